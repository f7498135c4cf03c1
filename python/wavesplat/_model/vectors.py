"""Points and directions in three dimensions, as plain tuples of floats."""

from __future__ import annotations

from collections.abc import Iterable
from math import hypot, inf, isfinite
from typing import Any, TypeAlias

from wavesplat._files import values
from wavesplat.errors import ArgumentError

__all__ = ["FARTHEST", "Vector", "check_magnitude", "point_and_normal", "triple", "vector"]

Vector: TypeAlias = tuple[float, float, float]


#: Largest ratio of lengths in a picture, such as of view and volume: beyond it floats do not resolve pixels.
FARTHEST = 1e9


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
