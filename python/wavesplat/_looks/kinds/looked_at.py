"""The samples that decide the kind of data, with their neighbours; and their types of numbers."""

from __future__ import annotations

import math
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from wavesplat._model.lazy.survey import HISTOGRAM_SAMPLES, KIND_SAMPLES, step_for
from wavesplat._model.lazy.volume import LazyVolume
from wavesplat._model.volume.volume import Volume
from wavesplat._model.volume.wavelet_volume import WaveletVolume

# Whether samples are whole numbers, with or without a sign, or floating-point numbers: their type says it.
#
# It is the type that they have in memory, wherever they lie: 64-bit integers that are read in parts are read as
# float64.


def numbers_of(volume: Volume | WaveletVolume) -> str:
    """The kind of the samples' type, as NumPy names it: "u", "i" or "f", as coefficients of wavelets have it."""
    return "f" if isinstance(volume, WaveletVolume) else volume._type_in_memory.kind


# The samples that decide the kind of data, with their neighbours; non-finite samples count as missing.

#: The two neighbours of samples along each axis.
Pairs: TypeAlias = "list[tuple[NDArray[Any], NDArray[Any]]]"

#: Least number of finite samples among those spread evenly; where a volume has fewer, more are looked at.
MIN_FINITE = 10_000


def looked_at(volume: Volume | WaveletVolume) -> tuple[NDArray[Any], Pairs]:
    """Samples spread evenly over the volume, and their two neighbours along each axis that has any, all flat.

    Evenly and not by chance, so that a volume has the same look every time.
    """
    samples, neighbours = _spread_evenly(volume)
    if volume.n_nonfinite and np.count_nonzero(np.isfinite(samples)) < MIN_FINITE:
        return _finite_with_neighbours(subsampled(volume))
    return samples, neighbours


def subsampled(volume: Volume | WaveletVolume) -> NDArray[Any]:
    """Every n-th sample along each axis, [z, y, x], some millions at most."""
    return volume._every(step_for(math.prod(volume.shape), HISTOGRAM_SAMPLES))


def subsampled_as_float64(volume: Volume | WaveletVolume) -> NDArray[np.float64]:
    """The same samples as the compiled module takes them."""
    return np.ascontiguousarray(subsampled(volume), np.float64)


def _spread_evenly(volume: Volume | WaveletVolume) -> tuple[NDArray[Any], Pairs]:
    step = step_for(math.prod(volume.shape), KIND_SAMPLES)
    if isinstance(volume, LazyVolume) and (kept := volume._with_neighbours(step)) is not None:
        return kept
    if isinstance(volume, WaveletVolume | LazyVolume):
        return with_neighbours(volume._every(step), 1)
    return with_neighbours(volume.samples, step)


def with_neighbours(samples: NDArray[Any], step: int) -> tuple[NDArray[Any], Pairs]:
    """Every n-th sample [z, y, x] along each axis that has neighbours, and these, all flat."""
    inside = [slice(1, n - 1, step) if n >= 3 else slice(0, n, step) for n in samples.shape]
    pairs = []
    for axis, n in enumerate(samples.shape):
        if n >= 3:
            before, after = list(inside), list(inside)
            before[axis], after[axis] = slice(0, n - 2, step), slice(2, n, step)
            pairs.append((samples[tuple(before)].ravel(), samples[tuple(after)].ravel()))
    return samples[tuple(inside)].ravel(), pairs


def _finite_with_neighbours(samples: NDArray[Any]) -> tuple[NDArray[Any], Pairs]:
    """The finite samples [z, y, x], those of the border too, and their neighbours, which may be missing."""
    around = np.pad(samples, 1, constant_values=np.nan)
    places = np.argwhere(np.isfinite(around))
    places = places[:: max(1, len(places) // KIND_SAMPLES)]
    pairs = [(around[tuple((places - way).T)], around[tuple((places + way).T)]) for way in np.eye(3, dtype=np.int64)]
    return around[tuple(places.T)], pairs
