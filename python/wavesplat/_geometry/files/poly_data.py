"""Surfaces, lines and points of VTK's files (.vtp, .vtk, .vtu), by VTK."""

from __future__ import annotations

from typing import Any

import numpy as np

from wavesplat._geometry.files.meshes import HEAD_BYTES, LPS_NOTE, SPACE
from wavesplat._geometry.files.read_shape import Asked, ReadShape
from wavesplat._geometry.foreign_shapes import kind_of, lines_of, points_of, surface_of
from wavesplat._readers.vtk import grids
from wavesplat._readers.vtk.arrays import check_grid
from wavesplat._system.libraries import library

SUFFIXES = (".vtp", ".vtk", ".vtu")
#: Fields of shapes that are positions.
PLACES = ("vertices", "positions", "paths")


def read(asked: Asked) -> ReadShape:
    """The shape in a file: its triangles; else its lines; else its points. Of cells of volume, their outer faces."""
    library("vtkmodules", extra="geometry")
    with asked.file.open("rb") as file:
        head = file.read(1 << 16)
    grids.check_promises(head, asked.file)
    data = grids.loaded(asked.file)
    if not data.IsA("vtkPolyData"):
        if not data.IsA("vtkDataSet"):
            raise ValueError(f"it holds a {data.GetClassName()}, which is no one surface; write one of its blocks")
        # VTK would end the process at cells of points that are not there.
        check_grid(data)
        outer = library("vtkmodules.vtkFiltersGeometry", extra="geometry").vtkGeometryFilter()
        outer.SetInputData(data)
        outer.Update()
        data = outer.GetOutput()
    kind = asked.kind or kind_of(data) or "points"
    fields = {"surface": surface_of, "lines": lines_of, "points": points_of}[kind](data, asked.values)
    space = SPACE.search(head[:HEAD_BYTES])
    if space is None or space[1] != b"LPS":
        return ReadShape(kind, fields)
    turned = {name: _turned(part) if name in PLACES else part for name, part in fields.items()}
    return ReadShape(kind, turned, None, (LPS_NOTE,))


def _turned(places: Any) -> Any:
    """Positions, or several paths of them, from LPS to RAS."""
    return [_turned(path) for path in places] if isinstance(places, list) else np.asarray(places) * (-1, -1, 1)
