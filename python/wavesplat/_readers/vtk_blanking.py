"""Points and cells that VTK's files hide, as of bodies in a flow and of cells that a finer grid covers.

An array of bytes says it of each: https://vtk.org/doc/nightly/html/classvtkDataSetAttributes.html, "CellGhostTypes".
Points and cells that are only copies of another block's are shown.
"""

from __future__ import annotations

from itertools import product
from typing import Any

import numpy as np
from numpy.typing import NDArray

#: The name of such an array.
GHOSTS = "vtkGhostType"
#: Bits of its bytes: a hidden point, and a cell that is refined or hidden.
HIDDEN_POINT, HIDDEN_CELL = 2, 8 | 32


def without_hidden(
    samples: NDArray[Any], of_points: NDArray[Any] | None, of_cells: NDArray[Any] | None, *, are_cells: bool
) -> tuple[NDArray[Any], tuple[str, ...]]:
    """The samples with NaN where they are hidden, and a sentence on that.

    samples : [z, y, x] of points, or of cells (`are_cells`). of_points, of_cells : ghost types of the same order.
    A point is hidden where all cells around it are.
    """
    hidden = np.zeros(samples.shape, bool)
    if are_cells and of_cells is not None:
        hidden |= (of_cells & HIDDEN_CELL) != 0
    if not are_cells and of_points is not None:
        hidden |= (of_points & HIDDEN_POINT) != 0
    if not are_cells and of_cells is not None:
        is_seen = (of_cells & HIDDEN_CELL) == 0
        touches = np.zeros(samples.shape, bool)
        for steps in product((0, 1), repeat=3):
            near = tuple(slice(step, step + n) for step, n in zip(steps, is_seen.shape, strict=True))
            touches[near] |= is_seen[tuple(slice(part.stop - part.start) for part in _within(near, touches.shape))]
        hidden |= ~touches
    if not hidden.any():
        return samples, ()
    shown = np.where(hidden, np.nan, samples).astype(np.result_type(samples.dtype, np.float32))
    return shown, (f"{hidden.mean():.1%} of the samples are hidden by the file, and nothing is drawn there",)


def _within(parts: tuple[slice, ...], shape: tuple[int, ...]) -> list[slice]:
    """The parts of axes that exist: a layer of points counts as one of cells."""
    return [slice(part.start, min(part.stop, n)) for part, n in zip(parts, shape, strict=True)]
