"""Marks of a figure on the frames of a movie: the same on every frame, at the same place."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wavesplat._picture.picture import Picture
from wavesplat._scene.scene import Scene
from wavesplat._scene.summary import stamped
from wavesplat.errors import ArgumentError


class FrameFigure:
    """Marks for frames; `arguments` are those of `Picture.annotated`.

    is_still : whether the looks of all frames are the same.
    """

    def __init__(self, arguments: Mapping[str, Any], *, is_still: bool) -> None:
        self._arguments = dict(arguments)
        legend: object = arguments.get("legend", False)
        if isinstance(legend, Iterable) and not isinstance(legend, str):
            self._arguments["legend"] = list(legend)  # for more than one frame
        if self._arguments.get("colorbar", False) is not False and not is_still:
            raise ArgumentError(
                "a colour bar shows one look, and key frames change it; leave out the colour bar, or the looks of the "
                "key frames"
            )
        self._size: tuple[int, int] | None = None

    def title_of(self, scene: Scene) -> str | None:
        """The title above a frame, with the scene's time, as wide as at every other time."""
        title: object = self._arguments.get("title")
        return stamped(title, scene) if isinstance(title, str) else None

    def drawn(self, picture: Picture, scene: Scene) -> NDArray[np.float32]:
        """The frame with its marks; as large as the others."""
        if self._arguments:
            title = self.title_of(scene)
            picture = picture.annotated(**self._arguments | ({} if title is None else {"title": title}))
        self._size = self._size or picture.size
        if picture.size != self._size:
            (width, height), (first_width, first_height) = picture.size, self._size
            raise ArgumentError(
                f"with its marks a frame has {width} x {height} pixels, and another one {first_width} x "
                f"{first_height}; leave out the legend or the title, or give a smaller font_size"
            )
        return picture.rgba
