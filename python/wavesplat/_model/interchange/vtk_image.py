"""Images of VTK, and so of PyVista: the active scalars of points, or else of cells.

Cells have their samples in their middles. VTK says nothing of a patient or of units: its axes are kept as they are.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from wavesplat._model.interchange.converted import Converted
from wavesplat._model.volume import affine, units
from wavesplat._model.volume.facts import Facts, quantity_of
from wavesplat.errors import ArgumentError

#: Names of the texts in the field data in which `Volume.to_pyvista` keeps what VTK has no place for.
UNIT, SPACE = "unit", "space"


def of_vtk(image: Any) -> Converted:
    """Convert a vtkImageData or pyvista.ImageData."""
    if not hasattr(image, "GetDirectionMatrix"):
        raise ArgumentError(
            f"a {type(image).__name__} is no image of evenly spaced samples; resample it to one, as with "
            "pyvista.ImageData(dimensions=..., spacing=..., origin=...).sample(mesh)"
        )
    array, of_cells = _scalars(image)
    n_channels = array.GetNumberOfComponents()
    if n_channels > 1:
        raise ArgumentError(
            f"the array {array.GetName()!r} has {n_channels} components; give one of them, as another array of the "
            "image, and make that the active scalars"
        )
    extent = np.reshape(image.GetExtent(), (3, 2))
    size = extent[:, 1] - extent[:, 0] + (0 if of_cells else 1)
    direction = image.GetDirectionMatrix()
    rows = np.array([[direction.GetElement(i, j) for j in range(3)] for i in range(3)])
    matrix = affine.affine_of(rows, image.GetSpacing(), image.GetOrigin())
    # The origin is the place of point 0; the image may begin at another.
    matrix[:3, 3] += matrix[:3, :3] @ (extent[:, 0] + (0.5 if of_cells else 0.0))
    samples: NDArray[Any] = np.asarray(array).reshape(tuple(size[::-1]))
    name = array.GetName()
    unit, factor = units.of_file(_text(image, UNIT))
    matrix[:3] *= factor
    facts = Facts(unit=unit, quantity=quantity_of(name), is_anatomical=_text(image, SPACE) == "RAS")
    return Converted(samples, matrix, facts, name)


def _scalars(image: Any) -> tuple[Any, bool]:
    """The active scalars, else the only array, and whether they are of cells."""
    parts = [(image.GetPointData(), False), (image.GetCellData(), True)]
    for part, of_cells in parts:
        if (active := part.GetScalars()) is not None:
            return active, of_cells
    arrays = [
        (part.GetArray(number), of_cells)
        for part, of_cells in parts
        for number in range(part.GetNumberOfArrays())
        if part.GetArray(number) is not None
    ]
    if len(arrays) != 1:
        names = ", ".join(str(array.GetName()) for array, _ in arrays) or "none"
        raise ArgumentError(
            f"the image has {len(arrays)} arrays ({names}) and no active scalars; choose one, as with "
            "image.set_active_scalars(name) of PyVista or image.GetPointData().SetActiveScalars(name) of VTK"
        )
    return arrays[0]


def _text(image: Any, name: str) -> str | None:
    array = image.GetFieldData().GetAbstractArray(name)
    return str(array.GetValue(0)) if array is not None and array.GetNumberOfValues() > 0 else None
