"""Fitting cameras: checks of the arguments; `crates/view` decides where the camera stands."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from itertools import product
from operator import index
from typing import TYPE_CHECKING, Any, Literal, NamedTuple, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from wavesplat import _native
from wavesplat._model.camera.views import Vector, check_magnitude
from wavesplat._model.volume import affine
from wavesplat._model.volume.grid import Grid
from wavesplat._system.values import described, number, positive
from wavesplat.errors import ArgumentError

if TYPE_CHECKING:
    from wavesplat._model.camera.camera import Camera


#: Ways to fit: "turn", in view from everywhere on a sphere around it, at one scale; "view", as near as one view allows.
Fit: TypeAlias = Literal["turn", "view"]

Vectors: TypeAlias = NDArray[np.float64]

#: Pixels of a side that integers of the machine hold.
MAX_SIDE = 2**31


#: See `crates/view`: sine and cosine of degrees, exact at quarter turns; right, up, and back (towards the eye) of a
#: camera on the orbit, as rows.
sin_cos_deg, orbit_axes = _native.sin_cos_deg, _native.orbit_axes


class Placed(NamedTuple):
    """Position, focal point, up and lens of a camera, as the compiled module takes and gives them."""

    position: Vector
    focal_point: Vector
    view_up: Vector
    parallel_scale: float | None
    view_angle: float | None


def corners_of(what: object) -> Vectors:
    """World positions of the eight corners of a volume's own box or, of a scene, of its box in the world.

    `what`: anything that has such a box as `bounds`, or that is taken as a volume.
    """
    if not isinstance(what, Grid):
        if _has_bounds(what):
            bounds: Any = what
            return np.array(list(product(*bounds.bounds.T)), np.float64)
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
    shown = None if points is None else _checked_points(points)
    return Placed(*_native.fit_view(axes, corners_of(what), shown, zoom, view_angle, aspect, fit == "turn"))


def cameras_in_view(
    turn: tuple[Vector, float, int],
    azimuth: float,
    elevation: float,
    what: object,
    *,
    zoom: float,
    view_angle: float | None,
    aspect: float,
    points: Vectors | None,
) -> list[Camera]:
    """Cameras of a turn (axis, degrees, frames), at a scale and a distance at which each of them shows everything."""
    check_lens(zoom, view_angle, aspect)
    given = (corners_of(what), points, zoom, view_angle, aspect)
    return cameras_at(_native.turn_in_view(turn, azimuth, elevation, *given))


def widened(camera: Camera, what: Grid | Vectors, *, zoom: float, aspect: float) -> Camera:
    """The camera, with a larger scale or moved back where it does not show a volume's corners, or points.

    `zoom`: magnification beyond that fit, which is kept.
    """
    shown = what if isinstance(what, np.ndarray) else corners_of(what)
    before = fields_of(camera)
    after = Placed(*_native.camera_widened(before, shown, zoom, aspect))
    return camera if after == before else camera_at(after)


def turned(camera: Camera, azimuth: float, elevation: float, roll: float) -> Camera:
    """See `Camera.turned`."""
    return camera_at(Placed(*_native.camera_turned(fields_of(camera), azimuth, elevation, roll)))


def zoomed(camera: Camera, factor: float) -> Camera:
    """See `Camera.zoomed`."""
    check_lens(factor, None, 1.0)
    return camera_at(Placed(*_native.camera_zoomed(fields_of(camera), factor)))


def in_perspective(camera: Camera) -> Camera:
    """A perspective camera that shows as much in the focal plane as an orthographic one, from where 30 degrees do."""
    return camera_at(Placed(*_native.camera_in_perspective(fields_of(camera))))


def all_around(camera: Camera) -> Camera:
    """The camera of a panorama from where a camera is."""
    return camera_at(Placed(*_native.camera_all_around(fields_of(camera))))


def within(camera: Camera, *, is_level: bool = True) -> Camera:
    """The camera moved to its focal point: the eye of a panorama from the middle of what the camera shows.

    It looks the same way or, level, along the horizon below or above that, with the world's z upright.
    """
    return camera_at(Placed(*_native.camera_within(fields_of(camera), is_level)))


def axes_of(camera: Camera) -> Vectors:
    """Rows: right, up, and back (towards the eye) of a camera, unit vectors in the world."""
    return _native.camera_axes(fields_of(camera))


def fields_of(camera: Camera) -> Placed:
    """Position, focal point, up and lens of a camera."""
    return Placed(camera.position, camera.focal_point, camera.view_up, camera.parallel_scale, camera.view_angle)


def camera_at(placed: Placed) -> Camera:
    """The camera with this position, focal point, up and lens."""
    from wavesplat._model.camera.camera import Camera

    return Camera(*placed[:3], parallel_scale=placed.parallel_scale, view_angle=placed.view_angle)


def cameras_at(fields: Iterable[tuple[Any, ...]]) -> list[Camera]:
    """The cameras with these positions, focal points, ups and lenses."""
    return [camera_at(Placed(*one)) for one in fields]


def projected(camera: Camera, points: ArrayLike, size: Sequence[int]) -> tuple[Vectors, Vectors]:
    """See `Camera.project`."""
    return _native.camera_project(fields_of(camera), _checked_points(points), _checked_size(size))


def unprojected(camera: Camera, pixels: ArrayLike, depths: ArrayLike, size: Sequence[int]) -> Vectors:
    """See `Camera.unproject`."""
    pixels_of_picture = _checked_size(size)
    try:
        places, along = np.array(pixels, np.float64), np.array(depths, np.float64)
    except (TypeError, ValueError, OverflowError):
        places, along = np.empty(0), np.empty(0)
    if places.ndim != 2 or places.shape[1] != 2 or along.shape not in ((), (len(places),)):
        raise ArgumentError(
            f"pixels has shape {places.shape} and depths {along.shape}; give columns and rows, shape (n, 2), and a "
            "depth for each, shape (n,), or one number for all"
        )
    return _native.camera_unproject(fields_of(camera), places, np.atleast_1d(along), pixels_of_picture)


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
    if not (1 <= width <= MAX_SIDE and 1 <= height <= MAX_SIDE):
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
