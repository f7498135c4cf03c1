"""Volumes of a few slices, such as two frames of a CT, and thin stacks: both are seen from their front."""

from __future__ import annotations

import numpy as np

from wavesplat._model.grid import Grid

#: Largest number of slices, and least number of samples along their sides.
FEW, WIDE = 4, 16
#: Largest ratio of the thinnest side to the second one of a thin stack, which is seen along its thin side.
THIN = 0.3
#: Least ratio of the distances of samples, across slices and within them, of a stack that is seen along it. (Confocal
#: stacks: 4; electron microscopy of sections: 10.)
COARSE = 3.0


def axis_of_distant_slices(grid: Grid) -> int | None:
    """The world's axis (0 is x) along which samples are far apart, so that other planes are blurred; else None."""
    if max(grid.spacing) < COARSE * np.sort(grid.spacing)[1]:
        return None
    return int(np.argmax(np.abs(grid.world_from_index[:3, int(np.argmax(grid.spacing))])))


def is_thin(grid: Grid) -> bool:
    """Whether a volume is a thin stack."""
    thinnest, second, _ = np.sort(np.ptp(grid.bounds, axis=0))
    return bool(thinnest < THIN * second)


def axis_of_few_slices(grid: Grid) -> int | None:
    """The world's axis (0 is x) along which a volume has a few slices; None where it has more, or is small."""
    _, second, _ = sorted(grid.shape)
    across = int(np.argmin(grid.shape))  # of z, y, x
    if grid.shape[across] > FEW or second < WIDE:
        return None
    return int(np.argmax(np.abs(grid.world_from_index[:3, 2 - across])))
