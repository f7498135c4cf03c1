"""Checks of arguments against annotations: none is lost in silence."""

import pytest

import wavesplat as ws
from wavesplat._model.arguments.types import takes_its_types
from wavesplat.errors import ArgumentError


def annotated(annotation):
    def function(value=None):
        return value

    function.__annotations__ = {"value": annotation}
    return takes_its_types(function)


@pytest.mark.parametrize(
    ("annotation", "right", "wrong", "message"),
    [
        ("float", 2, "2", "value is '2'; give a number"),
        ("int | None", None, 2.5, "value is 2.5; give a whole number"),
        ("bool", 1, [], None),
        ("Quality", "high", 3, "value is 3; give a name"),
        ("str | PathLike[str]", "a.nrrd", 3, "value is 3; give the name of a file or folder"),
        ("Callable[[float], object] | None", print, 3, "value is 3; give a function"),
        ("tuple[int, int]", "what the function says", "nothing", None),
    ],
)
def test_values_are_held_to_annotations(annotation, right, wrong, message):
    function = annotated(annotation)
    assert function(right) is right
    if message is None:
        assert function(wrong) is wrong
    else:
        with pytest.raises(ArgumentError, match=f"^{message}"):
            function(wrong)


@pytest.mark.parametrize("annotation", ["float | Length", "Length", "dict[str, int] | None", "Callable[[int], int]"])
def test_an_annotation_that_nobody_knows_is_an_error_where_the_function_is_defined(annotation):
    with pytest.raises(TypeError, match="add .* to KINDS or CHECKED_BY_FUNCTIONS"):
        annotated(annotation)


def test_texts_and_switches_are_no_numbers_anywhere():
    for given in ("2", True, b"2", None, [2], 10**400):
        for wrong in (
            lambda given=given: ws.Channel(emission_nm=given or "0"),
            lambda given=given: ws.FirstHit(given),
            lambda given=given: ws.ClipPlane((0, 0, given), (0, 0, 1)),
            lambda given=given: ws.TransferFunction([(0, 0), (given, 1)], [(0, 1, 1, 1)]),
            lambda given=given: ws.Points([(0, 0, 0)], opacity=given),
        ):
            with pytest.raises(ArgumentError, match=" is .*; give "):
                wrong()
    assert ws.ClipPlane((0, 0, 1e30), (0, 0, 1)).point[2] == 1e30
