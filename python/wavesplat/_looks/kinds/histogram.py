"""Statistics of a volume's histogram: its range, thresholds, greys for projections.

Projections get a grey ramp over the values that they project to, along the three index axes or in a view.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, get_args

import numpy as np
from numpy.typing import NDArray

from wavesplat import _native
from wavesplat._looks.curves.transfer_function import TransferFunction
from wavesplat._looks.kinds.hounsfield import looks_like_hounsfield
from wavesplat._looks.kinds.looked_at import subsampled, subsampled_as_float64
from wavesplat._model.arguments.sampling import Composite
from wavesplat._model.volume.wavelet_volume import WaveletVolume

if TYPE_CHECKING:
    from wavesplat._model.volume.volume import Volume

# The range of values that counts, and the threshold between background and object: `crates/look` has `histogram.rs`.


def robust_range_of(values: NDArray[np.float64]) -> tuple[float, float]:
    """The robust range of finite values, flat: the 0.1 and 99.9 percentiles, or the extremes if those are equal."""
    return _native.robust_range(values)


def otsu(values: NDArray[np.float64], low: float, high: float) -> float:
    """Otsu's threshold: it parts the values into the classes with the largest variance between their square roots."""
    return _native.otsu(values, low, high)


def otsu_of_scan(values: NDArray[np.float64], low: float, high: float) -> tuple[float, float, float]:
    """The mean of the background, Otsu's threshold above it, and the value that counts as largest, of a padded scan.

    low, high : values that count as smallest and largest, padding included.
    """
    return _native.otsu_of_scan(values, low, high)


# Greys of projections: `crates/look` has `projections.rs`.

#: Projections: all operators whose result is one number per pixel.
PROJECTIONS = tuple(name for name in get_args(Composite) if name not in ("over", "first-hit"))
#: Value of air, which absorbs nothing, in Hounsfield units, and absorption per millimetre and unit above it.
HOUNSFIELD_ATTENUATION = _native.HOUNSFIELD_ATTENUATION


def projected(volume: Volume | WaveletVolume, composite: str) -> TransferFunction:
    """Greys for the pixels of the projections along the three index axes."""
    is_ct = composite == "x-ray" and is_hounsfield(volume)
    return TransferFunction(*_native.greys_of_projection(_spread(volume), composite, is_ct))


def exposed(volume: Volume | WaveletVolume, composite: str, values: NDArray[np.floating[Any]]) -> TransferFunction:
    """Greys for a projection's pixels, given as any number of values."""
    pixels = np.ascontiguousarray(values, np.float64).ravel()
    return TransferFunction(*_native.greys_of_pixels(pixels, composite, robust_range(volume)))


def robust_range(volume: Volume | WaveletVolume) -> tuple[float, float]:
    """Values that count as smallest and largest: the 0.1 and 99.9 percentiles, or the extremes if those are equal."""
    return robust_range_of(finite_samples(volume))


def finite_samples(volume: Volume | WaveletVolume) -> NDArray[np.float64]:
    """Samples that are numbers, some millions at most, spread evenly over the volume."""
    values = subsampled(volume).astype(np.float64).ravel()
    return values[np.isfinite(values)]


def is_hounsfield(volume: Volume | WaveletVolume) -> bool:
    """Whether the values look like Hounsfield units."""
    return looks_like_hounsfield(finite_samples(volume), volume)


def attenuation(volume: Volume | WaveletVolume) -> tuple[float, float]:
    """The value that absorbs no x-rays, and absorption per world unit and sample unit above it.

    Both are fixed for values that look like Hounsfield units; for others they follow from the range of values.
    """
    return _native.attenuation(_spread(volume), is_hounsfield(volume))


def signed(volume: WaveletVolume) -> TransferFunction:
    """Diverging colours for wavelet details, full where they are as large as the largest thousandth."""
    return TransferFunction.diverging(float(np.percentile(np.abs(finite_samples(volume)), 99.9)) or 1.0)


def _spread(
    volume: Volume | WaveletVolume,
) -> tuple[NDArray[np.float64], tuple[int, int, int], tuple[float, float, float]]:
    return subsampled_as_float64(volume), volume.shape, volume.spacing
