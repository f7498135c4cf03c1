"""Arrays whose samples are read on demand, box by box: the sources of lazy volumes.

Any object with a shape, a type and slicing will do; objects of Zarr, Dask, h5py, xarray and NumPy's memory maps are
recognised by their attributes, so that their chunks, names and identities are used. Arrays that cannot be sent to
another process are sent by the name of their file, and opened there.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from functools import partial
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wavesplat._model.arguments.types import VOLUME
from wavesplat._model.interchange.converted import check_shape
from wavesplat._model.interchange.hdf5 import check_nesting, files_of_dataset, is_own_file, open_hdf5, place_of
from wavesplat._model.interchange.labelled_array import in_order, is_labelled
from wavesplat._model.lazy.checks import (
    DEFAULT_SIDE,
    checked_chunks,
    checked_shape,
    checked_type,
    converted,
    is_wide_integer,
    renderable_type,
)
from wavesplat._model.lazy.lazy_array import LazyArray, Shape
from wavesplat._model.volume.facts import Facts
from wavesplat._model.volume.stack import Box
from wavesplat._storage.file_states import FileChangedError, SourceFiles, StoredFiles
from wavesplat._storage.web import ServerError
from wavesplat._storage.zarr.chunk_files import check_chunks, chunk_files
from wavesplat._storage.zarr.reading import zarr_reader
from wavesplat._system.libraries import library
from wavesplat._system.values import described
from wavesplat.errors import ArgumentError, FileError, WavesplatError

#: Threads that read at once, where that helps.
N_READERS = 4
#: Chunks that are read one by one, at most, to find one that cannot be read.
MAX_LOOKED_THROUGH = 512


@dataclass(frozen=True)
class LazyConverted:
    """The levels of an object, the finest first, their affines where it has them, facts, and a name."""

    levels: list[LazyArray]
    world_from_index: list[NDArray[np.float64]] | None = None
    facts: Facts = field(default_factory=Facts)
    name: str | None = None
    #: Signs of the axes x, y, z, where the caller gives their distances (see `Converted`).
    directions: tuple[float, float, float] = (1.0, 1.0, 1.0)


class SlicedArray:
    """Samples that are read by slicing an array of any number of axes.

    array : the array, or None where `opened` opens it, once in each process.
    order : which axes of the array are z, y, x; two of a single plane, which has one sample along z.
    picked : the index along every axis, None for z, y and x, a slice for an axis that `convert` takes away.
    convert : makes samples of a part of the array, whose axes are still in the array's order.
    token : a name for the array; `files`, where given, identify its content.
    reads_parts : whether a part of a chunk is read without the rest of it.
    """

    def __init__(
        self,
        array: Any,
        *,
        name: str,
        chunks: Sequence[int],
        order: tuple[int, ...] = (0, 1, 2),
        picked: Sequence[int | slice | None] = (None, None, None),
        opened: Callable[[], Any] | None = None,
        convert: Callable[[NDArray[Any]], NDArray[Any]] | None = None,
        dtype: np.dtype[Any] | None = None,
        shape: Shape | None = None,
        n_readers: int = N_READERS,
        token: str | None = None,
        files: SourceFiles | None = None,
        check: Callable[[Any, Sequence[int | slice]], None] | None = None,
        reads_parts: bool = False,
    ) -> None:
        self._array, self._opened, self._fills = array, opened, hasattr(array, "read_into")
        self._process = os.getpid()
        self._order, self._picked = order, tuple(picked)
        self._convert, self._check = convert, check
        self.name, self.n_readers, self.files = name, n_readers, files
        own = self._source if shape is None or dtype is None else None
        full = tuple(int(n) for n in own.shape) if own is not None else ()
        z, y, x = shape if shape is not None else along_zyx(full, order, 1)
        self.shape = (z, y, x)
        self._stored = np.dtype(own.dtype) if own is not None else np.dtype(dtype)
        declared = self._stored if dtype is None else dtype
        self.dtype, self.is_wide_integer = renderable_type(declared, name), is_wide_integer(declared)
        z, y, x = (max(1, min(int(n), size)) for n, size in zip(chunks, self.shape, strict=True))
        self.chunks = (z, y, x)
        self.token = None if token is None else f"{token} {self._stored.str} {order} {self._picked}"
        self.is_in_memory = isinstance(array, np.ndarray) and not isinstance(array, np.memmap)
        self.reads_together = False
        self.reads_parts = reads_parts or isinstance(array, np.memmap)

    @property
    def _source(self) -> Any:
        # A forked process shares the offsets in open files with its parent: it opens them anew.
        if self._opened is not None and (self._array is None or self._process != os.getpid()):
            self._array, self._process = self._opened(), os.getpid()
        return self._array

    def _index(self, lo: Shape, hi: Shape) -> tuple[int | slice, ...]:
        index: list[int | slice] = [slice(None) if one is None else one for one in self._picked]
        n = len(self._order)
        for axis, first, end in zip(self._order, lo[-n:], hi[-n:], strict=True):
            index[axis] = slice(first, end)
        return tuple(index)

    def _turned(self, part: Any) -> NDArray[Any]:
        """Samples that were read, as [z, y, x]."""
        kept, samples = sorted(self._order), np.asanyarray(part)
        if self._convert is not None:
            samples = self._convert(samples)
        samples = np.transpose(samples, [kept.index(axis) for axis in self._order])
        return samples if samples.ndim == 3 else samples[np.newaxis]

    def _made(self, part: Any) -> NDArray[Any]:
        """Samples that were read, as [z, y, x] and in the renderer's type."""
        return converted(self._turned(part), self.dtype, self._stored, self.name)

    def whole(self) -> NDArray[Any]:
        """All samples, in the type that they are stored in; errors come from the library that reads them."""
        source, index = self._source, self._index((0, 0, 0), self.shape)
        if self._check is not None:
            self._check(source, index)
        read = getattr(source, "read_by_threads", source.__getitem__)
        return self._turned(read(index))

    def read(self, lo: Shape, hi: Shape) -> NDArray[Any]:
        """Read the samples of a box."""
        with self._reading(lo, hi):
            samples = self._read(lo, hi)
        wanted = tuple(b - a for a, b in zip(lo, hi, strict=True))
        if samples.shape != wanted:
            raise self._unreadable(lo, hi, ValueError(f"the shape is {samples.shape} instead of {wanted}"))
        return samples

    def read_into(self, lo: Shape, hi: Shape, out: NDArray[Any]) -> None:
        """Read the samples of a box into an array of zeros [z, y, x], of its shape and of the type `dtype`."""
        is_as_stored = self._convert is None and self._stored.newbyteorder("=") == self.dtype
        if not (self._fills and is_as_stored):
            out[...] = self.read(lo, hi)
            return
        axes = [self._order.index(axis) for axis in sorted(self._order)]
        with self._reading(lo, hi):
            self._source.read_into(self._index(lo, hi), np.transpose(out, axes))

    @contextmanager
    def _reading(self, lo: Shape, hi: Shape) -> Iterator[None]:
        """Name the first chunk of a box that cannot be read in an error, and check the files after the reading."""
        try:
            yield
        except FileChangedError:
            raise
        except Exception as error:
            # A changed file may be why the samples cannot be read, and is the better message.
            self._check_files(lo, hi)
            at, cause = ((lo, hi), error) if isinstance(error, ServerError) else self._first_unreadable(lo, hi, error)
            raise self._unreadable(*at, cause) from error
        self._check_files(lo, hi)

    def _check_files(self, lo: Shape, hi: Shape) -> None:
        """Raise a `FileChangedError` if a file of a box that was just read has changed since its state was recorded."""
        if self.files is not None:
            self.files.check_read(self._index(lo, hi))

    def _read(self, lo: Shape, hi: Shape) -> NDArray[Any]:
        index = self._index(lo, hi)
        if self._check is not None:
            self._check(self._source, index)
        return self._made(self._source[index])

    def _first_unreadable(self, lo: Shape, hi: Shape, error: Exception) -> tuple[Box, Exception]:
        """The first unreadable chunk of a box, and its error; the box itself where each chunk can be read alone."""
        places = [range(a // c * c, b, c) for a, b, c in zip(lo, hi, self.chunks, strict=True)]
        for n, first in enumerate(product(*places)):
            if n >= MAX_LOOKED_THROUGH:
                break
            own = [max(a, b) for a, b in zip(first, lo, strict=True)]
            end = [min(a + c, b) for a, c, b in zip(first, self.chunks, hi, strict=True)]
            box: Box = ((own[0], own[1], own[2]), (end[0], end[1], end[2]))
            try:
                self._read(*box)
            except Exception as cause:  # noqa: BLE001 - any error is reported
                return box, cause
        return (lo, hi), error

    def _unreadable(self, lo: Shape, hi: Shape, error: Exception) -> WavesplatError:
        if isinstance(error, WavesplatError) and not isinstance(error, FileError):
            return error
        first_line = (str(error).splitlines() or [""])[0] or type(error).__name__
        chunk = tuple(a // c for a, c in zip(lo, self.chunks, strict=True))
        ranges = ", ".join(f"{axis} {a}..{b - 1}" for axis, a, b in zip("zyx", lo, hi, strict=True))
        what = f"{self.name!r}: cannot read the samples {ranges} (chunk {chunk}): {first_line}"
        if isinstance(error, ServerError):
            return ServerError(what)  # which says how to mend it
        return FileError(f"{what}; copy or export the data again, or draw what there is: Volume.lazy(..., holes=True)")

    def read_many(self, boxes: Sequence[Box]) -> list[NDArray[Any]]:
        """Read the samples of several boxes."""
        return [self.read(*box) for box in boxes]

    def __getstate__(self) -> dict[str, Any]:
        state = self.__dict__.copy()
        if self._opened is not None:
            state["_array"] = None
        return state


def along_zyx(sizes: Sequence[int], order: Sequence[int], of_plane: int) -> Shape:
    """The sizes along the axes z, y, x; `of_plane` along z where there are two axes."""
    z, y, x = [of_plane] * (3 - len(order)) + [int(sizes[axis]) for axis in order]
    return z, y, x


class ComputedArray(SlicedArray):
    """Samples of a Dask array: all boxes of a step are computed together."""

    def __init__(self, array: Any, **options: Any) -> None:
        super().__init__(array, **options)
        self.reads_together = True

    def read(self, lo: Shape, hi: Shape) -> NDArray[Any]:
        """Read the samples of a box."""
        return self.read_many([(lo, hi)])[0]

    def read_many(self, boxes: Sequence[Box]) -> list[NDArray[Any]]:
        """Compute the samples of several boxes together."""
        dask: Any = library("dask", extra="dask")
        parts = [self._source[self._index(*box)] for box in boxes]
        try:
            # In a worker its own threads: waiting for the scheduler from there could wait for ever.
            options: dict[str, Any] = {"scheduler": "threads"} if _is_in_worker() else {}
            return [self._made(part) for part in dask.compute(*parts, **options)]
        except Exception as error:
            raise self._unreadable(*boxes[0], error) from error

    # For tasks of a cluster, to which chunks are brought.

    @property
    def is_persisted(self) -> bool:
        """Whether chunks lie in the memory of a cluster's workers."""
        graph = self._source.dask
        return any(type(value).__module__.startswith("distributed") for value in dict(graph).values())

    def delayed_chunks(self) -> NDArray[Any]:
        """The chunks as delayed objects, by their numbers along the array's own axes."""
        delayed: NDArray[Any] = self._source.to_delayed()
        return delayed

    def chunk_numbers(self, box: Box) -> list[tuple[int, ...]]:
        """Numbers of the chunks that a box touches."""
        ranges = []
        for part, ends in zip(self._index(*box), self._ends(), strict=True):
            places = (part, part + 1) if isinstance(part, int) else (part.start, part.stop)
            first, last = (int(np.searchsorted(ends, place, side="right")) for place in (places[0], places[1] - 1))
            ranges.append(range(first, last + 1))
        return list(product(*ranges))

    def _ends(self) -> list[NDArray[np.int64]]:
        return [np.cumsum(sizes) for sizes in self._source.chunks]

    def held(self, chunks: dict[tuple[int, ...], NDArray[Any]]) -> SlicedArray:
        """The same array, read from chunks in memory."""
        source = _HeldChunks([[0, *ends.tolist()] for ends in self._ends()], chunks, self._stored)
        return SlicedArray(
            source,
            name=self.name,
            chunks=self.chunks,
            order=self._order,
            picked=self._picked,
            dtype=self._stored,
            shape=self.shape,
        )


class _HeldChunks:
    """An array that is sliced out of chunks in memory. `places`: borders of all chunks along each axis."""

    def __init__(
        self, places: list[list[int]], chunks: dict[tuple[int, ...], NDArray[Any]], dtype: np.dtype[Any]
    ) -> None:
        self._places, self._chunks, self.dtype = places, chunks, dtype

    def __getitem__(self, index: tuple[int | slice, ...]) -> NDArray[Any]:
        lows = [part if isinstance(part, int) else part.start for part in index]
        highs = [part + 1 if isinstance(part, int) else part.stop for part in index]
        out = np.zeros([b - a for a, b in zip(lows, highs, strict=True)], self.dtype)
        for number, chunk in self._chunks.items():
            first = [places[k] for places, k in zip(self._places, number, strict=True)]
            end = [places[k + 1] for places, k in zip(self._places, number, strict=True)]
            low = [max(a, b) for a, b in zip(lows, first, strict=True)]
            high = [min(a, b) for a, b in zip(highs, end, strict=True)]
            if all(a < b for a, b in zip(low, high, strict=True)):
                there, here = (
                    tuple(slice(a - o, b - o) for a, b, o in zip(low, high, origin, strict=True))
                    for origin in (first, lows)
                )
                out[here] = np.asarray(chunk)[there]
        return out[tuple(0 if isinstance(part, int) else slice(None) for part in index)]


def _is_in_worker() -> bool:
    import sys

    worker = sys.modules.get("distributed.worker")
    if worker is None:
        return False
    try:
        worker.get_worker()
    except ValueError:
        return False
    return True


def lazy_array(thing: Any, *, argument: str = "samples", has_place: bool = False) -> LazyConverted:
    """The lazy array of another library's object, or one for each of a list of levels, the finest first.

    has_place : the caller gives the distances of samples, so that they may be uneven.
    """
    if isinstance(thing, list | tuple) and thing:
        found = [lazy_array(level, argument=argument, has_place=has_place) for level in thing]
        places = [one.world_from_index for one in found]
        levels = [level for one in found for level in one.levels]
        known = [place[0] for place in places if place is not None]
        own = known if len(known) == len(levels) else None
        return LazyConverted(levels, own, found[0].facts, found[0].name, found[0].directions)
    if hasattr(thing, "read") and hasattr(thing, "read_many") and hasattr(thing, "token"):
        return LazyConverted([thing], name=thing.name)
    if is_labelled(thing):
        return _of_labelled(thing, has_place=has_place)
    libraries = {base.__module__.partition(".")[0] for base in type(thing).__mro__}
    if "h5py" in libraries and hasattr(thing, "shape"):
        return _of_hdf5(thing)
    if not (hasattr(thing, "shape") and hasattr(thing, "dtype") and hasattr(thing, "__getitem__")):
        raise ArgumentError(
            f"{argument} is {described(thing)}; give an array with shape, dtype and slicing (of Zarr, Dask, h5py, "
            f"xarray, a memory map), or a list of levels; what is in memory is {VOLUME}"
        )
    name = _name_of(thing)
    order, picked = _spatial(checked_shape(thing, name), name)
    checked_type(thing, name)
    if hasattr(thing, "compute") and hasattr(thing, "dask"):
        chunks = checked_chunks(thing, name)
        array: LazyArray = ComputedArray(
            thing, name=name, chunks=[chunks[a] for a in order], order=order, picked=picked, token=f"dask {thing.name}"
        )
        return LazyConverted([array])
    if "zarr" in libraries:
        chunks = list(thing.chunks)  # of shards the inner ones, which zarr reads by their ranges
        files, reader = chunk_files(thing, picked), zarr_reader(thing)
        made = SlicedArray(
            thing if reader is None else reader,
            name=name,
            chunks=[chunks[a] for a in order],
            order=order,
            picked=picked,
            token=None if files is None else f"Zarr {thing.store_path}",
            files=files,
            check=partial(_check_zarr, name) if reader is None else None,
        )
        return LazyConverted([made], name=name)
    if isinstance(thing, np.ndarray):
        return LazyConverted([_of_numpy(thing, name, order, picked)])
    chunks = checked_chunks(thing, name)
    return LazyConverted(
        [SlicedArray(thing, name=name, chunks=[chunks[a] for a in order], order=order, picked=picked)], name=name
    )


def _name_of(thing: Any) -> str:
    if hasattr(thing, "compute"):
        return "array"  # Dask's names are made up
    own = getattr(thing, "name", None) or getattr(thing, "filename", None) or "array"
    return str(own).rstrip("/").rpartition("/")[2] or "array"


def _spatial(shape: Sequence[int], name: str) -> tuple[Shape, list[int | None]]:
    """The last three axes as z, y, x, and index 0 along the others, which must have size 1."""
    extra = len(shape) - 3
    if extra > 0 and all(n == 1 for n in shape[:extra]):
        return (extra, extra + 1, extra + 2), [*[0] * extra, None, None, None]
    check_shape(tuple(shape), name)
    return (0, 1, 2), [None, None, None]


def _check_zarr(name: str, array: Any, index: Sequence[int | slice]) -> None:
    check_chunks(array, index, name)


def _of_numpy(array: NDArray[Any], name: str, order: Shape, picked: Sequence[int | None]) -> SlicedArray:
    if not isinstance(array, np.memmap):
        side = [DEFAULT_SIDE] * 3
        return SlicedArray(array, name=name, chunks=side, order=order, picked=picked)
    rows = [1, array.shape[order[1]], array.shape[order[2]]]
    file = None if array.filename is None else Path(array.filename)
    # A view of a map does not know its offset, and writes to a copy-on-write map ("c") reach no file.
    is_whole = file is not None and type(array.base).__name__ == "mmap" and array.mode != "c"
    opened = token = None
    if is_whole and file is not None:
        layout = "F" if array.flags.f_contiguous and not array.flags.c_contiguous else "C"
        opened = partial(np.memmap, file, array.dtype, "r", array.offset, array.shape, layout)
        if layout == "F":
            rows = [array.shape[order[0]], array.shape[order[1]], 1]
        # A name alone: a map keeps its samples when its file is replaced, and writing through it does not change the
        # file's time at once, so that the state of the file does not identify the samples.
        state = StoredFiles([file]).fingerprint()
        token = None if state is None else f"map {state} {array.offset} {array.shape} {layout}"
    return SlicedArray(array, name=name, chunks=rows, order=order, picked=picked, opened=opened, token=token)


def _of_hdf5(dataset: Any) -> LazyConverted:
    check_nesting(dataset, dataset.file.filename)
    place, name = place_of(dataset), str(dataset.name).rpartition("/")[2]
    order, picked = _spatial(dataset.shape, name)
    zyx = (order[place.zyx[0]], order[place.zyx[1]], order[place.zyx[2]])
    chunks = dataset.chunks or [1, *dataset.shape[1:]]
    path, is_own = Path(dataset.file.filename), is_own_file(dataset)
    array = SlicedArray(
        dataset,
        name=name,
        chunks=[chunks[axis] for axis in zyx],
        order=zyx,
        picked=picked,
        opened=partial(open_hdf5, str(path), str(dataset.name)) if path.is_file() else None,
        # HDF5 has one lock for all threads.
        n_readers=1,
        token=f"HDF5 {path} {dataset.name}" if is_own else None,
        files=files_of_dataset(dataset) if is_own else None,
        reads_parts=dataset.chunks is None,
    )
    return LazyConverted([array], [place.world_from_index], place.facts, name)


class _Labelled:
    """An array with names and coordinates, sliced by index alone."""

    def __init__(self, array: Any) -> None:
        self._array = array
        self.shape, self.dtype = tuple(array.shape), array.dtype

    def __getitem__(self, index: Any) -> NDArray[Any]:
        return np.asarray(self._array[index])


def _of_labelled(array: Any, *, has_place: bool) -> LazyConverted:
    found = in_order(array, has_place=has_place)
    ordered = found.samples
    own = getattr(ordered, "data", None) if getattr(ordered, "chunks", None) else None
    inner = lazy_array(_Labelled(ordered) if own is None else own)
    level = inner.levels[0]
    if isinstance(level, SlicedArray):
        level.name = found.name or level.name
    places = None if found.world_from_index is None else [found.world_from_index]
    return replace(inner, world_from_index=places, facts=found.facts, name=found.name, directions=found.directions)
