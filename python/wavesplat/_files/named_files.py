"""Checks of files that a file names: only those in its own folder, unless the user allows others.

A header that somebody sent may name anything that this user can read, and pictures and meshes are passed on.
"""

from __future__ import annotations

import os
from pathlib import Path

from wavesplat._files.paths import lies_in
from wavesplat.errors import FileError


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
