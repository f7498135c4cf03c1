"""Reading of the samples of Zarr arrays in folders and archives, chunk by chunk into an array in memory."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from itertools import product
from math import prod
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wavesplat._files.zarr_chunks import BLOSC_HEADER, check_missing, expect_chunks, packed_bytes, truncated
from wavesplat._files.zarr_decoding import NONE_STORED, ChunkDecoder, ShardIndex, decoder_of, shard_index_of
from wavesplat._files.zarr_place import ZarrPlace, place_of

#: Index along an axis, or a range of indices.
Part = int | slice
#: Threads that read and decode chunks at once.
N_THREADS = 4


class ZarrReader:
    """An array that is sliced like the zarr array that it reads, for whole numbers and ranges without steps."""

    def __init__(self, array: Any, place: ZarrPlace, decode: ChunkDecoder, shards: ShardIndex | None) -> None:
        self.shape, self.dtype = tuple(int(n) for n in array.shape), np.dtype(array.dtype)
        self.chunks = tuple(int(n) for n in array.chunks)  # of shards the inner ones
        self._place, self._decode, self._shards = place, decode, shards
        self._prefix = f"{array.path}/" if array.path else ""
        self._folder = None if place.root is None else f"{place.root}/{array.path}".rstrip("/")
        self._key = array.metadata.encode_chunk_key
        self._fill = self.dtype.type(0 if array.fill_value is None else array.fill_value)

    def __getitem__(self, index: tuple[Part, ...]) -> NDArray[Any]:
        samples = np.zeros([part.stop - part.start for part in index if isinstance(part, slice)], self.dtype)
        self.read_into(index, samples)
        return samples

    def read_by_threads(self, index: tuple[Part, ...]) -> NDArray[Any]:
        """The samples at an index, as slicing gives them, read by several threads."""
        samples = np.zeros([part.stop - part.start for part in index if isinstance(part, slice)], self.dtype)
        pool = ThreadPoolExecutor(N_THREADS)
        try:
            for done in [pool.submit(self.read_into, part, samples[here]) for part, here in self._layers(index)]:
                done.result()
        finally:
            pool.shutdown(cancel_futures=True)
        return samples

    def _layers(self, index: tuple[Part, ...]) -> Iterator[tuple[tuple[Part, ...], tuple[slice, ...]]]:
        """Parts of an index that share no file, cut along the first two ranges, and their places in the outcome."""
        ranges = [axis for axis, part in enumerate(index) if isinstance(part, slice)]
        per_file = self.chunks if self._shards is None else np.multiply(self.chunks, self._shards.grid).tolist()
        for pieces in product(*(_pieces(per_file[axis], index[axis]) for axis in ranges[:2])):
            part = list(index)
            for axis, (number, own, _) in zip(ranges, pieces, strict=False):
                first = number * per_file[axis]
                part[axis] = slice(own.start + first, own.stop + first) if isinstance(own, slice) else own
            yield tuple(part), tuple(place for _, _, place in pieces if place is not None)

    def read_into(self, index: Sequence[Part], out: NDArray[Any]) -> None:
        """Read the samples at an index into an array of zeros, of the same axes but those with a whole number.

        Where chunks of zeros are not stored, nothing is written, so that their memory is not even touched.

        Raises
        ------
        FileError
            If a chunk is cut short, no file, or more than can be there.
        ValueError
            If a chunk is damaged.
        """
        indices: dict[str, NDArray[np.uint64] | None] = {}
        for pieces in product(*map(_pieces, self.chunks, index)):
            number = tuple(piece[0] for piece in pieces)
            here = tuple(piece[2] for piece in pieces if piece[2] is not None)
            content = self._content(number, indices)
            if content is not None:
                out[here] = self._decoded(content, number)[tuple(piece[1] for piece in pieces)]
            elif self._fill != 0:
                out[here] = self._fill

    def _decoded(self, content: bytes, number: tuple[int, ...]) -> NDArray[Any]:
        try:
            return self._decode(content)
        except Exception as error:  # codecs raise errors of any type
            grid = (1,) * len(number) if self._shards is None else self._shards.grid
            name = self._key(tuple(k // n for k, n in zip(number, grid, strict=True)))
            raise ValueError(f"chunk {name!r}: {error}") from error

    def _content(self, number: tuple[int, ...], indices: dict[str, NDArray[np.uint64] | None]) -> bytes | None:
        """The bytes of a chunk; None where there are none. `indices`: those of the shards that were met."""
        if self._shards is None:
            return self._whole(self._key(number))
        outer, inner = zip(*map(divmod, number, self._shards.grid), strict=True)
        name = self._key(outer)
        if name not in indices:
            content = self._read(name, self._shards.part)
            indices[name] = None if content is None else self._shards.places(content)
        places = indices[name]
        first, n = (NONE_STORED, NONE_STORED) if places is None else map(int, places[inner])
        if first == n == NONE_STORED:
            return None
        content = self._read(name, (first, first + n))
        if content is None or len(content) < n:
            raise truncated(name, first + n, len(content or b"") + first, self._place)
        return content

    def _whole(self, name: str) -> bytes | None:
        content = self._read(name)
        if content is None:
            return None
        if not self._decode.unpack:
            needed = self._decode.n_bytes
        else:
            needed = packed_bytes(content[:BLOSC_HEADER]) if self._decode.is_blosc else 0
        if not content or len(content) < needed:
            raise truncated(name, needed, len(content), self._place)
        return content

    def _read(self, name: str, part: tuple[int, int | None] | None = None) -> bytes | None:
        content = self._place.read(self._prefix + name, part)
        if content is None and self._folder is not None:
            check_missing(self._folder, name)
        return content


def _pieces(size: int, part: Part) -> Iterator[tuple[int, Part, slice | None]]:
    """The chunks along an axis that hold a part of it: their numbers, the part in the chunk, and its place in the part.

    A whole number has no place, since its axis is left out.
    """
    if not isinstance(part, slice):
        yield part // size, part % size, None
        return
    for number in range(part.start // size, -(-part.stop // size)):
        first, end = max(part.start, number * size), min(part.stop, (number + 1) * size)
        yield number, slice(first - number * size, end - number * size), slice(first - part.start, end - part.start)


def read_zarr(array: Any, index: Sequence[Part]) -> NDArray[Any]:
    """The samples of a zarr array at whole numbers and ranges without steps, as `array[index]` gives them."""
    reader = zarr_reader(array)
    if reader is None:
        return np.asarray(array[tuple(index)])
    ranges = (
        slice(*part.indices(n)[:2]) if isinstance(part, slice) else part
        for part, n in zip(index, array.shape, strict=True)
    )
    return reader.read_by_threads(tuple(ranges))


def zarr_reader(array: Any) -> ZarrReader | None:
    """The reader of a zarr array in a folder or an archive; None for other stores and codecs."""
    if prod(array.shape) == 0:
        return None
    place = place_of(array)
    if place is None:
        root = getattr(array.store_path.store, "root", None)
        if not isinstance(root, Path):
            return None
        place = ZarrPlace(root)
    decode = decoder_of(array) if place.is_local else None
    if decode is None:
        return None
    try:
        shards = shard_index_of(array)
    except ValueError:
        return None
    expect_chunks(array, place)
    return ZarrReader(array, place, decode, shards)
