"""Statistics of a volume's histogram: its range, thresholds, samples without padding, greys for projections.

Projections get a grey ramp over the values that they project to, along the three index axes or in a view.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from wavesplat import _native
from wavesplat._looks.curves.transfer_function import TransferFunction
from wavesplat._looks.kinds.hounsfield import looks_like_hounsfield
from wavesplat._looks.kinds.looked_at import subsampled
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


# Statistics of a volume's histogram: its range, samples without padding, greys for projections.

#: Share of a window below which values count as empty.
CLEAR = 0.05
#: Least width of a window, as a share of the volume's range, so that noise in uniform matter stays dark.
MIN_WINDOW = 0.05
#: Grey of the median of a radiograph, and the number of its nodes, which are even in the logarithm of the light.
MIDDLE_GREY = 0.45
N_RADIOGRAPH = 65
#: Largest grey of the median of a mean's or a sum's pixels.
BRIGHTEST_MEDIAN = 0.6
#: Projections whose values do not depend much on where the volume is seen from.
MAXIMA = ("maximum", "depth-shaded-maximum", "depth-colored-maximum", "attenuated-maximum", "local-maximum")
#: Maxima whose black is the value that most of an object exceeds, so that its front stands out.
HIDING = ("depth-shaded-maximum", "local-maximum")
#: Percentile of the samples beyond which some may be hot pixels of a camera, and how many times as far above the
#: background as all their neighbours these are.
BRIGHT_PERCENT, HOT = 99.8, 3.0
#: Reduction of a ray by each projection; a sum is a mean times the ray's length.
PROJECTIONS: dict[str, Callable[..., Any]] = {
    **dict.fromkeys(MAXIMA, np.nanmax),
    "minimum": np.nanmin,
    "mean": np.nanmean,
    "sum": np.nanmean,
    "x-ray": np.nanmean,
}
#: Value of air, which absorbs nothing, in Hounsfield units, and absorption per millimetre and unit above it, a
#: thousandth of that of water for photons of 60 keV, about the mean of a radiograph at 120 kV: 0.2059 per cm (Hubbell
#: and Seltzer, NIST).
HOUNSFIELD_ATTENUATION = (-1000.0, 2.059e-5)
#: Optical depth that the most absorbing rays get where the units of absorption are not known: a 150th comes through.
UNKNOWN_DEPTH = 5.0


def projected(volume: Volume | WaveletVolume, composite: str) -> TransferFunction:
    """Greys for the pixels of the projections along the three index axes."""
    if composite == "x-ray":
        clear, per_unit = attenuation(volume)
        return exposed(volume, composite, np.exp(-per_unit * _projected(volume, composite, clear)))
    return exposed(volume, composite, _projected(volume, composite))


def exposed(volume: Volume | WaveletVolume, composite: str, values: NDArray[np.floating[Any]]) -> TransferFunction:
    """Greys for a projection's pixels, given as any number of values."""
    if composite == "x-ray":
        return _radiograph(-np.log(np.maximum(values, np.finfo(np.float32).tiny)))
    if composite in MAXIMA:
        return _of_maxima(values, hides_half=composite in HIDING)
    low, high = robust_range(volume)
    return _grey_ramp(values, least=MIN_WINDOW * (high - low))


def pixels_of_maxima(volume: Volume | WaveletVolume) -> NDArray[np.float64]:
    """Largest values of the rays along each of the three index axes, all together."""
    return _projected(volume, "maximum")


def not_beyond(greys: TransferFunction, white: float) -> TransferFunction:
    """Greys of a maximum whose white is at most the value `white`."""
    low, black, own = greys.opacity[0][0], greys.color[0][0], greys.color[-1][0]
    return greys if own <= white or white <= low else _greys(low, min(black, low + 0.9 * (white - low)), white)


def not_before(greys: TransferFunction, black: float) -> TransferFunction:
    """Greys of a maximum whose black is at least the value `black`, if that is well below white."""
    own, white = greys.color[0][0], greys.color[-1][0]
    return greys if own >= black or white - black < 0.1 * (white - own) else _greys(black, black, white)


def robust_range(volume: Volume | WaveletVolume) -> tuple[float, float]:
    """Values that count as smallest and largest: the 0.1 and 99.9 percentiles, or the extremes if those are equal."""
    return robust_range_of(_finite(subsampled(volume)))


def finite_samples(volume: Volume | WaveletVolume) -> NDArray[np.float64]:
    """Samples that are numbers, some millions at most, spread evenly over the volume."""
    return _finite(subsampled(volume))


def is_hounsfield(volume: Volume | WaveletVolume) -> bool:
    """Whether the values look like Hounsfield units."""
    return looks_like_hounsfield(finite_samples(volume), volume)


def attenuation(volume: Volume | WaveletVolume) -> tuple[float, float]:
    """The value that absorbs no x-rays, and absorption per world unit and sample unit above it.

    Both are fixed for values that look like Hounsfield units; for others they follow from the range of values.
    """
    values = finite_samples(volume)
    if looks_like_hounsfield(values, volume):
        return HOUNSFIELD_ATTENUATION
    clear, _ = robust_range_of(values)
    most = float(np.percentile(_projected(volume, "x-ray", clear), 99.5))
    return clear, UNKNOWN_DEPTH / most if most > 0 else 1.0


def without_padding(samples: NDArray[Any]) -> NDArray[np.float64]:
    """Finite samples, flat, of an array [z, y, x] without the outer planes that have the value of its first corner.

    Statistics of them do not depend on how much empty space was put around the data.
    """
    return _native.without_padding(np.ascontiguousarray(samples, np.float64))


