"""Levels of an adaptive mesh on the even grid of one of them: boxes of cells, each of one level, over coarser ones.

That is the covering grid of yt: cells of the level itself are exact, coarser ones are repeated, and finer ones are left
out where the level has cells of its own below them, else averaged. Format: "Overlapping AMR" of the VTK XML formats.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wavesplat._readers.request import Request
from wavesplat._readers.vtk.arrays import world_from_index
from wavesplat._storage import size_checks
from wavesplat.errors import FileError

#: Boxes begin at cells of their level, but for this fraction of one.
TOLERANCE = 1e-3


@dataclass(frozen=True)
class Box:
    """A box of cells of a level: its lowest corner, sides of a cell, and cells along x, y, z."""

    level: int
    origin: NDArray[np.float64]
    spacing: NDArray[np.float64]
    n: NDArray[np.int64]
    grid: Any


def boxes_of(data: Any) -> list[Box] | None:
    """The boxes of a data object's levels, coarse ones first; None where it is no adaptive mesh of even boxes."""
    if not data.IsA("vtkUniformGridAMR") and not data.IsA("vtkAMRDataObject"):
        return None
    found = list(_grids(data))
    if not found or not all(grid.IsA("vtkImageData") for _, grid in found):
        return None
    boxes = []
    for level, grid in found:
        extent = np.reshape(grid.GetExtent(), (3, 2))
        spacing = np.array(grid.GetSpacing(), np.float64)
        origin = np.array(grid.GetOrigin(), np.float64) + extent[:, 0] * spacing
        boxes.append(Box(level, origin, spacing, (extent[:, 1] - extent[:, 0]).astype(np.int64), grid))
    return sorted(boxes, key=lambda box: box.level)


def _grids(data: Any) -> Iterator[tuple[int, Any]]:
    iterator = data.NewIterator()
    iterator.InitTraversal()
    while not iterator.IsDoneWithTraversal():
        grid = iterator.GetCurrentDataObject()
        if grid is not None and grid.GetNumberOfCells() > 0:
            yield iterator.GetCurrentLevel(), grid
        iterator.GoToNextItem()


def sizes_of(boxes: Sequence[Box]) -> dict[int, NDArray[np.int64]]:
    """Cells along x, y, z of the whole mesh at the spacing of each level."""
    low, high = _corners(boxes)
    return {box.level: np.maximum(1, np.rint((high - low) / box.spacing).astype(np.int64)) for box in boxes}


