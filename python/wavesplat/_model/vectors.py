"""Points and directions in three dimensions, as plain tuples of floats."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any, TypeAlias

from wavesplat._model.argument_types import described
from wavesplat.errors import ArgumentError

__all__ = ["FARTHEST", "Vector", "check_magnitude", "vector"]

Vector: TypeAlias = tuple[float, float, float]


#: Largest ratio of lengths in a picture, such as of view and volume: beyond it floats do not resolve pixels.
FARTHEST = 1e9


def check_magnitude(ratio: float, name: str) -> None:
    """Refuse a positive factor outside of 1 / FARTHEST .. FARTHEST."""
    if not 1 / FARTHEST <= ratio <= FARTHEST:
        raise ArgumentError(f"{name} is {ratio:g}; give a number from {1 / FARTHEST:g} to {FARTHEST:g}, 1 is neutral")


def vector(numbers: Iterable[Any], what: str) -> Vector:
    """Three floats from any sequence or array of three numbers; `what` names them in the error."""
    try:
        x, y, z = (float(number) for number in numbers)
    except (TypeError, ValueError, OverflowError):
        raise ArgumentError(f"{what} is {described(numbers)}; give three numbers") from None
    return x, y, z
