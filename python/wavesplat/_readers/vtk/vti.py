"""VTK's XML images (.vti): one array of points or cells, in one piece or several.

No library but VTK itself reads them, and it is large.
Format: "XML File Formats", https://docs.vtk.org/en/latest/vtk_file_formats/vtkxml_file_format.html, and for the bytes
before the samples "VTK XML Formats", https://itk.org/Wiki/VTK_XML_Formats.
The file says nothing of a patient: its axes are kept as they are.
"""

from __future__ import annotations

import base64
import lzma
import mmap
import xml.etree.ElementTree as ET
import zlib
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from wavesplat._model.volume.facts import Facts
from wavesplat._readers.components import component_of, facts_of_colors, quantity_of_array
from wavesplat._readers.file_contents import MAX_BYTES, Contents, FileArray, joined_ranges, ranges_of
from wavesplat._readers.request import Grid, Request
from wavesplat._readers.vtk.arrays import chosen, image_facts, other_grid, world_from_index
from wavesplat._readers.vtk.sampling import GHOSTS, without_hidden
from wavesplat._storage import size_checks
from wavesplat._storage.reading import mapped, reading
from wavesplat.errors import FileError

#: VTK's name of a type -> NumPy's.
TYPES = {"Float32": "f4", "Float64": "f8"} | {
    f"{kind}{8 * n}": f"{name}{n}" for kind, name in (("Int", "i"), ("UInt", "u")) for n in (1, 2, 4, 8)
}

#: Codec -> function that unpacks a block, to at most a number of bytes, and its largest ratio of compression.
CODECS: dict[str, tuple[Callable[[bytes, int], bytes], int]] = {
    "vtkZLibDataCompressor": (lambda data, n: zlib.decompressobj().decompress(data, n), size_checks.DEFLATE_RATIO),
    "vtkLZMADataCompressor": (lambda data, n: lzma.LZMADecompressor().decompress(data, n), size_checks.ANY_RATIO),
}


def read(request: Request) -> Grid:
    """The volume in a .vti file: the array that it names as its scalars, or the one that `dataset` names."""
    path = request.file
    with reading("a VTK image", path), mapped(path) as content:
        return _read(request, _Stored.of(content, path))


def _read(request: Request, stored: _Stored) -> Grid:
    path = request.path
    image = stored.header.find("ImageData")
    if image is None:
        raise other_grid(stored.header.get("type", ""), path)
    whole = _extent(image.get("WholeExtent", ""))
    array, guessed = _chosen(image, request)
    size = _size(whole, array.of_cells)
    samples: NDArray[Any] | None = None
    n_cells = 0
    guesses: tuple[str, ...] = ()
    quantity: str | None = None
    for extent, numbers in _parts(stored, image, array, whole):
        part, guesses = component_of(numbers, request, array.name)
        quantity = quantity_of_array(array.name, array.n_components, numbers.dtype, request)
        if samples is None:
            size_checks.check_memory(size_checks.n_bytes(size, part.dtype), path)
            samples = np.zeros(size[::-1], part.dtype)
        first = extent[:, 0] - whole[:, 0]
        samples[tuple(slice(i, i + n) for i, n in zip(first[::-1], part.shape, strict=True))] = part
        n_cells += _n_cells(extent)
    # Pieces share points, but no cells.
    if samples is None or n_cells != _n_cells(whole):
        raise FileError(
            f"the pieces of {array.name!r} do not fill the file's extent; write them all into one file: {path}"
        )
    ghosts = (_ghosts(stored, image, whole, of_cells=False), _ghosts(stored, image, whole, of_cells=True))
    samples, hidden = without_hidden(samples, *ghosts, are_cells=array.of_cells)
    colors = facts_of_colors(array.n_components, samples.dtype, request)
    facts = Facts(quantity=quantity, guesses=guessed + guesses + hidden, **colors)
    return Grid(samples, _world_from_index(image, whole, array.of_cells), facts)


def _ghosts(
    stored: _Stored, image: ET.Element, whole: NDArray[np.int64], *, of_cells: bool
) -> NDArray[np.uint8] | None:
    """The ghost types of all points or cells, [z, y, x]; None in a file without them."""
    found: NDArray[np.uint8] | None = None
    for piece in image.iter("Piece"):
        extent = _extent(piece.get("Extent", ""))
        for array in piece.findall("CellData/DataArray" if of_cells else "PointData/DataArray"):
            if array.get("Name") == GHOSTS and array.get("type") == "UInt8":
                part = stored.samples(array, _size(extent, of_cells)[::-1])
                found = np.zeros(_size(whole, of_cells)[::-1], np.uint8) if found is None else found
                first = (extent[:, 0] - whole[:, 0])[::-1]
                found[tuple(slice(i, i + n) for i, n in zip(first, part.shape, strict=True))] = part
    return found


