"""Contact sheets: a volume drawn with several presets, or pictures of several inputs, side by side with their names."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import ceil, sqrt
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from wavesplat._files.natural_order import natural_key
from wavesplat._looks.look import Look
from wavesplat._picture.annotating import with_caption
from wavesplat._picture.picture import Picture
from wavesplat._scene.rendering import render
from wavesplat.errors import ArgumentError

if TYPE_CHECKING:
    from wavesplat._model.volume import Volume
    from wavesplat._model.wavelet_volume import WaveletVolume

__all__ = ["Drawn", "drawn", "of_files"]

#: Grey of the sheet around and between pictures, and width of these gaps, pixels.
GREY, GAP_PX = 0.25, 2


@dataclass(frozen=True)
class Drawn:
    """A file of a picture, its name on the sheet, and its row and column on a plate."""

    path: Path
    name: str
    well: tuple[str, str] | None = None


def drawn(volume: Volume | WaveletVolume, names: Sequence[str], size: tuple[int, int]) -> Picture:
    """The contact sheet, as nearly square as may be. `size`: of each picture, pixels."""
    pictures = []
    for name in names:
        look = Look.preset(name, volume)
        picture = render(volume, look, size=size, background=look.background or "black")
        pictures.append(with_caption(picture.rgba, name))
    return _side_by_side(pictures, _in_a_square(len(names), size))


def of_files(files: Sequence[Drawn]) -> Picture:
    """The contact sheet of pictures in files: those of a plate by row and column, others as nearly square as may be.

    Raises
    ------
    ArgumentError
        If a file holds no picture of pixels.
    """
    pictures = [with_caption(_rgba_of(one.path), one.name) for one in files]
    height, width = np.max([picture.shape[:2] for picture in pictures], axis=0)
    wells = [one.well for one in files if one.well is not None]
    if len(set(wells)) < len(files):
        return _side_by_side(pictures, _in_a_square(len(files), (int(width), int(height))))
    rows, columns = (sorted(set(names), key=natural_key) for names in zip(*wells, strict=True))
    return _side_by_side(pictures, [(rows.index(row), columns.index(column)) for row, column in wells])


def _in_a_square(n: int, size: tuple[int, int]) -> list[tuple[int, int]]:
    """Row and column of each of `n` pictures of a size."""
    width, height = size
    n_columns = max(1, ceil(sqrt(n * height / max(width, 1))))
    return [divmod(number, n_columns) for number in range(n)]


def _side_by_side(pictures: Sequence[NDArray[np.float32]], places: Sequence[tuple[int, int]]) -> Picture:
    """Pictures by row and column, each in the middle of its place."""
    height, width = np.max([picture.shape[:2] for picture in pictures], axis=0)
    n_rows, n_columns = np.max(places, axis=0) + 1
    shape = (n_rows * (height + GAP_PX) + GAP_PX, n_columns * (width + GAP_PX) + GAP_PX, 4)
    sheet = np.full(shape, GREY, dtype=np.float32)
    sheet[..., 3] = 1
    for picture, (row, column) in zip(pictures, places, strict=True):
        own_height, own_width = picture.shape[:2]
        top = GAP_PX + row * (height + GAP_PX) + (height - own_height) // 2
        left = GAP_PX + column * (width + GAP_PX) + (width - own_width) // 2
        sheet[top : top + own_height, left : left + own_width] = picture
    return Picture(sheet)


def _rgba_of(path: Path) -> NDArray[np.float32]:
    """The pixels of a file, associated."""
    from PIL import Image

    try:
        with Image.open(path) as image:
            rgba: NDArray[np.float32] = np.asarray(image.convert("RGBA")).astype(np.float32) / np.float32(255)
    except (OSError, ValueError):
        raise ArgumentError(f"a sheet takes pictures as .png, .jpg or .webp, and this is none: {path}") from None
    rgba[..., :3] *= rgba[..., 3:]
    return rgba
