"""Materials from a histogram: a mixture of normal distributions, fitted by scikit-learn's `GaussianMixture`.

All distributions have the same deviation, as a scanner's noise is the same in all materials: with deviations of their
own, the widest would win at both ends, and what is below air would be bone.
Samples count by how little changes around them, since those between two materials are not a material of their own.

The share of a material in samples of value v is the probability that v was drawn from its distribution (Bayes), as in
the classifier of Drebin, Carpenter and Hanrahan (1988); and as there, a sample holds two neighbours at most.
For means m and n, weights u and w and deviation s the shares are even at (m + n) / 2 + s^2 ln(u / w) / (n - m), and
change by (n - m) / (4 s^2) there.
We take the line of that slope, but no steeper than over half the way between the means: a sample on a boundary holds
both materials however little noise there is.
"""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import suppress
from itertools import pairwise
from operator import index
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from wavesplat._looks.curves.materials import Material, Materials
from wavesplat._looks.kinds.histogram import robust_range_of
from wavesplat._looks.kinds.looked_at import subsampled
from wavesplat._model.volume.wavelet_volume import WaveletVolume
from wavesplat._system.libraries import library
from wavesplat._system.values import described
from wavesplat.errors import ArgumentError

if TYPE_CHECKING:
    from wavesplat._model.volume.volume import Volume

N_BINS = 512
#: Largest number of materials: a histogram separates a handful, and the time of a fit grows with their number.
MAX_MATERIALS = 32
#: Number of quantiles that stand for the histogram in the fit, which takes less than a second with them.
N_QUANTILES = 20_000
#: Least width of the ramp from one material to the next, as a share of the distance of their means.
MIN_RAMP = 0.5
#: Change between neighbours at which a sample counts half, and least deviation, as shares of the range of values.
#: By trial on CT and MRI: without the first, the skin of a body becomes a material and fat and muscle are one.
CALM = 0.03
MIN_DEVIATION = 0.01
#: Colours and opacities from the least dense material that shows to the densest: a veil, flesh, something solid.
COLORS = ((0.93, 0.72, 0.55), (0.88, 0.38, 0.27), (1.0, 0.95, 0.85))
OPACITIES = (0.006, 0.03, 0.6)


def fit(volume: Volume | WaveletVolume, materials: int | Sequence[str]) -> Materials:
    """See `Materials.fit`."""
    names = _names(materials)
    mixture = _mixture(_quantiles(volume, len(names)), len(names))
    order = np.argsort(mixture.means_[:, 0])
    means, weights = mixture.means_[order, 0], mixture.weights_[order]
    ramps = [
        _ramp(low, high, float(mixture.covariances_[0, 0]), odds)
        for (low, high), odds in zip(pairwise(means), weights[:-1] / weights[1:], strict=True)
    ]
    return Materials(
        Material(name, curve, color, opacity)
        for name, curve, color, opacity in zip(names, _curves(ramps, means[0]), *_looks(len(names)), strict=True)
    )


def _names(materials: int | Sequence[str]) -> list[str]:
    if isinstance(materials, str):
        raise ArgumentError(f"materials is {materials!r}; give a number of materials, or a list of their names")
    count = len(materials) if isinstance(materials, Sequence) else 0
    if not isinstance(materials, Sequence):
        with suppress(TypeError):
            count = index(materials)
    if not 1 <= count <= MAX_MATERIALS:
        raise ArgumentError(
            f"materials is {described(materials)}; give a number from 1 to {MAX_MATERIALS}, or a list of names"
        )
    if isinstance(materials, Sequence):
        return list(materials)
    return [f"material {number}" for number in range(1, count + 1)]


def _quantiles(volume: Volume | WaveletVolume, n_materials: int) -> NDArray[np.float64]:
    """Sorted quantiles of the samples, weighted by how little changes around them.

    Without the outermost thousandths, which are padding and metal.
    """
    samples = subsampled(volume).astype(np.float64)
    samples[~np.isfinite(samples)] = np.nan
    steepness = np.sqrt(sum(np.gradient(samples, axis=axis) ** 2 for axis in range(3) if samples.shape[axis] > 1))
    usable = np.isfinite(samples) & np.isfinite(steepness)
    counts, edges = np.zeros(1), np.zeros(2)
    if usable.any():
        low, high = robust_range_of(samples[usable])
        weights = 1.0 / (1.0 + (steepness[usable] / (CALM * ((high - low) or 1.0))) ** 2)
        counts, edges = np.histogram(samples[usable], N_BINS, (low, high), weights=weights)
    n_different = np.count_nonzero(counts)
    if n_different < n_materials:
        raise ArgumentError(
            f"volume {volume.name!r}: it has {n_different} different values, too few to tell {n_materials} materials "
            "apart; ask for fewer, or check the file"
        )
    below = np.concatenate([[0.0], np.cumsum(counts) / counts.sum()])
    return np.interp((np.arange(N_QUANTILES) + 0.5) / N_QUANTILES, below, edges)


def _mixture(values: NDArray[np.float64], n_materials: int) -> Any:
    least = MIN_DEVIATION * float(values[-1] - values[0])
    # k-means puts the first means; a seed makes it, and with it the fit, the same every time.
    mixture = library("sklearn.mixture", extra="fit").GaussianMixture(
        n_materials, covariance_type="tied", reg_covar=least**2, random_state=0, max_iter=1000
    )
    return mixture.fit(values[:, None])


def _ramp(low: float, high: float, variance: float, odds: float) -> tuple[float, float]:
    """Values, between two means, at which one material begins to turn into the other, and at which it has."""
    apart = high - low
    width = float(np.clip(4.0 * variance / apart, MIN_RAMP * apart, apart))
    middle = (low + high) / 2.0 + variance * np.log(odds) / apart
    start = float(np.clip(middle - width / 2.0, low, high - width))
    return start, start + width


def _curves(ramps: list[tuple[float, float]], mean: float) -> list[list[tuple[float, float]]]:
    """Each material's probability: it rises over one ramp and falls over the next. `mean`: of a single material."""
    rises = [[], *([(start, 0.0), (end, 1.0)] for start, end in ramps)]
    falls = [*([(start, 1.0), (end, 0.0)] for start, end in ramps), []]
    return [rise + fall or [(float(mean), 1.0)] for rise, fall in zip(rises, falls, strict=True)]


def _looks(n_materials: int) -> tuple[list[tuple[float, float, float]], list[float]]:
    """Colours and opacities: the lowest material is clear, the others go from a veil to solid."""
    n_seen = n_materials - 1
    shares = [number / max(n_seen - 1, 1) if n_seen > 1 else 1.0 for number in range(n_seen)]
    at = np.linspace(0.0, 1.0, len(COLORS))
    colors = [tuple(float(np.interp(share, at, channel)) for channel in zip(*COLORS, strict=True)) for share in shares]
    opacities = np.exp(np.interp(shares, at, np.log(OPACITIES)))
    return [(0.0, 0.0, 0.0), *colors], [0.0, *map(float, opacities)]  # type: ignore[list-item]
