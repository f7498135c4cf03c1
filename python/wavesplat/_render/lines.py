"""Lines over a picture: smooth edges, by masks that Pillow draws finer than the pixels."""

from __future__ import annotations

from collections.abc import Sequence
from math import ceil, floor

import numpy as np
from numpy.typing import NDArray

#: Pixels of a mask for each of the picture, along both sides, as many as fit into its most pixels.
FINER, MASK_PIXELS = (4, 2, 1), 1 << 27
#: Places outside of the picture, pixels, are at most so far away: Pillow counts in whole numbers.
FAR = 1e6
#: Width of lines: pixels, and as a share of the shorter side; the larger one counts.
WIDTH_PX, WIDTH_SHARE = 1.25, 1 / 350


def drawn_over(
    rgba: NDArray[np.float32], lines: Sequence[NDArray[np.float64]], color: tuple[float, float, float]
) -> NDArray[np.float32]:
    """A copy of a picture with lines over it.

    lines : points (x, y) each, in pixels; the centre of the first pixel is (0, 0).
    """
    from PIL import Image, ImageDraw

    height, width = rgba.shape[:2]
    thickness = max(WIDTH_PX, WIDTH_SHARE * min(width, height))
    drawn = np.array(rgba)
    for line in lines:
        # A box for each line: a mask of the whole picture is sixteen times as large as it.
        margin = ceil(thickness)
        left, top = (max(floor(low) - margin, 0) for low in line.min(axis=0))
        right, bottom = (
            min(ceil(high) + margin + 1, end) for high, end in zip(line.max(axis=0), (width, height), strict=True)
        )
        if right <= left or bottom <= top:
            continue
        area = (right - left) * (bottom - top)
        finer = next((n for n in FINER if n * n * area <= MASK_PIXELS), FINER[-1])
        mask = Image.new("L", (finer * (right - left), finer * (bottom - top)))
        places = (finer * (line + 0.5 - (left, top)) - 0.5).clip(-FAR, FAR)
        ImageDraw.Draw(mask).line(
            [(x, y) for x, y in places.tolist()], fill=255, width=max(1, round(finer * thickness)), joint="curve"
        )
        parts = np.asarray(mask).reshape(bottom - top, finer, right - left, finer)
        share = parts.mean(axis=(1, 3), dtype=np.float32) / np.float32(255)
        below = drawn[top:bottom, left:right]
        below[:] = below * (1 - share[..., None]) + share[..., None] * np.array((*color, 1), np.float32)
    return drawn
