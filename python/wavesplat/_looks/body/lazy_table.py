"""The table under a patient in a CT that is not in memory: samples read as they are drawn, or decoded from wavelets.

It is found as in `table.py`, from the same samples: of a lazy volume those are read once, slab by slab, from the
coarsest level that is as fine as the places that count. Then every box that is read gets air in the table's places, and
has a survey of its own, since light and bounds follow from what is drawn. Wavelets are decoded, since coefficients
have no places.
"""

from __future__ import annotations

import hashlib
import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wavesplat._looks.body.table import (
    EMPTY_HU,
    LARGEST,
    PLACE_MM,
    PROCESSING,
    SLICE_MM,
    Places,
    decided_by,
    empty_at,
    has_grid_of,
    may_have_table,
    out_of,
    without_table,
)
from wavesplat._model.lazy.lazy_array import LazyArray
from wavesplat._model.lazy.parts import read_box
from wavesplat._model.lazy.read_ahead import fill_box
from wavesplat._model.lazy.volume import LazyVolume, Level
from wavesplat._model.volume.stack import Box
from wavesplat._model.volume.volume import Volume
from wavesplat._model.volume.wavelet_volume import WaveletVolume

#: Share of the budget that a slab of samples takes.
SLAB_SHARE = 8
Mask = NDArray[np.bool_]
Shape = tuple[int, int, int]


def without_table_in_parts(
    volume: LazyVolume | WaveletVolume, decided_on: Volume | WaveletVolume | None = None
) -> Volume | None:
    """A patient's CT with air in place of the table; None where no table can be separated from the body.

    Of a lazy volume a lazy one; of wavelets the decoded samples, in memory.

    decided_on : of a series the volume whose table is used at all times; it counts where it is lazy and has
        the same grid. None is the volume itself.
    """
    if not may_have_table(volume):
        return None
    if isinstance(volume, LazyVolume):
        is_alike = isinstance(decided_on, LazyVolume) and has_grid_of(volume, decided_on)
        return _read(volume, decided_on if is_alike and isinstance(decided_on, LazyVolume) else volume)
    is_whole = volume.left_out == 0 and not volume.is_detail
    is_small = math.prod(volume.shape) * np.dtype(np.float32).itemsize <= LARGEST
    return without_table(volume.to_volume()) if is_whole and is_small else None


def _read(volume: LazyVolume, reference: LazyVolume) -> LazyVolume | None:
    number = _level_of_places(volume)
    grid = volume.grid_of(number)
    places = Places.of(grid)
    if places is None:
        return None
    looked_at = _looked_at(volume, number, places)
    of_reference = looked_at if reference is volume else _looked_at(reference, number, places)
    if looked_at is None or of_reference is None:
        return None
    decided = decided_by(places, of_reference, reference)
    out = None if decided is None else out_of(places, looked_at, decided)
    if decided is None or out is None:
        return None
    of_axes = places.places(grid.shape, len(out))
    in_file = np.ascontiguousarray(out.transpose(np.argsort(places.order)))
    value = max(EMPTY_HU + decided.offset, float(volume.value_range[0]))
    levels = []
    for level in volume._levels:
        between = np.linalg.inv(grid.world_from_index) @ level.world_from_index
        at = [_nearest(of, n, between, 2 - k) for k, (of, n) in enumerate(zip(of_axes, level.array.shape, strict=True))]
        levels.append(Level(EmptiedArray(level.array, in_file, (at[0], at[1], at[2]), value), level.world_from_index))
    facts = replace(volume.facts, processing=(*volume.facts.processing, PROCESSING))
    made = LazyVolume._made(levels, volume.name, facts, memory=volume.memory, keep=volume._keep, holes=volume.holes)
    made._at, made._source = volume._at, volume._source
    return made


def _level_of_places(volume: LazyVolume) -> int:
    """The coarsest level whose samples are no further apart than the search for a table needs."""
    fine = [
        k
        for k, level in enumerate(volume._levels)
        if max(level.spacing) <= SLICE_MM and sorted(level.spacing)[1] <= PLACE_MM / 2
    ]
    return fine[-1] if fine else 0


