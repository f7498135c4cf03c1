"""Transfer functions from a volume's histogram.

Otsu's threshold (1979) parts the background (air, empty field) from the object: it maximises the variance between the
two classes.
It is taken on the square roots, so that a few very bright spots (tracer in a bladder, vessels) do not become the object
and everything else its background.
The object's own percentiles then place the curves: its faint half stays a veil, its brightest part becomes solid.
Percentiles stand in for smallest and largest so that a hot pixel or a metal implant cannot flatten the curves.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from wavesplat.errors import ArgumentError
from wavesplat.transfer_function import TransferFunction
from wavesplat.wavelet_volume import WaveletVolume

if TYPE_CHECKING:
    from wavesplat.volume import Volume

__all__ = ["auto", "robust_range"]

#: Samples looked at, at most: enough for steady percentiles, and a fraction of a second on any volume.
N_SAMPLES_MAX = 2_000_000
N_BINS = 512
#: Percentiles that count as the smallest and largest value.
ROBUST = (0.1, 99.9)
#: How each projection reduces a ray; a sum is a mean times the ray's length.
PROJECTIONS: dict[str, Callable[..., Any]] = {
    "maximum": np.nanmax,
    "minimum": np.nanmin,
    "mean": np.nanmean,
    "sum": np.nanmean,
}


def auto(volume: Volume | WaveletVolume, composite: str) -> TransferFunction:
    """See `TransferFunction.auto`."""
    low, high = volume.value_range
    if not low < high:
        raise ArgumentError(
            f"volume {volume.name!r}: every sample is {low:g}, so the histogram shows nothing to tell apart; "
            "pass a transfer function, or check the file"
        )
    if composite in PROJECTIONS:
        return _grey_ramp(_projected(volume, composite))
    if isinstance(volume, WaveletVolume) and volume.is_detail:
        return _signed(volume)
    return _veil_and_solid(_finite(_subsampled(volume)))


def robust_range(volume: Volume | WaveletVolume) -> tuple[float, float]:
    """Values that count as smallest and largest: the 0.1 and 99.9 percentiles, or the extremes if those are equal."""
    return _robust_range(_finite(_subsampled(volume)))


def _robust_range(values: NDArray[np.float64]) -> tuple[float, float]:
    low, high = np.percentile(values, ROBUST)
    if not low < high:
        low, high = values.min(), values.max()
    return float(low), float(high)


def _subsampled(volume: Volume | WaveletVolume) -> NDArray[Any]:
    """Every n-th sample along each axis, [z, y, x]."""
    return volume._every(max(1, int(np.ceil((math.prod(volume.shape) / N_SAMPLES_MAX) ** (1 / 3)))))


def _finite(samples: NDArray[Any]) -> NDArray[np.float64]:
    values = samples.astype(np.float64).ravel()
    return values[np.isfinite(values)]


def _veil_and_solid(values: NDArray[np.float64]) -> TransferFunction:
    low, high = _robust_range(values)
    threshold = _otsu(values, low, high)
    inside = values[values > threshold]
    middle, upper, top = np.percentile(inside, (50, 90, 99.5))
    # Equal percentiles would make steps; keep a small distance, relative to the whole range.
    least = (high - low) * 1e-3
    middle = max(middle, threshold + least)
    upper = max(upper, middle + least)
    top = max(top, upper + least)
    opacity = [(threshold, 0.0), (middle, 0.04), (upper, 0.25), (top, 0.7)]
    color = [
        (threshold, 0.72, 0.36, 0.22),
        (middle, 0.95, 0.64, 0.44),
        (upper, 1.00, 0.88, 0.68),
        (top, 1.00, 0.99, 0.95),
    ]
    return TransferFunction(opacity, color)


def _signed(volume: WaveletVolume) -> TransferFunction:
    """Details: what is as large as the largest thousandth is solid."""
    return TransferFunction.diverging(float(np.percentile(np.abs(_finite(_subsampled(volume))), 99.9)) or 1.0)


def _otsu(values: NDArray[np.float64], low: float, high: float) -> float:
    """The threshold that parts the values into the two classes with the largest variance between their square roots."""
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


def _projected(volume: Volume | WaveletVolume, composite: str) -> NDArray[np.float64]:
    """What a projection along each of the three index axes gives, all pixels together."""
    samples = _subsampled(volume).astype(np.float64)
    samples[~np.isfinite(samples)] = np.nan
    reduce = PROJECTIONS[composite]
    pixels = []
    for axis, spacing in enumerate(reversed(volume.spacing)):
        length = spacing * (volume.shape[axis] - 1) if composite == "sum" else 1.0
        rays = np.isfinite(samples).any(axis=axis)
        pixels.append(reduce(np.where(np.expand_dims(rays, axis), samples, 0.0), axis=axis)[rays] * length)
    return np.concatenate(pixels)


def _grey_ramp(values: NDArray[np.float64]) -> TransferFunction:
    """Black to white; the darkest part is transparent, so that the volume's box does not show."""
    low, high = np.percentile(values, (1.0, 99.8))
    if not low < high:
        low, high = values.min(), values.max()
    high = high if low < high else low + 1.0
    clear = low + 0.05 * (high - low)
    return TransferFunction([(low, 0.0), (clear, 1.0)], [(low, 0.0, 0.0, 0.0), (high, 1.0, 1.0, 1.0)])
