"""Families of formats, and the module that reads each."""

from __future__ import annotations

from importlib import import_module
from types import ModuleType

#: Family -> its module below this folder.
MODULES = {
    "arrays": "plain.arrays",
    "bdv": "microscopes.bdv",
    "bioio_files": "microscopes.bioio_files",
    "bov": "simulations.bov",
    "cube": "simulations.cube",
    "dicom": "dicom.reading",
    "hdf5": "hdf5.hdf5",
    "imaris": "microscopes.imaris",
    "itk": "nrrd.itk",
    "lazy_files": "lazy_files",
    "netcdf": "hdf5.netcdf",
    "neuroimaging": "nifti.neuroimaging",
    "nifti": "nifti.nifti",
    "ome_zarr": "zarr.ome_zarr",
    "raw": "plain.raw",
    "segy": "simulations.segy",
    "tiff": "tiff.tiff",
    "vasp": "simulations.vasp",
    "vti": "vtk.vti",
    "vtk_grids": "vtk.grids",
    "vtk_legacy": "vtk.legacy",
    "vtk_series": "vtk.series",
}


def reader_of(family: str) -> ModuleType:
    """The module that reads a family of formats; loaded when first asked for."""
    return import_module(f"wavesplat._readers.{MODULES[family]}")
