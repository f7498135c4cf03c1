"""Readers: from a file or folder to a `Volume`, orientation and spacing kept, samples in the type of the file.

One module per family of formats; this one chooses it. Each has `levels(request)`, whose arrays are read whole or in
parts, or `read(request) -> Grid` where parts cannot be read.
The formats themselves are read by well-kept libraries, loaded only when needed.
"""

from __future__ import annotations

import math
import os
from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import replace
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any
from urllib.parse import urlsplit

import numpy as np

from wavesplat._model.arguments.types import takes_its_types, takes_options
from wavesplat._model.lazy.volume import LazyVolume, default_memory, lazily
from wavesplat._model.volume import affine, sources
from wavesplat._model.volume.facts import Facts
from wavesplat._model.volume.grid import name_of_facts
from wavesplat._model.volume.volume import Volume
from wavesplat._model.volume.volume_like import VolumeLike, as_volume
from wavesplat._public import public
from wavesplat._readers import single_planes
from wavesplat._readers.dicom.places import begins_as_dicom
from wavesplat._readers.families import reader_of
from wavesplat._readers.file_contents import Contents, contents_of
from wavesplat._readers.levels import INSTEAD, Levels
from wavesplat._readers.microscopes import bioio_files
from wavesplat._readers.options import OpenOptions
from wavesplat._readers.request import PLANES_ARE_TAKEN, Grid, Request, requested
from wavesplat._readers.unsupported_formats import (
    check_no_empty_case,
    foreign_content,
    foreign_folder,
    foreign_kind,
)
from wavesplat._readers.vtk.arrays import GRID_SUFFIXES
from wavesplat._storage import size_checks
from wavesplat._storage.file_states import StoredFiles
from wavesplat._storage.paths import FileName, check_no_pipe, check_text, printable
from wavesplat._storage.reading import reading
from wavesplat._storage.zarr.place import holds_zarr
from wavesplat._system.memory import free_bytes
from wavesplat._system.threads import check_cancelled, warn
from wavesplat._system.values import described
from wavesplat.errors import ArgumentError, FileError, FileWarning, WavesplatError

if TYPE_CHECKING:
    from typing import Unpack


