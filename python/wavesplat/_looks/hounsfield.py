"""Whether values are Hounsfield units.

A CT has both fixed points of the scale, air near -1000 and soft tissue near 0, next to nothing below air but a padding
value, few values as far above 0 as air is below, and less bone than soft tissue. Signed fields of simulations and noise
of the same size lack one of the three: they go on below -1100, are as frequent on both sides, or are flat above 0.
(`python studies/looks/hounsfield.py FILE ...` prints the numbers. Four CTs: none below -1100, 0.002 to 0.05 times as
many samples above 900 as below -900, soft tissue 15 to 37 times as dense as bone. Noise of deviation 400: 0.3 % below
-1100, 1.01 times, 1.4 times.)
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from wavesplat._model.wavelet_volume import WaveletVolume

if TYPE_CHECKING:
    from wavesplat._model.volume import Volume

#: Least shares of samples within 200 of air (-1000) and of soft tissue (0).
MIN_SHARE = 0.02
#: Lowest value of air with its noise, and largest share of samples below that where they are no padding.
AIR, MAX_BELOW = -1100.0, 0.001
#: Values that padding may have.
N_PADDINGS = 2
#: Samples beyond this on both sides of 0, and their largest ratio, above to below.
FAR, MAX_ABOVE = 900.0, 0.3
#: Ranges of soft tissue and of bone, and the least ratio of their densities.
SOFT_TISSUE, BONE, MIN_SOFT = (-150.0, 150.0), (200.0, 500.0), 2.0


def looks_like_hounsfield(values: NDArray[Any], volume: Volume | WaveletVolume) -> bool:
    """Whether finite values of a volume look like Hounsfield units.

    Of a file that says CT, air and soft tissue are enough. Values between whole numbers speak against it, but for scans
    of patients, which may be resampled, and for wavelets, which round.
    """
    if not values.size or min(np.mean(np.abs(values - value) < 200) for value in (-1000.0, 0.0)) <= MIN_SHARE:
        return False
    if volume.modality == "CT":
        return True
    may_be_fractional = volume.is_anatomical or isinstance(volume, WaveletVolume)
    if not may_be_fractional and not np.all(values == np.round(values)):
        return False
    below = values[values < AIR]
    # Padding is a value or two, with others between them and air where a scan was resampled; noise has no such peak.
    padding = np.sort(np.unique(below, return_counts=True)[1])[-N_PADDINGS:].sum() if below.size else 0
    n_below = 0 if 2 * padding > below.size else below.size
    if n_below > MAX_BELOW * values.size or np.sum(values > FAR) > MAX_ABOVE * np.sum(values < -FAR):
        return False
    soft, bone = (np.mean((values >= low) & (values < high)) for low, high in (SOFT_TISSUE, BONE))
    return bool(soft >= MIN_SOFT * bone)
