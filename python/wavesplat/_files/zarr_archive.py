"""Zip archives that hold a Zarr store, such as `.ozx` (RFC 9 of OME-Zarr) and `.zarr.zip`: keys are read in place.

The store is at the top of the archive, or in a folder that is alone there. An entry says how long it is unpacked;
`zipfile` reads no further.
"""

from __future__ import annotations

import os
import threading
import zipfile
from pathlib import Path
from typing import Any

from wavesplat.errors import FileError

#: Documents that the root of a store has, one of them.
ROOT_NAMES = ("zarr.json", ".zgroup", ".zarray", ".zattrs")
#: Most entries of an archive: a larger directory takes long to read, and is a mistake or worse.
MAX_ENTRIES = 2_000_000


class ZarrArchive:
    """A zip archive whose entries are the keys of a store; opened when the first is read, anew in each process."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self._lock = threading.Lock()
        self._process = 0
        self._file: zipfile.ZipFile | None = None
        self._prefix = ""
        self._entries: dict[str, zipfile.ZipInfo] = {}

    def size(self, key: str) -> int | None:
        """Bytes at a key, unpacked; None if there are none."""
        self._opened()
        entry = self._entries.get(self._prefix + key)
        return None if entry is None or entry.is_dir() else entry.file_size

    def read(self, key: str, first: int, n: int) -> bytes:
        """Read `n` bytes at a key from the byte `first` on.

        Raises
        ------
        FileError
            If the entry is damaged or encrypted.
        """
        file = self._opened()
        entry = self._entries[self._prefix + key]
        if entry.flag_bits & 1:
            raise FileError(f"the archive is encrypted; unpack it first, with its password: {self.path}")
        try:
            with file.open(entry) as stream:
                stream.seek(first)
                content: bytes = stream.read(n)
        except (zipfile.BadZipFile, NotImplementedError, EOFError, ValueError) as error:
            raise FileError(
                f"truncated or damaged: {key!r} in the archive ({error}); copy it again: {self.path}"
            ) from None
        if len(content) < n:
            raise FileError(
                f"truncated: {key!r} in the archive has {len(content)} of {n} bytes; copy it again: {self.path}"
            )
        return content

    def names(self) -> list[str]:
        """Names at the root of the store."""
        self._opened()
        n = len(self._prefix)
        return sorted({name[n:].partition("/")[0] for name in self._entries if name.startswith(self._prefix)} - {""})

    def _opened(self) -> zipfile.ZipFile:
        with self._lock:
            file = self._file
            # A forked process shares the offset in the open file with its parent.
            if file is None or self._process != os.getpid():
                self._file = file = _opened_zip(self.path)
                self._process = os.getpid()
                self._entries = {entry.filename: entry for entry in file.infolist()}
                self._prefix = _prefix(self._entries) or ""
            return file

    def __eq__(self, other: object) -> bool:
        return isinstance(other, ZarrArchive) and self.path == other.path

    __hash__ = None  # type: ignore[assignment]

    def __reduce__(self) -> tuple[Any, ...]:
        return ZarrArchive, (self.path,)


def holds_zarr(path: Path) -> bool:
    """Whether a file is a zip archive with a Zarr store; False also for what cannot be read."""
    try:
        with _opened_zip(path) as archive:
            return _prefix({entry.filename: entry for entry in archive.infolist()}) is not None
    except (FileError, OSError):
        return False


def _opened_zip(path: Path) -> zipfile.ZipFile:
    try:
        archive = zipfile.ZipFile(path)
    except (zipfile.BadZipFile, ValueError) as error:
        raise FileError(f"the archive is truncated or damaged ({error}); copy it again: {path}") from None
    if len(archive.filelist) > MAX_ENTRIES:
        raise FileError(f"the archive holds more than {MAX_ENTRIES} files; unpack it first: {path}")
    return archive


def _prefix(entries: dict[str, zipfile.ZipInfo]) -> str | None:
    """The folder of a store in an archive, such as `a.zarr/`, or "" at its top; None where there is no store."""
    folders = {name.partition("/")[0] for name in entries}
    places = ["", *(f"{folder}/" for folder in folders if len(folders) == 1)]
    return next((place for place in places if any(place + name in entries for name in ROOT_NAMES)), None)
