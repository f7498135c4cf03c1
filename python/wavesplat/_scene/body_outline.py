"""The outline of a patient on a slice: the air around the body, which what lies behind the slice shows through.

Air is what is darker than the body and reaches the border of the slice, not only through gaps, so that air inside, as
of the sinuses, and dark spots at the border belong to the body.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from wavesplat._looks.kinds import kind_of, offset_of
from wavesplat._model.volume import Volume
from wavesplat._model.wavelet_volume import WaveletVolume
from wavesplat._render import windows

#: Value between air and the body in a CT, Hounsfield units.
AIR_HU = -400.0
#: Value between air and the body in other scans, as a share of the way from dark to bright. (Two heads of T1: air has
#: up to 0.04, skin 0.3 and more.)
AIR_SHARE = 0.1
#: Half the width of gaps that air does not pass, as a share of the slice's longer side.
GAP_SHARE = 1 / 150

Mask = NDArray[np.bool_]


def least_of_body(volume: Volume | WaveletVolume) -> float | None:
    """Value above which samples of a patient's scan are of the body; None for other data."""
    if not volume.is_anatomical:
        return None
    if kind_of(volume) == "CT":
        return AIR_HU + offset_of(volume)
    low, high = windows.limits(volume, None, None)
    return low + AIR_SHARE * (high - low)


def air_around(values: NDArray[Any], least: float) -> Mask:
    """Pixels of a slice that are not above a value, and reach its border through pixels like them, not through gaps.

    values : array [row, column]; NaN, as outside of the volume, is air.
    """
    is_air: Mask = ~(values > least)
    n_gap = round(GAP_SHARE * max(values.shape))
    return _grown(_from_border(~_grown(~is_air, n_gap)), n_gap) & is_air


def _from_border(is_air: Mask) -> Mask:
    """The pixels that are connected, over sides, with the border."""
    found = np.zeros_like(is_air)
    for border in (np.s_[0], np.s_[-1], np.s_[:, 0], np.s_[:, -1]):
        found[border] = is_air[border]
    # In turns along rows and columns, a run of air is found as a whole as soon as one of its pixels is.
    n_found, n_unchanged, is_turned = np.count_nonzero(found), 0, False
    while n_unchanged < 2:
        found = _whole_runs(found.T, is_air.T).T if is_turned else _whole_runs(found, is_air)
        is_turned, before, n_found = not is_turned, n_found, np.count_nonzero(found)
        n_unchanged = n_unchanged + 1 if n_found == before else 0
    return found


def _grown(mask: Mask, n: int) -> Mask:
    """The mask and all within a square of `n` pixels to each side."""
    for axis in (0, 1):
        padded = np.pad(
            np.cumsum(mask, axis, dtype=np.int32), [(n + 1, n) if k == axis else (0, 0) for k in (0, 1)], "edge"
        )
        padded = np.moveaxis(padded, axis, 0)
        padded[: n + 1] = 0
        mask = np.moveaxis(padded[2 * n + 1 :] > padded[: -2 * n - 1], 0, axis)
    return mask


def _whole_runs(found: Mask, is_air: Mask) -> Mask:
    """The runs of air along rows that have a pixel which is found."""
    is_first = is_air.copy()
    is_first[:, 1:] &= ~is_air[:, :-1]
    number = np.cumsum(is_first.ravel()).reshape(is_air.shape)
    is_reached = np.zeros(int(number.flat[-1]) + 1, bool)
    is_reached[number[found]] = True
    return is_reached[number] & is_air
