"""Colours: as people write them, and interpolated in the spaces that VTK has.

Msh is CIE Lab in polar coordinates: M the distance from black, s the angle from the grey axis, h the hue.
Half way between two saturated colours of different hue it passes through white or grey.
Sources: CIE 15 (Lab, white point D65 as in sRGB); Moreland, Diverging color maps for scientific visualization, 2009.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Mapping
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from wavesplat._system import values
from wavesplat._system.values import described
from wavesplat.errors import ArgumentError

# Colours as people write them.

Rgba: TypeAlias = tuple[float, float, float, float]

#: Colours by name, pure as those of microscopes' channels: this green is brighter than that of web pages. Others have
#: the names of web pages.
NAMES: dict[str, Rgba] = {
    "black": (0.0, 0.0, 0.0, 1.0),
    "white": (1.0, 1.0, 1.0, 1.0),
    "grey": (0.5, 0.5, 0.5, 1.0),
    "gray": (0.5, 0.5, 0.5, 1.0),
    "red": (1.0, 0.0, 0.0, 1.0),
    "green": (0.0, 1.0, 0.0, 1.0),
    "blue": (0.0, 0.0, 1.0, 1.0),
    "cyan": (0.0, 1.0, 1.0, 1.0),
    "magenta": (1.0, 0.0, 1.0, 1.0),
    "yellow": (1.0, 1.0, 0.0, 1.0),
    "orange": (1.0, 0.65, 0.0, 1.0),
}


def parse(color: str | Iterable[Any] | None) -> Rgba | None:
    """Red, green, blue and opacity, 0..1, not associated; None for None and for "transparent".

    Takes three or four numbers 0..1, a name (black, red, skyblue, transparent), "#rrggbb", "#rrggbbaa", "r,g,b[,a]".
    """
    if color is None:
        return None
    if isinstance(color, str):
        if color == "transparent":
            return None
        return _parse_text(color.strip().lower())
    return _checked(color, color)


def _parse_text(text: str) -> Rgba:
    if text in NAMES:
        return NAMES[text]
    if re.fullmatch(r"#([0-9a-f]{6}|[0-9a-f]{8})", text):
        return _checked((byte / 255 for byte in bytes.fromhex(text[1:])), text)
    if text in (web := _web_colors()):
        return _checked((byte / 255 for byte in bytes.fromhex(web[text][1:])), text)
    try:
        return _checked([float(part) for part in text.split(",")], text)
    except ValueError:
        return _checked((), text)


def _web_colors() -> Mapping[str, Any]:
    """Colours of web pages by name, as "#rrggbb"."""
    from PIL import ImageColor

    return ImageColor.colormap


def _checked(numbers: Iterable[Any], given: object) -> Rgba:
    try:
        channels = values.numbers(numbers, "color", least=0, most=1)
    except ArgumentError:
        channels = ()
    if len(channels) not in (3, 4):
        raise ArgumentError(
            f'color is {described(given)}; give (r, g, b) or (r, g, b, a) with numbers 0..1, "#rrggbb", black, white, '
            "grey, red, green, blue, cyan, magenta, yellow, orange, transparent or one of web pages (skyblue)"
        )
    red, green, blue, alpha = (*channels, 1.0)[:4]
    return red, green, blue, alpha


# Interpolation of colours in RGB, HSV, CIE Lab, and Moreland's diverging space Msh, as VTK does it.

Color: TypeAlias = tuple[float, float, float]
Array: TypeAlias = NDArray[np.float64]

#: Linear sRGB to XYZ with Y of white 1, and that white (D65), as VTK rounds them.
XYZ_FROM_RGB = np.array([[0.4124, 0.3576, 0.1805], [0.2126, 0.7152, 0.0722], [0.0193, 0.1192, 0.9505]])
WHITE = np.array([0.9505, 1.0, 1.0890])
#: Tolerances of angles: s below which a colour is grey, and difference below which two hues are one (Moreland).
GREY, ONE_HUE = 0.05, 0.33 * np.pi
#: Least M of the colour in the middle.
MIN_MIDDLE = 88.0


def _lab_from_rgb(rgb: Array) -> Array:
    linear = np.where(rgb > 0.04045, ((rgb + 0.055) / 1.055) ** 2.4, rgb / 12.92)
    xyz = XYZ_FROM_RGB @ linear / WHITE
    f = np.where(xyz > 0.008856, np.cbrt(xyz), 7.787 * xyz + 16 / 116)
    return np.array([116 * f[1] - 16, 500 * (f[0] - f[1]), 200 * (f[1] - f[2])])


def rgb_from_lab(lab: Array) -> Array:
    """A colour of CIE Lab (L 0..100) in sRGB, 0..1."""
    y = (lab[0] + 16) / 116
    f = np.array([lab[1] / 500 + y, y, y - lab[2] / 200])
    xyz = np.where(f**3 > 0.008856, f**3, (f - 16 / 116) / 7.787) * WHITE
    linear = np.linalg.inv(XYZ_FROM_RGB) @ xyz
    rgb = np.where(linear > 0.0031308, 1.055 * np.maximum(linear, 0) ** (1 / 2.4) - 0.055, 12.92 * linear)
    # Out of the gamut by too much light: dimmed as a whole, which keeps the hue, as VTK does.
    inside: Array = np.clip(rgb / max(1.0, float(rgb.max())), 0, 1)
    return inside


def _in_rgb(first: Color, second: Color, parts: Array) -> list[Array]:
    a, b = np.array(first), np.array(second)
    return [a + part * (b - a) for part in parts]


def _in_lab(first: Color, second: Color, parts: Array) -> list[Array]:
    a, b = _lab_from_rgb(np.array(first)), _lab_from_rgb(np.array(second))
    return [rgb_from_lab(a + part * (b - a)) for part in parts]


def _in_hsv(first: Color, second: Color, parts: Array) -> list[Array]:
    import colorsys

    a, b = np.array(colorsys.rgb_to_hsv(*first)), np.array(colorsys.rgb_to_hsv(*second))
    return [np.array(colorsys.hsv_to_rgb(*(a + part * (b - a)))) for part in parts]


def _in_hsv_the_short_way(first: Color, second: Color, parts: Array) -> list[Array]:
    import colorsys

    a, b = np.array(colorsys.rgb_to_hsv(*first)), np.array(colorsys.rgb_to_hsv(*second))
    if abs(a[0] - b[0]) > 0.5:
        (a if a[0] > b[0] else b)[0] -= 1
    mixed = (a + part * (b - a) for part in parts)
    return [np.array(colorsys.hsv_to_rgb(hue % 1.0, saturation, value)) for hue, saturation, value in mixed]


def _in_msh(first: Color, second: Color, parts: Array) -> list[Array]:
    a, b = _msh_from_rgb(first), _msh_from_rgb(second)
    mixed = []
    for part in parts:
        left, right, way = a.copy(), b.copy(), float(part)
        if left[1] > GREY and right[1] > GREY and _between_hues(left[2], right[2]) > ONE_HUE:
            # Through white in the middle.
            middle = np.array([max(left[0], right[0], MIN_MIDDLE), 0.0, 0.0])
            left, right, way = (left, middle, 2 * way) if way < 0.5 else (middle, right, 2 * way - 1)
        if left[1] < GREY < right[1]:
            left[2] = _hue_of_grey(right, left[0])
        elif right[1] < GREY < left[1]:
            right[2] = _hue_of_grey(left, right[0])
        # Hue is a circle; the shorter way round.
        right[2] -= 2 * np.pi * np.round((right[2] - left[2]) / (2 * np.pi))
        m, s, h = left + way * (right - left)
        mixed.append(rgb_from_lab(m * np.array([np.cos(s), np.sin(s) * np.cos(h), np.sin(s) * np.sin(h)])))
    return mixed


def _msh_from_rgb(rgb: Color) -> Array:
    lab = _lab_from_rgb(np.array(rgb))
    m = float(np.linalg.norm(lab))
    s = float(np.arccos(np.clip(lab[0] / m, -1, 1))) if m > 0.001 else 0.0
    return np.array([m, s, np.arctan2(lab[2], lab[1]) if s > 0.001 else 0.0])


def _between_hues(first: float, second: float) -> float:
    apart = abs(first - second)
    return min(apart, 2 * np.pi - apart)


def _hue_of_grey(saturated: Array, m: float) -> float:
    """The hue for a grey end: the saturated colour's plus a spin, so that steps of its fading look even."""
    if saturated[0] >= m:
        return float(saturated[2])
    spin = saturated[1] * np.sqrt(m**2 - saturated[0] ** 2) / (saturated[0] * np.sin(saturated[1]))
    # The spin leads away from purple.
    return float(saturated[2] + (spin if saturated[2] > -0.3 * np.pi else -spin))


def _step(_: Color, second: Color, parts: Array) -> list[Array]:
    return [np.array(second) for _part in parts]


#: Interpolations by the name that ParaView gives them.
SPACES: dict[str, Callable[[Color, Color, Array], list[Array]]] = {
    "RGB": _in_rgb,
    "HSV": _in_hsv,
    "HSVWrap": _in_hsv_the_short_way,
    "Lab": _in_lab,
    "Lab/CIEDE2000": _in_lab,
    "CIELAB": _in_lab,
    "Diverging": _in_msh,
    "Step": _step,
}


def between(space: str, first: Color, second: Color, parts: Array) -> list[Color]:
    """The colours at parts, 0..1, of the way from one colour to another."""
    return [(float(r), float(g), float(b)) for r, g, b in SPACES[space](first, second, parts)]
