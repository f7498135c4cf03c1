"""Arrays of VTK's images, legacy and XML: which of them is drawn, and where its samples lie."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from wavesplat._readers.request import Request, several
from wavesplat.errors import ArgumentError, FileError

__all__ = ["chosen", "described_grid", "other_grid", "world_from_index"]

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


def chosen(names: Sequence[str], scalars: Sequence[str], request: Request) -> int:
    """The number of the array that is asked for, else of the first of the scalars, else of the only one."""
    if not names:
        raise FileError(
            f"the file holds a grid without an array of numbers, so there is nothing to draw; write it with values: "
            f"{request.path}"
        )
    listed = ", ".join(names)
    if request.dataset is not None:
        if request.dataset not in names:
            raise ArgumentError(f"no array {request.dataset!r}; the file holds {listed}: {request.path}")
        return list(names).index(request.dataset)
    named = [name for name in scalars if name in names]
    if named or len(names) == 1:
        return list(names).index(named[0]) if named else 0
    message = f"the file holds {len(names)} arrays ({listed}); choose one with dataset= (--dataset): {request.path}"
    raise several(message, "dataset", names)


def world_from_index(
    direction: ArrayLike, spacing: ArrayLike, origin: ArrayLike, first: ArrayLike, *, of_cells: bool
) -> NDArray[np.float64]:
    """The affine of an image whose samples begin at point `first`. Samples of cells lie in their middles."""
    matrix = np.eye(4)
    matrix[:3, :3] = np.reshape(np.asarray(direction, np.float64), (3, 3)) * np.asarray(spacing, np.float64)
    begin = np.asarray(first, np.float64) + (0.5 if of_cells else 0.0)
    matrix[:3, 3] = np.asarray(origin, np.float64) + matrix[:3, :3] @ begin
    return matrix


def other_grid(kind: str, path: object) -> FileError:
    """The error for a valid VTK file that holds no image."""
    held = described_grid(kind)
    if "POLYDATA" in kind.upper():
        return FileError(
            f"the file holds {held}, which has no samples inside; name the volume that it was made from: {path}"
        )
    if kind == "ImageData":
        return FileError(f"the file holds an image in VTK's HDF5; write it as pyvista.read(path).save('a.vti'): {path}")
    if kind == "Collection":
        return FileError(
            f"the file names one file for each time (Collection) and holds no samples; open one of those, or all as a "
            f"series: wavesplat movie 'NAME_*.vtu' --times all: {path}"
        )
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
