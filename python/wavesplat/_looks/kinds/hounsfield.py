"""Hounsfield units: whether values are some, also where 1000 or 1024 was added to them.

Such a scan has no negative value, air at 0 (or 24) and two narrow peaks, fat and soft tissue, about 100 apart below and
at the offset. MR has broad peaks at any place. The values of air decide between the two offsets; with little air the
offset may be wrong by 24.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from wavesplat._model.volume.wavelet_volume import WaveletVolume

if TYPE_CHECKING:
    from wavesplat._model.volume.volume import Volume

# Whether values are Hounsfield units.
#
# A CT has both fixed points of the scale, air near -1000 and soft tissue near 0, next to nothing below air but a
# padding value, few values as far above 0 as air is below, and less bone than soft tissue. Signed fields of simulations
# and noise of the same size lack one of the three: they go on below -1100, are as frequent on both sides, or are flat
# above 0. (`python studies/looks/hounsfield.py FILE ...` prints the numbers. Four CTs: none below -1100, 0.002 to 0.05
# times as many samples above 900 as below -900, soft tissue 15 to 37 times as dense as bone. Noise of deviation 400:
# 0.3 % below -1100, 1.01 times, 1.4 times.)

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


# CT whose values are Hounsfield units with 1000 or 1024 added, as scanners and old programs store them.

#: Values that 0 Hounsfield units may be stored as.
OFFSETS = (1000.0, 1024.0)
#: Ranges of fat and of soft tissue, and the value above which samples are of the body, Hounsfield units.
FAT, STORED_SOFT_TISSUE, BODY = (-140.0, -50.0), (-20.0, 110.0), -400.0
#: Least shares of air and of the body among the samples; crops have little air.
MIN_AIR, MIN_BODY = 0.003, 0.02
#: Pairs of the least share of each peak in the body and of both: there is little fat in a head or a chest. Of 48 crops
#: of three CTs 37 are found, and 26 by the first pair with at least 2 % of air. Of 760 cases that are no CT, 19 volumes
#: multiplied by 40 factors each, the second pair alone takes none for CT, and the first pair with 2 % of air takes 4
#: (an engine and a mean head). The two pairs together were not counted.
MIN_PEAKS = ((0.05, 0.55), (0.025, 0.7))
#: Most values per unit below fat and above soft tissue, as a share of those in the larger peak.
MAX_BESIDE = 0.35
#: Least share of values above 200 Hounsfield units, bone or contrast medium, in the body.
MIN_BONE = 0.003
#: Air of an offset of 1024 is at 24: fewer of the values 1 to 48 than this share are below 12, where air of 1000 is.
AIR_SHARE = 0.2
#: Most samples of 0 for each of air, where 0 is padding outside of a round field of view.
MAX_PADDING = 4.0


def stored_offset(values: NDArray[Any]) -> float:
    """The number that seems to be added to Hounsfield units, 1000 or 1024; 0 if the values do not look like CT."""
    finite = values[np.isfinite(values)]
    if finite.size == 0 or finite.min() < 0 or finite.max() < OFFSETS[0] + 200:
        return 0.0
    # Padding is 0 for both; where there is far more of it than of air, it is air.
    near_air = finite[(finite > 0) & (finite < 48)]
    is_air = near_air.size < np.count_nonzero(finite == 0) / MAX_PADDING
    is_1024 = near_air.size > 0 and not is_air and np.mean(near_air < 12) < AIR_SHARE
    offset = OFFSETS[1] if is_1024 else OFFSETS[0]
    units = finite - offset
    body = units[units > BODY]
    if body.size < MIN_BODY * units.size or np.mean(units < -900) < MIN_AIR:
        return 0.0

    def share(low: float, high: float) -> float:
        return float(np.mean((body >= low) & (body <= high)))

    fat, soft = share(*FAT), share(*STORED_SOFT_TISSUE)
    has_peaks = any(min(fat, soft) >= each and fat + soft >= both for each, both in MIN_PEAKS)
    if not has_peaks or share(200.0, np.inf) < MIN_BONE:
        return 0.0
    density = max(fat / (FAT[1] - FAT[0]), soft / (STORED_SOFT_TISSUE[1] - STORED_SOFT_TISSUE[0]))
    beside = max(share(-300.0, -180.0) / 120.0, share(150.0, 270.0) / 120.0)
    return offset if beside < MAX_BESIDE * density else 0.0
