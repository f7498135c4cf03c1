"""NRRD files that ITK cannot read as they are, and the header that it is given instead.

An axis of time, or of an unnamed kind, beside three whose place in space is given: ITK takes it for one of space, and
refuses the file, or takes the wrong one for time. ITK takes an axis of kind "list" for the components of a sample,
wherever it stands; so it is handed a header that names this kind. Samples packed by bzip2: ITK is built without it;
they are unpacked into a temporary file. A list of files whose last line has no end: ITK leaves that file out.
A name with a percent sign: ITK takes it for a pattern of names.

Format: https://teem.sourceforge.net/nrrd/format.html.
"""

from __future__ import annotations

import bz2
import os
import re
import tempfile
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from math import prod
from pathlib import Path
from typing import BinaryIO

import numpy as np

from wavesplat._readers.nrrd.detached_samples import MAX_HEADER_BYTES
from wavesplat._storage import size_checks
from wavesplat.errors import FileError

BLOCK_BYTES = 1 << 20
#: Fields that give the place of the samples.
PLACE_FIELDS = ("data file", "line skip", "byte skip")
#: Short names of spaces with a time axis.
WITH_TIME = {"rast", "last", "lpst"}
#: Kinds of axes that say nothing.
UNKNOWN = ("???", "none")
#: The format's names of a type, without blanks -> NumPy's.
TYPES = {
    **dict.fromkeys(("signedchar", "int8", "int8_t"), "i1"),
    **dict.fromkeys(("uchar", "unsignedchar", "uint8", "uint8_t"), "u1"),
    **dict.fromkeys(("short", "shortint", "signedshort", "signedshortint", "int16", "int16_t"), "i2"),
    **dict.fromkeys(("ushort", "unsignedshort", "unsignedshortint", "uint16", "uint16_t"), "u2"),
    **dict.fromkeys(("int", "signedint", "int32", "int32_t"), "i4"),
    **dict.fromkeys(("uint", "unsignedint", "uint32", "uint32_t"), "u4"),
    **dict.fromkeys(("longlong", "longlongint", "signedlonglong", "signedlonglongint", "int64", "int64_t"), "i8"),
    **dict.fromkeys(("ulonglong", "unsignedlonglong", "unsignedlonglongint", "uint64", "uint64_t"), "u8"),
    "float": "f4",
    "double": "f8",
}


@dataclass(frozen=True)
class ListedAxis:
    """An axis beside three of space: its place, the fastest first, its size, and whether the file names its kind."""

    number: int
    size: int
    is_known: bool


def listed_axis(fields: dict[str, str]) -> ListedAxis | None:
    """The one of four axes that is not one of space: of kind time or list, or without a kind and a direction.

    A space such as RAS-time has times as its fourth axis, and ITK does as well.
    """
    sizes, kinds = fields.get("sizes", "").split(), fields.get("kinds", "").lower().split()
    if len(sizes) != 4 or is_space_with_time(fields):
        return None
    for kind in ("time", "list"):
        if len(kinds) == 4 and kinds.count(kind) == 1:
            return ListedAxis(kinds.index(kind), int(sizes[kinds.index(kind)]), is_known=True)
    # Vectors are "(1,0,0)", also with blanks in them.
    directions = re.findall(r"\([^()]*\)|none", fields.get("space directions", "").lower())
    if len(directions) != 4 or directions.count("none") != 1:
        return None
    number = directions.index("none")
    if len(kinds) == 4 and kinds[number] not in UNKNOWN:
        return None
    return ListedAxis(number, int(sizes[number]), is_known=False)


def is_space_with_time(fields: dict[str, str]) -> bool:
    """Whether the space of a file has a time axis, as "right-anterior-superior-time", or "RAST", has."""
    space = fields.get("space", "").lower()
    return space.endswith("-time") or space in WITH_TIME


def is_bzip2(fields: dict[str, str]) -> bool:
    """Whether the samples are packed by bzip2."""
    return fields.get("encoding", "").lower() in ("bzip2", "bz2")


