"""Fitting cameras: the distance and the scale at which a volume is just in view.

For one view, by the volume's corners projected into the picture; for a whole turn, by the sphere around them:
a sphere of radius r fills the view where half the height is r, and in perspective from r / sin(half the angle).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import product
from math import atan, cos, degrees, dist, radians, sin, tan
from operator import index
from typing import TYPE_CHECKING, Any, Literal, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from wavesplat._model.camera.views import Vector, check_magnitude, triple
from wavesplat._model.volume import affine
from wavesplat._model.volume.grid import Grid
from wavesplat._system.values import described, number, positive
from wavesplat.errors import ArgumentError

if TYPE_CHECKING:
    from wavesplat._model.camera.camera import Camera


#: Ways to fit: "turn", in view from everywhere on a sphere around it, at one scale; "view", as near as one view allows.
Fit: TypeAlias = Literal["turn", "view"]

Vectors: TypeAlias = NDArray[np.float64]


@dataclass(frozen=True)
class Placed:
    """Position, focal point and lens of a fitted camera."""

    position: Vector
    focal_point: Vector
    parallel_scale: float | None
    view_angle: float | None


def corners_of(what: object) -> Vectors:
    """World positions of the eight corners of a volume's own box or, of a scene, of its box in the world.

    `what`: anything that has such a box as `bounds`, or that is taken as a volume.
    """
    if not isinstance(what, Grid):
        if _has_bounds(what):
            bounds: Any = what
            return np.array(list(product(*bounds.bounds.T)))
        what = _volume(what)
    return affine.box_corners(what.world_from_index, what.shape)


def is_anatomical(what: object) -> bool:
    """Whether the axes of a volume, or of a scene's first volume, are a patient's."""
    if not isinstance(what, Grid) and not _has_bounds(what):
        what = _volume(what)
    return bool(getattr(what, "is_anatomical", False))


def placed(
    axes: Vectors,
    what: object,
    *,
    zoom: float,
    view_angle: float | None,
    aspect: float,
    points: ArrayLike | None,
    fit: Fit,
) -> Placed:
    """Fit a camera with the `axes` (right, up, back) so that the volume, or `points`, is in view."""
    check_lens(zoom, view_angle, aspect)
    given: object = fit
    if not isinstance(given, str) or given not in ("turn", "view"):
        raise ArgumentError(f'fit is {described(fit)}; it is "turn" or "view"')
    corners = corners_of(what)
    shown = corners if points is None else _checked_points(points)
    if points is None or fit == "turn":
        center = (shown.min(axis=0) + shown.max(axis=0)) / 2
    else:
        # The middle of what is seen from there.
        seen = shown @ axes.T
        center = (seen.min(axis=0) + seen.max(axis=0)) / 2 @ axes
    parallel_scale = narrowed_angle = None
    if fit == "turn":
        radius = float(np.linalg.norm(shown - center, axis=1).max())
        if view_angle is None:
            distance = 2 * float(np.linalg.norm(corners - center, axis=1).max())  # clear of the box
            parallel_scale = radius * max(1.0, 1 / aspect) / zoom
        else:
            slope = tan(radians(view_angle) / 2)
            distance = radius / sin(atan(slope * min(1.0, aspect)))
    else:
        in_view = (shown - center) @ axes.T
        if view_angle is None:
            distance = float(np.ptp((corners - center) @ axes[2]))  # clear of the box, so that depths are positive
            half_height = np.maximum(np.abs(in_view[:, 1]), np.abs(in_view[:, 0]) / aspect).max()
            parallel_scale = float(half_height) / zoom
        else:
            distance = _distance_that_fits(in_view, view_angle, aspect)
    if view_angle is not None:
        narrowed_angle = narrowed(view_angle, zoom)
    return Placed(
        position=triple(center + distance * axes[2]),
        focal_point=triple(center),
        parallel_scale=parallel_scale,
        view_angle=narrowed_angle,
    )


def placed_for_all(
    views: Sequence[Vectors],
    what: object,
    *,
    zoom: float,
    view_angle: float | None,
    aspect: float,
    points: ArrayLike | None,
) -> Placed:
    """Fit a camera to the first of several views, at a scale and a distance at which each of them shows everything.

    All look at the centre of the bounding box of the corners, or of `points`.
    """
    check_lens(zoom, view_angle, aspect)
    corners = corners_of(what)
    shown = corners if points is None else _checked_points(points)
    center = (shown.min(axis=0) + shown.max(axis=0)) / 2
    from_center = shown - center
    parallel_scale = narrowed_angle = None
    if view_angle is None:
        distance = 2 * float(np.linalg.norm(corners - center, axis=1).max())
        halves = [np.abs(from_center @ (axes[:2] / [[aspect], [1.0]]).T).max() for axes in views]
        parallel_scale = float(max(halves)) / zoom
    else:
        distance = max(_distance_that_fits(from_center @ axes.T, view_angle, aspect) for axes in views)
        narrowed_angle = narrowed(view_angle, zoom)
    return Placed(
        position=triple(center + distance * views[0][2]),
        focal_point=triple(center),
        parallel_scale=parallel_scale,
        view_angle=narrowed_angle,
    )


def widened(camera: Camera, what: Grid | Vectors, *, zoom: float, aspect: float) -> Camera:
    """The camera, with a larger scale or moved back where it does not show a volume's corners, or points.

    `zoom`: magnification beyond that fit, which is kept.
    """
    shown = what if isinstance(what, np.ndarray) else corners_of(what)
    axes = axes_of(camera)
    in_view = (shown - camera.focal_point) @ axes.T
    if camera.view_angle is None:
        needed = float(np.maximum(np.abs(in_view[:, 1]), np.abs(in_view[:, 0]) / aspect).max()) / zoom
        return camera if needed <= (camera.parallel_scale or 0.0) else replace(camera, parallel_scale=needed)
    distance = _distance_that_fits(in_view, narrowed(camera.view_angle, 1 / zoom), aspect)
    if distance <= dist(camera.position, camera.focal_point):
        return camera
    return replace(camera, position=triple(camera.focal_point + distance * axes[2]))


def about(axis: Sequence[float], angle: float) -> Vectors:
    """Rotation matrix about an axis, degrees, anticlockwise seen from its tip (Rodrigues); exact at quarter turns."""
    s, c = sin_cos_deg(angle)
    unit = np.divide(axis, np.linalg.norm(axis))
    x, y, z = unit.tolist()
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    return np.asarray(c * np.eye(3) + s * cross + (1 - c) * np.outer(unit, unit)) + 0.0


def narrowed(view_angle: float, zoom: float) -> float:
    """The angle of view, degrees, in which things look `zoom` times as large."""
    return degrees(2 * atan(tan(radians(view_angle) / 2) / zoom))


def axes_of(camera: Camera) -> Vectors:
    """Rows: right, up, and back (towards the eye) of a camera, unit vectors in the world."""
    back = np.subtract(camera.position, camera.focal_point)
    back /= np.linalg.norm(back)
    right = np.cross(camera.view_up, back)
    right /= np.linalg.norm(right)
    return np.array([right, np.cross(back, right), back])


def projected(camera: Camera, points: ArrayLike, size: Sequence[int]) -> tuple[Vectors, Vectors]:
    """See `Camera.project`. The inverse of `ray` of `crates/core/src/camera.rs`, whose pixel centres are at halves."""
    seen = _checked_points(points) - camera.position
    width, height = _checked_size(size)
    right, up, back = axes_of(camera)
    forward = -(seen @ back)
    if camera.view_angle is None:
        half_heights: Vectors | float = camera.parallel_scale or 0.0
        depths = forward
    else:
        half_heights = np.where(forward > 0, forward, np.nan) * tan(radians(camera.view_angle) / 2)
        depths = np.where(forward > 0, np.linalg.norm(seen, axis=1), np.nan)
    columns = (width + height * (seen @ right) / half_heights) / 2 - 0.5
    rows = height * (1 - (seen @ up) / half_heights) / 2 - 0.5
    return np.stack([columns, rows], axis=1), depths


def unprojected(camera: Camera, pixels: ArrayLike, depths: ArrayLike, size: Sequence[int]) -> Vectors:
    """See `Camera.unproject`."""
    width, height = _checked_size(size)
    try:
        places, along = np.array(pixels, np.float64), np.array(depths, np.float64)
    except (TypeError, ValueError, OverflowError):
        places, along = np.empty(0), np.empty(0)
    if places.ndim != 2 or places.shape[1] != 2 or along.shape not in ((), (len(places),)):
        raise ArgumentError(
            f"pixels has shape {places.shape} and depths {along.shape}; give columns and rows, shape (n, 2), and a "
            "depth for each, shape (n,), or one number for all"
        )
    right, up, back = axes_of(camera)
    # Distances from the middle of the picture, in half its heights.
    across = (2 * (places[:, :1] + 0.5) - width) / height
    upwards = 1 - 2 * (places[:, 1:] + 0.5) / height
    along = np.broadcast_to(along, len(places))[:, None]
    if camera.view_angle is None:
        half = camera.parallel_scale or 0.0
        return np.asarray(camera.position + half * (across * right + upwards * up) - along * back)
    slope = tan(radians(camera.view_angle) / 2)
    rays = slope * (across * right + upwards * up) - back
    return np.asarray(camera.position + along * rays / np.linalg.norm(rays, axis=1, keepdims=True))


def orbit_axes(azimuth: float, elevation: float) -> Vectors:
    """Rows: right, up, and back (towards the eye) of a camera on the orbit, in the world."""
    sin_a, cos_a = sin_cos_deg(azimuth)
    sin_e, cos_e = sin_cos_deg(elevation)
    back = (-sin_a * cos_e, cos_a * cos_e, sin_e)
    up = (sin_a * sin_e, -cos_a * sin_e, cos_e)  # the derivative of `back` by the elevation
    # Adding 0.0 turns -0.0 into 0.0, which prints better.
    return np.array([np.cross(up, back), up, back]) + 0.0


def sin_cos_deg(angle: float) -> tuple[float, float]:
    """Sine and cosine of degrees, exact at quarter turns, so that the named views look straight along an axis."""
    quarters, rest = divmod(angle, 90.0)
    s, c = sin(radians(rest)), cos(radians(rest))
    return ((s, c), (c, -s), (-s, -c), (-c, s))[int(quarters) % 4]


def check_angles(**angles: float) -> None:
    """Refuse angles that are not finite."""
    for name, angle in angles.items():
        number(angle, name, "a finite number of degrees")


def check_lens(zoom: float, view_angle: float | None, aspect: float) -> None:
    """Refuse an impossible magnification, angle of view or aspect ratio."""
    for name, ratio in (("zoom", zoom), ("aspect", aspect)):
        positive(ratio, name, "a positive finite number, 1 is neutral")
        check_magnitude(ratio, name)
    if view_angle is not None and not 0 < view_angle < 180:
        raise ArgumentError(f"view_angle is {view_angle}; give degrees between 0 and 180, 30 is usual")


def _has_bounds(what: object) -> bool:
    bounds = getattr(what, "bounds", None)
    return isinstance(bounds, np.ndarray) and bounds.shape == (2, 3) and bool(np.isfinite(bounds).all())


def _volume(what: object) -> Grid:
    # Not above: volumes know crops and cameras.
    from wavesplat._model.volume.volume_like import as_volume

    return as_volume(what)


def _checked_size(size: Sequence[int]) -> tuple[int, int]:
    try:
        width, height = (index(side) for side in size)
    except (TypeError, ValueError):
        width, height = 0, 0
    if width < 1 or height < 1:
        raise ArgumentError(f"size is {described(size)}; give (width, height), two whole numbers of pixels from 1")
    return width, height


def _checked_points(points: ArrayLike) -> Vectors:
    try:
        shown = np.array(points, dtype=np.float64)
    except (TypeError, ValueError, OverflowError):
        shown = np.empty(0)
    if shown.ndim != 2 or shown.shape[1] != 3 or not len(shown) or not np.isfinite(shown).all():
        raise ArgumentError(f"points is {described(points)}; give finite world positions, shape (n, 3), at least one")
    return shown


def _distance_that_fits(in_view: Vectors, view_angle: float, aspect: float) -> float:
    """Smallest distance of the eye from the middle at which every corner is inside the view.

    A corner (u, v, w) is seen from distance d at v / (d - w), which must not exceed the tangent of half the angle.
    """
    slope = tan(radians(view_angle) / 2)
    u, v, w = in_view.T
    return float((w + np.maximum(np.abs(v), np.abs(u) / aspect) / slope).max())
