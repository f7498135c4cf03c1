"""Samples that automatic looks and cameras are made from, gathered box by box from a volume that is not in memory.

They are the very samples that looks of volumes in memory see, in their own type, so that both get the same look: every
n-th along each axis (`thinning.py`), and for the kind of data some samples with their direct neighbours.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wavesplat._model.thinning import HISTOGRAM_SAMPLES, KIND_SAMPLES, UNIT_SAMPLES, step_for

Shape = tuple[int, int, int]


class ThinnedSamples:
    """Every n-th sample of a volume along each axis, from the sample at `start` on.

    counts : number of them along z, y, x.
    """

    def __init__(self, dtype: np.dtype[Any], start: Shape, step: int, counts: Sequence[int]) -> None:
        self.start, self.step = start, step
        self.samples: NDArray[Any] = np.zeros(counts, dtype)

    def take(self, samples: NDArray[Any], low: Sequence[int]) -> None:
        """Copy those that lie in a box of samples [z, y, x], which begins at `low`."""
        ours, theirs = [], []
        for own, first, n, count in zip(self.start, low, samples.shape, self.samples.shape, strict=True):
            begin = max(0, -((own - first) // self.step))
            end = min(count, -((own - first - n) // self.step))
            if begin >= end:
                return
            ours.append(slice(begin, end))
            place = own + begin * self.step - first
            theirs.append(slice(place, place + (end - begin - 1) * self.step + 1, self.step))
        self.samples[tuple(ours)] = samples[tuple(theirs)]


class LookSamples:
    """Thinned samples of a volume of this shape and type, for looks, cameras and kinds of data."""

    def __init__(self, shape: Shape, dtype: np.dtype[Any]) -> None:
        n = math.prod(shape)
        steps = dict.fromkeys(step_for(n, most) for most in (HISTOGRAM_SAMPLES, UNIT_SAMPLES))
        #: By step, the finest first.
        self._every = {s: ThinnedSamples(dtype, (0, 0, 0), s, [-(-size // s) for size in shape]) for s in steps}
        self.neighbour_step = step_for(n, KIND_SAMPLES)
        self._neighbours = [
            ThinnedSamples(dtype, start, self.neighbour_step, self._counts(shape)) for start in _around(shape)
        ]

    def _counts(self, shape: Shape) -> list[int]:
        """Samples along each axis that have two neighbours along it, or all where none has."""
        return [
            len(range(1, n - 1, self.neighbour_step) if n >= 3 else range(0, n, self.neighbour_step)) for n in shape
        ]

    def take(self, samples: NDArray[Any], low: Sequence[int]) -> None:
        """Copy those that lie in a box of samples [z, y, x], which begins at `low`."""
        for part in (*self._every.values(), *self._neighbours):
            part.take(samples, low)

    def every(self, step: int) -> NDArray[Any] | None:
        """Every n-th sample along each axis; None where that step was not gathered."""
        found = self._every.get(step)
        return None if found is None else found.samples

    @property
    def finest(self) -> tuple[int, NDArray[Any]]:
        """The smallest step that was gathered, and the samples."""
        step = min(self._every)
        return step, self._every[step].samples

    @property
    def coarsest(self) -> NDArray[Any]:
        """The samples of the largest step that was gathered."""
        return self._every[max(self._every)].samples

    @property
    def with_neighbours(self) -> tuple[NDArray[Any], list[tuple[NDArray[Any], NDArray[Any]]]]:
        """Samples `neighbour_step` apart, and their two neighbours along each axis that has any, all flat."""
        middle, *around = (part.samples.ravel() for part in self._neighbours)
        return middle, list(zip(around[::2], around[1::2], strict=True))

    def parts(self) -> list[NDArray[Any]]:
        """All arrays, in an order that depends on shape alone."""
        return [part.samples for part in (*self._every.values(), *self._neighbours)]

    def placed(self) -> list[tuple[NDArray[Any], tuple[Shape, Shape]]]:
        """All arrays of `parts`, each with the index of its first sample and the steps between its samples."""
        kept = (*self._every.values(), *self._neighbours)
        return [(part.samples, (part.start, (part.step,) * 3)) for part in kept]

    def fill(self, parts: Iterable[NDArray[Any]]) -> None:
        """Take the arrays of `parts`; a `ValueError` for other shapes or types."""
        for own, part in zip((*self._every.values(), *self._neighbours), parts, strict=True):
            if part.shape != own.samples.shape or part.dtype != own.samples.dtype:
                raise ValueError("thinned samples of another volume")
            own.samples = part


def _around(shape: Shape) -> list[Shape]:
    """Places of the first sample that has neighbours, and of these: before and after it along each axis."""
    z, y, x = (1 if n >= 3 else 0 for n in shape)
    found: list[Shape] = [(z, y, x)]
    for axis, n in enumerate(shape):
        for side in (-1, 1) if n >= 3 else ():
            own = [z, y, x]
            own[axis] += side
            found.append((own[0], own[1], own[2]))
    return found
