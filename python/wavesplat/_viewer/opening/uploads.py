"""Files that pages send: written to a folder of their own, which only the user can enter, and removed when not needed.

A page names files by where they lay in what was dropped, such as `series/IM001.dcm`. Names are checked, files are made
new and never through a link, and nothing else is ever written there, so that no name leads anywhere else.

Files are needed while they are sent and read, and then as long as an object reads on from them, such as a series of
times. The catalogue holds the objects that undo can bring back, so no other record of uses is kept.
"""

from __future__ import annotations

import _thread
import os
import shutil
import tempfile
import threading
import weakref
from collections.abc import Iterable
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from wavesplat._system.values import described
from wavesplat.errors import ArgumentError, FileError

#: Largest upload: bytes and files together; larger data are opened where they lie, by the command.
MAX_BYTES, MAX_FILES = 4 << 30, 20_000
#: Largest number of bytes and files of all uploads of a viewer, finished ones included while their files are needed.
MAX_TOTAL_BYTES, MAX_TOTAL_FILES = 16 << 30, 100_000
#: Largest length of a name in bytes, and depth of folders.
MAX_NAME, MAX_PARTS = 255, 16
#: Bytes that must stay free on the disk.
SPARE_BYTES = 256 << 20
#: Uploads that may be under way at once.
MAX_OPEN = 8

CREATED = os.O_WRONLY | os.O_CREAT | os.O_EXCL | getattr(os, "O_BINARY", 0)
APPENDED = os.O_WRONLY | os.O_APPEND | getattr(os, "O_NOFOLLOW", 0) | getattr(os, "O_BINARY", 0)


@dataclass
class Upload:
    """Files of a page, some of which may be on their way."""

    number: int
    owner: Any
    folder: Path
    n_bytes: int
    n_files: int
    #: Bytes and files that have come.
    received: int = 0
    begun: int = 0
    is_complete: bool = False
    is_removed: bool = False
    #: Number of objects that read on from the files.
    n_readers: int = 0
    #: Held by writing and removing, so that no file is made in a folder that is being removed.
    lock: threading.Lock = field(default_factory=threading.Lock)

    def write(self, path: object, offset: object, payload: bytes) -> int:
        """Write the next bytes of a file; the number of bytes of all files that have come.

        Raises
        ------
        ArgumentError
            If the name is none of a file below the folder, or the bytes are not the next ones, or too many, or the
            upload is complete or was removed.
        FileError
            If the disk is full.
        """
        place = self.folder.joinpath(*checked_parts(path))
        if not isinstance(offset, int) or isinstance(offset, bool) or offset < 0:
            raise ArgumentError(f"upload: offset is {described(offset)}; it must be a whole number")
        with self.lock:
            return self._write(place, path, offset, payload)

    def remove(self) -> None:
        """Remove the files, after a write that is under way; later ones are refused."""
        with self.lock:
            self.is_removed = True
            shutil.rmtree(self.folder, ignore_errors=True)

    def _write(self, place: Path, path: object, offset: int, payload: bytes) -> int:
        if self.is_removed or self.is_complete:
            what = "was cancelled" if self.is_removed else "is complete"
            raise ArgumentError(f"upload {self.number} {what}, so that it takes no more bytes; send the files again")
        if self.received + len(payload) > self.n_bytes or (offset == 0 and self.begun >= self.n_files):
            raise ArgumentError(f"upload: more came than the {self.n_files} files of {self.n_bytes} bytes in all")
        try:
            self._append(place, offset, payload)
        except FileExistsError:
            raise ArgumentError(f"upload: the name {path!r} came twice; send each file once") from None
        except OSError as error:
            raise FileError(f"the files cannot be stored: {error.strerror or error}: {self.folder}") from None
        self.received += len(payload)
        return self.received

    def _append(self, place: Path, offset: int, payload: bytes) -> None:
        if offset == 0:
            place.parent.mkdir(mode=0o700, parents=True, exist_ok=True)
        handle = os.open(place, CREATED if offset == 0 else APPENDED, 0o600)
        with os.fdopen(handle, "ab") as file:
            if file.tell() != offset:
                raise ArgumentError(f"upload: bytes from {offset} came, and the file has {file.tell()}")
            file.write(payload)
        self.begun += offset == 0


