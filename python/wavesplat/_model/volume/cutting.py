"""Boxes taken out of a volume, so that one looks into it.

A sample whose centre lies inside a box becomes NaN, in a copy of the samples; the renderer draws nothing between a NaN
and its neighbours, so what is drawn ends at the last samples that are not inside: on the box's face where that lies on
samples, and less than a sample outside of it elsewhere. A box at right angles to the volume's axes makes flat faces,
any other one stairs as high as a sample.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from wavesplat._model.arguments.clips import Crop
from wavesplat._model.volume.grid import Grid
from wavesplat._model.volume.volume import Volume
from wavesplat.errors import ArgumentError

Boxes: TypeAlias = tuple[Crop, ...]

#: Tolerance within which a sample lies on a face, in samples: affines in files are rounded to float32.
ON_FACE = 1e-5


def in_samples_of(grid: Grid, boxes: Boxes, first: Grid) -> Boxes:
    """The boxes for `grid`: boxes in samples of `first` become boxes in its own samples, boxes in the world stay."""
    if grid is first or all(box.space == "world" for box in boxes):
        return boxes
    index_from_first = np.linalg.inv(grid.world_from_index) @ first.world_from_index
    turn, offset = index_from_first[:3, :3], index_from_first[:3, 3]
    if np.count_nonzero(np.abs(turn) > ON_FACE * np.abs(turn).max()) != 3:
        raise ArgumentError(
            f"CutOut is given in samples of {first.name!r}, but the axes of {grid.name!r} have other directions; "
            "give the box in the world"
        )
    return tuple(
        box
        if box.space == "world"
        else Crop(turn @ np.array(box.lower) + offset, turn @ np.array(box.upper) + offset, space="index")
        for box in boxes
    )


def without(volume: Volume, boxes: Boxes) -> Volume:
    """The volume with NaN in the boxes, as float32 or, of 32-bit integers and float64, as float64.

    It is cached with the volume until other boxes are asked for, so that the frames of a turn share it.

    Raises
    ------
    ArgumentError
        If no finite sample is left.
    """
    if not boxes:
        return volume
    if volume._cut is not None and volume._cut[0] == boxes:
        return volume._cut[1]
    volume._cut = None  # Before the next one is made: they are large.
    out = taken_out(volume, boxes)
    samples = volume.samples.astype(np.result_type(volume.dtype, np.float32))
    samples[out] = np.nan
    if not np.isfinite(samples).any():
        raise ArgumentError(f"CutOut leaves nothing of volume {volume.name!r}; its bounds are {_bounds(volume)}")
    cut = Volume(samples, world_from_index=volume.world_from_index, name=volume.name, facts=volume.facts)
    volume._cut = boxes, cut
    return cut


def taken_out(grid: Grid, boxes: Sequence[Crop]) -> NDArray[np.bool_]:
    """Whether each sample of a grid is taken out, shape (z, y, x)."""
    out = np.zeros(grid.shape, dtype=bool)
    for box in boxes:
        _mark(out, grid, box)
    _mark_lone(out)
    return out


def _mark(out: NDArray[np.bool_], grid: Grid, box: Crop) -> None:
    lower, upper = np.sort([box.lower, box.upper], axis=0)
    matrix, offset = grid.world_from_index[:3, :3], grid.world_from_index[:3, 3]
    if box.space == "world":
        corners = np.stack([np.where([(k >> axis) & 1 for axis in range(3)], upper, lower) for k in range(8)])
        index = (corners - offset) @ np.linalg.inv(matrix).T
        first, last = index.min(axis=0), index.max(axis=0)
    else:
        first, last = lower, upper
    n = np.array(grid.shape[::-1])
    begin = np.clip(np.floor(first + ON_FACE) + 1, 0, n).astype(int)
    end = np.clip(np.ceil(last - ON_FACE), begin, n).astype(int)
    part = out[tuple(slice(a, b) for a, b in zip(begin[::-1], end[::-1], strict=True))]
    # Along the volume's own axes the box is a block of samples.
    if box.space == "index" or (np.count_nonzero(matrix) == 3 and part.size):
        part[...] = True
        return
    x, y, z = (np.arange(a, b) for a, b in zip(begin, end, strict=True))
    near = ON_FACE * min(grid.spacing)
    for k in range(len(z)):
        inside = np.ones(part.shape[1:], dtype=bool)
        for axis, (across, down, through) in enumerate(matrix):
            world = (across * x)[None, :] + (down * y)[:, None] + (through * z[k] + offset[axis])
            inside &= (world > lower[axis] + near) & (world < upper[axis] - near)
        part[k] |= inside


def _mark_lone(out: NDArray[np.bool_]) -> None:
    """Mark also samples that have no neighbour left on either side along an axis.

    Nothing is drawn between them and their neighbours, but a sheet that runs through them would show them: samples
    on the volume's face, and samples on a face that two boxes share.
    """
    for axis in range(3):
        along = np.moveaxis(out, axis, 0)
        n = len(along)
        before = along[0].copy()  # the sample before, before it was marked
        along[0] |= along[1]
        for k in range(1, n):
            now = along[k].copy()
            along[k] |= before if k == n - 1 else before & along[k + 1]
            before = now


def _bounds(volume: Volume) -> str:
    lower, upper = (", ".join(f"{number:.4g}" for number in corner) for corner in volume.bounds)
    return f"({lower}) to ({upper})"
