"""Raw samples without a header: shape, type, byte order and offset come from the caller."""

from __future__ import annotations

from operator import index
from pathlib import Path

import numpy as np

from wavesplat._readers.levels import Levels, one_volume, stored_samples
from wavesplat._readers.request import Request
from wavesplat._storage import size_checks
from wavesplat.errors import ArgumentError, FileError


def levels(request: Request) -> Levels:
    """The samples in a raw file, laid out as the request says."""
    shape, dtype = _checked_shape(request), _checked_dtype(request)
    path = request.file
    size_checks.check_readable(path)
    _check_size(path, shape, dtype, request.offset)
    found = one_volume(shape, dtype, request, path.name)
    return Levels([stored_samples(path, request.offset, shape, found)], [np.eye(4)], found.facts(None))


def _check_size(path: Path, shape: tuple[int, ...], dtype: np.dtype[np.generic], offset: int) -> None:
    """Raise a `FileError` unless the file holds exactly these samples."""
    if offset < 0:
        raise ArgumentError(f"offset={offset}; give the bytes before the first sample, 0 or more")
    stored = path.stat().st_size - offset
    size_checks.check_stored(shape, dtype, max(stored, 0), path, held=(1,))
    needed = size_checks.n_bytes(shape, dtype)
    if stored > needed:
        raise FileError(
            f"shape {shape} of {dtype} needs {needed} bytes, the file holds {stored} after offset {offset}; "
            f"check shape and dtype, or pass offset={path.stat().st_size - needed} to skip a header: {path}"
        )


def _checked_shape(request: Request) -> tuple[int, ...]:
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


def _checked_dtype(request: Request) -> np.dtype[np.generic]:
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
