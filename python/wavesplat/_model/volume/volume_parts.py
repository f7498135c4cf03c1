"""A volume whose samples lie in several processes, each of which has a box of them: ranks of MPI, as a rule.

What a frame is planned with (range of values, bounds of bricks, samples for looks and light) is gathered from all
parts: each process makes the overview of its own samples, all get all overviews, and each then has a lazy volume of
the whole that plans the same frame as every other, and reads nothing but its own box.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from wavesplat import _native
from wavesplat._model.arguments.types import text_of
from wavesplat._model.interchange.convert_from import converted
from wavesplat._model.lazy.checks import DEFAULT_SIDE, renderable_type
from wavesplat._model.lazy.read_ahead import n_in
from wavesplat._model.lazy.survey import LookSamples, Survey
from wavesplat._model.lazy.volume import LazyVolume, lazily
from wavesplat._model.volume.facts import Facts
from wavesplat._model.volume.volume import _checked_affine, _checked_facts
from wavesplat._public import public
from wavesplat._storage.paths import printable
from wavesplat._system.values import described
from wavesplat.errors import ArgumentError, WavesplatError

#: Kernels whose densities are of samples as they are; the others need coefficients of the whole volume.
KERNELS = ("linear", "catmull-rom", "gaussian")
#: Bytes of bounds of the whole volume, for each kernel: the same for all parts, whatever memory their machines have.
BOUNDS_BYTES = 1 << 25
#: Layers along z of a part that are looked through at once.
AT_ONCE = 32

Shape = tuple[int, int, int]
Box = tuple[Shape, Shape]
#: A part of an array: its place, and its values.
Placed = tuple[tuple[slice, ...], NDArray[Any]]


@dataclass(frozen=True)
class Overview:
    """Range, bounds and thinned samples of one part, which all processes must know (`VolumePart.overview`)."""

    #: Shape (z, y, x), affine and type of the whole volume, in which all parts must agree.
    whole: tuple[Shape, tuple[float, ...], str]
    #: First index and end, z, y, x, of the part's own samples.
    own: Box
    #: Smallest and largest finite sample, and number of samples that are not finite.
    statistics: tuple[float, float, int]
    #: By kernel: side of a brick, and least and largest values of the bricks that the part's samples reach.
    bounds: dict[str, tuple[int, Placed]]
    light: Placed
    looks: list[Placed]


class PartArray:
    """The samples of one part as a lazy array of the whole volume: others cannot be read.

    samples : array [z, y, x] that begins at the index `start` of the whole; None in a process that has none.
    overviews : of all parts.
    """

    def __init__(
        self, name: str, own: Box, start: Shape, samples: NDArray[Any] | None, overviews: list[Overview]
    ) -> None:
        self._samples, self._overviews = samples, overviews
        self.name, self.own, self.start = name, own, start
        self.shape, self._axes, code = overviews[0].whole
        self.dtype = np.dtype(code)
        z, y, x = (min(DEFAULT_SIDE, n) for n in self.shape)
        self.chunks: Shape = (z, y, x)
        self.is_in_memory, self.n_readers, self.reads_together = True, 4, False
        self.token = self.files = None
        #: Whether samples of other parts are read as the nearest of this part.
        self.is_repeated = False

    def repeated(self) -> PartArray:
        """The same array, from which samples of other parts are read as the nearest of this part."""
        other = PartArray(self.name, self.own, self.start, self._samples, self._overviews)
        other.is_repeated = True
        return other

    @property
    def boxes(self) -> list[Box]:
        """First index and end of the samples of all parts."""
        return [overview.own for overview in self._overviews]

    def read(self, lo: Shape, hi: Shape) -> NDArray[Any]:
        """Read the samples of the box from `lo` to before `hi`."""
        if self._samples is None:
            raise ArgumentError(f"volume {self.name!r}: this process has no part of its samples")
        first = [a - own for a, own in zip(lo, self.start, strict=True)]
        end = [b - own for b, own in zip(hi, self.start, strict=True)]
        if all(a >= 0 and b <= n for a, b, n in zip(first, end, self._samples.shape, strict=True)):
            return self._samples[tuple(slice(a, b) for a, b in zip(first, end, strict=True))]
        if not self.is_repeated:
            raise ArgumentError(
                f"volume {self.name!r}: this process has a part of its samples, {_text_of(self.own)}; draw with "
                "ws.render_part, and give looks to projections, whose brightness depends on the whole"
            )
        n = self._samples.shape
        places = [np.clip(np.arange(a, b), 0, size - 1) for a, b, size in zip(first, end, n, strict=True)]
        repeated: NDArray[Any] = self._samples[np.ix_(*places)]
        return repeated

    def read_many(self, boxes: Sequence[Box]) -> list[NDArray[Any]]:
        """Read the samples of several boxes."""
        return [self.read(*box) for box in boxes]

    def survey(self, kernel: str) -> Survey:
        """The survey of the whole volume, merged from the surveys of all parts."""
        if kernel not in KERNELS:
            raise ArgumentError(
                f"kernel is {kernel!r}, whose coefficients depend on all samples, and this process has a part of them; "
                f"give {', '.join(map(repr, KERNELS[:-1]))} or {KERNELS[-1]!r}"
            )
        light_step = _light_step(self.shape, self._axes)
        core = _native.Survey(self.shape, kernel, BOUNDS_BYTES, [light_step])
        side, bounds, (light,) = core.parts()
        looks = LookSamples(self.shape, self.dtype)
        arrays = looks.parts()
        with _damage_errors(self.name):
            for overview in self._overviews:
                place, own = overview.bounds[kernel][1]
                low, high = bounds[..., 0][place], bounds[..., 1][place]
                np.minimum(low, own[..., 0], out=low)
                np.maximum(high, own[..., 1], out=high)
                for array, (place, values) in zip([light, *arrays], [overview.light, *overview.looks], strict=True):
                    if array[place].shape != np.shape(values):
                        raise ValueError(f"samples of shape {np.shape(values)} for {array[place].shape}")
                    array[place] = values
        looks.fill(arrays)
        made = _native.Survey.from_parts(
            self.shape, kernel, side, statistics_of(self._overviews), bounds, [(light_step, light)]
        )
        return Survey(self.shape, made, None, kernel, light_step=light_step, looks=looks)

    def __getstate__(self) -> dict[str, Any]:
        # The samples stay where they are.
        return {**self.__dict__, "_samples": None}


@contextmanager
def _damage_errors(name: str) -> Iterator[None]:
    """Turn errors from damaged overviews into an `ArgumentError`."""
    try:
        yield
    except WavesplatError:
        raise
    except (TypeError, ValueError, IndexError, KeyError, AttributeError) as error:
        raise ArgumentError(
            f"parts of {name!r}: an overview was damaged on its way ({type(error).__name__}: {error}); send what "
            "overview() returns, as a whole"
        ) from None


def statistics_of(overviews: Iterable[Overview]) -> tuple[float, float, int]:
    """Smallest and largest finite sample of all parts, and number of samples that are not finite."""
    lows, highs, numbers = zip(*(overview.statistics for overview in overviews), strict=True)
    return min(lows), max(highs), sum(numbers)


@public
class VolumePart:
    """The samples of one process that are a box of a larger volume, of which other processes have the rest.

    Parameters
    ----------
    samples : array, shape (z, y, x)
        The part's own samples, and its neighbours' samples around them (ghost or halo samples): with three layers the
        picture is the picture of the whole but for rounding, where the reconstruction is "linear"; four for
        "catmull-rom". With fewer the outermost samples are repeated, which changes the light near faces that parts
        share. Samples that lie beyond the whole, in arrays with ghost samples all around, are left out.
        Shared, not copied, where it is an array of a type that the renderer takes, in C or any other order.
    start : (z, y, x)
        Index in the whole of the first of these samples; below 0 where it lies beyond the whole.
    own : ((z, z), (y, y), (x, x))
        First index and end of the part's own samples in the whole, without its neighbours'. The parts of all
        processes tile the whole.
    shape : (z, y, x)
        Samples of the whole volume.
    spacing, world_from_index, unit, name : optional
        As for `Volume`, of the whole volume.

    Raises
    ------
    ArgumentError
        If the boxes do not fit together, or the place is degenerate.

    Examples
    --------
    Two parts in one process; docs/large_volumes.md has ranks of MPI:

    >>> import numpy as np, wavesplat as ws
    >>> field = np.asarray(ws.examples.ripples(24).samples)
    >>> lower = ws.VolumePart(field[:15], (0, 0, 0), ((0, 12), (0, 24), (0, 24)), field.shape)
    >>> upper = ws.VolumePart(field[9:], (9, 0, 0), ((12, 24), (0, 24), (0, 24)), field.shape)
    >>> overviews = [part.overview() for part in (lower, upper)]
    >>> drawn = [ws.render_part(part.whole(overviews), size=(32, 32)) for part in (lower, upper)]
    >>> ws.merge(drawn).size
    (32, 32)
    """

    def __init__(
        self,
        samples: ArrayLike,
        start: Sequence[int],
        own: Sequence[Sequence[int]],
        shape: Sequence[int],
        *,
        spacing: Sequence[float] | None = None,
        world_from_index: ArrayLike | None = None,
        unit: str | None = None,
        name: str = "volume",
    ) -> None:
        self.name = printable(text_of(name, "name of the volume"))
        given = np.asarray(converted(samples, "samples", has_place=True).samples)
        if given.ndim != 3 or min(given.shape) < 1:
            raise ArgumentError(f"part of {self.name!r}: samples have shape {given.shape}; give (z, y, x)")
        self.shape = _three(shape, "shape", self.name)
        given, self.start = _inside(given, _three(start, "start", self.name, least=-math.inf), self.shape)
        self._samples = np.asarray(given, renderable_type(given.dtype, self.name))
        self.own = _checked_box(own, self.start, given.shape, self.shape, self.name)
        self._matrix = _checked_affine(spacing, world_from_index, self.name)
        self._facts = _checked_facts(Facts(), unit, None, self.name)

    def overview(self) -> Overview:
        """Range, bounds and thinned samples of this part, to be sent to all processes, by `allgather` of MPI, say.

        A part's share of at most 2 million samples for looks, of the samples for light (all, of volumes up to 288
        samples long; else a part of them), and of bounds. It can be pickled.
        """
        axes = tuple(self._matrix[:3, :3].ravel().tolist())
        step = _light_step(self.shape, axes)
        looks = LookSamples(self.shape, self._samples.dtype)
        cores = {kernel: _native.Survey(self.shape, kernel, BOUNDS_BYTES, [step]) for kernel in KERNELS}
        (first, y, x), (end, y_end, x_end) = self.own
        for z in range(first, end, AT_ONCE):
            lo, hi = (z, y, x), (min(z + AT_ONCE, end), y_end, x_end)
            inner = tuple(slice(a - s, b - s) for a, b, s in zip(lo, hi, self.start, strict=True))
            samples = np.ascontiguousarray(self._samples[inner])
            looks.take(samples, lo)
            for core in cores.values():
                core.add(samples, lo)
        parts = {kernel: core.parts() for kernel, core in cores.items()}
        light = parts[KERNELS[0]][2][0]
        return Overview(
            whole=(self.shape, axes, self._samples.dtype.str),
            own=self.own,
            statistics=cores[KERNELS[0]].statistics,
            bounds={kernel: (side, _known(reached)) for kernel, (side, reached, _) in parts.items()},
            light=_cut(light, ((0, 0, 0), step), self.own),
            looks=[_cut(samples, place, self.own) for samples, place in looks.placed()],
        )

    def whole(self, overviews: Iterable[Overview | None], *, memory: float | str | None = None) -> LazyVolume:
        """The whole volume, of which this process has its part, for `render_part`.

        Parameters
        ----------
        overviews : iterable of Overview or None
            The overviews of all parts, this one's included, in any order. None is left out: of a process without
            samples.
        memory : str or number, optional
            As for `Volume.lazy`: bytes of copies that are made while it is drawn.

        Raises
        ------
        ArgumentError
            If the parts do not tile the volume, or samples are missing (NaN): fill them first.
        """
        given = [one for one in overviews if one is not None]
        for one in given:
            if not isinstance(one, Overview):
                raise ArgumentError(
                    f"parts of {self.name!r}: an overview is a {type(one).__name__}; give what overview() returns"
                )
        with _damage_errors(self.name):
            known = sorted(given, key=lambda overview: overview.own)
            _check_one_whole(known, self.name)
            _check_tiling(known, self.own, self.shape, self.name)
            low, high, n_missing = statistics_of(known)
        if n_missing or not low <= high:
            raise ArgumentError(
                f"volume {self.name!r}: {n_missing} samples are NaN or infinite, which parts of a volume cannot fill; "
                "give them a value, such as numpy.nan_to_num(samples)"
            )
        array = PartArray(self.name, self.own, self.start, self._samples, known)
        return lazily([array], [self._matrix], self.name, self._facts, memory=memory, keep=False)


def _light_step(shape: Shape, axes: Sequence[float]) -> Shape:
    matrix = np.eye(4)
    matrix[:3, :3] = np.reshape(axes, (3, 3))
    return _native.light_step(shape, matrix)


def _known(bounds: NDArray[np.float32]) -> Placed:
    """The box of bricks that a survey has bounds of, and the bounds."""
    is_known = bounds[..., 0] <= bounds[..., 1]
    place = []
    for axis in range(3):
        others = tuple(other for other in range(3) if other != axis)
        numbers = np.flatnonzero(is_known.any(axis=others))
        place.append(slice(int(numbers[0]), int(numbers[-1]) + 1) if len(numbers) else slice(0, 0))
    return tuple(place), bounds[tuple(place)].copy()


def _cut(samples: NDArray[Any], of: tuple[Shape, Shape], own: Box) -> Placed:
    """The thinned samples that lie in a box: their place among all, and their values.

    of : index of the first of all thinned samples, and the steps between them.
    """
    place = []
    for count, first, step, low, high in zip(samples.shape, *of, *own, strict=True):
        begin, end = (min(max(0, -((first - bound) // step)), count) for bound in (low, high))
        place.append(slice(begin, max(begin, end)))
    return tuple(place), samples[tuple(place)].copy()


def _inside(samples: NDArray[Any], start: Shape, shape: Shape) -> tuple[NDArray[Any], Shape]:
    """The samples that lie in the whole, and the index of the first."""
    low = [min(max(0, -first), n) for first, n in zip(start, samples.shape, strict=True)]
    high = [max(0, size - first) for first, size in zip(start, shape, strict=True)]
    z, y, x = (first + a for first, a in zip(start, low, strict=True))
    return samples[tuple(slice(a, b) for a, b in zip(low, high, strict=True))], (z, y, x)


def _three(numbers: Sequence[int], what: str, name: str, *, least: float = 0) -> Shape:
    try:
        z, y, x = (int(n) for n in numbers if int(n) == n and n >= least)
    except (TypeError, ValueError):
        raise ArgumentError(
            f"part of {name!r}: {what} is {described(numbers)}; give three whole numbers (z, y, x)"
        ) from None
    return z, y, x


def _checked_box(own: Sequence[Sequence[int]], start: Shape, held: Sequence[int], shape: Shape, name: str) -> Box:
    try:
        low, high = zip(*((first, end) for first, end in own), strict=True)
    except (TypeError, ValueError):
        raise ArgumentError(
            f"part of {name!r}: own is {described(own)}; give first index and end along each axis: "
            "((0, 64), (0, 64), (32, 64)), z first"
        ) from None
    box = _three(low, "the lower corner of own", name), _three(high, "the upper corner of own", name)
    if min(shape) < 2:
        raise ArgumentError(f"part of {name!r}: shape is {shape}; a volume has 2 samples or more along every axis")
    for axis, a, b, first, n, size in zip("zyx", *box, start, held, shape, strict=True):
        if not (a < b <= size and first <= a and b <= first + n and first + n <= size):
            raise ArgumentError(
                f"part of {name!r}: along {axis} the samples are {first} to {first + n} of {size}, and its own are "
                f"{a} to {b}; its own must lie within the samples, and these within the whole"
            )
    return box


def _check_one_whole(known: list[Overview], name: str) -> None:
    """Raise an `ArgumentError` where parts say different things of the whole, with what two of them say."""
    for other in known[1:]:
        for what, one, two in zip(("shape", "axes", "type of samples"), known[0].whole, other.whole, strict=True):
            if one != two:
                texts = [np.dtype(fact).name if isinstance(fact, str) else fact for fact in (one, two)]
                raise ArgumentError(
                    f"parts of {name!r} differ in the {what} of the whole: {texts[0]} of {_text_of(known[0].own)}, and "
                    f"{texts[1]} of {_text_of(other.own)}; give all of them the same"
                )


def _check_tiling(known: list[Overview], own: Box, shape: Shape, name: str) -> None:
    """Raise an `ArgumentError` unless the boxes tile the volume, and one of them is this part's."""
    boxes = [overview.own for overview in known]
    for one, other in itertools.combinations(boxes, 2):
        if all(max(a, c) < min(b, d) for a, b, c, d in zip(*one, *other, strict=True)):
            raise ArgumentError(
                f"parts of {name!r} overlap: {_text_of(one)}, and {_text_of(other)}; own samples, without ghost "
                "samples, must be of one part only"
            )
    n_own = sum(n_in(box) for box in boxes)
    if n_own != math.prod(shape):
        raise ArgumentError(
            f"the parts of {name!r} have {n_own} samples of {math.prod(shape)}; give the overviews of all of them"
        )
    if own not in boxes:
        raise ArgumentError(f"the overviews of {name!r} lack the overview of this part, {_text_of(own)}; give all")


def _text_of(box: Box) -> str:
    return ", ".join(f"{axis} {a} to {b}" for axis, a, b in zip("zyx", *box, strict=True))
