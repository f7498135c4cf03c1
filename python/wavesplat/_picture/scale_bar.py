"""Scale bars: a round length, 1, 2 or 5 times a power of ten, near a fifth of the picture's width."""

from __future__ import annotations

import re
from dataclasses import dataclass
from math import floor, isfinite, log10

from wavesplat._model.volume import units
from wavesplat._picture.lettering import CAP_HEIGHT, text_width
from wavesplat._picture.marks import Block, Mark, Rectangle, Style, Text
from wavesplat._system.values import described, float_of
from wavesplat.errors import ArgumentError

#: Wanted length of a bar, as a share of the picture's width.
SHARE = 0.2
#: Shortest bar, pixels, and longest, as a share of the picture's width.
MIN_PX, MAX_SHARE = 4.0, 0.95
#: Size of the line that remarks on the length, as a part of the number's.
SMALL = 0.8
FOCUS = "at the focal point"


@dataclass(frozen=True)
class Bar:
    """A length in world units and in pixels, and its text."""

    length: float
    length_px: float
    text: str
    remark: str = ""


def bar_of(
    wanted: bool | float | str, width: int, pixel: float, unit: str | None, *, is_perspective: bool = False
) -> Bar:
    """The bar for a picture `width` pixels wide.

    wanted : True, a length in world units, the name of a unit, or a length with it, such as "50 um".
    """
    number, asked = _asked(wanted)
    factor = _factor(unit, asked)
    length = factor * (round_length(SHARE * width * pixel / factor) if number is None else number)
    length_px = length / pixel
    if number is None and length_px < MIN_PX:
        raise ArgumentError(f"a picture {width} pixels wide has no room for a scale bar; draw a larger one")
    if not MIN_PX <= length_px <= MAX_SHARE * width:
        raise ArgumentError(
            f"the scale bar is {described(wanted)}, and the picture {width * pixel:.4g} {unit or 'units'} wide; give a "
            "length that is seen in it, or True"
        )
    if asked is not None:
        text = f"{length / factor:.9g} {units.written(asked)}"
    elif unit is None:
        # "units" is written, since a number alone would be taken for millimetres.
        text = f"{length:.9g} units"
    else:
        text = units.length_text(length, unit)
    return Bar(length, length_px, text, FOCUS if is_perspective else "")


def round_length(near: float) -> float:
    """The round length, 1, 2, 5, 10, 20, ... or tenths of these, whose ratio to a length is nearest 1."""
    decade = 10.0 ** floor(log10(near))
    lengths = [digit * decade for digit in (1, 2, 5, 10)]
    return min(lengths, key=lambda length: max(length / near, near / length))


def block(bar: Bar, style: Style) -> Block:
    """The bar with its text above."""
    thick = max(2.0, round(0.22 * style.size))
    lines = [(bar.text, style.size)] + ([(bar.remark, SMALL * style.size)] if bar.remark else [])
    width = max(bar.length_px, *(text_width(text, size, style.font) for text, size in lines))
    marks: list[Mark] = []
    y = 0.0
    for text, size in lines:
        y += CAP_HEIGHT * size if y == 0 else 1.25 * size
        # Over the middle of the bar where that keeps it above the bar, else from its beginning.
        fits = text_width(text, size, style.font) <= bar.length_px and not bar.remark
        x, anchor = (bar.length_px / 2, "middle") if fits else (0.0, "start")
        marks.append(Text(x, y, text, size, style.ink, "middle" if anchor == "middle" else "start", style.halo))
    y += (0.5 if bar.remark else 0.4) * style.size
    marks.append(Rectangle(0, y, bar.length_px, thick, style.ink, style.halo))
    return Block(tuple(marks), width, y + thick)


def _asked(wanted: bool | float | str) -> tuple[float | None, str | None]:
    """The length and the unit that are asked for; each None if it is not."""
    if wanted is True:
        return None, None
    if isinstance(wanted, str):
        text = wanted.strip()
        match = re.match(r"[0-9.]+(?:[eE][-+]?[0-9]+)?", text)
        digits, name = (match[0], text[match.end() :].lstrip()) if match else (None, text)
        try:
            number = float(digits) if digits else None
        except ValueError:
            number = float("nan")
        unit = units.checked(name) if name else None
    else:
        number, unit = float_of(wanted) or 0.0, None
    if number is not None and not (isfinite(number) and number > 0):
        raise ArgumentError(f"the scale bar is {described(wanted)}; give a positive length in world units, or True")
    return number, unit


def _factor(unit: str | None, asked: str | None) -> float:
    """World units in one of the units that is asked for."""
    if asked is None or unit is None or asked == unit:
        return 1.0
    ours, theirs = units.metres(unit), units.metres(asked)
    if ours is None or theirs is None:
        raise ArgumentError(
            f"the scale bar is wanted in {asked!r}, but the world's unit is {described(unit)}; give True"
        )
    return float(f"{theirs / ours:.12g}")
