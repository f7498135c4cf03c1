"""One pass over the samples of a lazy volume: range, bounds of bricks, and samples for automatic looks and cameras.

A frame is planned with it before a sample is read: the range scales tables, bounds show which chunks are invisible, and
a part of the samples is enough for looks, cameras and light. It is kept in a cache folder by the states of all files
that the samples lie in (`LazyArray.files`), so that it is made once for all programs. Surveys of arrays without files
(Dask, web servers, object stores) are kept by a name, and only in a folder that the user gives.
"""

from __future__ import annotations

import hashlib
import math
import os
import zipfile
import zlib
from collections import deque
from collections.abc import Callable, Iterable, Sequence
from contextlib import suppress
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wavesplat import _native
from wavesplat._model.lazy.lazy_array import LazyArray
from wavesplat._model.lazy.memory_budget import FOR_UNPACKING, check_budget
from wavesplat._model.lazy.read_ahead import BoxReader, Pending, cells, n_in
from wavesplat._model.volume.stack import Box
from wavesplat._storage.cache_folder import CacheFolder, default_folder
from wavesplat._storage.paths import expanded
from wavesplat._system.memory import trim_heap
from wavesplat._system.threads import check_cancelled
from wavesplat.errors import ArgumentError, WavesplatError

# Thinning of samples for automatic looks, kinds of data and cameras: every n-th along each axis.
#
# The survey of a lazy volume keeps exactly these (`survey.py`), so that they are read once for all of them.

#: Samples at most for histograms, percentiles and cameras (enough for steady percentiles, and a fraction of a second on
#: any volume); for the kind of data, each with its neighbours along the axes; for the unit, which every picture needs.
HISTOGRAM_SAMPLES, KIND_SAMPLES, UNIT_SAMPLES = _native.N_SAMPLES_MOST
step_for = _native.step_for


# Samples that automatic looks and cameras are made from, gathered box by box from a volume that is not in memory.
#
# They are the very samples that looks of volumes in memory see, in their own type, so that both get the same look:
# every n-th along each axis (`survey.py`), and for the kind of data some samples with their direct neighbours.

Shape = tuple[int, int, int]


