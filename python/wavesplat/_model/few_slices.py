"""Volumes of a few slices, such as two frames of a CT: too thin for translucent looks, and seen from their front."""

from __future__ import annotations

import numpy as np

from wavesplat._model.grid import Grid

__all__ = ["axis_of_few_slices"]

#: Largest number of slices, and least number of samples along their sides.
FEW, WIDE = 4, 16


def axis_of_few_slices(grid: Grid) -> int | None:
    """The world's axis (0 is x) along which a volume has a few slices; None where it has more, or is small."""
    _, second, _ = sorted(grid.shape)
    across = int(np.argmin(grid.shape))  # of z, y, x
    if grid.shape[across] > FEW or second < WIDE:
        return None
    return int(np.argmax(np.abs(grid.world_from_index[:3, 2 - across])))
