"""Parts of lazy volumes that are read as a whole: boxes, overviews, and samples to match the brightness of levels."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from wavesplat._files.memory import check_room
from wavesplat._model.crop import Crop
from wavesplat._model.lazy_array import LazyArray
from wavesplat._model.read_ahead import Box, BoxReader
from wavesplat._model.volume import Volume
from wavesplat.errors import ArgumentError

if TYPE_CHECKING:
    from wavesplat._model.lazy_volume import LazyVolume, Level

__all__ = ["MAX_OVERVIEW", "busiest_part", "level_in_finest", "nearest_every", "part_of", "preview_of", "read_box"]

#: Samples of a finer level from which its brightness is learnt, and the ratio of its spacing, both at most.
MAX_PART, MAX_FINER = 1 << 22, 4.5
#: Least side of a box that is looked for in all of a level, samples.
LEAST_SIDE = 16
#: Samples of the finest level whose neighbours tell noise and labels, about.
N_BUSIEST = 1 << 18
#: Samples of a level that is read as a whole for looks, cameras and previews, at most.
MAX_OVERVIEW = 1 << 24

Matrix = NDArray[np.float64]


def part_of(volume: LazyVolume, level: Level, crop: Crop | None) -> Volume:
    """The samples of a level in a box, in memory."""
    shape = level.array.shape
    low, high = [0, 0, 0], list(shape)
    if crop is not None:
        lower, upper = _index_box(volume, level, crop)
        low = [max(0, math.ceil(n - 1e-9)) for n in reversed(lower.tolist())]
        high = [min(n, math.floor(end + 1e-9) + 1) for n, end in zip(shape, reversed(upper.tolist()), strict=True)]
        if any(b - a < 2 for a, b in zip(low, high, strict=True)):
            raise ArgumentError(
                f"crop: the box holds samples z {low[0]}..{high[0]}, y {low[1]}..{high[1]}, x {low[2]}..{high[2]} of "
                f"{volume.name!r}, shape {shape}; a volume needs two along every axis"
            )
    box: Box = ((low[0], low[1], low[2]), (high[0], high[1], high[2]))
    samples = read_box(level.array, box)
    matrix = level.world_from_index.copy()
    matrix[:3, 3] += matrix[:3, :3] @ np.array(low[::-1], np.float64)
    return Volume(samples, world_from_index=matrix, name=volume.name, facts=volume.facts)


def read_box(array: LazyArray, box: Box) -> NDArray[Any]:
    """Read the samples of a box."""
    n = math.prod(b - a for a, b in zip(*box, strict=True))
    check_room(n * array.dtype.itemsize, "the samples", "read a smaller box, or a coarser level")
    with BoxReader([array]) as reader:
        return reader.begin(0, box, [box]).result()


def _index_box(volume: LazyVolume, level: Level, crop: Crop) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """First and last index (x, y, z) of a box in the samples of a level, not rounded."""
    ends = crop.corners_in("world")
    from_world = np.linalg.inv(level.world_from_index)
    if ends is None:
        ends = crop.corners_in("index")
        from_world = from_world @ volume.world_from_index
    lower, upper = (np.asarray(end, np.float64) for end in ends or ((0.0,) * 3,) * 2)
    corners = np.stack([np.where([(k >> a) & 1 for a in range(3)], upper, lower) for k in range(8)])
    inside = corners @ from_world[:3, :3].T + from_world[:3, 3]
    return inside.min(axis=0), inside.max(axis=0)


def nearest_every(volume: LazyVolume, level: Level, number: int, step: int) -> NDArray[Any]:
    """The sample of a level nearest to every n-th sample of the finest level, [z, y, x]."""
    between = np.linalg.inv(level.world_from_index) @ volume.world_from_index
    places = []
    for axis, n in enumerate(volume.shape):
        a = 2 - axis
        index = between[a, a] * np.arange(0, n, step) + between[a, 3]
        places.append(np.clip(np.rint(index), 0, level.array.shape[axis] - 1).astype(np.int64))
    if math.prod(level.array.shape) <= MAX_OVERVIEW:
        samples = volume._overview(number)
        return samples[np.ix_(*places)]
    # The level is too large to be read as a whole: the nearest of the samples that its survey kept.
    finest, strided = volume.survey(number, "linear").finest(is_cube=True)
    nearest = [
        np.minimum(np.rint(p / finest[0]).astype(np.int64), n - 1) for p, n in zip(places, strided.shape, strict=True)
    ]
    return strided[np.ix_(*nearest)].astype(volume.dtype)


def preview_of(volume: LazyVolume, number: int) -> Volume:
    """Preview of a level: all samples of a small one, else every n-th along each axis, as its survey kept them."""
    level = volume._levels[number]
    matrix = level.world_from_index.copy()
    if math.prod(level.array.shape) <= MAX_OVERVIEW:
        samples = volume._overview(number)
    else:
        step, kept = volume.survey(number, "linear").finest(is_cube=True)
        samples = kept.astype(level.array.dtype)
        matrix[:3, :3] *= step[0]
    return Volume(samples, world_from_index=matrix, name=volume.name, facts=volume.facts)


def level_in_finest(volume: LazyVolume, number: int) -> tuple[Any, Any, Any] | None:
    """Place of a level in the finest one, and the same box of it and of a finer one, to match their brightness."""
    if number == 0:
        return None
    levels, value_range = volume._levels, volume.survey(number, "linear").value_range
    finest, own = levels[0], levels[number]
    # The finest level within the ratio: reading a finer one costs more than it adds.
    ratios = [max(a / b for a, b in zip(own.spacing, finer.spacing, strict=True)) for finer in levels[:number]]
    fitting = [k for k, ratio in enumerate(ratios) if ratio <= MAX_FINER]
    place = fitting[0] if fitting else number - 1
    finer = levels[place]
    coarse_box = _busiest(volume, number, MAX_PART / _ratio(own, finer))
    coarse = read_box(volume.arrays(number), coarse_box)
    fine_box = _same_box(coarse_box, own, finer)
    fine = read_box(volume.arrays(place), fine_box)
    low_value = min(value_range[0], float(np.nanmin(fine)))
    high_value = max(value_range[1], float(np.nanmax(fine)))
    told = (finer.world_from_index, (_finite(fine), fine_box[0]), (_finite(coarse), coarse_box[0]))
    return finest.array.shape, finest.world_from_index, (*told, (low_value, high_value))


def busiest_part(volume: LazyVolume, number: int) -> NDArray[Any]:
    """Samples of the finest level, [z, y, x], side by side, where the values of a coarser one vary most."""
    own, finest = volume._levels[number], volume._levels[0]
    side = max(4, int((N_BUSIEST / _ratio(own, finest)) ** (1 / 3)))
    box = _busiest(volume, number, max(side, LEAST_SIDE) ** 3)
    # In two steps, since a small box has many places in a level.
    within = [range(a, max(b - side, a) + 1, max(side // 2, 1)) for a, b in zip(*box, strict=True)]
    coarse = read_box(volume.arrays(number), box)
    places = [(z, y, x) for z in within[0] for y in within[1] for x in within[2]]

    def spread(place: tuple[int, ...]) -> float:
        cut = tuple(slice(at - first, at - first + side) for at, first in zip(place, box[0], strict=True))
        return float(np.nan_to_num(np.std(coarse[cut].astype(np.float64))))

    low = max(places, key=spread)
    z, y, x = (min(at + side, end) for at, end in zip(low, box[1], strict=True))
    return read_box(finest.array, _same_box((low, (z, y, x)), own, finest))


def _ratio(coarse: Level, fine: Level) -> float:
    """Samples of the finer of two levels in the place of one of the coarser."""
    return math.prod(a / b for a, b in zip(coarse.spacing, fine.spacing, strict=True))


def _same_box(box: Box, coarse: Level, fine: Level) -> Box:
    """The samples of the finer of two levels in a box of the coarser."""
    between = np.linalg.inv(fine.world_from_index) @ coarse.world_from_index
    low, high = [], []
    for axis in range(3):
        a = 2 - axis
        ends = [between[a, a] * index + between[a, 3] for index in (box[0][axis], box[1][axis] - 1)]
        n = fine.array.shape[axis]
        first = int(np.clip(math.floor(min(ends)), 0, n - 2))
        low.append(first)
        high.append(int(np.clip(math.ceil(max(ends)) + 1, first + 2, n)))
    return ((low[0], low[1], low[2]), (high[0], high[1], high[2]))


def _finite(samples: NDArray[Any]) -> NDArray[np.float32]:
    return np.ascontiguousarray(np.nan_to_num(samples.astype(np.float32)))


def _busiest(volume: LazyVolume, number: int, most: float) -> Box:
    """A box of about `most` samples of a level, where the values that its survey kept vary most."""
    shape = volume._levels[number].array.shape
    side = max(LEAST_SIDE, int(round(most ** (1 / 3), 6)))
    size = [min(n, side) for n in shape]
    steps, strided = volume.survey(number, "linear").finest()
    best, first = -1.0, [(n - s) // 2 for n, s in zip(shape, size, strict=True)]
    for z in range(0, shape[0] - size[0] + 1, max(size[0] // 2, 1)):
        for y in range(0, shape[1] - size[1] + 1, max(size[1] // 2, 1)):
            for x in range(0, shape[2] - size[2] + 1, max(size[2] // 2, 1)):
                inside = tuple(
                    slice(-(-a // step), max(-(-(a + n) // step), -(-a // step) + 1))
                    for a, n, step in zip((z, y, x), size, steps, strict=True)
                )
                values = strided[inside]
                spread = float(np.nanstd(values)) if values.size else 0.0
                if spread > best:
                    best, first = spread, [z, y, x]
    low = (first[0], first[1], first[2])
    return low, (low[0] + size[0], low[1] + size[1], low[2] + size[2])
