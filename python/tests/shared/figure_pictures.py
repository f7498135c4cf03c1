"""A synthetic picture with a report, and the texts on figures of it."""

from __future__ import annotations

import numpy as np

import wavesplat as ws
from wavesplat._picture import lettering
from wavesplat._picture.marks import UPWARDS, Ramp, Rectangle, Text
from wavesplat._picture.report_facts import shown_layer

GREYS = ws.TransferFunction([(0, 1), (1000, 1)], [(0, 0, 0, 0), (1000, 1, 1, 1)])
BONE = ws.TransferFunction([(150, 0), (400, 0.8)], [(150, 0.8, 0.5, 0.3), (400, 1, 1, 0.9)])
CAMERA = ws.Camera((0, 500, 0), (0, 0, 0), (0, 0, 1), parallel_scale=100)
ALPHA = "\N{GREEK SMALL LETTER ALPHA}"
RED, GREEN, WHITE = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (1.0, 1.0, 1.0)


def picture(background="white", size=(400, 300), **facts):
    """A disc on a background, with the report of a rendered picture."""
    width, height = size
    y, x = np.mgrid[:height, :width]
    rgba = np.zeros((height, width, 4), np.float32)
    if background != "transparent":
        rgba[:] = (1, 1, 1, 1) if background == "white" else (0, 0, 0, 1)
    rgba[np.hypot(y - height / 2, x - width / 2) < height / 3] = (0.4, 0.5, 0.6, 1)
    report = {"pixel": 0.5, "unit": "mm", "anatomical": True, "camera": CAMERA.as_json(), "background": background}
    report["shown"] = [shown_layer("ct.nii.gz", "over", BONE, "HU")]
    return ws.Picture(rgba, report=report | facts)


def without(name):
    made = picture()
    del made.report[name]
    return made


def drawn_in(before, after):
    """Mask of the pixels that changed, of the first picture's size."""
    height, width = before.rgba.shape[:2]
    return (before.rgba != after.rgba[-height:, :width]).any(axis=2)


def texts(figure):
    """Texts on a figure, in order."""
    return [mark.text for mark in figure._canvas.marks if isinstance(mark, Text)]


def check_inside(figure):
    """Check that all marks of a figure lie on its canvas."""
    width, height = figure.size
    for mark in figure._canvas.marks:
        if isinstance(mark, Text) and mark.slant != UPWARDS:
            long = lettering.text_width(mark.text, mark.size)
            left = mark.x - long * {"start": 0, "middle": 0.5, "end": 1}[mark.anchor]
            assert left >= 0
            assert left + long <= width
            assert 0.69 * mark.size <= mark.y <= height
        elif isinstance(mark, Text):
            assert mark.x <= width
        elif isinstance(mark, Rectangle | Ramp):
            assert min(mark.x, mark.y) >= 0
            assert mark.x + mark.width <= width
            assert mark.y + mark.height <= height
