"""Colour bars: the colours of a transfer function over the values that it shows, with round numbers beside them.

Projections show colour times opacity over the background; else opacity is left out, since a ray meets many values.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from itertools import pairwise
from math import ceil, copysign, floor, isfinite, log1p, log10
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wavesplat._looks.curves import colormaps
from wavesplat._looks.curves.transfer_function import TransferFunction
from wavesplat._model.volume import units
from wavesplat._picture.lettering import CAP_HEIGHT, text_width
from wavesplat._picture.marks import UPWARDS, Block, Color, Mark, Ramp, Rectangle, Style, Text
from wavesplat.errors import ArgumentError

#: Sizes of the bar, in sizes of the font: width, length of a tick, gap to its number, least height for a number.
WIDTH, TICK, GAP, SPACE = 1.0, 0.3, 0.3, 2.4
#: Largest number of ticks: further numbers say nothing more.
MAX_TICKS = 7
#: Width of a title, in sizes of the font, that always has room above the bar.
SHORT = 5.0
#: Operators that show a colour for a surface or mix colours along a ray; all others colour one number per ray.
MIXING = ("over", "first-hit")
#: Signs for "-0123456789".
RAISED = "\u02c9\u00ba\u00b9\u00b2\u00b3\u2074\u2075\u2076\u2077\u2078\u2079"
#: Numbers from here on, and below the inverse of 1000, are written with a power of ten.
LARGE, SMALL = 1e5, 1e-3
#: Length of a number with a power of ten from which it is written out instead, and largest number written out.
LONG_TEXT, WRITTEN_OUT = 8, 1e15
#: Largest error of a written number, as a share of the step between two; largest number of its decimals.
SHARE_OF_STEP, MAX_DECIMALS = 1e-3, 17
#: Least range with round numbers in float64, and least exponent: its powers of ten end soon after.
MIN_SPAN, MIN_EXPONENT = 1e-300, -300
#: A logarithmic map: least number of nodes, least number of decades, and tolerance of their even distances.
LOG_NODES, LOG_DECADES, LOG_EVEN = 16, 1.0, 0.02
STOPS_PER_SPAN = 8
MINUS, TIMES = "\N{MINUS SIGN}", "\N{MULTIPLICATION SIGN}"


@dataclass(frozen=True)
class Scale:
    """Colours from the lowest to the highest value that is shown, and the name of the values."""

    low: float
    high: float
    stops: tuple[tuple[float, Color], ...]
    is_log: bool
    title: str
    #: Size of values with a sign up to which the scale is about linear, where it is logarithmic beyond; 0 elsewhere.
    linear: float = 0.0

    def place(self, value: float) -> float:
        """Place of a value along the bar, 0..1."""
        if self.linear:
            return (_symlog(value, self.linear) / _symlog(self.high, self.linear) + 1) / 2
        if self.is_log:
            return log10(value / self.low) / log10(self.high / self.low)
        return (value - self.low) / (self.high - self.low)


def scale_of(curves: TransferFunction | None, composite: str, title: str, background: Color) -> Scale:
    """The scale of a transfer function's bar; `curves` None is one that depends on more than the value."""
    if curves is None:
        raise ArgumentError(
            f"the colours of {title!r} depend on the gradient or a second field too, so there is no colour bar for "
            "them; leave it out, or draw with a TransferFunction"
        )
    low, high = _window(curves)
    is_log = _is_log(curves) and low > 0
    linear = _linear_part(curves) if low == -high else 0.0
    nodes = sorted({value for value, *_ in (*curves.opacity, *curves.color) if low < value < high} | {low, high})
    values = (
        _between(np.array(nodes), is_log=is_log) if is_log or linear or composite not in MIXING else np.array(nodes)
    )
    # Both sides of a step: the curves just below a node, and just above it.
    sides = [(value, side) for value in values.tolist() for side in (-1, 1)]
    rgba = curves(np.array([value + side * 1e-9 * (high - low) for value, side in sides]))
    rgba[:, 3] = np.where(composite in MIXING, 1.0, rgba[:, 3])
    rgb = rgba[:, :3] * rgba[:, 3:] + (1 - rgba[:, 3:]) * np.array(background)
    scale = Scale(low, high, (), is_log, title, linear)
    stops: list[tuple[float, Color]] = []
    for (value, _), (red, green, blue) in zip(sides, rgb.tolist(), strict=True):
        stop = (min(max(scale.place(value), 0.0), 1.0), (round(red, 6), round(green, 6), round(blue, 6)))
        if (
            not stops
            or max(abs(a - b) for a, b in zip(stop[1], stops[-1][1], strict=True)) > 1e-6
            or (stop[0] != stops[-1][0])
        ):
            stops.append(stop)
    return Scale(low, high, tuple(stops), is_log, title, linear)


