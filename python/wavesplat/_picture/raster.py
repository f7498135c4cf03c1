"""A canvas as pixels: text by FreeType, through Pillow; slanted edges are smooth."""

from __future__ import annotations

from math import ceil, floor
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wavesplat._picture import lettering
from wavesplat._picture.marks import UPRIGHT, Canvas, Color, Polygon, Ramp, Rectangle, Text

#: Rows per pixel for edges, and scale at which slanted text is drawn before it is turned.
FINER = 4
#: Number of corners that stand for a round one.
RIM_CORNERS = 16

Rgba = NDArray[np.float32]


def drawn(canvas: Canvas) -> Rgba:
    """The canvas as pixels, associated floats."""
    red, green, blue, alpha = canvas.background or (0.0, 0.0, 0.0, 0.0)
    pixels = np.empty((canvas.height, canvas.width, 4), np.float32)
    pixels[:] = (red * alpha, green * alpha, blue * alpha, alpha)
    height, width = canvas.rgba.shape[:2]
    left, top = canvas.place
    pixels[top : top + height, left : left + width] = canvas.rgba
    for mark in canvas.marks:
        if not isinstance(mark, Ramp) and mark.halo is not None:
            _draw(pixels, mark, canvas.font, mark.halo[0], mark.halo[1])
    for mark in canvas.marks:
        if isinstance(mark, Ramp):
            _draw_ramp(pixels, mark)
        else:
            _draw(pixels, mark, canvas.font, mark.fill, 0.0)
    return pixels


def _draw(pixels: Rgba, mark: Rectangle | Polygon | Text, font: str | None, color: Color, rim: float) -> None:
    """Draw one mark, or its halo, which reaches a rim beyond it."""
    if isinstance(mark, Rectangle):
        x0, y0, x1, y1 = _edges(mark)
        n = round(rim)
        _lay(pixels, np.ones((y1 - y0 + 2 * n, x1 - x0 + 2 * n), np.float32), (x0 - n, y0 - n), color)
    elif isinstance(mark, Polygon):
        _lay(pixels, *_polygon(mark, rim), color)
    elif mark.text.strip():
        _lay(pixels, *_text(mark, font, rim), color)


def _edges(mark: Rectangle | Ramp) -> tuple[int, int, int, int]:
    x0, y0 = round(mark.x), round(mark.y)
    return x0, y0, max(x0 + 1, round(mark.x + mark.width)), max(y0 + 1, round(mark.y + mark.height))


def _polygon(mark: Polygon, rim: float) -> tuple[NDArray[np.float32], tuple[int, int]]:
    """Coverage of a polygon, and its place: exact along x, in rows that are finer than the pixels'."""
    corners = _outline(mark.points, rim)
    left, top = (floor(least) for least in corners.min(axis=0))
    right, bottom = (ceil(most) for most in corners.max(axis=0))
    rows = top + (np.arange((bottom - top) * FINER) + 0.5) / FINER
    begin, end = np.full(rows.shape, np.inf), np.full(rows.shape, -np.inf)
    for (x0, y0), (x1, y1) in zip(corners, np.roll(corners, -1, axis=0), strict=True):
        if y0 == y1:
            continue
        met = (rows >= min(y0, y1)) & (rows < max(y0, y1))
        x = x0 + (rows[met] - y0) / (y1 - y0) * (x1 - x0)
        begin[met], end[met] = np.minimum(begin[met], x), np.maximum(end[met], x)
    edges = left + np.arange(right - left + 1)
    covered = np.clip(edges[None, :], begin[:, None], np.maximum(begin, end)[:, None])
    covered[~np.isfinite(begin)] = 0
    shares = np.diff(covered, axis=1).reshape(bottom - top, FINER, right - left).mean(axis=1)
    return shares.astype(np.float32), (left, top)


def _outline(points: tuple[tuple[float, float], ...], rim: float) -> NDArray[np.float64]:
    """Corners of a convex polygon with a round rim around it."""
    if not rim:
        return np.array(points)
    angles = np.linspace(0, 2 * np.pi, RIM_CORNERS, endpoint=False)
    around = rim * np.stack([np.cos(angles), np.sin(angles)], axis=1)
    cloud: list[tuple[float, float]] = sorted({(x, y) for point in points for x, y in (around + point).tolist()})
    return np.array([*_chain(cloud), *_chain(cloud[::-1])])