@contextmanager
def header_for_itk(path: Path, fields: dict[str, str], places: Sequence[tuple[Path, int]]) -> Iterator[Path]:
    """The file for ITK: itself, or another header, for as long as it is read.

    places : the files that hold the samples, each with the bytes before them.
    """
    axis = listed_axis(fields)
    kinds = fields.get("kinds", "").lower().split()
    is_listed = axis is None or kinds[axis.number : axis.number + 1] == ["list"]
    if is_listed and not (is_bzip2(fields) or _is_cut_list(path, fields) or _has_percent(fields, places)):
        yield path
        return
    fields = dict(fields)
    if axis is not None:
        kinds = kinds if len(kinds) == 4 else ["domain"] * 4
        kinds[axis.number] = "list"
        fields["kinds"] = " ".join(kinds)
    with tempfile.TemporaryDirectory() as made:
        if is_bzip2(fields):
            samples = Path(made) / "samples.raw"
            _unpack(path, fields, places, samples)
            place = [b"data file: samples.raw"]
            fields["encoding"] = "raw"
        else:
            place = _places_of(fields, places)
        # The format wants the place of the samples last, since a list of files has no end.
        lines = [f"{name}: {value}".encode("latin-1") for name, value in fields.items() if name not in PLACE_FIELDS]
        header = Path(made) / "header.nhdr"
        header.write_bytes(b"\n".join([b"NRRD0005", *lines, *place, b""]))
        yield header


def _is_cut_list(path: Path, fields: dict[str, str]) -> bool:
    """Whether a list of files ends without a line end: ITK would leave out the last of them."""
    if not fields.get("data file", "").upper().startswith("LIST"):
        return False
    with path.open("rb") as file:
        file.seek(-1, os.SEEK_END)
        return file.read(1) != b"\n"


def _has_percent(fields: dict[str, str], places: Sequence[tuple[Path, int]]) -> bool:
    """Whether the one file that holds the samples has a percent sign in its name: ITK takes that for a pattern."""
    named = fields.get("data file", "")
    return "%" in named and len(places) == 1 and places[0][0].name == Path(named).name


def _places_of(fields: dict[str, str], places: Sequence[tuple[Path, int]]) -> list[bytes]:
    """Fields of places for a header in another folder: the same files, by absolute paths."""
    line_skip = int(fields.get("line skip", 0))
    named = fields.get("data file")
    if named is None:  # the samples follow the header, whose lines are skipped as well
        with places[0][0].open("rb") as file:
            line_skip += file.read(places[0][1]).count(b"\n")
    skips = [f"line skip: {max(line_skip, 0)}".encode(), f"byte skip: {fields.get('byte skip', 0)}".encode()]
    files = [os.fsencode(file.absolute()) for file, _ in places]
    if len(files) == 1 and b"%" not in files[0]:
        return [*skips, b"data file: " + files[0]]
    if len(files) == 1:
        # In a list names are no patterns. It holds all axes.
        n_axes = [str(len(fields["sizes"].split()))]
    else:
        # How many axes a file holds stands behind the word LIST, or behind first, last and step of a pattern.
        words = (named or "").split()
        n_axes = words[1:2] if words[0].upper() == "LIST" else words[4:5]
    return [*skips, " ".join(["data file: LIST", *n_axes]).encode(), *files]


def _unpack(path: Path, fields: dict[str, str], places: Sequence[tuple[Path, int]], target: Path) -> None:
    """Write the samples of all files into one, without what is skipped in each: lines, and bytes once unpacked."""
    name = "".join(fields.get("type", "").lower().split())
    if name not in TYPES:
        raise FileError(f"samples of type {fields.get('type', 'unknown')!r} cannot be drawn; write numbers: {path}")
    shape = [int(n) for n in fields.get("sizes", "").split()]
    stored = sum(max(file.stat().st_size - offset, 0) for file, offset in places)
    size_checks.check_stored(shape, np.dtype(TYPES[name]), stored, path, ratio=size_checks.ANY_RATIO)
    line_skip = int(fields.get("line skip", 0))
    byte_skip = int(fields.get("byte skip", 0))
    if byte_skip < 0:
        raise FileError(f"a byte skip of {byte_skip} beside encoding bzip2; write how many bytes to skip: {path}")
    needed = prod(shape) * np.dtype(TYPES[name]).itemsize // max(len(places), 1)
    with target.open("wb") as out:
        for file, offset in places:
            with file.open("rb") as packed:
                packed.seek(offset)
                skip_lines(packed, line_skip)
                n_written = _unpack_stream(packed, out, byte_skip, needed)
            if n_written < needed:
                raise FileError(
                    f"truncated, or a wrong header: the samples need {needed} bytes of {file.name}, {n_written} are "
                    f"packed; copy or export it again: {path}"
                )


def _unpack_stream(packed: BinaryIO, out: BinaryIO, skipped: int, needed: int) -> int:
    """Unpack `needed` bytes behind `skipped` ones, to the stream's end, for its checksum; return their number."""
    n_written = 0
    with bz2.open(packed) as stream:
        while block := stream.read(BLOCK_BYTES):
            part = block[skipped:]
            skipped -= len(block) - len(part)
            n_written += out.write(part[: needed - n_written])
    return n_written


def skip_lines(file: BinaryIO, n: int) -> None:
    """Read past `n` lines."""
    for _ in range(n):
        if not file.readline(MAX_HEADER_BYTES):
            return
