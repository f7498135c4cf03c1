"""Frames as files: JPEG while something moves, PNG, exact, at rest."""

from __future__ import annotations

import io

import numpy as np
from numpy.typing import NDArray

from wavesplat._picture import picture_files

#: Colour behind transparent pixels in a format without transparency.
PAPER = (0.0, 0.0, 0.0)


def jpeg_bytes(rgba: NDArray[np.float32], quality: int, *, subsampled: bool) -> bytes:
    """A picture as a JPEG file. `subsampled`: colours at half the resolution (4:2:0), which suits slow lines."""
    content = io.BytesIO()
    image = picture_files.rgb_image(rgba, PAPER)
    image.save(content, "jpeg", quality=quality, subsampling=2 if subsampled else 0)
    return content.getvalue()


def png_bytes(rgba: NDArray[np.float32]) -> bytes:
    """A picture as a PNG file, with the pixels of `Picture.save`, 8 bits."""
    return picture_files.png_bytes(rgba, 8)
