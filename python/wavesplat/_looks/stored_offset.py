"""CT whose values are Hounsfield units with 1000 or 1024 added, as scanners and old programs store them.

Such a scan has no negative value, air at 0 (or 24) and two narrow peaks, fat and soft tissue, about 100 apart below and
at the offset. MR has broad peaks at any place: of four scans of MR and a PET, each scaled by 60 factors, none is taken
for CT. Which of the two offsets it is, is told by the air; where there is but little, it may be wrong by 24.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

__all__ = ["stored_offset"]

#: Values that 0 Hounsfield units may be stored as.
OFFSETS = (1000.0, 1024.0)
#: Ranges of fat and of soft tissue, and the value above which samples are of the body, Hounsfield units.
FAT, SOFT_TISSUE, BODY = (-140.0, -50.0), (-20.0, 110.0), -400.0
#: Least share of air, of which crops have little, and of the body.
MIN_AIR, MIN_BODY = 0.003, 0.02
#: Least share of each peak in the body, with the least share of both: there is little fat in a head, or in a chest. (Of
#: 48 crops of three CTs 37 are told, 26 with the first pair and air of 0.02 alone; 4 of 19 other volumes x 40
#: factors are taken for CT, as with the first pair: an engine and a mean head, each with factors of no use.)
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
    """The offset of what seem to be Hounsfield units, 1000 or 1024; 0 where they do not seem to be."""
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

    fat, soft = share(*FAT), share(*SOFT_TISSUE)
    has_peaks = any(min(fat, soft) >= each and fat + soft >= both for each, both in MIN_PEAKS)
    if not has_peaks or share(200.0, np.inf) < MIN_BONE:
        return 0.0
    density = max(fat / (FAT[1] - FAT[0]), soft / (SOFT_TISSUE[1] - SOFT_TISSUE[0]))
    beside = max(share(-300.0, -180.0) / 120.0, share(150.0, 270.0) / 120.0)
    return offset if beside < MAX_BESIDE * density else 0.0
