"""Raw samples without a header: shape, type, byte order and offset come from the caller."""

from __future__ import annotations

from operator import index
from pathlib import Path

import numpy as np

from wavesplat._files import size_checks
from wavesplat._files.reading import reading
from wavesplat._model.facts import Facts
from wavesplat._readers.request import Grid, Request, index_unnamed_axes, n_times_of, one_volume_of
from wavesplat.errors import ArgumentError, FileError

__all__ = ["check_size", "checked_dtype", "checked_shape", "read"]


def read(request: Request) -> Grid:
    """The samples in a raw file."""
    shape, dtype = checked_shape(request), checked_dtype(request)
    path = request.file
    if path.is_dir():
        raise FileError(f"this is a folder; raw samples are read from one file: {path}")
    size_checks.check_readable(path)
    check_size(path, shape, dtype, request.offset, held=one_volume_of(shape, request))
    index = index_unnamed_axes(shape, request)
    with reading("raw samples", path):
        if len(shape) > 3:  # only the volume that is asked for is read
            samples = np.array(np.memmap(path, dtype, "r", offset=request.offset, shape=shape)[index])
        else:
            samples = np.fromfile(path, dtype, offset=request.offset).reshape(shape)[index]
    return Grid(samples, np.eye(4), Facts(n_times=n_times_of(shape, request)))


def check_size(
    path: Path, shape: tuple[int, ...], dtype: np.dtype[np.generic], offset: int, held: tuple[int, ...]
) -> None:
    """Raise a `FileError` unless the file holds exactly these samples. `held`: shape of the part kept in memory."""
    if offset < 0:
        raise ArgumentError(f"offset={offset}; give the bytes before the first sample, 0 or more")
    stored = path.stat().st_size - offset
    size_checks.check_stored(shape, dtype, max(stored, 0), path, held=held)
    needed = size_checks.n_bytes(shape, dtype)
    if stored > needed:
        raise FileError(
            f"shape {shape} of {dtype} needs {needed} bytes, the file holds {stored} after offset {offset}; "
            f"check shape and dtype, or pass offset={path.stat().st_size - needed} to skip a header: {path}"
        )


def checked_shape(request: Request) -> tuple[int, ...]:
    """The shape that was given; an `ArgumentError` if there is none."""
    if request.shape is None:
        raise ArgumentError(f'raw samples need shape=(z, y, x) and dtype=, such as "uint8"; pass both: {request.path}')
    try:
        shape = tuple(index(n) for n in request.shape)
    except TypeError:
        raise ArgumentError(f"shape is {request.shape!r}; give whole numbers (z, y, x)") from None
    if len(shape) < 3 or min(shape) < 1:
        raise ArgumentError(f"shape is {shape}; give at least three positive numbers (z, y, x)")
    return shape


def checked_dtype(request: Request) -> np.dtype[np.generic]:
    """The type that was given, in its byte order."""
    if request.dtype is None:
        raise ArgumentError(f'raw samples need dtype=, such as "uint8" or "int16"; pass it: {request.path}')
    try:
        dtype = np.dtype(request.dtype)
    except (TypeError, ValueError):
        raise ArgumentError(
            f'dtype is {request.dtype!r}; give a NumPy type, such as "uint8", "int16" or "float32"'
        ) from None
    order: object = request.byte_order
    if order is not None and not (isinstance(order, str) and order in ("little", "big")):
        raise ArgumentError(f'byte_order is {request.byte_order!r}; it is "little" or "big"')
    if request.byte_order is None:
        return dtype.newbyteorder("<") if dtype.byteorder == "=" else dtype
    return dtype.newbyteorder("<" if request.byte_order == "little" else ">")