def scale_of_depths(depth_colors: Mapping[str, Any], unit: str | None) -> Scale:
    """The scale of the report's depth colours: depths from the nearest place, or coordinates along an axis."""
    axis, (low, high) = depth_colors["axis"], depth_colors["range"]
    low, high = (0.0, high - low) if axis is None else (low, high)
    places, colors = colormaps.colors_of(depth_colors["cmap"])
    stops = tuple(
        (place, (red, green, blue)) for place, (red, green, blue) in zip(places, colors.tolist(), strict=True)
    )
    return Scale(
        low, high, stops, is_log=False, title=(axis or "depth") + (f" ({units.written(unit)})" if unit else "")
    )


def block(scale: Scale, height: float, style: Style, background: Color | None = None) -> Block:
    """The bar with its title, `height` high together.

    A short title stands above, with the power of ten that the numbers lack; a long one beside, from below upwards.
    """
    size, font = style.size, style.font
    ticks, exponent = _ticks(scale, min(MAX_TICKS, max(2, int((height - 2 * size) / (SPACE * size)))))
    numbers = (WIDTH + TICK + GAP) * size
    right = numbers + max(text_width(text, size, font) for _, text in ticks)
    is_long = text_width(scale.title, size, font) > max(right, SHORT * size)
    power = f"{TIMES}10{_raised(exponent)}" if exponent else ""
    head = power if is_long else "  ".join(text for text in (scale.title, power) if text)
    top = (1.7 if head else 0.4) * size
    length, width = height - top - 0.4 * size, WIDTH * size
    line = max(1.0, round(0.05 * size))
    edge = style.ink if background is None else _mixed(style.ink, background)

    def written(x: float, y: float, text: str) -> Text:
        return Text(x, y, text, size, style.ink, "start", style.halo)

    marks: list[Mark] = [written(0, CAP_HEIGHT * size, head)] if head else []
    marks.append(Rectangle(-line, top - line, width + 2 * line, length + 2 * line, edge, style.halo))
    marks.append(Ramp(0, top, width, length, scale.stops))
    for value, text in ticks:
        y = top + (1 - scale.place(value)) * length
        marks.append(Rectangle(width, y - line / 2, TICK * size, line, edge, style.halo))
        marks.append(written(numbers, y + CAP_HEIGHT * size / 2, text))
    right = max(right, text_width(head, size, font))
    if is_long:
        room = length + top
        small = min(size, size * room / text_width(scale.title, size, font))
        right += 0.6 * size + CAP_HEIGHT * small
        middle = top + length / 2 if text_width(scale.title, small, font) <= length else height - room / 2
        marks.append(Text(right, middle, scale.title, small, style.ink, "middle", style.halo, UPWARDS))
        right += 0.2 * small
    return Block(tuple(marks), right, height)


def round_ticks(low: float, high: float, most: int) -> list[float]:
    """Multiples of 1, 2, 2.5 or 5 times a power of ten within the range, at most `most` and at least two."""
    span = high - low
    if span < MIN_SPAN:
        return [low, high]
    decade = 10.0 ** floor(log10(span))
    steps = sorted(digit * decade * scale for digit in (1, 2, 2.5, 5) for scale in (0.01, 0.1, 1))
    for step in steps:
        first, last = ceil(low / step - 1e-9), floor(high / step + 1e-9)
        ticks = [number * step for number in range(first, last + 1)] if 2 <= last - first + 1 <= most else []
        # Near the limit of float64 neighbours can be one number.
        if ticks and len(set(ticks)) == len(ticks):
            return ticks
    return [low, high]


def _ticks(scale: Scale, most: int) -> tuple[list[tuple[float, str]], int]:
    """Values with their texts, and the power of ten that all texts are multiplied by."""
    if scale.is_log:
        exponents = range(ceil(log10(scale.low) - 1e-9), floor(log10(scale.high) + 1e-9) + 1)
        kept = list(exponents)[:: max(1, ceil(len(exponents) / most))]
        if len(kept) >= 2:
            return [(10.0**power, _power(power)) for power in kept], 0
    if scale.linear:
        # Powers of ten from the linear part on, on both sides of 0.
        exponents = range(ceil(log10(scale.linear) - 1e-9), floor(log10(scale.high) + 1e-9) + 1)
        kept = list(exponents)[:: -max(1, ceil(2 * len(exponents) / most))][::-1]
        above = [(10.0**power, _power(power)) for power in kept]
        if above:
            below = [(-value, MINUS + text) for value, text in reversed(above)]
            return [*below, (0.0, "0"), *above], 0
    values = round_ticks(scale.low, scale.high, most)
    largest = max(abs(value) for value in values)
    exponent = max(floor(log10(largest)), MIN_EXPONENT) if largest and not SMALL <= largest < LARGE else 0
    texts = _written(values, exponent)
    if exponent > 0 and largest < WRITTEN_OUT and max(map(len, texts)) > LONG_TEXT:
        # Dates and times since an epoch: 20260101 is shorter than 2.0260101 and its power of ten.
        exponent, texts = 0, _written(values, 0)
    return list(zip(values, [text.replace("-", MINUS) for text in texts], strict=True)), exponent


