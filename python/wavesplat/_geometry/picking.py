"""The shape that a ray meets first: its number, where, which of its parts, and the value there.

Positions are turned so that the ray runs along z. Then it meets a ball, or a line of some thickness, where the origin
of the plane (x, y) lies near enough to a point or a segment, and a triangle where the origin lies in it. The signs of
three areas decide that: neighbouring triangles compute the area at their common edge from the same two corners, so no
ray passes between them (Woop, Benthin and Wald 2013, *Watertight Ray/Triangle Intersection*).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from math import inf
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from wavesplat._geometry.frame import Frame
from wavesplat._geometry.lines import WIDTH_PX, Lines
from wavesplat._geometry.points import SIZE_PX, Points
from wavesplat._geometry.shape import Shape
from wavesplat._geometry.slice_plane import SlicePlane
from wavesplat._geometry.surface import Surface

Array: TypeAlias = NDArray[np.float64]

#: Opacity from which on a shape is taken for what lies behind it: the half at which pictures record depth.
OPAQUE = 0.5
#: Distance within which thin lines and small points are met, pixels: no hand is steadier.
SLACK_PX = 2.0


@dataclass(frozen=True, eq=False)
class Ray:
    """A ray of a pixel.

    origin, direction : world units, the direction of length 1. nearest : depth where it begins, -inf for none.
    pixel : sizes of a pixel in world units at depths along the ray.
    """

    origin: Array
    direction: Array
    nearest: float
    pixel: Callable[[Array], Array]

    def turned(self, positions: Array) -> Array:
        """World positions, shape (n, 3), on axes from the origin of the ray, which runs along z: shape (3, n).

        Sums of columns: on two cores a product of a million positions and a matrix took 0.6 s, and these 0.02 s.
        """
        aside = np.eye(3)[np.abs(self.direction).argmin()]
        across = np.cross(self.direction, aside)
        across /= np.linalg.norm(across)
        axes = np.stack([across, np.cross(self.direction, across), self.direction])
        dx, dy, dz = (positions[:, k] - self.origin[k] for k in range(3))
        return np.stack([dx * axis[0] + dy * axis[1] + dz * axis[2] for axis in axes])


@dataclass(frozen=True)
class Picked:
    """The shape that a ray meets first.

    number : of the shape. depth : world units along the ray. part : number of the point, path or triangle, from 0; None
    of a slice or a frame. value : of the shape's values there, or None.
    """

    number: int
    depth: float
    part: int | None
    value: float | None


@dataclass(frozen=True, eq=False)
class _Met:
    """Places where a ray meets the parts of a shape: arrays of shape (n,), values None where it has none."""

    depths: Array
    parts: NDArray[np.int64]
    opacities: Array
    values: Array | None = None

    def only(self, kept: NDArray[np.bool_]) -> _Met:
        values = None if self.values is None else self.values[kept]
        return _Met(self.depths[kept], self.parts[kept], self.opacities[kept], values)

    def on_both_sides(self, half: Array) -> _Met:
        """The places where a ray enters and leaves solids, from places in their middles and half of the way through.

        An eye in a solid sees its far side, and so does one before a clip that takes the near side away.
        """
        values = None if self.values is None else np.tile(self.values, 2)
        depths = np.concatenate([self.depths - half, self.depths + half])
        return _Met(depths, np.tile(self.parts, 2), np.tile(self.opacities, 2), values)


def picked(
    ray: Ray,
    shapes: Sequence[Shape],
    *,
    is_kept: Callable[[Array], NDArray[np.bool_]],
    cards_of: Callable[[SlicePlane], Sequence[Any]],
    bounds: Array,
    farthest: float = inf,
) -> Picked | None:
    """The nearest shape of at least half opacity that a ray meets, else the nearest translucent one; None without any.

    is_kept : whether the scene's clips keep world points, shape (n, 3). cards_of : makes the pictures of a slice.
    bounds : the box of frames without one. farthest : depth behind which nothing is seen.
    """
    found: list[tuple[bool, float, Picked]] = []
    for number, shape in enumerate(shapes):
        if not shape._is_seen:
            continue
        met = _met(ray, shape, cards_of, bounds)
        kept = (met.depths > ray.nearest) & (met.depths <= farthest) & (met.opacities > 0)
        if met.values is not None:
            kept &= np.isfinite(met.values)  # holes
        if getattr(shape, "clipped", False):
            kept &= is_kept(ray.origin + met.depths[:, None] * ray.direction)
        met = met.only(kept)
        for is_opaque in (True, False):
            alike = met.only((met.opacities >= OPAQUE) == is_opaque)
            if len(alike.depths):
                found.append((not is_opaque, *_nearest(number, shape, alike)))
    return min(found, key=lambda one: one[:2])[2] if found else None


def _nearest(number: int, shape: Shape, met: _Met) -> tuple[float, Picked]:
    k = int(met.depths.argmin())
    depth = float(met.depths[k])
    part = int(met.parts[k]) if isinstance(shape, Surface | Lines | Points) else None
    return depth, Picked(number, depth, part, None if met.values is None else float(met.values[k]))


def _met(ray: Ray, shape: Shape, cards_of: Callable[[SlicePlane], Sequence[Any]], bounds: Array) -> _Met:
    if isinstance(shape, Surface):
        return _met_surface(ray, shape)
    if isinstance(shape, Lines):
        lines = shape.paths
        numbers = lines.numbers
        is_step = numbers[1:] == numbers[:-1]
        size = (shape.radius, None) if shape.radius is not None else (None, shape.width or WIDTH_PX)
        look = _alphas(shape, len(numbers)), shape.values
        return _met_steps(ray, lines.positions, (is_step, numbers), size, look)
    if isinstance(shape, Points):
        return _met_points(ray, shape)
    if isinstance(shape, SlicePlane):
        return _met_cards(ray, cards_of(shape))
    assert isinstance(shape, Frame)
    ends = shape._arrays(bounds, (True, True, True))[0]["positions"]  # its edges
    numbers = np.repeat(np.arange(len(ends) // 2), 2)
    is_step = numbers[1:] == numbers[:-1]
    return _met_steps(ray, ends, (is_step, numbers), (None, shape.width), (np.full(len(ends), shape.opacity), None))


def _alphas(shape: Any, n: int) -> Array:
    """Opacity at each of `n` vertices, positions or points."""
    alphas: Any = 1.0
    if shape.color is not None and not isinstance(shape.color, str):
        color = np.asarray(shape.color)
        alphas = color[..., 3] if color.shape[-1] == 4 else 1.0
    return np.broadcast_to(np.asarray(shape.opacity * alphas, np.float64), n)


def _met_points(ray: Ray, points: Points) -> _Met:
    x, y, depths = ray.turned(points.positions)
    away = np.hypot(x, y)
    pixels = ray.pixel(depths)
    if points.radius is None:
        radii = np.broadcast_to(np.asarray(SIZE_PX if points.size is None else points.size) / 2 * pixels, len(away))
    else:
        radii = np.broadcast_to(np.asarray(points.radius, np.float64), len(away))
    near = np.flatnonzero(away <= np.maximum(radii, SLACK_PX * pixels))
    values = None if points.values is None else points.values[near]
    met = _Met(depths[near], near, _alphas(points, len(away))[near], values)
    if points.radius is None:
        return met
    return met.on_both_sides(np.sqrt(np.maximum(radii[near] ** 2 - away[near] ** 2, 0)))


def _met_steps(
    ray: Ray,
    positions: Array,
    steps: tuple[NDArray[np.bool_], NDArray[np.int64]],
    size: tuple[float | None, float | None],
    look: tuple[Array, Array | None],
) -> _Met:
    """Places where a ray meets the segments between neighbouring positions.

    steps : which neighbours have a segment between them, and the number of the path of each position.
    size : radius in world units, or width in pixels. look : opacity of each position, and its value.
    """
    is_step, numbers = steps
    (radius, width), (alphas, values) = size, look
    turned = ray.turned(positions)
    reach = max(SLACK_PX, (width or 0) / 2) * float(ray.pixel(np.abs(turned[2]).max()))
    sides = _sides(turned[0], turned[1], max(radius or 0.0, reach))
    first = np.flatnonzero(is_step & ((sides[1:] & sides[:-1]) == 0))
    start = turned[:, first]
    along = turned[:, first + 1] - start
    squares = along[0] ** 2 + along[1] ** 2
    dots = start[0] * along[0] + start[1] * along[1]
    # The share of the segment where it is nearest to the ray; one along the ray is met at its nearer end.
    shares = np.where(squares > 0, np.clip(-dots / np.where(squares > 0, squares, 1), 0, 1), along[2] < 0)
    x, y, depths = start + shares * along
    away, pixels = np.hypot(x, y), ray.pixel(depths)
    radii = np.full(len(away), radius, np.float64) if radius is not None else width / 2 * pixels  # type: ignore[operator]
    near = np.flatnonzero(away <= np.maximum(radii, SLACK_PX * pixels))
    share, first = shares[near], first[near]
    between = None if values is None else _mixed(values, first, share)
    met = _Met(depths[near], numbers[first], _mixed(alphas, first, share), between)
    if radius is None:
        return met
    # The way through a tube is the longer, the more it runs along the ray; its rounded ends are met as balls are.
    lengths = np.linalg.norm(along[:, near], axis=0)
    sines = np.sqrt(squares[near]) / np.where(lengths > 0, lengths, 1)
    is_end = (share <= 0) | (share >= 1)
    half = np.sqrt(np.maximum(radii[near] ** 2 - away[near] ** 2, 0))
    return met.on_both_sides(half / np.where(is_end | (sines == 0), 1, sines))


def _sides(x: Array, y: Array, reach: float) -> NDArray[np.uint8]:
    """A bit for each side of the ray on which a position lies farther from it than `reach`.

    A part all of whose positions have a bit in common misses the ray, as most do.
    """
    tests = (x > reach, x < -reach, y > reach, y < -reach)
    sides = np.zeros(len(x), np.uint8)
    for k, test in enumerate(tests):
        sides |= test.astype(np.uint8) << np.uint8(k)
    return sides


def _mixed(values: Array, first: NDArray[np.int64], share: Array) -> Array:
    mixed: Array = values[first] * (1 - share) + values[first + 1] * share
    return mixed


def _met_surface(ray: Ray, surface: Surface) -> _Met:
    x, y, z = ray.turned(surface.vertices)
    faces = surface.faces
    sides = _sides(x, y, 0.0)
    candidates = np.flatnonzero((sides[faces[:, 0]] & sides[faces[:, 1]] & sides[faces[:, 2]]) == 0)
    corners = faces[candidates].astype(np.int64)
    # Twice the areas of the triangles that each edge makes with the origin: weights of the corners opposite to them.
    areas = np.stack(
        [x[corners[:, a]] * y[corners[:, b]] - x[corners[:, b]] * y[corners[:, a]] for a, b in ((1, 2), (2, 0), (0, 1))]
    )
    whole = areas.sum(axis=0)
    is_met = ((areas >= 0).all(axis=0) | (areas <= 0).all(axis=0)) & (whole != 0)
    corners, weights = corners[is_met], (areas[:, is_met] / whole[is_met]).T

    def inside(numbers: Array) -> Array:
        mixed: Array = (weights * numbers[corners]).sum(axis=1)
        return mixed

    values = None if surface.values is None else inside(surface.values)
    return _Met(inside(z), candidates[is_met], inside(_alphas(surface, len(x))), values)


def _met_cards(ray: Ray, cards: Sequence[Any]) -> _Met:
    mets = [_Met(np.empty(0), np.empty(0, np.int64), np.empty(0)), *(_met_card(ray, card) for card in cards)]
    depths = np.concatenate([met.depths for met in mets])
    return _Met(depths, np.zeros(len(depths), np.int64), np.concatenate([met.opacities for met in mets]))


def _met_card(ray: Ray, card: Any) -> _Met:
    """The place where a ray meets the picture on a parallelogram; the value there is not known here."""
    corner, along_x, along_y = (np.asarray(card[name]) for name in ("corner", "along_x", "along_y"))
    matrix = np.stack([along_x, along_y, -ray.direction], axis=1)
    if abs(np.linalg.det(matrix)) <= 1e-12 * np.linalg.norm(np.cross(along_x, along_y)):
        return _Met(np.empty(0), np.empty(0, np.int64), np.empty(0))  # it is seen from its edge
    across, down, depth = np.linalg.solve(matrix, ray.origin - corner)
    height, width = card["rgba"].shape[:2]
    column, row = int(np.floor(across * width)), int(np.floor(down * height))
    is_on = 0 <= column < width and 0 <= row < height
    alpha = float(card["rgba"][row, column, 3]) if is_on else 0.0
    if card["rgba"].dtype == np.uint8:
        alpha /= 255
    return _Met(np.array([depth]), np.zeros(1, np.int64), np.array([alpha * card["style"][0]]))
