"""VTK's legacy images (.vtk, STRUCTURED_POINTS): one array of points or cells, as text or big-endian bytes.

No library but VTK itself reads all of them, and it is large: ITK does not know `signed_char`, `vtkIdType` and `bit`,
fields and cells.
Format: "VTK file formats", https://docs.vtk.org/en/latest/vtk_file_formats/vtk_legacy_file_format.html.
The file says nothing of a patient: its axes are kept as they are.
"""

from __future__ import annotations

import mmap
import re
from dataclasses import dataclass, field, replace
from functools import partial
from pathlib import Path
from typing import Any
from urllib.parse import unquote

import numpy as np
from numpy.typing import NDArray

from wavesplat._model.volume.facts import Facts
from wavesplat._readers.components import (
    chosen_component,
    component_of,
    facts_of_colors,
    length_along,
    quantity_of_array,
    type_of_length,
)
from wavesplat._readers.file_contents import MAX_BYTES, Contents, FileArray, ranges_of
from wavesplat._readers.levels import Levels, OneVolume, stored_samples
from wavesplat._readers.request import Grid, Request
from wavesplat._readers.vtk.arrays import chosen, image_facts, other_grid, world_from_index
from wavesplat._storage import size_checks
from wavesplat._storage.reading import mapped, reading
from wavesplat.errors import FileError

#: The format's names of a type -> NumPy's. Bits are eight to a byte. Identifiers are written as 32-bit integers.
TYPES = {
    "bit": "?",
    "char": "i1",
    "signed_char": "i1",
    "unsigned_char": "u1",
    "short": "i2",
    "unsigned_short": "u2",
    "int": "i4",
    "unsigned_int": "u4",
    "long": "i8",
    "unsigned_long": "u8",
    "long_long": "i8",
    "unsigned_long_long": "u8",
    "vtkidtype": "i4",
    "float": "f4",
    "double": "f8",
    **{f"vtktype{sign}int{8 * n}": f"{sign or 'i'}{n}" for sign in ("", "u") for n in (1, 2, 4, 8)},
}
#: Types of eight bytes that have four where they were written on Windows.
OF_TWO_WIDTHS = ("long", "unsigned_long")
#: Attributes with a fixed number of components -> that number.
COMPONENTS = {"VECTORS": 3, "NORMALS": 3, "TENSORS": 9, "TENSORS6": 6, "GLOBAL_IDS": 1, "PEDIGREE_IDS": 1}
#: The version in the first line, and the first one whose cells have offsets. VTK ends the process at longer numbers.
VERSION, FIRST_WITH_OFFSETS = re.compile(rb"Version\s+(\d{1,3})\.\d{1,3}(?!\d)", re.IGNORECASE), 5
BLOCK_BYTES = 1 << 20
MAX_LINE_BYTES = 1 << 16
#: Bytes of a line that VTK reads; it never comes back from a longer one.
MAX_VTK_LINE_BYTES = 255
WORD = re.compile(rb"\S+")
IS_SPACE = np.isin(np.arange(256), list(b" \t\n\r\v\f"))
#: Words that begin cells: of a grid, and of the four kinds of a PolyData.
CELLS = ("CELLS", "VERTICES", "LINES", "POLYGONS", "TRIANGLE_STRIPS")
#: Bytes behind the line CELLS in which the word OFFSETS is looked for.
BEHIND_CELLS = 64


@dataclass(frozen=True)
class LegacyArray:
    """An array of points or cells in a file, and the offset of its numbers."""

    name: str
    of_cells: bool
    dtype: np.dtype[Any]
    n_components: int
    n_tuples: int
    begin: int
    #: Whether the numbers are text, bits, or (`is_color`) colours: as text these go from 0 to 1, and stand for bytes.
    is_text: bool
    is_bits: bool
    #: Whether it is one of VTK's scalars, which are drawn by default.
    is_scalars: bool = False
    is_color: bool = False


