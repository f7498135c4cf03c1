"""Maps of shares: fractional anisotropy (FA), and probabilities, recognized by name and values.

Neither has a field in NIfTI that programs fill, so each is a guess, and is said to be one.

- FA is at most the square root of 3/2, which tensors with a negative eigenvalue reach in noise, and mostly below a
  third of that. Above 1, that range is its own. Clipped to 1, the rim that noise makes is a heap at 1 above a gap,
  which a scan that is clipped at a percentile has not. Else the name must say FA, as a scan normalised to 1 has it too.
- Probabilities of tissue are mostly near their ends. Scans that are normalised to 1 are mostly between them.
- Probabilities of a lesion, or of one structure of an atlas, are 0 in nearly all of the volume.
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Literal, TypeAlias

import numpy as np
from numpy.typing import NDArray

from wavesplat._looks.number_types import numbers_of

if TYPE_CHECKING:
    from wavesplat._model.volume import Volume
    from wavesplat._model.wavelet_volume import WaveletVolume

#: Largest anisotropy, and largest median of it inside the brain. (FSL's FA of a brain: 0.18.)
MAX_FA, MAX_MEDIAN_FA = 1.2248, 0.45
#: FA clipped to 1: largest median and 90th percentile of what is not 0, least share of exactly 0 outside of the brain,
#: least share of exactly 1, and the value from which on less than that lies below 1. (FSL's FA of a brain, clipped: see
#: `test_derived_maps`. Nine MR scans clipped at percentiles 98 and 99.9: none fits, four by the gap alone.)
MAX_MEDIAN_CLIPPED, MAX_UPPER_CLIPPED, MIN_OUTSIDE, MIN_HEAP, GAP_FROM = 0.3, 0.75, 0.3, 2e-4, 0.9
#: Least value of shares, which splines overshoot, and the value that no share reaches.
LEAST, ABOVE_SHARES = -0.05, 1.1
#: Largest value of shares in per cent.
PER_CENT = 100.0
#: Value from which on a share counts as not 0, and the largest share of the volume that such values of a lesion have.
#: (A stroke: 0.09; a hippocampus: 0.03; fractional anisotropy: 0.23; heads: 0.38 and more.)
NOT_ZERO, MAX_SMALL = 0.02, 0.1
#: Values near 1 and values in between, least share of the former among those that are not 0, and their least ratio.
#: (Grey and white matter: shares 0.33 to 0.44, ratios 1.8 to 2.3; heads: at most 0.23 and 0.9; CT windowed: 0.06.)
NEAR_ONE, BETWEEN, MIN_NEAR_ONE, MIN_RATIO = 0.9, (0.3, 0.7), 0.25, 1.5
#: Largest share of the volume that tissue has.
MAX_FULL = 0.8
#: Words of names.
FA_WORDS = {"fa"}
PROBABILITY_WORDS = {"prob", "probs", "probability", "probseg", "probmap", "posterior", "posteriors", "pve", "tpm"}

Found: TypeAlias = "tuple[Literal['FA', 'probability'], str] | None"


def share_kind(volume: Volume | WaveletVolume, values: NDArray[np.float64]) -> Found:
    """Whether a patient's volume holds fractional anisotropy or probabilities, and why; None for other volumes.

    values : samples spread over the volume, finite.
    """
    low, high = volume.value_range
    words = set(re.split(r"[^a-z0-9]+", volume.name.lower()))
    if not low >= LEAST or not high > 0:
        return None
    if words & PROBABILITY_WORDS and high <= PER_CENT:
        return "probability", f"probabilities up to {high:.3g}, by the file's name and by the values"
    if high > MAX_FA or numbers_of(volume) != "f":
        return None
    found = values[values > NOT_ZERO * high]
    if found.size and _is_clipped_anisotropy(values, found, high):
        return "FA", "fractional anisotropy: mostly small, with a heap at 1 to which it is clipped, by the values"
    return _anisotropy(found, high, words) or _probability(found, high, values.size)


def _anisotropy(found: NDArray[np.float64], high: float, words: set[str]) -> Found:
    """See `share_kind`. found : samples that are not 0. high : the largest value. words : words of the file's name."""
    if not found.size or np.median(found) > MAX_MEDIAN_FA:
        return None
    if words & FA_WORDS:
        return "FA", "fractional anisotropy, by the file's name and by the values"
    if high > ABOVE_SHARES:
        return "FA", f"fractional anisotropy: mostly small, and up to {high:.3g}, by the values"
    return None


def _is_clipped_anisotropy(values: NDArray[np.float64], found: NDArray[np.float64], high: float) -> bool:
    """Whether samples look like anisotropy that was clipped to 1. found : the `values` that are not 0."""
    if high != 1 or np.mean(values == 0) < MIN_OUTSIDE:
        return False
    median, upper = np.percentile(found, (50.0, 90.0))
    heap, below = np.mean(found == 1), np.mean((found > GAP_FROM) & (found < 1))
    return bool(median <= MAX_MEDIAN_CLIPPED and upper <= MAX_UPPER_CLIPPED and heap >= MIN_HEAP and heap > below)


def _probability(found: NDArray[np.float64], high: float, n_values: int) -> Found:
    """See `share_kind`. found : samples that are not 0, of `n_values`. high : the largest value."""
    if high > ABOVE_SHARES:
        return None
    near_one = float(np.mean(found > NEAR_ONE)) if found.size else 0.0
    between = float(np.mean((found > BETWEEN[0]) & (found < BETWEEN[1]))) if found.size else 0.0
    # Of p-values, which are near 1 nearly everywhere, nothing could be seen.
    if near_one >= max(MIN_NEAR_ONE, MIN_RATIO * between) and found.size <= MAX_FULL * n_values:
        return "probability", "probabilities: from 0 to 1, mostly near one of them, by the values"
    if found.size < MAX_SMALL * n_values:
        return "probability", "probabilities, or other shares of 1, in a small part of the volume, by the values"
    return None
