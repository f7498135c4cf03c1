"""Offers of the start page: examples with their pictures, and the files that the command opened last."""

from __future__ import annotations

from functools import lru_cache
from typing import Any

from wavesplat import examples
from wavesplat._scene.scene import Scene
from wavesplat._viewer import encoding
from wavesplat._viewer.example_names import EXAMPLES
from wavesplat._viewer.picturing import picture_of
from wavesplat._viewer.recent import Recent
from wavesplat._viewer.state import ViewerState
from wavesplat._viewer.uploads import MAX_BYTES
from wavesplat.errors import ArgumentError

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
    return encoding.jpeg_bytes(picture.rgba, PICTURE_QUALITY, subsampled=False)
