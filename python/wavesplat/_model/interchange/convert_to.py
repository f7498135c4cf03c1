"""Conversion of a volume to other libraries' objects, which `convert_from` turns back into the same volume.

NIfTI and ITK count millimetres: lengths in other units are converted, for ITK in a patient's world alone.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from wavesplat._model.interchange import itk_image, labelled_array, nibabel_image, vtk_image
from wavesplat._model.volume import affine, units
from wavesplat._model.volume.grid import UPRIGHT, Grid
from wavesplat._system.libraries import library

if TYPE_CHECKING:
    import nibabel
    import pyvista
    import SimpleITK
    import xarray

#: Tolerance within which the index axes count as the world's, as a fraction of the spacing.
TOLERANCE = 1e-9


def to_xarray(grid: Grid, samples: NDArray[Any]) -> xarray.DataArray:
    """A `xarray.DataArray` with the axes z, y, x and their coordinates."""
    matrix = grid.world_from_index
    attributes: dict[str, Any] = {}
    if grid.is_anatomical:
        attributes[labelled_array.SPACE] = "RAS"
    if grid.modality is not None:
        attributes[labelled_array.MODALITY] = grid.modality
    if grid.value_unit is not None:
        attributes[labelled_array.UNITS] = grid.value_unit
    steps, firsts = np.diag(matrix)[:3], matrix[:3, 3]
    off = np.abs(matrix[:3, :3] - np.diag(steps)).max(axis=0)
    if (off > TOLERANCE * np.array(grid.spacing)).any():
        # Turned: coordinates count along the samples' own axes, and this takes them to the world.
        steps, firsts = np.array(grid.spacing), np.zeros(3)
        rows = matrix @ np.diag([*(1 / steps), 1.0])
        attributes[labelled_array.AFFINE] = rows.ravel().tolist()
    coordinates = {}
    with_unit = {} if grid.unit is None else {"units": grid.unit}
    is_map = UPRIGHT in grid.facts.conventions
    for name, first, step, n in zip("xyz", firsts, steps, reversed(grid.shape), strict=True):
        # As the conventions for climate and forecasts say that z is up.
        more = {"axis": name.upper(), **({"positive": "up"} if name == "z" else {})} if is_map else {}
        coordinates[name] = (name, first + step * np.arange(n), with_unit | more)
    made: xarray.DataArray = library("xarray", extra="xarray").DataArray(
        samples, dims=("z", "y", "x"), coords=coordinates, name=grid.facts.quantity or grid.name, attrs=attributes
    )
    return made


def to_simple_itk(grid: Grid, samples: NDArray[Any]) -> SimpleITK.Image:
    """A `SimpleITK.Image`: LPS and millimetres of a patient's world, another world as it is."""
    import SimpleITK

    matrix = affine.RAS_FROM_LPS @ _in_millimetres(grid) if grid.is_anatomical else grid.world_from_index
    spacing = affine.spacing_of(matrix)
    image: SimpleITK.Image = SimpleITK.GetImageFromArray(samples)
    image.SetSpacing(spacing.tolist())
    image.SetOrigin(matrix[:3, 3].tolist())
    image.SetDirection((matrix[:3, :3] / spacing).ravel().tolist())
    if not grid.is_anatomical:
        image.SetMetaData(itk_image.SPACE, itk_image.NO_ANATOMY)
        if grid.unit is not None:
            image.SetMetaData(itk_image.UNIT, grid.unit)
    if grid.modality is not None:
        image.SetMetaData("modality", grid.modality)
    if grid.value_unit is not None:
        image.SetMetaData(itk_image.VALUE_UNIT, grid.value_unit)
    return image


def to_nibabel(grid: Grid, samples: NDArray[Any]) -> nibabel.Nifti1Image:
    """A `nibabel.Nifti1Image`, in millimetres where the unit is known."""
    import nibabel

    # NIfTI-1 counts samples along an axis in 16 bits.
    kind: Any = nibabel.Nifti1Image if max(grid.shape) < 2**15 else nibabel.Nifti2Image
    image: nibabel.Nifti1Image = kind(samples.T, _in_millimetres(grid))
    header = image.header
    header.set_xyzt_units("mm" if units.metres(grid.unit) is not None else "unknown")
    if grid.is_anatomical:
        image.set_sform(image.affine, "scanner")
    else:
        header["descrip"] = nibabel_image.NO_ANATOMY.encode()
    return image


def to_pyvista(grid: Grid, samples: NDArray[Any]) -> pyvista.ImageData:
    """A `pyvista.ImageData` with the samples as active scalars of its points."""
    matrix = grid.world_from_index
    spacing = affine.spacing_of(matrix)
    image: pyvista.ImageData = library("pyvista", extra="pyvista").ImageData(
        dimensions=grid.shape[::-1],
        spacing=spacing,
        origin=matrix[:3, 3],
        direction_matrix=matrix[:3, :3] / spacing,
    )
    # Images of several datasets of a file are combined by the names of their arrays.
    name = grid.facts.quantity or grid.name
    image.point_data[name] = samples.ravel()
    image.set_active_scalars(name)
    if grid.unit is not None:
        image.field_data[vtk_image.UNIT] = [grid.unit]
    if grid.is_anatomical:
        image.field_data[vtk_image.SPACE] = ["RAS"]
    return image


def _in_millimetres(grid: Grid) -> NDArray[np.float64]:
    """The affine in millimetres; unchanged where the unit has no known size."""
    matrix = np.array(grid.world_from_index)
    size = units.metres(grid.unit)
    if size is not None:
        matrix[:3] *= float(f"{size / units.MILLIMETRE:.12g}")
    return matrix