class Uploads:
    """All uploads of a viewer, in one folder that is removed with it."""

    def __init__(self) -> None:
        self._uploads: dict[int, Upload] = {}
        self._next = 1
        self._folder: Path | None = None
        self._lock = threading.Lock()
        self._remove: Any = None
        self._is_closed = False

    def begin(self, owner: Any, n_files: object, n_bytes: object) -> Upload:
        """A new upload.

        Raises
        ------
        ArgumentError
            If it, or all uploads together, would be larger than allowed, or the viewer is closed.
        FileError
            If the disk has no room for it.
        """
        files, size = _count("files", n_files), _count("bytes", n_bytes)
        if size > MAX_BYTES or not 1 <= files <= MAX_FILES:
            raise ArgumentError(
                f"{files} files of {size / 1e9:.3g} GB are too many; a page sends up to {MAX_FILES} files of "
                f"{MAX_BYTES >> 30} GiB in all; open larger data where they lie: wavesplat view FILE"
            )
        with self._lock:
            if self._is_closed:
                raise ArgumentError("the viewer is closed, so that it takes no files; open it again")
            others = list(self._uploads.values())
            if sum(not one.is_complete for one in others) >= MAX_OPEN:
                raise ArgumentError(f"{MAX_OPEN} uploads are under way; wait for one of them, or cancel it")
            _check_total(others, files, size)
            root = self._made()
            free = shutil.disk_usage(root).free
            if size > free - SPARE_BYTES:
                raise FileError(
                    f"the files have {size / 1e9:.3g} GB, and the disk has {free / 1e9:.3g} GB left; make room, or set "
                    f"TMPDIR to a folder elsewhere: {root}"
                )
            number, self._next = self._next, self._next + 1
            folder = root / str(number)
            folder.mkdir(mode=0o700)
            made = self._uploads[number] = Upload(number, owner, folder, size, files)
            return made

    def get(self, number: object) -> Upload:
        """The upload of a number; an `ArgumentError` without one."""
        with self._lock:
            found = self._uploads.get(number) if isinstance(number, int) and not isinstance(number, bool) else None
        if found is None:
            raise ArgumentError(f"upload is {described(number)}; there is none of that number, or it was cancelled")
        return found

    def discard(self, number: object) -> None:
        """Remove an upload and its files, if there is one."""
        found = self._uploads.pop(number, None) if isinstance(number, int) else None
        if found is not None:
            found.remove()

    def discard_after(self, number: int, readers: Iterable[object]) -> None:
        """Remove an upload when none of the objects that read on from its files is left; at once without any."""
        upload = self._uploads.get(number)
        if upload is None:  # its page has gone meanwhile
            return
        held = list({id(one): one for one in readers}.values())
        upload.n_readers = len(held)
        if not held:
            self.discard(number)
        for one in held:
            weakref.finalize(one, self._reader_gone, upload).atexit = False

    def _reader_gone(self, upload: Upload) -> None:
        upload.n_readers -= 1
        if upload.n_readers == 0:
            # The garbage collector may call this in any thread, also in one that holds a lock.
            with suppress(RuntimeError):  # at the end of the process, when all is removed anyway
                _thread.start_new_thread(self.discard, (upload.number,))

    def leave(self, owner: Any) -> None:
        """Remove the unfinished uploads of a page that has gone."""
        with self._lock:
            uploads = list(self._uploads.values())
            left = [one.number for one in uploads if one.owner == owner and not one.is_complete]
        for number in left:
            self.discard(number)

    def close(self) -> None:
        """Remove all files, after writes that are under way; there are no uploads any more."""
        with self._lock:
            self._is_closed = True
            left = list(self._uploads.values())
            self._uploads.clear()
        for upload in left:
            upload.remove()
        if self._remove is not None:
            self._remove()

    def _made(self) -> Path:
        if self._folder is None:
            self._folder = Path(tempfile.mkdtemp(prefix="wavesplat-open-"))  # only the user can enter it
            self._remove = weakref.finalize(self, shutil.rmtree, self._folder, ignore_errors=True)
        return self._folder


def _check_total(others: list[Upload], n_files: int, n_bytes: int) -> None:
    """Raise an `ArgumentError` if a further upload would make all of them too large together."""
    held_files, held = sum(one.n_files for one in others), sum(one.n_bytes for one in others)
    if held + n_bytes > MAX_TOTAL_BYTES or held_files + n_files > MAX_TOTAL_FILES:
        raise ArgumentError(
            f"{n_files} files of {n_bytes / 1e9:.3g} GB are too many beside the {held_files} of {held / 1e9:.3g} GB "
            f"that pages sent before and that are still needed; all together may be {MAX_TOTAL_FILES} files of "
            f"{MAX_TOTAL_BYTES >> 30} GiB; cancel what is being sent, or open the files where they lie: "
            "wavesplat view FILE"
        )


def checked_parts(path: object) -> list[str]:
    """The folders and the name of a file in an upload.

    Raises
    ------
    ArgumentError
        If the path leads out of its folder, or no system would take it.
    """
    parts = path.split("/") if isinstance(path, str) else []
    if not 1 <= len(parts) <= MAX_PARTS or not all(map(_is_name, parts)):
        raise ArgumentError(
            f"upload: the name {described(path)} is none of a file in a folder: at most {MAX_PARTS} names with / "
            "between them, none of them empty, '.' or '..', without \\ and control characters"
        )
    return parts


def _is_name(part: str) -> bool:
    try:
        n_bytes = len(part.encode())
    except UnicodeEncodeError:
        return False
    refused = '\\:"<>|?*' if os.name == "nt" else "\\"
    is_plain = not any(letter in refused or ord(letter) < 32 or ord(letter) == 127 for letter in part)
    return 0 < n_bytes <= MAX_NAME and part.strip(" .") != "" and is_plain


def _count(name: str, given: object) -> int:
    if not isinstance(given, int) or isinstance(given, bool) or not 0 <= given < 1 << 60:
        raise ArgumentError(f"upload: {name} is {described(given)}; it must be a whole number")
    return given
