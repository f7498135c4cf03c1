"""Chunk files of Zarr arrays: that they are whole and no longer than can be, and whether they changed.

Writers rename chunks into place (zarr-python) or write into them (others), so folders' times are not enough: every
file is asked for its state (`python benches/surveys.py` measures how long that takes). Opening an array costs nothing:
the pass is made for its first picture.
"""

from __future__ import annotations

import hashlib
import json
import os
import stat
import time
from collections.abc import Iterator, Sequence
from contextlib import suppress
from itertools import product
from math import prod
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wavesplat._storage.file_states import FileChangedError, state_of, wait_for_next_tick
from wavesplat._storage.zarr.place import ZarrPlace
from wavesplat.errors import FileError

# Checks of the chunk files of Zarr arrays: that they are whole, before they are decoded, and no longer than can be.
#
# Blosc says in each chunk how long it is and reads that far, also past the end of its input: a file that was cut
# short comes back with whatever lies behind it in memory. A shard of no bytes is taken for one that is not there.
# Header of Blosc: https://www.blosc.org/c-blosc2/format/chunk_format.html, the packed size in bytes 12 to 16.

#: Bytes of the header of blosc.
BLOSC_HEADER = 16
#: Bytes of a sample in the widest type that filters store; of overhead for each inner chunk of a shard; and of a margin
#: for every chunk.
WIDEST, INNER_BYTES, MARGIN_BYTES = 8, 256, 1 << 16


