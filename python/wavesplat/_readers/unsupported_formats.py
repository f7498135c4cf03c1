"""Formats that Wavesplat knows and does not read: what the file or folder holds, and the way to a volume, for messages.

One table; a format is known by the ends of its files' names, by their first bytes, or by names in a folder. Tried with
the libraries that they name were the ways of PyVista (Exodus, CGNS, PLOT3D, SLC, OpenFOAM), yt (Enzo), astropy, adios2,
SciPy's .mat, ASE's LAMMPS dumps, MRC by gemmi and mrcfile, N5 of three axes, precomputed and WKW; not the others.
"""

from __future__ import annotations

import json
import re
from collections.abc import Collection
from pathlib import Path
from typing import NamedTuple

from wavesplat._readers.vtk.arrays import other_grid
from wavesplat.errors import FileError

OF_N5 = (
    "name a folder whose attributes.json has dimensions, and give wavesplat.Volume(tensorstore.open({'driver': 'n5', "
    "'kvstore': 'file://' + path + '/'}).result().read().result().T, spacing=...), of four axes .T[..., channel], or "
    "resave it as OME-Zarr"
)
BY_SITK = "give wavesplat.Volume(SimpleITK.ReadImage(path))"
BY_XARRAY = "give wavesplat.Volume(xarray.open_dataset(path)[name])"
UNPACK = "unpack it first"
BY_VTU = (
    "save pyvista.read(path), of several blocks its .combine(), as .vtu, and open that with resample=N (--resample N)"
)
BY_FOAM = (
    "with r = pyvista.OpenFOAMReader('CASE/case.foam'), whose file may be empty, and "
    "r.set_active_time_value(r.time_values[-1]), save r.read()['internalMesh'] as .vtu, and open that with resample=N "
    "(--resample N)"
)
BY_YT = (
    "with data = yt.load(path) and grid = data.covering_grid(level, data.domain_left_edge, data.domain_dimensions * "
    "data.refine_by**level), give wavesplat.Volume(grid.to_xarray(fields=[field])[field]), field = ('gas', 'density')"
)
BY_EXPORT = "export it as .vtu, .vti or netCDF, as ParaView and VisIt do that read it"
BY_PROGRAM = "export it as TIFF, NRRD or HDF5 with the program that wrote it"
BY_MRC = (
    "with m = mrcfile.open(path) (.gz and .bz2 too) and h = m.header, give wavesplat.Volume(numpy.moveaxis(m.data, "
    "(0, 1, 2), (3 - h.maps, 3 - h.mapr, 3 - h.mapc)), spacing=m.voxel_size.tolist(), unit='angstrom'), since its axes "
    "may be in any order; docs/interop.md has the lines that keep its place (origin, nxstart) too"
)
BY_OVF = (
    "with f = discretisedfield.Field.from_file(path), give wavesplat.Volume(f.array[..., 2].T, spacing=f.mesh.cell, "
    "unit='m') for the component z"
)
ATOMS = (
    "atoms without a field",
    "draw them as points: wavesplat.Points(ase.io.read(path).positions); a field is in the .cube or CHGCAR beside it",
)
MESH = ("a mesh", "name the image that it was made from, and draw the mesh with it (--surface)")
PICTURE = ("one picture", "a volume is a folder of TIFF or DICOM slices, or one file of a stack")
WEB_PAGE = ("a web page, as after a failed download", "download the file again")
WKW = (
    "a data set of WEBKNOSSOS (wkw)",
    "with d = wkw.Dataset.open(folder of header.wkw), give wavesplat.Volume(d.read(offset, shape)[0].T, spacing=...)",
)
PRECOMPUTED = (
    "Neuroglancer's precomputed format",
    (
        "with the folder of the file info as path, give wavesplat.Volume(tensorstore.open({'driver': "
        "'neuroglancer_precomputed', 'kvstore': 'file://' + path + '/'}).result().read().result()[..., 0].T, "
        "spacing=..., unit='nm'), the resolution in info"
    ),
)


class Known(NamedTuple):
    """A format: its content in words, the way to a volume, ends of names, and first bytes at their offsets."""

    what: str
    way: str
    names: tuple[str, ...] = ()
    begins: tuple[tuple[int, bytes], ...] = ()


