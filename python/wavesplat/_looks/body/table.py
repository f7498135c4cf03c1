"""The table under a patient in a CT, separated from the body by the shape that only tables have.

A table is the same from slice to slice, thin, wide, and lies below all of the body. So, on a coarse copy of about 3 mm:

1. In each axial slice, opening (erosion, then dilation) keeps what is thick, the body; what it removes is thin.
2. Places of a slice at which most slices have something thin are parts of a prism along the body, which anatomy is not.
3. Connected places are a table if they are long and narrow, and below the middle of the body, none of it below them.
   Matter below a wide one is no part of the patient either: a second shell, rails, mechanics; nor are small parts
   beside its ends that are the same in all slices.

Arms, legs and hands are thick, or change from slice to slice, so they stay. A scan in which thin walls prevail (dry
bones, hollow phantoms), one of a few slices, on oblique axes, or without Hounsfield units stays as it is, and so does a
table that touches the body along its whole width. It needs NumPy only, and some hundredths of a second.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wavesplat._looks.kinds.hounsfield import looks_like_hounsfield, stored_offset
from wavesplat._model.volume.grid import Grid
from wavesplat._model.volume.volume import Volume

#: Text in `Facts.processing` of a volume that is drawn without its table.
PROCESSING = "the table below the body left out of the picture"

#: Value between air and matter, and value of air, Hounsfield units.
AIR_HU, EMPTY_HU = -400.0, -1000.0
#: Distances of the samples that are looked at, and of places, of which each has the largest of its samples; mm.
SAMPLE_MM, PLACE_MM, SLICE_MM = 1.7, 3.4, 4.0
#: Largest number of slices that are looked at.
N_SLICES = 100
#: Places that erosion takes on either side: matter thinner than twice that and one, 15 mm, is thin.
N_ERODED = 2
#: Least share of the slices that have something thin at a place of a table.
MIN_SLICES = 0.7
#: Least length of the scan along the body, and least width of a table or a visible end of it; mm.
MIN_LENGTH_MM, MIN_WIDTH_MM = 60.0, 60.0
#: Largest mean thickness of a table, with the places around it that count: two shells; mm.
MAX_THICKNESS_MM = 25.0
#: Largest share of a table's places that lie among thick parts of the body, or in them.
MAX_ENCLOSED = 0.1
#: Least share of all matter but the table that is thick. (Patients: 0.95 and more; dry bones and hollow phantoms: below
#: 0.5.)
MIN_THICK = 0.6
#: Largest share of the thick matter that may lie below a table, such as its mechanics.
MAX_BELOW = 0.02
#: Largest section of a part at the end of a table that belongs to it, mm2, and least share of the slices, weighted by
#: itself, that have it: arms and hands are larger, and change from slice to slice.
MAX_END_MM2, MIN_SAME = 600.0, 0.85
#: Largest volume that is copied, bytes.
LARGEST = 2**31
#: Places from an edge of the scan within which an upright part may be an arm that it cuts; and those beside a wide
#: table that belong to it.
EDGE = 2
#: Least cosine of the angle between the volume's axes and the patient's.
MIN_COSINE = 0.85

Mask = NDArray[np.bool_]


def without_table(volume: Volume, decided_by: Volume | None = None) -> Volume | None:
    """A copy of a patient's CT with air in place of the table; None where no table can be separated from the body.

    Type, shape, place and name are the same; `facts.processing` says that the table is left out. It is kept with the
    volume.

    decided_by : of a series the volume whose table is used at all times, so that the table does not come and go; it
        counts where it has the same grid. What is thick at the volume's own time stays. None is the volume itself.
    """
    reference = decided_by if decided_by is not None and has_grid_of(volume, decided_by) else volume
    key = "without table", id(reference) if reference is not volume else 0
    if key not in volume._parts:
        # The reference with it, so that another volume does not get its identity.
        volume._parts[key] = _found(volume, reference) or "", reference if reference is not volume else None
    found, _ = volume._parts[key]
    return None if isinstance(found, str) else found


def has_grid_of(volume: Volume, other: Volume) -> bool:
    """Whether two volumes have the same samples' places."""
    return volume.shape == other.shape and np.array_equal(volume.world_from_index, other.world_from_index)


def _found(volume: Volume, reference: Volume) -> Volume | None:
    decided = _decided(reference)
    if decided is None or volume.samples.nbytes > LARGEST:
        return None
    places = Places.of(volume)
    assert places is not None  # the reference has them
    out = out_of(places, places.looked_at(volume.samples), decided)
    if out is None:
        return None
    samples = volume.samples.copy()
    places.empty(samples, out, max(EMPTY_HU + decided.offset, float(volume.value_range[0])))
    return volume._processed(samples, PROCESSING, volume._source)


