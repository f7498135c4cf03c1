"""Output files: checks of formats and places; they appear whole or not at all.

A file is written beside its place under another name, then moved there.
"""

from __future__ import annotations

import errno
import hashlib
import os
import re
import shutil
import signal
import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from functools import cache
from itertools import count
from os import PathLike
from pathlib import Path
from types import FrameType
from typing import Literal, TypeAlias

from wavesplat._system.libraries import library
from wavesplat.errors import ArgumentError, FileError, WavesplatError

# Hidden files and folders beside an output, in which it is written until it is whole.
#
# A name holds the process and its machine: `.PID-NUMBER-MACHINE.part`. Files that a killed process left are removed by
# the next output in that folder.

#: Numbers that distinguish files written at the same time.
_NUMBERS = count()
#: Folders that this process has already searched for left-over files: a movie writes thousands of files into one.
_SEEN: set[str] = set()


def part_beside(target: Path, ending: str = ".part") -> Path:
    """A hidden name beside an output.

    Without the output's name in it, which may be as long as names can be; threads may write the same output at once.
    """
    return target.with_name(f".{os.getpid()}-{next(_NUMBERS)}-{_machine()}{ending}")


def remove_left_over(folder: Path, *, again: bool = True) -> None:
    """Remove unfinished outputs of killed processes of this machine from a folder; outputs in progress stay.

    again : whether a folder is looked through that this process has looked through before.
    """
    if sys.platform == "win32" or (not again and str(folder) in _SEEN):  # `os.kill(pid, 0)` would end the process there
        return
    _SEEN.add(str(folder))
    name = re.compile(rf"\.(\d{{1,9}})-\d+-{_machine()}\.part(\.\w+)*")
    with suppress(OSError), os.scandir(folder) as entries:
        for entry in entries:
            if (found := name.fullmatch(entry.name)) and not _is_alive(int(found[1])):
                with suppress(OSError):
                    removed(Path(entry.path))


def removed(part: Path) -> None:
    """Remove a file or folder, if it is there."""
    if part.is_dir() and not part.is_symlink():
        shutil.rmtree(part, ignore_errors=True)
    else:
        part.unlink(missing_ok=True)


def _is_alive(pid: int) -> bool:
    try:
        os.kill(pid, 0)
    except ProcessLookupError:
        return False
    except OSError:  # of another user
        return True
    return True


@cache
def _machine() -> str:
    """Eight hexadecimal digits that identify the machine or container in which process numbers are unique."""
    try:
        numbers_of = os.readlink("/proc/self/ns/pid")  # noqa: PTH115 - no path, but a name
    except OSError:
        numbers_of = ""
    name = os.uname().nodename if hasattr(os, "uname") else ""
    return hashlib.blake2b(f"{name} {numbers_of}".encode(), digest_size=4).hexdigest()


# Output files: checks of formats and places, and files that appear whole or not at all.

Kind: TypeAlias = Literal["pictures", "movies", "meshes", "looks", "volumes", "wavelet coefficients"]

#: Kind of result -> suffixes that it is written with; the suffix chooses the format.
SUFFIXES: dict[Kind, tuple[str, ...]] = {
    "pictures": (".png", ".jpg", ".jpeg", ".webp", ".tif", ".tiff", ".exr", ".svg", ".pdf"),
    "movies": (".mp4", ".webm", ".gif", ".webp"),
    "meshes": (".ply", ".stl", ".obj", ".glb", ".gltf", ".3mf"),
    "looks": (".json",),
    "volumes": (".nii.gz", ".nii", ".nrrd", ".ome.tif", ".ome.tiff", ".ome.zarr"),
    "wavelet coefficients": (".wavelets",),
}

#: Suffixes of formats that are folders, and the files in such a folder; folders in it are named by numbers.
FOLDERS = {".ome.zarr": ("zarr.json", ".zgroup", ".zattrs", ".zmetadata")}


#: Error of the system -> advice, where another folder may not help.
MENDS = {
    errno.ENOSPC: "free some space or choose another folder",
    errno.EDQUOT: "free some space or choose another folder",
    errno.ENAMETOOLONG: "shorten the name",
    errno.ELOOP: "the links lead round in a circle; remove them, or change the name",
}

#: Signals that ask a process to end.
ENDING = ("SIGTERM", "SIGHUP")


def check_output(path: str | PathLike[str], kind: Kind) -> str:
    """The suffix in lower case, if a result of this kind can be written there; else a `FileError`."""
    target = _named(path)
    suffix = next((known for known in SUFFIXES[kind] if target.name.lower().endswith(known)), target.suffix.lower())
    if suffix not in SUFFIXES[kind] or target.name.lower() == suffix:
        given = f"as {suffix}" if suffix else "to a name without a suffix"
        raise FileError(f"cannot write {kind} {given}; use one of: {', '.join(SUFFIXES[kind])}: {path}")
    if suffix == ".pdf":  # before the work that would be lost
        library("reportlab.pdfgen.canvas", extra="figure")
    if suffix in FOLDERS and target.is_dir():
        _check_folder(target, FOLDERS[suffix])
    else:
        check_writable(path)
    return suffix