#: Longer ends come first where one ends with another.
FORMATS = (
    Known(
        "an MRC map",
        BY_MRC,
        (".map.gz", ".mrc.gz", ".map.bz2", ".mrc.bz2", ".mrc", ".mrcs", ".map", ".ccp4", ".st", ".ali"),
        ((208, b"MAP "), (208, b"MAP\0")),
    ),
    Known("a case of OpenFOAM", BY_FOAM, (".foam", ".openfoam")),
    Known("weather data (GRIB)", BY_XARRAY, (".grib", ".grb", ".grib2", ".grb2"), ((0, b"GRIB"),)),
    Known(
        "fields of the Met Office (PP)",
        "give wavesplat.Volume(xarray.DataArray.from_iris(iris.load_cube(path, name)))",
        (".pp",),
    ),
    Known("meshes of finite elements (Exodus)", BY_VTU, (".ex2", ".exo", ".exii", ".ex2v2")),
    Known("grids of a simulation (CGNS)", BY_VTU, (".cgns",)),
    Known("grids of a simulation (XDMF)", BY_VTU, (".xdmf", ".xmf")),
    Known("grids of a simulation (EnSight)", BY_VTU, (".case", ".encas")),
    Known(
        "grids of a simulation (PLOT3D)",
        "with r = pyvista.MultiBlockPlot3DReader(path) and r.add_q_files(path of .q), save r.read().combine() as .vtu, "
        "and open that with resample=N (--resample N)",
        (".p3d", ".q", ".xyzb"),
    ),
    Known("grids of a simulation (Silo)", BY_EXPORT, (".silo",)),
    Known("grids of a simulation (Tecplot)", BY_EXPORT, (".plt", ".szplt", ".tec"), ((0, b"#!TDV"),)),
    Known("grids of a simulation (Nek5000)", BY_EXPORT, (".nek5000", ".nek3d")),
    Known("a mesh of Conduit (Blueprint)", BY_EXPORT, (".root", ".blueprint_root")),
    Known("an adaptive mesh of Enzo", BY_YT, (".hierarchy", ".boundary")),
    Known(
        "data of ADIOS2",
        "with f = adios2.FileReader(path), give wavesplat.Volume(f.read(name), spacing=...)",
        (".bp", ".bp4", ".bp5"),
    ),
    Known("magnetisation (OVF)", BY_OVF, (".ovf", ".omf", ".ohf", ".oef", ".ovf2"), ((0, b"# OOMMF"),)),
    Known("a volume of VolVis (SLC)", "save pyvista.read(path) as .vti, and open that", (".slc",)),
    Known(
        "an image of astronomy (FITS)",
        "give wavesplat.Volume(astropy.io.fits.getdata(path), spacing=...)",
        (".fits", ".fit", ".fts", ".fits.gz", ".fits.fz"),
        ((0, b"SIMPLE  ="),),
    ),
    Known(
        "a molecule (Chemical JSON)",
        "write its orbitals and densities as Gaussian cubes (.cube), as Avogadro does",
        (".cjson",),
    ),
    Known(
        "positions of atoms (LAMMPS)",
        "they are no field; draw them as points: wavesplat.Points(ase.io.read(path, format='lammps-dump-text')"
        ".positions)",
        (".dump", ".lammpstrj"),
        ((0, b"ITEM: TIMESTEP"),),
    ),
    Known(*ATOMS, (".pdb", ".cif", ".gro", ".extxyz")),
    Known(
        "variables of MATLAB",
        "with d = scipy.io.loadmat(path), give wavesplat.Volume(d[name].T, spacing=...)",
        (),
        ((0, b"MATLAB 5.0"),),
    ),
    Known("a MINC image", "unpack it, and give it a name that ends in .mnc", (".mnc2", ".mnc.gz")),
    Known("an image of MRtrix", "write it as NIfTI: mrconvert a.mif a.nii.gz", (".mif", ".mif.gz", ".mih")),
    Known("an image that ITK reads", BY_SITK, (".gipl",)),
    Known("a surface (GIFTI)", MESH[1], (".gii",)),
    Known(*MESH, (".stl", ".obj", ".ply", ".glb", ".gltf")),
    Known("a volume of OpenVDB", BY_PROGRAM, (".vdb",), ((0, b" BDV"),)),
    Known("data of Amira or Avizo", BY_PROGRAM, (".am",), ((0, b"# AmiraMesh"), (0, b"# Avizo"))),
    Known("an X-ray scan of Zeiss", BY_PROGRAM, (".txm", ".txrm", ".xrm")),
    Known("a slide", "save a part of it as TIFF, as QuPath does", (".svs", ".ndpi", ".mrxs", ".scn")),
    Known(*PICTURE, (".png", ".jpg", ".jpeg", ".bmp", ".gif", ".webp")),
    Known(*PRECOMPUTED),
    Known(*WKW, (".wkw",), ((0, b"WKW"),)),
    # Archives and packed bytes come last: the formats above may be packed.
    Known("an archive", UNPACK, (".tar", ".tgz", ".7z", ".rar")),
    Known("packed bytes", UNPACK, (".gz", ".bz2", ".xz", ".zst")),
)
#: Groups at the root of an HDF5 file without a volume -> what it holds, and the way to a volume.
BY_GROUPS = {
    ("coordsets", "topologies"): ("a mesh of Conduit (Blueprint)", BY_EXPORT),
    ("results", "settings"): (
        "results of Fluent",
        (
            "save pyvista.read(path of the .cas.h5 beside it).combine() as .vtu, and open that with resample=N "
            "(--resample N)"
        ),
    ),
    ("meshes", "settings"): ("a case of Fluent", BY_VTU),
}
#: Ends of names of VTK's other files -> the name of their type.
OF_VTK = {".htg": "HyperTreeGrid", ".vtkhdf": "VTKHDF"}
#: First bytes -> content of the file, and the way to a volume, where the file should not have the name that it has.
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
    b"<!doctype html": WEB_PAGE,
    b"<html": WEB_PAGE,
}
#: Suffixes whose files may begin with such bytes: archives, packed streams, and samples without a header.
MAY_BE_OURS = (".npz", ".gz", ".mgz", ".img", ".raw", ".bin", ".mnc", ".brik", ".rec", ".v")
#: Names of FARGO3D's arrays, which have no header; their sizes are in the domain files beside.
FARGO = re.compile(r"gas(dens|energy|vx|vy|vz|rad)\d+\.dat")
#: Subfolders of a folder that are looked into, at most, to know a format by them.
MAX_FOLDERS = 50


