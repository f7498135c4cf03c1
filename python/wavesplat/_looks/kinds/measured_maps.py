"""Maps of what was calculated from scans: diffusion, perfusion, statistics, and shares such as FA.

A file says what a map holds by its quantity (the intent of NIfTI, the image type of DICOM). Otherwise it is guessed by
words of the file's name, as BIDS, FSL, SPM and FreeSurfer write them. By values alone, two kinds are recognized:

- Diffusivities in mm²/s are floating-point numbers up to 0.001 at least and 0.02 at most: water in a body has 0.003.
- p-values are near 1 nearly everywhere, outside of the body too, and fall to near 0 somewhere.

Relaxation times and perfusion without a name look like scans of their own contrast, and stay such.
"""

from __future__ import annotations

import itertools
import re
from typing import TYPE_CHECKING, Literal, TypeAlias

import numpy as np
from numpy.typing import NDArray

from wavesplat._looks.kinds.looked_at import numbers_of
from wavesplat._model.volume import facts as q

if TYPE_CHECKING:
    from wavesplat._model.volume.volume import Volume
    from wavesplat._model.volume.wavelet_volume import WaveletVolume

#: Quantities by the words that name them alone.
BY_WORD = {
    **dict.fromkeys(("adc", "adcmap"), q.ADC),
    **dict.fromkeys(("t1map", "t1mapping", "qt1"), q.T1),
    **dict.fromkeys(("t2map", "t2mapping", "qt2"), q.T2),
    **dict.fromkeys(("t2starmap", "t2smap", "qt2star"), q.T2_STAR),
    **dict.fromkeys(("cbf", "rcbf", "relcbf", "cbfmap"), q.BLOOD_FLOW),
    **dict.fromkeys(("cbv", "rcbv", "relcbv", "cbvmap"), q.BLOOD_VOLUME),
    **dict.fromkeys(("mtt", "relmtt", "ttp", "tmax"), q.PERFUSION),
    **dict.fromkeys(("zstat", "zscore", "zmap", "zfstat"), q.Z_STATISTIC),
    **dict.fromkeys(("tstat", "tscore", "tmap", "spmt"), q.T_STATISTIC),
    **dict.fromkeys(("fstat", "spmf"), q.F_STATISTIC),
}
#: Quantities by a short word, which needs another one beside it: "T1_map", "dti_MD".
BY_TWO_WORDS = {
    **{(word, "map"): of for word, of in (("t1", q.T1), ("t2", q.T2), ("t2star", q.T2_STAR))},
    **dict.fromkeys(itertools.product(("md", "ad", "rd"), ("map", "dti", "dki", "dwimap", "tensor")), q.DIFFUSIVITY),
}
#: Names of p-values, alone or in two words, and of 1 - p, as FSL's randomise writes them.
P_WORDS, P_PAIRS = {"pval", "pvals", "pvalue", "pvalues"}, ({"p", "value"}, {"p", "values"}, {"p", "val"})
ONE_MINUS_P_WORDS = {"corrp"}
#: Names of uptake values.
UPTAKE_WORDS = {"suv", "suvbw", "suvlbm", "suvr"}
#: The largest p that counts as significant, and the least share of zeros that are the outside of a mask.
SIGNIFICANT, MIN_MASKED = 0.05, 0.2
#: Largest value of diffusivities in mm²/s: least of maps of a body, which has water, and most, with noise.
MIN_DIFFUSIVITY, MAX_DIFFUSIVITY = 0.001, 0.02
#: Values that count as near 1, and the least share of them among p-values.
NEAR_ONE, MIN_NEAR_ONE = 0.9, 0.7
#: Longest word whose number at the end is a part of it, as in "T2".
LONGEST_SHORT = 3

Found: TypeAlias = "tuple[Literal['map', 'p-values', 'probability', 'PET'], str] | None"


def map_kind(volume: Volume | WaveletVolume, values: NDArray[np.float64]) -> Found:
    """Whether a patient's volume holds a calculated map, and why; None for other volumes.

    values : samples spread over the volume, finite.
    """
    if not volume.is_anatomical or volume.modality not in (None, "MR") or not values.size:
        return None
    low, high = volume.value_range
    quantity = volume.facts.quantity
    if quantity == q.P_VALUE and 0 <= low <= high <= 1:
        return _p_values(values, "the file says so")
    if quantity in q.QUANTITIES and low >= 0:
        return "map", f"a map of the {quantity}: the file says so"
    if volume.modality is None and (found := _by_words(_words_of(volume.name), values, low, high)) is not None:
        return found
    if low < 0 or numbers_of(volume) != "f":
        return None
    if MIN_DIFFUSIVITY <= high <= MAX_DIFFUSIVITY:
        return "map", f"a map of diffusion in mm²/s: up to {high:.2g}, by the values"
    if high <= 1 and low < SIGNIFICANT and np.mean(values > NEAR_ONE) >= MIN_NEAR_ONE:
        return "p-values", "p-values: near 1 nearly everywhere, and near 0 somewhere, by the values"
    return None