#: Suffix -> module. Longer suffixes come first where one ends with another.
SUFFIXES = {
    ".nii.gz": "nifti",
    ".nii": "nifti",
    ".img.gz": "nifti",
    ".img": "nifti",
    ".hdr": "nifti",
    ".mgz": "nifti",
    ".mgh": "nifti",
    ".mnc": "neuroimaging",
    ".head": "neuroimaging",
    ".brik.gz": "neuroimaging",
    ".brik": "neuroimaging",
    ".par": "neuroimaging",
    ".rec": "neuroimaging",
    ".v": "neuroimaging",
    ".nrrd": "itk",
    ".nhdr": "itk",
    ".mha": "itk",
    ".mhd": "itk",
    ".vtk": "vtk_legacy",
    ".vti": "vti",
    **dict.fromkeys(GRID_SUFFIXES, "vtk_grids"),
    **dict.fromkeys((".pvd", ".series"), "vtk_series"),
    ".dcm": "dicom",
    ".ima": "dicom",
    ".zarr.zip": "ome_zarr",
    ".ozx": "ome_zarr",
    ".zip": "dicom",
    ".tiff": "tiff",
    ".tif": "tiff",
    ".btf": "tiff",
    ".npy": "arrays",
    ".npz": "arrays",
    ".raw": "raw",
    ".bin": "raw",
    ".h5": "hdf5",
    ".hdf5": "hdf5",
    ".hdf": "hdf5",
    **dict.fromkeys((".cube", ".cub", ".cube.gz", ".cub.gz"), "cube"),
    **dict.fromkeys((".vasp", ".vasp.gz"), "vasp"),
    ".bov": "bov",
    ".sgy": "segy",
    ".segy": "segy",
    **dict.fromkeys((".nc", ".nc4", ".cdf", ".netcdf"), "netcdf"),
    ".ims": "hdf5",
    ".xml": "bdv",
    ".zarr": "ome_zarr",
    **dict.fromkeys(bioio_files.SUFFIXES, "bioio_files"),
}
#: First bytes -> module, for files under other names: (offset, bytes). (nibabel insists on its suffixes.)
MAGIC = {
    (0, b"NRRD"): "itk",
    (0, b"# vtk DataFile"): "vtk_legacy",
    (0, b"II*\0"): "tiff",
    (0, b"MM\0*"): "tiff",
    (0, b"\x93NUMPY"): "arrays",
    (0, b"\x89HDF\r\n\x1a\n"): "hdf5",
    (0, b"CDF"): "netcdf",
}
N_FIRST_BYTES = 352
#: Modules of formats that hold scans of patients, whatever their headers say.
OF_PATIENTS = ("nifti", "neuroimaging", "dicom")
#: Module -> options that it takes, besides `spacing` and `unit`, which all take.
OPTIONS = {
    "nifti": {"time", "channel", "component"},
    "neuroimaging": {"time", "channel", "component", "external_files"},
    "itk": {"time", "channel", "external_files"},
    "vti": {"channel", "component", "dataset"},
    "vtk_legacy": {"channel", "component", "dataset"},
    "dicom": {"series", "time", "channel", "gaps", "suv"},
    "tiff": {"time", "channel", "level", "external_files"},
    "arrays": {"time", "channel", "component", "dataset"},
    "raw": {"time", "channel", "shape", "dtype", "byte_order", "offset"},
    "hdf5": {"time", "channel", "component", "dataset", "resample", "external_files"},
    "imaris": {"time", "channel", "level", "external_files"},
    "bdv": {"time", "channel", "level", "external_files"},
    "bioio_files": {"series", "time", "channel"},
    "vtk_grids": {"channel", "component", "dataset", "resample", "external_files"},
    "vtk_series": {"time", "channel", "component", "dataset", "resample", "external_files"},
    "cube": {"dataset"},
    "vasp": {"dataset"},
    "bov": {"channel", "component", "external_files"},
    "segy": set(),
    "netcdf": {"time", "channel", "dataset", "resample", "external_files"},
    "ome_zarr": {"time", "channel", "component", "dataset", "level"},
}
#: Samples are left in their file where they take more than one part in LARGE_SHARE of the free memory.
LARGE_SHARE = 4
#: Beginning of the guesses that `spacing` replaces.
OF_DISTANCES = "distance"
KINDS = (
    "NIfTI, FreeSurfer, MINC, AFNI, PAR/REC, ECAT, NRRD, MetaImage, VTK grids, DICOM, TIFF, .npy, .npz, raw, HDF5, "
    "netCDF, cubes, VASP, BOV, SEG-Y, Imaris, BigDataViewer, OME-Zarr, and microscopes' files by bioio"
)


@public
@takes_its_types
@takes_options(OpenOptions, Request, in_full=True)
def open(
    path: str | PathLike[str] | VolumeLike,
    **options: Unpack[OpenOptions],
) -> Volume:
    """The volume in a file or folder, in the RAS world frame if the format has one.

    Parameters
    ----------
    path : path or URL
        NIfTI (.nii, .nii.gz, .hdr/.img), FreeSurfer (.mgz, .mgh), MINC (.mnc), AFNI (.HEAD, .BRIK), PAR/REC, ECAT
        (.v), NRRD (.nrrd, .nhdr), MetaImage (.mha, .mhd), VTK images and grids (.vtk, .vti, .vtr, .vts, .vtu, .vtm and
        others, .pvd and .vtu.series of several times), DICOM (a folder, also of folders, one of the files, a DICOMDIR,
        or a .zip of them), a TIFF stack (one file or a folder), .npy, .npz, raw, HDF5, netCDF (.nc), Gaussian cubes
        (.cube), VASP (CHGCAR, LOCPOT), BOV, SEG-Y, Imaris (.ims), BigDataViewer (its .xml or .h5), OME-Zarr (also
        zipped, or under a URL), microscopes' files by bioio (.czi, .lif, .nd2, ...). Or an object of another library,
        without options: the same as `Volume(object)`.
    **options : OpenOptions
        What to read of the file, and how.

    Returns
    -------
    Volume
        Samples keep the type of the file. World units are millimetres for medical formats, else as in the file.
        `facts` has the unit, whether the axes are a patient's, modality, channels, times, and what was guessed.

    Warns
    -----
    FileWarning
        If a part of a file or series is missing or damaged, and the rest was read.

    Raises
    ------
    FileError
        If there is no such file, or it is unreadable, truncated, of an unknown kind or not a volume.
    ArgumentError
        If an option has no meaning for that format or is out of range.
    LimitError
        If the samples cannot fit into this machine's memory.

    Examples
    --------
    >>> import numpy as np, os, tempfile, wavesplat as ws
    >>> path = os.path.join(tempfile.mkdtemp(), "ramp.raw")
    >>> np.arange(24, dtype=np.uint8).tofile(path)
    >>> ws.open(path, shape=(2, 3, 4), dtype="uint8", spacing=(1, 1, 2)).shape
    (2, 3, 4)
    """
    if not isinstance(path, str | PathLike):
        return _held(path, Request(".", **options))
    return opened(requested(path, **options), stacklevel=5)