@dataclass
class _Image:
    """Size, place and arrays of the image in a file."""

    size: NDArray[np.int64] = field(default_factory=lambda: np.zeros(3, np.int64))
    first: NDArray[np.int64] = field(default_factory=lambda: np.zeros(3, np.int64))
    spacing: list[float] = field(default_factory=lambda: [1.0] * 3)
    origin: list[float] = field(default_factory=lambda: [0.0] * 3)
    arrays: list[LegacyArray] = field(default_factory=list)

    def size_of(self, array: LegacyArray) -> tuple[int, int, int]:
        """Samples of an array along x, y, z. A layer of points counts as one of cells."""
        nx, ny, nz = (max(int(n) - 1, 1) if array.of_cells else int(n) for n in self.size)
        return nx, ny, nz


def levels(request: Request) -> Levels | Grid:
    """The volume in a legacy VTK file: its scalars, or the array that `dataset` names."""
    path = request.file
    with mapped(path) as content:
        image = _Parser(content, path).image()
        array, matrix, guessed = _picked(image, request)
        n, dtype = array.n_components, np.dtype(array.dtype)
        shape = (*image.size_of(array)[::-1], n)
        number, guesses = chosen_component(n, dtype, request, array.name)
        colors = facts_of_colors(n, dtype, request)
        facts = Facts(quantity=quantity_of_array(array.name, n, dtype, request), guesses=guessed + guesses, **colors)
        if not (array.is_text or array.is_bits):
            volume = OneVolume((0, 1, 2), [None, None, None, number], dtype, dtype)
            if number is None:
                length = partial(length_along, axis=-1)
                volume = replace(
                    volume, picked=[None, None, None, slice(0, n)], made=type_of_length(dtype), convert=length
                )
            return Levels([stored_samples(path, array.begin, shape, volume)], [matrix], facts)
        if request.memory is not None:
            written = "text" if array.is_text else "bits"
            raise FileError(f"the samples are written as {written}; open the file without memory=: {request.safe_path}")
        # Not a view: the file is closed.
        numbers = _numbers(content, array, path).reshape(shape)
        return Grid(np.array(component_of(numbers, request, array.name)[0]), matrix, facts)


def contents(request: Request) -> Contents:
    """All arrays of the file."""
    path = request.file
    with reading("a VTK image", path), mapped(path) as content:
        image = _Parser(content, path).image()
        corners = world_from_index(np.eye(3), image.spacing, image.origin, image.first, of_cells=False)
        looks = len(content) <= MAX_BYTES
        found = [
            FileArray(
                array.name,
                str(array.dtype.newbyteorder("=")),
                image.size_of(array)[::-1],
                array.n_components,
                "cells" if array.of_cells else "points",
                _ranges(content, array, path) if looks else (),
            )
            for array in image.arrays
        ]
        return Contents(tuple(found), image_facts("STRUCTURED_POINTS", image.size.tolist(), corners))


def _ranges(content: mmap.mmap, array: LegacyArray, path: Path) -> tuple[tuple[float, float] | None, ...]:
    return ranges_of(_numbers(content, array, path).reshape(-1, array.n_components), has_components=True)


def check_whole(path: Path) -> None:
    """Raise an error unless all numbers that a grid of any kind promises are in its file: VTK does not look."""
    with mapped(path) as content:
        _Parser(content, path).pass_over()


def _picked(image: _Image, request: Request) -> tuple[LegacyArray, NDArray[np.float64], tuple[str, ...]]:
    names, sizes = [array.name for array in image.arrays], [array.n_components for array in image.arrays]
    number, guessed = chosen(names, [one.name for one in image.arrays if one.is_scalars], sizes, request)
    array = image.arrays[number]
    nx, ny, nz = image.size_of(array)
    if array.n_tuples != nx * ny * nz:
        raise FileError(
            f"a wrong header: {array.name!r} has {array.n_tuples} samples, and the image {nx} x {ny} x {nz}; "
            f"write it again: {request.path}"
        )
    matrix = world_from_index(np.eye(3), image.spacing, image.origin, image.first, of_cells=array.of_cells)
    return array, matrix, guessed


