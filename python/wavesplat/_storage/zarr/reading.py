"""Reading of the samples of Zarr arrays in folders and archives: chunks are decoded into an array in memory.

zarr takes every chunk through an event loop, a thread and several objects, which costs several times as much as zstd
does for a chunk of 64^3 bytes. The usual codecs are undone here; arrays with any other are read by zarr.
Formats: https://zarr-specs.readthedocs.io/en/latest/v2/v2.0.html and .../v3/core/index.html; shards:
https://zarr-specs.readthedocs.io/en/latest/v3/codecs/sharding-indexed/index.html
"""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from itertools import product
from math import prod
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wavesplat._storage.zarr.chunk_files import BLOSC_HEADER, check_missing, expect_chunks, packed_bytes, truncated
from wavesplat._storage.zarr.place import ZarrPlace, place_of

#: Compressors that numcodecs undoes without configuration, by their names in the metadata.
COMPRESSORS = {"blosc", "bz2", "gzip", "lz4", "lzma", "zlib", "zstd"}
#: Compressors of Zarr v3, a part of them.
COMPRESSORS_OF_V3 = {"blosc", "gzip", "zstd"}
#: Bytes of a checksum.
CRC_BYTES = 4
#: Bytes of the longest header of a frame of Zstandard, and those that it begins with.
ZSTD_HEADER, ZSTD_MAGIC = 18, b"\x28\xb5\x2f\xfd"
#: Offset and length of an inner chunk that a shard does not have.
NONE_STORED = 2**64 - 1

#: Function from bytes, and an array for the outcome or None, to bytes.
Unpack = Callable[[Any, Any], Any]
#: Scratch memory of each thread, for the chunk that it decodes.
SCRATCH = threading.local()


@dataclass(frozen=True)
class ChunkDecoder:
    """Functions and layout by which the bytes of a chunk become samples.

    unpack : functions from bytes and an array for the outcome, or None, to bytes, in the order of decoding.
    dtype : type of the stored samples, with their byte order.
    shape : samples along the stored axes.
    axes : the stored axis that is each axis of the array.
    is_blosc : whether blosc was applied last, so that the file begins with its header.
    unpacked_size : function that reads the number of unpacked bytes from the header of packed ones; None without one.
    """

    unpack: tuple[Unpack, ...]
    dtype: np.dtype[Any]
    shape: tuple[int, ...]
    axes: tuple[int, ...]
    is_blosc: bool = False
    unpacked_size: Callable[[Any], int | None] | None = None

    @property
    def n_bytes(self) -> int:
        """Bytes of a chunk that is unpacked."""
        return prod(self.shape) * self.dtype.itemsize

    def __call__(self, content: bytes) -> NDArray[Any]:
        """Decode a chunk; the axes of the samples are the array's. An exception of any type if it is damaged.

        The samples may lie in memory that the next chunk of this thread is decoded into.
        """
        unpacked: Any = content
        for unpack in self.unpack[:-1]:
            unpacked = unpack(unpacked, None)
        if self.unpack:
            unpacked = self._unpacked_last(unpacked)
        n = memoryview(unpacked).nbytes
        if n != self.n_bytes:
            raise self._wrong_size(n)
        return np.frombuffer(unpacked, self.dtype).reshape(self.shape).transpose(self.axes)

    def _unpacked_last(self, packed: Any) -> Any:
        """The bytes of the samples, by the last function: in memory of this thread where their header says they fit it.

        What says that it is longer is not unpacked, as a few kilobytes can unpack to gigabytes.
        """
        declared = None if self.unpacked_size is None else self.unpacked_size(packed)
        if declared is None:
            return self.unpack[-1](packed, None)
        if declared != self.n_bytes:
            raise self._wrong_size(declared)
        if getattr(SCRATCH, "memory", None) is None or SCRATCH.memory.nbytes != declared:
            SCRATCH.memory = np.empty(declared, np.uint8)
        self.unpack[-1](packed, SCRATCH.memory)
        return SCRATCH.memory

    def _wrong_size(self, n: int) -> ValueError:
        return ValueError(f"a chunk unpacks to {n} bytes instead of {self.n_bytes}")


