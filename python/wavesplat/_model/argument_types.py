"""Checks of arguments against a function's annotations; the error names the argument and what it takes.

Only annotations whose parts, joined by `|`, are all in `KINDS` (or `Callable`) are checked; others where they are used.
"""

from __future__ import annotations

import inspect
import os
import re
from collections.abc import Callable, Iterable
from functools import wraps
from operator import index
from typing import ParamSpec, TypeVar

from wavesplat._files.json_text import is_text
from wavesplat.errors import ArgumentError

__all__ = ["check_text", "described", "is_whole_number_below", "takes_its_types", "text_of"]

P = ParamSpec("P")
R = TypeVar("R")

#: Letters of a value in a message, at most; longer ones are named by their type.
MAX_LETTERS = 60
#: Bound of the whole numbers that the compiled module takes.
MAX_WHOLE = 2**63

VOLUME = (
    "a wavesplat.Volume, as from wavesplat.open(path), an array [z, y, x], or an image of SimpleITK, ITK, nibabel, "
    "xarray, PyVista, VTK, PyTorch or napari"
)


def described(value: object, *, lists: bool = False) -> str:
    """Text of a value for a message, or its type where that is long; `lists`: lists are written out too."""
    if (
        value is None
        or isinstance(value, str | int | float | complex | tuple | bytes)
        or (lists and isinstance(value, list))
    ):
        try:
            text = repr(value)
        except ValueError:  # whole numbers of more than 4300 digits
            text = "a number of very many digits"
        if len(text) <= MAX_LETTERS:
            return text
    return f"a {type(value).__name__}"


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

    @wraps(function)
    def checked(*args: P.args, **kwargs: P.kwargs) -> R:
        try:
            given = signature.bind(*args, **kwargs).arguments
        except TypeError:
            return function(*args, **kwargs)  # which says it better
        for name, value in given.items():
            if name in checks:
                checks[name](name, value)
        return function(*args, **kwargs)

    return checked


def _check(annotation: str) -> Callable[[str, object], None] | None:
    """A checker of values against an annotation; None for annotations with parts that are not in `KINDS`."""
    if annotation == "Volume":
        return None  # functions that take only samples say what to do with coefficients
    words = [annotation] if annotation in KINDS else re.split(r" \| (?![^\[]*\])", annotation)
    kinds = [_kind(word) for word in words]
    if not all(kinds):
        return None
    forms = list(dict.fromkeys(form for kind in kinds if kind and (form := kind[1])))

    def check(name: str, value: object) -> None:
        if TEXT in kinds:
            check_text(value, name)
        if not any(kind and kind[0](value) for kind in kinds):
            raise ArgumentError(f"{name} is {described(value)}; give {' or '.join(forms)}")

    return check


def _kind(word: str) -> tuple[Callable[[object], bool], str] | None:
    """Test for one part of an annotation, and its form in messages; None for an unknown part."""
    if word in KINDS:
        return KINDS[word]
    return (callable, "a function") if word.startswith("Callable[") else None


def _is_number(value: object) -> bool:
    # True would be 1: a switch in the place of a number is a slip.
    if isinstance(value, str | bytes | bytearray | bool):
        return False
    try:
        float(value)  # type: ignore[arg-type]
    except (TypeError, ValueError, OverflowError):
        return False
    return True


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
    "float": (_is_number, "a number"),
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
}
