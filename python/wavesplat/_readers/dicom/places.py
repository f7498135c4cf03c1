"""Files of DICOM as hospitals hand it over: a folder of folders, a DICOMDIR, or a zip archive.

Exports have a folder for each patient, study and series, mostly with a directory of the files (DICOMDIR, DICOM PS3.10,
8; its records are defined in PS3.3, F.3). A folder stands for all files below it. A zip archive is unpacked into a
temporary folder first, DICOM files alone, for as long as it is read.
"""

from __future__ import annotations

import os
import shutil
import tempfile
import weakref
import zipfile
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path, PurePosixPath
from time import time_ns
from typing import Any

from wavesplat._readers.dicom.pixel_data import header_dataset
from wavesplat._readers.dicom.values import integer, items, text
from wavesplat._storage.paths import check_text, check_within
from wavesplat._storage.reading import BoundedFile
from wavesplat._system.threads import check_cancelled
from wavesplat.errors import FileError, LimitError, WavesplatError

SUFFIXES = (".dcm", ".ima", ".dicom")
#: Largest depth of folders, and number of entries: a study of a patient has some thousands, a disk millions.
MAX_DEPTH, MAX_ENTRIES = 12, 100_000
#: Nanoseconds after which a folder's time of change is another one for a later change: FAT has steps of 2 s.
SETTLED_NS = 2_500_000_000
#: Share of the free space for temporary files that an unpacked archive may take.
MAX_SHARE = 0.5
#: Folders that operating systems add, without images.
NOT_OURS = ("__MACOSX", "$RECYCLE.BIN", "System Volume Information")
#: Bytes at the beginning of a file that show whether it is DICOM.
N_FIRST = 132
ZIP = b"PK\3\4"
#: Longest name of a file that is unpacked.
MAX_NAME = 100


def begins_as_dicom(head: bytes) -> bool:
    """Whether a file begins as DICOM does: with its mark or, without one, an element of group 8."""
    return head[128:132] == b"DICM" or head[:4] in (b"\x08\x00\x05\x00", b"\x08\x00\x00\x00", b"\x08\x00\x08\x00")


# Folders


def files_below(folder: Path, within: Path | None = None, kept: dict[str, Any] | None = None) -> list[Path]:
    """All files in a folder and in the folders below it, in order of names; each folder is entered once.

    Hidden folders, and the files that macOS puts beside others ("._name"), are left out.

    within : see `check_within`. kept : what is kept between the time points of a series; the list is, as long as no
        folder has another time of change.
    """
    key = f"files below {folder}, within {within}"
    known = None if kept is None else kept.get(key)
    if known is not None and all(_changed(place) == time for place, time in known[1].items()):
        files: list[Path] = known[0]
        return files
    started, times = time_ns(), dict[Path, int]()
    found = _listed_below(folder, within, times)
    # Of a folder that was changed a moment ago a later change may have the same time.
    if kept is not None and max(times.values(), default=0) < started - SETTLED_NS:
        kept[key] = found, times
    return found


def _changed(folder: Path) -> int | None:
    """When names in a folder were last added, changed or taken out, nanoseconds; None where it is not there."""
    try:
        return folder.stat().st_mtime_ns
    except OSError:
        return None


def _listed_below(folder: Path, within: Path | None, times: dict[Path, int]) -> list[Path]:
    """See `files_below`. times : gets the time of change of each folder, taken before it is read."""
    found: list[Path] = []
    seen: set[tuple[int, int]] = set()
    waiting = [(folder, 0)]
    while waiting:
        place, depth = waiting.pop()
        state = place.stat()
        if (state.st_dev, state.st_ino) in seen or depth > MAX_DEPTH:
            continue
        seen.add((state.st_dev, state.st_ino))
        times[place] = state.st_mtime_ns
        folders: list[tuple[Path, int]] = []
        for name, is_file, is_folder in _entries(place, is_top=depth == 0):
            if len(found) + len(seen) + len(waiting) + len(folders) > MAX_ENTRIES:
                raise FileError(
                    f"the folder holds more than {MAX_ENTRIES} files and folders; name the folder of a patient, a "
                    f"study or a series: {folder}"
                )
            if name.startswith("._") or name in NOT_OURS or not (is_file or (is_folder and not name.startswith("."))):
                continue
            entry = place / name
            check_text(entry)
            check_within(entry, within)
            if is_file:
                found.append(entry)
            else:
                folders.append((entry, depth + 1))
        waiting += reversed(folders)
    return found


def _entries(folder: Path, *, is_top: bool) -> list[tuple[str, bool, bool]]:
    """Names in a folder in order, whether each is a file, and a folder; none of a folder below that may not be read."""
    try:
        with os.scandir(folder) as entries:
            return sorted((entry.name, entry.is_file(), entry.is_dir()) for entry in entries)
    except PermissionError:
        if is_top:
            raise
        return []


# Directories, named DICOMDIR