def check_chunks(array: Any, picked: Sequence[int | slice], path: object) -> None:
    """Raise a `FileError` that names the first chunk with picked samples that is cut short or no file.

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


# States of all chunk files of a Zarr array in a folder, from one pass over the folder.

#: Names of the files that describe an array.
ARRAY_METADATA_NAMES = ("zarr.json", ".zarray")
#: A pass that takes longer, in seconds, is not made for every picture: at most a 20th of the time goes into them.
#: Between passes the folders alone are checked, whose times show chunks that were renamed into place.
LONG_PASS, SHARE = 0.25, 20


class _ChunkScan:
    """One pass over the chunk files: numbers of chunks, their states, and times of the folders that hold them."""

    def __init__(self, folder: Path, grid: Sequence[int], picked: Sequence[int | None]) -> None:
        begun = time.monotonic()
        self._grid, self._picked = grid, picked
        self._numbers: list[int] = []
        self._states: list[int] = []
        self.folders: dict[str, int] = {}
        self.written_ns = 0
        self._root = str(folder)
        self._look_into(self._root, ())
        order = np.argsort(np.array(self._numbers, np.int64), kind="stable")
        self.numbers: NDArray[np.int64] = np.array(self._numbers, np.int64)[order]
        self.states: NDArray[np.int64] = np.array(self._states, np.int64)[order]
        del self._numbers, self._states
        self.ended = time.monotonic()
        self.seconds = self.ended - begun

    def _look_into(self, place: str, before: tuple[int, ...]) -> None:
        """Add the picked chunks below a folder, which stands for the first of their numbers, `before`.

        The names are `c/1/2/3`, `1/2/3`, or the same with dots; other names are no chunks.
        """
        self.folders[place] = Path(place).stat().st_mtime_ns
        is_last = len(before) == len(self._grid) - 1
        with os.scandir(place) as entries:
            for entry in entries:
                name = entry.name
                if is_last and name.isdecimal():  # most names are such, so they take the short way
                    self._add((*before, int(name)), entry)
                    continue
                parts = name.split(".")
                if place == self._root and parts[0] == "c":
                    del parts[0]
                if not all(part.isdecimal() for part in parts):
                    continue
                own = (*before, *map(int, parts))
                if len(own) == len(self._grid):
                    self._add(own, entry)
                elif len(own) < len(self._grid) and self._is_wanted(own) and entry.is_dir():
                    self._look_into(entry.path, own)

    def _is_wanted(self, own: tuple[int, ...]) -> bool:
        return all(want is None or want == k for want, k in zip(self._picked, own, strict=False))

    def _add(self, own: tuple[int, ...], entry: os.DirEntry[str]) -> None:
        for k, n, want in zip(own, self._grid, self._picked, strict=True):
            if k >= n or (want is not None and want != k):
                return
        try:
            # Windows keeps old times in the entries of a folder.
            found = Path(entry.path).stat() if os.name == "nt" else entry.stat()
        except FileNotFoundError:
            return  # removed meanwhile, or a link to nothing, which is an error where it is read
        state = state_of(found)
        self.written_ns = max(self.written_ns, state[1])
        self._numbers.append(_number(own, self._grid))
        # A hash of 64 bits makes a missed change improbable enough, and takes 8 bytes a chunk.
        self._states.append(hash(state))

    def is_same(self, other: _ChunkScan) -> bool:
        """Whether all chunks have the same states as in another scan."""
        return np.array_equal(self.numbers, other.numbers) and np.array_equal(self.states, other.states)

    def state(self, number: int) -> int | None:
        """The state of a chunk; None for one that was not there."""
        at = int(np.searchsorted(self.numbers, number))
        return int(self.states[at]) if at < len(self.numbers) and self.numbers[at] == number else None


def _number(place: Sequence[int], grid: Sequence[int]) -> int:
    """Number of a chunk in C order.

    Python's integers, since NumPy's ravel_multi_index refuses grids of 2^63 places, which metadata may claim.
    """
    number = 0
    for k, n in zip(place, grid, strict=True):
        number = number * n + k
    return number


class ChunkFiles:
    """Chunk files of a Zarr array, at a picked index of each axis other than z, y, x."""

    def __init__(self, array: Any, folder: Path, picked: Sequence[int | None]) -> None:
        self._array, self._folder = array, folder
        sizes = [int(n) for n in (array.shards or array.chunks)]
        self._grid = [-(-int(n) // size) for n, size in zip(array.shape, sizes, strict=True)]
        self._picked = [None if one is None else one // size for one, size in zip(picked, sizes, strict=True)]
        self._metadata = _metadata(folder)
        self._seen: _ChunkScan | None = None
        #: Number of passes that found other states than the pass before.
        self.n_changes = 0

    def begin(self) -> None:
        """Make the first pass over the files, if there was none."""
        if self._seen is None:
            self._seen = self._passed()

    def _passed(self) -> _ChunkScan:
        try:
            return _ChunkScan(self._folder, self._grid, self._picked)
        except OSError as error:
            raise FileChangedError(
                f"the chunks cannot be looked at ({error.strerror}); draw again once nobody writes to the array: "
                f"{error.filename or self._folder}"
            ) from None

    def fingerprint(self) -> str | None:
        """A hash of all states, and of the metadata; None where a chunk was written just now, by whole seconds."""
        self.begin()
        seen = self._seen
        assert seen is not None
        if not wait_for_next_tick(seen.written_ns):
            return None
        digest = hashlib.sha256(f"{self._folder.absolute()}\n{self._metadata}\n".encode("utf-8", "surrogateescape"))
        digest.update(seen.numbers.tobytes())
        digest.update(seen.states.tobytes())
        return digest.hexdigest()

    def check_read(self, index: Sequence[int | slice]) -> None:
        """Raise a `FileChangedError` if a chunk that was just read is not in the state of the last pass."""
        seen = self._seen
        if seen is None:
            return
        encode, folder = self._array.metadata.encode_chunk_key, str(self._folder)
        for place in chunk_numbers(self._array, index):
            name = str(encode(place))
            try:
                found = os.stat(f"{folder}/{name}")  # noqa: PTH116 - a Path costs more than the call
                now: int | None = hash(state_of(found))
            except OSError:
                now = None
            if now != seen.state(_number(place, self._grid)):
                raise FileChangedError(
                    f"chunk {name!r} was written to while it was drawn; draw again once nobody writes to the array: "
                    f"{self._folder}"
                )

    def look_again(self) -> None:
        """Count a change if a chunk was changed, added or removed since the last pass; nothing before the first."""
        seen = self._seen
        if seen is None:
            return
        if _metadata(self._folder) != self._metadata:
            raise FileChangedError(f"the array was written anew since it was opened; open it again: {self._folder}")
        if (
            seen.seconds > LONG_PASS
            and time.monotonic() < seen.ended + SHARE * seen.seconds
            and _have_same_mtimes(seen.folders)
        ):
            return
        self._seen = self._passed()
        self.n_changes += not self._seen.is_same(seen)

    def __getstate__(self) -> dict[str, object]:
        # States have 16 bytes a chunk, and are the business of the process that sends the array.
        return {**self.__dict__, "_seen": None}


def _have_same_mtimes(folders: dict[str, int]) -> bool:
    """Whether no folder's modification time has changed."""
    try:
        return all(Path(folder).stat().st_mtime_ns == written for folder, written in folders.items())
    except OSError:
        return False


def _metadata(folder: Path) -> str:
    """Hash of an array's metadata without its attributes, which say nothing of samples."""
    digest = hashlib.sha256()
    for name in ARRAY_METADATA_NAMES:
        with suppress(OSError):
            text = (folder / name).read_bytes()
            with suppress(ValueError, AttributeError):
                fields = json.loads(text)
                fields.pop("attributes", None)
                text = json.dumps(fields, sort_keys=True).encode()
            digest.update(text)
    return digest.hexdigest()


def chunk_files(array: Any, picked: Sequence[int | None]) -> ChunkFiles | None:
    """The chunk files of an array in a folder; None for other stores."""
    place = array.store_path
    root = getattr(place.store, "root", None)
    if not isinstance(root, Path) or array.ndim < 1:
        return None
    folder = root / place.path
    # Only for chunk names that a pass finds.
    name = str(array.metadata.encode_chunk_key(tuple(range(1, array.ndim + 1))))
    numbers = ".".join(map(str, range(1, array.ndim + 1)))
    if name.replace("/", ".") not in (numbers, f"c.{numbers}"):
        return None
    return ChunkFiles(array, folder, picked) if any((folder / one).is_file() for one in ARRAY_METADATA_NAMES) else None
