"""Pictures side by side on one sheet, each with its name: of one volume with several presets, or of several."""

from __future__ import annotations

from collections.abc import Sequence
from math import ceil, log
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from wavesplat._looks.look import Look
from wavesplat._picture.annotating import caption_strip
from wavesplat._picture.picture import Picture
from wavesplat._scene.drawing.rendering import render
from wavesplat._storage.paths import natural_key

if TYPE_CHECKING:
    from wavesplat._model.volume.volume import Volume
    from wavesplat._model.volume.wavelet_volume import WaveletVolume

#: Grey of the sheet around and between pictures, and width of these gaps, pixels.
GREY, GAP_PX = 0.25, 2
#: Preferred ratio of a sheet's width to its height, and weight of empty places in the choice of columns.
SCREEN, EMPTY = 1.5, 1.1


def drawn(volume: Volume | WaveletVolume, names: Sequence[str], size: tuple[int, int]) -> Picture:
    """A volume with each preset. `size`: of each picture, pixels."""
    pictures = []
    for name in names:
        look = Look.preset(name, volume)
        pictures.append((name, render(volume, look, size=size, background=look.background or "black").rgba))
    return sheet_of(pictures)


def sheet_of(
    pictures: Sequence[tuple[str, NDArray[np.float32]]], wells: Sequence[tuple[str, str]] | None = None
) -> Picture:
    """A sheet of pictures with their names below: by rows and columns of wells, else by `columns_of`.

    wells : names of the row and the column of each picture on a plate.
    """
    width, height = (max(rgba.shape[axis] for _, rgba in pictures) for axis in (1, 0))
    strips = [caption_strip(name, width, height) for name, _ in pictures]
    height += strips[0].shape[0]
    if wells is not None and len(set(wells)) == len(pictures):
        rows, columns = (sorted(set(names), key=natural_key) for names in zip(*wells, strict=True))
        n_rows, n_columns = len(rows), len(columns)
        places = [(rows.index(row), columns.index(column)) for row, column in wells]
    else:
        n_columns = columns_of(len(pictures), width, height)
        n_rows = ceil(len(pictures) / n_columns)
        places = [divmod(number, n_columns) for number in range(len(pictures))]
    shape = (n_rows * (height + GAP_PX) + GAP_PX, n_columns * (width + GAP_PX) + GAP_PX, 4)
    sheet = np.full(shape, GREY, dtype=np.float32)
    sheet[..., 3] = 1
    for (row, column), (_, rgba), strip in zip(places, pictures, strips, strict=True):
        top, left = (GAP_PX + place * (side + GAP_PX) for place, side in ((row, height), (column, width)))
        room = height - strip.shape[0]
        # A smaller picture lies in the middle of its place.
        _lay(sheet, rgba, top + (room - rgba.shape[0]) // 2, left + (width - rgba.shape[1]) // 2)
        _lay(sheet, strip, top + room, left)
    return Picture(sheet)


def columns_of(n: int, width: int, height: int) -> int:
    """The number of columns for `n` pictures: the sheet is about as wide as a screen, with few places empty."""

    def unfit(columns: int) -> float:
        rows = ceil(n / columns)
        return abs(log(columns * width / (rows * height) / SCREEN)) + EMPTY * log(rows * columns / n)

    return min(range(1, n + 1), key=unfit)


def _lay(sheet: NDArray[np.float32], rgba: NDArray[np.float32], top: int, left: int) -> None:
    place = sheet[top : top + rgba.shape[0], left : left + rgba.shape[1]]
    place[:] = rgba + (1 - rgba[..., 3:]) * place
