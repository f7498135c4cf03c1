"""Voxels inside a region of closed lines, as radiotherapy draws them: one or a few lines in each slice.

A voxel is inside if its centre is, by the even-odd rule over all lines of the plane: from the centre along the row, an
odd number of them is crossed. So a line inside another one is a hole, and one inside a hole is matter again. A centre
on a line is inside at the left and the upper side of the region, and outside at the others, so that neighbours share
none. A slice shows the nearest plane of lines, if it lies within half the distance of planes.

Written here: Pillow fills whatever pixels a line touches, half a voxel more on every side; scikit-image, whose voxels
are these, is an extra, and fills one line at a time.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from math import ceil, floor

import numpy as np
from numpy.typing import NDArray

from wavesplat._model.grid import Grid

#: Distance, in voxels, within which points are in one plane, and planes are one.
FLAT = 0.1
#: Coordinates in files are rounded; they are moved by this many voxels, so that a plane half way lies in one slice.
EPSILON = 1e-6
#: Crossings of lines and rows that are worked on at once.
CROSSINGS = 1 << 20


@dataclass(frozen=True)
class Mask:
    """The voxels of a region, and where they begin in the grid."""

    #: Booleans [z, y, x], of the smallest box that has the region.
    inside: NDArray[np.bool_]
    first: tuple[int, int, int]
    #: Lines that are left out, because they do not lie in slices of the grid.
    n_oblique: int

    @property
    def box(self) -> tuple[slice, slice, slice]:
        """The place in the grid's samples [z, y, x]."""
        z, y, x = (slice(start, start + n) for start, n in zip(self.first, self.inside.shape, strict=True))
        return z, y, x


def mask_of(lines: Sequence[NDArray[np.float64]], grid: Grid) -> Mask:
    """The voxels of a grid inside closed lines, shape (points, 3) each, in the grid's world."""
    to_index = np.linalg.inv(grid.world_from_index)
    found = [line @ to_index[:3, :3].T + to_index[:3, 3] for line in lines]
    spreads = np.array([np.ptp(line, axis=0) for line in found]).reshape(-1, 3)
    axis = int(np.median(spreads, axis=0).argmin()) if found else 2
    flat = [line for line, spread in zip(found, spreads, strict=True) if spread[axis] <= FLAT]
    shape = grid.shape[::-1]  # along x, y, z, as coordinates are
    n_oblique = len(found) - len(flat)
    ends = _box(flat, axis, shape)
    if ends is None:
        return Mask(np.zeros((0, 0, 0), np.bool_), (0, 0, 0), n_oblique)
    first, n = ends
    column, row = (other for other in range(3) if other != axis)
    inside = np.zeros([n[axis], n[row], n[column]], np.bool_)
    for slices, plane in _planes(flat, axis, first[axis], n[axis]):
        polygons = [line[:, [column, row]] - (first[column], first[row]) for line in plane]
        inside[slices] = even_odd(polygons, n[row], n[column])
    # From (along the axis, row, column) to z, y, x.
    order = [(axis, row, column).index(along) for along in (2, 1, 0)]
    return Mask(inside.transpose(order), (first[2], first[1], first[0]), n_oblique)


def _planes(
    lines: Sequence[NDArray[np.float64]], axis: int, first: int, n: int
) -> Iterator[tuple[NDArray[np.intp], list[NDArray[np.float64]]]]:
    """The slices, of n from the first one on, that show a plane of lines, and its lines."""
    at = np.array([line[:, axis].mean() for line in lines]) + EPSILON - first
    order = np.argsort(at, kind="stable")
    begins = np.flatnonzero(np.diff(at[order], prepend=-np.inf) > FLAT)
    planes = np.split(order, begins[1:])
    places = np.array([at[plane].mean() for plane in planes])
    slices = np.arange(n)
    # Of two planes at the same distance the lower one.
    above = np.searchsorted(places, slices).clip(1, max(len(places) - 1, 1))
    is_above = slices - places[above - 1] > np.abs(places[above % len(places)] - slices)
    nearest = np.where(is_above, above, above - 1) if len(places) > 1 else np.zeros(n, np.intp)
    away, half = slices - places[nearest], _half(places)
    shown = (-half <= away) & (away < half)
    for plane in np.unique(nearest[shown]).tolist():
        yield np.flatnonzero(shown & (nearest == plane)), [lines[line] for line in planes[plane]]


def _half(places: NDArray[np.float64]) -> float:
    """Half the usual distance of planes, at least half a slice."""
    usual = float(np.median(np.diff(places))) if len(places) > 1 else 1.0
    return max(usual, 1.0) / 2


def _box(lines: Sequence[NDArray[np.float64]], axis: int, shape: Sequence[int]) -> tuple[list[int], list[int]] | None:
    """First index along x, y, z and number of voxels of the box of the lines in a grid; None if there are none."""
    if not lines:
        return None
    low, high = (
        np.min([line.min(axis=0) for line in lines], axis=0),
        np.max([line.max(axis=0) for line in lines], axis=0),
    )
    half = _half(np.unique(np.round([line[:, axis].mean() for line in lines], 1)))
    low[axis], high[axis] = low[axis] - half, high[axis] + half
    first = [max(floor(low[along]), 0) for along in range(3)]
    n = [min(ceil(high[along]), shape[along] - 1) - first[along] + 1 for along in range(3)]
    return (first, n) if min(n) > 0 else None


def even_odd(polygons: Sequence[NDArray[np.float64]], n_rows: int, n_columns: int) -> NDArray[np.bool_]:
    """Pixels [row, column] inside an odd number of polygons: parity of the edges left of each centre.

    polygons : shape (points, 2) each, (column, row); the centre of the first pixel is at (0, 0).
    """
    begins = np.concatenate(polygons)
    ends = np.concatenate([np.roll(polygon, -1, axis=0) for polygon in polygons])
    # An edge crosses the rows from its upper end on, its lower end left out: a corner is counted once.
    upper, lower = (
        np.ceil(of_both(begins[:, 1], ends[:, 1])).clip(0, n_rows).astype(np.intp)
        for of_both in (np.minimum, np.maximum)
    )
    # A crossing turns all pixels right of it, so the running sum counts the edges left of a pixel. The further column
    # takes crossings beyond the last pixel.
    toggles = np.zeros(n_rows * (n_columns + 1), np.int64)
    n_edges = max(1, CROSSINGS // n_rows)
    for start in range(0, len(begins), n_edges):
        some = slice(start, start + n_edges)
        counts = (lower - upper)[some]
        edge = np.repeat(np.arange(start, start + len(counts)), counts)
        rows = np.repeat(upper[some], counts) + np.arange(counts.sum()) - np.repeat(np.cumsum(counts) - counts, counts)
        (x, y), (to_x, to_y) = begins[edge].T, ends[edge].T
        crossed = np.ceil(x + (rows - y) * (to_x - x) / (to_y - y)).clip(0, n_columns).astype(np.intp)
        toggles += np.bincount(rows * (n_columns + 1) + crossed, minlength=len(toggles))
    inside: NDArray[np.bool_] = np.cumsum(toggles.reshape(n_rows, n_columns + 1)[:, :-1], axis=1) % 2 == 1
    return inside
