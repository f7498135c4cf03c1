"""Files of kinds that Wavesplat does not read: their content, and the way to a volume, for error messages."""

from __future__ import annotations

from pathlib import Path

from wavesplat._readers.vtk_arrays import other_grid
from wavesplat.errors import FileError

__all__ = ["OF_N5", "foreign_content", "foreign_folder", "foreign_kind"]

BY_SITK = "give wavesplat.Volume(SimpleITK.ReadImage(path))"
BY_XARRAY = "give wavesplat.Volume(xarray.open_dataset(path)[name])"
OF_N5 = "resave it as HDF5 or OME-Zarr, as with BigStitcher in Fiji"
UNPACK = "unpack it first"
BY_VTU = (
    "save pyvista.read(path), of several blocks its .combine(), as .vtu, and open that with resample=N (--resample N)"
)

#: Suffix -> content of the file, and the way to a volume.
BY_SUFFIX = {
    **dict.fromkeys((".grib", ".grb", ".grib2", ".grb2"), ("weather data (GRIB)", BY_XARRAY)),
    **dict.fromkeys((".mnc2", ".mnc.gz"), ("a MINC image", "unpack it, and give it a name that ends in .mnc")),
    **dict.fromkeys((".mif", ".mif.gz", ".mih"), ("an image of MRtrix", "write it as NIfTI: mrconvert a.mif a.nii.gz")),
    ".gipl": ("an image that ITK reads", BY_SITK),
    **dict.fromkeys(
        (".mrc", ".map", ".ccp4"), ("an MRC map", "give wavesplat.Volume(mrcfile.read(path), spacing=...)")
    ),
    ".gii": ("a surface (GIFTI)", "name the image that it was made from"),
    **dict.fromkeys((".stl", ".obj", ".ply", ".glb", ".gltf"), ("a mesh", "name the image that it was made from")),
    **dict.fromkeys((".cgns", ".xdmf", ".xmf", ".case", ".foam"), ("grids of a simulation", BY_VTU)),
    **dict.fromkeys((".tar", ".tgz", ".7z", ".rar"), ("an archive", UNPACK)),
    **dict.fromkeys((".gz", ".bz2", ".xz", ".zst"), ("packed bytes", UNPACK)),
    **dict.fromkeys(
        (".png", ".jpg", ".jpeg", ".bmp", ".gif", ".webp"),
        ("one picture", "a volume is a folder of TIFF or DICOM slices, or one file of a stack"),
    ),
}
#: Suffix of VTK's other files -> the name of their type.
OF_VTK = {
    ".htg": "HyperTreeGrid",
    ".pvd": "Collection",
    ".vtkhdf": "VTKHDF",
}
#: First bytes -> content of the file, and the way to a volume. No format that is read begins so, but packed files.
BY_CONTENT = {
    b"CDF": ("netCDF", "give it a name that ends in .nc"),
    b"\x0e\x03\x13\x01": ("HDF4", "convert it to HDF5 first, as h4toh5 does"),
    b"\x89PNG": ("a PNG picture", "name the volume itself"),
    b"\xff\xd8\xff": ("a JPEG picture", "name the volume itself"),
    b"PK\3\4": ("a zip archive", UNPACK),
    b"\x1f\x8b": ("bytes packed by gzip", "unpack it, or give it a name that ends in .gz if it is NIfTI"),
    b"BZh": ("bytes packed by bzip2", UNPACK),
    b"\xfd7zXZ\0": ("bytes packed by xz", UNPACK),
    b"\x28\xb5\x2f\xfd": ("bytes packed by Zstandard", UNPACK),
    b"%PDF": ("a PDF", "name the volume itself"),
    b"version https://git-lfs": ("a pointer of Git LFS, not the file itself", "fetch it with: git lfs pull"),
    b"/annex/objects": ("a pointer of git-annex, not the file itself", "fetch it with: git annex get"),
    b"<!doctype html": ("a web page, as of a failed download", "download the file again"),
    b"<html": ("a web page, as of a failed download", "download the file again"),
}
#: Suffixes whose files may begin with such bytes: archives, packed streams, and samples without a header.
MAY_BE_OURS = (".npz", ".gz", ".mgz", ".img", ".raw", ".bin", ".mnc", ".brik", ".rec", ".v")


def foreign_kind(path: Path) -> FileError | None:
    """The error that describes a file by its suffix; None for an unknown suffix."""
    name = path.name.lower()
    for suffix, kind in OF_VTK.items():
        if name.endswith(suffix):
            return other_grid(kind, path)
    for suffix, (what, way) in BY_SUFFIX.items():
        if name.endswith(suffix):
            return FileError(f"the file holds {what}, which wavesplat does not read; {way}: {path}")
    return None


def foreign_folder(folder: Path, names: list[str]) -> FileError | None:
    """The error that describes a folder by the names in it; None where it may be one of slices."""
    if "attributes.json" not in names:
        return None
    return FileError(f"the folder holds N5 of another form than BigDataViewer's; {OF_N5}: {folder}")


def foreign_content(path: Path, start: bytes) -> FileError | None:
    """The error that describes a file by its first bytes, whatever its name; None where we may read it."""
    if path.name.lower().endswith(MAY_BE_OURS):
        return None
    head = start.lstrip().lower() if start[:1] in b" \t\r\n<" else start
    for magic, (what, way) in BY_CONTENT.items():
        if head.startswith(magic):
            return FileError(f"the file holds {what}, which is no volume; {way}: {path}")
    return None
