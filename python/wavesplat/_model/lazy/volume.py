"""A volume whose samples stay where they are: read box by box while it is drawn, within a memory budget.

It may have several levels, such as each with half the samples of the finer one along an axis; a picture is drawn from
the coarsest level whose samples are no further apart than its pixels. One pass over the samples of a level gives its
survey (`survey.py`), made with the first picture and kept.
"""

from __future__ import annotations

import math
import pickle
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from os import PathLike
from typing import TYPE_CHECKING, Any, NoReturn

import numpy as np
from numpy.typing import NDArray

from wavesplat import _native
from wavesplat._model.arguments.clips import Crop
from wavesplat._model.arguments.types import is_whole_number_below
from wavesplat._model.lazy.array import lazy_array
from wavesplat._model.lazy.checks import LazyCache, look_again, narrowest_integer
from wavesplat._model.lazy.lazy_array import LazyArray
from wavesplat._model.lazy.survey import Survey, kept_survey, surveyed
from wavesplat._model.volume import affine
from wavesplat._model.volume.facts import Facts
from wavesplat._model.volume.grid import Grid
from wavesplat._model.volume.stack import Box
from wavesplat._model.volume.volume import Volume
from wavesplat._public import public
from wavesplat._storage.file_states import SourceFiles
from wavesplat._system.memory import byte_size, bytes_of, free_bytes
from wavesplat._system.values import described
from wavesplat.errors import ArgumentError

if TYPE_CHECKING:
    from numpy.typing import DTypeLike

    from wavesplat._model.volume.sources import Source

#: Default budget: one part in SHARE of the free memory, at most MAX_DEFAULT bytes.
SHARE, MAX_DEFAULT = 4, 4 * 10**9
#: Entries of `LazyCache.derived` that are kept, at most.
MAX_DERIVED = 4
#: Samples of the level that looks and cameras are made from, at most: SMALL, and one in OVERVIEW_SHARE of the finest
#: level's, since a first picture from afar must not wait for samples that it does not show.
SMALL, OVERVIEW_SHARE = 1 << 21, 64
#: Coarser levels that take no more than one part in COPY_SHARE of the budget are copied into memory.
COPY_SHARE = 8
#: Integers of 8 and 16 bits, which the compiled module calls narrow.
NARROW = ("u1", "i1", "u2", "i2")

Matrix = NDArray[np.float64]


@dataclass(frozen=True)
class Level:
    """The array of a level, and its affine."""

    array: LazyArray
    world_from_index: Matrix

    @property
    def spacing(self) -> tuple[float, float, float]:
        """Distances between neighbouring samples along x, y, z."""
        x, y, z = (float(step) for step in affine.spacing_of(self.world_from_index))
        return x, y, z


