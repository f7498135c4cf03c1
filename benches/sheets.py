"""Sheets of pictures for looking at: one row for each volume, a column for each program, a line of text below each."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw, ImageFont

__all__ = ["LUMINANCE", "Sheet", "mean_luminance"]

#: Rec. 709 weights, on encoded values.
LUMINANCE = np.array([0.2126, 0.7152, 0.0722])
#: Height of the line below a picture, pixels; grey of the sheet and of its text.
LINE, PAPER, INK = 20, (30, 30, 30), (235, 235, 235)
#: Largest channel of a pixel that counts as black.
BLACK = 6


class Sheet:
    """A sheet of `n_columns` x `n_rows` square pictures of `side` pixels."""

    def __init__(self, n_columns: int, n_rows: int, side: int) -> None:
        self.side = side
        self._image = Image.new("RGB", (n_columns * side, n_rows * (side + LINE)), PAPER)
        self._pen, self._font = ImageDraw.Draw(self._image), ImageFont.load_default(13)

    def put(self, column: int, row: int, picture: NDArray[np.uint8], text: str) -> None:
        """Paste a picture, shape (height, width, 3), as large as fits, with a line of text below."""
        shown: Any = Image.fromarray(picture)
        shown.thumbnail((self.side, self.side))
        left, top = column * self.side, row * (self.side + LINE)
        self._image.paste(shown, (left + (self.side - shown.width) // 2, top + (self.side - shown.height) // 2))
        self._pen.text((left + 4, top + self.side + 2), text, font=self._font, fill=INK)

    def save(self, path: Path) -> None:
        """Write the sheet, and make its folder."""
        path.parent.mkdir(parents=True, exist_ok=True)
        self._image.save(path)


def mean_luminance(picture: NDArray[Any]) -> float:
    """Mean luminance, 0..255, of the pixels of a picture, shape (height, width, 3), that are not black."""
    seen = (picture > BLACK).any(axis=2)
    return float((picture[seen] @ LUMINANCE).mean()) if seen.any() else 0.0
