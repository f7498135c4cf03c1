"""Places of Zarr stores: a folder, a zip archive or an address, whose keys are read.

A chunk may be a link to a device without an end, a server may send for ever, or 4 kB that unpack to gigabytes. How
many bytes a chunk can have is known from the metadata of its array, and nothing is read beyond.
"""

from __future__ import annotations

import io
import os
import stat
import threading
import zipfile
from collections.abc import Coroutine
from pathlib import Path, PurePath
from typing import Any

from wavesplat._storage import web
from wavesplat._storage.addresses import below, is_web, safe_address
from wavesplat._storage.paths import check_within
from wavesplat._storage.web import ForbiddenError, Part
from wavesplat._system.threads import warn
from wavesplat.errors import FileError, FileWarning

# Zip archives that hold a Zarr store, such as `.ozx` (RFC 9 of OME-Zarr) and `.zarr.zip`: keys are read in place.
#
# The store is at the top of the archive, or in a folder that is alone there. An entry says how long it is unpacked;
# `zipfile` reads no further.

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


# Places of Zarr stores, a folder, a zip archive or an address: keys are read, up to the sizes that the metadata allow.

#: The error for a library that would write.
READ_ONLY = "places are only read"

#: Names of metadata documents; every other key names a chunk.
METADATA_NAMES = ("zarr.json", ".zarray", ".zattrs", ".zgroup", ".zmetadata")
#: Largest metadata document, in bytes; a store with thousands of arrays has one of a few megabytes.
MAX_METADATA_BYTES = 1 << 26
#: Largest metadata document of a server that is kept, bytes.
MAX_KNOWN_BYTES = 1 << 20
#: Refused keys that are remembered, at most.
MAX_REFUSED = 1000


