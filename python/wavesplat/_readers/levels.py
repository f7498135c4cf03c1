"""Levels of an image in a file: arrays that are read whole, or in parts as they are drawn; their places, and facts.

A reader describes them by `levels(request)`, or gives a `Grid` of what is only read whole. With `request.memory` parts
must be readable: an error says where they are not.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import AbstractContextManager, nullcontext
from dataclasses import dataclass, field, replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wavesplat._model.interchange.converted import check_shape
from wavesplat._model.lazy.array import SlicedArray, along_zyx
from wavesplat._model.lazy.checks import renderable_type
from wavesplat._model.volume.facts import Facts
from wavesplat._readers.components import AXES, LENGTH_NOTE, check_vectors, has_vectors, length_along, type_of_length
from wavesplat._readers.request import Grid, Request, index_unnamed_axes, n_times_of
from wavesplat._readers.single_planes import level_of_plane, note_on_level
from wavesplat._storage import size_checks
from wavesplat._storage.file_states import StoredFiles
from wavesplat._storage.stored_arrays import StoredArray
from wavesplat.errors import ArgumentError, FileError

INSTEAD = "store the samples in chunks, as a Zarr array"


@dataclass(frozen=True)
class Levels:
    """Levels, the finest first, their affines from index (x, y, z) to the world, and the file's facts."""

    arrays: Sequence[SlicedArray]
    world_from_index: Sequence[NDArray[np.float64]]
    facts: Facts = field(default_factory=Facts)
    #: Returns sentences on what was missing of the samples that were read.
    losses: Callable[[], tuple[str, ...]] = tuple
    #: Keeps the library that reads the samples from warnings and logs.
    quietly: Callable[[], AbstractContextManager[None]] = nullcontext

    def n_bytes(self, number: int = 0) -> int:
        """Bytes of the samples of a level, in memory."""
        return size_checks.n_bytes(self.arrays[number].shape, self.arrays[number].dtype)

    def whole(self, request: Request) -> Grid:
        """All samples of the finest level; of a single plane, the level that has the pixels of its picture."""
        number, facts = level_of_plane([array.shape for array in self.arrays], request) or 0, self.facts
        if number > 0:
            facts = replace(facts, guesses=(*facts.guesses, note_on_level(number, len(self.arrays))))
        size_checks.check_memory(self.n_bytes(number), request.safe_path)
        with self.quietly():
            samples = self.arrays[number].whole()
        return Grid(samples, self.world_from_index[number], facts, self.losses())


def one_stream(path: object, what: str) -> FileError:
    """The error for parts of samples that are compressed as one stream."""
    return FileError(
        f"the samples are compressed as one stream ({what}), so parts of them cannot be read; unpack the file "
        f"(gunzip), {INSTEAD}, or open it without memory=: {path}"
    )


@dataclass(frozen=True)
class OneVolume:
    """One volume of an array: the axes that are z, y, x (or y, x), the index along each of the others, and its samples.

    `convert` makes samples, of the type `made`, of stored numbers, and takes an axis away that has a slice.
    """

    order: tuple[int, ...]
    picked: Sequence[int | slice | None]
    dtype: np.dtype[Any]
    made: np.dtype[Any]
    convert: Callable[[NDArray[Any]], NDArray[Any]] | None = None
    n_times: int = 1
    #: The component, or the length, that is drawn of vectors.
    component: str | None = None
    guesses: tuple[str, ...] = ()

    def turned(self) -> OneVolume:
        """The same volume of the array with its axes the other way round."""
        last = len(self.picked) - 1
        convert = None if self.convert is None else partial(length_along, axis=0)
        return replace(self, order=tuple(last - one for one in self.order), picked=self.picked[::-1], convert=convert)

    def facts(self, quantity: str | None) -> Facts:
        """Facts of the volume. `quantity`: the name of the array's values."""
        named = quantity if quantity is None or self.component is None else f"{quantity} {self.component}"
        return Facts(quantity=named, n_times=self.n_times, guesses=self.guesses)


def one_volume(shape: Sequence[int], dtype: np.dtype[Any], request: Request, name: str) -> OneVolume:
    """The volume that is asked for of an array whose axes have no names; of vectors, a component or their length.

    name : the array, in messages.
    """
    component, guesses = None, tuple[str, ...]()
    if has_vectors(shape, dtype, request):
        component, guesses = request.component or "magnitude", () if request.component else (LENGTH_NOTE.format(name),)
        component_axis = AXES.index(component) if component in AXES else slice(0, len(AXES))
        picked: list[int | slice | None] = [None, None, None, component_axis]
        order: tuple[int, ...] = (0, 1, 2)
    else:
        check_vectors(request, name)
        index = index_unnamed_axes(shape, request)
        at = index.index(...)
        picked = [*index[:at], *[None] * (len(shape) - len(index) + 1), *index[at + 1 :]]
        order = tuple(axis for axis, one in enumerate(picked) if one is None)
    try:
        renderable_type(dtype, request.name)
        if len(order) != 2:  # a single plane is no volume, but a slice shows it
            check_shape([shape[axis] for axis in order], request.name)
    except ArgumentError as error:
        raise FileError(f"{error}: {request.safe_path}") from None
    made, convert = dtype, None
    if component == "magnitude":
        made, convert = type_of_length(dtype), partial(length_along, axis=-1)
    return OneVolume(order, picked, dtype, made, convert, n_times_of(shape, request), component, guesses)


def stored_samples(path: Path, offset: int, shape: Sequence[int], volume: OneVolume) -> SlicedArray:
    """One volume of an array that lies in a file as it is, from byte `offset` on, the last axis fastest."""
    size_checks.check_stored(shape, volume.dtype, max(path.stat().st_size - offset, 0), path, held=(1,))
    z, y, x = along_zyx(shape, volume.order, 1)
    # A chunk is a slice across the slowest of the axes.
    slowest = int(np.argmin(along_zyx(range(len(shape)), volume.order, len(shape))))
    convert = volume.convert
    return SlicedArray(
        None,
        name=path.name,
        chunks=[1 if k == slowest else n for k, n in enumerate((z, y, x))],
        order=volume.order,
        picked=volume.picked,
        opened=partial(StoredArray, path, volume.dtype, offset, tuple(shape)),
        convert=convert,
        dtype=volume.made,
        shape=(z, y, x),
        token=f"stored {path} {volume.dtype.str} {offset} {tuple(shape)} {getattr(convert, 'keywords', None)}",
        files=StoredFiles([path]),
        reads_parts=True,
    )
