"""The order in which rays of an eye pass through boxes that do not overlap.

A plane between two boxes shows which of them cannot hide the other: the one behind it, seen from the eye. With planes
along several axes between them it may be both, and then no ray meets both. A picture of many boxes needs an order that
is right for every pair. There is none where boxes lie around each other in a ring, which grids and trees of boxes
never do.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from wavesplat.errors import ArgumentError

Corners = NDArray[np.float64]


def front_to_back(lows: Corners, highs: Corners, eye: Sequence[float], *, is_direction: bool) -> list[int]:
    """Numbers of the boxes, each before all boxes that it hides from the eye.

    A topological sort: a box is taken once every box that may hide it is taken, so the order is right for each pair. A
    round in which no box is free proves a ring.

    Parameters
    ----------
    lows, highs : arrays, shape (n, 3)
        Corners of the boxes, which may share faces, but must not overlap.
    eye : three numbers
        Place of the eye among the boxes or, where it `is_direction`, the direction of parallel rays, away from it.

    Raises
    ------
    ArgumentError
        If boxes lie around each other in a ring, so that each hides the next.
    """
    hides = _may_hide(lows, highs, eye, is_direction=is_direction)
    n_in_front = hides.sum(axis=0)
    left = np.ones(len(lows), bool)
    order: list[int] = []
    while left.any():
        free = np.flatnonzero(left & (n_in_front == 0))
        if not len(free):
            ring = ", ".join(str(k) for k in np.flatnonzero(left)[:6])
            raise ArgumentError(
                f"boxes lie around each other in a ring, so that each hides the next from this eye: numbers {ring}; "
                "cut the volume into a grid or a tree of boxes"
            )
        order += free.tolist()
        left[free] = False
        n_in_front -= hides[free].sum(axis=0)
    return order


def _may_hide(lows: Corners, highs: Corners, eye: Sequence[float], *, is_direction: bool) -> NDArray[np.bool_]:
    """Whether a ray may pass through box i, then through box j, [i, j]."""
    hides = ~np.eye(len(lows), dtype=bool)
    for axis in range(3):
        is_below = highs[:, None, axis] <= lows[None, :, axis]
        # Whether the eye is on the lower side of some plane between the two, or on the upper side.
        from_below, from_above = np.array(eye[axis] >= 0), np.array(eye[axis] <= 0)
        if not is_direction:
            from_below, from_above = eye[axis] <= lows[None, :, axis], eye[axis] >= highs[:, None, axis]
        hides &= ~(is_below & from_above)
        hides &= ~(is_below & from_below).T
    return hides
