"""Arguments of shapes as arrays: positions, values, numbers of vertices, and the errors that name what is wrong."""

from __future__ import annotations

from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from wavesplat._model.argument_types import described
from wavesplat.errors import ArgumentError

__all__ = [
    "check_count",
    "checked_positions",
    "checked_size",
    "checked_values",
    "frozen",
    "numbers_of",
    "row_of",
]

Floats: TypeAlias = NDArray[np.float64]


#: Largest number of positions or triangles of a shape, which the compiled module counts by 32 bits.
MAX_PLACES = 1 << 28


def row_of(what: str, row: int) -> str:
    """A row of an argument in messages: "vertices[3] of the surface" of "vertices of the surface"."""
    name, of, owner = what.partition(" of ")
    return f"{name}[{row}]{of}{owner}"


def check_count(given: Any, what: str) -> None:
    """An `ArgumentError` where an array has more rows than a shape may have, before it is copied."""
    if isinstance(given, np.ndarray) and given.ndim and len(given) > MAX_PLACES:
        raise ArgumentError(
            f"{what} has {len(given):,} rows, and a shape has at most {MAX_PLACES:,}; thin it out, or draw parts of it"
        )


def frozen(array: NDArray[Any]) -> NDArray[Any]:
    """The array, which nobody can write to any more."""
    array.flags.writeable = False
    return array


def numbers_of(given: Any, what: str, form: str, dtype: Any = np.float64) -> NDArray[Any]:
    """An argument as an array of its own. `form`: what to give, for the message."""
    try:
        array: NDArray[Any] = np.array(given, dtype=dtype)
    except (TypeError, ValueError, OverflowError):
        raise ArgumentError(f"{what} is {described(given)}; give {form}") from None
    return array


def checked_positions(given: Any, what: str, each: str) -> Floats:
    """World positions, shape (n, 3), finite and at least one; `each`: what a row is, for messages."""
    form = f"world positions (x, y, z), an array of shape (n, 3), a row for each {each}"
    check_count(given, what)
    array = numbers_of(given, what, form)
    if array.ndim != 2 or array.shape[1] != 3:
        raise ArgumentError(f"{what} has shape {array.shape}; give {form}")
    if not len(array):
        raise ArgumentError(f"{what} is empty; give at least one {each}, or leave the shape out")
    is_finite = np.isfinite(array).all(axis=1)
    if not is_finite.all():
        row = int(np.argmin(is_finite))
        raise ArgumentError(
            f"{row_of(what, row)} is {_triple(array[row])}, and {int((~is_finite).sum())} of {len(array)} are not "
            f"finite; leave them out, as with {what.partition(' ')[0]}[np.isfinite(...).all(axis=1)]"
        )
    return frozen(array)


def _triple(numbers: NDArray[Any]) -> str:
    return f"({', '.join(f'{number:g}' for number in numbers.tolist())})"


def checked_values(given: Any, n: int, what: str, each: str) -> Floats:
    """A value for each of `n` things, shape (n,); those that are NaN or infinite are NaN, and not drawn."""
    form = f"a number for each {each}, an array of shape ({n},)"
    array = numbers_of(given, what, form)
    if array.shape != (n,):
        raise ArgumentError(f"{what} has shape {array.shape}, and there are {n}; give {form}")
    return frozen(np.where(np.isfinite(array), array, np.nan))


def checked_size(given: Any, n: int, what: str) -> float | Floats:
    """A positive number, or one for each of `n` things."""
    form = f"a positive number, or one for each of the {n}"
    array = numbers_of(float("nan") if isinstance(given, str | bool) else given, what, form)
    if array.shape not in ((), (n,)):
        raise ArgumentError(f"{what} has shape {array.shape}; give {form}")
    is_right = np.isfinite(array) & (array > 0)
    if not is_right.all():
        if array.ndim == 0:
            raise ArgumentError(f"{what} is {described(given)}; give {form}")
        row = int(np.argmin(is_right))
        raise ArgumentError(f"{row_of(what, row)} is {array[row]:g}; give {form}")
    return float(array) if array.ndim == 0 else frozen(array)
