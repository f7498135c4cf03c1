"""Checks of arguments against a function's annotations; the error names the argument and what it takes.

An annotation is one or several types, joined by `|`. Each of them is in `KINDS`, which says how it is checked, or in
`CHECKED_BY_FUNCTIONS`; any other is an error when the function is defined. Arguments with a type of the second list are
checked by the function itself.
"""

from __future__ import annotations

import inspect
import os
from collections.abc import Callable, Iterable
from functools import wraps
from operator import index
from typing import ParamSpec, TypeVar

from wavesplat._files.file_names import FileName
from wavesplat._files.json_text import is_text
from wavesplat._files.values import described, float_of
from wavesplat._model.keyword_hints import check_keywords
from wavesplat.errors import ArgumentError

__all__ = ["check_text", "described", "is_whole_number_below", "takes_its_types", "text_of"]

P = ParamSpec("P")
R = TypeVar("R")

#: Bound of the whole numbers that the compiled module takes.
MAX_WHOLE = 2**63

VOLUME = (
    "a wavesplat.Volume, as from wavesplat.open(path), an array [z, y, x], or an image of SimpleITK, ITK, nibabel, "
    "xarray, PyVista, VTK, PyTorch, yt or napari"
)


def is_whole_number_below(value: object, n: int) -> bool:
    """Whether a value is one of the whole numbers from 0 to n - 1."""
    try:
        return 0 <= index(value) < n  # type: ignore[arg-type]
    except TypeError:
        return False


def check_text(value: object, what: str) -> None:
    """Raise an `ArgumentError` for a text that cannot be written: it has half of a surrogate pair."""
    if isinstance(value, str) and not is_text(value):
        raise ArgumentError(f"{what} is {described(value)}, which has half of a surrogate pair; give a text without")


def text_of(value: object, what: str) -> str:
    """A value as a text; an `ArgumentError` for a whole number of more digits than Python writes."""
    if isinstance(value, FileName):
        return value
    try:
        return str(value)
    except ValueError:
        raise ArgumentError(f"{what} is {described(value)}; give a name") from None


def takes_its_types(function: Callable[P, R]) -> Callable[P, R]:
    """Decorate a function so that arguments of other types than its annotations' raise an `ArgumentError`."""
    signature = inspect.signature(function)
    checks = {
        name: check
        for name, parameter in signature.parameters.items()
        if isinstance(parameter.annotation, str) and (check := _check(parameter.annotation))
    }

    takes_any = any(parameter.kind is parameter.VAR_KEYWORD for parameter in signature.parameters.values())

    @wraps(function)
    def checked(*args: P.args, **kwargs: P.kwargs) -> R:
        try:
            given = signature.bind(*args, **kwargs).arguments
        except TypeError:
            if not takes_any:
                check_keywords(function, kwargs, signature.parameters)
            return function(*args, **kwargs)  # which says it better
        for name, value in given.items():
            if name in checks:
                checks[name](name, value)
        return function(*args, **kwargs)

    return checked


def _check(annotation: str) -> Callable[[str, object], None] | None:
    """A checker of values against an annotation; None for one that the function checks itself."""
    words = [annotation] if annotation in KINDS else _alternatives(annotation)
    for word in words:
        if word not in KINDS and word.partition("[")[0] not in CHECKED_BY_FUNCTIONS:
            raise TypeError(f"annotation {annotation!r}: add {word!r} to KINDS or CHECKED_BY_FUNCTIONS")
    if annotation == "Volume" or not all(word in KINDS for word in words):
        return None  # functions that take only samples say what to do with coefficients
    kinds = [KINDS[word] for word in words]
    forms = list(dict.fromkeys(form for _, form in kinds if form))

    def check(name: str, value: object) -> None:
        if TEXT in kinds:
            check_text(value, name)
        if not any(fits(value) for fits, _ in kinds):
            raise ArgumentError(f"{name} is {described(value)}; give {' or '.join(forms)}")

    return check


def _alternatives(annotation: str) -> list[str]:
    """The types of an annotation that are joined by `|` outside of brackets."""
    words, depth = [""], 0
    for letter in annotation.replace(" | ", "|"):
        depth += (letter == "[") - (letter == "]")
        if letter == "|" and depth == 0:
            words.append("")
        else:
            words[-1] += letter
    return words


def _is_whole(value: object) -> bool:
    try:
        return not isinstance(value, bool) and -MAX_WHOLE <= index(value) < MAX_WHOLE  # type: ignore[arg-type]
    except TypeError:
        return False


def _is_flag(value: object) -> bool:
    try:
        bool(value)
    except (TypeError, ValueError):
        return False
    return True


def _is_many(value: object) -> bool:
    return isinstance(value, Iterable)


def _is_text(value: object) -> bool:
    return isinstance(value, str) and is_text(value)


def _is_a(*names: str) -> Callable[[object], bool]:
    """Test whether a value's class or one of its bases has one of these names (their modules import this one)."""
    return lambda value: any(base.__name__ in names for base in type(value).__mro__)


TEXT = (_is_text, "a name")

KINDS: dict[str, tuple[Callable[[object], bool], str]] = {
    "Iterable[Light]": (_is_many, "a sequence of wavesplat.Light"),
    "None": (lambda value: value is None, ""),
    "float": (lambda value: float_of(value) is not None, "a number"),
    "int": (_is_whole, "a whole number"),
    "bool": (_is_flag, "True or False"),
    "str": TEXT,
    **dict.fromkeys(("Kernel", "Composite", "Quality", "Slab", "Buffer"), TEXT),
    # Names of files may hold bytes that are no text.
    "str | PathLike[str]": (lambda value: isinstance(value, str | os.PathLike), "the name of a file or folder"),
    "Grid": (_is_a("Grid"), VOLUME),
    "Volume": (_is_a("Volume"), VOLUME),
    "WaveletVolume": (_is_a("WaveletVolume"), ""),
    "Picture": (_is_a("Picture"), "a wavesplat.Picture"),
    "Shading": (_is_a("Shading"), "a wavesplat.Shading or None"),
    "Literal['look']": (lambda value: isinstance(value, str) and value == "look", '"look"'),
    "Look": (_is_a("Look"), "a wavesplat.Look"),
    # Functions that take only `TransferFunction` say so themselves.
    "TransferFunction": (_is_a("TransferFunction", "TransferFunction2D"), "a TransferFunction"),
    "TransferFunction2D": (_is_a("TransferFunction2D"), "a TransferFunction2D"),
    "Materials": (_is_a("Materials"), "Materials"),
    "Crop": (_is_a("Crop"), "a wavesplat.Crop(lower, upper, space=...)"),
    "Callable[[float], object]": (callable, "a function"),
}

#: Types whose values the functions check themselves, since they take them in several forms, or say what to do instead.
CHECKED_BY_FUNCTIONS = frozenset(
    {
        *("Any", "object", "VolumeLike", "Scene", "Labels", "AnyLook", "Sampling", "Stereo", "Operator", "Opacity"),
        *("Camera", "Clip", "Along", "Plane", "Orientation", "Corner", "Side", "Fit", "Ablation", "StandardSplatting"),
        *("tuple", "Iterable", "Sequence", "Mapping", "Literal", "PathLike", "ArrayLike", "DTypeLike", "Isolines"),
        "_native.Shapes",
        "Shown",
    }
)
