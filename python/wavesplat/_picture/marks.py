"""Marks that are drawn on a picture: a list of few kinds, which every kind of file can hold, and their style.

    canvas (width, height, background) = a rendering at a place + marks over it

`raster`, `svg` and `pdf` draw the same list: pixels, or vectors and text.
Lengths are pixels of the canvas, from its upper left corner, y down; colours are 0..1, as they are shown.
A halo is a rim of a contrasting colour, with which a mark is seen on any picture; all halos lie below all marks.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from math import hypot
from typing import Literal, TypeAlias

import numpy as np
from numpy.typing import NDArray

# The style of marks: size, colours, typeface.

BLACK: Color = (0.0, 0.0, 0.0)
WHITE: Color = (1.0, 1.0, 1.0)
#: Width of a halo, in sizes of the font.
HALO = 0.09


@dataclass(frozen=True)
class Style:
    """Size of the font in pixels, colour of what is written, its halo, and the file of the typeface."""

    size: float
    ink: Color
    halo: Halo | None = None
    font: str | None = None

    def on_picture(self) -> Style:
        """The style with a halo, to be seen on anything."""
        return replace(self, halo=(contrast(self.ink), max(1.0, HALO * self.size)))


def luminance(color: Color) -> float:
    """Luminance (Rec. 709) of a colour as it is shown."""
    return 0.2126 * color[0] + 0.7152 * color[1] + 0.0722 * color[2]


def contrast(color: Color) -> Color:
    """Black or white, whichever contrasts with a colour."""
    return BLACK if luminance(color) > 0.45 else WHITE


# Marks that are drawn on a picture: a list of few kinds, which every kind of file can hold.

Color: TypeAlias = tuple[float, float, float]
Point: TypeAlias = tuple[float, float]
#: A halo: its colour, and how far it reaches beyond the mark.
Halo: TypeAlias = tuple[Color, float]
#: Slants of horizontal text, and of text that runs upwards.
UPRIGHT, UPWARDS = (1.0, 0.0, 0.0, 1.0), (0.0, -1.0, 1.0, 0.0)


@dataclass(frozen=True)
class Rectangle:
    """A filled rectangle; in pixels, its edges are moved to the nearest ones."""

    x: float
    y: float
    width: float
    height: float
    fill: Color
    halo: Halo | None = None


@dataclass(frozen=True)
class Polygon:
    """A filled polygon, convex."""

    points: tuple[Point, ...]
    fill: Color
    halo: Halo | None = None


@dataclass(frozen=True)
class Text:
    """A line of text; `x` is where it begins, its middle or its end, `y` its baseline.

    slant : which way its right and its down point, x and y of each; upright if not given.
    """

    x: float
    y: float
    text: str
    size: float
    fill: Color
    anchor: Literal["start", "middle", "end"] = "start"
    halo: Halo | None = None
    slant: tuple[float, float, float, float] = UPRIGHT


@dataclass(frozen=True)
class Ramp:
    """A rectangle whose colour changes from its lower to its upper edge, evenly from stop to stop.

    stops : (place, colour), places 0..1 in order from below; two at one place make a step.
    """

    x: float
    y: float
    width: float
    height: float
    stops: tuple[tuple[float, Color], ...]


Mark: TypeAlias = Rectangle | Polygon | Text | Ramp


@dataclass(frozen=True)
class Block:
    """Marks that belong together, in a box whose upper left corner is the origin."""

    marks: tuple[Mark, ...]
    width: float
    height: float


@dataclass(frozen=True)
class Canvas:
    """A picture with all that is drawn on and beside it.

    rgba : the rendering, associated; `place`: of its upper left corner.
    background : of the canvas where the rendering is not, red, green, blue and opacity; None is transparent.
    font : file of the typeface; None is ours.
    """

    width: int
    height: int
    rgba: NDArray[np.float32]
    place: tuple[int, int] = (0, 0)
    background: tuple[float, float, float, float] | None = None
    marks: tuple[Mark, ...] = ()
    font: str | None = None
    dpi: float | None = None
    title: str = ""


def moved(marks: Iterable[Mark], dx: float, dy: float) -> tuple[Mark, ...]:
    """The marks at another place."""
    return tuple(
        replace(mark, points=tuple((x + dx, y + dy) for x, y in mark.points))
        if isinstance(mark, Polygon)
        else replace(mark, x=mark.x + dx, y=mark.y + dy)
        for mark in marks
    )


def stroke(start: Point, end: Point, width: float, fill: Color, halo: Halo | None = None) -> Polygon:
    """A straight line, as a polygon."""
    dx, dy = end[0] - start[0], end[1] - start[1]
    length = hypot(dx, dy) or 1.0
    nx, ny = -dy / length * width / 2, dx / length * width / 2
    corners = ((start, 1), (end, 1), (end, -1), (start, -1))
    return Polygon(tuple((x + side * nx, y + side * ny) for (x, y), side in corners), fill, halo)


def disc(center: Point, radius: float, fill: Color, halo: Halo | None = None) -> Polygon:
    """A circle, as a polygon with corners too small to see."""
    angles = np.linspace(0, 2 * np.pi, 25)[:-1]
    around: Sequence[tuple[float, float]] = np.stack([np.cos(angles), np.sin(angles)], axis=1).tolist()
    return Polygon(tuple((center[0] + radius * x, center[1] + radius * y) for x, y in around), fill, halo)