class ThinnedSamples:
    """Every n-th sample of a volume along each axis, from the sample at `start` on.

    counts : number of them along z, y, x.
    """

    def __init__(self, dtype: np.dtype[Any], start: Shape, step: int, counts: Sequence[int]) -> None:
        self.start, self.step = start, step
        self.samples: NDArray[Any] = np.zeros(counts, dtype)

    def take(self, samples: NDArray[Any], low: Sequence[int]) -> None:
        """Copy those that lie in a box of samples [z, y, x], which begins at `low`."""
        ours, theirs = [], []
        for own, first, n, count in zip(self.start, low, samples.shape, self.samples.shape, strict=True):
            begin = max(0, -((own - first) // self.step))
            end = min(count, -((own - first - n) // self.step))
            if begin >= end:
                return
            ours.append(slice(begin, end))
            place = own + begin * self.step - first
            theirs.append(slice(place, place + (end - begin - 1) * self.step + 1, self.step))
        self.samples[tuple(ours)] = samples[tuple(theirs)]


class LookSamples:
    """Thinned samples of a volume of this shape and type, for looks, cameras and kinds of data."""

    def __init__(self, shape: Shape, dtype: np.dtype[Any]) -> None:
        n = math.prod(shape)
        steps = dict.fromkeys(step_for(n, most) for most in (HISTOGRAM_SAMPLES, UNIT_SAMPLES))
        #: By step, the finest first.
        self._every = {s: ThinnedSamples(dtype, (0, 0, 0), s, [-(-size // s) for size in shape]) for s in steps}
        self.neighbour_step = step_for(n, KIND_SAMPLES)
        self._neighbours = [
            ThinnedSamples(dtype, start, self.neighbour_step, self._counts(shape)) for start in _around(shape)
        ]

    def _counts(self, shape: Shape) -> list[int]:
        """Samples along each axis that have two neighbours along it, or all where none has."""
        return [
            len(range(1, n - 1, self.neighbour_step) if n >= 3 else range(0, n, self.neighbour_step)) for n in shape
        ]

    def take(self, samples: NDArray[Any], low: Sequence[int]) -> None:
        """Copy those that lie in a box of samples [z, y, x], which begins at `low`."""
        for part in (*self._every.values(), *self._neighbours):
            part.take(samples, low)

    def every(self, step: int) -> NDArray[Any] | None:
        """Every n-th sample along each axis; None where that step was not gathered."""
        found = self._every.get(step)
        return None if found is None else found.samples

    @property
    def finest(self) -> tuple[int, NDArray[Any]]:
        """The smallest step that was gathered, and the samples."""
        step = min(self._every)
        return step, self._every[step].samples

    @property
    def coarsest(self) -> NDArray[Any]:
        """The samples of the largest step that was gathered."""
        return self._every[max(self._every)].samples

    @property
    def with_neighbours(self) -> tuple[NDArray[Any], list[tuple[NDArray[Any], NDArray[Any]]]]:
        """Samples `neighbour_step` apart, and their two neighbours along each axis that has any, all flat."""
        middle, *around = (part.samples.ravel() for part in self._neighbours)
        return middle, list(zip(around[::2], around[1::2], strict=True))

    def parts(self) -> list[NDArray[Any]]:
        """All arrays, in an order that depends on shape alone."""
        return [part.samples for part in (*self._every.values(), *self._neighbours)]

    def placed(self) -> list[tuple[NDArray[Any], tuple[Shape, Shape]]]:
        """All arrays of `parts`, each with the index of its first sample and the steps between its samples."""
        kept = (*self._every.values(), *self._neighbours)
        return [(part.samples, (part.start, (part.step,) * 3)) for part in kept]

    def fill(self, parts: Iterable[NDArray[Any]]) -> None:
        """Take the arrays of `parts`; a `ValueError` for other shapes or types."""
        for own, part in zip((*self._every.values(), *self._neighbours), parts, strict=True):
            if part.shape != own.samples.shape or part.dtype != own.samples.dtype:
                raise ValueError("thinned samples of another volume")
            own.samples = part


def _around(shape: Shape) -> list[Shape]:
    """Places of the first sample that has neighbours, and of these: before and after it along each axis."""
    z, y, x = (1 if n >= 3 else 0 for n in shape)
    found: list[Shape] = [(z, y, x)]
    for axis, n in enumerate(shape):
        for side in (-1, 1) if n >= 3 else ():
            own = [z, y, x]
            own[axis] += side
            found.append((own[0], own[1], own[2]))
    return found


# One pass over the samples of a lazy volume: range, bounds of bricks, and some of the samples; and its cache.

#: Version of the cached files.
FORMAT = 5
#: Bytes that are read at once, and bytes of bounds that are kept in a file; both at most.
STEP_BYTES, MAX_KEPT_BYTES = 64 << 20, 1 << 28

#: Errors of reading a file that is damaged, or not a survey.
DAMAGED: tuple[type[Exception], ...] = (
    *(OSError, EOFError, ValueError, TypeError, KeyError, IndexError, OverflowError, MemoryError),
    *(zipfile.BadZipFile, zlib.error, WavesplatError),
)

#: A folder, and the name of a file in it.
Place = tuple[CacheFolder, str]
Matrix = NDArray[np.float64]


@dataclass(frozen=True)
class ShownPart:
    """The only part of a level that is read, since a crop hides the rest, and the rest as a coarser level has it.

    box : samples (z, y, x) that are read, first and end.
    value_range : smallest and largest sample of the coarser level.
    light : the samples of the coarser level nearest to those that light is computed from, [z, y, x]. Matter that a crop
        hides shades what is left, so light needs samples from beyond the box.
    """

    box: Box
    value_range: tuple[float, float]
    light: NDArray[np.float32]


class Survey:
    """Results of one pass over the samples, for a kernel."""

    def __init__(
        self,
        shape: Shape,
        core: _native.Survey,
        prepared: _native.Survey | None,
        kernel: str,
        *,
        light_step: Shape,
        looks: LookSamples,
        is_from_cache: bool = False,
        is_whole: bool = True,
    ) -> None:
        self.shape = shape
        #: Whether all samples were read; if not, `looks` holds samples of a part of the volume.
        self.is_whole = is_whole
        #: Samples for looks, cameras and kinds of data.
        self.looks = looks
        #: Whether it comes from a cache folder: no sample was read for it.
        self.is_from_cache = is_from_cache
        self.core = core
        self.prepared = prepared
        self.kernel = kernel
        #: Steps (z, y, x) between the samples for light.
        self.light_step = light_step

    @property
    def value_range(self) -> tuple[float, float]:
        """Smallest and largest finite sample."""
        low, high, _ = self.core.statistics
        return low, high

    @property
    def n_nonfinite(self) -> int:
        """Number of samples that are not finite."""
        return self.core.statistics[2]

    def forget_bounds(self) -> None:
        """Release the bounds, which take most memory, once they were used."""
        self.core.forget_bounds()
        if self.prepared is not None:
            self.prepared.forget_bounds()

    def finest(self, *, is_cube: bool = False) -> tuple[Shape, NDArray[Any]]:
        """The closest samples that were kept, and the steps between them; `is_cube`: equal along the axes."""
        step, samples = self.looks.finest
        of_looks, of_light = (step, step, step), self.light_step
        is_best = math.prod(of_looks) <= math.prod(of_light) or (is_cube and len(set(of_light)) > 1)
        if self.is_whole and is_best:
            return of_looks, samples
        return of_light, self.core.strided(0)

    def __reduce__(self) -> tuple[Any, ...]:
        parts = {name: (core.parts(), core.statistics) for name, core in self._cores()}
        place = self.shape, self.kernel, self.light_step
        return _unpacked, (place, parts, self.looks, self.is_from_cache, self.is_whole)

    def _cores(self) -> list[tuple[str, _native.Survey]]:
        pairs = (("samples", self.core), ("prepared", self.prepared))
        return [(name, core) for name, core in pairs if core is not None]


def _unpacked(
    place: tuple[Shape, str, Shape], parts: dict[str, Any], looks: LookSamples, is_from_cache: bool, is_whole: bool
) -> Survey:
    (shape, kernel, step), made = place, {}
    for name, ((side, bounds, strided), statistics) in parts.items():
        made[name] = _native.Survey.from_parts(
            shape, kernel, side, statistics, bounds, [(step, own) for own in strided]
        )
    return Survey(
        shape,
        made["samples"],
        made.get("prepared"),
        kernel,
        light_step=step,
        looks=looks,
        is_from_cache=is_from_cache,
        is_whole=is_whole,
    )


def surveyed(
    array: LazyArray,
    world_from_index: Matrix,
    kernel: str,
    memory: int,
    *,
    keep: bool | str | os.PathLike[str] = True,
    holes: bool = False,
    part: ShownPart | None = None,
) -> Survey:
    """The cached survey, or a new one, which reads all samples; twice for B-spline coefficients or missing samples.

    memory : bytes; a quarter is for bounds, so that bricks are larger where there is less.
    keep : True for the cache folder, the name of another folder, or False.
    holes : samples that cannot be read count as 0; the survey is not cached then.
    part : reads the samples of this box alone; the survey is not cached then.
    """
    if hasattr(array, "survey"):  # of the parts of several processes, which have looked through their own
        found: Survey = array.survey(kernel)
        return found
    check_budget([array], memory)
    shape = array.shape
    light_step = _native.light_step(shape, world_from_index)
    if array.files is not None:
        # The files as they are before the first read; what is read later from files in another state is an error.
        array.files.begin()
    place = None if part else _place_of(array, world_from_index, kernel, keep)
    if place is not None and (known := _kept(place, array, kernel, light_step, memory)) is not None:
        return known
    core = _native.Survey(shape, kernel, memory // 4, [light_step])
    looks = LookSamples(shape, array.dtype)

    def add_samples(samples: NDArray[Any], box: Box) -> None:
        core.add(samples, box[0])
        looks.take(samples, box[0])

    boxes = _steps(array, memory, part)
    n_missing = _read_all(array, boxes, memory, add_samples, holes=holes)
    core = _completed(core, part, shape, kernel, light_step)
    low, high, n_nonfinite = core.statistics
    if not low <= high:
        raise ArgumentError(f"volume {array.name!r}: none of its samples is finite, so there is nothing to draw")
    prepared = None
    if kernel.startswith("bspline") or n_nonfinite:
        made = _native.Survey(shape, kernel, memory // 4, [light_step])

        def add(samples: NDArray[Any], box: Box, held: Box) -> None:
            made.add_prepared(samples, held[0], box, kernel, (low, high, n_nonfinite), world_from_index)

        def around(box: Box) -> Box:
            return _native.samples_for(shape, box, kernel, n_nonfinite, world_from_index)

        _read_prepared(array, boxes, memory, around, add, holes=holes)
        prepared = _completed(made, part, shape, kernel, light_step)
    survey = Survey(shape, core, prepared, kernel, light_step=light_step, looks=looks, is_whole=part is None)
    if place is not None and not n_missing:
        with suppress(OSError):  # a full disk must not keep a picture from being drawn
            _keep(place, survey)
        trim_heap()
    return survey


def kept_survey(
    array: LazyArray, world_from_index: Matrix, kernel: str, memory: int, keep: bool | str | os.PathLike[str]
) -> Survey | None:
    """The cached survey; None where there is none."""
    place = _place_of(array, world_from_index, kernel, keep)
    step = _native.light_step(array.shape, world_from_index)
    return None if place is None else _kept(place, array, kernel, step, memory)


def _completed(
    core: _native.Survey, part: ShownPart | None, shape: Shape, kernel: str, light_step: Shape
) -> _native.Survey:
    """A survey of a part, with range and samples for light of the rest by the coarser level."""
    if part is None:
        return core
    side, bounds, strided = core.parts()
    low, high, n_nonfinite = core.statistics
    inside = tuple(slice(-(-a // n), -(-b // n)) for a, b, n in zip(*part.box, light_step, strict=True))
    light = part.light.copy()
    light[inside] = strided[0][inside]
    statistics = min(low, part.value_range[0]), max(high, part.value_range[1]), n_nonfinite
    return _native.Survey.from_parts(shape, kernel, side, statistics, bounds, [(light_step, light)])


def _steps(array: LazyArray, memory: int, part: ShownPart | None) -> list[Box]:
    """Boxes along the chunks that fill the volume, or the part that is shown, each read at once."""
    whole: Box = ((0, 0, 0), array.shape) if part is None else part.box
    most = min(STEP_BYTES, max(memory // 16, 1)) // array.dtype.itemsize
    return cells(whole, array.chunks, max(most, 1))


def _read_all(
    array: LazyArray,
    boxes: Sequence[Box],
    memory: int,
    add: Callable[[NDArray[Any], Box], None],
    *,
    holes: bool,
) -> int:
    """Read every box once, the next ones ahead; return the number of chunks that could not be read."""
    with BoxReader([array], holes=[0.0] if holes else None, memory=int(memory * FOR_UNPACKING)) as reader:
        pending = deque[Pending]()
        n_begun, n_ahead = 0, _n_ahead(array, boxes, memory)
        for k, box in enumerate(boxes):
            while n_begun < min(k + 1 + n_ahead, len(boxes)):
                pending.append(reader.begin(0, boxes[n_begun], [boxes[n_begun]]))
                n_begun += 1
            add(pending.popleft().result(), box)
            trim_heap()
            check_cancelled()
        return len(reader.counts.holes)


def _n_ahead(array: LazyArray, boxes: Sequence[Box], memory: int) -> int:
    """Boxes that are read ahead: those that a quarter of the budget holds beside the one that is looked through."""
    one = max(n_in(box) for box in boxes) * array.dtype.itemsize
    return min(max(2, array.n_readers) - 1, max(memory // 4 // one - 1, 0))


def _read_prepared(
    array: LazyArray,
    boxes: Sequence[Box],
    memory: int,
    around: Callable[[Box], Box],
    add: Callable[[NDArray[Any], Box, Box], None],
    *,
    holes: bool,
) -> None:
    """Read every box together with the samples that `around` says it needs."""
    with BoxReader([array], holes=[0.0] if holes else None, memory=int(memory * FOR_UNPACKING)) as reader:
        held = around(boxes[0])
        pending = reader.begin(0, held, [held])
        for k, box in enumerate(boxes):
            samples, own = pending.result(), held
            if k + 1 < len(boxes):
                held = around(boxes[k + 1])
                pending = reader.begin(0, held, [held])
            add(samples, box, own)
            del samples
            trim_heap()
            check_cancelled()


def _place_of(
    array: LazyArray, world_from_index: Matrix, kernel: str, keep: bool | str | os.PathLike[str]
) -> Place | None:
    """Folder and file name of a survey; None where it is not kept, or nothing identifies the samples."""
    if keep is False or (keep is True and array.files is None) or (array.files is None and array.token is None):
        return None
    state = "by name" if array.files is None else array.files.fingerprint()
    if state is None:
        return None
    is_ours = isinstance(keep, bool)
    try:
        folder = CacheFolder(default_folder("surveys") if isinstance(keep, bool) else expanded(keep), is_ours)
    except RuntimeError:  # no home
        return None
    # Samples for light, and what stands for missing ones, depend on distances in the world.
    axes = world_from_index[:3, :3].tolist()
    text = f"{FORMAT} {kernel} {array.shape} {array.dtype.str} {axes} {array.token} {state}"
    return folder, f"{hashlib.sha256(text.encode('utf-8', 'surrogateescape')).hexdigest()[:32]}.npz"


def _keep(place: Place, survey: Survey) -> None:
    parts: dict[str, NDArray[Any]] = {"format": np.array([FORMAT])}
    for part, core in (("samples", survey.core), ("prepared", survey.prepared)):
        if core is not None:
            side, bounds, strided = core.parts()
            if bounds.nbytes > MAX_KEPT_BYTES:
                return
            parts |= {f"{part} side": np.array([side]), f"{part} bounds": bounds}
            parts[f"{part} statistics"] = np.array(core.statistics, np.float64)
            parts[f"{part} light"] = strided[0]
    parts |= {f"look {k}": own for k, own in enumerate(survey.looks.parts())}
    folder, name = place
    folder.write(name, lambda file: np.savez_compressed(file, allow_pickle=False, **parts))


def _kept(place: Place, array: LazyArray, kernel: str, light_step: Shape, memory: int) -> Survey | None:
    """The cached survey; None where there is none, it is damaged, or it takes more than the budget allows."""
    folder, name = place
    file = folder.open(name)
    if file is None:
        return None
    try:
        with file, np.load(file, allow_pickle=False) as parts:
            # No more than is said here is unpacked.
            if sum(member.file_size for member in parts.zip.infolist()) > max(memory, 2 * MAX_KEPT_BYTES):
                return None
            core = _rebuilt(parts, "samples", array.shape, kernel, light_step)
            prepared = None
            if "prepared side" in parts.files:
                prepared = _rebuilt(parts, "prepared", array.shape, kernel, light_step)
            looks = LookSamples(array.shape, array.dtype)
            looks.fill(parts[f"look {k}"] for k in range(len(looks.parts())))
            bounds = math.prod(parts["samples bounds"].shape) * 4
    except DAMAGED:
        return None
    # Bounds for a larger budget would not leave room for samples.
    if bounds > memory // 3:
        return None
    return Survey(array.shape, core, prepared, kernel, light_step=light_step, looks=looks, is_from_cache=True)


def _rebuilt(parts: Any, name: str, shape: Shape, kernel: str, light_step: Shape) -> _native.Survey:
    low, high, n_nonfinite = parts[f"{name} statistics"].tolist()
    if parts["format"].tolist() != [FORMAT] or not -math.inf < low <= high < math.inf:
        raise ValueError("a survey of another kind")
    side, bounds = int(parts[f"{name} side"][0]), parts[f"{name} bounds"]
    light = [(light_step, parts[f"{name} light"])]
    return _native.Survey.from_parts(shape, kernel, side, (low, high, int(n_nonfinite)), bounds, light)
