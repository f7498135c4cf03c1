"""Sources of volumes and labels, by which documents name them: a file, how it was opened, and the steps after that.

    {"path": "/data/ct.nii.gz", "spacing": [1, 1, 2], "then": [{"smoothed": {"deviation": 0.7, "unit": "voxels"}}]}
    {"example": "ct_pelvis"}

Paths are absolute here; `beside` makes those relative that lie below a folder or beside it.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any, TypeAlias

import numpy as np

from wavesplat._storage.addresses import checked, is_address, is_web
from wavesplat._storage.paths import expanded, lies_in, real_path
from wavesplat._system.threads import warn

Source: TypeAlias = dict[str, Any]

#: Fields of documents that hold paths: of volumes, and of the typeface of figures.
PATHS = ("path", "font")


def of_file(path: str | os.PathLike[str], options: Mapping[str, Any]) -> Source | None:
    """A file or address, and the options that it was opened with; None where its name is no text."""
    name = absolute(path)
    if name is None:
        return None
    return {"path": name, **_fields(options)}


def of_series(path: str | os.PathLike[str] | list[Any], options: Mapping[str, Any]) -> Source | None:
    """Files of several times, by a name, a pattern or a list, and the options that they are opened with."""
    names = [absolute(one) for one in path] if isinstance(path, list) else absolute(path)
    if names is None or (isinstance(names, list) and None in names):
        return None
    return {"path": names, "series_of_times": True, **_fields(options)}


def _fields(options: Mapping[str, Any]) -> dict[str, Any]:
    fields = {name: _plain(value) for name, value in sorted(options.items())}
    if "spacing" in fields:
        # So that 1 and 1.0 are written alike.
        fields["spacing"] = [float(step) for step in fields["spacing"]]
    return fields


def absolute(path: str | os.PathLike[str]) -> str | None:
    """The absolute path, or the address; None where it is not valid text."""
    name: object = os.fspath(path)
    if not isinstance(name, str):
        return None
    name = checked(name) if is_address(name) else name
    if not is_address(name):
        name = str(Path(name).expanduser().absolute())
    try:
        name.encode()
    except UnicodeEncodeError:
        return None
    return name


def then(source: Source | None, step: str, /, **options: Any) -> Source | None:
    """The source of a step's result: the source of its input, and the step; None where the input has none."""
    if source is None:
        return None
    done = {step: {key: _plain(value) for key, value in options.items() if value is not None}}
    return {**source, "then": [*source.get("then", []), done]}


def beside(document: Any, folder: Path) -> Any:
    """The document with relative paths for files that lie below `folder`, or below its parent folder."""
    return with_paths(document, lambda path: _relative(path, folder))


def warn_of_elsewhere(document: Any, path: str | os.PathLike[str], *, stacklevel: int) -> None:
    """Warn if a document in the file `path` names files or addresses that it can only open with `external_files`."""
    folder = expanded(path).absolute().parent
    elsewhere: list[str] = []

    def look(named: str) -> str:
        if not (is_web(named) if is_address(named) else lies_in(str(folder / named), real_path(folder))):
            elsewhere.append(named)
        return named

    with_paths(document, look)
    if elsewhere:
        warn(
            f"{elsewhere[0]!r} does not lie in the folder of the scene; open it with external_files=True "
            f"(--external-files), or save it beside the volume: {path}",
            stacklevel=stacklevel + 1,
        )


def with_paths(document: Any, changed: Callable[[str], str | None]) -> Any:
    """The document with all paths in it changed."""
    if isinstance(document, list):
        return [with_paths(part, changed) for part in document]
    if not isinstance(document, dict):
        return document
    return {
        name: _changed(part, changed) if name in PATHS else with_paths(part, changed) for name, part in document.items()
    }


def _changed(part: Any, changed: Callable[[str], str | None]) -> Any:
    if isinstance(part, str):
        return changed(part)
    if not isinstance(part, list):
        return part
    parts = [_changed(one, changed) for one in part]
    return None if None in parts else parts


def _relative(path: str, folder: Path) -> str:
    if is_address(path) or not Path(path).is_absolute():
        return path
    try:
        relative = os.path.relpath(path, folder)
    except ValueError:  # on another drive
        return path
    parts = Path(relative).parts
    # Two folders up is somewhere else.
    return path if parts[:2] == ("..", "..") else Path(relative).as_posix()


def _plain(value: Any) -> Any:
    """The value of an option as a JSON value."""
    if value is None or isinstance(value, bool | str):
        return value
    if isinstance(value, np.dtype | type):
        return np.dtype(value).str if not np.dtype(value).isnative else np.dtype(value).name
    if isinstance(value, list | tuple | np.ndarray):
        return [_plain(part) for part in value]
    if isinstance(value, np.generic):
        return value.item()
    if isinstance(value, os.PathLike):
        return absolute(value)
    return value