def default_memory() -> int:
    """Default budget for samples in bytes: a quarter of the free memory, at least 64 MiB and at most 4 GB."""
    free = free_bytes()
    return MAX_DEFAULT if free is None else max(min(free // SHARE, MAX_DEFAULT), 1 << 26)


@public
class LazyVolume(Volume):
    """A volume whose samples stay in their file, or array, and are read while it is drawn.

    `Volume.lazy` and `open(path, memory=...)` make it. It is drawn as any volume, by `render`, scenes, movies and the
    viewer, and to the byte as the CPU draws one in memory; functions that need all samples at once refuse it: take a
    part with `read`.

    Attributes
    ----------
    memory : int
        Bytes of samples, and of their bounds, that are held at once while it is drawn.
    levels : sequence of shapes (z, y, x)
        Shapes of its levels of detail, the finest first.

    Examples
    --------
    >>> import numpy as np, wavesplat as ws
    >>> array = np.array(ws.examples.ripples(32).samples)  # or an array of Zarr, Dask, h5py
    >>> lazy = ws.Volume.lazy(array, memory="100 MB")
    >>> a, b = (ws.render(volume, size=(32, 32)) for volume in (lazy, ws.Volume(array)))
    >>> np.array_equal(a.rgba, b.rgba)
    True
    """

    __slots__ = ("_at", "_cache", "_holes", "_keep", "_levels", "_memory")

    _levels: list[Level]
    #: The level that is drawn; None for the one that a picture needs.
    _at: int | None
    _memory: int
    _keep: bool | str | PathLike[str]
    _holes: bool
    #: Shared by the volumes that `at_level` makes.
    _cache: LazyCache

    @classmethod
    def _made(
        cls,
        levels: Sequence[Level],
        name: str,
        facts: Facts,
        *,
        memory: int | None = None,
        keep: bool | str | PathLike[str] = True,
        holes: bool = False,
    ) -> LazyVolume:
        volume = cls.__new__(cls)
        finest = levels[0]
        Grid.__init__(volume, name, finest.array.shape, finest.world_from_index, facts)
        if min(finest.array.shape) < 2:
            raise ArgumentError(
                f"volume {name!r}: shape {finest.array.shape} (z, y, x) has fewer than 2 samples along an axis, so it "
                "fills no space; give a stack of at least 2 slices of at least 2 x 2 samples"
            )
        volume._levels = list(levels)
        volume._memory = default_memory() if memory is None else memory
        volume._keep = keep
        volume._holes = holes
        volume._at = None
        volume._cache = LazyCache(volume.n_changes_of_files())
        volume._source = None
        volume._cut = None
        volume._resampled = None
        return volume

    # Access to samples, refused where all would be needed.

    def _refuse(self, what: str) -> NoReturn:
        raise ArgumentError(
            f"volume {self.name!r} is lazy, so {what} would have to read all of its "
            f"{byte_size(math.prod(self.shape) * self.dtype.itemsize)}; take a part or a coarser level first: "
            "volume.read(crop), volume.read(level=...), or open it without memory="
        )

    @property
    def samples(self) -> NDArray[Any]:
        """Refused: the samples are not in memory. `read` gives a part of them."""
        self._refuse("its samples")

    @property
    def _samples(self) -> NDArray[Any]:  # type: ignore[override]
        self._refuse("this")

    @property
    def _core(self) -> _native.Volume:  # type: ignore[override]
        self._refuse("this")

    def changed(self) -> None:
        """Report that the samples have changed: everything made from them is made anew.

        Call it after changing a memory map, a Dask array or data on a server: those are not checked. Chunks of Zarr
        arrays in folders that were written to are noticed at the next picture without it, and so are other files,
        which must be opened again.
        """
        self._cache.forget()
        self._source = None

    @property
    def _identity(self) -> tuple[object, int]:
        """Key that is equal for the same samples, and another one after a change."""
        return self._cache, self._cache.generation

    def notice_changes(self) -> None:
        """Drop everything made from the samples if their files have changed; in a picture only at its start.

        Raises
        ------
        FileError
            If a file has changed that must be opened again.
        """
        for files in self._files():
            look_again(files)
        n_changes = self.n_changes_of_files()
        if n_changes != self._cache.n_changes:
            self._cache.n_changes = n_changes
            self._cache.forget()

    def _files(self) -> list[SourceFiles]:
        """The files of all levels."""
        return [level.array.files for level in self._levels if level.array.files is not None]

    def n_changes_of_files(self, *, now: bool = False) -> int:
        """Number of changes found in the files, by any volume that reads them; `now`: check the files first."""
        for files in self._files() if now else ():
            files.look_again()
        return sum(files.n_changes for files in self._files())

    def _renew(self) -> None:
        self._cache.derived.clear()

    def __array__(self, dtype: DTypeLike | None = None, copy: bool | None = None) -> NDArray[Any]:
        """All samples, read into memory, as `numpy.asarray(volume)` asks for them."""
        samples = self.read().samples
        return samples if dtype is None else samples.astype(dtype)

    @property
    def dtype(self) -> np.dtype[Any]:
        """The type that the samples are read in: float64 for 64-bit integers."""
        return self._levels[0].array.dtype

    @property
    def _type_in_memory(self) -> np.dtype[Any]:
        array = self._levels[0].array
        return narrowest_integer(*self.value_range) if getattr(array, "is_wide_integer", False) else array.dtype

    @property
    def memory(self) -> int:
        """Bytes of samples, and of their bounds, that are held at once while it is drawn."""
        return self._memory

    @property
    def levels(self) -> tuple[tuple[int, int, int], ...]:
        """Shapes (z, y, x) of its levels of detail, the finest first."""
        return tuple(level.array.shape for level in self._levels)

    @property
    def level(self) -> int | None:
        """The level that is drawn, 0 the finest; None for the one that a picture needs."""
        return self._at

    @property
    def value_range(self) -> tuple[float, float]:
        """Smallest and largest finite sample; in a pyramid, of a small level.

        Reads all samples of that level, unless that was done before.
        """
        return self.survey(self._surveyed_level(), "linear").value_range

    @property
    def n_nonfinite(self) -> int:
        """Number of NaN and infinite samples of the level of `value_range`: missing ones, which make matter fainter."""
        return self.survey(self._surveyed_level(), "linear").n_nonfinite

    @property
    def is_from_cache(self) -> bool:
        """Whether range and values come from a cache folder, by an earlier pass over the samples."""
        return self.survey(self._surveyed_level(), "linear").is_from_cache

    @property
    def is_looked_through(self) -> bool:
        """Whether range and values are known or quickly found: samples were looked through before, or are few."""
        level = self._surveyed_level()
        if math.prod(self._levels[level].array.shape) <= SMALL:
            return True
        return self.known_survey(level, "linear") is not None or (level, "linear", None) in self._cache.surveys

    @property
    def fits_in_budget(self) -> bool:
        """Whether all samples take no more than a quarter of the budget."""
        return math.prod(self.shape) * self.dtype.itemsize <= self._memory // 4

    def _surveyed_level(self) -> int:
        """The level that ranges and looks are made from: the finest of few samples (`SMALL`, `OVERVIEW_SHARE`)."""
        if self._at is not None:
            return self._at
        sizes = [math.prod(level.array.shape) for level in self._levels]
        if sizes[0] <= SMALL:
            return 0
        fitting = [k for k, size in enumerate(sizes) if size <= min(SMALL, sizes[0] / OVERVIEW_SHARE)]
        return fitting[0] if fitting else len(self._levels) - 1

    # Other volumes of the same levels.

    def at_level(self, level: int | None) -> LazyVolume:
        """The same volume, drawn from one level of detail: 0 is the finest, None the level that a picture needs.

        Raises
        ------
        ArgumentError
            If there is no such level.
        """
        n = len(self._levels)
        if level is not None and not is_whole_number_below(level, n):
            raise ArgumentError(
                f"level is {described(level)}; {self.name!r} has {n} levels, so give 0 to {n - 1}, or None"
            )
        other = self._copy()
        other._at = level
        return other

    def with_memory(self, memory: float | str) -> LazyVolume:
        """The same volume with another budget, such as "2 GB".

        Raises
        ------
        ArgumentError
            If it is not an amount of memory.
        """
        other = self._copy()
        other._memory = bytes_of(memory)
        # Bounds are as fine as the budget allows.
        other._cache = LazyCache(self._cache.n_changes)
        return other

    def _placed(self, world_from_world: Matrix, facts: Facts, source: Source | None) -> LazyVolume:
        levels = [Level(one.array, _frozen(world_from_world @ one.world_from_index)) for one in self._levels]
        made = LazyVolume._made(levels, self.name, facts, memory=self._memory, keep=self._keep, holes=self._holes)
        made._at, made._source = self._at, source
        return made

    def _copy(self) -> LazyVolume:
        made = LazyVolume._made(
            self._levels, self.name, self.facts, memory=self._memory, keep=self._keep, holes=self._holes
        )
        made._at, made._source, made._cache = self._at, self._source, self._cache
        return made

    def read(self, crop: Crop | None = None, *, level: int | None = None) -> Volume:
        """A part of the volume in memory: the samples of a level in a box.

        Parameters
        ----------
        crop : Crop, optional
            The box, in the world or in samples (x, y, z) of the finest level; None is all of it.
        level : int, optional
            Which level, 0 the finest; None is the level chosen by `at_level`, else the finest.

        Returns
        -------
        Volume
            The samples, at their place in the world.

        Raises
        ------
        LimitError
            If the samples do not fit into this machine's memory.
        FileError
            If a part of them cannot be read; the message names it.
        """
        from wavesplat._model.lazy.parts import part_of

        self.notice_changes()
        chosen = self._levels[self._checked(level)]
        return part_of(self, chosen, crop)

    def _checked(self, level: int | None) -> int:
        if level is None:
            return self._at or 0
        if not is_whole_number_below(level, len(self._levels)):
            raise ArgumentError(f"level is {described(level)}; there are {len(self._levels)} levels, 0 is the finest")
        return level

    def _stored_grid(self) -> Grid:
        return self.grid_of(self._checked(None))

    def _stored_box(self, box: Box) -> NDArray[Any]:
        from wavesplat._model.lazy.parts import read_box

        return read_box(self._levels[self._checked(None)].array, box)

    def preview(self) -> Volume:
        """A coarse copy in memory, of some millions of samples at most, for pictures that must come at once."""
        from wavesplat._model.lazy.parts import preview_of

        found: Volume | None = self._cache.derived.get("preview")
        if found is None:
            found = self._cache.derived["preview"] = preview_of(self, self._surveyed_level())
        return found

    # Data for pictures.

    def survey(self, level: int, kernel: str, box: Box | None = None) -> Survey:
        """The survey of a level, by one pass over its samples, or its samples in a box (`box_of_crop`); made once."""
        self.notice_changes()
        found = self._cache.surveys.get((level, kernel, box))
        if found is None:
            from wavesplat._model.lazy.parts import shown_part

            own = self._levels[level]
            found = surveyed(
                self.arrays(level),
                own.world_from_index,
                kernel,
                self._memory,
                keep=self._keep,
                holes=self._holes,
                part=None if box is None else shown_part(self, level, box),
            )
            self._cache.surveys[level, kernel, box] = found
        return found

    def known_survey(self, level: int, kernel: str, box: Box | None = None) -> Survey | None:
        """The survey of a level, bounds included, if it is there without reading samples; else None."""
        self.notice_changes()
        found = self._cache.surveys.get((level, kernel, box))
        if box is not None:
            return found if found is not None and found.core.has_bounds else None
        if found is None or not found.core.has_bounds:
            found = kept_survey(
                self._levels[level].array, self._levels[level].world_from_index, kernel, self._memory, self._keep
            )
        return found

    def packed_surveys(self, level: int, kernel: str, box: Box | None) -> bytes:
        """The surveys of a level, or of a box of it, pickled for another process."""
        found = {}
        for own in {kernel, "linear"} if level > 0 else {kernel}:
            survey = self.survey(level, own, box)
            if not survey.core.has_bounds:
                self._cache.surveys.pop((level, own, box))
                survey = self.survey(level, own, box)
            found[level, own, box] = survey
        return pickle.dumps(found)

    def take_surveys(self, packed: bytes) -> None:
        """Add the surveys that `packed_surveys` pickled."""
        for key, survey in pickle.loads(packed).items():  # noqa: S301 - from our own process
            if key not in self._cache.surveys:
                self._cache.surveys[key] = survey

    def _every(self, step: int) -> NDArray[Any]:
        """Every n-th sample along each axis, [z, y, x]; of a pyramid the nearest samples of a coarser level."""
        level = self._surveyed_level()
        if level == 0 and self._at is None:
            found = self.survey(0, "linear").looks.every(step)
            if found is not None:
                return found
        from wavesplat._model.lazy.parts import nearest_every

        return nearest_every(self, self._levels[level], level, (step, step, step))

    def _with_neighbours(self, step: int) -> tuple[NDArray[Any], list[tuple[NDArray[Any], NDArray[Any]]]] | None:
        """Samples `step` apart and their neighbours along each axis, as its survey kept them; None of a pyramid."""
        if self._surveyed_level() != 0 or self._at is not None:
            return None
        looks = self.survey(0, "linear").looks
        return looks.with_neighbours if looks.neighbour_step == step else None

    def _busiest_part(self) -> NDArray[Any] | None:
        """Samples of the finest level side by side, where values vary most; None where the survey kept neighbours."""
        from wavesplat._model.lazy.parts import busiest_part

        level = self._surveyed_level()
        if level == 0:
            return None
        found: NDArray[Any] | None = self._cache.derived.get("busiest")
        if found is None:
            found = self._cache.derived["busiest"] = busiest_part(self, level)
        return found

    def _overview(self, level: int) -> NDArray[Any]:
        """All samples of a small level."""
        from wavesplat._model.lazy.parts import read_box

        found: NDArray[Any] | None = self._cache.derived.get(("overview", level))
        if found is None:
            array = self._levels[level].array
            if array.files is not None:
                array.files.begin()
            found = self._cache.derived["overview", level] = read_box(array, ((0, 0, 0), array.shape))
        return found

    def core_of(self, level: int, kernel: str, box: Box | None = None) -> _native.LazyVolume:
        """The compiled module's `LazyVolume` of a level, which plans frames; `box`: the only part that is read."""
        self.notice_changes()
        key = level, kernel, box
        core: _native.LazyVolume | None = self._cache.derived.pop(key, None)
        if core is None:
            from wavesplat._model.lazy.parts import level_in_finest

            own, survey = self._levels[level], self.survey(level, kernel, box)
            if not survey.core.has_bounds:  # an earlier `_native.LazyVolume` took them
                self._cache.surveys.pop(key)
                survey = self.survey(level, kernel, box)
            core = _native.LazyVolume(
                self.name,
                own.array.shape,
                own.world_from_index,
                kernel=kernel,
                is_narrow=own.array.dtype.str[1:] in NARROW,
                survey=survey.core,
                prepared=survey.prepared,
                light=0,
                chunk=own.array.chunks,
                sample_bytes=own.array.dtype.itemsize,
                level=level_in_finest(self, level, box),
            )
            survey.forget_bounds()
        self._cache.derived[key] = core
        while len(self._cache.derived) > MAX_DERIVED:
            self._cache.derived.pop(next(iter(self._cache.derived)), None)
        return core

    def level_for(self, pixel: Callable[[Level], float]) -> int:
        """The level to draw: the one of `at_level`, else the coarsest whose samples are no further apart than pixels.

        pixel : smallest distance of pixels, in samples of a level.
        """
        if self._at is not None:
            return self._at
        for k in range(len(self._levels) - 1, 0, -1):
            if pixel(self._levels[k]) >= 1 and min(self._levels[k].array.shape) >= 2:
                return k
        return 0

    def grid_of(self, level: int) -> Grid:
        """The grid of a level."""
        chosen = self._levels[level]
        return Grid(self.name, chosen.array.shape, chosen.world_from_index, self.facts)

    def arrays(self, level: int) -> LazyArray:
        """The array of a level; for a small coarser one a copy in memory, which is read once."""
        array = self._levels[level].array
        n_bytes = math.prod(array.shape) * array.dtype.itemsize
        if level == 0 or array.is_in_memory or n_bytes > self._memory // COPY_SHARE:
            return array
        copy: LazyArray | None = self._cache.derived.get(("copy", level))
        if copy is None:
            copy = self._cache.derived["copy", level] = lazy_array(self._overview(level)).levels[0]
        return copy

    @property
    def holes(self) -> bool:
        """Whether samples that cannot be read are left out, and reported, instead of ending a picture."""
        return self._holes

    def __repr__(self) -> str:
        n_z, n_y, n_x = self.shape
        levels = f", {len(self._levels)} levels" if len(self._levels) > 1 else ""
        return (
            f"<LazyVolume {self.name!r}: z {n_z}, y {n_y}, x {n_x}, {self.dtype}, "
            f"{byte_size(math.prod(self.shape) * self.dtype.itemsize)}{levels}, memory {byte_size(self._memory)}>"
        )

    def __reduce__(self) -> tuple[Any, ...]:
        keep = self._keep if isinstance(self._keep, bool) else str(self._keep)
        shown = self._at, self._source
        return _rebuilt, (self._levels, (self.name, self.facts), (self._memory, keep, self._holes), shown)


def _rebuilt(
    levels: list[Level],
    place: tuple[str, Facts],
    how: tuple[int, bool | str, bool],
    shown: tuple[int | None, Source | None],
) -> LazyVolume:
    (name, facts), (memory, keep, holes) = place, how
    volume = LazyVolume._made(levels, name, facts, memory=memory, keep=keep, holes=holes)
    volume._at, volume._source = shown
    return volume


def lazily(
    levels: Sequence[LazyArray],
    places: Sequence[Matrix],
    name: str,
    facts: Facts,
    *,
    memory: float | str | None,
    level: int | None = None,
    keep: bool | str | PathLike[str] = True,
    holes: bool = False,
) -> LazyVolume:
    """A lazy volume of levels with these affines."""
    budget = None if memory is None else bytes_of(memory)
    own = [Level(array, _frozen(place)) for array, place in zip(levels, places, strict=True)]
    volume = LazyVolume._made(own, name, replace(facts), memory=budget, keep=keep, holes=holes)
    return volume if level is None else volume.at_level(level)


def _frozen(matrix: Matrix) -> Matrix:
    own = np.array(matrix, np.float64)
    own.flags.writeable = False
    return own
