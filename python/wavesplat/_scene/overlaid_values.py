"""The values of a volume over a slice of another one, in the colours of their look."""

from __future__ import annotations

from itertools import pairwise
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from wavesplat._looks.transfer_function import TransferFunction

Floats: TypeAlias = NDArray[np.float32]

#: Pixels that are mixed at once: their colours, in float64, take little memory.
PIXELS_AT_ONCE = 1 << 18


def laid_over(rgba: Floats, values: Floats, curves: TransferFunction, opacity: float) -> tuple[Floats, bool]:
    """The picture with the colours of values laid over it, and whether they show anywhere."""
    most = max(alpha for _, alpha in curves.opacity)
    mixed, is_seen = np.array(rgba), False
    if most == 0:
        return mixed, False
    lowest = clear_below(curves)
    rows = max(1, PIXELS_AT_ONCE // values.shape[1])
    for start in range(0, len(values), rows):
        part, below = values[start : start + rows], mixed[start : start + rows]
        over = curves(part.ravel()).reshape(*part.shape, 4)
        seen = np.isfinite(part) & (part >= lowest) & (over[..., 3] > 0)
        alpha = np.where(seen, opacity * over[..., 3] / most, 0.0)[..., None]
        over[..., 3] = 1.0
        below[:] = np.where(seen[..., None], over * alpha + (1 - alpha) * below, below)
        is_seen = is_seen or bool(seen.any())
    return mixed, is_seen


def clear_below(curves: TransferFunction) -> float:
    """The value below which nothing shows: the low end, unless less is more there, as in maps of two signs."""
    alphas = [alpha for _, alpha in curves.opacity]
    if any(low > high for low, high in pairwise(alphas)):
        return -np.inf
    return min(node[0] for node in (*curves.opacity, *curves.color))
