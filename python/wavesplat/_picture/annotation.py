"""What is written on a picture: the anatomical letters of its edges, a scale bar, a caption.

Text is drawn by Pillow, with the font that comes with it, white with a black outline to be seen on anything.
"""

from __future__ import annotations

from math import floor, log10
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from wavesplat.errors import ArgumentError

if TYPE_CHECKING:
    from collections.abc import Callable

__all__ = ["bar_length", "edge_letters", "round_length", "with_caption", "with_letters", "with_scale_bar"]

#: Letters of the negative and the positive direction of the RAS world's x, y and z.
LETTERS = ("LR", "PA", "IS")
#: A direction that leans to an axis by less than this, the sine of 11.5 degrees, does not get its letter.
LEAST_LEAN = 0.2
#: Text is this part of the shorter side high, in these bounds, pixels.
TEXT_SHARE, TEXT_PX = 1 / 22, (10, 60)
#: A picture with less has no room for a scale bar and its margins.
LEAST_PX = 8
#: A scale bar is at most this part of the width long.
BAR_SHARE = 0.3

Rgba = NDArray[np.float32]


def edge_letters(right: NDArray[np.float64], up: NDArray[np.float64]) -> dict[str, str]:
    """Which way the edges of a picture lie in the RAS world, as "R" or, with the nearest axis first, "AS"."""
    return {"left": _letters(-right), "right": _letters(right), "top": _letters(up), "bottom": _letters(-up)}


def _letters(direction: NDArray[np.float64]) -> str:
    leaning = [axis for axis in range(3) if abs(direction[axis]) >= LEAST_LEAN]
    leaning.sort(key=lambda axis: -round(abs(float(direction[axis])), 6))
    return "".join(LETTERS[axis][int(direction[axis] > 0)] for axis in leaning)


def round_length(most: float) -> float:
    """The largest of 1, 2, 5, 10, 20, ... (and their tenths) that is not more."""
    decade = 10.0 ** floor(log10(most))
    # The last one all the same where rounding makes it a little more.
    return next((digit * decade for digit in (5, 2) if digit * decade <= most), decade)


def bar_length(width: int, pixel: float) -> float:
    """How long a bar is drawn in a picture so wide; `pixel`: distance of neighbours, in which unit the length is."""
    return round_length(BAR_SHARE * width * pixel)


def with_letters(rgba: Rgba, letters: dict[str, str]) -> Rgba:
    """The picture with letters at the middle of its edges."""
    height, width = rgba.shape[:2]

    def draw(pen: Any, font: Any, margin: int) -> None:
        for edge, (place, anchor) in {
            "left": ((margin, height / 2), "lm"),
            "right": ((width - margin, height / 2), "rm"),
            "top": ((width / 2, margin), "ma"),
            "bottom": ((width / 2, height - margin), "md"),
        }.items():
            pen.text(place, letters[edge], font=font, anchor=anchor)

    return _drawn(rgba, draw)


def with_scale_bar(rgba: Rgba, length: float, pixel: float, text: str) -> Rgba:
    """The picture with a bar and a text at the lower left. `length`: of the bar, `pixel`: distance of neighbours."""
    height, width = rgba.shape[:2]
    length_px = length / pixel
    if round(length_px) < 1 or min(width, height) < LEAST_PX:
        raise ArgumentError(f"a picture of {width} x {height} pixels has no room for a scale bar; draw a larger one")

    def draw(pen: Any, font: Any, margin: int) -> None:
        bar_px = max(2, margin // 2)
        left, bottom = 2 * margin, height - 2 * margin
        pen.rectangle((left, bottom - bar_px, left + round(length_px) - 1, bottom - 1))
        pen.text((left + length_px / 2, bottom - bar_px - margin / 2), text, font=font, anchor="md")

    return _drawn(rgba, draw)


def with_caption(rgba: Rgba, text: str) -> Rgba:
    """The picture with a line of text at its lower edge."""
    height, width = rgba.shape[:2]
    return _drawn(rgba, lambda pen, font, margin: pen.text((width / 2, height - margin), text, font=font, anchor="md"))


class _Pen:
    """Draws the same into two masks: the strokes, and those with an outline."""

    def __init__(self, strokes: Any, outlined: Any, outline_px: int) -> None:
        self._strokes, self._outlined, self._outline_px = strokes, outlined, outline_px

    def text(self, place: tuple[float, float], text: str, **how: Any) -> None:
        self._strokes.text(place, text, fill=255, **how)
        self._outlined.text(place, text, fill=255, stroke_width=self._outline_px, **how)

    def rectangle(self, corners: tuple[float, float, float, float]) -> None:
        x0, y0, x1, y1 = corners
        n = self._outline_px
        self._strokes.rectangle(corners, fill=255)
        self._outlined.rectangle((x0 - n, y0 - n, x1 + n, y1 + n), fill=255)


def _drawn(rgba: Rgba, draw: Callable[[Any, Any, int], None]) -> Rgba:
    from PIL import Image, ImageDraw, ImageFont

    height, width = rgba.shape[:2]
    text_px = int(np.clip(round(min(width, height) * TEXT_SHARE), *TEXT_PX))
    strokes, outlined = (Image.new("L", (width, height)) for _ in range(2))
    pen = _Pen(ImageDraw.Draw(strokes), ImageDraw.Draw(outlined), outline_px=max(1, text_px // 12))
    draw(pen, ImageFont.load_default(text_px), max(2, text_px // 4))
    for mask, ink in ((outlined, (0, 0, 0, 1)), (strokes, (1, 1, 1, 1))):
        share = np.asarray(mask)[..., None] / 255
        rgba = (rgba * (1 - share) + share * np.array(ink)).astype(np.float32)
    return rgba
