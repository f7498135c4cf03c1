"""Lines over a picture, with smooth edges; and lines of equal value on a slice, such as isodoses."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from math import ceil, floor
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wavesplat._looks.curves import colors
from wavesplat._looks.curves.colormaps import colors_of
from wavesplat._model.arguments.types import takes_its_types
from wavesplat._model.volume.volume import Volume
from wavesplat._model.volume.volume_like import as_volume
from wavesplat._model.volume.wavelet_volume import WaveletVolume
from wavesplat._public import public
from wavesplat._system.values import described, numbers
from wavesplat.errors import ArgumentError

# Lines over a picture: smooth edges, by masks that Pillow draws finer than the pixels.

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


# Lines of equal value of a volume on a slice, such as isodoses: what is drawn, and where it lies in the picture.

#: Values of one volume, at most.
MAX_VALUES = 64
#: The part of a colour map that the lines have: its ends are dark, or white.
MAP_ENDS = (0.08, 0.92)


@public
@dataclass(frozen=True, init=False, eq=False)
class Isolines:
    """Lines of equal value of a volume, for slices: isodoses, isotherms, isobars.

    Parameters
    ----------
    volume : Volume, WaveletVolume, array or what else `Volume` takes
        It may be another one than the slice is of, on a grid of its own.
    values : sequence of float
        A line for each, in the unit of the volume's values.
    color : colour or str, default "turbo"
        One colour of all lines, or a colour map from the least value to the greatest.
    name : str, optional
        Name in the legend, before the values; the volume's name where values have no unit, else none.

    Raises
    ------
    ArgumentError
        If one of them cannot be.

    Examples
    --------
    >>> import wavesplat as ws
    >>> scan = ws.examples.ct_pelvis()
    >>> picture = ws.slice(scan, isolines=ws.Isolines(scan.smoothed(2), [-200, 100]))
    >>> [line["name"] for line in picture.report["lines"]]
    ['-200 HU', '100 HU']
    """

    volume: Volume | WaveletVolume
    values: tuple[float, ...]
    color: str | tuple[float, float, float]
    name: str

    @takes_its_types
    def __init__(
        self, volume: Any, values: Iterable[float], *, color: str | Iterable[float] = "turbo", name: str = ""
    ) -> None:
        form = f"1 to {MAX_VALUES} finite numbers, such as [20, 40]"
        levels = sorted(set(numbers(values, "values of isolines", form)))
        if not 1 <= len(levels) <= MAX_VALUES:
            raise ArgumentError(f"values of isolines is {described(values)}; give {form}")
        for attribute, value in (
            ("volume", as_volume(volume)),
            ("values", tuple(levels)),
            ("color", _checked(color)),
            ("name", str(name)),
        ):
            object.__setattr__(self, attribute, value)

    def colors(self) -> list[tuple[float, float, float]]:
        """Red, green and blue, 0..1, of each line."""
        return _colors(self.color, len(self.values))

    def __repr__(self) -> str:
        listed = ", ".join(f"{value:g}" for value in self.values)
        return f"<Isolines of {self.volume.name!r}: {listed}>"


def _checked(color: Any) -> str | tuple[float, float, float]:
    """A colour, or the name of a colour map."""
    found = _colors(color, 1)[0]
    return color if isinstance(color, str) else found


def _colors(color: Any, n: int) -> list[tuple[float, float, float]]:
    """A colour for each of n values: one for all, or the places of a map."""
    try:
        one = colors.parse(color)
    except ArgumentError:
        if not isinstance(color, str):
            raise
        places = np.linspace(*MAP_ENDS, n) if n > 1 else np.array([MAP_ENDS[1]])
        return [(red, green, blue) for red, green, blue in _of_map(color, places)]
    if one is None:
        raise ArgumentError(f"color of isolines is {described(color)}; give a colour, or the name of a colour map")
    return [one[:3]] * n


def _of_map(name: str, places: NDArray[np.float64]) -> list[list[float]]:
    at, table = colors_of(name)
    mixed: list[list[float]] = np.column_stack([np.interp(places, at, channel) for channel in table.T]).tolist()
    return mixed


def lines_at(values: NDArray[np.float32], level: float) -> list[NDArray[np.float64]]:
    """Lines of a value in an array of values, NaN outside, by marching squares: points (x, y) in pixels."""
    from contourpy import LineType, contour_generator

    if min(values.shape) < 2:
        return []
    generator: Any = contour_generator(
        z=np.ma.masked_invalid(values.astype(np.float64)), line_type=LineType.Separate, corner_mask=True
    )
    return [line for line in generator.lines(level) if len(line) > 1]