def foreign_kind(path: Path) -> FileError | None:
    """The error that describes a file by its name; None for an unknown one."""
    name = path.name.lower()
    for suffix, kind in OF_VTK.items():
        if name.endswith(suffix):
            return other_grid(kind, path)
    if FARGO.fullmatch(name):
        return _error(
            "an array of FARGO3D without a header",
            "open it as raw, with shape=(nz, ny, nx), the numbers of cells by domain_z.dat, domain_y.dat and "
            "domain_x.dat, and dtype='float64' (--shape NX,NY,NZ --dtype float64); angles are drawn as lengths",
            path,
        )
    if name.endswith((".xyz", ".x")):
        what, way = ATOMS if _is_text(path) else (_named("PLOT3D").what, _named("PLOT3D").way)
        return _error(what, way, path)
    found = next((one for one in FORMATS if name.endswith(one.names)), None)
    return None if found is None else _error(found.what, found.way, path)


def check_no_empty_case(path: Path) -> None:
    """Raise the error for a case of OpenFOAM, whose file may be empty: it stands for the folder that it lies in."""
    case = _named("OpenFOAM")
    if path.name.lower().endswith(case.names) and path.exists():
        raise _error(case.what, case.way, path)


def foreign_folder(folder: Path, *, depth: int = 0) -> FileError | None:
    """The error that describes a folder by the names in it; None where it may be one of slices.

    depth : how deep folders in it count too, where it holds nothing else.
    """
    found = _by_names(folder, _names_in(folder), depth)
    return None if found is None else _error(*found, folder, holder="folder")


def _by_names(folder: Path, names: set[str], depth: int) -> tuple[str, str] | None:
    """Content of a folder and the way to a volume; the folder's own format comes before formats in its subfolders."""
    if "attributes.json" in names:
        return "N5 of another form than BigDataViewer's", OF_N5
    if "header.wkw" in names:
        return WKW
    if "info" in names and _is_precomputed(folder / "info"):
        return PRECOMPUTED
    if {"constant", "system"} <= names or any(name.lower().endswith((".foam", ".openfoam")) for name in names):
        return _named("OpenFOAM").what, BY_FOAM
    if "md.idx" in names or "md.0" in names:
        return _named("ADIOS2").what, _named("ADIOS2").way
    if "Header" in names and any(name.startswith("Level_") for name in names):
        return "an adaptive mesh of AMReX", BY_YT
    if depth == 0:
        return None
    inner = [folder / name for name in sorted(names)[:MAX_FOLDERS] if (folder / name).is_dir()]
    return next((found for one in inner if (found := _by_names(one, _names_in(one), depth - 1)) is not None), None)


def _names_in(folder: Path) -> set[str]:
    try:
        return {entry.name for entry in folder.iterdir()}
    except OSError:
        return set()


def _is_precomputed(path: Path) -> bool:
    try:
        with path.open("rb") as file:
            found = json.loads(file.read(1 << 20))
    except (OSError, ValueError, RecursionError):
        return False
    return isinstance(found, dict) and {"scales", "num_channels"} <= set(found)


def foreign_groups(groups: Collection[str], path: Path) -> FileError | None:
    """The error that describes an HDF5 file by the groups at its root; None for an unknown one."""
    for names, (what, way) in BY_GROUPS.items():
        if set(names) <= set(groups):
            return _error(what, way, path)
    return None


def foreign_content(path: Path, start: bytes) -> FileError | None:
    """The error that describes a file by its first bytes, whatever its name; None where we may read it."""
    if path.name.lower().endswith(MAY_BE_OURS) and start[208:211] != b"MAP":  # MRC, also named .rec
        return None
    head = start.lstrip().lower() if start[:1] in b" \t\r\n<" else start
    for magic, (what, way) in BY_CONTENT.items():
        if head.startswith(magic):
            return FileError(f"the file holds {what}, which is no volume; {way}: {path}")
    for one in FORMATS:
        if any(start[offset : offset + len(magic)] == magic for offset, magic in one.begins):
            return _error(one.what, one.way, path)
    return None


def _named(word: str) -> Known:
    """The format whose description has a word."""
    return next(one for one in FORMATS if word in one.what)


def _error(what: str, way: str, path: Path, *, holder: str = "file") -> FileError:
    return FileError(f"the {holder} holds {what}, which wavesplat does not read; {way}: {path}")


def _is_text(path: Path) -> bool:
    """Whether a file begins with printable text."""
    with path.open("rb") as file:
        return all(32 <= byte < 127 or byte in b"\t\r\n" for byte in file.read(64))
