"""Chains of positions: all in one array, with the number where each begins."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from typing import Any, overload

import numpy as np
from numpy.typing import NDArray

from wavesplat._geometry.positions import check_count, checked_positions, frozen, numbers_of, row_of
from wavesplat._model.argument_types import described
from wavesplat.errors import ArgumentError


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