def _looked_at(volume: LazyVolume, number: int, places: Places) -> NDArray[Any] | None:
    """The samples of a level in which a table is searched, [slice, row, column], read slab by slab.

    None where they take more than a quarter of the budget.
    """
    array = volume._levels[number].array
    wanted = places.indices(array.shape)
    ascending = [np.sort(along) for along in wanted]
    if math.prod(along.size for along in ascending) * array.dtype.itemsize > volume.memory // 4:
        return None
    found = np.empty([along.size for along in ascending], array.dtype)
    n_bytes_of_row = array.shape[1] * array.shape[2] * array.dtype.itemsize
    thick = max(1, min(array.chunks[0], volume.memory // SLAB_SHARE // n_bytes_of_row))
    for first in range(0, array.shape[0], thick):
        inside = (ascending[0] >= first) & (ascending[0] < first + thick)
        if inside.any():
            rows = ascending[0][inside]
            box: Box = ((int(rows[0]), 0, 0), (int(rows[-1]) + 1, array.shape[1], array.shape[2]))
            slab = read_box(array, box)
            found[inside] = slab[np.ix_(rows - rows[0], ascending[1], ascending[2])]
    return found.transpose(places.order)[places.turned]


def _nearest(places: NDArray[np.intp], n: int, between: NDArray[np.float64], axis: int) -> NDArray[np.intp]:
    """Places along an axis of another level's samples, by the nearest sample of the level that they belong to."""
    index = np.rint(between[axis, axis] * np.arange(n) + between[axis, 3]).astype(np.intp)
    nearest: NDArray[np.intp] = places[np.clip(index, 0, places.size - 1)]
    return nearest


@dataclass
class EmptiedArray:
    """An array that reads as another one, but for a value at some places.

    out : whether a place is emptied. places : number of the place of each sample along z, y, x.
    """

    array: LazyArray
    out: Mask
    places: tuple[NDArray[np.intp], NDArray[np.intp], NDArray[np.intp]]
    value: float

    def __getattr__(self, name: str) -> Any:
        if name.startswith("__") or name == "array":
            raise AttributeError(name)
        return getattr(self.array, name)

    @property
    def token(self) -> str | None:
        """Name of the samples; not the array's name, since the array has another survey."""
        own = hashlib.sha256(self.out.tobytes()).hexdigest()
        return None if self.array.token is None else f"{self.array.token} emptied {own} {self.value:g}"

    def read(self, lo: Shape, hi: Shape) -> NDArray[Any]:
        """Read the samples of a box."""
        return self._emptied(self.array.read(lo, hi), (lo, hi))

    def read_into(self, lo: Shape, hi: Shape, out: NDArray[Any]) -> None:
        """Read the samples of a box into an array of zeros, of its shape and of the type `dtype`."""
        fill_box(self.array, (lo, hi), out)
        self._empty(out, (lo, hi))

    def read_many(self, boxes: Sequence[Box]) -> list[NDArray[Any]]:
        """Read the samples of several boxes."""
        return [self._emptied(one, box) for one, box in zip(self.array.read_many(boxes), boxes, strict=True)]

    def _emptied(self, samples: NDArray[Any], box: Box) -> NDArray[Any]:
        """The samples of a box that were read, or an emptied copy."""
        if not self.out[np.ix_(*self._places_in(box))].any():
            return samples
        emptied = np.array(samples)
        self._empty(emptied, box)
        return emptied

    def _empty(self, samples: NDArray[Any], box: Box) -> None:
        """Empty the samples of a box."""
        empty_at(samples, self.out, self._places_in(box), self.value)

    def _places_in(self, box: Box) -> list[NDArray[np.intp]]:
        """Along each axis the number of the place of each sample of a box."""
        return [at[a:b] for at, a, b in zip(self.places, *box, strict=True)]