@dataclass(frozen=True)
class ShardIndex:
    """Layout of the index of a shard: where its inner chunks are.

    grid : inner chunks of a shard along each axis of the array.
    is_first : whether the index lies at the start of the file, not at its end.
    has_checksum : whether a checksum follows it.
    """

    grid: tuple[int, ...]
    is_first: bool
    has_checksum: bool

    @property
    def part(self) -> tuple[int, int | None]:
        """First byte and end of the index in the file; a negative first byte counts from the file's end."""
        n = 16 * prod(self.grid) + CRC_BYTES * self.has_checksum
        return (0, n) if self.is_first else (-n, None)

    def places(self, content: bytes) -> NDArray[np.uint64]:
        """Offset and length of every inner chunk, from the bytes of the index; shape (*grid, 2)."""
        n = 16 * prod(self.grid)
        own = _checked(content) if self.has_checksum else content
        if len(own) != n:
            raise ValueError(f"truncated: the index of a shard has {len(own)} bytes instead of {n}")
        return np.frombuffer(own, "<u8").reshape(*self.grid, 2)


def decoder_of(array: Any) -> ChunkDecoder | None:
    """The decoder of a zarr array's chunks, of shards of the inner chunks; None where a codec is not known here."""
    metadata, dtype = array.metadata.to_dict(), np.dtype(array.dtype)
    if dtype.kind not in "biuf":
        return None
    if metadata["zarr_format"] == 2:
        return _decoder_of_v2(metadata, dtype)
    if not _is_plain_v3(metadata):
        return None
    codecs, shape = metadata["codecs"], _chunk_shape(metadata["chunk_grid"])
    if (shards := _sharding(codecs)) is not None:
        codecs, shape = shards["codecs"], _chunk_shape({"configuration": shards})
    return _decoder_of_codecs(codecs, dtype, shape)


