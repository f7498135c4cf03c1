"""Samples of VTK's grids on an image, without the points and cells that their files hide."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import product
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wavesplat._model.volume.map_axes import off_from_even, rounding_of
from wavesplat._readers.file_contents import GridFacts
from wavesplat._readers.request import Request
from wavesplat._readers.vtk.arrays import described_grid, fills_space, world_from_index
from wavesplat._storage import size_checks
from wavesplat.errors import FileError

# Points and cells that VTK's files hide, such as bodies in a flow and cells that a finer grid covers.
#
# An array of bytes says it of each: https://vtk.org/doc/nightly/html/classvtkDataSetAttributes.html, "CellGhostTypes".
# Points and cells that are only copies of another block's are shown.

#: The name of such an array.
GHOSTS = "vtkGhostType"
#: Bits of its bytes: a hidden point, and a cell that is refined or hidden.
HIDDEN_POINT, HIDDEN_CELL = 2, 8 | 32


def without_hidden(
    samples: NDArray[Any], of_points: NDArray[Any] | None, of_cells: NDArray[Any] | None, *, are_cells: bool
) -> tuple[NDArray[Any], tuple[str, ...]]:
    """The samples with NaN where they are hidden, and a sentence on that.

    samples : [z, y, x] of points, or of cells (`are_cells`). of_points, of_cells : ghost types of the same order.
    A point is hidden where all cells around it are.
    """
    hidden = np.zeros(samples.shape, bool)
    if are_cells and of_cells is not None:
        hidden |= (of_cells & HIDDEN_CELL) != 0
    if not are_cells and of_points is not None:
        hidden |= (of_points & HIDDEN_POINT) != 0
    if not are_cells and of_cells is not None:
        is_seen = (of_cells & HIDDEN_CELL) == 0
        touches = np.zeros(samples.shape, bool)
        for steps in product((0, 1), repeat=3):
            near = tuple(slice(step, step + n) for step, n in zip(steps, is_seen.shape, strict=True))
            touches[near] |= is_seen[tuple(slice(part.stop - part.start) for part in _within(near, touches.shape))]
        hidden |= ~touches
    if not hidden.any():
        return samples, ()
    shown = np.where(hidden, np.nan, samples).astype(np.result_type(samples.dtype, np.float32))
    return shown, (f"{hidden.mean():.1%} of the samples are hidden by the file, and nothing is drawn there",)


def _within(parts: tuple[slice, ...], shape: tuple[int, ...]) -> list[slice]:
    """The parts of axes that exist: a layer of points counts as one of cells."""
    return [slice(part.start, min(part.stop, n)) for part, n in zip(parts, shape, strict=True)]


# Samples of VTK's grids on an image: the place of those that are even already, and VTK's sampling of the others.

#: Places of a uniform grid are off by at most this fraction of a step.
TOLERANCE = 1e-4
#: The array in which VTK says whether a sample lies in the grid.
VALID = "vtkValidPointMask"
#: Largest number of cells whose widths are measured to describe what a file holds.
MAX_MEASURED = 2_000_000
#: The array that is sampled.
SAMPLED = "wavesplat"


def n_points(grid: Any) -> tuple[int, int, int]:
    """Points of a structured grid along x, y, z."""
    x, y, z = np.diff(np.reshape(grid.GetExtent(), (3, 2)))[:, 0] + 1
    return int(x), int(y), int(z)


def uniform_place(grid: Any, *, of_cells: bool) -> NDArray[np.float64] | None:
    """The affine from index (x, y, z) to the world of a grid with evenly spaced points; None of another grid."""
    from vtkmodules.util.numpy_support import vtk_to_numpy

    if grid.IsA("vtkImageData"):
        direction = grid.GetDirectionMatrix()
        rows = np.array([[direction.GetElement(i, j) for j in range(3)] for i in range(3)])
        first = np.array(grid.GetExtent())[::2]
        return world_from_index(rows, grid.GetSpacing(), grid.GetOrigin(), first, of_cells=of_cells)
    if grid.IsA("vtkRectilinearGrid"):
        axes = [vtk_to_numpy(getattr(grid, f"Get{axis}Coordinates")()) for axis in "XYZ"]
        found = [off_from_even(axis, TOLERANCE) if len(axis) > 1 else (1.0, 0.0, True) for axis in axes]
        if not all(is_even for _, _, is_even in found):
            return None
        origin = [float(axis[0]) for axis in axes]
        return world_from_index(np.eye(3), [step for step, _, _ in found], origin, (0, 0, 0), of_cells=of_cells)
    if grid.IsA("vtkStructuredGrid"):
        nx, ny, nz = n_points(grid)
        points = vtk_to_numpy(grid.GetPoints().GetData()).reshape(nz, ny, nx, 3)
        # Expected places go by four corners, each of them rounded.
        corners = points[:: max(nz - 1, 1), :: max(ny - 1, 1), :: max(nx - 1, 1)]
        rounding = np.array([2 * rounding_of(corners[..., axis]) for axis in range(3)])
        return _of_points(points.astype(np.float64), rounding, of_cells=of_cells)
    return None


def _of_points(
    points: NDArray[np.float64], rounding: NDArray[np.float64], *, of_cells: bool
) -> NDArray[np.float64] | None:
    """The affine of points [z, y, x] that lie on an even, maybe skewed grid; None of others.

    rounding : the distance along x, y, z by which they may be off since their type is short.
    """
    if min(points.shape[:3]) < 2:
        return None
    origin = points[0, 0, 0]
    ends = points[0, 0, -1], points[0, -1, 0], points[-1, 0, 0]
    steps = np.stack([(end - origin) / (n - 1) for end, n in zip(ends, points.shape[2::-1], strict=True)], axis=1)
    finest = np.linalg.norm(steps, axis=0).min()
    k, j, i = (np.arange(n, dtype=np.float64) for n in points.shape[:3])
    for z in k.astype(int):  # a layer at a time: of all points the places would take as much memory again
        expected = origin + z * steps[:, 2] + j[:, None, None] * steps[:, 1] + i[None, :, None] * steps[:, 0]
        if not (np.abs(points[z] - expected).max(axis=(0, 1)) <= np.maximum(TOLERANCE * finest, rounding)).all():
            return None
    if abs(np.linalg.det(steps)) == 0:
        return None
    return world_from_index(steps, (1, 1, 1), origin, (0, 0, 0), of_cells=of_cells)


def type_of_samples(values: Sequence[NDArray[Any]]) -> type[np.floating[Any]]:
    """The type of floats that the numbers of all blocks are sampled in."""
    # Integers would be interpolated as such; 24 bits hold integers of 16.
    is_wide = any(one.dtype.itemsize > 4 or (one.dtype.kind in "iu" and one.dtype.itemsize == 4) for one in values)
    return np.float64 if is_wide else np.float32


def set_only_array(block: Any, values: NDArray[Any], *, of_cells: bool) -> None:
    """Replace the arrays of a grid, but the arrays of hidden cells, by the one that is sampled.

    VTK samples blocks together only where all of them have it, in one type.
    """
    from vtkmodules.util.numpy_support import numpy_to_vtk

    for part in (block.GetPointData(), block.GetCellData()):
        for name in [part.GetArrayName(number) for number in range(part.GetNumberOfArrays())]:
            if name != GHOSTS:
                part.RemoveArray(name)
    array = numpy_to_vtk(np.ascontiguousarray(values), deep=1)
    array.SetName(SAMPLED)
    (block.GetCellData() if of_cells else block.GetPointData()).AddArray(array)


def check_depth(blocks: list[Any], request: Request) -> None:
    """Raise a `FileError` for grids that are flat, or have no cell that fills space."""
    lengths = _sides(blocks)
    if not (np.isfinite(lengths).all() and (lengths > 0).all()):
        raise FileError(f"the grid is flat, with sides {_numbers(lengths)}; a volume has three: {request.path}")
    if not any(fills_space(block) for block in blocks):
        raise FileError(
            "the cells are surfaces or lines (such as triangles), which have no samples inside; name the volume that "
            f"they were made from: {request.path}"
        )


def facts_of_grid(data: Any, blocks: list[Any]) -> GridFacts:
    """Points, cells and bounds of the grids that a data object is made of."""
    bounds = np.array([block.GetBounds() for block in blocks]).reshape(-1, 3, 2)
    low, high = bounds[..., 0].min(axis=0), bounds[..., 1].max(axis=0)
    n_cells = sum(block.GetNumberOfCells() for block in blocks)
    widths = _cell_sizes(blocks) if n_cells <= MAX_MEASURED else (0.0, 0.0)
    return GridFacts(
        described_grid(data.GetClassName()),
        sum(block.GetNumberOfPoints() for block in blocks),
        n_cells,
        (tuple(low.tolist()), tuple(high.tolist())),
        len(blocks),
        widths if widths[1] > 0 else None,
    )


def _sides(blocks: list[Any]) -> NDArray[np.float64]:
    """Lengths of the box around grids along x, y, z."""
    bounds = np.array([block.GetBounds() for block in blocks]).reshape(-1, 3, 2)
    sides: NDArray[np.float64] = bounds[..., 1].max(axis=0) - bounds[..., 0].min(axis=0)
    return sides


def sampled_on_image(data: Any, blocks: list[Any], request: Request) -> tuple[NDArray[Any], NDArray[np.float64], str]:
    """Samples [z, y, x, component] on an image that covers a grid, NaN outside; its affine; and the cost, in words."""
    from vtkmodules.util.numpy_support import vtk_to_numpy
    from vtkmodules.vtkFiltersCore import vtkResampleToImage

    lengths = _sides(blocks)
    step = lengths.max() / ((request.resample or 2) - 1)
    size = [max(2, round(length / step) + 1) for length in lengths]
    # The sampling, its mask and a copy.
    n = _n_components(blocks)
    size_checks.check_memory((2 * n + 1) * size_checks.n_bytes(size, np.dtype("f4")), request.path)
    sampler = vtkResampleToImage()
    sampler.SetInputDataObject(data)
    sampler.SetUseInputBounds(True)
    sampler.SetSamplingDimensions(*size)
    sampler.Update()
    image = sampler.GetOutput()
    points = image.GetPointData()
    values, valid = points.GetArray(SAMPLED), points.GetArray(VALID)
    if values is None or valid is None:
        raise FileError(f"VTK could not sample the grid; sample it with ParaView, and write .vti: {request.path}")
    shape = tuple(size[::-1])
    samples = vtk_to_numpy(values).reshape(*shape, -1).copy()
    is_inside = vtk_to_numpy(valid).reshape(shape) != 0
    if not is_inside.any():
        raise FileError(
            f"VTK finds no cell around any of {is_inside.size} samples; give a larger resample=N, or split its cells "
            f"into tetrahedra, as pyvista.read(path).triangulate() does: {request.path}"
        )
    samples[~is_inside] = np.nan
    matrix = world_from_index(np.eye(3), image.GetSpacing(), image.GetOrigin(), (0, 0, 0), of_cells=False)
    outside = 1 - float(is_inside.mean())
    guess = f"sampled at {' x '.join(map(str, size))} places, {_numbers(image.GetSpacing())} apart"
    smallest, largest = _cell_sizes(blocks)
    cells = f"cells are {smallest:.3g} to {largest:.3g} wide; " if largest > 0 else ""
    return samples, matrix, f"{guess}; {cells}{outside:.1%} of the samples lie outside of it"


def _n_components(blocks: list[Any]) -> int:
    """Components of the array that is sampled."""
    parts = [part for block in blocks for part in (block.GetPointData(), block.GetCellData())]
    found = [array.GetNumberOfComponents() for part in parts if (array := part.GetArray(SAMPLED)) is not None]
    return int(max(found, default=1))


def _cell_sizes(blocks: list[Any]) -> tuple[float, float]:
    """The smallest and the largest width of cells, the cube root of their volumes; zeros without such cells."""
    from vtkmodules.util.numpy_support import vtk_to_numpy
    from vtkmodules.vtkFiltersVerdict import vtkCellSizeFilter

    found = []
    for block in blocks:
        sizes = vtkCellSizeFilter()
        sizes.SetInputDataObject(block)
        sizes.ComputeVolumeOn()
        for unused in (sizes.ComputeAreaOff, sizes.ComputeLengthOff, sizes.ComputeVertexCountOff):
            unused()
        sizes.Update()
        volumes = vtk_to_numpy(sizes.GetOutput().GetCellData().GetArray("Volume"))
        volumes = np.abs(volumes[volumes != 0])  # volumes of left-handed cells are negative
        found += [volumes.min(), volumes.max()] if len(volumes) else []
    return (float(np.cbrt(min(found))), float(np.cbrt(max(found)))) if found else (0.0, 0.0)


def _numbers(values: Any) -> str:
    return " x ".join(f"{value:.4g}" for value in values)