def files_of_directory(file: Path, within: Path | None = None) -> tuple[list[Path], list[Path]]:
    """The files that a DICOMDIR names: existing ones and missing ones; no files if it is no DICOMDIR.

    Names on discs are in capitals, and are often copied in small letters: where a name is not found as it is written,
    case does not count.
    """
    with BoundedFile(file) as stream:
        dataset, _ = header_dataset(file, stream)
    records = items(dataset, 0x00041220)
    if len(records) > MAX_ENTRIES:
        raise FileError(f"the directory (DICOMDIR) has more than {MAX_ENTRIES} records; name a folder instead: {file}")
    listings: dict[Path, dict[str, str]] = {}
    found, missing = [], []
    for record in records:
        names = [name.strip() for name in text(record, 0x00041500).split("\\")]
        is_unused = 0x00041410 in record and integer(record, 0x00041410) == 0
        if is_unused or not any(names) or not all(map(_is_name, names)):
            continue
        place = _resolved(file.parent, names, listings)
        if place is None:
            missing.append(file.parent.joinpath(*names))
        else:
            check_within(place, within)
            found.append(place)
    return list(dict.fromkeys(found)), list(dict.fromkeys(missing))


def _is_name(name: str) -> bool:
    """Whether a part of a path names an entry of its folder, and leads nowhere else."""
    return name not in ("", ".", "..") and not any(sign in name for sign in "/\0:")


def _resolved(folder: Path, names: Sequence[str], listings: dict[Path, dict[str, str]]) -> Path | None:
    """The file of this path below a folder, in any case; None if it is not there."""
    place = folder
    for name in names:
        entry = name
        if not (place / name).exists():
            if place not in listings:
                entries = [one.name for one in place.iterdir()] if place.is_dir() else []
                listings[place] = {one.casefold(): one for one in entries}
            entry = listings[place].get(name.casefold(), "")
            if not entry:
                return None
        place = place / entry
    return place if place.is_file() else None


# Archives of kind zip


def is_zip(path: Path) -> bool:
    """Whether a file is a zip archive."""
    if not path.is_file():
        return False
    with path.open("rb") as file:
        return file.read(len(ZIP)) == ZIP


class _TemporaryFolder:
    """A temporary folder that is removed with the object, at the latest when Python ends."""

    def __init__(self) -> None:
        self.name = tempfile.mkdtemp(prefix="wavesplat-")
        self.cleanup = weakref.finalize(self, shutil.rmtree, self.name, ignore_errors=True)


@contextmanager
def unpacked(path: Path, kept: dict[str, Any] | None) -> Iterator[Path]:
    """A temporary folder with the DICOM files of a zip archive; errors name the archive in its place.

    kept : state of a series, with which the folder stays from one time point to the next.
    """
    state = path.stat()
    key = (state.st_mtime_ns, state.st_size)
    before, folder = (kept or {}).get("unpacked zip", (None, None))
    if before != key:
        folder = _TemporaryFolder()
        if kept is not None:
            kept["unpacked zip"] = (key, folder)
        try:
            _unpack(path, Path(folder.name))
        except BaseException:
            (kept or {}).pop("unpacked zip", None)
            folder.cleanup()
            raise
    try:
        yield Path(folder.name)
    except WavesplatError as error:
        error.args = (str(error).replace(folder.name, str(path)),)
        raise
    finally:
        if kept is None:
            folder.cleanup()


def _unpack(path: Path, folder: Path) -> None:
    with zipfile.ZipFile(path) as archive:
        members = [one for one in archive.infolist() if _is_wanted(one, path)]
        if len(members) > MAX_ENTRIES:
            raise FileError(f"the zip archive holds more than {MAX_ENTRIES} files; unpack it first: {path}")
        # Archives that are made to overwhelm count the same bytes again and again.
        if sum(one.compress_size for one in members) > path.stat().st_size:
            raise FileError(f"the zip archive says that it holds more bytes than there are; make it again: {path}")
        room = shutil.disk_usage(folder).free * MAX_SHARE
        if (needed := sum(one.file_size for one in members)) > room:
            raise LimitError(
                f"the zip archive unpacks to {needed / 1e9:.3g} GB, and there is room for {room / 1e9:.3g} GB; "
                f"unpack it first, where there is: {path}"
            )
        n_found = 0
        for member in members:
            check_cancelled()
            with archive.open(member) as packed:
                head = packed.read(N_FIRST)
                if not (begins_as_dicom(head) or member.filename.lower().endswith(SUFFIXES)):
                    continue
                with _free_name(folder, member.filename).open("wb") as file:
                    file.write(head)
                    shutil.copyfileobj(packed, file)
                n_found += 1
    if not n_found:
        raise FileError(
            f"the zip archive holds no DICOM files, and no others are read from one; unpack it, and name the volume in "
            f"it: {path}"
        )


def _is_wanted(member: zipfile.ZipInfo, path: Path) -> bool:
    if member.flag_bits & 1:
        raise FileError(f"the zip archive is encrypted; unpack it first, with its password: {path}")
    return not member.is_dir() and not any(
        part.startswith("._") or part in NOT_OURS for part in PurePosixPath(member.filename).parts
    )


def _free_name(folder: Path, name: str) -> Path:
    """A path below a folder for a file of an archive, whose folders are made: nothing outside, nothing overwritten."""
    parts = [_cleaned(part) for part in name.replace("\\", "/").split("/") if part not in ("", ".", "..")] or ["file"]
    place = folder
    for part in parts[:-1][-MAX_DEPTH:]:
        place = place / part
        while place.is_file():
            place = place.with_name(f"{place.name}_")
    place.mkdir(parents=True, exist_ok=True)
    place = place / parts[-1]
    while place.exists():
        place = place.with_name(f"_{place.name}")
    return place


def _cleaned(part: str) -> str:
    return "".join(sign if sign.isprintable() and sign not in ':*?"<>|' else "_" for sign in part)[-MAX_NAME:]
