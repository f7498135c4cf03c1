"""Contents of an upload: files that belong together, slices without a folder, and objects that read on from them."""

from __future__ import annotations

import os
from collections.abc import Iterator, Sequence
from itertools import takewhile
from pathlib import Path
from typing import Any

import numpy as np

from wavesplat._geometry.files.brain_surfaces import is_freesurfer
from wavesplat._geometry.files.opening import SUFFIXES as OF_GEOMETRY
from wavesplat._model.lazy.volume import LazyVolume
from wavesplat._model.volume.series import Series
from wavesplat._model.volume.volume import Volume
from wavesplat._readers.dicom.header import header_of
from wavesplat._readers.opening import SUFFIXES as OF_VOLUMES
from wavesplat._scene.scene import MAX_LAYERS
from wavesplat._viewer.opening.open_paths import Found
from wavesplat.errors import FileError

# Objects that read on from the files that were opened: an upload stays on the disk as long as one of them is there.
#
# Most volumes, segmentations and shapes are in memory and need their files no more.


def readers_of(found: Found) -> Iterator[object]:
    """The objects that read on from the files of what was found; copies, parts and moved volumes share them."""
    for layer in found.layers:
        for thing in (layer.volume, layer.drawn):
            yield from _readers_of(thing)


def _readers_of(thing: object) -> Iterator[object]:
    if isinstance(thing, Series):
        yield thing._volumes
    elif isinstance(thing, LazyVolume):
        yield from (level.array for level in thing._levels)
    elif isinstance(thing, Volume) and (mapped := _mapped(thing.samples)) is not None:
        yield mapped


def _mapped(samples: Any) -> object | None:
    """The map of a file in memory that an array is a view of; None of other arrays."""
    while samples is not None and not isinstance(samples, np.memmap):
        samples = getattr(samples, "base", None)
    return getattr(samples, "_mmap", None)  # one object for all views


# Slices that were sent without a folder: they are moved into one, whose name the page shows.
#
# Without it their folder would be the folder of the upload, which has a number for a name.

#: Headers that are read to see whether all slices are of one series, and letters of a name, at most.
MAX_HEADERS, MAX_LETTERS = 16, 60
#: Name of slices whose files have nothing in common.
NAMELESS = "slices"


def gathered(files: Sequence[Path], folder: Path) -> Path:
    """The folder that holds some files of an upload; files in the upload's own folder get one of their own.

    files : two or more. folder : of the upload.
    """
    common = Path(os.path.commonpath([file.parent for file in files]))
    if common != folder:
        return common
    made = _free(folder / (_description(files) or _common_start(files) or NAMELESS))
    for file in files:
        place = made / file.relative_to(folder)
        place.parent.mkdir(mode=0o700, parents=True, exist_ok=True)
        file.rename(place)
    return made


def _free(place: Path) -> Path:
    """A place beside others that is not taken."""
    number, wanted = 2, place
    while place.exists():
        number, place = number + 1, wanted.with_name(f"{wanted.name} {number}")
    return place


def _description(files: Sequence[Path]) -> str:
    """The description of the series (DICOM) that all of some files have; "" without one."""
    step = -(-len(files) // MAX_HEADERS)
    found = set[str]()
    for file in files[::step]:
        try:
            header = header_of(file)
        except Exception:  # noqa: BLE001 - parsers of damaged files raise nearly anything; the reader says what is wrong
            return ""
        found.add("" if header is None else _as_name(header.description))
    return found.pop() if len(found) == 1 else ""


def _common_start(files: Sequence[Path]) -> str:
    """The beginning of all names without the numbers at its end, at least two letters of it."""
    stems = sorted(file.stem for file in files)
    # What the first and the last one have in common in the order of letters, all between them have.
    same = takewhile(lambda pair: pair[0] == pair[1], zip(stems[0], stems[-1], strict=False))
    start = "".join(letter for letter, _ in same).rstrip("0123456789 ._-")
    return _as_name(start) if len(start) > 1 else ""


def _as_name(text: str) -> str:
    """The text as the name of a folder on any system."""
    plain = "".join(letter if letter.isalnum() or letter in " ._-+()" else " " for letter in text)
    return " ".join(plain.split())[:MAX_LETTERS].strip(" .")


# The paths of an upload that are opened: files that belong together, such as a series of DICOM, are one of them.

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
