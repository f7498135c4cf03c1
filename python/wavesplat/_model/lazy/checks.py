"""Checks of lazy volumes: that an array can be read box by box, and whether its files changed."""

from __future__ import annotations

import math
import operator
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from typing import TYPE_CHECKING, Any, Protocol, runtime_checkable

import numpy as np
from numpy.typing import NDArray

from wavesplat._storage.file_states import SourceFiles
from wavesplat._system.values import described
from wavesplat.errors import ArgumentError

if TYPE_CHECKING:
    from wavesplat._model.lazy.survey import Survey
    from wavesplat._model.volume.stack import Box

#: Types that the renderer reads as they are.
NATIVE = tuple(np.dtype(code) for code in ("u1", "i1", "u2", "i2", "u4", "i4", "f4", "f8"))
#: Assumed samples along each axis of a chunk, for arrays in memory and for arrays without chunks.
DEFAULT_SIDE = 32


def checked_shape(array: Any, name: str) -> tuple[int, ...]:
    """The shape of an array; an `ArgumentError` where it is invalid or not known."""
    given = array.shape
    try:
        sizes = list(given)
    except TypeError:
        sizes = []
    if any(isinstance(size, float | np.floating) and math.isnan(size) for size in sizes):
        raise ArgumentError(
            f"volume {name!r}: the sizes of its chunks depend on the samples and are not known (shape {given}); "
            "call compute_chunk_sizes() on the Dask array first, and give it a shape of three axes"
        )
    try:
        shape = tuple(operator.index(size) for size in sizes)
    except TypeError:
        shape = ()
    if not shape or min(shape) < 0:
        raise ArgumentError(
            f"volume {name!r}: its shape is {described(given)}; give whole numbers of samples (z, y, x)"
        )
    return shape


def checked_type(array: Any, name: str) -> np.dtype[Any]:
    """The type of an array's samples; an `ArgumentError` where it is none of NumPy's."""
    try:
        dtype: np.dtype[Any] = np.dtype(array.dtype)
        return dtype
    except (TypeError, ValueError):
        # TensorStore has types of its own.
        own = getattr(array.dtype, "numpy_dtype", None)
        if isinstance(own, np.dtype):
            return own
        raise ArgumentError(
            f"volume {name!r}: its dtype is {described(array.dtype)}; give a type of NumPy, such as uint16"
        ) from None


def checked_chunks(array: Any, name: str) -> list[int]:
    """Samples of a chunk along each axis, the most where chunks differ; an `ArgumentError` for invalid chunks."""
    given = getattr(array, "chunks", None)
    if given is None:
        return [DEFAULT_SIDE] * len(array.shape)
    try:
        sizes = [max(operator.index(n) for n in one) if isinstance(one, tuple | list) else one for one in given]
        chunks = [operator.index(size) for size in sizes]
    except (TypeError, ValueError):
        chunks = []
    if len(chunks) != len(array.shape) or min(chunks, default=0) < 1:
        raise ArgumentError(
            f"volume {name!r}: its chunks are {described(given)}; give a whole number from 1 for each of the "
            f"{len(array.shape)} axes, or None"
        )
    return chunks


def renderable_type(dtype: np.dtype[Any], name: str) -> np.dtype[Any]:
    """The renderer's type for samples of a type; an `ArgumentError` for types that are not real numbers."""
    own = dtype.newbyteorder("=")
    if own in NATIVE:
        return own
    if own.kind == "b":
        return np.dtype(np.uint8)
    if own.kind == "f":
        return np.dtype(np.float32 if own.itemsize == 2 else np.float64)
    if is_wide_integer(own):
        # Which narrower type would do is known once all are read; this holds whole numbers up to 2^53.
        return np.dtype(np.float64)
    raise ArgumentError(f"volume {name!r}: samples are {dtype}, not real numbers; {_hint(dtype)}")


def is_wide_integer(dtype: np.dtype[Any]) -> bool:
    """Whether a type is an integer type that the renderer does not read: of 64 bits."""
    return dtype.kind in "iu" and dtype.newbyteorder("=") not in NATIVE


def narrowest_integer(lowest: float, highest: float) -> np.dtype[Any]:
    """The smallest integer type of the renderer that holds a range of whole numbers exactly, else float64.

    Samples of 64-bit integers have it in memory; read in parts they are float64, and the look is chosen as for it.
    """
    for dtype in NATIVE:
        if dtype.kind in "iu":
            limits = np.iinfo(dtype)
            if limits.min <= lowest and highest <= limits.max:
                return dtype
    return np.dtype(np.float64)


