"""The part of a lazy volume that a slice is made of: the box around its planes, of the level that its pixels need."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from wavesplat._model.lazy.parts import read_box
from wavesplat._model.lazy.volume import LazyVolume, Level
from wavesplat._model.volume.stack import Box
from wavesplat._model.volume.volume import Volume
from wavesplat._system.memory import byte_size
from wavesplat.errors import LimitError

#: Samples that kernels reach beyond a plane, coefficients of B-splines included.
MARGIN = 20


def part_around(volume: LazyVolume, corners: NDArray[np.float64], pixel: float) -> Volume | None:
    """The samples around the hull of world positions (x, y, z), a row each; None where none lies there.

    pixel : distance of pixels, world units.

    Raises
    ------
    LimitError
        If no level's part fits into the volume's memory.
    """
    wanted = volume.level_for(lambda level: pixel / min(level.spacing))
    needed = 0
    for number in range(wanted, len(volume.levels)):
        level = volume._levels[number]
        box = _box(level, corners)
        if box is None:
            return None
        needed = math.prod(b - a for a, b in zip(*box, strict=True)) * level.array.dtype.itemsize
        if needed <= volume.memory:
            matrix = level.world_from_index.copy()
            matrix[:3, 3] += matrix[:3, :3] @ np.array(box[0][::-1], np.float64)
            samples = read_box(level.array, box)
            return Volume(samples, world_from_index=matrix, name=volume.name, facts=volume.facts)
        if volume.level is not None:
            break
    raise LimitError(
        f"this slice of {volume.name!r} is made of {byte_size(needed)}, and its memory is "
        f"{byte_size(volume.memory)}; cut along an axis, give it more with with_memory, or a coarser level"
    )


def _box(level: Level, corners: NDArray[np.float64]) -> Box | None:
    inverse = np.linalg.inv(level.world_from_index)
    index = corners @ inverse[:3, :3].T + inverse[:3, 3]
    low, high = [], []
    for axis, n in enumerate(level.array.shape):
        first, last = float(index[:, 2 - axis].min()), float(index[:, 2 - axis].max())
        if last < -1 or first > n:
            return None
        a = min(max(math.floor(first) - MARGIN, 0), n - 2)
        low.append(a)
        high.append(max(min(math.ceil(last) + MARGIN + 1, n), a + 2))
    return (low[0], low[1], low[2]), (high[0], high[1], high[2])
