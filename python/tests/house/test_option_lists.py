"""Options that several functions take: one list each, with equal names, types and defaults wherever they are taken."""

import dataclasses
import inspect

import numpy as np
import pytest

import wavesplat as ws
from wavesplat._model.arguments.types import takes_options
from wavesplat._readers.options import FileOptions, OpenOptions
from wavesplat._readers.request import Request
from wavesplat._render.options import DrawOptions, FrameOptions, RenderOptions

#: Each list with the class of its values.
LISTS = [(RenderOptions, DrawOptions), (OpenOptions, Request)]
#: Each function with the list that it takes.
DOORS = {
    "render": (ws.render, RenderOptions),
    "Scene.render": (ws.Scene.render, RenderOptions),
    "study.render": (ws.study.render, RenderOptions),
    "progressive": (ws.progressive, FrameOptions),
    "render_frames": (ws.render_frames, FrameOptions),
    "movie": (ws.movie, FrameOptions),
    "open": (ws.open, OpenOptions),
    "open_series": (ws.open_series, FileOptions),
    "open_scene": (ws.open_scene, FileOptions),
}
#: Defaults of a function that are not the list's, and why.
OTHER_DEFAULTS = {("movie", "quality"): None}  # moving frames need less


@pytest.mark.parametrize(("listed", "values"), LISTS)
def test_a_list_and_its_values_have_the_same_fields(listed, values):
    written = {name: getattr(kind, "__forward_arg__", kind) for name, kind in listed.__annotations__.items()}
    assert written == {f.name: f.type for f in dataclasses.fields(values) if f.name in written}


@pytest.mark.parametrize(("listed", "values"), LISTS)
def test_every_option_is_documented_once(listed, values):
    entries = [line for line in inspect.cleandoc(listed.__doc__).splitlines() if " : " in line and line[0] != " "]
    names = [name.strip() for entry in entries for name in entry.split(" : ")[0].split(",")]
    assert sorted(names) == sorted(listed.__annotations__)


@pytest.mark.parametrize("door", DOORS)
def test_signatures_are_whole(door):
    function, listed = DOORS[door]
    values = DrawOptions if "quality" in listed.__annotations__ else Request
    defaults = {field.name: field.default for field in dataclasses.fields(values)}
    parameters = inspect.signature(function).parameters
    assert all(parameter.kind is not parameter.VAR_KEYWORD for parameter in parameters.values())
    for name in listed.__annotations__:
        assert parameters[name].kind is inspect.Parameter.KEYWORD_ONLY
        assert parameters[name].default == OTHER_DEFAULTS.get((door, name), defaults[name])


@pytest.mark.parametrize("door", DOORS)
def test_documentation_is_whole(door):
    function, listed = DOORS[door]
    assert "**options" not in function.__doc__
    before_returns = function.__doc__.split("\nReturns\n")[0].split("\nYields\n")[0]
    assert all(name in before_returns for name in listed.__annotations__)


def test_a_misspelt_option_is_told_with_the_one_that_is_meant():
    with pytest.raises(TypeError, match=r"render\(\) got an unexpected keyword argument 'qualty'; is it 'quality'\?"):
        ws.render(ws.examples.ripples(8), qualty="high")
    with pytest.raises(TypeError, match=r"open\(\) got an unexpected keyword argument 'zzz'$"):
        ws.open("a.nrrd", zzz=3)


@pytest.mark.parametrize(
    ("function", "keyword", "words"),
    [
        (ws.render, "view", r"; write camera= \(the name of a view, such as \"xy\""),
        (ws.Scene.render, "view", r"; write camera= "),
        (ws.slice, "view", r"^slice\(\) got .* 'view'; write plane=$"),
        (ws.render, "cmap", r"; write look=$"),
        (ws.slice, "cmap", r"; write transfer_function= "),
        (ws.render, "iso_value", r"; write composite= \(wavesplat.FirstHit\(value\)\)$"),
        (ws.render, "scale_bar", r"; annotate the picture: picture.annotated\(scale_bar=...\)$"),
        (ws.slice, "labels", r"; give a scene: wavesplat.Scene\(volume, labels=...\)$"),
        (ws.open, "voxel_size", r"; write spacing=$"),
        (ws.Label, "colour", r"^Label\(\) got .*; is it 'color'\?$"),
    ],
)
def test_a_keyword_of_the_command_or_of_another_program_says_what_to_write(function, keyword, words):
    with pytest.raises(TypeError, match=words):
        function(ws.examples.ripples(8), **{keyword: 1})


def test_an_option_of_a_list_is_taken_by_every_door_and_leaves_no_trace():
    # What a new option costs: a line in the list and one with its default; doors need none.
    class Wider(FrameOptions, total=False):
        """Wider options.

        Parameters
        ----------
        fog : float
            Share of light that is lost on the way.
        """

        fog: float

    values = dataclasses.make_dataclass("Values", [("fog", "float", 0.5)], bases=(DrawOptions,), frozen=True)

    def draw(volume, **options):
        """Draw.

        Parameters
        ----------
        volume : Volume
            The volume.
        **options : Wider
            As they are.
        """
        return options

    door = takes_options(Wider, values)(draw)
    assert inspect.signature(door).parameters["fog"].default == 0.5
    assert "fog" in door.__doc__
    assert door(None, fog=1) == {"fog": 1}
    assert "fog" not in inspect.signature(ws.render).parameters


def test_options_are_passed_on_as_a_dictionary():
    options: RenderOptions = {"size": (24, 16), "quality": "draft", "device": "cpu"}
    scene = ws.Scene(ws.examples.ripples(8))
    pictures = [scene.render(**options), ws.render(scene, **options), list(ws.progressive(scene, **options))[-1]]
    for picture in pictures[1:]:
        assert np.array_equal(picture.rgba, pictures[0].rgba)


def test_frames_take_the_options_that_a_picture_takes():
    scene = ws.Scene(ws.examples.ripples(8))
    options = {"size": (16, 12), "device": "cpu", "threads": 1, "psnr": 30.0}
    [frame] = ws.render_frames(scene, ["front"], **options)
    assert frame.report["n_threads"] == 1
    assert frame.report["expected_psnr_db"] > 25
    with pytest.raises(ws.errors.ArgumentError, match="psnr"):
        ws.render_frames(scene, ["front"], client="threads", **options)
