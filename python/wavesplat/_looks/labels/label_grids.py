"""Segmentations on the samples of a scan, by the affines of both.

Axes that are flipped or exchanged are put into the scan's order, which changes no number. Where the samples then lie on
the scan's samples, shifted by a whole number, they are copied: what the segmentation does not reach has no label.
Any other grid (coarser, finer, oblique, half a sample apart) is resampled by nearest neighbour, since numbers of labels
have no values between them.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import permutations
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wavesplat._model.volume import affine, units
from wavesplat._model.volume.grid import Grid
from wavesplat._system.memory import check_room
from wavesplat.errors import ArgumentError

Array = NDArray[np.float64]

#: Distance, in samples, within which samples lie on each other. The nearest neighbour is the same up to half a sample;
#: beyond this the segmentation was made on another grid, which is worth a note.
SAME_PLACE = 0.05
#: Share of the scan's spacing below which a segmentation's is finer; headers round spacings.
FINER = 0.95
#: Samples that are looked up at once: their positions, in float64, take little memory.
SAMPLES_AT_ONCE = 1 << 20


@dataclass(frozen=True)
class Placed:
    """Codes on the samples of a scan.

    codes : array [z, y, x], of the scan's shape.
    is_resampled : whether samples were looked up at other places than their own.
    share_outside : share of the labelled samples that lie outside of the scan; 0 where they were resampled.
    """

    codes: NDArray[Any]
    is_resampled: bool
    share_outside: float = 0.0


def placed(codes: NDArray[Any], world_from_index: Array, outside: int, scan: Grid) -> Placed:
    """Codes of a segmentation on the samples of a scan.

    Parameters
    ----------
    codes : array [z, y, x] of whole numbers
        One code a sample.
    world_from_index : array, shape (4, 4)
        Where they lie.
    outside : int
        Code of places that the segmentation does not reach.
    scan : Grid
        Whose samples are wanted.

    Raises
    ------
    ArgumentError
        If the boxes of both do not touch.
    LimitError
        If there is no memory for the scan's number of codes.
    """
    if not _touch(codes.shape, world_from_index, scan):
        raise ArgumentError(
            f"labels: the segmentation, {_box(codes.shape, world_from_index)}, does not touch the scan {scan.name!r}, "
            f"{_box(scan.shape, scan.world_from_index)}; give the segmentation of this scan, or its array alone, which "
            "lies on the scan's samples, if you know that they belong together"
        )
    codes, matrix = along_axes_of(scan, codes, world_from_index)
    scan_from_own = _changed_index(matrix, scan.world_from_index)
    shift = _whole_shift(codes.shape, scan_from_own)
    if shift is not None and not shift.any() and codes.shape == scan.shape:
        return Placed(np.ascontiguousarray(codes), is_resampled=False)
    check_room(codes.itemsize * int(np.prod(scan.shape)), "the labels on the scan's samples", "crop the scan")
    on_scan = np.full(scan.shape, outside, codes.dtype)
    if shift is None:
        _look_up(codes, on_scan, _changed_index(scan.world_from_index, matrix))
        return Placed(on_scan, is_resampled=True)
    _copy(codes, on_scan, shift)
    n_before, n_after = (int(np.count_nonzero(each != outside)) for each in (codes, on_scan))
    return Placed(on_scan, is_resampled=False, share_outside=1 - n_after / max(n_before, 1))


def along_axes_of(scan: Grid, codes: NDArray[Any], world_from_index: Array) -> tuple[NDArray[Any], Array]:
    """Codes and affine with the axes in the order and the directions that are nearest to the scan's."""
    # Directions in terms of the scan's, which need not be at right angles.
    turn = np.linalg.inv(_directions(scan.world_from_index)) @ _directions(world_from_index)
    order = max(permutations(range(3)), key=lambda order: sum(abs(turn[k, axis]) for k, axis in enumerate(order)))
    matrix = np.array(world_from_index)
    matrix[:, :3] = matrix[:, list(order)]
    # Samples are [z, y, x].
    codes = codes.transpose([2 - axis for axis in reversed(order)])
    for k, axis in enumerate(order):
        if turn[k, axis] < 0:
            codes = np.flip(codes, 2 - k)
            matrix[:3, 3] += (codes.shape[2 - k] - 1) * matrix[:3, k]
            matrix[:3, k] *= -1
    return codes, matrix


def check_unit(unit: str | None, scan: Grid) -> None:
    """Raise an `ArgumentError` if a segmentation's lengths are in another unit than a scan's; None: unknown."""
    if units.differ(unit, scan.unit):
        raise ArgumentError(
            f"labels: the lengths of the segmentation are in {unit}, the scan {scan.name!r} is in {scan.unit}; "
            "open one of them with spacing= and unit= of the other"
        )


def is_finer(world_from_index: Array, scan: Grid) -> bool:
    """Whether a grid has smaller spacings than a scan, along any of the axes of both."""
    own_from_scan = _changed_index(scan.world_from_index, world_from_index)
    return bool((np.linalg.norm(own_from_scan[:3, :3], axis=0) > 1 / FINER).any())


