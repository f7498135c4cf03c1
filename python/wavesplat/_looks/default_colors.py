"""Colours of things that have none of their own, one after the other."""

from __future__ import annotations

import colorsys


def label_color(place: int) -> tuple[float, float, float]:
    """The colour of a label by its place among others.

    Steps of a golden section leave no large gap in the circle of hues after any number of labels, and a colour does not
    depend on how many labels there are.
    """
    hue = (0.05 + place * 0.618_033_988_75) % 1.0
    lightness, saturation = (0.55, 0.65) if place % 2 == 0 else (0.68, 0.5)
    return colorsys.hls_to_rgb(hue, lightness, saturation)