@dataclass(frozen=True)
class Decided:
    """A table that was found: its places [row, column], those below it, and the offset of the units."""

    table: Mask
    below: Mask
    offset: float


def _decided(volume: Volume) -> Decided | None:
    """The table of a volume; None where there is none, or it is in doubt. It is kept with the volume."""
    if "table" not in volume._parts:
        volume._parts["table"] = _find(volume) or ""
    found = volume._parts["table"]
    return None if isinstance(found, str) else found


def _find(volume: Volume) -> Decided | None:
    if not may_have_table(volume) or volume.samples.nbytes > LARGEST:
        return None
    places = Places.of(volume)
    return None if places is None else decided_by(places, places.looked_at(volume.samples), volume)


def may_have_table(volume: Grid) -> bool:
    """Whether a volume may be a CT of a patient on a table, from which none was taken yet."""
    if not (volume.is_anatomical and volume.unit == "mm" and volume.modality in (None, "CT")):
        return False
    return PROCESSING not in volume.facts.processing and not any(
        "largest body" in one for one in volume.facts.processing
    )


def decided_by(places: Places, looked_at: NDArray[Any], volume: Volume) -> Decided | None:
    """The table in the samples of a volume that are looked at; None where there is none, or it is in doubt."""
    if places.length < MIN_LENGTH_MM:
        return None
    offset = _offset(looked_at, volume)
    if offset is None:
        return None
    found = _table(places.matter(looked_at, AIR_HU + offset), places.distances)
    return None if found is None else Decided(*found, offset)


def out_of(places: Places, looked_at: NDArray[Any], decided: Decided) -> Mask | None:
    """The places, [slice, row, column], of a table in samples that are looked at; None where the body may be there."""
    matter = places.matter(looked_at, AIR_HU + decided.offset)
    thick = _thick(matter)
    # At another time, more than mechanics may lie there.
    if np.count_nonzero(thick & decided.below) > MAX_BELOW * np.count_nonzero(thick):
        return None
    return _outside(matter, thick, decided.table, decided.below)


def _offset(looked_at: NDArray[Any], volume: Volume) -> float | None:
    """The offset of the values from Hounsfield units; None where they do not look like such units."""
    some = looked_at[::2, ::2, ::2].astype(np.float64)
    some = some[np.isfinite(some)]
    if looks_like_hounsfield(some, volume):
        return 0.0
    # Quick: most volumes that are none have smaller values.
    offset = stored_offset(some) if volume.value_range[0] >= 0 else 0.0
    return offset or None


