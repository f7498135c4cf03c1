"""Colours as people write them."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from typing import Any, TypeAlias

from wavesplat._files import values
from wavesplat._model.argument_types import described
from wavesplat.errors import ArgumentError

__all__ = ["Rgba", "parse"]

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
