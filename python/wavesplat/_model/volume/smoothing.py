"""Smoothing by a Gaussian: noise and the steps of samples go, edges stay where they are.

The kernel exp(-i^2 / 2 s^2) of s samples ends at 3 s, has the sum 1, and runs along each axis in turn; beyond the
volume its outermost samples are repeated. Samples that are not finite take no part: each mean is over the finite ones,
weighted by the kernel (normalised convolution, Knutsson and Westin 1993), and what was not finite is NaN.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

#: Reach of the kernel, in standard deviations.
TRUNCATED = 3.0
#: Smallest deviation that smooths, in samples: kernels of smaller ones end before the first neighbour.
MIN_DEVIATION = 0.5 / TRUNCATED
#: Samples that are smoothed at once: few enough to stay in a processor's cache.
N_AT_ONCE = 1 << 18


def smoothed(samples: NDArray[Any], deviations: Sequence[float]) -> NDArray[Any]:
    """Samples [z, y, x] smoothed by Gaussians of these standard deviations, in samples along (z, y, x).

    The result is float32; float64 of 32-bit integers and float64. Where some samples are not finite, smoothing takes
    the memory of two results.
    """
    values = samples.astype(np.result_type(samples.dtype, np.float32))
    finite = np.isfinite(values)
    if finite.all():
        _smooth(values, deviations)
        return values
    weights = finite.astype(values.dtype)
    values[~finite] = 0
    _smooth(values, deviations)
    _smooth(weights, deviations)
    np.divide(values, weights, out=values, where=finite)
    values[~finite] = np.nan
    return values


def _smooth(values: NDArray[Any], deviations: Sequence[float]) -> None:
    """Smooth finite values in place."""
    for axis, deviation in enumerate(deviations):
        kernel = _kernel(deviation)
        if len(kernel) == 1:
            continue
        # Along the axis first; cut across the longer of the other two.
        along = np.moveaxis(values, axis, 0)
        if axis == 2:
            along = along.swapaxes(1, 2)
        n_at_once = max(1, N_AT_ONCE // (along.shape[0] * along.shape[2]))
        for first in range(0, along.shape[1], n_at_once):
            part = along[:, first : first + n_at_once]
            part[...] = _along_first(part, kernel)


def _kernel(deviation: float) -> NDArray[np.float64]:
    """Half of the kernel, from the middle outwards; the whole has the sum 1."""
    reach = int(TRUNCATED * deviation + 0.5)
    if reach == 0:
        return np.ones(1)
    half = np.exp(-0.5 * (np.arange(reach + 1) / deviation) ** 2)
    whole = float(2 * half.sum() - half[0])
    return np.asarray(half / whole)


def _along_first(values: NDArray[Any], kernel: NDArray[np.float64]) -> NDArray[Any]:
    reach = len(kernel) - 1
    padded = np.concatenate([values[:1].repeat(reach, axis=0), values, values[-1:].repeat(reach, axis=0)])
    n = len(values)
    total: NDArray[Any] = padded[reach : reach + n] * values.dtype.type(kernel[0])
    both = np.empty_like(total)
    for k in range(1, reach + 1):
        np.add(padded[reach - k : reach - k + n], padded[reach + k : reach + k + n], out=both)
        both *= values.dtype.type(kernel[k])
        total += both
    return total