def is_zarr(path: str | PathLike[str], **options: Any) -> bool:
    """Whether there is a Zarr image or array at a path or address; False also where it cannot be opened."""
    try:
        return _family(requested(path, **options)) == "ome_zarr"
    except WavesplatError:
        return False  # whatever is wrong is said where the file is opened


def _held(thing: VolumeLike, options: Request) -> Volume:
    """The volume of another library's object."""
    if type(thing).__module__ == "builtins":
        raise ArgumentError(f"path is {described(thing)}; give the name of a file or folder, or an image or array")
    volume = as_volume(thing, argument="path")
    if not isinstance(volume, Volume):
        raise ArgumentError("path is a WaveletVolume already; give a file, a folder or an array")
    if given := options.given():
        raise ArgumentError(
            f"{', '.join(sorted(given))} say how files are read, and path is a {type(thing).__name__}; "
            "choose from it first, or give wavesplat.Volume(array, spacing=...)"
        )
    return volume


def opened(request: Request, *, stacklevel: int = 2) -> Volume:
    """The volume of a request. `stacklevel`: as for `warnings.warn`."""
    check_cancelled()
    family = _family(request)
    _check_options(request, family)
    if family in ("itk", "dicom"):
        check_text(request.file)
    most = _most_bytes(request)
    grid = _found(request, family, most)
    if isinstance(grid, Levels):
        is_large = request.memory is not None or (grid.n_bytes() > most and not grid.arrays[0].is_in_memory)
        if is_large and (lazy := _lazily(grid, request, family)) is not None:
            return lazy
        grid = _whole(grid, request, family)
    volume = _volume(grid, request, family)
    volume._source = sources.of_file(request.path, {name: getattr(request, name) for name in request.given()})
    for loss in grid.all_losses:
        warn(f"{loss}: {request.safe_path}", FileWarning, stacklevel=stacklevel)
    return volume


def contents(request: Request) -> Contents | None:
    """All arrays of a file, and the grid that they lie on; None where its reader lists none."""
    if request.is_url:
        return None
    family = _family(replace(request, dataset=None))
    if family == "vtk_legacy":
        from wavesplat._readers.vtk import grids

        family = "vtk_grids" if grids.is_grid(request.file, or_mesh=True) else family
    return contents_of(request, family)


def grid_of(request: Request) -> Grid:
    """The samples of a file, as its reader gives them."""
    family = _family(request)
    _check_options(request, family)
    found = _found(request, family, math.inf)
    return _whole(found, request, family) if isinstance(found, Levels) else found


#: Families whose samples can be read in parts -> their names in messages.
IN_PARTS = {
    "arrays": "a NumPy file",
    "raw": "raw samples",
    "nifti": "NIfTI",
    "itk": "an image",
    "vtk_legacy": "a VTK image",
    "hdf5": "HDF5",
    "netcdf": "netCDF",
    "imaris": "an Imaris file",
    "bdv": "BigDataViewer's HDF5 or N5",
    "ome_zarr": "Zarr",
    "tiff": "TIFF",
    "bioio_files": "a microscope's file",
}
#: Families whose samples lie in one file as they are, or else as one stream: the size of the file gives the size of the
#: samples.
UNCOMPRESSED = ("arrays", "raw", "nifti", "itk", "vtk_legacy")


def _most_bytes(request: Request) -> float:
    """Bytes of samples that are read at once: a quarter of the free memory; no limit for series that are read on."""
    free = None if request.kept is not None and request.time is not None else free_bytes()
    return math.inf if free is None else free // LARGE_SHARE