def _words_of(name: str) -> set[str]:
    """The words of a name in small letters, and each without the number at its end ("zstat1")."""
    words = {word for word in re.split(r"[^a-z0-9]+", name.lower()) if word}
    return words | {word.rstrip("0123456789") for word in words if len(word) > LONGEST_SHORT}


def _by_words(words: set[str], values: NDArray[np.float64], low: float, high: float) -> Found:
    """The kind by words of a name, if the values can be of that kind."""
    by = "by the file's name and by the values"
    if low < 0:
        return None  # values with two signs are statistics, recognized elsewhere
    if high <= 1 and words & ONE_MINUS_P_WORDS:
        return "probability", f"1 - p of a test, {by}"
    if high <= 1 and (words & P_WORDS or any(pair <= words for pair in P_PAIRS)):
        return _p_values(values, by)
    if words & UPTAKE_WORDS:
        return "PET", f"PET in SUV, {by}"
    found = next((BY_WORD[word] for word in sorted(words) if word in BY_WORD), None)
    found = found or next((of for (one, other), of in BY_TWO_WORDS.items() if {one, other} <= words), None)
    return None if found is None else ("map", f"a map of the {found}, {by}")


def _p_values(values: NDArray[np.float64], by: str) -> Found:
    if np.mean(values == 0) < MIN_MASKED:
        return "p-values", f"p-values, {by}"
    # Between 0 and the p of the rim, values pass through significant ones.
    return "map", f"p-values with 0 outside of a mask, which would show as significant, so high ones show; {by}"


# Maps of shares: fractional anisotropy (FA), and probabilities, recognized by name and values.
#
# Neither has a field in NIfTI that programs fill, so each is a guess, and is said to be one.
#
# - FA is at most the square root of 3/2, which tensors with a negative eigenvalue reach in noise, and mostly below a
# third of that. Above 1, that range is its own. Clipped to 1, the rim that noise makes is a heap at 1 above a gap,
# which a scan that is clipped at a percentile has not. Else the name must say FA, as a scan normalised to 1 has it too.
# - Probabilities of tissue are mostly near their ends. Scans that are normalised to 1 are mostly between them. -
# Probabilities of a lesion, or of one structure of an atlas, are 0 in nearly all of the volume.

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
SHARE_NEAR_ONE, BETWEEN, MIN_SHARE_NEAR_ONE, MIN_RATIO = 0.9, (0.3, 0.7), 0.25, 1.5
#: Largest share of the volume that tissue has.
MAX_FULL = 0.8
#: Words of names.
FA_WORDS = {"fa"}
PROBABILITY_WORDS = {"prob", "probs", "probability", "probseg", "probmap", "posterior", "posteriors", "pve", "tpm"}

FoundShare: TypeAlias = "tuple[Literal['FA', 'probability'], str] | None"


def share_kind(volume: Volume | WaveletVolume, values: NDArray[np.float64]) -> FoundShare:
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


def _anisotropy(found: NDArray[np.float64], high: float, words: set[str]) -> FoundShare:
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


def _probability(found: NDArray[np.float64], high: float, n_values: int) -> FoundShare:
    """See `share_kind`. found : samples that are not 0, of `n_values`. high : the largest value."""
    if high > ABOVE_SHARES:
        return None
    near_one = float(np.mean(found > SHARE_NEAR_ONE)) if found.size else 0.0
    between = float(np.mean((found > BETWEEN[0]) & (found < BETWEEN[1]))) if found.size else 0.0
    # Of p-values, which are near 1 nearly everywhere, nothing could be seen.
    if near_one >= max(MIN_SHARE_NEAR_ONE, MIN_RATIO * between) and found.size <= MAX_FULL * n_values:
        return "probability", "probabilities: from 0 to 1, mostly near one of them, by the values"
    if found.size < MAX_SMALL * n_values:
        return "probability", "probabilities, or other shares of 1, in a small part of the volume, by the values"
    return None
