"""Where a picture is taken from: the same triple, and the same names, that VTK and PyVista use."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field
from functools import partial
from math import atan, cos, degrees, dist, hypot, isfinite, radians, sin, tan
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from wavesplat import _native
from wavesplat._model import affine
from wavesplat._model.argument_types import described, takes_its_types
from wavesplat._model.options import VIEWS
from wavesplat._model.vectors import FARTHEST, Vector, check_magnitude, vector
from wavesplat._public import public
from wavesplat.errors import ArgumentError

if TYPE_CHECKING:
    from wavesplat._model.grid import Grid

__all__ = ["Camera", "check_place", "check_view", "checked_lens"]

#: Spacings that are smaller, or larger than its inverse, have squares that float32 does not hold.
SMALLEST = 1e-18
#: Of a place by the spacing there: a thousandth of a sample is still told apart in float64.
PRECISION = 1e12


@public
@dataclass(frozen=True, init=False)
class Camera:
    """An eye in world space, orthographic or in perspective.

    Parameters
    ----------
    position, focal_point : three numbers (x, y, z)
        The eye and the point in the middle of the picture, world units.
    view_up : three numbers (x, y, z)
        Direction that points up in the picture; need not be perpendicular to the view.
    parallel_scale : float, keyword only
        Half the height of the view, world units: an orthographic camera.
    view_angle : float, keyword only
        Angle of view from bottom to top, degrees: a perspective camera. Give one of the two.

    Raises
    ------
    ArgumentError
        If the position is the focal point, the up direction is parallel to the view, or a number is out of range.

    Examples
    --------
    >>> import wavesplat as ws
    >>> ws.Camera((0, 500, 0), (0, 0, 0), (0, 0, 1), view_angle=30).view_angle
    30.0
    """

    position: Vector
    focal_point: Vector
    view_up: Vector
    parallel_scale: float | None
    view_angle: float | None
    _core: _native.Camera = field(repr=False, compare=False)

    @takes_its_types
    def __init__(
        self,
        position: Iterable[float],
        focal_point: Iterable[float],
        view_up: Iterable[float],
        *,
        parallel_scale: float | None = None,
        view_angle: float | None = None,
    ) -> None:
        # Checked at once, so that an error points at the line that made it.
        triple = (
            vector(position, "position of the camera"),
            vector(focal_point, "focal_point of the camera"),
            vector(view_up, "view_up of the camera"),
        )
        lens = tuple(None if number is None else float(number) for number in (parallel_scale, view_angle))
        core = _native.Camera(*triple, *lens)
        names = ("position", "focal_point", "view_up", "parallel_scale", "view_angle", "_core")
        for name, value in zip(names, (*triple, *lens, core), strict=True):
            object.__setattr__(self, name, value)

    @classmethod
    @takes_its_types
    def orbit(
        cls,
        volume: Grid,
        azimuth: float = 0.0,
        elevation: float = 0.0,
        *,
        zoom: float = 1.0,
        view_angle: float | None = None,
        aspect: float = 1.0,
        points: ArrayLike | None = None,
    ) -> Camera:
        """Camera on a circle around the volume, with the whole volume just in view.

        Parameters
        ----------
        volume : Volume or WaveletVolume
            What to look at; the middle of its box is the focal point.
        azimuth : float, degrees
            0 is the anterior view: the eye on +y of the RAS world, looking towards -y, +z up.
            It grows towards the patient's left: 90 is the left view, 180 the posterior one.
        elevation : float, degrees
            Lifts the eye towards +z: 90 looks down from above, -90 up from below.
            The up direction turns along, so no elevation is degenerate.
        zoom : float, default 1
            Magnification. In perspective it narrows the angle of view; the eye stays.
        view_angle : float, degrees, optional
            Perspective with this vertical angle (at zoom 1); None is orthographic.
        aspect : float, default 1
            Width over height of the picture that the volume must fit.
        points : array, shape (n, 3), optional
            What must be in view instead of the corners of the volume's box, world positions.

        Raises
        ------
        ArgumentError
            If a number is not finite, or zoom, aspect or view angle is out of range.

        Examples
        --------
        >>> import wavesplat as ws
        >>> volume = ws.examples.ripples(8)
        >>> eye = ws.Camera.orbit(volume, azimuth=90)  # from the patient's left
        >>> eye.position[0] < eye.focal_point[0]
        True
        """
        _check_orbit(azimuth, elevation, zoom, view_angle, aspect)
        axes = _orbit_axes(azimuth, elevation)
        corners = affine.box_corners(volume.world_from_index, volume.shape)
        shown = corners if points is None else _checked_points(points)
        if points is None:
            center = (corners.min(axis=0) + corners.max(axis=0)) / 2
        else:
            # The middle of what is seen from there.
            seen = shown @ axes.T
            center = (seen.min(axis=0) + seen.max(axis=0)) / 2 @ axes
        in_view = (shown - center) @ axes.T
        if view_angle is None:
            beyond = (corners - center) @ axes.T
            distance = float(np.ptp(beyond[:, 2]))  # clear of the box, so that depths are positive
            half_height = np.maximum(np.abs(in_view[:, 1]), np.abs(in_view[:, 0]) / aspect).max()
            parallel_scale, narrowed_angle = float(half_height) / zoom, None
        else:
            distance = _distance_that_fits(in_view, view_angle, aspect)
            parallel_scale, narrowed_angle = None, degrees(2 * atan(tan(radians(view_angle) / 2) / zoom))
        eye = center + distance * axes[2]
        return cls(eye, center, axes[1], parallel_scale=parallel_scale, view_angle=narrowed_angle)

    @classmethod
    @takes_its_types
    def view(
        cls, volume: Grid, name: str, *, zoom: float = 1.0, view_angle: float | None = None, aspect: float = 1.0
    ) -> Camera:
        """Camera of a named view, with the whole volume just in view.

        Parameters
        ----------
        volume : Volume or WaveletVolume
            What to look at.
        name : str
            "anterior", "posterior", "left", "right", "superior" or "inferior": where the eye is.
            Anterior and inferior show the patient's right at the left of the picture. "front" and "back", "top" and
            "bottom" are others for "anterior" and "posterior", "superior" and "inferior". "xy", "xz" and "yz" show
            these world axes, the first to the right, and "isometric" is a three-quarter view from above.
        zoom, view_angle, aspect
            As for `Camera.orbit`.

        Raises
        ------
        ArgumentError
            If there is no view of that name.

        Examples
        --------
        >>> import wavesplat as ws
        >>> ws.Camera.view(ws.examples.ripples(8), "superior").view_up
        (0.0, 1.0, 0.0)
        """
        if name not in VIEWS:
            raise ArgumentError(f"unknown view {name!r}; use one of: {', '.join(VIEWS)}")
        azimuth, elevation = VIEWS[name]
        return cls.orbit(volume, azimuth, elevation, zoom=zoom, view_angle=view_angle, aspect=aspect)

    def __reduce__(self) -> tuple[Any, ...]:
        lens = partial(type(self), parallel_scale=self.parallel_scale, view_angle=self.view_angle)
        return lens, (self.position, self.focal_point, self.view_up)


def checked_lens(zoom: float, view_angle: float | None) -> None:
    """Refuse a magnification or an angle of view that cannot be."""
    _check_orbit(0.0, 0.0, zoom, view_angle, 1.0)


def check_view(camera: Camera, volume: Grid) -> None:
    """An `ArgumentError` for a view in which the volume, or a pixel, leaves what numbers can tell apart."""
    columns, middle = check_place(volume)
    across = sum(hypot(*column) for column in columns)
    distance = dist(camera.position, camera.focal_point)
    farthest = max(dist(camera.position, middle), dist(camera.focal_point, middle))
    half = distance * tan(radians(camera.view_angle) / 2) if camera.view_angle else camera.parallel_scale or 0.0
    if not across / FARTHEST <= half <= across * FARTHEST:
        raise ArgumentError(
            f"the camera sees {2 * half:g} world units from bottom to top, the volume {volume.name!r} is {across:g} "
            "across; give a zoom, parallel_scale or view_angle that shows something of it"
        )
    if not (farthest <= across * FARTHEST and distance >= across / FARTHEST):
        raise ArgumentError(
            f"the camera is {farthest:g} world units from the volume {volume.name!r}, which is {across:g} across, and "
            f"{distance:g} from its focal point; move it nearer, or the two apart"
        )


def check_place(volume: Grid) -> tuple[list[Vector], Vector]:
    """Edges of the volume's box and its middle; an `ArgumentError` where numbers cannot hold its place in the world.

    In plain floats: this is done for every frame.
    """
    rows = volume.world_from_index.tolist()
    steps = [hypot(rows[0][axis], rows[1][axis], rows[2][axis]) for axis in range(3)]
    least, most = min(steps), max(steps)
    farthest = max(abs(rows[0][3]), abs(rows[1][3]), abs(rows[2][3]))
    if not (least >= SMALLEST and most <= 1 / SMALLEST and most <= FARTHEST * least and farthest <= PRECISION * least):
        raise ArgumentError(
            f"volume {volume.name!r} has samples {least:g} to {most:g} apart, {farthest:g} from the world's origin; "
            "give them in other units, or pass spacing="
        )
    edges = [
        (rows[0][axis] * (n - 1), rows[1][axis] * (n - 1), rows[2][axis] * (n - 1))
        for axis, n in enumerate(reversed(volume.shape))
    ]
    x, y, z = (rows[axis][3] + sum(edge[axis] for edge in edges) / 2 for axis in range(3))
    return edges, (x, y, z)


def _checked_points(points: ArrayLike) -> NDArray[np.float64]:
    try:
        shown = np.array(points, dtype=np.float64)
    except (TypeError, ValueError, OverflowError):
        shown = np.empty(0)
    if shown.ndim != 2 or shown.shape[1] != 3 or not len(shown) or not np.isfinite(shown).all():
        raise ArgumentError(f"points is {described(points)}; give finite world positions, shape (n, 3), at least one")
    return shown


def _check_orbit(azimuth: float, elevation: float, zoom: float, view_angle: float | None, aspect: float) -> None:
    for name, angle in (("azimuth", azimuth), ("elevation", elevation)):
        if not isfinite(angle):
            raise ArgumentError(f"{name} is {angle}; give a finite number of degrees")
    for name, ratio in (("zoom", zoom), ("aspect", aspect)):
        if not (isfinite(ratio) and ratio > 0):
            raise ArgumentError(f"{name} is {ratio}; give a positive finite number, 1 is neutral")
        check_magnitude(ratio, name)
    if view_angle is not None and not 0 < view_angle < 180:
        raise ArgumentError(f"view_angle is {view_angle}; give degrees between 0 and 180, 30 is usual")


def _orbit_axes(azimuth: float, elevation: float) -> NDArray[np.float64]:
    """Rows: right, up, and back (towards the eye) of a camera on the orbit, in the world."""
    sin_a, cos_a = _sin_cos_deg(azimuth)
    sin_e, cos_e = _sin_cos_deg(elevation)
    back = (-sin_a * cos_e, cos_a * cos_e, sin_e)
    up = (sin_a * sin_e, -cos_a * sin_e, cos_e)  # the derivative of `back` by the elevation
    # Adding 0.0 turns -0.0 into 0.0, which prints better.
    return np.array([np.cross(up, back), up, back]) + 0.0


def _sin_cos_deg(angle: float) -> tuple[float, float]:
    """Sine and cosine, exact at quarter turns, so that the named views look straight along an axis."""
    quarters, rest = divmod(angle, 90.0)
    s, c = sin(radians(rest)), cos(radians(rest))
    return ((s, c), (c, -s), (-s, -c), (-c, s))[int(quarters) % 4]


def _distance_that_fits(in_view: NDArray[np.float64], view_angle: float, aspect: float) -> float:
    """Smallest distance of the eye from the middle at which every corner is inside the view.

    A corner (u, v, w) is seen from distance d at v / (d - w), which must not exceed the tangent of half the angle.
    """
    slope = tan(radians(view_angle) / 2)
    u, v, w = in_view.T
    return float((w + np.maximum(np.abs(v), np.abs(u) / aspect) / slope).max())
