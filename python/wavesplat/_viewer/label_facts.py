"""Statistics of the values of each label of a segmentation, of slab after slab of the scan.

Counts, means and squares about the mean of two parts are merged by the formula of Chan, Golub and LeVeque (1983), which
loses no digits where means are large; so a slab's values are read once, and only they take memory as 64-bit numbers.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

#: Samples of a slab, about: 8 MB as 64-bit numbers, which caches of processors hold in part.
SLAB_SAMPLES = 1 << 18

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class LabelValues:
    """Statistics by code, arrays of shape (n,): voxels, finite values among them, and their mean, sd, min and max."""

    n_voxels: NDArray[np.int64]
    n_finite: NDArray[np.int64]
    mean: Floats
    sd: Floats
    min: Floats
    max: Floats


def values_of_labels(
    codes: NDArray[np.integer], samples: NDArray[np.generic], wanted: NDArray[np.bool_]
) -> LabelValues:
    """Statistics of samples by their codes.

    codes : shape (z, y, x), 0..n - 1. samples : the same shape, any real type. wanted : shape (n,), the codes that
        count; statistics of others are 0. What is outside of all labels is mostly not wanted.
    """
    n = len(wanted)
    n_voxels, n_finite = np.zeros(n, np.int64), np.zeros(n, np.int64)
    mean, squares, least, most = np.zeros(n), np.zeros(n), np.full(n, np.inf), np.full(n, -np.inf)
    depth = max(1, SLAB_SAMPLES // max(1, codes[0].size))
    for first in range(0, len(codes), depth):
        slab = codes[first : first + depth].reshape(-1)
        counts = np.bincount(slab, minlength=n) * wanted
        n_voxels += counts
        if not counts.any():
            continue
        inside = wanted[slab]
        labels, values = slab[inside], samples[first : first + depth].reshape(-1)[inside].astype(np.float64)
        if not (finite := np.isfinite(values)).all():
            labels, values = labels[finite], values[finite]
            counts = np.bincount(labels, minlength=n)
        known = np.maximum(counts, 1)
        own = np.bincount(labels, values, n) / known
        values_about = values - own[labels]
        step, both = own - mean, np.maximum(n_finite + counts, 1)
        squares += np.bincount(labels, values_about**2, n) + np.where(counts, step**2 * n_finite * counts / both, 0)
        mean += np.where(counts, step * counts / both, 0)
        n_finite += counts
        np.minimum.at(least, labels, values)
        np.maximum.at(most, labels, values)
    return LabelValues(n_voxels, n_finite, mean, np.sqrt(squares / np.maximum(n_finite, 1)), least, most)
