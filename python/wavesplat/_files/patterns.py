"""Patterns of file names, such as `scan_*.nii.gz`: the files that match, in the order of the numbers in their names."""

from __future__ import annotations

import glob
import os
from pathlib import Path

from wavesplat._files.addresses import is_address
from wavesplat._files.natural_order import natural_key
from wavesplat._files.paths import expanded
from wavesplat.errors import FileError


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
