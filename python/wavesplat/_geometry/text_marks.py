"""Text in space: numbers and titles of frames, names of points, as marks on the picture at projected places.

Marks that would lie over each other, or beyond the picture, are left out: names of points first those farther away.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from itertools import product
from math import radians, tan
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from wavesplat._geometry.frame import Frame, ticks_of
from wavesplat._geometry.points import SIZE_PX, Points
from wavesplat._geometry.shape import Shape
from wavesplat._model.camera.camera import Camera
from wavesplat._model.volume import units
from wavesplat._picture.lettering import CAP_HEIGHT, text_width
from wavesplat._picture.marks import Mark, Style, Text, stroke

Array: TypeAlias = NDArray[np.float64]

#: Length of a tick, gap to what is written, and distance of the title from the numbers, in sizes of the font.
TICK, GAP, TITLE_GAP = 0.4, 0.35, 0.45
#: Least length of an edge that gets ticks, in sizes of the font: shorter ones are seen from their end.
MIN_EDGE = 4.0
#: Share of a direction from which text stands beside, and not above or below, what it names.
BESIDE = 0.45
#: Largest number of points whose names are written.
MAX_NAMES = 2000
TITLES, ANATOMICAL = ("x", "y", "z"), ("R", "A", "S")


@dataclass
class _Page:
    """Marks on a picture, and the boxes that are taken."""

    camera: Camera
    size: tuple[int, int]
    style: Style
    marks: list[Mark] = field(default_factory=list)
    taken: list[tuple[float, float, float, float]] = field(default_factory=list)

    def place_of(self, points: Array) -> tuple[Array, Array]:
        """Places of world points, from the corner of the first pixel, and their depths."""
        pixels, depths = self.camera.project(points, size=self.size)
        return pixels + 0.5, depths

    def write(self, text: str, at: Array, towards: Array, size: float) -> float | None:
        """Write a text that begins at a place and stands off in a direction; its reach there, or None for no room."""
        across, high = text_width(text, size, self.style.font), CAP_HEIGHT * size
        if abs(towards[0]) >= BESIDE:
            left, top = (at[0] if towards[0] > 0 else at[0] - across), at[1] - high / 2
            reach = across
        else:
            left, top = at[0] - across / 2, (at[1] if towards[1] > 0 else at[1] - high)
            reach = abs(towards[1]) * high + abs(towards[0]) * across / 2
        rim = 0.15 * size
        box = (left - rim, top - rim, left + across + rim, top + high + rim)
        width, height = self.size
        if box[0] < 0 or box[1] < 0 or box[2] > width or box[3] > height or any(_meet(box, one) for one in self.taken):
            return None
        self.taken.append(box)
        self.marks.append(Text(left, top + high, text, size, self.style.ink, "start", self.style.halo))
        return reach


def has_text(shapes: Sequence[Shape]) -> bool:
    """Whether something is written beside shapes."""
    return any(_is_written(shape) for shape in shapes)


def _is_written(shape: Shape) -> bool:
    if isinstance(shape, Frame):
        return shape.ticks
    return isinstance(shape, Points) and shape.labels is not None and any(shape.labels)


def marks_in_space(
    shapes: Sequence[Shape],
    camera: Camera,
    size: tuple[int, int],
    style: Style,
    *,
    bounds: Array,
    unit: str | None,
    is_anatomical: bool,
) -> tuple[Mark, ...]:
    """The marks of all that is written beside shapes.

    bounds : box of frames without one. unit : of the world's lengths. is_anatomical : the axes are a patient's.
    """
    page = _Page(camera, size, style)
    for shape in shapes:
        if isinstance(shape, Frame) and shape.ticks:
            names = ANATOMICAL if is_anatomical else TITLES
            behind = f" ({units.written(unit)})" if shape.units and unit is not None else ""
            _write_frame(page, shape._around(bounds), [f"{name}{behind}" for name in names])
    for shape in shapes:
        if isinstance(shape, Points) and _is_written(shape):
            _write_names(page, shape)
    return tuple(page.marks)


# Frames ---------------------------------------------------------------------------------------------------------------


def _write_frame(page: _Page, box: Array, titles: Sequence[str]) -> None:
    corners = np.array([[box[k, axis] for axis, k in enumerate(which)] for which in product((0, 1), repeat=3)])
    places, _ = page.place_of(corners)
    if not np.isfinite(places).all():
        return  # the eye is in the box, or beside it
    middle = places.mean(axis=0)
    for axis, title in enumerate(titles):
        edge = _rim_edge(box, axis, places, page)
        if edge is not None:
            _write_axis(page, edge, axis, title, middle)


def _rim_edge(box: Array, axis: int, corners: Array, page: _Page) -> Array | None:
    """Ends of the box's edge along an axis that lies at the rim of what is seen of it, lowest or leftmost; or None."""
    best: tuple[float, Array] | None = None
    for ends in _edges_along(box, axis):
        (a, b), _ = page.place_of(ends)
        along = b - a
        length = float(np.hypot(*along))
        if length < MIN_EDGE * page.style.size:
            continue
        offsets = (corners - a) @ np.array([-along[1], along[0]]) / length
        is_at_rim = offsets.min() > -1e-6 * length or offsets.max() < 1e-6 * length
        if not is_at_rim:
            continue
        center = (a + b) / 2
        score = center[1] if abs(along[0]) >= abs(along[1]) else -center[0]
        if best is None or score > best[0]:
            best = float(score), ends
    return None if best is None else best[1]