def _chain(cloud: list[tuple[float, float]]) -> list[tuple[float, float]]:
    """One half of the convex hull of sorted points, without its last one (Andrew 1979)."""
    hull: list[tuple[float, float]] = []
    for x, y in cloud:
        while len(hull) >= 2:
            (x0, y0), (x1, y1) = hull[-2:]
            if (x1 - x0) * (y - y0) - (y1 - y0) * (x - x0) > 0:
                break
            hull.pop()
        hull.append((x, y))
    return hull[:-1]


def _text(mark: Text, font: str | None, rim: float) -> tuple[NDArray[np.float32], tuple[int, int]]:
    from PIL import Image, ImageDraw

    if mark.slant != UPRIGHT:
        return _slanted(mark, font, rim)
    typeface = lettering.opened(font, mark.size)
    anchor = {"start": "ls", "middle": "ms", "end": "rs"}[mark.anchor]
    x0, y0, x1, y1 = typeface.getbbox(mark.text, anchor=anchor)
    left, top = (floor(place + least - rim - 2) for place, least in ((mark.x, x0), (mark.y, y0)))
    right, bottom = (ceil(place + most + rim + 2) for place, most in ((mark.x, x1), (mark.y, y1)))
    mask = Image.new("L", (right - left, bottom - top))
    how: dict[str, Any] = {"fill": 255, "font": typeface, "anchor": anchor, "stroke_width": rim}
    ImageDraw.Draw(mask).text((mark.x - left, mark.y - top), mark.text, **how)
    return np.asarray(mask, np.float32) / np.float32(255), (left, top)


def _slanted(mark: Text, font: str | None, rim: float) -> tuple[NDArray[np.float32], tuple[int, int]]:
    """Coverage of slanted text, and its place: drawn upright, four times as large, then turned."""
    from PIL import Image

    upright = Text(0, 0, mark.text, FINER * mark.size, mark.fill, mark.anchor)
    shares, (x0, y0) = _text(upright, font, FINER * rim)
    height, width = shares.shape
    # From the fine text to the picture, about the mark's place.
    turn = np.array(mark.slant).reshape(2, 2).T / FINER
    corners = turn @ np.array([(x, y) for x in (x0, x0 + width) for y in (y0, y0 + height)], float).T
    place = np.array([mark.x, mark.y])
    (left, top), (right, bottom) = (
        np.floor(corners.min(axis=1) + place).astype(int) - 1,
        np.ceil(corners.max(axis=1) + place).astype(int) + 1,
    )
    back = np.linalg.inv(turn)
    start = back @ (np.array([left, top]) - place) - (x0, y0)
    step = back / FINER
    # Pillow wants the map from corners of target pixels to the source.
    (a, b), (c, d) = step.tolist()
    size = (FINER * int(right - left), FINER * int(bottom - top))
    fine = Image.fromarray(np.round(255 * shares).astype(np.uint8)).transform(
        size, Image.Transform.AFFINE, (a, b, float(start[0]), c, d, float(start[1])), Image.Resampling.BILINEAR
    )
    shares = np.asarray(fine, np.float32).reshape(size[1] // FINER, FINER, size[0] // FINER, FINER).mean(axis=(1, 3))
    return shares / np.float32(255), (int(left), int(top))


def _draw_ramp(pixels: Rgba, mark: Ramp) -> None:
    x0, y0, x1, y1 = _edges(mark)
    places = np.array([place for place, _ in mark.stops])
    colors = np.array([color for _, color in mark.stops])
    rows = 1 - (np.arange(y1 - y0) + 0.5) / (y1 - y0)
    for row, place in enumerate(rows):
        color = tuple(float(np.interp(place, places, channel)) for channel in colors.T)
        _lay(pixels, np.ones((1, x1 - x0), np.float32), (x0, y0 + row), (color[0], color[1], color[2]))


def _lay(pixels: Rgba, shares: NDArray[np.float32], place: tuple[int, int], color: Color) -> None:
    """Lay a colour over the pixels by their coverage; what lies beyond the edges is left out."""
    (left, top), (height, width) = place, shares.shape
    x0, y0 = max(left, 0), max(top, 0)
    x1, y1 = min(left + width, pixels.shape[1]), min(top + height, pixels.shape[0])
    if x0 >= x1 or y0 >= y1:
        return
    share = shares[y0 - top : y1 - top, x0 - left : x1 - left, None]
    below = pixels[y0:y1, x0:x1]
    pixels[y0:y1, x0:x1] = below * (1 - share) + share * np.array((*color, 1), np.float32)
