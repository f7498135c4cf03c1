"""Reference lines: where the planes of other slices cross a slice, in a colour for each direction of planes."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from itertools import product
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from wavesplat._model.views import PLANES
from wavesplat._picture.picture import Picture
from wavesplat._render.lines import drawn_over

Facts: TypeAlias = Mapping[str, Any]
Line: TypeAlias = NDArray[np.float64]

#: Colours by the world's axis that is most across the planes, those of the viewer's slices.
COLORS = {"z": (1.0, 0.42, 0.42), "y": (0.42, 0.83, 0.42), "x": (0.42, 0.66, 1.0)}
#: Sine of the angle of two planes, below which they count as parallel.
PARALLEL = 1e-6


def color_of(report: Facts) -> tuple[float, float, float]:
    """The colour of a slice's plane in other slices; `report`: of the slice."""
    return COLORS["xyz"[int(np.abs(report["normal"]).argmax())]]


def scout_of(normal: Iterable[float], planes: tuple[str, str, str]) -> str:
    """Which of the volume's named planes shows slices with this normal as lines: sagittal, or coronal of sagittal ones.

    planes : the names of the three planes of the volume.
    """
    x, y, _ = np.abs(tuple(normal))
    return next(name for name in planes if PLANES[name].across == ("x" if x <= y else "y"))


def with_reference_lines(picture: Picture, others: Iterable[Facts]) -> Picture:
    """The slice with a line where each of the other slices' planes crosses it.

    others : reports of the other slices.
    """
    rgba = picture.rgba
    for other in others:
        line = _crossing(picture.report, picture.size, other)
        if line is not None:
            rgba = drawn_over(rgba, [line], color_of(other))
    return Picture(rgba, value=picture.value, report=picture.report)


def _crossing(report: Facts, size: tuple[int, int], other: Facts) -> Line | None:
    """The ends (x, y) of a line from edge to edge of a picture, in pixels; None where the plane does not cross it."""
    normal, origin = np.array(other["normal"]), np.array(report["origin"])
    # Heights above the other plane rise evenly along the picture's rows and columns.
    per_pixel = report["pixel"] * np.array([normal @ report["right"], normal @ report["down"]])
    height = float(normal @ (origin - np.array(other["origin"])))
    if np.abs(per_pixel).max() <= PARALLEL * report["pixel"]:
        return None
    ends = []
    edges = np.array([(-0.5, n - 0.5) for n in size])
    for along, side in product((0, 1), (0, 1)):
        across = 1 - along
        if per_pixel[along] == 0:
            continue
        point = np.empty(2)
        point[across] = edges[across, side]
        point[along] = -(height + per_pixel[across] * point[across]) / per_pixel[along]
        if edges[along, 0] <= point[along] <= edges[along, 1]:
            ends.append(point)
    if len(ends) < 2:
        return None
    # Through a corner there are three or four ends, of which two are the same.
    apart = [np.linalg.norm(end - ends[0]) for end in ends]
    farthest = int(np.argmax(apart))
    return np.array([ends[0], ends[farthest]]) if apart[farthest] > 0 else None