def spacing_text(world_from_index: Array) -> str:
    """Distances of samples along x, y and z, such as "1 x 1 x 2.5"."""
    return " x ".join(f"{step:.4g}" for step in affine.spacing_of(world_from_index))


def _changed_index(world_from_own: Array, world_from_other: Array) -> Array:
    """The affine from indices of one grid to indices of another."""
    return np.asarray(np.linalg.inv(world_from_other) @ world_from_own, np.float64)


def _directions(world_from_index: Array) -> Array:
    directions: Array = world_from_index[:3, :3] / affine.spacing_of(world_from_index)
    return directions


def _whole_shift(shape: tuple[int, ...], scan_from_own: Array) -> NDArray[np.intp] | None:
    """Index (x, y, z) of the first sample in the scan; None where samples lie between the scan's samples."""
    last = np.array(shape[::-1]) - 1.0
    ends = np.array([[(k >> axis) & 1 for axis in range(3)] for k in range(8)]) * last
    moved = ends @ scan_from_own[:3, :3].T + scan_from_own[:3, 3] - ends
    shift = np.rint(moved.mean(axis=0))
    return shift.astype(np.intp) if np.abs(moved - shift).max() <= SAME_PLACE else None


def _copy(codes: NDArray[Any], on_scan: NDArray[Any], shift: NDArray[np.intp]) -> None:
    """Copy codes to a place in others; what lies beyond these is left out."""
    from_, to = [], []
    for n_own, n_scan, first in zip(codes.shape, on_scan.shape, shift[::-1].tolist(), strict=True):
        lower, upper = max(first, 0), min(first + n_own, n_scan)
        to.append(slice(lower, max(upper, lower)))
        from_.append(slice(lower - first, max(upper, lower) - first))
    on_scan[tuple(to)] = codes[tuple(from_)]


def _look_up(codes: NDArray[Any], on_scan: NDArray[Any], own_from_scan: Array) -> None:
    """Fill in the nearest code of every sample of the scan; those that none is near stay as they are."""
    n_z, n_y, n_x = on_scan.shape
    n_own = np.array(codes.shape[::-1])
    turn, first = own_from_scan[:3, :3], own_from_scan[:3, 3]
    off_axis = np.abs(turn - np.diag(np.diag(turn))) @ np.array([n_x, n_y, n_z])
    if off_axis.max() <= SAME_PLACE:
        places = [np.floor(first[a] + turn[a, a] * np.arange(n) + 0.5) for a, n in enumerate((n_x, n_y, n_z))]
        inside = [np.flatnonzero((place >= 0) & (place < n)) for place, n in zip(places, n_own, strict=True)]
        theirs = [place[near].astype(np.intp) for place, near in zip(places, inside, strict=True)]
        on_scan[np.ix_(*inside[::-1])] = codes[np.ix_(*theirs[::-1])]
        return
    rows_at_once = max(1, SAMPLES_AT_ONCE // n_x)
    across = turn[:, 0] * np.arange(n_x)[:, None]
    for z in range(n_z):
        for start in range(0, n_y, rows_at_once):
            rows = np.arange(start, min(start + rows_at_once, n_y))
            index = (first + z * turn[:, 2] + turn[:, 1] * rows[:, None])[:, None, :] + across
            near = np.floor(index + 0.5).astype(np.intp)
            is_near = ((near >= 0) & (near < n_own)).all(axis=-1)
            x, y, depth = near[is_near].T
            on_scan[z, start : start + len(rows)][is_near] = codes[depth, y, x]


def _touch(shape: tuple[int, ...], world_from_index: Array, scan: Grid) -> bool:
    """Whether boxes touch: on the axes of neither do they lie beside each other. Boxes reach half a sample further."""
    scan_from_own = _changed_index(world_from_index, scan.world_from_index)
    own_from_scan = _changed_index(scan.world_from_index, world_from_index)
    return _reaches(shape, scan.shape, scan_from_own) and _reaches(scan.shape, shape, own_from_scan)


def _reaches(shape: tuple[int, ...], other: tuple[int, ...], other_from_own: Array) -> bool:
    half = np.array([[(k >> axis) & 1 for axis in range(3)] for k in range(8)])
    corners = half * np.array(shape[::-1]) - 0.5
    moved = corners @ other_from_own[:3, :3].T + other_from_own[:3, 3]
    # A face that is shared is a touch, though rounded.
    upper = np.array(other[::-1]) - 0.5 + SAME_PLACE
    return bool(((moved.max(axis=0) >= -0.5 - SAME_PLACE) & (moved.min(axis=0) <= upper)).all())


def _box(shape: tuple[int, ...], world_from_index: Array) -> str:
    n_z, n_y, n_x = shape
    lower, upper = affine.world_bounds(world_from_index, (n_z, n_y, n_x)).tolist()
    corners = (", ".join(f"{number:.4g}" for number in corner) for corner in (lower, upper))
    return "({}) to ({})".format(*corners)