def _found(request: Request, family: str, most: float) -> Levels | Grid:
    """The levels of an image in a file; or its samples, where no parts of them can be read."""
    if family not in IN_PARTS:
        if request.memory is not None:
            raise ArgumentError(
                f"of this kind of file ({family}) parts cannot be read; open it without memory=, or {INSTEAD}: "
                f"{request.safe_path}"
            )
        whole: Grid = reader_of(family).read(request)
        return whole
    levels: Callable[[Request], Levels | Grid] = reader_of("lazy_files" if family == "itk" else family).levels
    with reading(IN_PARTS[family], request.safe_path):
        if family in UNCOMPRESSED and request.memory is None:
            if request.file.stat().st_size > most:
                with suppress(WavesplatError):  # whatever is wrong is said where it is read as a whole
                    return levels(replace(request, memory=default_memory()))
            return levels(request)
        # The file that was described must be the one whose state was taken meanwhile.
        before = None if request.is_url or request.file.is_dir() else StoredFiles([request.file])
        found = levels(request)
        if before is not None:
            before.look_again()
        return found


def _whole(levels: Levels, request: Request, family: str) -> Grid:
    with reading(IN_PARTS[family], request.safe_path):
        return levels.whole(request)


def _lazily(grid: Levels, request: Request, family: str) -> LazyVolume | None:
    """The volume whose samples stay in the file; None for a single plane that is asked for, which is read at once."""
    single_planes.check_thickness(grid.arrays[0].shape, request, grid.facts.n_times)
    if PLANES_ARE_TAKEN.get() and min(grid.arrays[0].shape) == 1:
        return None
    places = list(grid.world_from_index)
    if not np.isfinite(places).all():
        # The file is to blame, not the caller; at once, before anything calculates with it.
        raise FileError(
            f"a wrong header: the place of the samples (world_from_index) has a number that is not finite; "
            f"mend it, or export the file again: {request.safe_path}"
        )
    if request.spacing is not None:
        # Coarser levels keep their place relative to the finest.
        first = affine.with_spacing(places[0], request.spacing)
        places = [first @ np.linalg.inv(places[0]) @ place for place in places]
    facts = _facts(grid.facts, (), request)
    name = _name(request, family, facts)
    volume = lazily(grid.arrays, places, name, facts, memory=request.memory, keep=request.cache, holes=request.holes)
    options = {name: getattr(request, name) for name in (*request.given(), "memory") if name != "holes"}
    volume._source = sources.of_file(request.path, {k: v for k, v in options.items() if v is not None})
    return volume


def _facts(of_file: Facts, losses: Sequence[str], request: Request) -> Facts:
    """The facts of the file, with losses as guesses, and options in place of what it says."""
    guesses = [*of_file.guesses, *losses]
    if request.spacing is not None:
        guesses = [guess for guess in guesses if not guess.startswith(OF_DISTANCES)]
    return replace(of_file, guesses=tuple(guesses), unit=request.unit or of_file.unit)


def _name(request: Request, family: str, facts: Facts) -> FileName:
    """The name of a volume: its file's name; for a folder, the modality or quantity of its values."""
    if request.name.is_private:
        return FileName(name_of_facts(facts) or request.name, is_private=True)
    return FileName(request.name, is_private=family in OF_PATIENTS)


def _volume(grid: Grid, request: Request, family: str) -> Volume:
    grid = single_planes.as_volume(grid, request)
    world_from_index = grid.world_from_index
    if request.spacing is not None:
        world_from_index = affine.with_spacing(world_from_index, request.spacing)
    facts = _facts(grid.facts, grid.all_losses, request)
    name = _name(request, family, facts)
    try:
        return Volume(grid.samples, world_from_index=world_from_index, name=name, facts=facts)
    except ArgumentError as error:
        # The array came from the file, so the file is to blame, not the caller.
        raise FileError(f"{error}: {request.safe_path}") from None


