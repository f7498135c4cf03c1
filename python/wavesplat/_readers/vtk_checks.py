"""Checks of grids that VTK has read: it does not look, and what is wrong in them ends the process later."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

#: VTK's number of a type of cells -> their points, of those that have a fixed number (vtkCellType.h).
POINTS_OF = {1: 1, 3: 2, 5: 3, 8: 4, 9: 4, 10: 4, 11: 8, 12: 8, 13: 6, 14: 5, 15: 10, 16: 12, 21: 3, 22: 6, 23: 8} | {
    24: 10,
    25: 20,
    26: 15,
    27: 13,
    28: 9,
    29: 27,
    30: 6,
    31: 12,
    32: 18,
    33: 24,
    34: 7,
    35: 4,
    37: 19,
}
#: Types of as many points as they like.
ANY_NUMBER = (0, 2, 4, 6, 7, 36, 41, 42, *range(68, 82))
#: Types of cells that fill space: straight, quadratic, of any number of faces, and of higher orders.
SOLID = (*range(10, 17), *range(24, 28), 29, *range(31, 34), 37, 41, 42, *range(64, 68), *range(71, 75), *range(78, 82))


def fills_space(grid: Any) -> bool:
    """Whether a grid that was checked has a cell that fills space; surfaces and lines have no samples inside."""
    from vtkmodules.util.numpy_support import vtk_to_numpy

    if not grid.IsA("vtkUnstructuredGrid"):
        return not grid.IsA("vtkPolyData")
    return grid.GetNumberOfCells() > 0 and bool(np.isin(vtk_to_numpy(_types_of(grid)), SOLID).any())


def check_grid(grid: Any) -> None:
    """Raise a `ValueError` for a grid whose points, cells and arrays do not fit each other."""
    n_points, n_cells = grid.GetNumberOfPoints(), grid.GetNumberOfCells()
    for part, n in ((grid.GetPointData(), n_points), (grid.GetCellData(), n_cells)):
        for number in range(part.GetNumberOfArrays()):
            array = part.GetAbstractArray(number)
            if array.GetNumberOfTuples() != n:
                raise ValueError(f"the array {array.GetName()!r} has {array.GetNumberOfTuples()} places of {n}")
    if grid.IsA("vtkStructuredGrid") or grid.IsA("vtkRectilinearGrid"):
        sides = np.diff(np.reshape(grid.GetExtent(), (3, 2)))[:, 0] + 1
        if grid.IsA("vtkStructuredGrid"):
            fits = grid.GetPoints() is not None and grid.GetPoints().GetNumberOfPoints() == np.prod(sides)
        else:
            axes = [getattr(grid, f"Get{axis}Coordinates")() for axis in "XYZ"]
            fits = [0 if axis is None else axis.GetNumberOfTuples() for axis in axes] == sides.tolist()
        if not fits:
            raise ValueError(f"other points than those of {sides.tolist()}")
    if grid.IsA("vtkUnstructuredGrid") and n_cells > 0:
        _check_cells(grid, n_points, n_cells)


def _types_of(grid: Any) -> Any:
    """The type of each cell; the method has another name since VTK 9.6."""
    try:
        return grid.GetCellTypes()
    except TypeError:  # before, it wanted a list to fill
        return grid.GetCellTypesArray()


def _check_cells(grid: Any, n_points: int, n_cells: int) -> None:
    from vtkmodules.util.numpy_support import vtk_to_numpy

    offsets: NDArray[Any] = vtk_to_numpy(grid.GetCells().GetOffsetsArray())
    points: NDArray[Any] = vtk_to_numpy(grid.GetCells().GetConnectivityArray())
    types: NDArray[Any] = vtk_to_numpy(_types_of(grid))
    if len(types) != n_cells or len(offsets) != n_cells + 1:
        raise ValueError(f"{len(types)} types and {len(offsets)} offsets of {n_cells} cells")
    sizes = np.diff(offsets)
    if offsets[0] != 0 or offsets[-1] != len(points) or (sizes < 0).any():
        raise ValueError("offsets of cells that do not grow")
    if len(points) and (points.min() < 0 or points.max() >= n_points):
        raise ValueError("a cell of points that are not there")
    for kind in np.unique(types).tolist():
        fixed = POINTS_OF.get(kind)
        if fixed is None and kind not in ANY_NUMBER:
            raise ValueError(f"cells of type {kind}, which VTK does not have")
        if fixed is not None and (sizes[types == kind] != fixed).any():
            raise ValueError(f"cells of type {kind} with another number of points than {fixed}")