def _edges_along(box: Array, axis: int) -> Iterator[Array]:
    others = [other for other in range(3) if other != axis]
    for which in product((0, 1), repeat=2):
        ends = np.empty((2, 3))
        ends[:, axis] = box[:, axis]
        ends[:, others] = [box[k, other] for k, other in zip(which, others, strict=True)]
        yield ends


def _write_axis(page: _Page, ends: Array, axis: int, title: str, middle: Array) -> None:
    """Ticks with their numbers along an edge, and the title beside them."""
    (a, b), _ = page.place_of(ends)
    along = (b - a) / np.hypot(*(b - a))
    out = np.array([-along[1], along[0]])
    out = out if out @ ((a + b) / 2 - middle) > 0 else -out
    font, small = page.style, 0.85 * page.style.size
    values = ticks_of(*ends[:, axis])
    places = np.repeat(ends[:1], len(values), axis=0)
    places[:, axis] = values
    points, _ = page.place_of(places)
    reach = 0.0
    for value, point in zip(values, points, strict=True):
        tip = point + TICK * font.size * out
        width = max(1.0, 0.08 * font.size)
        page.marks.append(stroke((point[0], point[1]), (tip[0], tip[1]), width, font.ink, font.halo))
        reach = max(reach, page.write(f"{value:g}", tip + GAP * small * out, out, small) or 0.0)
    off = (TICK + TITLE_GAP) * font.size + GAP * small + reach
    if abs(out[0]) < BESIDE:  # a slanted edge is nearer to one end of the title than to its middle
        off += abs(out[0]) * text_width(title, font.size, font.font) / 2
    # In the middle, else behind one of the ends.
    behind = 1.6 * font.size
    for place, towards in (((a + b) / 2 + off * out, out), (b + behind * along, along), (a - behind * along, -along)):
        if page.write(title, place, towards, font.size) is not None:
            break


# Names ----------------------------------------------------------------------------------------------------------------


def _write_names(page: _Page, points: Points) -> None:
    """Names beside points, the nearest first."""
    named = np.array([k for k, name in enumerate(points.labels) if name])
    places, depths = page.place_of(points.positions[named])
    radii = _radii_px(page, points, depths, named)
    is_seen = np.isfinite(places[:, 0])
    for k in [k for k in np.argsort(depths, kind="stable") if is_seen[k]][:MAX_NAMES]:
        off = radii[k] + GAP * page.style.size
        for side in (1.0, -1.0):
            towards = np.array([side, 0.0])
            if page.write(points.labels[named[k]], places[k] + off * towards, towards, page.style.size) is not None:
                break


def _radii_px(page: _Page, points: Points, depths: Array, named: NDArray[np.int64]) -> Array:
    """Radii of points in the picture, about."""
    if points.radius is None:
        sizes = np.broadcast_to(SIZE_PX if points.size is None else points.size, len(points.positions))
        return np.asarray(sizes[named] / 2, np.float64)
    camera, height = page.camera, page.size[1]
    half = camera.parallel_scale if camera.view_angle is None else depths * tan(radians(camera.view_angle) / 2)
    radii = np.broadcast_to(points.radius, len(points.positions))[named]
    return np.asarray(radii * height / (2 * np.asarray(half, np.float64)), np.float64)


def _meet(a: tuple[float, float, float, float], b: tuple[float, float, float, float]) -> bool:
    return a[0] < b[2] and b[0] < a[2] and a[1] < b[3] and b[1] < a[3]
