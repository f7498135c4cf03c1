"""Making of lazy volumes, and parts of them that are read as a whole."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from os import PathLike
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from wavesplat import _native
from wavesplat._model.arguments.clips import Crop
from wavesplat._model.arguments.types import text_of
from wavesplat._model.lazy.array import lazy_array
from wavesplat._model.lazy.lazy_array import LazyArray
from wavesplat._model.lazy.read_ahead import BoxReader, n_in
from wavesplat._model.lazy.survey import ShownPart
from wavesplat._model.lazy.volume import LazyVolume, lazily
from wavesplat._model.volume import affine
from wavesplat._model.volume.facts import Facts
from wavesplat._model.volume.stack import Box
from wavesplat._model.volume.volume import Volume, _checked_affine, _checked_facts, _with_guesses
from wavesplat._storage.paths import printable
from wavesplat._system.memory import check_room
from wavesplat.errors import ArgumentError

if TYPE_CHECKING:
    from wavesplat._model.lazy.survey import Survey
    from wavesplat._model.lazy.volume import Level
    from wavesplat._model.volume.grid import Grid

# Lazy volumes from arrays of other libraries: their place, and the places of their levels.

Matrix = NDArray[np.float64]


def lazy_volume(
    samples: object,
    *,
    place: tuple[Sequence[float] | None, Any],
    given: tuple[str | None, bool | None, str | None, Facts | None],
    memory: float | str | None,
    level: int | None,
    keep: bool | str | PathLike[str],
    holes: bool,
) -> LazyVolume:
    """See `Volume.lazy`."""
    if isinstance(samples, LazyVolume):
        raise ArgumentError("this is a lazy volume already; change it with with_memory or at_level")
    (spacing, matrix), (unit, anatomical, given_name, given_facts) = place, given
    found = lazy_array(samples, has_place=spacing is not None or matrix is not None)
    name = printable((found.name or "volume") if given_name is None else text_of(given_name, "name of the volume"))
    own = found.world_from_index
    if spacing is None and matrix is None and own:
        matrices, known = [_checked_affine(None, one, name) for one in own], found.facts
    else:
        first = _checked_affine(spacing, matrix, name)
        if spacing is not None:
            first = first @ np.diag([*found.directions, 1.0])
        known = (
            found.facts if spacing is None and matrix is None else replace(found.facts, unit=None, is_anatomical=False)
        )
        matrices = [first, *(_spread(first, found.levels[0], coarser, name) for coarser in found.levels[1:])]
    facts = known if given_facts is None else _with_guesses(given_facts, known.guesses, name)
    if len(matrices) > 1 and not own:
        guess = "place of the coarser levels: they fill the same box as the finest, from the outer faces of its samples"
        facts = replace(facts, guesses=(*facts.guesses, guess))
    return lazily(
        found.levels,
        matrices,
        name,
        _checked_facts(facts, unit, anatomical, name),
        memory=memory,
        level=level,
        keep=keep,
        holes=holes,
    )


def _spread(finest: Matrix, fine: LazyArray, coarse: LazyArray, name: str) -> Matrix:
    """Affine of a coarser level that fills the same box: its samples lie in the middle of blocks of the finer one."""
    matrix = finest.copy()
    for axis, (n, m) in enumerate(zip(reversed(fine.shape), reversed(coarse.shape), strict=True)):
        if m > n:
            raise ArgumentError(
                f"volume {name!r}: a level of shape {coarse.shape} follows one of {fine.shape}; give the finest first"
            )
        # Sizes of levels are rounded: the whole factor is meant where it fits to within a sample of the coarser one.
        factor = round(n / m) if abs(n / m - round(n / m)) * m < 1 + 1e-9 else n / m
        matrix[:3, axis] = finest[:3, axis] * factor
        matrix[:3, 3] += finest[:3, axis] * (factor - 1) / 2
    return matrix


# Parts of lazy volumes that are read as a whole: boxes, overviews, and samples to match the brightness of levels.

#: Samples of a finer level from which its brightness is learnt, and the ratio of its spacing, both at most.
MAX_PART, MAX_FINER = 1 << 22, 4.5
#: Least side of a box that is looked for in all of a level, samples.
MIN_SIDE = 16
#: About how many samples of the finest level are compared with neighbours, to find noise and labels.
N_BUSIEST = 1 << 18
#: Samples of a level that is read as a whole whatever is cropped, at most; and samples around a crop that are read with
#: it: kernels reach 3, differences of gradients 1, and missing samples are filled from 16.
MIN_CROPPED, AROUND_CROP = 1 << 21, 20
#: Samples of a level that is read as a whole for looks, cameras and previews, at most.
MAX_OVERVIEW = 1 << 24


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
    check_room(n_in(box) * array.dtype.itemsize, "the samples", "read a smaller box, or a coarser level")
    with BoxReader([array]) as reader:
        return reader.begin(0, box, [box]).result()


def _index_box(volume: LazyVolume, level: Level, crop: Crop) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """First and last index (x, y, z) of a box in the samples of a level, not rounded."""
    inside = affine.transformed(np.linalg.inv(level.world_from_index), corners_of_crop(volume, crop))
    return inside.min(axis=0), inside.max(axis=0)


def corners_of_crop(volume: Grid, crop: Crop) -> NDArray[np.float64]:
    """The eight corners of a crop in the world, which may be given in the samples of a volume."""
    lower, upper = np.asarray(crop.lower, np.float64), np.asarray(crop.upper, np.float64)
    corners = np.stack([np.where([(k >> a) & 1 for a in range(3)], upper, lower) for k in range(8)])
    return corners if crop.space == "world" else affine.transformed(volume.world_from_index, corners)


def box_of_crop(volume: LazyVolume, number: int, corners: NDArray[np.float64] | None) -> Box | None:
    """The only box of a level that is read where a crop hides the rest, along the borders of chunks.

    None where all is read: there is no crop, the level is small, no coarser one covers the rest, or the box has more
    than half of its samples. It depends on sizes alone, so that a picture does not depend on earlier ones.

    corners : the corners of the crop in the world, shape (8, 3).
    """
    level, shape = volume._levels[number], volume._levels[number].array.shape
    if corners is None or volume._surveyed_level() <= number or math.prod(shape) <= MIN_CROPPED:
        return None
    index = affine.transformed(np.linalg.inv(level.world_from_index), corners)[:, ::-1]
    first, end = index.min(axis=0) - AROUND_CROP, index.max(axis=0) + AROUND_CROP + 1
    low, high = [], []
    for n, chunk, a, b in zip(shape, level.array.chunks, first.tolist(), end.tolist(), strict=True):
        low.append(min(max(0, math.floor(a)), n - 1) // chunk * chunk)
        high.append(min(n, -(-max(1, math.ceil(b)) // chunk) * chunk))
    size = [b - a for a, b in zip(low, high, strict=True)]
    if min(size) <= 0 or 2 * math.prod(size) > math.prod(shape):
        return None
    return (low[0], low[1], low[2]), (high[0], high[1], high[2])


def shown_part(volume: LazyVolume, number: int, box: Box) -> ShownPart:
    """A box of a level that is read, and the rest by the level that looks are made from."""
    level, coarse = volume._levels[number], volume._surveyed_level()
    value_range = volume.value_range
    steps = _native.light_step(level.array.shape, level.world_from_index)
    light = nearest_every(volume, volume._levels[coarse], coarse, steps, of=level).astype(np.float32)
    return ShownPart(box, value_range, np.nan_to_num(light, nan=value_range[0], posinf=0.0, neginf=0.0))


def nearest_every(
    volume: LazyVolume, level: Level, number: int, steps: Sequence[int], *, of: Level | None = None
) -> NDArray[Any]:
    """The sample of a level nearest to every n-th sample of a finer one, [z, y, x].

    steps : between the samples along z, y, x. of : the finer level; None is the finest.
    """
    finer = of or volume._levels[0]
    between = np.linalg.inv(level.world_from_index) @ finer.world_from_index
    places = []
    for axis, (n, step) in enumerate(zip(finer.array.shape, steps, strict=True)):
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


def level_in_finest(volume: LazyVolume, number: int, box: Box | None) -> tuple[Any, Any, Any] | None:
    """Place of a level in the finest one, and the same box of it and of a finer one, to match their brightness.

    box : the only part of the level that is read for a picture, as `box_of_crop` has it.
    """
    if number == 0:
        return None
    survey = volume.survey(number, "linear", box)
    levels, value_range = volume._levels, survey.value_range
    finest, own = levels[0], levels[number]
    # The finest level within the ratio: reading a finer one costs more than it adds.
    ratios = [max(a / b for a, b in zip(own.spacing, finer.spacing, strict=True)) for finer in levels[:number]]
    fitting = [k for k, ratio in enumerate(ratios) if ratio <= MAX_FINER]
    place = fitting[0] if fitting else number - 1
    finer = levels[place]
    coarse_box = _busiest(own.array.shape, survey, MAX_PART / _ratio(own, finer))
    coarse = read_box(volume.arrays(number), coarse_box)
    fine_box = _same_box(coarse_box, own, finer)
    fine = read_box(volume.arrays(place), fine_box)
    low_value = min(value_range[0], float(np.nanmin(fine)))
    high_value = max(value_range[1], float(np.nanmax(fine)))
    known = (finer.world_from_index, (_finite(fine), fine_box[0]), (_finite(coarse), coarse_box[0]))
    return finest.array.shape, finest.world_from_index, (*known, (low_value, high_value))


def busiest_part(volume: LazyVolume, number: int) -> NDArray[Any]:
    """Samples of the finest level, [z, y, x], side by side, where the values of a coarser one vary most."""
    own, finest = volume._levels[number], volume._levels[0]
    side = max(4, int((N_BUSIEST / _ratio(own, finest)) ** (1 / 3)))
    box = _busiest(own.array.shape, volume.survey(number, "linear"), max(side, MIN_SIDE) ** 3)
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


def _busiest(shape: Sequence[int], survey: Survey, most: float) -> Box:
    """A box of about `most` samples of a level of this shape, where the values that its survey kept vary most."""
    side = max(MIN_SIDE, int(round(most ** (1 / 3), 6)))
    size = [min(n, side) for n in shape]
    steps, strided = survey.finest()
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
