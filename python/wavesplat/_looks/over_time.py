"""The time point of a series that its look is made for: one for all times, so that nothing flickers."""

from __future__ import annotations

import numpy as np

from wavesplat._looks.histogram import finite_samples
from wavesplat._model.series import Series
from wavesplat._model.volume import Volume

__all__ = ["brightest"]

#: Percentile of a volume's samples that measures how bright it is.
PERCENT = 99.5


def brightest(series: Series) -> Volume:
    """The brightest of the first, the middle and the last volume; found once.

    With a look made for the brightest nothing is clipped, and a contrast agent shows.
    """
    if series._brightest is None:
        n = len(series)
        ends = {number: _end(series[number]) for number in sorted({0, n // 2, n - 1})}
        series._brightest = series[max(ends, key=lambda number: ends[number])]
    return series._brightest


def _end(volume: Volume) -> float:
    values = finite_samples(volume)
    return float(np.percentile(values, PERCENT)) if values.size else -np.inf
