"""Points and directions in three dimensions, as plain tuples of floats."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any, TypeAlias

from wavesplat.errors import ArgumentError

__all__ = ["Vector", "vector"]

Vector: TypeAlias = tuple[float, float, float]


def vector(numbers: Iterable[Any], what: str) -> Vector:
    """Three floats from any sequence or array of three numbers; `what` names them in the error."""
    try:
        x, y, z = (float(number) for number in numbers)
    except (TypeError, ValueError, OverflowError):
        raise ArgumentError(f"{what} is {numbers!r}; give three numbers") from None
    return x, y, z
