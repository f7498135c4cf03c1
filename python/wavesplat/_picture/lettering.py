"""The typeface of figures: widths of texts, and checks that the typeface has their letters."""

from __future__ import annotations

import io
import re
from functools import lru_cache
from pathlib import Path
from typing import Any

from wavesplat.errors import ArgumentError, FileError

#: File of Liberation Sans, which is as wide as Arial and Helvetica.
OURS = Path(__file__).parents[1] / "data" / "liberation_sans" / "LiberationSans-Regular.ttf"
#: Typefaces for files that name theirs instead of holding it.
FAMILY = "'Liberation Sans', Arial, Helvetica, sans-serif"
#: Height of a capital letter, in sizes of the font: measured in our font, and near enough for others.
CAP_HEIGHT = 0.69
#: Size of the font at which widths are measured, pixels: hinting does not matter there.
MEASURED_PX = 200
#: Blanks at which lines may be broken; figure spaces belong to the number that they fill up.
BLANKS = re.compile(r"[^\S\u2007]+")
#: Largest number of letters of a title or name; more take seconds to set and fill a page.
MAX_LETTERS = 2000


def file_of(font: str | None) -> str:
    """The file of a typeface."""
    return str(OURS if font is None else font)


@lru_cache(maxsize=64)
def opened(font: str | None, size: float) -> Any:
    """The typeface as an object of Pillow."""
    from PIL import ImageFont

    path = Path(file_of(font)).expanduser()
    if not path.is_file():
        raise FileError(f"there is no font; give a .ttf or .otf file: {path}")
    try:
        # From memory: a file that is written to while it is mapped would end the process.
        return ImageFont.truetype(io.BytesIO(_content(path)), size, layout_engine=ImageFont.Layout.BASIC)
    except OSError as error:
        raise FileError(f"this is no font ({error}); give a .ttf or .otf file: {path}") from error


@lru_cache(maxsize=4)
def _content(path: Path) -> bytes:
    return path.read_bytes()


def text_width(text: str, size: float, font: str | None = None) -> float:
    """Width of a line of text, pixels."""
    return float(opened(font, MEASURED_PX).getlength(text)) * size / MEASURED_PX


def check_length(text: str, what: str) -> None:
    """Raise an `ArgumentError` for a text that no figure has room for."""
    if len(text) > MAX_LETTERS:
        raise ArgumentError(f"{what} has {len(text)} letters; give a shorter one, of at most {MAX_LETTERS}")


def check_letters(text: str, font: str | None, what: str) -> None:
    """Raise an `ArgumentError` where a text has signs that the typeface lacks."""
    missing = [sign for sign in dict.fromkeys(text) if sign.isprintable() and not sign.isspace()]
    missing = [sign for sign in missing if not has_sign(sign, font)]
    if missing:
        raise ArgumentError(
            f"{what} has signs that the typeface does not: {' '.join(missing[:10])}; give font=, a .ttf file that has"
        )


def fitting(text: str, size: float, width: float, font: str | None = None) -> str:
    """The text, with its middle left out where it is wider than this."""
    for n in range(len(text), 1, -1):
        short = text if n == len(text) else f"{text[: (n + 1) // 2]}\u2026{text[len(text) - n // 2 :]}"
        if text_width(short, size, font) <= width:
            return short
    return text[:1]


def has_sign(sign: str, font: str | None) -> bool:
    """Whether the typeface has a sign."""
    typeface = opened(font, 32)
    return _drawn(typeface, sign) != _drawn(typeface, "\uffff")


def _drawn(typeface: Any, sign: str) -> bytes:
    mask = typeface.getmask(sign)
    return bytes(mask) + bytes(str(mask.size), "ascii")


def wrapped(text: str, size: float, width: float, font: str | None = None) -> list[str]:
    """Lines of at most this width, broken at blanks; a longer word stands alone."""
    lines = []
    for paragraph in text.splitlines() or [""]:
        line = ""
        for word in BLANKS.split(paragraph.strip(" \t")):
            longer = f"{line} {word}" if line else word
            if line and text_width(longer, size, font) > width:
                lines.append(line)
                longer = word
            line = longer
        lines.append(line)
    return lines
