"""Curves as VTK, and so 3D Slicer and ParaView, keep them: nodes with a midpoint and a sharpness.

Half way to the next node's value the curve is at `midpoint` of the way there, and `sharpness` leads from a line (0) to
a step (1). Nearly all curves have midpoint 0.5 and sharpness 0 and are lines; what bends is drawn by short lines.
Source: the documentation and the behaviour of `vtkPiecewiseFunction`, VTK 9.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

#: Sharpness below which a piece is a line, and above which it is a step.
LINE, STEP = 0.01, 0.99
#: Number of lines for a bent piece.
N_LINES = 32


def line_nodes(nodes: Iterable[Sequence[float]]) -> list[tuple[float, ...]]:
    """Nodes (x, y, ..., midpoint, sharpness), in any order, as nodes (x, y, ...) of lines."""
    table = sorted((tuple(float(number) for number in node) for node in nodes), key=lambda node: node[0])
    found: list[tuple[float, ...]] = [node[:-2] for node in table[:1]]
    for (*first, midpoint, sharpness), (*second, _, _) in pairwise(table):
        if sharpness > STEP:
            x = first[0] + midpoint * (second[0] - first[0])
            found += [(x, *first[1:]), (x, *second[1:])]
        elif sharpness >= LINE or midpoint != 0.5:
            # A pair of lines needs only its middle node, which may lie elsewhere than half way.
            parts = np.array([midpoint]) if sharpness < LINE else np.linspace(0, 1, N_LINES + 1)[1:-1]
            for part, way in zip(parts, way_between(parts, midpoint, sharpness), strict=True):
                x = first[0] + float(part) * (second[0] - first[0])
                found.append((x, *(a + float(way) * (b - a) for a, b in zip(first[1:], second[1:], strict=True))))
        found.append(tuple(second))
    return found


def way_between(part: NDArray[np.float64], midpoint: float, sharpness: float) -> NDArray[np.float64]:
    """Share of the way from one node's value to the next, 0..1, at a part of the distance, 0..1."""
    midpoint = min(max(midpoint, 1e-5), 1 - 1e-5)
    part = np.where(part < midpoint, 0.5 * part / midpoint, 0.5 + 0.5 * (part - midpoint) / (1 - midpoint))
    if sharpness < LINE:
        return part
    if sharpness > STEP:
        return (part >= 0.5).astype(np.float64)
    power = 1 + 10 * sharpness
    part = np.where(part < 0.5, 0.5 * (2 * part) ** power, 1 - 0.5 * np.abs(2 * (1 - part)) ** power)
    # A cubic Hermite curve whose slopes at both ends, 1 - sharpness, flatten it.
    slope = (1 - sharpness) * ((part**3 - 2 * part**2 + part) + (part**3 - part**2))
    return np.clip(3 * part**2 - 2 * part**3 + slope, 0, 1)
