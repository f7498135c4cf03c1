"""A volume drawn with several presets, side by side, each with its name."""

from __future__ import annotations

from collections.abc import Sequence
from math import ceil, sqrt
from typing import TYPE_CHECKING

import numpy as np

from wavesplat._looks.look import Look
from wavesplat._picture.annotating import with_caption
from wavesplat._picture.picture import Picture
from wavesplat._scene.rendering import render

if TYPE_CHECKING:
    from wavesplat._model.volume import Volume
    from wavesplat._model.wavelet_volume import WaveletVolume

__all__ = ["drawn"]

#: Grey of the sheet around and between pictures, and width of these gaps, pixels.
GREY, GAP_PX = 0.25, 2


def drawn(volume: Volume | WaveletVolume, names: Sequence[str], size: tuple[int, int]) -> Picture:
    """The contact sheet, as nearly square as may be. `size`: of each picture, pixels."""
    width, height = size
    n_columns = max(1, ceil(sqrt(len(names) * height / max(width, 1))))
    n_rows = ceil(len(names) / n_columns)
    shape = (n_rows * (height + GAP_PX) + GAP_PX, n_columns * (width + GAP_PX) + GAP_PX, 4)
    sheet = np.full(shape, GREY, dtype=np.float32)
    sheet[..., 3] = 1
    for number, name in enumerate(names):
        look = Look.preset(name, volume)
        picture = render(volume, look, size=size, background=look.background or "black")
        row, column = divmod(number, n_columns)
        top, left = (GAP_PX + place * (side + GAP_PX) for place, side in ((row, height), (column, width)))
        sheet[top : top + height, left : left + width] = with_caption(picture.rgba, name)
    return Picture(sheet)