@dataclass(frozen=True)
class Places:
    """A coarse grid of places on a volume: slices from the feet up, rows from the front to the back, columns."""

    #: Which of the axes z, y, x are slices, rows and columns, and the direction of each.
    order: tuple[int, int, int]
    turned: tuple[slice, slice, slice]
    #: Steps from one sample that is looked at to the next, and how many of them make a place.
    steps: tuple[int, int, int]
    together: tuple[int, int]
    #: Length of the scan, and height and width of a place; mm.
    length: float
    distances: tuple[float, float]

    @classmethod
    def of(cls, grid: Grid) -> Places | None:
        """The places of a volume; None where its axes are not nearly parallel to the patient's."""
        axes = grid.world_from_index[:3, :3] / np.linalg.norm(grid.world_from_index[:3, :3], axis=0)
        of_world = [int(np.abs(axes[world]).argmax()) for world in (2, 1, 0)]
        cosines = [axes[world, axis] for world, axis in zip((2, 1, 0), of_world, strict=True)]
        if sorted(of_world) != [0, 1, 2] or min(np.abs(cosines)) < MIN_COSINE:
            return None
        z, y, x = (2 - axis for axis in of_world)
        # Rows go down to the back: against the world's y.
        turned = tuple(
            slice(None, None, 1 if c * sign > 0 else -1) for c, sign in zip(cosines, (1, -1, 1), strict=True)
        )
        between, *across = (grid.spacing[axis] for axis in of_world)
        n_slices = grid.shape[z]
        apart = max(1, -(-n_slices // N_SLICES), int(SLICE_MM / between))
        steps = [max(1, int(SAMPLE_MM / distance)) for distance in across]
        together = [max(1, int(PLACE_MM / (n * distance))) for n, distance in zip(steps, across, strict=True)]
        height, width = (d * n * k for d, n, k in zip(across, steps, together, strict=True))
        return cls(
            (z, y, x),
            (turned[0], turned[1], turned[2]),
            (apart, steps[0], steps[1]),
            (together[0], together[1]),
            n_slices * between,
            (height, width),
        )

    def looked_at(self, samples: NDArray[Any]) -> NDArray[Any]:
        """The samples that are looked at, of all samples [z, y, x]: [slice, row, column]."""
        turned = samples.transpose(self.order)[self.turned]
        return turned[tuple(slice(None, None, step) for step in self.steps)]

    def indices(self, shape: tuple[int, int, int]) -> list[NDArray[np.intp]]:
        """Indices along z, y, x of the samples that are looked at, in the order of slices, rows and columns."""
        found = [np.empty(0, np.intp)] * 3
        for axis, way, step in zip(self.order, self.turned, self.steps, strict=True):
            found[axis] = np.arange(shape[axis])[way][::step]
        return found

    def places(self, shape: tuple[int, int, int], n_slices: int) -> list[NDArray[np.intp]]:
        """Number of the place of each sample, along z, y, x."""
        found = [np.empty(0, np.intp)] * 3
        across = [step * k for step, k in zip(self.steps[1:], self.together, strict=True)]
        for axis, way, step in zip(self.order, self.turned, (self.steps[0], *across), strict=True):
            n = shape[axis]
            at = nearest_places(n, step, n_slices) if axis == self.order[0] else np.arange(n) // step
            found[axis] = at[way]
        return found

    def matter(self, looked_at: NDArray[Any], least: float) -> Mask:
        """Whether a place has a sample above a value, shape (slices, rows, columns)."""
        found: Mask = looked_at > least
        for axis, n in enumerate(self.together, 1):
            found = _any_of(found, n, axis)
        return found

    def empty(self, samples: NDArray[Any], out: Mask, value: float) -> None:
        """Give the samples at some places a value; `samples` has the volume's axes."""
        view = samples.transpose(self.order)[self.turned]
        rows, columns = (np.flatnonzero(out.any(axis=(0, 3 - axis))) for axis in (1, 2))
        steps = [n * k for n, k in zip(self.steps[1:], self.together, strict=True)]
        (top, bottom), (left, right) = (
            (int(places[0]) * step, (int(places[-1]) + 1) * step)
            for places, step in zip((rows, columns), steps, strict=True)
        )
        part = view[:, top:bottom, left:right]
        row, column = (
            np.arange(start, start + n) // step
            for start, n, step in zip((top, left), part.shape[1:], steps, strict=True)
        )
        empty_at(part, out, (nearest_places(len(view), self.steps[0], len(out)), row, column), value)


def nearest_places(n: int, step: int, n_places: int) -> NDArray[np.intp]:
    """Number of the place next to each of `n` samples; every `step`-th sample is a place."""
    return np.minimum((np.arange(n) + step // 2) // step, n_places - 1)


def empty_at(samples: NDArray[Any], out: Mask, places: Sequence[NDArray[np.intp]], value: float) -> None:
    """Give the samples at some places a value; NaN and infinity stay as they are.

    places : along each axis the number of the place of each sample.
    """
    # Plane by plane, since a mask of all samples takes memory.
    for plane, k in zip(samples, places[0], strict=True):
        plane[out[k][np.ix_(*places[1:])] & np.isfinite(plane)] = value


def _is_wall(y: NDArray[np.intp], x: NDArray[np.intp], body_at: Mask) -> bool:
    """Whether both ends of a wide part run into the body, as a chest wall's that a round field of view cuts thin.

    y, x : places of the part. body_at : places of the body in most slices. A table has free ends.
    """
    left, right = x <= x.min() + EDGE, x >= x.max() - EDGE
    return all(bool(body_at[y[end], x[end]].any()) for end in (left, right))


def _thick(matter: Mask) -> Mask:
    """The matter that is thicker than tables are."""
    return matter & _dilated(_eroded(matter, N_ERODED), N_ERODED + 1)


def _outside(matter: Mask, thick: Mask, table: Mask, below: Mask) -> Mask:
    """The places of a table, and those below it, but for what is the body's and its neighbours."""
    out: Mask = (below | table) & ~_dilated(matter & ~(below | table) | thick & ~below, 1)
    return out


def _table(matter: Mask, distances: tuple[float, float]) -> tuple[Mask, Mask] | None:
    """The places [row, column] of a table, and those below it; None where there is none, or it is in doubt."""
    thick = _thick(matter)
    n_thick = np.count_nonzero(thick)
    thin = matter & ~thick
    height, width = distances
    prism = _dilated(thin, 1).mean(axis=0) >= MIN_SLICES
    if not (n_thick and prism.any()):
        return None
    rows = thick.sum(axis=(0, 2))
    middle = float((rows * np.arange(rows.size)).sum() / n_thick)
    enclosed = np.logical_or.accumulate(thick, axis=1) & np.logical_or.accumulate(thick[:, ::-1], axis=1)[:, ::-1]
    body_at = _dilated(thick, EDGE).mean(axis=0) > MIN_SLICES
    table, below = np.zeros_like(prism), np.zeros_like(prism)
    for y, x in _parts(prism):
        # Without the places around it that the prism has.
        tall, wide = (np.ptp(y) - 1) * height, (np.ptp(x) - 1) * width
        longest = max(tall, wide)
        is_plate = longest >= MIN_WIDTH_MM and y.size * height * width <= MAX_THICKNESS_MM * longest
        if not is_plate or y.min() <= middle or enclosed[:, y, x].mean() > MAX_ENCLOSED:
            continue
        if wide < tall and not EDGE <= x.min() <= x.max() < prism.shape[1] - EDGE:
            continue
        if wide >= tall and _is_wall(y, x, body_at):
            continue
        table[y, x] = True
        if wide >= tall:
            # A little beyond its ends too, where shells meet.
            for beside in range(-EDGE, EDGE + 1):
                below[y, np.clip(x + beside, 0, prism.shape[1] - 1)] = True
    if not table.any():
        return None
    # The prism has a place above the table too, on which something may lie.
    below[2:] = np.logical_or.accumulate(below, axis=0)[:-2]
    below[:2] = False
    below |= _ends(matter, table, below, height * width)
    body = thick & ~below
    n_body = np.count_nonzero(body)
    if n_body < (1 - MAX_BELOW) * n_thick or n_body < MIN_THICK * np.count_nonzero(matter & ~(below | table)):
        return None
    return table, below


def _any_of(mask: Mask, n: int, axis: int) -> Mask:
    """Whether one of each `n` neighbours along an axis is in the mask; the last ones may be fewer."""
    starts = np.arange(0, mask.shape[axis], n)
    return mask if n == 1 else np.logical_or.reduceat(mask, starts, axis=axis)


def _eroded(mask: Mask, n: int) -> Mask:
    """The mask without what is within `n` rows or columns of others; the edges of slices are no surfaces."""
    return ~_dilated(~mask, n)


def _dilated(mask: Mask, n: int) -> Mask:
    """The mask with what is within `n` steps along rows and columns."""
    for _ in range(n):
        grown = mask.copy()
        for axis in (1, 2):
            own, of = (np.moveaxis(each, axis, 0) for each in (grown, mask))
            own[1:] |= of[:-1]
            own[:-1] |= of[1:]
        mask = grown
    return mask


def _ends(matter: Mask, table: Mask, below: Mask, area: float) -> Mask:
    """The places of small parts at the ends of a table that are the same from slice to slice, such as its rails.

    table, below : its places, and those below it, [row, column]. area : of a place, mm2.
    """
    found = np.zeros_like(table)
    near, columns = _dilated(table[None], 1)[0], np.flatnonzero(table.any(axis=0))
    share = matter.mean(axis=0)
    for y, x in _parts((share > 0) & ~(table | below)):
        is_end = x.min() <= columns[0] + EDGE or x.max() >= columns[-1] - EDGE
        is_small = y.size * area <= MAX_END_MM2
        # Of the places that have matter at all, weighted by how often.
        is_same = (share[y, x] ** 2).sum() >= MIN_SAME * share[y, x].sum()
        if not (is_end and is_small and is_same and near[y, x].any()):
            continue
        # What lies on the table, such as a finger, is above it, and no rail beside it.
        rows = np.flatnonzero(table[:, max(x.min() - EDGE, 0) : x.max() + EDGE + 1].any(axis=1))
        if y.max() > rows[0]:
            found[y, x] = True
    # A table is thick where a rail meets it.
    found |= _dilated(found[None], EDGE)[0] & table
    return found


def _parts(mask: Mask) -> list[tuple[NDArray[np.intp], NDArray[np.intp]]]:
    """Rows and columns of each connected part of a slice, corners included."""
    left, parts = set(zip(*(places.tolist() for places in np.nonzero(mask)), strict=True)), []
    around = [(y, x) for y in (-1, 0, 1) for x in (-1, 0, 1)]
    while left:
        part, todo = [], [left.pop()]
        while todo:
            y, x = todo.pop()
            part.append((y, x))
            near = left.intersection((y + down, x + across) for down, across in around)
            left -= near
            todo.extend(near)
        rows, columns = np.array(part, dtype=np.intp).T
        parts.append((rows, columns))
    return parts