@dataclass(frozen=True)
class _Array:
    """An array of points or cells that the first piece of an image describes."""

    name: str
    of_cells: bool
    n_components: int
    kind: str


def _arrays(image: ET.Element) -> tuple[list[_Array], list[str]]:
    """The arrays of an image, and the names of those that are its scalars."""
    piece = image.find("Piece")
    points, cells = ([], []) if piece is None else (piece.findall("PointData"), piece.findall("CellData"))
    arrays = [
        _Array(array.get("Name", ""), part in cells, int(array.get("NumberOfComponents") or 1), array.get("type", ""))
        for part in (*points, *cells)
        for array in part.findall("DataArray")
        if array.get("Name") != GHOSTS
    ]
    return arrays, [name for part in (*points, *cells) if (name := part.get("Scalars", ""))]


def _chosen(image: ET.Element, request: Request) -> tuple[_Array, tuple[str, ...]]:
    """The array to draw, and sentences on what was guessed."""
    arrays, scalars = _arrays(image)
    names, sizes = [array.name for array in arrays], [array.n_components for array in arrays]
    number, guessed = chosen(names, scalars, sizes, request)
    return arrays[number], guessed


def _parts(
    stored: _Stored, image: ET.Element, array: _Array, whole: NDArray[np.int64]
) -> Iterator[tuple[NDArray[np.int64], NDArray[Any]]]:
    """The extents of the pieces that have an array, and its numbers there, [z, y, x, component]."""
    for piece in image.iter("Piece"):
        extent = _extent(piece.get("Extent", ""))
        if (extent[:, 0] < whole[:, 0]).any() or (extent[:, 1] > whole[:, 1]).any():
            raise ValueError("a piece beyond the extent")
        for one in piece.findall("CellData/DataArray" if array.of_cells else "PointData/DataArray"):
            if one.get("Name", "") == array.name:
                shape = (*_size(extent, array.of_cells)[::-1], array.n_components)
                yield extent, stored.samples(one, shape)


def contents(request: Request) -> Contents:
    """All arrays of the file."""
    with reading("a VTK image", request.path), mapped(request.file) as content:
        stored = _Stored.of(content, request.file)
        image = stored.header.find("ImageData")
        if image is None:
            raise other_grid(stored.header.get("type", ""), request.path)
        whole = _extent(image.get("WholeExtent", ""))
        found = [_described(stored, image, array, whole) for array in _arrays(image)[0]]
        corners = _world_from_index(image, whole, of_cells=False)
        n_points = tuple(int(n) for n in _size(whole, of_cells=False))
        return Contents(tuple(found), image_facts("ImageData", n_points, corners))


def _described(stored: _Stored, image: ET.Element, array: _Array, whole: NDArray[np.int64]) -> FileArray:
    looks = array.kind in TYPES and len(stored.content) <= MAX_BYTES
    parts = [part for _, part in _parts(stored, image, array, whole)] if looks else []
    return FileArray(
        array.name,
        str(np.dtype(TYPES[array.kind])) if array.kind in TYPES else array.kind,
        tuple(_size(whole, array.of_cells)[::-1]),
        array.n_components,
        "cells" if array.of_cells else "points",
        joined_ranges([ranges_of(part, has_components=True) for part in parts]),
    )


def _extent(text: str) -> NDArray[np.int64]:
    """First and last point along x, y, z."""
    extent = np.array(text.split(), np.int64).reshape(3, 2)
    if (extent[:, 1] < extent[:, 0]).any():
        raise ValueError(f"an extent of {text}")
    return extent


def _size(extent: NDArray[np.int64], of_cells: bool) -> tuple[int, int, int]:
    """Samples along x, y, z; a layer of points counts as one of cells."""
    steps = extent[:, 1] - extent[:, 0]
    nx, ny, nz = (max(int(n), 1) if of_cells else int(n) + 1 for n in steps)
    return nx, ny, nz


def _n_cells(extent: NDArray[np.int64]) -> int:
    nx, ny, nz = _size(extent, of_cells=True)
    return nx * ny * nz


def _world_from_index(image: ET.Element, whole: NDArray[np.int64], of_cells: bool) -> NDArray[np.float64]:
    def numbers(name: str, default: str) -> NDArray[np.float64]:
        return np.array((image.get(name) or default).split(), np.float64)

    direction, spacing = numbers("Direction", "1 0 0 0 1 0 0 0 1"), numbers("Spacing", "1 1 1")
    return world_from_index(direction, spacing, numbers("Origin", "0 0 0"), whole[:, 0], of_cells=of_cells)


