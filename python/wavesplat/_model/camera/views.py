"""Named views and planes: the side from which data are seen, the axes of the picture, and vectors for them.

A body is shown as radiologists read it: axial from the feet, coronal from the front, sagittal from the patient's left.
Other data are shown as they are stored, row 0 on top and column 0 on the left, as Fiji, napari and matplotlib show an
array of shape (z, y, x): `a[k]` is xy, `a[:, j]` is xz and `a[:, :, i]` is yz. All are turned, never mirrored: the eye
is before the first slice of xy, behind the last row of xz and before the first column of yz.
Maps and calculated volumes, where the file says so (`UPRIGHT` of `_model/volume/grid.py`), have the world's axes to the
right and up.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from math import hypot, inf, isfinite
from typing import Any, NamedTuple, TypeAlias

from wavesplat import _native
from wavesplat._system import values
from wavesplat.errors import ArgumentError

# Points and directions in three dimensions, as plain tuples of floats.

Vector: TypeAlias = tuple[float, float, float]


#: Largest ratio of lengths in a picture, such as of view and volume: beyond it floats do not resolve pixels.
FARTHEST = _native.FARTHEST


def check_magnitude(ratio: float, name: str) -> None:
    """Refuse a positive factor outside of 1 / FARTHEST .. FARTHEST."""
    if not 1 / FARTHEST <= ratio <= FARTHEST:
        raise ArgumentError(f"{name} is {ratio:g}; give a number from {1 / FARTHEST:g} to {FARTHEST:g}, 1 is neutral")


def vector(numbers: Iterable[Any], what: str) -> Vector:
    """Three numbers, which may be infinite or NaN, as floats; `what` names them in the error."""
    x, y, z = values.numbers(numbers, what, "three numbers", n=3, finite=False)
    return x, y, z


def triple(numbers: Iterable[Any]) -> Vector:
    """Three numbers that are known to be right, as plain floats."""
    x, y, z = (float(number) for number in numbers)
    return x, y, z


def point_and_normal(point: Iterable[Any], normal: Iterable[Any], what: str) -> tuple[Vector, Vector]:
    """A point and the normal of a plane, of any length, or an `ArgumentError`; `what`: such as "clip plane"."""
    point, normal = vector(point, f"point of the {what}"), vector(normal, f"normal of the {what}")
    if not (all(map(isfinite, (*point, *normal))) and 0 < hypot(*normal) < inf):
        raise ArgumentError(
            f"{what} has the point {point} and the normal {normal}; give finite numbers, and a normal that is not zero"
        )
    return point, normal


# Named views and planes: the side from which data are seen, and the axes of the picture.


class PlaneView(NamedTuple):
    """How a plane is shown."""

    #: The world's axis across it.
    across: str
    #: The world's direction that is up in its picture.
    up: str
    #: The world's direction from the plane to the eye.
    to_eye: str

    @property
    def axes(self) -> tuple[Vector, Vector, Vector]:
        """Right and up of the picture, and the direction to the eye, unit vectors in the world."""
        up, to_eye = _direction(self.up), _direction(self.to_eye)
        (a, b, c), (d, e, f) = up, to_eye
        # The cross product; adding 0.0 turns -0.0 into 0.0, which prints better.
        return (b * f - c * e + 0.0, c * d - a * f + 0.0, a * e - b * d + 0.0), up, to_eye


#: The planes of a body and those of other data, in the order in which equally near ones are chosen.
PLANES = {
    "axial": PlaneView("z", "+y", "-z"),
    "coronal": PlaneView("y", "+z", "+y"),
    "sagittal": PlaneView("x", "+z", "-x"),
    "xy": PlaneView("z", "-y", "-z"),
    "xz": PlaneView("y", "-z", "+y"),
    "yz": PlaneView("x", "-z", "-x"),
}
#: The planes of data other than bodies where the world's axes grow to the right and up.
UPRIGHT_PLANES = {
    "xy": PlaneView("z", "+y", "+z"),
    "xz": PlaneView("y", "+z", "-y"),
    "yz": PlaneView("x", "+z", "+x"),
}
OF_BODIES, OF_OTHERS = ("axial", "coronal", "sagittal"), ("xy", "xz", "yz")

#: Azimuth and elevation, degrees, of the named views (`crates/view`); those of planes are of data other than bodies.
VIEWS: dict[str, tuple[float, float]] = _native.VIEWS


def view_angles(name: object, *, is_anatomical: bool) -> tuple[float, float]:
    """Azimuth and elevation, degrees, of a named view; an `ArgumentError` where there is none of that name."""
    if not isinstance(name, str) or name not in VIEWS:
        raise ArgumentError(f"unknown view {name!r}; use one of: {', '.join(VIEWS)}")
    return _native.view_angles(name, is_anatomical)


def planes_of(*, is_anatomical: bool) -> tuple[str, str, str]:
    """Names of the three planes: of a body, or of other data."""
    return OF_BODIES if is_anatomical else OF_OTHERS


def plane_view(name: str, *, is_upright: bool) -> PlaneView:
    """How the plane of a name is shown."""
    return UPRIGHT_PLANES.get(name, PLANES[name]) if is_upright else PLANES[name]


def named_plane(name: object, *, is_anatomical: bool) -> str:
    """The plane of data that a name stands for: xy of a body is axial, and axial of other data is xy."""
    if not isinstance(name, str) or name not in PLANES:
        raise ArgumentError(f"unknown plane {name!r}; use one of: {', '.join(PLANES)}, or (point, normal)")
    return plane_across(PLANES[name].across, is_anatomical=is_anatomical)


def plane_across(axis: str, *, is_anatomical: bool) -> str:
    """The plane of data across an axis of the world, "x", "y" or "z"."""
    return next(own for own in planes_of(is_anatomical=is_anatomical) if PLANES[own].across == axis)


def nearest_plane(normal: Sequence[float], *, is_anatomical: bool) -> str:
    """The named plane whose normal is nearest; of equally near ones that across z, then y, goes first."""
    nearness = {name: round(abs(normal["xyz".index(PLANES[name].across)]), 9) for name in PLANES}
    return max(planes_of(is_anatomical=is_anatomical), key=lambda name: nearness[name])


def _direction(signed_axis: str) -> Vector:
    length = 1.0 if signed_axis[0] == "+" else -1.0
    x, y, z = (length if axis == signed_axis[1] else 0.0 for axis in "xyz")
    return x, y, z
