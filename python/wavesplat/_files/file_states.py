"""Whether files are still what they were: size, time of writing and time of status change, looked at before and after.

What is known of samples (range, bounds of bricks) holds for the files that it was found in. Each read is checked after
it: where the state is the one from before all reads, nothing was written in between.

The time of status change (ctime) tells files apart whose time of writing was set back, and files moved to the name of
another. Inodes are left out: file systems in user space number files anew whenever they forget them. On Windows ctime
is the time of creation, so there the inode counts.
"""

from __future__ import annotations

import hashlib
import os
import time
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Protocol

from wavesplat.errors import FileError

__all__ = ["FileChangedError", "SourceFiles", "State", "StoredFiles", "state_of", "wait_for_next_tick"]

#: Size, and times in nanoseconds of writing and of status change (on Windows: the inode).
State = tuple[int, int, int]

#: Seconds between two writes that Linux tells apart for certain: its clock for files ticks 100 to 1000 times a second.
TICK = 0.02
#: The same of file systems with whole seconds (FAT counts every other one).
COARSE_TICK = 2.0


class FileChangedError(FileError):
    """A file is another than the one that was opened or looked through."""


class SourceFiles(Protocol):
    """The files that an array is read from."""

    def fingerprint(self) -> str | None:
        """Text that no other content of the files has; None where it could have been written to unseen."""

    def begin(self) -> None:
        """Look at all files, before the first sample is read; later calls do nothing."""

    def check_read(self, index: Sequence[int | slice]) -> None:
        """A `FileChangedError` if what was just read is not from the files that were looked at."""

    @property
    def n_changes(self) -> int:
        """How often `look_again` found that samples have changed."""

    def look_again(self) -> None:
        """Look whether samples have changed; a `FileChangedError` where the file must be opened again for them."""


def state_of(found: os.stat_result) -> State:
    """The state of a file."""
    return found.st_size, found.st_mtime_ns, found.st_ino if os.name == "nt" else found.st_ctime_ns


def wait_for_next_tick(written_ns: int) -> bool:
    """Wait until a write would have another time than that of the last one; False if that takes too long."""
    elapsed = time.time() - written_ns / 1e9
    if written_ns % 10**9 == 0:
        return not 0 <= elapsed < COARSE_TICK
    if 0 <= elapsed < TICK:
        time.sleep(TICK - elapsed)
    return True


class StoredFiles:
    """Files whose headers were read, so that they must be opened again once one of them has changed.

    paths : those that are not there count too: that they still are not.
    axis : the axis of the array that has a file for each index; None: each read is checked against all files.
    is_complete : whether these are all files that samples lie in; else nothing is kept of them.
    """

    def __init__(
        self, paths: Iterable[str | os.PathLike[str]], *, axis: int | None = None, is_complete: bool = True
    ) -> None:
        self._paths = [Path(path).absolute() for path in paths]
        self._axis, self._is_complete = axis, is_complete
        self._states = [_state_at(path) for path in self._paths]
        self._is_sent = False

    def begin(self) -> None:
        """Nothing: the files were looked at when they were opened."""

    def fingerprint(self) -> str | None:
        """Names, sizes and times of all files; None where the last write was just now, by a clock of whole seconds."""
        self.look_again()
        written = [state[1] for state in self._states if state is not None]
        if not self._is_complete or not written or not wait_for_next_tick(max(written)):
            return None
        told = "\n".join(f"{path} {state}" for path, state in zip(self._paths, self._states, strict=True))
        return hashlib.sha256(told.encode("utf-8", "surrogateescape")).hexdigest()

    def check_read(self, index: Sequence[int | slice]) -> None:
        """A `FileChangedError` if one of the files that were read has changed."""
        numbers: Iterable[int] = range(len(self._paths))
        if self._axis is not None:
            part = index[self._axis]
            numbers = (part,) if isinstance(part, int) else range(part.start or 0, part.stop)
        for number in numbers:
            self._check(number)

    @property
    def n_changes(self) -> int:
        """None: a change is an error."""
        return 0

    def look_again(self) -> None:
        """A `FileChangedError` if a file has changed."""
        for number in range(len(self._paths)):
            self._check(number)

    def have_changed(self) -> bool:
        """Whether a file has changed."""
        try:
            self.look_again()
        except FileChangedError:
            return True
        return False

    def _check(self, number: int) -> None:
        path, before = self._paths[number], self._states[number]
        now = _state_at(path)
        if now is None and before is not None:
            raise FileChangedError(f"the file is not there any more; put it back, or open another one: {path}")
        # Other machines may tell other times of status change of the same file.
        n = 2 if self._is_sent else 3
        if (now or ())[:n] != (before or ())[:n]:
            raise FileChangedError(f"the file was changed or replaced since it was opened; open it again: {path}")

    def __getstate__(self) -> dict[str, object]:
        return {**self.__dict__, "_is_sent": True}


def _state_at(path: Path) -> State | None:
    """The state of what has a name; None where nothing can be found there."""
    try:
        return state_of(path.stat())
    except (OSError, ValueError):
        return None