def _numbers(content: mmap.mmap, array: LegacyArray, path: Path) -> NDArray[Any]:
    """All numbers of an array."""
    n = array.n_tuples * array.n_components
    size_checks.check_memory(size_checks.n_bytes([n], array.dtype), path)
    if not array.is_text:
        if array.is_bits:
            return np.unpackbits(np.frombuffer(content, np.uint8, -(-n // 8), array.begin), count=n)
        return np.frombuffer(content, array.dtype, n, array.begin).astype(array.dtype.newbyteorder("="))
    numbers = _numbers_of_text(content, array.begin, n, np.dtype("f8") if array.is_color else array.dtype)
    return (numbers * 255 + 0.5).astype(np.uint8) if array.is_color else numbers


def _numbers_of_text(content: mmap.mmap, begin: int, n: int, dtype: np.dtype[Any]) -> NDArray[Any]:
    """`n` numbers of text from byte `begin` on, which the parser has found to be there."""
    numbers = np.empty(n, dtype.newbyteorder("="))
    at, n_read = begin, 0
    while n_read < n:
        if at >= len(content):
            raise FileError("the file was changed while it was read; open it again")
        end = at + BLOCK_BYTES
        if rest := WORD.match(content, end):  # the block ends in a word
            end = rest.end()
        words = content[at:end].split()[: n - n_read]
        numbers[n_read : n_read + len(words)] = np.array(words).astype(numbers.dtype)
        at, n_read = end, n_read + len(words)
    return numbers


def _end_of_words(content: mmap.mmap, begin: int, n: int, path: Path) -> int:
    """Offset of the byte behind `n` words of text."""
    at, count, was_space = begin, 0, True
    while count < n and at < len(content):
        block = np.frombuffer(content[at : at + BLOCK_BYTES], np.uint8)
        is_word = ~IS_SPACE[block]
        starts = np.flatnonzero(is_word & np.append(was_space, ~is_word[:-1]))
        if count + len(starts) >= n:
            last = WORD.match(content, at + int(starts[n - count - 1]))
            return last.end() if last else len(content)
        at, count, was_space = at + len(block), count + len(starts), not is_word[-1]
    if count < n:
        raise FileError(f"truncated: {n} samples are promised, {count} are there; copy it again: {path}")
    return at


class _Parser:
    """A parser of a file's lines, one after the other; numbers of arrays are passed over."""

    def __init__(self, content: mmap.mmap, path: Path) -> None:
        self._content, self._path, self._at = content, path, 0
        self._is_text = False
        #: Whether VTK reads the file after this check.
        self._checks_words = False
        self._version: int | None = None
        self._image = _Image()
        self._of_cells: bool | None = None
        self._n_tuples = 0

    def _begin(self) -> None:
        """Pass over the first lines, which say whether the numbers are text."""
        first = self._line()
        version = VERSION.search(first)
        self._version = int(version[1]) if version else None
        if not first.lower().startswith(b"# vtk datafile"):
            raise ValueError("no first line of a VTK file")
        self._at = self._end_of_line()  # the title, which may be empty
        form = self._words()[0]
        if form not in ("ASCII", "BINARY"):
            raise ValueError(f"neither ASCII nor BINARY, but {form[:20]}")
        self._is_text = form == "ASCII"

    def pass_over(self) -> None:
        """Pass over all numbers of a grid of any kind; numbers as text are parsed, since VTK ends at other words."""
        self._checks_words = True
        self._begin()
        if self._version is None:
            raise ValueError("a first line without a version")
        while words := self._words():
            key, rest = words[0], words[1:]
            if key in ("X_COORDINATES", "Y_COORDINATES", "Z_COORDINATES"):
                self._skip(rest[1], int(rest[0]), described=key)
            elif key == "POINTS":
                self._skip(rest[1], 3 * int(rest[0]), described=key)
            elif key == "CELL_TYPES":
                self._skip("int", int(rest[0]), described=key)
            elif key in CELLS:
                self._pass_over_cells(int(rest[0]), int(rest[1]))
            elif key != "DATASET" and not self._take_place(key, rest):
                self._take(key, rest)

    def _pass_over_cells(self, n: int, n_numbers: int) -> None:
        """Pass over cells: their points, counted before each, or since version 5.1 two arrays."""
        # Not a line: the numbers of cells in bytes need not hold the end of one.
        has_offsets = self._content[self._at : self._at + BEHIND_CELLS].upper().split()[:1] == [b"OFFSETS"]
        if has_offsets != ((self._version or 0) >= FIRST_WITH_OFFSETS):
            raise ValueError("cells of another version than the file's")
        if not has_offsets:
            self._skip("int", n_numbers, described="CELLS")
            return
        for count in (n, n_numbers):
            kind = self._words()[1]
            self._skip(kind, count, described="CELLS")

    def image(self) -> _Image:
        """Size, place and arrays; a `FileError` for other data than an image."""
        self._begin()
        has_image = False
        while words := self._words():
            if words[0] == "DATASET":
                has_image = True
                if words[1].upper() != "STRUCTURED_POINTS":
                    raise other_grid(words[1].upper(), self._path)
            elif not self._take_place(words[0], words[1:]):
                self._take(words[0], words[1:])
        if not has_image:
            raise FileError(f"the file holds no DATASET, so no image; write one as STRUCTURED_POINTS: {self._path}")
        if not (self._image.size > 0).all():
            raise ValueError(f"dimensions of {' '.join(map(str, self._image.size))}")
        return self._image

    def _take_place(self, key: str, rest: list[str]) -> bool:
        """Take size or place of the image from a line; return whether it states one of them."""
        image = self._image
        if key == "DIMENSIONS":
            image.size = np.array(rest[:3], np.int64)
        elif key == "EXTENT":
            extent = np.array(rest[:6], np.int64).reshape(3, 2)
            image.first, image.size = extent[:, 0], extent[:, 1] - extent[:, 0] + 1
        elif key in ("SPACING", "ASPECT_RATIO"):
            image.spacing = [float(number) for number in rest[:3]]
        elif key == "ORIGIN":
            image.origin = [float(number) for number in rest[:3]]
        else:
            return False
        return True

    def _take(self, key: str, rest: list[str]) -> None:
        """Take a line that begins with a keyword, and the data that belong to it."""
        if key in ("POINT_DATA", "CELL_DATA"):
            self._of_cells, self._n_tuples = key == "CELL_DATA", int(rest[0])
        elif key == "METADATA":
            self._skip_to_empty_line()
        elif key == "FIELD":
            self._take_field(int(rest[1]))
        elif key == "SCALARS":
            if len(line := self._words(peek=True)) == 2 and line[0] == "LOOKUP_TABLE":
                self._words()
            self._add(rest[0], rest[1], int(rest[2]) if len(rest) > 2 else 1, self._n_tuples, is_scalars=True)
        elif key == "COLOR_SCALARS":
            self._add(rest[0], "unsigned_char", int(rest[1]), self._n_tuples, is_scalars=True, is_color=True)
        elif key == "LOOKUP_TABLE":
            self._skip("float" if self._is_text else "unsigned_char", 4 * int(rest[1]))
        elif key in COMPONENTS or key == "TEXTURE_COORDINATES":
            n_components = COMPONENTS.get(key) or int(rest[1])
            self._add(rest[0], rest[-1], n_components, self._n_tuples)
        else:
            raise ValueError(f"the word {key[:40]!r} where VTK has none")

    def _take_field(self, n_arrays: int) -> None:
        """Take the arrays of a field, each of which states its length."""
        for _ in range(n_arrays):
            if self._words(peek=True)[:1] == ["METADATA"]:
                self._line()
                self._skip_to_empty_line()
            words = self._line().decode("latin-1").split()
            name, n_components, n_tuples, kind = words[-4:]
            self._add(name, kind, int(n_components), int(n_tuples))

    def _add(self, name: str, kind: str, n_components: int, n_tuples: int, **scalars: bool) -> None:
        """Add an array whose numbers begin here; one that is not of points or cells is only passed over.

        scalars : `is_scalars` and `is_color` of `LegacyArray`.
        """
        if kind.lower() == "string":
            self._skip_strings(n_components * n_tuples)
            return
        begin = self._at
        dtype = self._skip(kind, n_components * n_tuples, described=f"array {unquote(name)!r}")
        if self._of_cells is not None:
            is_bits = kind.lower() == "bit"
            array = LegacyArray(
                unquote(name),
                self._of_cells,
                np.dtype("u1") if is_bits else dtype,
                n_components,
                n_tuples,
                begin,
                self._is_text,
                is_bits,
                **scalars,
            )
            self._image.arrays.append(array)

    def _skip(self, kind: str, n: int, described: str = "look-up table") -> np.dtype[Any]:
        """Pass over `n` numbers; return their type."""
        name = kind.lower()
        if name not in TYPES:
            raise FileError(
                f"samples of type {kind!r} cannot be drawn; write them as numbers ({described}): {self._path}"
            )
        if n < 0:
            raise ValueError(f"{described} of {n} numbers")
        dtype, stored = np.dtype(TYPES[name]), len(self._content) - self._at
        if self._is_text:
            # As text identifiers are as wide as they need.
            dtype = np.dtype("i8") if name == "vtkidtype" else dtype
            # Each number takes at least a digit and a space.
            size_checks.check_stored([n], np.dtype("u1"), (stored + 1) // 2, self._path, held=[0])
            begin, self._at = self._at, _end_of_words(self._content, self._at, n, self._path)
            if self._checks_words:
                _numbers_of_text(self._content, begin, n, np.dtype("f8"))
                if self._content.find(b"_", begin, self._at) >= 0:  # Python reads 1_000
                    raise ValueError(f"a word that is no number ({described})")
            return dtype
        if name in OF_TWO_WIDTHS and 4 * n <= stored < 8 * n:
            dtype = np.dtype(dtype.kind + "4")
        n_bytes = -(-n // 8) if name == "bit" else n * dtype.itemsize
        size_checks.check_stored([n_bytes], np.dtype("u1"), stored, self._path, held=[0])
        self._at += n_bytes
        return dtype.newbyteorder(">")

    def _skip_strings(self, n: int) -> None:
        """Pass over texts: a line each, or each behind its length, whose first two bits say how wide it is."""
        for _ in range(n):
            if self._at >= len(self._content):
                raise FileError(f"truncated: {n} texts are promised, and fewer are there; copy it again: {self._path}")
            if self._is_text:
                self._at = self._end_of_line()
                continue
            width = (8, 4, 2, 1)[self._content[self._at] >> 6]
            length = int.from_bytes(self._content[self._at : self._at + width], "big")
            self._at += width + (length & ((1 << (8 * width - 2)) - 1))

    def _skip_to_empty_line(self) -> None:
        while self._at < len(self._content) and self._content[self._at : self._end_of_line()].strip():
            begin, self._at = self._at, self._end_of_line()
            self._check_length(begin)

    def _check_length(self, begin: int) -> None:
        """Raise a `ValueError` if VTK, which reads the file next, never comes back from the line that begins there."""
        if self._checks_words and self._at - begin > MAX_VTK_LINE_BYTES:
            raise ValueError(f"a line of more than {MAX_VTK_LINE_BYTES} letters")

    def _end_of_line(self) -> int:
        found = self._content.find(b"\n", self._at, self._at + MAX_LINE_BYTES)
        return min(found + 1 if found >= 0 else self._at + MAX_LINE_BYTES, len(self._content))

    def _line(self) -> bytes:
        """The next line that is not empty; empty at the end of the file."""
        while self._at < len(self._content):
            begin, self._at = self._at, self._end_of_line()
            self._check_length(begin)
            if line := self._content[begin : self._at].strip():
                return line
        return b""

    def _words(self, *, peek: bool = False) -> list[str]:
        """Words of the next line that is not empty, the first of them in capitals."""
        before = self._at
        words = self._line().decode("latin-1").split()
        self._at = before if peek else self._at
        return [words[0].upper(), *words[1:]] if words else []