def _corners(boxes: Sequence[Box]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    low = np.min([box.origin for box in boxes], axis=0)
    return low, np.max([box.origin + box.n * box.spacing for box in boxes], axis=0)


def on_one_grid(
    boxes: Sequence[Box], values_of: Callable[[Any], NDArray[Any] | None], request: Request
) -> tuple[NDArray[Any], NDArray[np.float64], str]:
    """Samples at the spacing of a level, NaN where there is no cell; their affine; and what it cost, in words.

    The level is the finest with at most as many samples along its longest side as the user asks for, else the coarsest.
    values_of : numbers of a grid's cells, x fastest; None of a grid without.
    """
    sizes = sizes_of(boxes)
    fitting = [level for level, size in sizes.items() if size.max() <= (request.resample or 0)]
    level = max(fitting, default=min(sizes))
    size = sizes[level]
    spacing = next(box.spacing for box in boxes if box.level == level)
    low, _ = _corners(boxes)
    # Samples, their levels, and a copy while finer ones are averaged.
    size_checks.check_memory(3 * size_checks.n_bytes(size.tolist(), np.dtype("f8")), request.path)
    samples, of_level = np.full(size[::-1], np.nan), np.full(size[::-1], -1, np.int16)
    finer_sum: NDArray[np.float64] = np.zeros(0)
    finer_n: NDArray[np.int64] = np.zeros(0, np.int64)
    kinds = set()
    for box in boxes:
        values = values_of(box.grid)
        if values is None:
            continue
        kinds.add(values.dtype)
        values = values.reshape(box.n[::-1])
        first, ratio = _place(box, low, spacing, request)
        if box.level <= level:
            there, repeated = _repeated(values, first, ratio, size)
            samples[there], of_level[there] = repeated, box.level
        else:
            if not finer_n.size:
                finer_sum, finer_n = np.zeros(samples.shape), np.zeros(samples.shape, np.int64)
            _add_finer(values, first, ratio, (finer_sum, finer_n))
    if finer_n.size:
        is_open = (of_level < 0) & (finer_n > 0)
        samples[is_open], of_level[is_open] = finer_sum[is_open] / finer_n[is_open], level
    if kinds <= {np.dtype("f4"), np.dtype("i2"), np.dtype("u2"), np.dtype("i1"), np.dtype("u1")}:
        samples = samples.astype(np.float32)
    matrix = world_from_index(np.eye(3), spacing, low, (0, 0, 0), of_cells=True)
    n_cells = sum(int(np.prod(box.n)) for box in boxes)
    shares = f"{(of_level == level).mean():.1%} of them are of this level"
    coarser = ((of_level >= 0) & (of_level < level)).mean()
    guess = (
        f"on the grid of level {level} of {min(sizes)} to {max(sizes)}, {' x '.join(map(str, size))} samples for "
        f"{n_cells} cells, {' x '.join(f'{step:.4g}' for step in spacing)} apart: {shares}, "
        f"{coarser:.1%} repeat coarser cells, {(of_level < 0).mean():.1%} lie outside"
    )
    return samples, matrix, guess


def _place(
    box: Box, low: NDArray[np.float64], spacing: NDArray[np.float64], request: Request
) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
    """The box's first cell, counted in its own cells from the mesh's corner, and its cells' sides in the grid's."""
    ratio = box.spacing / spacing
    whole = np.where(ratio >= 1, ratio, 1 / ratio)
    first = (box.origin - low) / box.spacing
    off = max(np.abs(first - np.rint(first)).max(), np.abs(whole - np.rint(whole)).max())
    if not off <= TOLERANCE:
        raise FileError(
            f"a box of level {box.level} does not begin at a cell of the other levels, or its cells are no whole parts "
            f"of theirs; sample it with ParaView (Resample To Image), and write .vti: {request.path}"
        )
    return np.rint(first).astype(np.int64), ratio


def _repeated(
    values: NDArray[Any], first: NDArray[np.int64], ratio: NDArray[np.float64], size: NDArray[np.int64]
) -> tuple[tuple[slice, ...], NDArray[Any]]:
    """Where the cells of a coarser box, or one of the level itself, lie in the grid, and their values there."""
    there = []
    for axis, (begin, times, n) in enumerate(zip(first, np.rint(ratio).astype(int), size, strict=True)):
        number = 2 - axis  # of the samples' axis: z, y, x
        values = np.repeat(values, times, axis=number)
        start = int(begin * times)
        kept = max(0, min(values.shape[number], int(n) - start))
        values = values.take(range(kept), axis=number) if kept < values.shape[number] else values
        there.append(slice(start, start + kept))
    return tuple(there[::-1]), values


def _add_finer(
    values: NDArray[Any],
    first: NDArray[np.int64],
    ratio: NDArray[np.float64],
    sums: tuple[NDArray[np.float64], NDArray[np.int64]],
) -> None:
    """Add the cells of a finer box to sums and counts of the grid's cells that they lie in."""
    counts = np.ones(values.shape, np.int64)
    values, there = values.astype(np.float64), []
    for axis, (begin, times) in enumerate(zip(first, np.rint(1 / ratio).astype(int), strict=True)):
        number = 2 - axis
        cells = (int(begin) + np.arange(values.shape[number])) // times
        starts = np.flatnonzero(np.diff(cells, prepend=cells[0] - 1))
        values, counts = (np.add.reduceat(part, starts, axis=number) for part in (values, counts))
        there.append(slice(int(cells[0]), int(cells[-1]) + 1))
    place = tuple(there[::-1])
    inside = tuple(slice(0, max(0, n - at.start)) for at, n in zip(place, sums[0].shape, strict=True))
    sums[0][place] += values[inside]
    sums[1][place] += counts[inside]
