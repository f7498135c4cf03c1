"""Paths that users give: of files and folders, and not of pipes, on which a reader would wait for ever."""

from __future__ import annotations

import os
from os import PathLike
from pathlib import Path

from wavesplat._files.file_names import FileName
from wavesplat.errors import ArgumentError, FileError

#: Largest text file, in bytes; a transfer function or a table of labels has a few thousand.
MAX_TEXT_BYTES = 1 << 26


def expanded(path: str | PathLike[str]) -> Path:
    """The path, with ~ resolved."""
    try:
        return Path(path).expanduser()
    except RuntimeError:
        raise FileError(f"there is no home folder of that name; write the folder itself: {path}") from None
    except TypeError:
        raise ArgumentError(f"path is a {type(path).__name__}; give the name of a file or folder") from None


def real_path(path: Path) -> Path:
    """The real path, links followed as far as they go."""
    try:
        return Path(os.path.realpath(path))
    except OSError:  # the working folder was deleted
        return path


def lies_in(path: str, folder: Path) -> bool:
    """Whether a path leads into a folder, links followed. `folder`: its real path."""
    return real_path(Path(path)).is_relative_to(folder)


def check_no_pipe(path: Path) -> None:
    """Raise a `FileError` for an existing path that is neither a file nor a folder."""
    try:
        path.stat()
        is_other = not (path.is_file() or path.is_dir())
    except (FileNotFoundError, NotADirectoryError):
        return
    except OSError as error:
        raise FileError(f"cannot read: {error.strerror}; check the name and the permissions: {path}") from None
    except ValueError as error:  # a zero byte
        raise FileError(f"cannot read: {error}; check the name: {path}") from None
    if is_other:
        raise FileError(f"this is not a file but a device, a pipe or a socket; copy what it gives to a file: {path}")


def read_text(path: str | PathLike[str], what: str) -> str:
    """The text in a file. `what`: such as "transfer function"."""
    place = expanded(path)
    check_no_pipe(place)
    try:
        with place.open("rb") as file:
            content = file.read(MAX_TEXT_BYTES + 1)
        if len(content) > MAX_TEXT_BYTES:
            raise FileError(f"the {what} is larger than {MAX_TEXT_BYTES >> 20} MiB; give another file: {path}")
        return content.decode("utf-8-sig")  # some editors begin with a mark of the byte order
    except UnicodeDecodeError:
        raise FileError(f"the {what} is not text: {path}") from None
    except OSError as error:
        if isinstance(error, FileError):
            raise
        raise FileError(f"cannot read the {what}: {error.strerror or error}; check the name: {path}") from None


def check_text(path: Path) -> None:
    """Raise a `FileError` for a name that cannot be handed to a library as text: ITK would end the process."""
    if printable(str(path)) != str(path):
        raise FileError(
            f"the name is not UTF-8, or has letters that this locale lacks, and ITK cannot open it; "
            f"rename it, or set LC_ALL=C.UTF-8: {path}"
        )


def printable(name: str) -> str:
    """A name as text: bytes that are no UTF-8, which some systems allow in names, are replaced."""
    if isinstance(name, FileName):
        return name
    return name.encode("utf-8", "surrogatepass").decode("utf-8", "replace")
