"""Layers on the axes of the first one, as the renderer wants them: sheets are shared, so all grids must be parallel.

A grid whose axes are in another order is turned, which changes no sample; flipped ones are taken as they are. Any other
grid is resampled once, at its own resolution along each of the new axes, and kept with its volume. Outside of the
source samples are NaN, which the renderer draws as empty.
"""

from __future__ import annotations

from dataclasses import replace
from itertools import permutations

import numpy as np
from numpy.typing import NDArray

from wavesplat import _native
from wavesplat._model.camera.views import triple
from wavesplat._model.volume import affine, units
from wavesplat._model.volume.forked import drawing
from wavesplat._model.volume.grid import Grid
from wavesplat._model.volume.volume import Volume
from wavesplat._model.volume.wavelet_volume import WaveletVolume
from wavesplat._system.memory import check_room
from wavesplat.errors import ArgumentError

Array = NDArray[np.float64]

#: Largest difference of directions that are the same: affines in files are rounded to float32.
PARALLEL = 1e-6
#: Part of a sample by which a corner may lie beyond the last one without needing another.
BEYOND = 1e-6


def check_units(grids: list[Volume | WaveletVolume]) -> None:
    """Raise an `ArgumentError` for volumes whose worlds have different units of length."""
    known = [grid for grid in grids if grid.unit]
    for grid in known[1:]:
        first = known[0]
        if units.differ(grid.unit, first.unit):
            raise ArgumentError(
                f"the lengths of {first.name!r} are in {first.unit}, the lengths of {grid.name!r} in {grid.unit}; open "
                "one of them with spacing= and unit= of the other"
            )


def is_oblique(grid: Grid, first: Grid) -> bool:
    """Whether the axes of a grid are none of the first one's, in any order."""
    return _order(grid, first) is None


def on_axes_of(volume: Volume | WaveletVolume, first: Grid) -> Volume | WaveletVolume:
    """The volume on axes that are parallel to the axes of another grid, in their order."""
    order = _order(volume, first)
    if order == (0, 1, 2):
        return volume
    samples = volume.to_volume() if isinstance(volume, WaveletVolume) else volume
    kept = volume if isinstance(volume, Volume) else samples
    axes = _directions(first)
    key = axes.tobytes()
    if kept._resampled is None or kept._resampled[0] != key:
        kept._resampled = None  # Before the next one is made: they are large.
        made = _turned(samples, order) if order is not None else _resampled(samples, axes)
        kept._resampled = key, made
    return kept._resampled[1]


def _order(grid: Grid, first: Grid) -> tuple[int, ...] | None:
    """Which axis of a grid lies along each axis of the first one; None where one lies along none."""
    own, wanted = _directions(grid), _directions(first)
    for order in permutations(range(3)):
        turned = own[:, order]
        flips = np.sign((turned * wanted).sum(axis=0))
        if np.linalg.norm(turned - flips * wanted, axis=0).max() <= PARALLEL:
            return order
    return None


def _directions(grid: Grid) -> Array:
    """Unit vectors along the axes, as columns."""
    columns = grid.world_from_index[:3, :3]
    directions: Array = columns / np.linalg.norm(columns, axis=0)
    return directions


def _turned(volume: Volume, order: tuple[int, ...]) -> Volume:
    """The volume with its axes in another order."""
    matrix = np.array(volume.world_from_index)
    matrix[:, :3] = matrix[:, list(order)]
    # Samples are [z, y, x].
    of_array = [2 - axis for axis in reversed(order)]
    samples = volume.samples.transpose(of_array)
    return Volume(samples, world_from_index=matrix, name=volume.name, facts=volume.facts)


def _resampled(volume: Volume, axes: Array) -> Volume:
    """Samples between the samples of a volume, on axes of these directions."""
    index_from_world = np.linalg.inv(volume.world_from_index[:3, :3])
    # The distance along each axis over which the index moves by one sample: the volume's own resolution there.
    steps = 1 / np.linalg.norm(index_from_world @ axes, axis=0)
    corners = affine.box_corners(volume.world_from_index, volume.shape) @ np.linalg.inv(axes).T
    lower, upper = corners.min(axis=0), corners.max(axis=0)
    n_x, n_y, n_z = (int(n) for n in np.ceil((upper - lower) / steps - BEYOND).astype(int) + 1)
    what = f"{volume.name!r} on the axes of the first layer"
    check_room(4 * n_x * n_y * n_z, what, "resample it more coarsely first")
    # The grid reaches as far beyond one end as beyond the other.
    first = (lower + upper) / 2 - steps * (np.array([n_x, n_y, n_z]) - 1) / 2
    matrix = np.eye(4)
    matrix[:3, :3], matrix[:3, 3] = axes * steps, axes @ first
    across, down, through = matrix[:3, :3].T
    samples = np.empty((n_z, n_y, n_x), np.float32)
    with drawing(volume):
        for z in range(n_z):
            samples[z] = _native.plane(
                volume._core,
                origin=triple(matrix[:3, 3] + z * through),
                across=triple(across),
                down=triple(down),
                width=n_x,
                height=n_y,
                kernel="linear",
                slab="maximum",
                n_planes=1,
                step=(0.0, 0.0, 0.0),
                threads=None,
            )
    spacing = " x ".join(f"{step:.4g}" for step in steps)
    how = f"resampled onto the axes of another volume, spacing {spacing}"
    facts = replace(volume.facts, processing=(*volume.facts.processing, how))
    return Volume(samples, world_from_index=matrix, name=volume.name, facts=facts)
