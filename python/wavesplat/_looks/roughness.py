"""Roughness of samples: how much neighbours bend beside how much they rise.

For samples a, b, c in a row the bend is |a - 2b + c| and the rise |c - a| / 2. A wave of n samples has 2 pi / n of bend
to its rise; independent noise 3.5, since their deviations are sqrt(6) and sqrt(1/2) of the noise's. Scans have noise,
and boundaries about as sharp as their samples; codes that solve equations need some samples for what they solve.
(Medians and sums of 22 scans: 1.2 to 3.4, but for an engine's sum, 0.97, and smoothed phantoms, 0.9. Fuel, a jet of
heptane, a protein's density, bytes all: 0.4 to 0.8.)
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

#: Largest roughness of data without noise.
MAX_SMOOTH = 0.9


def roughness(samples: NDArray[Any], neighbours: list[tuple[NDArray[Any], NDArray[Any]]]) -> float:
    """Ratio of bend to rise, over all samples and in the median of those that rise, whichever is larger.

    samples : any number of samples. neighbours : their two neighbours along each axis; samples take no part along axes
        where one of the three is missing (not finite). Infinity where nothing rises.
    """
    middle = samples.astype(np.float64)
    bend, rise = np.zeros(middle.shape), np.zeros(middle.shape)
    with np.errstate(over="ignore", invalid="ignore"):
        for before, after in neighbours:
            low, high = before.astype(np.float64), after.astype(np.float64)
            is_known = np.isfinite(low) & np.isfinite(middle) & np.isfinite(high)
            bend += np.where(is_known, np.abs(low - 2 * middle + high), 0.0)
            rise += np.where(is_known, 0.5 * np.abs(high - low), 0.0)
        values, counts = np.unique(middle[np.isfinite(middle)], return_counts=True)
        # A background of one value is no matter, smooth or not.
        background = values[counts.argmax()] if values.size else np.nan
        is_matter = np.isfinite(bend) & np.isfinite(rise) & (rise > 0) & (middle != background)
        if not is_matter.any():
            return float("inf")
        is_finite = np.isfinite(bend) & np.isfinite(rise)
        whole = bend[is_finite].sum() / rise[is_finite].sum()
    return float(max(whole, np.median(bend[is_matter] / rise[is_matter])))


def is_smooth(samples: NDArray[Any], neighbours: list[tuple[NDArray[Any], NDArray[Any]]]) -> bool:
    """Whether samples have no noise, as the results of simulations."""
    return roughness(samples, neighbours) < MAX_SMOOTH