def _finite(samples: NDArray[Any]) -> NDArray[np.float64]:
    values = samples.astype(np.float64).ravel()
    return values[np.isfinite(values)]


def signed(volume: WaveletVolume) -> TransferFunction:
    """Diverging colours for wavelet details, full where they are as large as the largest thousandth."""
    return TransferFunction.diverging(float(np.percentile(np.abs(_finite(subsampled(volume))), 99.9)) or 1.0)


def _projected(volume: Volume | WaveletVolume, composite: str, clear: float = 0.0) -> NDArray[np.float64]:
    """Pixels of the projections along each of the three index axes, all together.

    For an x-ray, the integral of the values above `clear`.
    """
    samples = subsampled(volume).astype(np.float64)
    # Of a larger volume some samples were left out, and neighbours are not known.
    if composite in MAXIMA and samples.shape == volume.shape:
        _dim_hot_samples(samples)
    samples[~np.isfinite(samples)] = np.nan
    if composite == "x-ray":
        samples = np.maximum(samples - clear, 0.0)
    reduce = PROJECTIONS[composite]
    pixels = []
    for axis, spacing in enumerate(reversed(volume.spacing)):
        length = spacing * (volume.shape[axis] - 1) if composite in ("sum", "x-ray") else 1.0
        rays = np.isfinite(samples).any(axis=axis)
        pixels.append(reduce(np.where(np.expand_dims(rays, axis), samples, 0.0), axis=axis)[rays] * length)
    return np.concatenate(pixels)


def _dim_hot_samples(samples: NDArray[np.float64]) -> None:
    """Give lone samples that are far brighter than all neighbours, hot pixels of a camera, the largest of these.

    samples : [z, y, x], changed in place.
    """
    finite = samples[np.isfinite(samples)]
    if not finite.size:
        return
    background, bright = np.percentile(finite, (50.0, BRIGHT_PERCENT))
    at = np.argwhere(samples > bright)
    around = np.full(len(at), -np.inf)
    for axis in range(3):
        for side in (-1, 1):
            beside = at.copy()
            beside[:, axis] += side
            is_inside = (beside[:, axis] >= 0) & (beside[:, axis] < samples.shape[axis])
            around[is_inside] = np.fmax(around[is_inside], samples[tuple(beside[is_inside].T)])
    is_hot = samples[tuple(at.T)] - background > HOT * (around - background)
    samples[tuple(at[is_hot].T)] = around[is_hot]


def _grey_ramp(values: NDArray[np.floating[Any]], least: float) -> TransferFunction:
    """Greys over at least the extent `least`; the darkest is transparent, so that the volume's box does not show.

    Black is higher where the object would be nearly white: a body's mean is, and its rim would take half of the greys.
    """
    low, high = (float(value) for value in np.percentile(values, (1.0, 99.8)))
    high = max(high, low + (least or 1.0))
    inside = values[values > low + CLEAR * (high - low)]
    middle = float(np.median(inside)) if inside.size else low
    black = (middle - BRIGHTEST_MEDIAN * high) / (1.0 - BRIGHTEST_MEDIAN)
    return _greys(low, min(max(black, low), low + 0.9 * (high - low)), high)


def _of_maxima(values: NDArray[np.floating[Any]], *, hides_half: bool) -> TransferFunction:
    """Greys of a maximum: white is near the value that a fiftieth of the pixels exceeds.

    So metal or a bladder full of tracer dims nothing else.
    Where that fiftieth is all there is, such as a single vessel, a third of its range is left for what is around it.
    `hides_half`: black is not the background but what a quarter of the object does not exceed; else white is a quarter
    higher, so that vessels stand out from a brain.
    """
    low, white, high = (float(value) for value in np.percentile(values, (1.0, 98.0, 99.8)))
    reach = 1.0 if hides_half else 1.25
    high = max(min(low + reach * (white - low), high), low + 0.3 * (high - low))
    high = high if low < high else low + 1.0
    inside = values[values > low + CLEAR * (high - low)]
    black = float(np.percentile(inside, 25.0)) if hides_half and inside.size else low
    return _greys(low, min(black, low + 0.9 * (high - low)), high)


def _greys(low: float, black: float, white: float) -> TransferFunction:
    clear = low + CLEAR * (white - low)
    return TransferFunction([(low, 0.0), (clear, 1.0)], [(black, 0.0, 0.0, 0.0), (white, 1.0, 1.0, 1.0)])


def _radiograph(depths: NDArray[np.floating[Any]]) -> TransferFunction:
    """Greys by the optical depth, as a digital radiograph shows it: bone is bright.

    Its median over the object becomes a middle grey, whatever the exponent that it takes, so that a thick object keeps
    its contrast. What absorbs next to nothing is transparent.
    """
    white = max(float(np.percentile(depths, 99.8)), 1e-3)
    inside = depths[depths > CLEAR * white]
    middle = float(np.median(inside)) / white if inside.size else 0.5
    exponent = np.clip(np.log(MIDDLE_GREY) / np.log(min(middle, 0.99)), 0.7, 2.5)
    steps = np.linspace(1.0, 0.0, N_RADIOGRAPH)
    through = np.exp(-white * steps)
    colors = [(float(t), g, g, g) for t, g in zip(through, steps**exponent, strict=True)]
    return TransferFunction([(float(np.exp(-CLEAR * white)), 1.0), (1.0, 0.0)], colors)