@dataclass(frozen=True)
class _Stored:
    """A file: its XML, and the appended data behind it."""

    header: ET.Element
    path: Path
    content: mmap.mmap
    #: Offset of the appended data; `None` without any.
    appended: int | None
    is_base64: bool

    @classmethod
    def of(cls, content: mmap.mmap, path: Path) -> _Stored:
        """Parse a file's XML; appended data are no XML, and the parser is not shown them."""
        at = content.find(b"<AppendedData")
        if at < 0:
            return cls(parsed(content[:]), path, content, None, is_base64=True)
        begin = content.find(b"_", content.find(b">", at))
        header = parsed(content[:at] + b"</VTKFile>")
        return cls(header, path, content, begin + 1, is_base64=b"base64" in content[at:begin])

    def samples(self, array: ET.Element, shape: tuple[int, ...]) -> NDArray[Any]:
        """The numbers of an array."""
        kind = array.get("type", "")
        if kind not in TYPES:
            raise FileError(f"samples of type {kind!r} cannot be drawn; write them as numbers: {self.path}")
        dtype = np.dtype(TYPES[kind]).newbyteorder(self.byte_order)
        form, text = array.get("format", "ascii"), array.text or ""
        if form == "ascii":
            # Each number takes at least a digit and a space.
            size_checks.check_stored(shape, np.dtype("u1"), (len(text) + 1) // 2, self.path)
            return np.array(text.split(), dtype.newbyteorder("=")).reshape(shape)
        if form == "binary":
            encoded = _Encoded("".join(text.split()).encode(), is_base64=True)
        elif self.appended is not None:
            begin = self.appended + int(array.get("offset", "0"))
            encoded = _Encoded(self.content, self.is_base64, begin)
        else:
            raise FileError(f"the appended data are not there; copy or export the file again: {self.path}")
        unpacked = self.unpacked(encoded, shape, dtype)
        return np.frombuffer(unpacked, dtype).reshape(shape).astype(dtype.newbyteorder("="), copy=False)

    @property
    def byte_order(self) -> Literal["big", "little"]:
        return "big" if self.header.get("byte_order") == "BigEndian" else "little"

    def unpacked(self, encoded: _Encoded, shape: tuple[int, ...], dtype: np.dtype[Any]) -> bytes:
        """The bytes of an array."""
        needed = size_checks.n_bytes(shape, dtype)
        width = 8 if self.header.get("header_type") == "UInt64" else 4

        def integers(data: bytes) -> list[int]:
            return [int.from_bytes(data[i : i + width], self.byte_order) for i in range(0, len(data), width)]

        compressor = self.header.get("compressor")
        if compressor is None:
            size_checks.check_stored(shape, dtype, encoded.most_bytes(), self.path)
            data = encoded.take(width + needed)
            if len(data) != width + needed or integers(data[:width]) != [needed]:
                raise ValueError("not as many samples as the extent has")
            return data[width:]
        if compressor not in CODECS:
            raise FileError(f"compressed by {compressor}; write it with zlib, or not compressed: {self.path}")
        unpack, ratio = CODECS[compressor]
        size_checks.check_stored(shape, dtype, encoded.most_bytes(), self.path, ratio=ratio)
        n_blocks, whole, last = integers(_Encoded(encoded.text, encoded.is_base64, encoded.begin).take(3 * width))
        unpacked = [whole] * (n_blocks - 1 if 0 < n_blocks <= needed else 0) + [last or whole]
        if sum(unpacked) != needed:
            raise ValueError("not as many samples as the extent has")
        # The header is encoded on its own, all blocks together.
        packed = integers(encoded.take((3 + n_blocks) * width))[3:]
        ends = np.cumsum([0, *packed])
        data = encoded.take(int(ends[-1]))
        blocks = [unpack(data[a:b], n) for a, b, n in zip(ends[:-1], ends[1:], unpacked, strict=True)]
        if [len(block) for block in blocks] != unpacked:
            raise ValueError("a block that is cut")
        return b"".join(blocks)


def parsed(text: bytes) -> ET.Element:
    """The parsed XML; a document type is refused, since its entities could grow without bound."""
    if b"<!DOCTYPE" in text or b"\0" in text:  # a zero byte: of UTF-16, in which it looks otherwise
        raise ValueError("a document type, which VTK does not write")
    return ET.fromstring(text)  # noqa: S314 - see above


@dataclass
class _Encoded:
    """Bytes as they are, or in base64, taken one after the other; those taken at once have been encoded at once."""

    text: bytes | mmap.mmap
    is_base64: bool
    begin: int = 0

    def most_bytes(self) -> int:
        """Number of bytes that are left, at most."""
        n = len(self.text) - self.begin
        return n * 3 // 4 if self.is_base64 else n

    def take(self, n: int) -> bytes:
        """The next `n` bytes; fewer where the file ends."""
        begin, self.begin = self.begin, self.begin + (-(-n // 3) * 4 if self.is_base64 else n)
        part = self.text[begin : self.begin]
        return base64.b64decode(part)[:n] if self.is_base64 else part
