"""Regions of a structure set (RTSTRUCT) as labels: the voxels inside of their closed lines.

A voxel is inside if its centre is, by the even-odd rule over all lines of the plane: from the centre along the row, an
odd number of them is crossed. So a line inside another one is a hole, and one inside a hole is matter again. A centre
on a line is inside at the left and the upper side of the region, and outside at the others, so that neighbours share
none. A slice shows the nearest plane of lines, if it lies within half the distance of planes.

Written here: Pillow fills whatever pixels a line touches, half a voxel more on every side; scikit-image, whose voxels
are these, is an extra, and fills one line at a time.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from math import ceil, floor
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wavesplat._looks.labels.label_names import Named, chosen_numbers
from wavesplat._model.volume import units
from wavesplat._model.volume.facts import Facts
from wavesplat._model.volume.grid import Grid
from wavesplat._model.volume.volume import Volume
from wavesplat._readers.dicom.structures import Structure, structures_in
from wavesplat._storage import size_checks
from wavesplat._system.threads import warn
from wavesplat._system.values import described
from wavesplat.errors import ArgumentError, FileError, FileWarning

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


# Regions of a structure set (RTSTRUCT) as labels, filled on the samples of a scan.
#
# Regions of radiotherapy enclose each other (tumour, margins, organ, body), so where they overlap the smallest one is
# shown; the outline of the patient (EXTERNAL), which has all others in it, only where it is asked for.

#: The kind of region that is the outline of the patient.
OUTLINE = "EXTERNAL"
MAX_NUMBER = 65_535
#: Regions that a message names, at most.
N_NAMED = 4


def labels_of_structures(
    file: Path, scan: Grid | None, segments: Sequence[str | int] | None
) -> tuple[Volume, dict[int, Named]]:
    """The numbers of an RTSTRUCT's regions on the samples of a scan, and their names and colours.

    segments : from `chosen_numbers`; None: all but the outline of the patient.
    """
    if scan is None:
        raise ArgumentError(
            "a structure set (RTSTRUCT) has lines, and no samples: give the scan on whose samples its regions are "
            f"filled, wavesplat.Labels.open(path, scan=scan), or `wavesplat render SCAN --labels FILE`: {file}"
        )
    if not isinstance(scan, Grid):
        raise ArgumentError(f"scan is {described(scan)}; give a wavesplat.Volume, as from wavesplat.open(path)")
    found = chosen_structures(structures_in(file), segments, file)
    masks = [(one, mask_of(in_unit_of(scan, one.lines), scan)) for one in found]
    outside = [one.name for one, mask in masks if one.lines and not mask.inside.any()]
    if len(outside) == sum(bool(one.lines) for one in found):
        raise FileError(
            f"no region of the structure set (RTSTRUCT) lies in the scan; open the scan that it was drawn on: {file}"
        )
    samples, covered = _numbered(masks, scan, file)
    oblique = [f"{mask.n_oblique} lines of {one.name!r}" for one, mask in masks if mask.n_oblique]
    for problem, listed in (
        ("regions overlap, and the smallest is shown: hidden are", covered),
        ("regions that are not in the scan:", outside),
        ("lines that lie in no slice of the scan are left out:", oblique),
    ):
        if listed:
            more = ", ..." if len(listed) > N_NAMED else ""
            _warn(f"{problem} {', '.join(listed[:N_NAMED])}{more}", file, stacklevel=5)
    facts = Facts(unit=scan.unit, is_anatomical=scan.is_anatomical, modality="RTSTRUCT")
    volume = Volume(samples, world_from_index=scan.world_from_index, name="labels", facts=facts)
    return volume, {one.number: (one.name, one.color) for one in found}


def _numbered(masks: Sequence[tuple[Structure, Mask]], scan: Grid, file: Path) -> tuple[NDArray[Any], list[str]]:
    """Numbers of the regions on the samples of a scan, the smallest on top, and how much of others is hidden.

    So a region inside another one, such as a tumour in an organ, is always visible.
    """
    most = max(one.number for one, _ in masks)
    dtype = np.dtype(np.uint8 if most < 256 else np.uint16)
    size_checks.check_memory(size_checks.n_bytes(scan.shape, dtype), file)
    samples, hidden = np.zeros(scan.shape, dtype), np.zeros(most + 1, np.int64)
    sizes = {one.number: int(mask.inside.sum()) for one, mask in masks}
    for one, mask in sorted(masks, key=lambda pair: -sizes[pair[0].number]):
        part = samples[mask.box]
        hidden += np.bincount(part[mask.inside], minlength=most + 1)
        part[mask.inside] = one.number
    return samples, [
        f"{hidden[one.number]} of {sizes[one.number]} voxels of {one.name!r}" for one, _ in masks if hidden[one.number]
    ]


def chosen_structures(
    structures: Sequence[Structure], segments: Sequence[str | int] | None, file: Path, *, has_outline: bool = False
) -> list[Structure]:
    """The regions that are wanted, all with numbers of labels; regions without lines are named in a warning.

    has_outline : whether the outline of the patient is one of them also where none is named.
    """
    numbers = {one.number for one in structures}
    if len(numbers) < len(structures) or not all(0 < number <= MAX_NUMBER for number in numbers):
        structures = [replace(one, number=place) for place, one in enumerate(structures, 1)]
    if segments is not None:
        wanted = chosen_numbers(segments, {one.number: one.name for one in structures}, file)
        chosen = [one for one in structures if one.number in wanted]
    elif has_outline:
        chosen = list(structures)
    else:
        chosen = [one for one in structures if one.kind != OUTLINE] or list(structures)
        left_out = [one.name for one in structures if one not in chosen]
        if left_out:
            _warn(
                f"the outline of the patient is left out, since all else lies in it: {', '.join(left_out)}; name it as "
                "a segment to see it",
                file,
            )
    if empty := [one.name for one in chosen if not one.lines]:
        _warn(
            f"regions without closed lines: {', '.join(empty[:N_NAMED])}{', ...' if len(empty) > N_NAMED else ''}", file
        )
    if len(empty) == len(chosen):
        raise FileError(f"the structure set (RTSTRUCT) has no closed lines of these regions; name others: {file}")
    return chosen


def in_unit_of(scan: Grid, lines: Sequence[NDArray[np.float64]]) -> list[NDArray[np.float64]]:
    """Lines in a patient, mm, in the world of a scan.

    Raises
    ------
    ArgumentError
        If the scan does not say where it lies in the patient, or its unit has no size that is known.
    """
    if not scan.is_anatomical:
        raise ArgumentError(
            f"the scan {scan.name!r} says nothing of a patient, and lines of a structure set (RTSTRUCT) lie in one; "
            "open the DICOM or NIfTI series that it was drawn on"
        )
    scale = units.factor("mm", scan.unit)
    if scale is None:
        raise ArgumentError(
            f"lines of a structure set (RTSTRUCT) are in millimetres, and the size of {scan.unit!r}, the unit of the "
            f"scan {scan.name!r}, is unknown; open it with spacing= and unit='mm'"
        )
    return [line * scale for line in lines]


def _warn(text: str, file: Path, *, stacklevel: int = 6) -> None:
    warn(f"{text}: {file}", FileWarning, stacklevel=stacklevel)
