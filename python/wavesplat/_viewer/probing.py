"""Samples of volumes at world points."""

from __future__ import annotations

from typing import Any

import numpy as np

from wavesplat._model.lazy_volume import LazyVolume
from wavesplat._model.volume import Volume


def value_at(volume: Volume, place: tuple[int, int, int]) -> float:
    """The value of the sample with an index [z, y, x]."""
    if isinstance(volume, LazyVolume):
        z, y, x = place
        return float(volume.arrays(0).read(place, (z + 1, y + 1, x + 1))[0, 0, 0])
    return float(volume.samples[place])


def sample_at(world_from_index: Any, shape: tuple[int, ...], point: Any) -> tuple[int, int, int] | None:
    """The index [z, y, x] of the sample nearest to a point; None outside."""
    matrix = np.linalg.inv(world_from_index)
    index = np.rint(matrix[:3, :3] @ point + matrix[:3, 3])[::-1]
    if not all(0 <= at < n for at, n in zip(index, shape, strict=True)):
        return None  # also what is beyond whole numbers
    z, y, x = (int(at) for at in index)
    return z, y, x