def _check_folder(target: Path, contents: tuple[str, ...]) -> None:
    """Raise a `FileError` if a folder that would be replaced holds something else, or cannot be replaced."""
    with as_file_errors(target):
        names = os.listdir(target)  # noqa: PTH208 - names alone
        others = sorted(name for name in names if name not in contents and not name.isdigit())
        if others or (names and not set(names) & set(contents)):
            named = ", ".join(repr(name) for name in (others or names)[:3])
            raise FileError(
                f"cannot write: the folder holds {named}, which would be lost; change the name, or remove it first: "
                f"{target}"
            )
        if not os.access(followed(target).parent, os.W_OK | os.X_OK):
            raise FileError(f"cannot write: the folder cannot be replaced; choose another place: {target}")


def _named(path: str | PathLike[str]) -> Path:
    try:
        return Path(path)
    except TypeError:
        raise ArgumentError(f"path is a {type(path).__name__}; give the name of a file") from None


def check_writable(path: str | PathLike[str]) -> Path:
    """The path, if a file can be written there; else a `FileError`."""
    target = _named(path)
    with as_file_errors(target):
        folder = followed(target).parent
        if not folder.is_dir():
            raise FileError(f"cannot write: the folder does not exist; make it first, or change the name: {target}")
        if target.is_dir():
            raise FileError(f"cannot write: this is a folder; add a file name to it: {target}")
        if target.exists() and not target.is_file():
            raise FileError(
                f"cannot write: this is a device or a pipe, which cannot be replaced whole; name a file: {target}"
            )
        if not os.access(folder, os.W_OK | os.X_OK):
            raise FileError(f"cannot write: no permission in its folder; choose another folder: {target}")
        with suppress(FileNotFoundError):
            target.lstat()  # the system knows of names that are too long
    return target


@contextmanager
def as_file_errors(target: Path) -> Iterator[None]:
    """Turn the system's errors about names, folders and disks into a `FileError`."""
    try:
        yield
    except WavesplatError:  # some are a `ValueError` too
        raise
    except OSError as error:
        mend = MENDS.get(error.errno or 0, "choose another folder")
        raise FileError(f"cannot write: {error.strerror or error}; {mend}: {target}") from error
    except ValueError as error:  # a zero byte
        raise FileError(f"cannot write: {error}; change the name: {target}") from error


def write_atomically(path: str | PathLike[str], write: Callable[[Path], object]) -> None:
    """Let `write` fill a new file beside `path`, then put it in place; on failure nothing is left.

    The new file has the same suffix, since some libraries choose the format by it. A symbolic link stays: the file that
    it leads to is replaced.
    """
    target = followed(check_writable(path))
    remove_left_over(target.parent, again=False)
    part = part_beside(target, f".part{target.suffix}")
    with as_file_errors(target), removed_when_terminated(part):
        try:
            write(part)
            part.replace(target)
        finally:
            part.unlink(missing_ok=True)


def write_folder_atomically(path: str | PathLike[str], write: Callable[[Path], object]) -> None:
    """Let `write` fill a new folder beside `path`, then put it in place of what is there; on failure nothing is left.

    A symbolic link stays: the folder that it leads to is replaced. Check an existing folder by `check_output` first.
    """
    target = followed(_named(path))
    remove_left_over(target.parent)
    # The old folder must not be removed as a left-over: it may be the only copy.
    part, old = part_beside(target), part_beside(target, ".old")
    with as_file_errors(target), removed_when_terminated(part):
        try:
            part.mkdir()
            write(part)
            if target.exists():
                target.rename(old)
            try:
                part.rename(target)
            except OSError:
                if old.exists():
                    old.rename(target)
                raise
        finally:
            removed(part)
            removed(old)


def followed(target: Path) -> Path:
    """The place that a symbolic link leads to, or the path itself."""
    return Path(os.path.realpath(target)) if target.is_symlink() else target


@contextmanager
def removed_when_terminated(part: Path) -> Iterator[None]:
    """Remove a file or folder if the process is terminated meanwhile, by `kill` or a closed terminal.

    Only the main thread can handle signals, and only those without another handler are handled.
    """
    if threading.current_thread() is not threading.main_thread():
        yield
        return

    def end(number: int, _frame: FrameType | None) -> None:
        removed(part)
        signal.signal(number, signal.SIG_DFL)
        os.kill(os.getpid(), number)

    numbers = [getattr(signal, name) for name in ENDING if hasattr(signal, name)]
    numbers = [number for number in numbers if signal.getsignal(number) is signal.SIG_DFL]
    for number in numbers:
        signal.signal(number, end)
    try:
        yield
    finally:
        for number in numbers:
            signal.signal(number, signal.SIG_DFL)
