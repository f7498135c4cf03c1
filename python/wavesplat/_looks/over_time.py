"""The time point of a series that its look is made for: one for all times, so that nothing flickers."""

from __future__ import annotations

import numpy as np

from wavesplat._looks.kinds.histogram import finite_samples
from wavesplat._model.volume.series import Series
from wavesplat._model.volume.volume import Volume
from wavesplat._model.volume.wavelet_volume import WaveletVolume

#: Percentile of a volume's samples that measures how bright it is.
PERCENT = 99.5


def brightest(series: Series) -> Volume:
    """The brightest of the first, the middle and the last volume; found once.

    With a look made for the brightest nothing is clipped, and a contrast agent shows.
    """
    return _found(series)[1]


def brightest_number(series: Series) -> int:
    """Number of the volume that looks are made for."""
    return _found(series)[0]


def sampled_numbers(series: Series) -> list[int]:
    """Numbers of the first, the middle and the last volume."""
    n = len(series)
    return sorted({0, n // 2, n - 1})


def _found(series: Series) -> tuple[int, Volume]:
    if series._brightest is None:
        ends = {number: bright_end(series[number]) for number in sampled_numbers(series)}
        number = max(ends, key=lambda number: ends[number])
        series._brightest = number, series[number]
    return series._brightest


def bright_end(volume: Volume | WaveletVolume) -> float:
    """The value that few samples exceed."""
    values = finite_samples(volume)
    return float(np.percentile(values, PERCENT)) if values.size else -np.inf
