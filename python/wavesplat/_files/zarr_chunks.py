"""Checks of the chunk files of Zarr arrays: that they are whole, before they are decoded, and no longer than can be.

Blosc says in each chunk how long it is and reads that far, also past the end of its input: a file that was cut
short comes back with whatever lies behind it in memory. A shard of no bytes is taken for one that is not there.
Header of Blosc: https://www.blosc.org/c-blosc2/format/chunk_format.html, the packed size in bytes 12 to 16.
"""

from __future__ import annotations

import os
import stat
from collections.abc import Iterator, Sequence
from itertools import product
from math import prod
from pathlib import Path
from typing import Any

from wavesplat._files.zarr_place import ZarrPlace
from wavesplat.errors import FileError

#: Bytes of the header of blosc.
BLOSC_HEADER = 16
#: Bytes of a sample in the widest type that filters store; of overhead for each inner chunk of a shard; and of a margin
#: for every chunk.
WIDEST, INNER_BYTES, MARGIN_BYTES = 8, 256, 1 << 16


def check_chunks(array: Any, picked: Sequence[int | slice], path: object) -> None:
    """Raise a `FileError` that names the first chunk, of those with picked samples, that is cut short or no file.

    Of stores that are no folders nothing is checked.
    """
    for name, file in _files(array, picked):
        size = file.stat().st_size
        needed = _n_bytes_needed(array, file)
        if size == 0 or size < needed:
            raise truncated(name, needed, size, path)


def truncated(name: str, needed: int, size: int, path: object) -> FileError:
    """The error for a chunk whose file is shorter than the bytes that it needs."""
    return FileError(
        f"truncated: chunk {name!r} needs {max(needed, 1)} bytes, its file holds {size}; "
        f"copy or export it again: {path}"
    )


def expect_chunks(array: Any, place: ZarrPlace | None) -> None:
    """Bound what is read of an array's chunks at a place by the size of samples which compression does not shrink."""
    if place is None:
        return
    inner = prod(array.chunks)
    n = prod(array.shards or array.chunks)
    # Filters may store samples in a wider type than the array's.
    itemsize = max(array.dtype.itemsize, WIDEST if array.filters else 0)
    # Packed noise is longer by a few hundredths; each inner chunk of a shard has a header, and a place in an index.
    place.expect(array.path, n * itemsize + n * itemsize // 32 + (n // inner) * INNER_BYTES + MARGIN_BYTES)


def _files(array: Any, picked: Sequence[int | slice]) -> Iterator[tuple[str, Path]]:
    """Names and files of the chunks that have one; the others are all fill value."""
    place = array.store_path
    root = getattr(place.store, "root", None)
    if root is None:
        return
    folder = Path(root) / place.path
    for number in chunk_numbers(array, picked):
        name = str(array.metadata.encode_chunk_key(number))
        if _is_there(folder, name):
            yield name, folder / name


def chunk_numbers(array: Any, picked: Sequence[int | slice]) -> Iterator[tuple[int, ...]]:
    """Numbers along each axis of the chunks, or shards, that hold the picked samples."""
    sizes = _file_chunks(array)
    numbers = [
        range((part.start or 0) // size, -(-(n if part.stop is None else part.stop) // size))
        if isinstance(part, slice)
        else (part // size,)
        for n, size, part in zip(array.shape, sizes, picked, strict=True)
    ]
    return product(*numbers)


def _is_there(folder: Path, name: str) -> bool:
    """Whether a chunk has a file; a `FileError` where something else has its name, which zarr takes for no chunk."""
    try:
        mode = os.stat(f"{folder}/{name}").st_mode  # noqa: PTH116 - a Path costs more than the call, chunk by chunk
    except (FileNotFoundError, NotADirectoryError):
        check_missing(str(folder), name)
        return False
    except OSError as error:
        raise FileError(
            f"cannot read chunk {name!r}: {error.strerror}; check its permissions, or copy the array again: {folder}"
        ) from None
    if not stat.S_ISREG(mode):
        what = "a folder" if stat.S_ISDIR(mode) else "a device, a pipe or a socket"
        raise FileError(f"chunk {name!r} is {what} and no file; copy or export the array again: {folder}")
    return True


def check_missing(folder: str, name: str) -> None:
    """Raise a `FileError` where a chunk has no file because a link on its path leads nowhere, or a folder is a file.

    Links of git-annex lead nowhere before a file is got.
    """
    place = f"{folder}/{name}"
    while len(place) > len(folder):
        try:
            mode = os.lstat(place).st_mode
        except NotADirectoryError:
            raise FileError(
                f"chunk {name!r} cannot be there, since a file has the name of its folder; copy or export the array "
                f"again: {folder}"
            ) from None
        except OSError:
            place = place.rpartition("/")[0]
            continue
        if stat.S_ISLNK(mode) and not Path(place).exists():
            raise FileError(
                f"chunk {name!r} is behind a link to what is not there; get the linked files, or copy the array with "
                f"them: {place}"
            )
        return


def _file_chunks(array: Any) -> tuple[int, ...]:
    """Samples along each axis that share a file."""
    return tuple(int(n) for n in (array.shards or array.chunks))


def _n_bytes_needed(array: Any, file: Path) -> int:
    """Least length of a chunk's file, in bytes; 0 where only decoding shows it."""
    codecs = [*(array.filters or ()), *(array.compressors or ())]
    if array.shards:
        return 0
    if not codecs:
        return prod(map(int, array.chunks)) * int(array.dtype.itemsize)
    if "blosc" not in type(codecs[-1]).__name__.lower():
        return 0
    with file.open("rb") as stream:
        return packed_bytes(stream.read(BLOSC_HEADER))


def packed_bytes(header: bytes) -> int:
    """Bytes of a chunk of blosc, by its first bytes, the header."""
    return int.from_bytes(header[12:16], "little") if len(header) == BLOSC_HEADER else BLOSC_HEADER
