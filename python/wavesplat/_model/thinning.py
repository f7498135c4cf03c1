"""Thinning of samples for automatic looks, kinds of data and cameras: every n-th along each axis.

The survey of a lazy volume keeps exactly these (`survey.py`), so that they are read once for all of them.
"""

from __future__ import annotations

import math

#: Samples at most for histograms, percentiles and cameras (enough for steady percentiles, and a fraction of a second on
#: any volume); for the kind of data, each with its neighbours along the axes; for the unit, which every picture needs.
HISTOGRAM_SAMPLES, KIND_SAMPLES, UNIT_SAMPLES = 2_000_000, 150_000, 20_000


def step_for(n_samples: int, most: int) -> int:
    """The step from one sample to the next along each axis that leaves about `most` of them."""
    return max(1, math.ceil(math.pow(n_samples / most, 1 / 3)))