def _hint(dtype: np.dtype[Any]) -> str:
    return "take .real, .imag or np.abs" if dtype.kind == "c" else "convert them to numbers, by array.astype"


def converted(samples: NDArray[Any], dtype: np.dtype[Any], declared: np.dtype[Any], name: str) -> NDArray[Any]:
    """Samples that were read, in the renderer's type; an `ArgumentError` where their values would be lost.

    declared : the type that the array declares.
    """
    if samples.dtype.kind not in "biuf":
        raise ArgumentError(
            f"volume {name!r}: samples came as {samples.dtype}, not as real numbers; {_hint(samples.dtype)}"
        )
    if isinstance(samples, np.ma.MaskedArray):
        samples = _filled(samples, dtype, declared, name)
    with np.errstate(invalid="ignore", over="ignore"):
        made = np.ascontiguousarray(samples, dtype)
    if samples.dtype != declared and not _is_kept(samples.dtype, dtype) and not _is_same(made, samples):
        raise ArgumentError(
            f"volume {name!r}: samples came as {samples.dtype}, with values that the array's dtype, {declared}, cannot "
            "hold; mend its dtype"
        )
    return made


def _filled(samples: Any, dtype: np.dtype[Any], declared: np.dtype[Any], name: str) -> NDArray[Any]:
    """Samples with NaN for masked ones, as in memory; an `ArgumentError` for integer types, which have no NaN."""
    if not np.ma.is_masked(samples):
        return np.ma.getdata(samples)
    if dtype.kind != "f":
        raise ArgumentError(
            f"volume {name!r}: some samples are masked, and {declared} has no value for what is missing; give them as "
            "float32, or without the mask"
        )
    filled: NDArray[Any] = np.ma.filled(samples.astype(dtype), np.nan)
    return filled


def _is_kept(given: np.dtype[Any], dtype: np.dtype[Any]) -> bool:
    """Whether values of a type keep their meaning in another: nothing but digits of floating point may be lost."""
    return np.can_cast(given, dtype, "same_kind" if given.kind == dtype.kind == "f" else "safe")


def _is_same(made: NDArray[Any], samples: NDArray[Any]) -> bool:
    return bool(np.array_equal(made, samples, equal_nan=samples.dtype.kind == "f"))


# Checks of lazy volumes' files for changes: once at the start of a picture, so that all of it shows one state.
#
# Outside of pictures they are checked before each answer. A change empties the cache of a lazy volume.

#: `id`s of the files that were checked for the picture that is being made; None outside of pictures.
_LOOKED_AT: ContextVar[set[int] | None] = ContextVar("looked_at", default=None)


@runtime_checkable
class _OfFiles(Protocol):
    def notice_changes(self) -> None:
        """Drop everything computed from samples that have changed."""


@contextmanager
def comparing_once(volumes: Iterable[object]) -> Iterator[None]:
    """Compare some volumes with their files now, and not again while a picture of them is made.

    Raises
    ------
    FileError
        If a file has changed that must be opened again.
    """
    if _LOOKED_AT.get() is not None:
        compare(volumes)
        yield
        return
    token = _LOOKED_AT.set(set())
    try:
        compare(volumes)
        yield
    finally:
        _LOOKED_AT.reset(token)


def compare(volumes: Iterable[object]) -> None:
    """Compare lazy volumes with their files, except for files that were checked for this picture."""
    for volume in volumes:
        if isinstance(volume, _OfFiles):
            volume.notice_changes()


def look_again(files: SourceFiles) -> None:
    """Check files for changes, if that was not done for this picture."""
    looked_at = _LOOKED_AT.get()
    if looked_at is not None:
        if id(files) in looked_at:
            return
        looked_at.add(id(files))
    files.look_again()


class LazyCache:
    """Cache of the lazy volumes that read the same levels with the same budget: surveys, and data made of them.

    n_changes : number of changes found in the files so far.
    """

    def __init__(self, n_changes: int) -> None:
        self.n_changes = n_changes
        #: Number of calls of `forget`, by which scenes see whether their looks still fit the samples.
        self.generation = 0
        #: Surveys by level, kernel and box that was read (None: all), and data made of them, the latest last.
        self.surveys: dict[tuple[int, str, Box | None], Survey] = {}
        self.derived: dict[Any, Any] = {}

    def forget(self) -> None:
        """Drop everything: the samples have changed."""
        self.surveys.clear()
        self.derived.clear()
        self.generation += 1
