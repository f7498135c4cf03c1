"""Arrays of VTK's images: which is drawn, and where its samples lie; and checks of grids that VTK has read."""

from __future__ import annotations

import re
from collections.abc import Sequence
from itertools import product
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from wavesplat._readers.components import N_COMPONENTS
from wavesplat._readers.file_contents import GridFacts
from wavesplat._readers.request import Request, listed, no_such_name
from wavesplat.errors import FileError

#: Suffixes of grids that are no image, and of images in parts.
GRID_SUFFIXES = tuple(
    f".{name}" for name in ["vtr", "vts", "vtu", "vtp", "pvti", "pvtr", "pvts", "pvtu", "pvtp", "vtm", "vtmb", "vthb"]
)
#: Names that a guess lists, at most.
MAX_IN_GUESS = 8
#: Names of arrays that number points and cells, or say where they came from: VTK puts them beside the fields.
NUMBERS_ONLY = re.compile(
    r"(vtk(Original|Ghost|Valid|Composite|Block|Domain)\w*|((Global|Pedigree)_?)?(Point|Cell|Node|Element)_?Ids?)"
    r"( of cells)?",
    re.IGNORECASE,
)
#: VTK's names of data that are no image -> their description.
GRIDS = {
    "RECTILINEARGRID": "a rectilinear grid, whose samples may be unevenly spaced",
    "STRUCTUREDGRID": "a structured grid, whose samples lie on curves",
    "UNSTRUCTUREDGRID": "an unstructured grid",
    "POLYDATA": "a mesh of surfaces or lines",
    "HYPERTREEGRID": "a tree of cells",
    "OVERLAPPINGAMR": "levels of an adaptive mesh",
    "NONOVERLAPPINGAMR": "levels of an adaptive mesh",
    "HIERARCHICALBOXDATASET": "levels of an adaptive mesh",
    "MULTIBLOCKDATASET": "several blocks",
    "MULTIBLOCK": "several blocks",
}


def chosen(
    names: Sequence[str], scalars: Sequence[str], n_components: Sequence[int], request: Request
) -> tuple[int, tuple[str, ...]]:
    """The number of the array that is asked for, else of the active scalars, else of the first; and what was guessed.

    Arrays that number points or cells come last.

    n_components : of each array. One of scalars or vectors is drawn without a further choice, so it comes first.
    """
    if not names:
        raise FileError(
            f"the file holds a grid without an array of numbers, so there is nothing to draw; write it with values: "
            f"{request.path}"
        )
    if request.dataset is not None:
        if request.dataset not in names:
            raise no_such_name("array", request.dataset, names, request)
        return list(names).index(request.dataset), ()
    fields = [name for name in names if not NUMBERS_ONLY.fullmatch(name)] or list(names)
    active = [name for name in scalars if name in fields]
    drawn = [name for name, n in zip(names, n_components, strict=True) if n in (1, N_COMPONENTS) and name in fields]
    number = list(names).index((active or drawn or fields)[0])
    if len(names) == 1:
        return number, ()
    which = "the active one" if active and number else "one" if number else "the first"
    guess = f"shown: {names[number]}, {which} of {len(names)} arrays ({listed(names, MAX_IN_GUESS)})"
    return number, (f"{guess}; dataset=NAME (--dataset NAME) chooses another",)


def world_from_index(
    direction: ArrayLike, spacing: ArrayLike, origin: ArrayLike, first: ArrayLike, *, of_cells: bool
) -> NDArray[np.float64]:
    """The affine of an image whose samples begin at point `first`. Samples of cells lie in their middles."""
    matrix = np.eye(4)
    matrix[:3, :3] = np.reshape(np.asarray(direction, np.float64), (3, 3)) * np.asarray(spacing, np.float64)
    begin = np.asarray(first, np.float64) + (0.5 if of_cells else 0.0)
    matrix[:3, 3] = np.asarray(origin, np.float64) + matrix[:3, :3] @ begin
    return matrix


def image_facts(kind: str, n_points: Sequence[int], world_from_index: NDArray[np.float64]) -> GridFacts:
    """Facts of an image of evenly spaced points along x, y, z, by the affine of its points."""
    n_cells = int(np.prod([max(n - 1, 1) for n in n_points]))
    ends = [(0, n - 1) for n in n_points]
    corners = np.array([[*corner, 1] for corner in product(*ends)]) @ world_from_index.T
    low, high = corners[:, :3].min(axis=0), corners[:, :3].max(axis=0)
    size = " x ".join(map(str, n_points))
    bounds = tuple(low.tolist()), tuple(high.tolist())
    return GridFacts(f"an image of {size} evenly spaced points ({kind})", int(np.prod(n_points)), n_cells, bounds)


def other_grid(kind: str, path: object) -> FileError:
    """The error for a valid VTK file that holds no image."""
    held = described_grid(kind)
    if "POLYDATA" in kind.upper():
        return FileError(
            f"the file holds {held}, which has no samples inside; name the volume that it was made from: {path}"
        )
    if kind == "ImageData":
        return FileError(f"the file holds an image in VTK's HDF5; write it as pyvista.read(path).save('a.vti'): {path}")
    return FileError(
        f"the file holds {held}, not an image of evenly spaced samples; resample it to one, as with "
        f"pyvista.ImageData(dimensions=..., spacing=..., origin=...).sample(pyvista.read(path)): {path}"
    )


def described_grid(kind: str) -> str:
    """The description of a kind of data, in messages, by VTK's name of the kind."""
    is_parallel = kind.upper().startswith("P") and kind.upper() != "POLYDATA"
    name = kind.upper().replace("_", "").removeprefix("VTK")
    held = GRIDS.get(name.removeprefix("P") if is_parallel else name)
    return f"{held} ({kind})" if held else f"VTK's {kind or 'data of an unnamed kind'}"


# Checks of grids that VTK has read: it does not look, and what is wrong in them ends the process later.

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
#: Types of cells with any number of points.
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
            raise ValueError(f"the number of points is not as in {sides.tolist()}")
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