def _family(request: Request) -> str:
    """Name of the module that reads a path."""
    if request.shape is not None or request.dtype is not None:
        return "raw"
    if request.is_url:
        _check_address(request)
        return "ome_zarr"
    path = request.file
    check_no_pipe(path)
    if path.is_dir():
        return _family_of_folder(path)
    check_no_empty_case(path)
    size_checks.check_readable(path)
    suffix = next((suffix for suffix in SUFFIXES if path.name.lower().endswith(suffix)), None)
    with path.open("rb") as file:
        start = file.read(N_FIRST_BYTES)
    family = _family_by_content(SUFFIXES.get(suffix or "") or _family_by_magic(start), path)
    if suffix == ".zip" and holds_zarr(path):
        return "ome_zarr"
    _check_no_other_format(path, start, suffix, family)
    if family == "dicom" and suffix != ".zip":
        # One file of a series: the others are looked for beside it.
        for name in _names_in(path.parent):
            check_text(path.parent / name)
    if family == "hdf5" and request.dataset is None:
        from wavesplat._readers.hdf5.hdf5 import kind_of

        return kind_of(path)
    if family is None:
        raise foreign_kind(path) or FileError(
            f"unknown kind of file; wavesplat reads {KINDS}; for raw samples pass shape=(z, y, x) and dtype=: {path}"
        )
    return family


def _check_no_other_format(path: Path, start: bytes, suffix: str | None, family: str | None) -> None:
    """Refuse a known format that is not read, by its first bytes or, for HDF5 and netCDF, by its name."""
    may_be_ours = suffix in (".zip", ".zarr.zip", ".ozx") or family == "netcdf"
    if not may_be_ours and (error := foreign_content(path, start)) is not None:
        raise error
    if suffix is None and family in ("hdf5", "netcdf") and (error := foreign_kind(path)) is not None:
        raise error


def _check_address(request: Request) -> None:
    """Refuse an address whose name ends as a format other than Zarr: other formats are read from disks."""
    name = urlsplit(str(request.path)).path.rstrip("/").lower()
    suffix = next((suffix for suffix in SUFFIXES if name.endswith(suffix)), None)
    if suffix is None or SUFFIXES[suffix] == "ome_zarr":
        return
    raise FileError(
        f"the address names a {suffix} file, and only Zarr is read from addresses; get the file first, as with "
        f"curl -O or wget, and open it, or write it as OME-Zarr beside: {request.safe_path}"
    )


def _family_of_folder(folder: Path) -> str:
    names = _names_in(folder)
    if not names:
        raise FileError(f"the folder is empty; name the folder that holds the slices: {folder}")
    if {"zarr.json", ".zattrs", ".zgroup", ".zarray"} & set(names):
        return "ome_zarr"
    if any(name.lower().endswith((".tif", ".tiff")) for name in names):
        return "tiff"
    from wavesplat._readers.microscopes.bdv_n5 import holds_setups

    if holds_setups(names):
        return "bdv"
    if (error := foreign_folder(folder)) is not None:
        raise error
    return "dicom"


def _names_in(folder: Path) -> list[str]:
    """Names in a folder; a pipe or a device is refused, since readers of folders open all entries."""
    try:
        with os.scandir(folder) as entries:
            found = sorted((entry.name, entry.is_file()) for entry in entries)
    except OSError as error:
        raise FileError(f"cannot read the folder: {error.strerror}; check its permissions: {folder}") from None
    for name, is_file in found:
        if not is_file and ((entry := folder / name).is_fifo() or entry.is_socket() or entry.is_char_device()):
            raise FileError(
                f"the folder holds {printable(entry.name)!r}, which is a device, a pipe or a socket; "
                f"move the files to a folder of their own: {folder}"
            )
    return [name for name, _ in found]


def _family_by_content(family: str | None, path: Path) -> str | None:
    """The module that reads a file whose suffix or first bytes several formats have."""
    if family is None:
        from wavesplat._readers.simulations import vasp

        return "vasp" if vasp.is_named(path) else None
    if family == "hdf5":
        from wavesplat._readers.hdf5 import netcdf

        return "netcdf" if netcdf.is_netcdf(path) else family
    if family in ("vti", "vtk_legacy"):
        from wavesplat._readers.vtk import grids

        return "vtk_grids" if grids.is_grid(path) else family
    return family


def _family_by_magic(start: bytes) -> str | None:
    if begins_as_dicom(start):  # before the others: its first 128 bytes may be the beginning of a TIFF
        return "dicom"
    for (offset, magic), family in MAGIC.items():
        if start[offset:].startswith(magic):
            return family
    return None


def _check_options(request: Request, family: str) -> None:
    for option in sorted(request.given() - OPTIONS[family] - {"spacing", "unit"}):
        users = ", ".join(name for name, options in OPTIONS.items() if option in options)
        raise ArgumentError(
            f"{option}= has no meaning for this kind of file (only for: {users}); leave it out: {request.safe_path}"
        )
