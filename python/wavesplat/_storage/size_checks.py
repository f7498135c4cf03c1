"""Checks before memory is allocated: that a file holds the samples that its header promises, and that they fit.

A damaged or hostile header of a few bytes can promise terabytes.
"""

from __future__ import annotations

import gzip
import os
import zlib
from collections.abc import Iterable, Sequence
from math import prod
from pathlib import Path
from typing import Any

import numpy as np

from wavesplat._storage.paths import check_no_pipe
from wavesplat._system.memory import check_room
from wavesplat.errors import FileError

#: Deflate cannot shrink data by more than this factor (RFC 1951: 258 bytes from two bits).
DEFLATE_RATIO = 1032
#: Factor by which no other lossless codec shrinks data: bzip2 reaches 45 000 on zeros.
ANY_RATIO = 50_000
#: zlib's `wbits` for zlib or gzip, detected by the first bytes, with any window.
ZLIB_OR_GZIP = 32 + 15
GZIP = b"\x1f\x8b"
BLOCK_BYTES = 1 << 20


def check_readable(path: Path) -> None:
    """Raise a `FileError` if there is no such file, or it is no regular file, or it is empty or not readable."""
    check_no_pipe(path)
    try:
        with path.open("rb") as file:
            if not file.read(1):
                raise FileError(f"the file is empty; copy or export it again: {path}")
    except FileNotFoundError:
        raise FileError(f"no such file or folder; check the name: {path}") from None
    except OSError as error:
        if isinstance(error, FileError):
            raise
        raise FileError(f"cannot read the file: {error.strerror}; check its permissions: {path}") from None


def n_bytes(shape: Sequence[int], dtype: np.dtype[Any]) -> int:
    """Size of an array; Python integers, so it cannot overflow."""
    return prod(int(n) for n in shape) * dtype.itemsize


def check_stored(
    shape: Sequence[int],
    dtype: np.dtype[Any],
    stored: int,
    path: object,
    *,
    ratio: int = 1,
    held: Sequence[int] | None = None,
) -> None:
    """Raise a `FileError` if `stored` bytes, compressed at best by `ratio`, cannot hold an array of this shape.

    held : shape of the part that will be in memory; all of the array if not given.
    """
    needed = n_bytes(shape, dtype)
    if stored * ratio < needed:
        raise FileError(
            f"truncated, or a wrong header: {_described(shape, dtype)} need {needed} bytes, the file holds {stored}"
            f"{' (compressed)' if ratio > 1 else ''}; copy or export it again: {path}"
        )
    check_memory(needed if held is None else n_bytes(held, dtype), path)


def check_gzip(
    shape: Sequence[int], dtype: np.dtype[Any], offset: int, path: Path, held: Sequence[int] | None = None
) -> None:
    """Raise a `FileError` if a gzip file, whose samples begin at byte `offset` once unpacked, cannot hold the array."""
    needed = offset + n_bytes(shape, dtype)
    if not _ends_as_promised(path, needed):
        unpacked = _unpacked_size(path, needed)
        check_stored(shape, dtype, max(unpacked - offset, 0), path, held=held)
    check_memory(needed if held is None else n_bytes(held, dtype), path)


def check_deflated(places: Iterable[tuple[Path, int]], needed: int, path: object) -> None:
    """Raise a `FileError` if the streams at these offsets of files do not unpack, checksums too, to `needed` bytes.

    For libraries that return a part of the samples where a stream is damaged.
    """
    unpacked = sum(_unpacked_with_checksum(file, offset, path) for file, offset in places)
    if unpacked < needed:
        raise FileError(
            f"truncated, or a wrong header: the samples need {needed} bytes, {unpacked} are packed; "
            f"copy or export it again: {path}"
        )


def check_memory(needed: int, path: object) -> None:
    """Raise a `LimitError` if an array of `needed` bytes does not fit into the free memory."""
    check_room(needed, "the samples", f"use a smaller or coarser file: {path}")


def _described(shape: Sequence[int], dtype: np.dtype[Any]) -> str:
    return f"{' x '.join(str(n) for n in shape)} samples of {dtype}"


def _ends_as_promised(path: Path, unpacked: int) -> bool:
    """Whether the last four bytes, the unpacked size modulo 2^32, agree with `unpacked`: quick, for whole files."""
    stored = path.stat().st_size
    with path.open("rb") as file:
        file.seek(-min(4, stored), os.SEEK_END)
        size_field = int.from_bytes(file.read(4), "little")
    return size_field == unpacked % 2**32 and unpacked <= stored * DEFLATE_RATIO


def _unpacked_with_checksum(file: Path, offset: int, path: object) -> int:
    """Number of bytes that a zlib or gzip stream unpacks to; only a block of them is in memory at a time."""
    count = 0
    with file.open("rb") as packed:
        packed.seek(offset)
        stream, rest = zlib.decompressobj(ZLIB_OR_GZIP), b""
        try:
            while rest := rest or packed.read(BLOCK_BYTES):
                count += len(stream.decompress(rest, BLOCK_BYTES))
                rest = stream.unconsumed_tail
                if stream.eof:
                    # gzip streams may follow each other.
                    rest = stream.unused_data or packed.read(BLOCK_BYTES)
                    if not rest.startswith(GZIP):
                        return count
                    stream = zlib.decompressobj(ZLIB_OR_GZIP)
        except zlib.error as error:
            raise FileError(f"damaged: the packed samples do not unpack ({error}); copy it again: {path}") from None
    raise FileError(f"truncated: the packed samples have no end; copy or export it again: {path}")


def _unpacked_size(path: Path, enough: int) -> int:
    """Number of bytes that can be unpacked, counted up to `enough`; used for files that look wrong at their end."""
    count = 0
    try:
        with gzip.open(path) as file:
            while count < enough and (block := file.read(2**20)):
                count += len(block)
    except (OSError, EOFError, zlib.error):
        pass  # what comes before the damage is the answer
    return count
