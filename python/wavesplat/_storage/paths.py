"""Names of files: paths that users give, patterns, names of volumes, and files that other files name."""

from __future__ import annotations

import glob
import os
import re
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING

from wavesplat._storage.addresses import is_address
from wavesplat.errors import ArgumentError, FileError

if TYPE_CHECKING:
    from typing import Self

# The order that people put names in: frame2 before frame10.


def natural_key(name: str) -> list[tuple[int, str]]:
    """Sort key of a name, in which runs of digits compare as numbers."""
    return [(int(part), "") if part.isdecimal() else (-1, part) for part in re.split(r"(\d+)", name)]


# Patterns of file names, such as `scan_*.nii.gz`: the files that match, in the order of the numbers in their names.


def matching_files(text: str) -> list[str] | None:
    """The files that match a pattern; None if the text is a name: it has no wildcards, or something has that name.

    Raises
    ------
    FileError
        If no file matches.
    """
    if is_address(text) or not glob.has_magic(text):
        return None
    path = expanded(text)
    if os.path.lexists(path):
        return None
    # Existing folders whose names have wildcards are names too.
    folder = path.parent
    while glob.has_magic(str(folder)) and not os.path.lexists(folder):
        folder = folder.parent
    before = "" if folder == Path() else glob.escape(str(folder))
    # Not pathlib's glob, which leaves out links to folders.
    pattern = os.path.join(before, path.relative_to(folder))  # noqa: PTH118
    found = sorted(glob.glob(pattern, recursive=True), key=natural_key)  # noqa: PTH207
    if not found:
        raise FileError(f"no file matches this pattern; check the name: {text}")
    return found


# Paths that users give: of files and folders, and not of pipes, on which a reader would wait for ever.

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


# Names of volumes that were taken from files, and whether they may be a patient's.
#
# A name stays of this type wherever a volume hands its own on, so that code which shows names knows that nobody gave
# it.

#: Name in place of a folder's.
NAMELESS = "volume"


class FileName(str):
    """The name of a file, without its folders.

    is_private : of a scan of a patient by its format, or in place of the name of a folder; such are not shown.
    """

    is_private: bool

    def __new__(cls, text: str, *, is_private: bool = False) -> Self:
        """The name, as text that can be written: bytes that are no UTF-8 are replaced."""
        made = super().__new__(cls, text.encode("utf-8", "surrogatepass").decode("utf-8", "replace"))
        made.is_private = is_private
        return made


# Checks of files that a file names: only files in its own folder, unless the user allows others.
#
# A header that somebody sent may name anything that this user can read, and pictures and meshes are passed on.


def check_named_file(
    name: str, path: Path, *, anywhere: bool, within: Path | None = None, is_folder: bool = False
) -> None:
    """Raise a `FileError` if the file `name`, named by the file `path`, lies in another folder or is no file.

    Links in the folder are followed: they were made by the user, not by the file; but where a document in the folder
    `within` names the file, they may have come with it, and must lead to what lies there. A file that is not there is
    left to the reader, which says what it misses. `is_folder`: a folder is named, not a file.
    """
    folder = Path.cwd() / path.parent
    named = Path(os.path.normpath(folder / name))
    # A library in C would read the name to the zero byte only.
    if "\0" in name or not (anywhere or named.is_relative_to(os.path.normpath(folder))):
        raise refused(f"{name!r}, in another folder", path)
    if within is not None and not lies_in(str(named), within):
        raise refused(f"{name!r}, a link to another folder", path)
    if named.exists() and not (named.is_dir() if is_folder else named.is_file()):
        raise FileError(f"the file names {name!r} as one that holds its samples, which is no file: {path}")


def check_within(file: Path, within: Path | None, name: str | None = None) -> None:
    """Raise a `FileError` if a file that a document leads to lies outside of its folder.

    within : real path of the document's folder; None for files that the user names.
    name : what the message calls the file, if not by its name.
    """
    if within is not None and not lies_in(str(file), within):
        raise FileError(
            f"{(name or file.name)!r} is a link out of the folder of the document that names it; if you trust it, pass "
            f"external_files=True (--external-files): {file.parent}"
        )


def refused(what: str, path: object) -> FileError:
    """The error for a file that wants `what` to be read."""
    return FileError(
        f"the file names {what}; if you trust it, pass external_files=True (--external-files), "
        f"else move its parts into one folder: {path}"
    )
