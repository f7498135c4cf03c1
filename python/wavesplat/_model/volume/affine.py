"""Affine maps `world_from_index`: a 4 x 4 matrix that takes (i, j, k, 1), i fastest in memory, to world (x, y, z, 1).

The columns of its upper-left 3 x 3 block are the steps between neighbouring samples, in world units;
their lengths are the spacing, and nothing requires them to be orthogonal (a gantry-tilted CT is sheared).
The world frame of medical data is RAS: +x is the patient's right, +y anterior, +z superior.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import product

import numpy as np
from numpy.typing import ArrayLike, NDArray

from wavesplat._system.values import described, numbers
from wavesplat.errors import ArgumentError

Affine = NDArray[np.float64]

#: Determinant of unit columns, below which a map has no inverse in float64.
SINGULAR = 1e-9
#: Half turn about z: ITK and DICOM count x towards the patient's left and y towards the back, RAS the other way.
RAS_FROM_LPS: Affine = np.diag([-1.0, -1.0, 1.0, 1.0])


def from_spacing(spacing: Sequence[float]) -> Affine:
    """Affine with sample (0, 0, 0) at the world origin and `spacing` (x, y, z) between neighbours."""
    return np.diag([*checked_spacing(spacing), 1.0])


def affine_of(direction: ArrayLike, spacing: ArrayLike, origin: ArrayLike) -> Affine:
    """Affine with unit steps as the columns of `direction`, distances (x, y, z), and sample (0, 0, 0) at `origin`."""
    matrix = np.eye(4)
    matrix[:3, :3] = np.asarray(direction, np.float64) * np.asarray(spacing, np.float64)
    matrix[:3, 3] = origin
    return matrix


def with_spacing(world_from_index: Affine, spacing: Sequence[float]) -> Affine:
    """Affine with the same origin and directions, and other distances (x, y, z) between neighbours."""
    scaled = world_from_index.copy()
    scaled[:3, :3] *= np.asarray(checked_spacing(spacing)) / spacing_of(world_from_index)
    return scaled


def spacing_of(world_from_index: Affine) -> NDArray[np.float64]:
    """Distance between neighbouring samples along x, y, z: the lengths of the columns."""
    lengths: NDArray[np.float64] = np.linalg.norm(world_from_index[:3, :3], axis=0)
    return lengths


def checked_spacing(spacing: Sequence[float]) -> tuple[float, float, float]:
    """Three positive finite numbers, or an `ArgumentError` that says what was given."""
    x, y, z = numbers(spacing, "spacing", "three numbers (x, y, z)", n=3, finite=False)
    if not all(np.isfinite(step) and step > 0 for step in (x, y, z)):
        raise ArgumentError(
            f"spacing is ({x:g}, {y:g}, {z:g}); each of (x, y, z) must be a positive finite number "
            "(an axis that runs backwards is written with world_from_index)"
        )
    return x, y, z


def checked_map(matrix: ArrayLike, what: str) -> Affine:
    """A copy of an affine map, shape (4, 4), or an `ArgumentError` that says why it is none; `what`: for messages."""
    try:
        found = np.array(matrix, np.float64)
    except (TypeError, ValueError, OverflowError):
        raise ArgumentError(f"{what} is {described(matrix)}; give 4 x 4 numbers") from None
    if found.shape != (4, 4):
        raise ArgumentError(f"{what} has shape {found.shape}; it must be (4, 4)")
    if not np.isfinite(found).all() or found[3].tolist() != [0, 0, 0, 1]:
        raise ArgumentError(
            f"{what} has the last row {found[3].tolist()}; give finite numbers, and 0, 0, 0, 1 as the last row"
        )
    # Against the lengths of the columns, which are any unit.
    scale = float(np.prod(spacing_of(found)))
    if not abs(np.linalg.det(found[:3, :3])) > SINGULAR * scale:
        raise ArgumentError(f"{what} has no inverse: it maps the volume onto a plane; give one that can be undone")
    return found


def world_bounds(world_from_index: Affine, shape: tuple[int, int, int]) -> NDArray[np.float64]:
    """Corners (lower, upper) of the axis-aligned world box around all sample centres, shape (2, 3)."""
    corners = box_corners(world_from_index, shape)
    return np.stack([corners.min(axis=0), corners.max(axis=0)])


def box_corners(world_from_index: Affine, shape: tuple[int, int, int]) -> NDArray[np.float64]:
    """World positions of the eight outermost sample centres, shape (8, 3); `shape` is (z, y, x)."""
    n_z, n_y, n_x = shape
    index = np.array(list(product((0, n_x - 1), (0, n_y - 1), (0, n_z - 1))), dtype=np.float64)
    return transformed(world_from_index, index)


def transformed(matrix: NDArray[np.floating], points: NDArray[np.float64]) -> NDArray[np.float64]:
    """Points, shape (n, 3), by an affine map."""
    moved: NDArray[np.float64] = points @ matrix[:3, :3].T + matrix[:3, 3]
    return moved


def axis_codes(world_from_index: Affine) -> str:
    """Directions of the index axes x, y, z in the RAS world, to the nearest axis: "RAS", "LPS", "PIR", ..."""
    directions = world_from_index[:3, :3] / spacing_of(world_from_index)
    letters = ["??"] * 3
    free = {0, 1, 2}
    # The most aligned index axis chooses first, so that two oblique axes never get the same letter.
    for column in np.argsort(-np.abs(directions).max(axis=0), kind="stable"):
        row = max(free, key=lambda candidate: abs(directions[candidate, column]))
        free.remove(row)
        letters[column] = ("LR", "PA", "IS")[row][int(directions[row, column] > 0)]
    return "".join(letters)
