"""Hounsfield units: whether values are some, also where 1000 or 1024 was added to them.

The compiled module decides (`crates/look`: `hounsfield.rs`).
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from wavesplat import _native
from wavesplat._model.volume.wavelet_volume import WaveletVolume

if TYPE_CHECKING:
    from wavesplat._model.volume.volume import Volume


def looks_like_hounsfield(values: NDArray[np.float64], volume: Volume | WaveletVolume) -> bool:
    """Whether finite values of a volume, flat, look like Hounsfield units.

    Of a file that says CT, air and soft tissue are enough. Values between whole numbers speak against it, but for scans
    of patients, which may be resampled, and for wavelets, which round.
    """
    may_be_fractional = volume.is_anatomical or isinstance(volume, WaveletVolume)
    return _native.looks_like_hounsfield(values, volume.modality == "CT", may_be_fractional)


def stored_offset(values: NDArray[np.float64]) -> float:
    """The number that seems to be added to Hounsfield units, 1000 or 1024; 0 if the values do not look like CT."""
    return _native.stored_offset(values.ravel())
