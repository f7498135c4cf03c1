"""Whether a grid's place is one that nobody measured: axis-aligned, with the origin at its first sample or its middle.

Programs that know nothing of a place write such headers, and formats of medicine then say "left-posterior-superior" by
default: an image that ITK made has that space, distances of 1 and the origin at its first sample. Nothing in such a
header speaks of a patient, so the values decide: Hounsfield units and whole numbers, as scanners write them, are of
one; fractions, noisy or not, were calculated.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from wavesplat._model.grid import Grid

#: A convention of a file, kept among its facts: it names a patient's axes, and nothing else of a place.
NO_PLACE = "axes of a patient: they are named, but samples are 1 apart, from the origin on, as by default"

#: Of a file whose axes are those of a map, or of a survey.
UPRIGHT = "x and y grow to the right and up in pictures, as on maps"


def is_placed_by_default(grid: Grid) -> bool:
    """Whether a grid has axes along the world's, and the world's origin at its first sample or its middle."""
    matrix = grid.world_from_index
    if not np.array_equal(matrix[:3, :3], np.diag(np.diag(matrix[:3, :3]))):
        return False
    origin = np.linalg.solve(matrix[:3, :3], -matrix[:3, 3])  # in samples
    # Formats differ in where the middle of an even number of samples is.
    middle = (np.array(grid.shape[::-1]) - 1) / 2
    return bool(np.abs(origin).max() < 1e-6 or np.abs(origin - middle).max() <= 1 + 1e-6)


def is_without_place(world_from_index: NDArray[np.float64]) -> bool:
    """Whether an affine in RAS or LPS is a format's default: steps of 1 from the origin."""
    return bool(np.array_equal(np.abs(world_from_index), np.eye(4)))


def is_of_no_patient(grid: Grid, values: NDArray[np.float64]) -> bool:
    """Whether fractions were calculated, by a header that says no more of a patient than its format does by default."""
    return NO_PLACE in grid.facts.conventions and not np.array_equal(values, np.rint(values))
