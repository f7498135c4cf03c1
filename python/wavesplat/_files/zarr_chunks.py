"""Checks that the chunk files of a Zarr array are whole, before they are decoded.

Blosc says in each chunk how long it is and reads that far, also past the end of its input: a file that was cut
short comes back with whatever lies behind it in memory. A shard of no bytes is taken for one that is not there.
Header of Blosc: https://www.blosc.org/c-blosc2/format/chunk_format.html, the packed size in bytes 12 to 16.
"""

from __future__ import annotations

import stat
from collections.abc import Iterator, Sequence
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np

from wavesplat.errors import FileError

__all__ = ["check_chunks", "chunk_numbers"]

BLOSC_HEADER = 16


def check_chunks(array: Any, picked: Sequence[int | slice], path: object) -> None:
    """Raise a `FileError` that names the first chunk, of those with picked samples, that is cut short or no file.

    Of stores that are no folders, and of zarr 2, nothing is checked.
    """
    for name, file in _files(array, picked):
        size = file.stat().st_size
        needed = _n_bytes_needed(array, file)
        if size == 0 or size < needed:
            raise FileError(
                f"truncated: chunk {name!r} needs {max(needed, 1)} bytes, its file holds {size}; "
                f"copy or export it again: {path}"
            )


def _files(array: Any, picked: Sequence[int | slice]) -> Iterator[tuple[str, Path]]:
    """Names and files of the chunks that have one; the others are all fill value."""
    place = getattr(array, "store_path", None)
    root = getattr(getattr(place, "store", None), "root", None)
    encode = getattr(getattr(array, "metadata", None), "encode_chunk_key", None)
    if root is None or encode is None:
        return
    folder = Path(root) / getattr(place, "path", "")
    for number in chunk_numbers(array, picked):
        name = str(encode(number))
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
    place = folder / name
    try:
        mode = place.stat().st_mode
    except FileNotFoundError:
        _check_links(folder, place, name)
        return False
    except NotADirectoryError:
        raise FileError(
            f"chunk {name!r} cannot be there, since a file has the name of its folder; copy or export the array again: "
            f"{folder}"
        ) from None
    except OSError as error:
        raise FileError(
            f"cannot read chunk {name!r}: {error.strerror}; check its permissions, or copy the array again: {folder}"
        ) from None
    if not stat.S_ISREG(mode):
        what = "a folder" if stat.S_ISDIR(mode) else "a device, a pipe or a socket"
        raise FileError(f"chunk {name!r} is {what} and no file; copy or export the array again: {folder}")
    return True


def _check_links(folder: Path, place: Path, name: str) -> None:
    """Raise a `FileError` where a link on the path to a chunk leads nowhere, as git-annex's do before a file is got."""
    while place != folder:
        if place.is_symlink():
            raise FileError(
                f"chunk {name!r} is behind a link to what is not there; get the linked files, or copy the array with "
                f"them: {place}"
            )
        if place.exists():
            return
        place = place.parent


def _file_chunks(array: Any) -> tuple[int, ...]:
    """Samples along each axis that share a file."""
    shards = getattr(array, "shards", None)
    return tuple(int(n) for n in (shards or array.chunks))


def _n_bytes_needed(array: Any, file: Path) -> int:
    """Least length of a chunk's file, in bytes; 0 where only decoding shows it."""
    codecs = [*(array.filters or ()), *(array.compressors or ())]
    if getattr(array, "shards", None):
        return 0
    if not codecs:
        return int(np.prod(array.chunks)) * int(array.dtype.itemsize)
    if "blosc" not in type(codecs[-1]).__name__.lower():
        return 0
    with file.open("rb") as stream:
        header = stream.read(BLOSC_HEADER)
    return int.from_bytes(header[12:16], "little") if len(header) == BLOSC_HEADER else BLOSC_HEADER
