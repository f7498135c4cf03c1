"""Offers of the start page: examples with their pictures, and the files that the command opened last.

Names of files can say whom a scan is of: only the user can read the list, pages get it behind their key, and
`Recent.clear` deletes it. A page chooses a file by its place in the list and so can open no other.
"""

from __future__ import annotations

import json
import os
import tempfile
from contextlib import suppress
from functools import lru_cache
from pathlib import Path
from typing import Any

from wavesplat import examples
from wavesplat._scene.scene import Scene
from wavesplat._storage.addresses import is_address, safe_address
from wavesplat._viewer.opening.example_names import EXAMPLES
from wavesplat._viewer.opening.uploads import MAX_BYTES
from wavesplat._viewer.server import messages
from wavesplat._viewer.session.picturing import picture_of
from wavesplat._viewer.session.state import ViewerState
from wavesplat.errors import ArgumentError

MAX_FILES = 12
#: Largest file that is read, bytes: a longer one is not ours.
MAX_LIST_BYTES = 1 << 18
NAME = "recent.json"


def state_folder() -> Path:
    """`$XDG_STATE_HOME/wavesplat`, or the system's folder; a `RuntimeError` where there is no home."""
    if os.name == "nt":
        base = os.environ.get("LOCALAPPDATA") or Path.home() / "AppData" / "Local"
    else:
        base = os.environ.get("XDG_STATE_HOME") or Path.home() / ".local" / "state"
    return Path(base) / "wavesplat"


class Recent:
    """The list of a folder; where that cannot be written it stays empty."""

    def __init__(self, folder: Path | None = None) -> None:
        self._folder = folder

    def paths(self) -> list[str]:
        """Absolute paths and addresses, the last one first."""
        with suppress(OSError, ValueError, RuntimeError):
            file = self._file()
            if file.stat().st_size <= MAX_LIST_BYTES:
                found = json.loads(file.read_text(encoding="utf-8"))
                listed = found.get("files") if isinstance(found, dict) else None
                files = listed if isinstance(listed, list) else []
                return [one for one in files if isinstance(one, str)][:MAX_FILES]
        return []

    def add(self, path: str) -> None:
        """Put a file first; an address without what may be a password."""
        name = safe_address(path) if is_address(path) else str(Path(path).expanduser().absolute())
        self._write([name, *[one for one in self.paths() if one != name]][:MAX_FILES])

    def clear(self) -> None:
        """Delete the list."""
        with suppress(OSError, RuntimeError):
            self._file().unlink()

    def shown(self) -> list[dict[str, Any]]:
        """The list as pages show it: names, folders, and whether each is there."""
        return [_shown(path) for path in self.paths()]

    def _file(self) -> Path:
        return (self._folder or state_folder()) / NAME

    def _write(self, paths: list[str]) -> None:
        # A list that cannot be kept is no reason not to show a volume.
        with suppress(OSError, ValueError, RuntimeError):
            file = self._file()
            file.parent.mkdir(mode=0o700, parents=True, exist_ok=True)
            text = json.dumps({"files": paths}, indent=1)
            handle, part = tempfile.mkstemp(".part", ".wavesplat-", file.parent)  # for the user alone
            try:
                with os.fdopen(handle, "w", encoding="utf-8") as written:
                    written.write(text)
                Path(part).replace(file)
            finally:
                with suppress(OSError):
                    Path(part).unlink()


def last_part(path: str) -> str:
    """The name of a file, or the last part of an address."""
    return path.rstrip("/").rpartition("/")[2] if is_address(path) else Path(path).name


def _shown(path: str) -> dict[str, Any]:
    if is_address(path):
        return {"name": last_part(path), "folder": path.rstrip("/").rpartition("/")[0], "is_there": True}
    place = Path(path)
    return {"name": last_part(path), "folder": str(place.parent), "is_there": _is_there(place)}


def _is_there(place: Path) -> bool:
    """Whether a file is there; not, where its folder may not be entered or its disk does not answer."""
    try:
        return place.exists()
    except OSError:
        return False


# Offers of the start page: examples with their pictures, and the files that the command opened last.

#: Pixels of the picture of an example, and quality of its JPEG file.
PICTURE_SIZE, PICTURE_QUALITY = (320, 240), 85


def offered(recent: Recent | None) -> dict[str, Any]:
    """Examples, recent files, and the limit of what a page sends."""
    return {
        "examples": [{"name": name, "title": title} for name, title in EXAMPLES.items()],
        "recent": None if recent is None else recent.shown(),
        "max_bytes": MAX_BYTES,
    }


@lru_cache(maxsize=len(EXAMPLES))
def example_scene(name: str) -> Scene:
    """An example, as `wavesplat view --example` shows it.

    Raises
    ------
    ArgumentError
        If there is no such example.
    """
    if name not in EXAMPLES:
        raise ArgumentError(f"example is {name!r}; use one of: {', '.join(EXAMPLES)}")
    return Scene(getattr(examples, name)())


@lru_cache(maxsize=len(EXAMPLES))
def example_picture(name: str) -> bytes:
    """The first picture of an example, a JPEG file."""
    picture = picture_of(ViewerState.of(example_scene(name)), "3d", PICTURE_SIZE)
    return messages.jpeg_bytes(picture.rgba, PICTURE_QUALITY, subsampled=False)
