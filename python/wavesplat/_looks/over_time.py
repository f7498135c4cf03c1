"""Which time point of a series its look is made for, so that all times have one, and nothing flickers."""

from __future__ import annotations

import numpy as np

from wavesplat._looks.histogram import finite_samples
from wavesplat._model.series import Series
from wavesplat._model.volume import Volume

__all__ = ["brightest"]

#: What few samples exceed.
PERCENT = 99.5


def brightest(series: Series) -> Volume:
    """The brightest of the first, the middle and the last volume; found once.

    Of the brightest nothing is clipped, and a contrast agent shows.
    """
    if series._brightest is None:
        n = len(series)
        ends = {number: _end(series[number]) for number in sorted({0, n // 2, n - 1})}
        series._brightest = series[max(ends, key=lambda number: ends[number])]
    return series._brightest


def _end(volume: Volume) -> float:
    values = finite_samples(volume)
    return float(np.percentile(values, PERCENT)) if values.size else -np.inf
