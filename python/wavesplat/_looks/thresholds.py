"""The range of values that counts, and the threshold between background and object.

Otsu's threshold (1979) parts the background (air, empty field) from the object: it maximises the variance between the
two classes.
It is taken on the square roots, so that a few very bright spots (tracer in a bladder, vessels) do not become the object
and everything else its background.
Percentiles stand in for smallest and largest so that a hot pixel or a metal implant cannot flatten the curves.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

N_BINS = 512
#: Percentiles that count as the smallest and largest value.
ROBUST = (0.1, 99.9)
#: Padding around what was scanned: least share of the samples of one value. Air in it: least distance of the means of
#: air and object, in the sum of their deviations. (Grey and white matter: 1.5; speckle: 2.4.)
MIN_PADDING, MIN_APART = 0.1, 2.5


def robust_range_of(values: NDArray[np.float64]) -> tuple[float, float]:
    """The robust range of finite values, any number of them."""
    low, high = np.percentile(values, ROBUST)
    if not low < high:
        low, high = values.min(), values.max()
    return float(low), float(high)


def otsu(values: NDArray[np.float64], low: float, high: float) -> float:
    """Otsu's threshold: it parts the values into the classes with the largest variance between their square roots."""
    roots = np.sqrt(np.clip((values - low) / (high - low), 0.0, 1.0))
    counts, edges = np.histogram(roots, bins=N_BINS, range=(0.0, 1.0))
    centers = (edges[:-1] + edges[1:]) / 2
    below = np.cumsum(counts)[:-1]
    above = values.size - below
    sum_below = np.cumsum(counts * centers)[:-1]
    sum_above = (counts * centers).sum() - sum_below
    with np.errstate(divide="ignore", invalid="ignore"):
        between = below * above * (sum_below / below - sum_above / above) ** 2
    # An empty gap between the classes makes a plateau; its middle is the steadiest choice.
    best = np.flatnonzero(np.nan_to_num(between) >= np.nanmax(between) * (1 - 1e-9))
    return float(low + edges[1:-1][best[len(best) // 2]] ** 2 * (high - low))


def otsu_of_scan(values: NDArray[np.float64], low: float, high: float) -> tuple[float, float, float]:
    """The mean of the background, Otsu's threshold above it, and the value that counts as largest, of a padded scan.

    Samples outside of a scan may have one value. Such padding would be the background, and the air of the scan the
    object, so the padding is left out if the rest falls into two classes far apart.

    low, high : values that count as smallest and largest, padding included. Of a scan that is next to nothing but
        padding, a bone alone, `high` may lie within the scan: then the scan's own largest value counts.
    """
    threshold = otsu(values, low, high)
    found, counts = np.unique(values, return_counts=True)
    if counts.argmax() == 0 and counts[0] >= MIN_PADDING * values.size:
        scanned = values[values > found[0]]
        start, end = robust_range_of(scanned) if scanned.size else (0.0, 0.0)
        again = otsu(scanned, start, end) if start < end else threshold
        air, matter = scanned[scanned <= again], scanned[scanned > again]
        if again > threshold and air.size and matter.size:
            mean = float(air.mean())
            if float(matter.mean()) - mean > MIN_APART * float(air.std() + matter.std()):
                return mean, again, high if high > again else end
    return low, threshold, high
