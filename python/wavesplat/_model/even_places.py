"""Whether coordinates along an axis are even: as exactly as their numbers can say it.

A longitude of 359.58 in single precision is rounded to a multiple of 3.05e-5, so that steps of 0.0009 differ by 7 %.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

#: Tolerance of coordinates, as a fraction of the step: many are calculated in single precision.
TOLERANCE = 1e-3
#: Maximum rounding error of a coordinate in units in the last place: half a unit each for itself and both ends, doubled
#: since coordinates are often calculated from the one before.
ULPS = 2.0


def off_from_even(places: NDArray[Any], tolerance: float = TOLERANCE) -> tuple[float, float, bool]:
    """The mean step, the largest distance from even places, and whether it is within rounding or tolerance.

    places : two or more coordinates, in the type of the file. tolerance : as a fraction of the step.
    """
    numbers = places.astype(np.float64)
    step = float((numbers[-1] - numbers[0]) / (len(numbers) - 1))
    off = float(np.abs(numbers - (numbers[0] + step * np.arange(len(numbers)))).max())
    # Written so that NaN is uneven too.
    return step, off, bool(step != 0 and off <= max(tolerance * abs(step), rounding_of(places)))


def rounding_of(places: NDArray[Any]) -> float:
    """The distance by which even coordinates can be off since their type is short."""
    if places.dtype.kind != "f" or not np.isfinite(places).all():
        return 0.0
    with np.errstate(over="ignore"):
        single = places.astype(np.float32)
    # Fractions in double precision that have the numbers of single precision were converted from it.
    is_converted = np.array_equal(single, places) and not np.array_equal(np.round(places), places)
    kept = single if is_converted else places
    return ULPS * float(np.spacing(np.abs(kept).max()))
