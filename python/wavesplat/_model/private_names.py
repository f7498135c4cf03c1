"""Documents without the names of folders, which may be those of patients: what files that are published hold.

A path becomes the name of its file. It becomes null where that would not do: a folder of slices, whose own name may be
a patient's; a pattern with wildcards for folders; two different files of one name. Stores of Zarr are folders that
users name as files.
"""

from __future__ import annotations

import glob
import os
from pathlib import Path, PurePath
from typing import Any

from wavesplat._files.addresses import is_address, last_part
from wavesplat._model.sources import Source, with_paths

__all__ = ["file_name_of", "name_in_files", "without_folders"]

#: Name in place of a folder's, of volumes and layers that have it.
NAMELESS = "volume"


def without_folders(document: Any) -> Any:
    """The document, or the report, with names of files in place of paths; see the module."""
    paths: dict[str, str | None] = {}

    def look(path: str) -> str:
        paths[path] = file_name_of(path)
        return path

    with_paths(document, look)
    given = list(paths.values())
    chosen = {path: None if given.count(name) > 1 else name for path, name in paths.items()}
    folders = {PurePath(path).name for path, name in chosen.items() if name is None}
    return _renamed(with_paths(document, chosen.__getitem__), folders)


def file_name_of(path: str) -> str | None:
    """The name of a file, or the last part of an address; None of what is, or may be, a folder."""
    if is_address(path):
        return last_part(path)
    parts = PurePath(path)
    is_zarr = parts.suffix.lower() == ".zarr"
    if path.endswith("/") and not is_zarr:  # a folder that need not be here, such as one that a page sent
        return None
    if glob.has_magic(str(parts.parent)) and not os.path.lexists(path):
        return None
    if Path(path).is_dir() and not is_zarr:
        return None
    return parts.name


def name_in_files(name: str, source: Source | None) -> str:
    """The name of a volume, with another one where it is that of a folder which the volume was read from."""
    paths: list[str] = []

    def look(path: str) -> str:
        paths.append(path)
        return path

    with_paths(source, look)
    return NAMELESS if name in {PurePath(path).name for path in paths if file_name_of(path) is None} else name


def _renamed(part: Any, folders: set[str]) -> Any:
    """The document with another name where a volume or layer has that of a folder."""
    if isinstance(part, list | tuple):
        return [_renamed(one, folders) for one in part]
    if not isinstance(part, dict):
        return part
    return {
        name: _name_of(one, folders) if name in ("name", "layer", "resampled") else _renamed(one, folders)
        for name, one in part.items()
    }


def _name_of(one: Any, folders: set[str]) -> Any:
    """A name, or a list of names, with another one where it is that of a folder."""
    if isinstance(one, list | tuple):
        return [_name_of(each, folders) for each in one]
    return NAMELESS if isinstance(one, str) and one in folders else _renamed(one, folders)
