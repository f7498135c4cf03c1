"""Opacity of a voxel in looks that are chosen for a volume: a few voxels of its largest values are opaque.

A voxel is as long as the geometric mean of the spacings, the unit of a transfer function without one. It is the only
length of the data that a crop, a padded copy and a stack of more slices share, so the same matter looks the same in all
of them. The size of the box is none: a ball in a box eight times as large was half as bright. Nor is the thickness of
structures, which a crop to one object changes. A microscope's voxel is fitted to what it resolves, so that the finest
structures are some voxels thick, and are seen.

Boxes that are thinner than these few voxels are opaque through their whole thickness, as their maximum projection is.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from wavesplat._model.grid import Grid

#: Voxels of the largest values that are opaque together. (With 3 a stack of 14 slices is about as bright as its maximum
#: projection; docs/design/022 has the numbers.)
N_OPAQUE = 3.0
#: Opacity that counts as opaque.
OPAQUE = 0.995


def opaque_after(grid: Grid) -> float:
    """Number of voxels of the largest values that are opaque together: `N_OPAQUE`, or what a thinner box has."""
    # By logarithms, since the product of tiny spacings is 0.
    voxel = math.exp(sum(map(math.log, grid.spacing)) / 3)
    thickness = min(n * step for n, step in zip(grid.shape, reversed(grid.spacing), strict=True)) / voxel
    return min(N_OPAQUE, thickness)


def opacity_of_voxel(opacity: float, n_voxels: float) -> float:
    """Opacity of one voxel, of which `n_voxels` together have `opacity`."""
    return 1.0 - math.pow(1.0 - min(opacity, 0.9999), 1.0 / n_voxels)


def rising(places: NDArray[np.float64], n_voxels: float) -> NDArray[np.float64]:
    """Opacity of a voxel at places in a window, 0..1: extinction rises with the square of the place.

    n_voxels : voxels at place 1 that are opaque together.
    """
    return np.asarray(-np.expm1(np.log1p(-OPAQUE) / n_voxels * places**2))