class ZarrPlace:
    """The place of a Zarr store: a folder, a zip archive or an address.

    Parameters
    ----------
    where : Path or str
        A folder, a file, which must be a zip archive, or an address of the protocols that are opened.
    within : Path, optional
        The folder of a document that names it: files must lie in it, also where links lead, and hosts be public.
    """

    def __init__(self, where: Path | str, *, within: Path | None = None) -> None:
        self.archive = ZarrArchive(where) if isinstance(where, Path) and where.is_file() else None
        self.root = where if isinstance(where, Path) and self.archive is None else None
        self.address = "" if isinstance(where, Path) else where
        self._within = within
        self._max_bytes: dict[str, int] = {}
        #: Keys of chunks and of metadata that the server refuses, and whether it gave any chunk.
        self.refused: dict[str, None] = {}
        self.has_chunks = False
        #: Whether the first refused chunk is warned of at once: where samples are read as they are drawn.
        self.warns = False
        #: Metadata that a server gave, or None for what it does not have: checks and libraries ask for each many times.
        self._known: dict[str, bytes | None] = {}
        self._lock = threading.Lock()

    @property
    def is_local(self) -> bool:
        """Whether it is a folder or a file of this machine."""
        return not self.address

    def expect(self, array: str, n_bytes: int) -> None:
        """Set the largest size of a chunk of the array at this key."""
        self._max_bytes[array.strip("/")] = n_bytes

    def read(self, key: str, part: Part = None) -> bytes | None:
        """The bytes at a key, or a part of them; None if there are none.

        Raises
        ------
        FileError
            If it cannot be read, or is more than can be there.
        """
        self._check_key(key)
        if self.is_local:
            return self._with_note(key, self._of_file(key, part))
        if part is None and key in self._known:
            return self._known[key]
        from fsspec.asyn import get_loop, sync

        content: bytes | None = sync(get_loop(), self._request, key, part)
        return self._with_note(key, content, part)

    async def read_async(self, key: str, part: Part = None) -> bytes | None:
        """Read a key as `read` does, for asyncio: other keys are read meanwhile."""
        import asyncio

        self._check_key(key)
        if self.is_local:
            return self._with_note(key, await asyncio.to_thread(self._of_file, key, part))
        if part is None and key in self._known:
            return self._known[key]
        from fsspec.asyn import get_loop

        # fsspec has a loop of its own, which its sessions belong to. Errors come as values: zarr leaves requests alone
        # after the first error, and asyncio would complain that nobody asked for the errors of the others.
        request = asyncio.run_coroutine_threadsafe(_result_or_error(self._request(key, part)), get_loop())
        content, error = await asyncio.wrap_future(request)
        if error is not None:
            raise error
        return self._with_note(key, content, part)

    def mark(self, key: str) -> str | None:
        """The web server's mark of a key's version (ETag or time of change); None without one."""
        if not is_web(self.address):
            return None
        from fsspec.asyn import get_loop, sync

        mark: str | None = sync(get_loop(), web.mark_of, below(self.address, key), public_only=self._within is not None)
        return mark

    def names(self) -> list[str]:
        """Names of the arrays, groups and chunks at the root, sorted; empty where they cannot be listed."""
        if self.root is not None:
            try:
                found = [entry.name for entry in self.root.iterdir()]
            except OSError:
                return []
        elif self.archive is not None:
            found = self.archive.names()
        elif is_web(self.address):
            return []  # a page of links is no list
        else:
            files, root = self._bucket()
            try:
                found = [path.rstrip("/").rpartition("/")[2] for path in files.ls(root, detail=False)]
            except OSError:
                return []
        return sorted(name for name in found if not name.startswith(".") and name not in METADATA_NAMES)

    def _with_note(self, key: str, content: bytes | None, part: Part = None) -> bytes | None:
        """The content, unchanged, after noting that the place gives chunks, or metadata of a server."""
        if not _is_metadata(key):
            self.has_chunks = self.has_chunks or content is not None
        elif not self.is_local and part is None and len(content or b"") <= MAX_KNOWN_BYTES:
            self._known[key] = content
        return content

    def _max_bytes_of(self, key: str) -> int:
        """Largest number of bytes that a key may hold."""
        if _is_metadata(key):
            return MAX_METADATA_BYTES
        arrays = [array for array in self._max_bytes if not array or key.startswith(f"{array}/")]
        return self._max_bytes[max(arrays, key=len)] if arrays else MAX_METADATA_BYTES

    def _of_file(self, key: str, part: Part) -> bytes | None:
        if self.archive is not None:
            size = self.archive.size(key)
            return None if size is None else self.archive.read(key, *self._bounds(key, size, part))
        path = f"{self.root}/{key}"  # a Path costs more than what is done with it, chunk by chunk
        try:
            found = os.stat(path)  # noqa: PTH116
        except (FileNotFoundError, NotADirectoryError):
            return None
        if not stat.S_ISREG(found.st_mode):
            kind = "a folder" if stat.S_ISDIR(found.st_mode) else "a device, a pipe or a socket"
            what = "" if _is_metadata(key) else "chunk "
            raise FileError(f"{what}{key!r} is {kind} and no file; copy or export the data again: {self.root}")
        if self._within is not None:
            check_within(Path(path), self._within, key)
        first, n = self._bounds(key, found.st_size, part)
        with open(path, "rb", buffering=0) as file:  # noqa: PTH123
            file.seek(first)
            return _read_whole(file, n)

    def _bounds(self, key: str, size: int, part: Part) -> tuple[int, int]:
        """First byte and number of bytes of a part of a key's content of `size` bytes."""
        most = self._max_bytes_of(key)
        first, end = (0, None) if part is None else part
        first = max(size + first, 0) if first < 0 else first
        n = max((size if end is None else min(end, size)) - first, 0)
        if (part is None and size > most) or n > most:
            raise self._too_long(key, most, size)
        return first, n

    async def _request(self, key: str, part: Part) -> bytes | None:
        most = self._max_bytes_of(key)
        try:
            if is_web(self.address):
                return await web.get(below(self.address, key), most, part, public_only=self._within is not None)
            return await self._of_bucket(key, most, part)
        except (ForbiddenError, PermissionError):
            self._refuse(key)
            return None

    async def _of_bucket(self, key: str, most: int, part: Part) -> bytes | None:
        """Read a key by the protocol's library, asking for a byte more than allowed, to notice longer content."""
        files, root = self._bucket()
        first, end = (0, None) if part is None else part
        if -first > most:
            raise self._too_long(key, most, -first)
        if first >= 0:
            end = min(first + most + 1, first + most + 1 if end is None else end)
        try:
            content: bytes = await files._cat_file(f"{root}/{key}", start=first, end=end)
        except FileNotFoundError:
            return None
        if len(content) > most:
            raise self._too_long(key, most, len(content))
        return content

    def _bucket(self) -> tuple[Any, str]:
        import fsspec

        protocol, _, root = self.address.partition("://")
        return fsspec.filesystem(protocol.lower()), root.rstrip("/")

    def _check_key(self, key: str) -> None:
        """Raise a `FileError` for a key that leads out of the place; in a folder also by backslashes or drives."""
        leads_out = ".." in key.split("/") or key.startswith("/") or "\0" in key
        if self.is_local and ("\\" in key or ":" in key):
            path = PurePath(key)
            leads_out = leads_out or bool(path.anchor) or ".." in path.parts
        if leads_out:
            raise FileError(
                f"{key!r} leads out of the Zarr folder; name an array in it, or mend the metadata that name it"
            )

    def _too_long(self, key: str, most: int, found: int) -> FileError:
        return FileError(
            f"{key!r} has {found} bytes, and there can be at most {most}; the data are damaged, or not what they say: "
            f"{self}"
        )

    def _refuse(self, key: str) -> None:
        with self._lock:
            is_first = not any(not _is_metadata(one) for one in self.refused)
            if len(self.refused) < MAX_REFUSED:
                self.refused[key] = None
        if self.warns and is_first and not _is_metadata(key):
            warn(
                f"the server refuses (403) chunk {key!r}; it and others like it count as not there, so their samples "
                f"have the fill value: {self}",
                FileWarning,
                stacklevel=2,
            )

    def __eq__(self, other: object) -> bool:
        return isinstance(other, ZarrPlace) and (self.root, self.archive, self.address, self._within) == (
            other.root,
            other.archive,
            other.address,
            other._within,
        )

    __hash__ = None  # type: ignore[assignment]

    def __str__(self) -> str:
        own = self.root if self.archive is None else self.archive.path
        return safe_address(self.address) if own is None else str(own)

    def __getstate__(self) -> dict[str, Any]:
        return {name: value for name, value in vars(self).items() if name != "_lock"}

    def __setstate__(self, state: dict[str, Any]) -> None:
        vars(self).update(state)
        self._lock = threading.Lock()


def _read_whole(file: io.RawIOBase, n: int) -> bytes:
    """Read `n` bytes, or those up to the end of the file; one call of the system may give fewer."""
    content = file.read(n) or b""
    while len(content) < n and (more := file.read(n - len(content))):
        content += more
    return content


async def _result_or_error(request: Coroutine[Any, Any, bytes | None]) -> tuple[bytes | None, Exception | None]:
    """The result of a request and None, or None and its error."""
    try:
        return await request, None
    except Exception as error:  # noqa: BLE001 - raised where it is waited for
        return None, error


def _is_metadata(key: str) -> bool:
    return key.rpartition("/")[2] in METADATA_NAMES


def place_of(array: Any) -> ZarrPlace | None:
    """The place of an array or group of zarr whose store is a `PlaceStore`; None for other stores."""
    found = getattr(array.store_path.store, "place", None)
    return found if isinstance(found, ZarrPlace) else None