def shard_index_of(array: Any) -> ShardIndex | None:
    """The layout of the indices of an array's shards; None for an array without shards.

    Raises
    ------
    ValueError
        If the index itself is packed.
    """
    metadata = array.metadata.to_dict()
    shards = None if metadata["zarr_format"] == 2 else _sharding(metadata["codecs"])
    if shards is None:
        return None
    names = [codec["name"] for codec in shards["index_codecs"]]
    if names[:1] != ["bytes"] or names[1:] not in ([], ["crc32c"]) or not _is_little(shards["index_codecs"][0]):
        raise ValueError(f"the index of shards is packed by {names}")
    outer, inner = _chunk_shape(metadata["chunk_grid"]), _chunk_shape({"configuration": shards})
    grid = tuple(a // b for a, b in zip(outer, inner, strict=True))
    return ShardIndex(grid, str(shards.get("index_location", "end")) == "start", len(names) == 2)


def _decoder_of_v2(metadata: Mapping[str, Any], dtype: np.dtype[Any]) -> ChunkDecoder | None:
    compressor, shape = metadata["compressor"], tuple(int(n) for n in metadata["chunks"])
    if metadata["filters"] or (compressor and compressor["id"] not in COMPRESSORS):
        return None
    unpack = (_decompressor(compressor["id"]),) if compressor else ()
    axes = tuple(range(len(shape)))
    if metadata["order"] == "F":
        shape, axes = shape[::-1], axes[::-1]
    name = compressor["id"] if compressor else ""
    return ChunkDecoder(unpack, dtype, shape, axes, is_blosc=name == "blosc", unpacked_size=UNPACKED_SIZES.get(name))


def _decoder_of_codecs(
    codecs: Iterable[Mapping[str, Any]], dtype: np.dtype[Any], shape: tuple[int, ...]
) -> ChunkDecoder | None:
    """The decoder of a chain of codecs of Zarr v3: transpositions, the order of bytes, compressors and checksums."""
    axes, unpack, names = list(range(len(shape))), list[Unpack](), list[str]()
    unpacked_size = None
    for codec in codecs:
        name = codec["name"]
        if name == "transpose":
            # Axis k of the outcome is axis order[k] of the input.
            axes = [axes[axis] for axis in codec["configuration"]["order"]]
        elif name == "bytes":
            dtype = dtype.newbyteorder("<" if _is_little(codec) else ">")
        elif name == "crc32c":
            unpack.insert(0, _without_checksum)
        elif name in COMPRESSORS_OF_V3:
            if not unpack:
                unpacked_size = UNPACKED_SIZES.get(name)
            unpack.insert(0, _decompressor(name))
        else:
            return None
        names.append(name)
    stored = tuple(shape[axis] for axis in axes)
    back = tuple(int(axis) for axis in np.argsort(axes))
    return ChunkDecoder(tuple(unpack), dtype, stored, back, is_blosc=names[-1] == "blosc", unpacked_size=unpacked_size)


def _is_plain_v3(metadata: Mapping[str, Any]) -> bool:
    """Whether the chunks are a regular grid, and nothing lies between it and the store."""
    return metadata["chunk_grid"]["name"] == "regular" and not metadata.get("storage_transformers")


def _chunk_shape(grid: Mapping[str, Any]) -> tuple[int, ...]:
    return tuple(int(n) for n in grid["configuration"]["chunk_shape"])


def _sharding(codecs: Sequence[Mapping[str, Any]]) -> Mapping[str, Any] | None:
    """Configuration of the codec of shards, where that is the only codec."""
    only = codecs[0] if len(codecs) == 1 else {}
    found: Mapping[str, Any] | None = only["configuration"] if only.get("name") == "sharding_indexed" else None
    return found


def _is_little(codec: Mapping[str, Any]) -> bool:
    # Types of one byte have no order.
    return str(codec.get("configuration", {}).get("endian") or "little") == "little"


def _decompressor(name: str) -> Unpack:
    import numcodecs

    decode: Unpack = numcodecs.get_codec({"id": name}).decode
    return decode


def _without_checksum(content: Any, _: object) -> Any:
    return _checked(content)


def _checked(content: Any) -> Any:
    """The content before a CRC-32C at its end, which is compared."""
    import google_crc32c

    own, declared = bytes(content[:-CRC_BYTES]), bytes(content[-CRC_BYTES:])
    if google_crc32c.value(own).to_bytes(CRC_BYTES, "little") != declared:
        raise ValueError("the checksum is wrong: the content is damaged")
    return own


def _size_in_blosc_header(packed: Any) -> int | None:
    return int.from_bytes(packed[4:8], "little") if len(packed) >= BLOSC_HEADER else None


def _size_in_lz4_header(packed: Any) -> int | None:
    return int.from_bytes(packed[:4], "little") if len(packed) > 4 else None


def _size_in_zstd_header(packed: Any) -> int | None:
    """Content size in the header of a frame of Zstandard; None where it has none (RFC 8878, 3.1.1.1)."""
    if len(packed) < ZSTD_HEADER or packed[:4] != ZSTD_MAGIC:
        return None
    descriptor = packed[4]
    flag, is_single = descriptor >> 6, descriptor >> 5 & 1
    n = (is_single, 2, 4, 8)[flag]
    if n == 0:
        return None
    first = 5 + (1 - is_single) + (0, 1, 2, 4)[descriptor & 3]
    return int.from_bytes(packed[first : first + n], "little") + (256 if n == 2 else 0)


#: Compressors whose headers say how many bytes they unpack to.
UNPACKED_SIZES: dict[str, Callable[[Any], int | None]] = {
    "blosc": _size_in_blosc_header,
    "lz4": _size_in_lz4_header,
    "zstd": _size_in_zstd_header,
}


# Reading of the samples of Zarr arrays in folders and archives, chunk by chunk into an array in memory.

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
        """Read the samples at an index into an array of zeros, of the same axes but the axes with a whole number.

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
        """The bytes of a chunk; None where there are none. `indices`: of the shards that were met."""
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
