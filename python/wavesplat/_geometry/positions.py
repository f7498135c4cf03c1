"""Arguments of shapes as arrays: positions, values, numbers of vertices, and chains of positions."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from typing import Any, TypeAlias, overload

import numpy as np
from numpy.typing import NDArray

from wavesplat._system.values import described
from wavesplat.errors import ArgumentError

# Arguments of shapes as arrays: positions, values, numbers of vertices, and the errors that name what is wrong.

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


# Chains of positions: all in one array, with the number where each begins.


class Chains(Sequence[NDArray[np.float64]]):
    """Paths through positions, each an array of shape (n, 3).

    positions : of all paths, one after the other. starts : the first position of each path, then the number of all.
    """

    def __init__(self, positions: NDArray[np.float64], starts: NDArray[np.uint32]) -> None:
        self.positions, self.starts = positions, starts

    def __len__(self) -> int:
        return len(self.starts) - 1

    @overload
    def __getitem__(self, number: int) -> NDArray[np.float64]: ...
    @overload
    def __getitem__(self, number: slice) -> list[NDArray[np.float64]]: ...
    def __getitem__(self, number: int | slice) -> Any:
        if isinstance(number, slice):
            return [self[k] for k in range(len(self))[number]]
        k = range(len(self))[number]
        return self.positions[self.starts[k] : self.starts[k + 1]]

    def __iter__(self) -> Iterator[NDArray[np.float64]]:
        return (self.positions[a:b] for a, b in zip(self.starts[:-1], self.starts[1:], strict=True))

    @property
    def lengths(self) -> NDArray[np.int64]:
        """Number of positions of each path."""
        starts = self.starts.astype(np.int64)
        return starts[1:] - starts[:-1]

    @property
    def numbers(self) -> NDArray[np.int64]:
        """Number of the path that each position belongs to."""
        return np.repeat(np.arange(len(self)), self.lengths)

    def directions(self) -> NDArray[np.float64]:
        """Unit vectors along the paths at each position, the mean of both sides; zero where a path stands still."""
        steps = np.zeros((len(self.positions) + 1, 3))
        steps[1:-1] = np.diff(self.positions, axis=0)
        steps[self.starts[self.starts <= len(self.positions)]] = 0  # between two paths
        lengths = np.linalg.norm(steps, axis=1)
        steps[lengths > 0] /= lengths[lengths > 0, None]
        along = steps[1:] + steps[:-1]
        lengths = np.linalg.norm(along, axis=1)
        along[lengths > 0] /= lengths[lengths > 0, None]
        return along


def chains_of(given: Any, what: str) -> Chains:
    """Paths as chains: an array of shape (n, 3), or several in a list; paths of fewer than two positions are nothing.

    what : name of the argument in messages.
    """
    if isinstance(given, Chains):
        return given
    form = "one array of world positions (x, y, z), shape (n, 3), or a list of such"
    check_count(given, what)
    if isinstance(given, np.ndarray) and given.ndim == 2:
        parts: list[Any] = [given]
    elif isinstance(given, str) or not isinstance(given, Iterable):
        raise ArgumentError(f"{what} is {described(given)}; give {form}")
    else:
        parts = list(given)
        if parts and all(np.ndim(part) == 1 for part in parts[:3]):
            parts = [numbers_of(parts, what, form)]
    arrays = [numbers_of(part, row_of(what, k), form) for k, part in enumerate(parts)]
    for k, array in enumerate(arrays):
        if array.size and (array.ndim != 2 or array.shape[1] != 3):
            raise ArgumentError(f"{row_of(what, k)} has shape {array.shape}; give {form}")
    kept = [array for array in arrays if array.size]
    if not any(len(array) > 1 for array in kept):
        raise ArgumentError(f"{what} has no path of at least two positions; give {form}")
    together = np.concatenate(kept)
    is_finite = np.isfinite(together).all(axis=1)
    starts = np.concatenate([[0], np.cumsum([len(array) for array in kept])])
    if not is_finite.all():
        at = int(np.argmin(is_finite))
        k = int(np.searchsorted(starts, at, side="right")) - 1
        raise ArgumentError(
            f"{row_of(what, k)} has {tuple(together[at].tolist())} as position {at - int(starts[k])}, which is not "
            "finite; leave it out, or break the path there"
        )
    return Chains(checked_positions(together, what, "position"), frozen(starts.astype(np.uint32)))