def _written(values: list[float], exponent: int) -> list[str]:
    """Values over a power of ten, with the fewest decimals that distinguish them and are near enough."""
    shown = [value / 10.0**exponent for value in values]
    near = SHARE_OF_STEP * abs(shown[1] - shown[0])
    for digits in range(MAX_DECIMALS + 1):
        texts = [f"{number:.{digits}f}" for number in shown]
        if len(set(texts)) == len(texts) and all(
            abs(float(text) - number) <= near for text, number in zip(texts, shown, strict=True)
        ):
            return texts
    return [f"{number:.17g}" for number in shown]


def _power(exponent: int) -> str:
    """A power of ten as text: short ones written out, others with an exponent."""
    return f"{10.0**exponent:g}" if -3 <= exponent <= 3 else f"10{_raised(exponent)}"


def _raised(number: int) -> str:
    # The typeface has no raised minus and zero; a macron and an ordinal sign look like them.
    return str(number).translate(str.maketrans("-0123456789", RAISED))


def _window(curves: TransferFunction) -> tuple[float, float]:
    """Range from the first to the last value at which something is visible and changes."""
    opacity, color = curves.opacity, curves.color
    ends = [value for value, _ in opacity] + [value for value, *_ in color]
    low, high = min(ends), max(ends)
    seen = [place for place, (_, alpha) in enumerate(opacity) if alpha > 0]
    if seen:
        if seen[0] > 0:
            low = opacity[seen[0] - 1][0]
        if seen[-1] < len(opacity) - 1:
            high = opacity[seen[-1] + 1][0]
    if not high > low:
        # A step: colours on both sides of it.
        reach = abs(low) / 2 or 0.5
        low, high = low - reach, high + reach
    if not isfinite(high - low):
        raise ArgumentError("the transfer function reaches to infinity; there is no colour bar for it")
    return float(low), float(high)


def _is_log(curves: TransferFunction) -> bool:
    """Whether the colours are even in the logarithm of the values, as `from_colormap(..., log=True)` makes them."""
    values = np.array([value for value, *_ in curves.color])
    if len(values) < LOG_NODES or values[0] <= 0 or log10(values[-1] / values[0]) < LOG_DECADES:
        return False
    steps = np.diff(np.log(values))
    return bool(np.ptp(steps) <= LOG_EVEN * steps.mean())


def _linear_part(curves: TransferFunction) -> float:
    """Size of values up to which colours are about even, where they are even in symmetric logarithms; 0 elsewhere.

    The scale is sign(v) log(1 + |v| / linear). Of even places the first two values above 0 give `linear`.
    """
    values = np.array([value for value, *_ in curves.color])
    n = len(values) // 2
    if len(values) < LOG_NODES or len(values) % 2 == 0 or values[n] != 0 or not np.allclose(values, -values[::-1]):
        return 0.0
    above = values[n + 1 :]
    ratio = above[1] / above[0] - 2
    if ratio < LOG_EVEN:
        return 0.0
    linear = float(above[0] / ratio)
    places = np.log1p(above / linear)
    is_even = np.allclose(places, places[0] * np.arange(1, n + 1), rtol=LOG_EVEN)
    return linear if is_even and above[-1] > 10**LOG_DECADES * linear else 0.0


def _symlog(value: float, linear: float) -> float:
    return copysign(log1p(abs(value) / linear), value)


def _between(nodes: NDArray[np.float64], *, is_log: bool) -> NDArray[np.float64]:
    """Nodes and values between them, where colours are not linear along the bar."""
    count = max(2, min(STOPS_PER_SPAN, 256 // len(nodes)))
    space = np.geomspace if is_log else np.linspace
    spans = [space(start, end, count, endpoint=False) for start, end in pairwise(nodes)]
    return np.concatenate([*spans, nodes[-1:]])


def _mixed(ink: Color, background: Color) -> Color:
    """Colour of lines: the ink mixed with the background, lighter than letters."""
    red, green, blue = (0.7 * one + 0.3 * other for one, other in zip(ink, background, strict=True))
    return red, green, blue
