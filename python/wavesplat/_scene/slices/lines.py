"""Lines over a slice: of regions, around labels, and of equal values.

Where a slice is parallel to the planes of a region's lines, the lines of the nearest plane are drawn as they are, if it
lies within half the distance of planes. On any other slice, and of labels, the voxels inside count: their line is where
half of a place, between samples, lies inside.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from wavesplat._looks.kinds.kinds import unit_of_values
from wavesplat._looks.labels.labels import Labels
from wavesplat._looks.labels.regions import Region
from wavesplat._looks.labels.structure_labels import in_unit_of, mask_of
from wavesplat._looks.layer_names import layer_name_of
from wavesplat._model.volume.grid import Grid
from wavesplat._model.volume.volume import Volume
from wavesplat._model.volume.wavelet_volume import WaveletVolume
from wavesplat._picture.report_facts import plain_name
from wavesplat._render.isolines import Isolines, drawn_over, lines_at
from wavesplat._render.slicing import Planes
from wavesplat._system.values import described
from wavesplat.errors import ArgumentError

Rgba: TypeAlias = NDArray[np.float32]
Lines: TypeAlias = "list[NDArray[np.float64]]"
Named: TypeAlias = "tuple[str, tuple[float, float, float], Lines]"

#: Depth of a line's points, in distances of samples, within which it counts as parallel to a slice.
FLAT = 0.1
#: Coordinates in files are rounded; a plane half way between two slices is shown by one of them.
EPSILON = 1e-6
#: Where labels end: half of a place, between samples, lies inside.
HALF = 0.5


@dataclass(frozen=True)
class Over:
    """A picture with lines over it, the names and colours of those that show, and notes on others."""

    rgba: Rgba
    shown: list[dict[str, Any]]
    notes: list[str]


@dataclass(frozen=True)
class LinesOver:
    """The arguments `contours` and `isolines` of a slice."""

    contours: list[Labels | Region]
    isolines: list[Isolines]

    @property
    def volumes(self) -> list[Volume | WaveletVolume]:
        """The volumes of the isolines."""
        return [one.volume for one in self.isolines]

    def over(self, rgba: Rgba, planes: Planes, scan: Grid, **options: Any) -> Over:
        """The slice with all lines; `options`: of the values that isolines are of, as `Planes.values_of` takes them."""
        found = Over(rgba, [], [])
        if self.isolines:
            found = _with_isolines(rgba, planes, self.isolines, **options)
        if self.contours:
            more = _with_contours(found.rgba, planes, self.contours, scan)
            found = Over(more.rgba, found.shown + more.shown, found.notes + more.notes)
        return found


def lines_over(contours: Any, isolines: Any) -> LinesOver | None:
    """The two arguments, checked; None where neither is given."""
    if contours is None and isolines is None:
        return None
    several = [isolines] if isinstance(isolines, Isolines) else [] if isolines is None else isolines
    if not isinstance(several, list | tuple) or not all(isinstance(one, Isolines) for one in several):
        raise ArgumentError(
            f"isolines is {described(isolines)}; give wavesplat.Isolines(volume, values), or several in a list"
        )
    regions = [contours] if isinstance(contours, Labels | Region) else [] if contours is None else contours
    if not isinstance(regions, list | tuple) or not all(isinstance(region, Labels | Region) for region in regions):
        raise ArgumentError(
            f"contours is {described(contours)}; give wavesplat.Region.open(path), a list of regions, or Labels"
        )
    return LinesOver(list(regions), list(several))


def _with_contours(rgba: Rgba, planes: Planes, contours: Sequence[Labels | Region], scan: Grid) -> Over:
    """The slice with the lines of regions, and around labels."""
    shown, notes = [], list[str]()
    for one in contours:
        if isinstance(one, Labels):
            labels = one.for_lines_over(scan)
            notes += labels.notes
            around = _around_labels(planes, labels, scan)
        else:
            around = _of_region(planes, one, scan)
        for name, color, lines in around:
            if lines:
                rgba = drawn_over(rgba, lines, color)
                shown.append({"name": name, "color": list(color)})
    return Over(rgba, shown, notes if shown else [*notes, "no line of the contours lies in the slice"])


def _with_isolines(
    rgba: Rgba, planes: Planes, isolines: Sequence[Isolines], *, kernel: Any, slab: Any, threads: int | None
) -> Over:
    """The slice with the lines of equal values."""
    shown, notes = [], []
    for one in isolines:
        values = planes.values_of(one.volume, kernel, slab, threads)
        unit = unit_of_values(one.volume)
        name = one.name or ("" if unit else plain_name(layer_name_of(one.volume)))
        absent = []
        for value, color in zip(one.values, one.colors(), strict=True):
            text = f"{value:g} {unit}".rstrip()
            if lines := lines_at(values, value):
                rgba = drawn_over(rgba, lines, color)
                shown.append({"name": f"{name} {text}".lstrip(), "color": list(color)})
            else:
                absent.append(text)
        if absent:
            inside = values[np.isfinite(values)]
            there = f"its values there are {inside.min():g} to {inside.max():g}" if inside.size else "it lies elsewhere"
            notes.append(f"no isoline {', '.join(absent)} of {layer_name_of(one.volume)!r} lies in the slice: {there}")
    return Over(rgba, shown, notes)


# Regions


def _of_region(planes: Planes, region: Region, scan: Grid) -> Iterator[Named]:
    """Name, colour and lines of a region."""
    yield region.name, region.color, _lines_of(planes, region, scan)


def _lines_of(planes: Planes, region: Region, scan: Grid) -> Lines:
    lines = in_unit_of(scan, region.lines) if region.is_of_patient else list(region.lines)
    heights = [line @ planes.cut.normal for line in lines]
    step = min(scan.spacing)
    if all(np.ptp(height) <= FLAT * step for height in heights):
        places = np.array([height.mean() for height in heights]) - planes.cut.offset + EPSILON * step
        return [_closed(_in_pixels(planes, lines[n])) for n in _nearest(places, planes, scan)]
    mask = mask_of(lines, scan)
    if not mask.inside.any():
        return []
    return _edge(planes, _placed(mask.inside, mask.first, scan))


def _nearest(places: NDArray[np.float64], planes: Planes, scan: Grid) -> list[int]:
    """The lines of the plane that a slice shows. `places`: distances of all lines from it, along its normal."""
    step = planes.step_of(scan)
    distinct = np.sort(places)[np.diff(np.sort(places), prepend=-np.inf) > FLAT * step]
    usual = max(float(np.median(np.diff(distinct))), step) if len(distinct) > 1 else step
    nearest = distinct[np.abs(distinct).argmin()]
    # Of two planes at the same distance one is shown.
    if not -usual / 2 <= nearest < usual / 2:
        return []
    return np.flatnonzero(np.abs(places - nearest) <= FLAT * step).tolist()


def _in_pixels(planes: Planes, points: NDArray[np.float64]) -> NDArray[np.float64]:
    from_first = (points - planes.frame.origin) / planes.frame.pixel
    return np.column_stack([from_first @ planes.cut.right, -(from_first @ planes.cut.up)])


def _closed(line: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.concatenate([line, line[:1]])


# Labels


def _around_labels(planes: Planes, labels: Labels, scan: Grid) -> Iterator[Named]:
    """Name, colour and lines of each label with a look."""
    matrix = scan.world_from_index if labels.world_from_index is None else labels.world_from_index
    grid = Grid("labels", labels.shape, matrix, scan.facts)
    for number, look in labels.labels.items():
        inside = labels._codes == labels.numbers.index(number)
        box = tuple(_range(inside.any(axis=(*range(axis), *range(axis + 1, 3)))) for axis in range(3))
        part = inside[box]
        first = (box[0].start, box[1].start, box[2].start)
        yield look.name or str(number), look.color, _edge(planes, _placed(part, first, grid))


def _range(is_there: NDArray[np.bool_]) -> slice:
    there = np.flatnonzero(is_there)
    return slice(int(there[0]), int(there[-1]) + 1)


def _placed(inside: NDArray[np.bool_], first: tuple[int, int, int], grid: Grid) -> Volume:
    """A part of a grid as a volume, with a rim of nothing, so that its outline is closed."""
    matrix = grid.world_from_index.copy()
    matrix[:3, 3] += matrix[:3, :3] @ (np.array(first[::-1]) - 1.0)
    return Volume(np.pad(inside, 1).view(np.uint8), world_from_index=matrix, name="region")


def _edge(planes: Planes, volume: Volume) -> Lines:
    middle = replace(planes, thickness=0.0)  # as labels, also of a slab
    values = middle.values_of(volume, "linear", "maximum", None)
    return lines_at(np.nan_to_num(values, nan=0.0), HALF)
