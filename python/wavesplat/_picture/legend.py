"""Legends: a swatch of colour and a name a line, in columns."""

from __future__ import annotations

from collections.abc import Sequence
from math import ceil

from wavesplat._picture.lettering import CAP_HEIGHT, text_width
from wavesplat._picture.marks import Block, Color, Mark, Rectangle, Text
from wavesplat._picture.style import Style

#: Largest number of entries of a legend that was not asked for by name.
LONGEST = 30
#: Smallest number of lines in a column, where the picture is lower: else columns are as many as names.
MIN_LINES = 16

#: Sizes in units of the font: a swatch, the gap to its name, a line, and the gap between columns.
SWATCH, GAP, LINE, COLUMN = 0.85, 0.5, 1.45, 1.4


def shortened(swatches: Sequence[tuple[str, Color]]) -> list[tuple[str, Color | None]]:
    """The names, of very many the first ones and how many more there are."""
    if len(swatches) <= LONGEST:
        return list(swatches)
    return [*swatches[:LONGEST], (f"and {len(swatches) - LONGEST} more", None)]


def block(swatches: Sequence[tuple[str, Color | None]], height: float, style: Style, *, may_be_higher: bool) -> Block:
    """All names, in as few columns as the height allows, which are equally long; without a colour, the name alone.

    may_be_higher : the block may be higher than the picture that it stands beside.
    """
    size = style.size
    most = max(MIN_LINES if may_be_higher else 1, int((height - SWATCH * size) / (LINE * size)) + 1)
    n_columns = ceil(len(swatches) / most)
    n_rows = ceil(len(swatches) / n_columns)
    marks: list[Mark] = []
    x = right = 0.0
    for start in range(0, len(swatches), n_rows):
        column = swatches[start : start + n_rows]
        for row, (name, color) in enumerate(column):
            y = row * LINE * size
            line = max(1.0, round(0.05 * size))
            side = SWATCH * size
            if color is not None:
                marks.append(Rectangle(x, y, side, side, style.ink, style.halo))
                marks.append(Rectangle(x + line, y + line, side - 2 * line, side - 2 * line, color))
            baseline = y + (side + CAP_HEIGHT * size) / 2
            marks.append(Text(x + side + GAP * size, baseline, name, size, style.ink, "start", style.halo))
        right = x + (SWATCH + GAP) * size + max(text_width(name, size, style.font) for name, _ in column)
        x = right + COLUMN * size
    return Block(tuple(marks), right, (n_rows - 1) * LINE * size + SWATCH * size)
