"""A cache folder, whose files can be made again: small, private, and cleaned up by itself.

Its files are made of users' data, so only the user can read them. A file is written under a name that nobody can guess
and then moved to its own, so that readers and writers in several processes need no locks, and a link that somebody put
there is replaced, not followed.
"""

from __future__ import annotations

import os
import re
import stat
import tempfile
import time
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import BinaryIO

#: Bytes of all files together; the least recently used are removed first. A survey of 256^3 samples takes 18 MB.
MAX_BYTES = 2 << 30
#: Seconds after its last use when a file is removed: samples of data that is not looked at any more should not stay.
MAX_AGE = 30 * 24 * 3600.0
#: Seconds after its last write when an unfinished file, of a process that was killed, is removed.
MAX_PART_AGE = 24 * 3600.0

#: Names of our files: nothing else in a folder that the user has named is touched.
NAME = re.compile(r"[0-9a-f]{32}\.npz")
PART_PREFIX, PART_SUFFIX = ".wavesplat-", ".part"

#: Flags to read a regular file: no link is followed, and a pipe of its name does not make the reader wait for a writer.
READ_FLAGS = os.O_RDONLY | sum(getattr(os, name, 0) for name in ("O_NOFOLLOW", "O_NONBLOCK", "O_BINARY"))


def default_folder(kind: str) -> Path:
    """`$XDG_CACHE_HOME/wavesplat/...`, or the system's folder for caches; a `RuntimeError` where there is no home."""
    if os.name == "nt":
        base = os.environ.get("LOCALAPPDATA") or Path.home() / "AppData" / "Local"
    else:
        base = os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache"
    return Path(base) / "wavesplat" / kind


#: Folders that this process has tidied.
_TIDIED: set[Path] = set()


class CacheFolder:
    """A cache folder; its files have names of 32 hexadecimal digits and `.npz`.

    is_ours : whether nobody else has business there: its permissions are mended, and files of other users not read.
    """

    def __init__(self, path: Path, is_ours: bool) -> None:
        self.path, self._is_ours = path, is_ours

    def open(self, name: str) -> BinaryIO | None:
        """Open a file to read, which counts as its use; None where there is no regular file of the name."""
        if self.path not in _TIDIED:
            _TIDIED.add(self.path)
            self.tidy()
        try:
            handle = os.open(self.path / name, READ_FLAGS)
        except (OSError, ValueError):
            return None
        found = os.fstat(handle)
        is_of_another_user = self._is_ours and hasattr(os, "geteuid") and found.st_uid != os.geteuid()
        if is_of_another_user or not stat.S_ISREG(found.st_mode):
            os.close(handle)
            return None
        with suppress(OSError):  # of another user, or read-only
            os.utime(handle if os.utime in os.supports_fd else self.path / name)
        return os.fdopen(handle, "rb")

    def write(self, name: str, write: Callable[[BinaryIO], object]) -> None:
        """Put a file in place, whole or not at all; an `OSError` where that cannot be done."""
        self._make()
        handle, name_of_part = tempfile.mkstemp(PART_SUFFIX, PART_PREFIX, self.path)  # for the user alone
        part = Path(name_of_part)
        try:
            with os.fdopen(handle, "wb") as file:
                write(file)
            part.replace(self.path / name)
        finally:
            with suppress(OSError):
                part.unlink()
        self.tidy()

    def _make(self) -> None:
        """Make the folder, which only the user can enter where it is new or ours."""
        folders = (self.path.parent, self.path) if self._is_ours else (self.path,)
        folders[0].parent.mkdir(parents=True, exist_ok=True)
        for folder in folders:
            folder.mkdir(mode=0o700, exist_ok=True)
            if self._is_ours and os.name != "nt" and stat.S_IMODE(folder.stat().st_mode) != 0o700:
                folder.chmod(0o700)

    def tidy(self) -> None:
        """Remove files that were not used for `MAX_AGE`, and the least recently used ones beyond `MAX_BYTES`.

        Another process may do the same at once: a file that is gone already is no error.
        """
        now, kept = time.time(), []
        try:
            entries = list(os.scandir(self.path))
        except OSError:
            return
        for entry in entries:
            is_part = entry.name.startswith(PART_PREFIX) and entry.name.endswith(PART_SUFFIX)
            if not (is_part or NAME.fullmatch(entry.name)):
                continue
            with suppress(OSError):
                found = entry.stat(follow_symlinks=False)
                age = now - found.st_mtime
                if age > (MAX_PART_AGE if is_part else MAX_AGE):
                    Path(entry.path).unlink()
                elif not is_part:
                    kept.append((found.st_mtime, found.st_size, entry.path))
                    if self._is_ours and os.name != "nt" and stat.S_IMODE(found.st_mode) not in (0o600, 0o400):
                        # Written by releases that left it to the umask; never through a link.
                        _make_private(entry.path)
        total = sum(size for _, size, _ in kept)
        for _, size, path in sorted(kept):
            if total <= MAX_BYTES:
                break
            with suppress(OSError):
                Path(path).unlink()
            total -= size


def _make_private(path: str) -> None:
    handle = os.open(path, READ_FLAGS)
    try:
        if stat.S_ISREG(os.fstat(handle).st_mode):
            os.fchmod(handle, 0o600)
    finally:
        os.close(handle)
