"""States of files, to notice changes: size, time of writing and time of status change, before and after reads.

What is known of samples (range, bounds of bricks) holds for the files that it was found in. Each read is checked after
it: where the state is the one from before all reads, nothing was written in between.

The time of status change (ctime) also shows writes whose time was set back, and files moved to the name of
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

#: Size, and times in nanoseconds of writing and of status change (on Windows: the inode).
State = tuple[int, int, int]

#: Seconds between two writes that Linux surely distinguishes: its clock for files ticks 100 to 1000 times a second.
TICK = 0.02
#: Seconds between two writes that file systems with whole seconds distinguish (FAT counts every other one).
COARSE_TICK = 2.0


class FileChangedError(FileError):
    """A file is not the one any more that was opened or looked through."""


class SourceFiles(Protocol):
    """The files that an array is read from."""

    def fingerprint(self) -> str | None:
        """Text that identifies the content of the files; None where a write could have gone unnoticed."""

    def begin(self) -> None:
        """Record the states of all files, before the first sample is read; later calls do nothing."""

    def check_read(self, index: Sequence[int | slice]) -> None:
        """Raise a `FileChangedError` if a file that was just read is not in its recorded state."""

    @property
    def n_changes(self) -> int:
        """Number of changes of samples that `look_again` has found."""

    def look_again(self) -> None:
        """Check whether samples have changed; a `FileChangedError` where their file must be opened again."""


def state_of(found: os.stat_result) -> State:
    """The state of a file."""
    return found.st_size, found.st_mtime_ns, found.st_ino if os.name == "nt" else found.st_ctime_ns


def wait_for_next_tick(written_ns: int) -> bool:
    """Wait until a write would have another time than the last one; False if that takes too long."""
    elapsed = time.time() - written_ns / 1e9
    if written_ns % 10**9 == 0:
        return not 0 <= elapsed < COARSE_TICK
    if 0 <= elapsed < TICK:
        time.sleep(TICK - elapsed)
    return True


class StoredFiles:
    """Files whose headers were read, so that they must be opened again once one of them has changed.

    paths : the files; one that is missing counts too, and must stay missing.
    axis : the axis of the array that has a file for each index; None: each read is checked against all files.
    is_complete : whether these are all files that samples lie in; else no fingerprint is given.
    """

    def __init__(
        self, paths: Iterable[str | os.PathLike[str]], *, axis: int | None = None, is_complete: bool = True
    ) -> None:
        self._paths = [Path(path).absolute() for path in paths]
        self._axis, self._is_complete = axis, is_complete
        self._states = [_state_at(path) for path in self._paths]
        self._is_sent = False

    def begin(self) -> None:
        """Do nothing: the states were recorded when the files were opened."""

    def fingerprint(self) -> str | None:
        """Hash of names, sizes and times of all files; None where the last write was just now, by whole seconds."""
        self.look_again()
        written = [state[1] for state in self._states if state is not None]
        if not self._is_complete or not written or not wait_for_next_tick(max(written)):
            return None
        lines = "\n".join(f"{path} {state}" for path, state in zip(self._paths, self._states, strict=True))
        return hashlib.sha256(lines.encode("utf-8", "surrogateescape")).hexdigest()

    def check_read(self, index: Sequence[int | slice]) -> None:
        """Raise a `FileChangedError` if one of the files that were read has changed."""
        numbers: Iterable[int] = range(len(self._paths))
        if self._axis is not None:
            part = index[self._axis]
            numbers = (part,) if isinstance(part, int) else range(part.start or 0, part.stop)
        for number in numbers:
            self._check(number)

    @property
    def n_changes(self) -> int:
        """Always 0: a change is an error."""
        return 0

    def look_again(self) -> None:
        """Raise a `FileChangedError` if a file has changed."""
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
        # Other machines may report other times of status change of the same file.
        n = 2 if self._is_sent else 3
        if (now or ())[:n] != (before or ())[:n]:
            raise FileChangedError(f"the file was changed or replaced since it was opened; open it again: {path}")

    def __getstate__(self) -> dict[str, object]:
        return {**self.__dict__, "_is_sent": True}


def _state_at(path: Path) -> State | None:
    """The state of the file at a path; None where none can be found."""
    try:
        return state_of(path.stat())
    except (OSError, ValueError):
        return None
