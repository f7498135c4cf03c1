"""Maps of what was calculated from scans of patients: diffusion, relaxation, perfusion, statistics, p-values, uptake.

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

from wavesplat._looks.number_types import numbers_of
from wavesplat._model import quantities as q

if TYPE_CHECKING:
    from wavesplat._model.volume import Volume
    from wavesplat._model.wavelet_volume import WaveletVolume

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
