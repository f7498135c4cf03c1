"""The paths of an upload that are opened: files that belong together, such as a series of DICOM, are one of them."""

from __future__ import annotations

import os
from collections.abc import Sequence
from pathlib import Path

from wavesplat._geometry.brain_surfaces import is_freesurfer
from wavesplat._geometry.opening import SUFFIXES as OF_GEOMETRY
from wavesplat._readers.opening import SUFFIXES as OF_VOLUMES
from wavesplat._scene.scene import MAX_LAYERS
from wavesplat._viewer.loose_slices import gathered
from wavesplat.errors import FileError

#: Suffix of a header -> suffixes of the files that hold its samples, which are not opened themselves.
PARTS = {
    (".mhd",): (".raw", ".zraw", ".raw.gz"),
    (".nhdr",): (".raw", ".raw.gz", ".gz", ".bz2"),
    (".hdr",): (".img", ".img.gz"),
    (".head",): (".brik", ".brik.gz"),
    (".par",): (".rec",),
    (".bov",): (".raw", ".bin", ".bof"),
    (".pvti", ".pvtr", ".pvts", ".pvtu", ".pvtp", ".vtm", ".vtmb", ".vthb"): (
        *(".vti", ".vtr", ".vts", ".vtu", ".vtp"),
        *(".bin", ".raw"),
    ),
}
#: Files of pages of TIFF, and of slices of DICOM, which make one volume together.
STACKS, SLICES = (".tif", ".tiff"), (".dcm", ".ima")
#: Files that say something about others, and are left out beside them.
BESIDE = (".json", ".txt", ".md", ".pdf", ".html", ".tsv", ".bval", ".bvec", ".png", ".jpg", ".jpeg", ".xml")
#: Entries of the root of a Zarr array or group.
ZARR = ("zarr.json", ".zattrs", ".zgroup", ".zarray")


def paths_in(folder: Path) -> list[Path]:
    """Paths below the folder of an upload that are opened, each a volume, a segmentation or a shape, by their names.

    Slices that lie in no folder are moved into one.

    Raises
    ------
    FileError
        If there is nothing, or more than a scene holds.
    """
    stores, files = _walked(folder)
    found = [*stores, *_units(files, folder)]
    if not found:
        raise FileError("nothing was sent that could be a volume: the folder is empty, or all its files are hidden")
    if len(found) > MAX_LAYERS:
        listed = ", ".join(path.name for path in found[:3])
        raise FileError(
            f"these are {len(found)} volumes ({listed}, ...), and a scene holds {MAX_LAYERS}; send fewer of them, or "
            "slices of one volume as a folder of DICOM or TIFF"
        )
    return found


def _walked(folder: Path) -> tuple[list[Path], list[Path]]:
    """Folders that are Zarr, and files elsewhere that are not hidden."""
    stores, files = list[Path](), list[Path]()
    for place, folders, names in os.walk(folder):
        if set(ZARR) & set(names):
            stores.append(Path(place))
            folders.clear()
            continue
        folders.sort()
        files += [Path(place) / name for name in sorted(names) if not name.startswith(".")]
    return stores, files


def _units(files: Sequence[Path], folder: Path) -> list[Path]:
    """The path of each volume or shape in some files."""
    headers = [file for file in files if any(_ends(file, header) for header in PARTS)]
    parts = [part for header, parts in PARTS.items() if any(_ends(file, header) for file in headers) for part in parts]
    # A .hdr is a header of Analyze, of which both files have one name; .gz alone ends other names too.
    whole = [file for file in files if file in headers or not _is_part(file, parts, headers)]
    slices = [file for file in whole if _is_slice(file)]
    stacks = [file for file in whole if _ends(file, STACKS)]
    others = [file for file in whole if file not in slices and file not in stacks]
    known = [file for file in others if _is_known(file) or is_freesurfer(file)]
    units = [gathered(some, folder) if len(some) > 1 else some[0] for some in (slices, stacks) if some]
    main = [file for file in known if not _ends(file, BESIDE)]
    units += main
    if not units:
        # Whatever is wrong with these is said by their reader.
        units = known or others[:1]
    return sorted(units)


def _is_part(file: Path, parts: Sequence[str], headers: Sequence[Path]) -> bool:
    if not _ends(file, parts):
        return False
    is_other_volume = file.name.lower().endswith((".nii.gz", ".mgh.gz", ".cube.gz"))
    return not is_other_volume and file not in headers


def _is_slice(file: Path) -> bool:
    """Whether a file is DICOM: by its suffix, or by its content under a name of another kind."""
    if _ends(file, SLICES) or file.name.upper() == "DICOMDIR":
        return True
    if _is_known(file):
        return False
    # Exports often leave the suffix out, or end names with a number.
    with file.open("rb") as stream:
        return stream.read(132)[128:] == b"DICM"


def _is_known(file: Path) -> bool:
    return _ends(file, (*OF_VOLUMES, *OF_GEOMETRY, ".wavelets", ".json"))


def _ends(file: Path, suffixes: Sequence[str]) -> bool:
    return file.name.lower().endswith(tuple(suffixes))
