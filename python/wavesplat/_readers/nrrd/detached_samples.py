"""Data files that hold the samples of an NRRD or MetaImage header.

They are found before ITK runs, which opens any file that a header names. Both headers are read byte by byte as ITK's
own parsers do, and anything that they could take for something else is refused.
"""

from __future__ import annotations

import os
import re
from pathlib import Path

from wavesplat._storage.paths import check_named_file
from wavesplat.errors import FileError

#: Longest header that is read, in bytes: real ones are shorter, and patterns would be slow to find in longer ones.
MAX_HEADER_BYTES = 1 << 24
#: Files that a header may name, at most: no series has as many.
MAX_FILES = 1 << 16

#: Longest field of an NRRD header, longest path of one, and largest number of dimensions of a MetaImage: half of ITK's
#: buffers, two thirds of the shortest path with which it crashed, and the size of its arrays.
MAX_FIELD_BYTES, MAX_PATH_BYTES, MAX_DIMENSIONS = 500, 1000, 10

N_DIMENSIONS = re.compile(rb"(?:\A|\n)[ \t]*NDims[ \t]*[=:][ \t]*(\d{1,2})[ \t\r]*(?:\n|\Z)")
META_IMAGE = re.compile(rb"(?:\A|\n)[ \t]*ElementDataFile[ \t]*[=:]([^\n]*)(?:\n|\Z)")
#: The field "data file"; `key:=value` is no field, even if the key has the name of one.
NRRD = re.compile(rb"(?:\A|\n)[ \t]*data ?file[ \t]*:(?!=)([^\n]*)", re.IGNORECASE)
#: The end of a header that is followed by samples.
EMPTY_LINE = re.compile(rb"\r?\n\r?\n")
#: The only conversion that a pattern of numbered files needs.
NUMBER = re.compile(r"%0?\d{0,3}d")


def places_of_samples(path: Path, *, anywhere: bool, within: Path | None = None) -> list[tuple[Path, int]]:
    """The files that hold the samples, each with the bytes before them; files in other folders are refused."""
    with path.open("rb") as file:
        start = file.read(MAX_HEADER_BYTES)
    is_nrrd = start.startswith(b"NRRD")
    names = _named_by_nrrd(start, path) if is_nrrd else _named_by_meta_image(start, path)
    (_check_nrrd if is_nrrd else _check_meta_image)(start, path)
    for name in names:
        check_named_file(name, path, anywhere=anywhere, within=within)
    header = _header_of_nrrd(start) if is_nrrd else _header_of_meta_image(start)
    return [(path.parent / name, 0) for name in names] or [(path, len(header or b""))]


def _check_nrrd(start: bytes, path: Path) -> None:
    """Raise a `FileError` for a field or a path that is so long that a message of it would overwrite memory in ITK.

    Its parser writes the lines that it does not understand into buffers of some 1024 bytes, and ends the process.
    """
    if len(os.fsencode(path.absolute())) > MAX_PATH_BYTES:
        raise FileError(f"the path is longer than {MAX_PATH_BYTES} bytes, which ITK cannot hold; move the file: {path}")
    header = _header_of_nrrd(start)
    if len(header) == MAX_HEADER_BYTES:
        raise FileError(f"the header has no end in {MAX_HEADER_BYTES >> 20} MiB; copy or export it again: {path}")
    for line in header.split(b"\n"):
        name, _, value = line.partition(b":")
        is_text = line.startswith(b"#") or value.startswith(b"=") or name.strip().lower() == b"content"
        if len(line) > MAX_FIELD_BYTES and not is_text:
            raise FileError(
                f"a wrong header: its line {line[:30].decode('latin-1')!r}... has {len(line)} bytes, and fields have "
                f"{MAX_FIELD_BYTES} at most; mend it, or export the file again: {path}"
            )


def _check_meta_image(start: bytes, path: Path) -> None:
    """Raise a `FileError` for a number of dimensions that ITK has no room for: it would write beyond its arrays."""
    header = _header_of_meta_image(start) or start
    found = N_DIMENSIONS.search(header)
    if header.count(b"NDims") != 1 or not found or not 1 <= int(found[1]) <= MAX_DIMENSIONS:
        raise FileError(
            f"a wrong header: its line NDims must be there once, and give 1 to {MAX_DIMENSIONS} dimensions; "
            f"mend it, or export the file again: {path}"
        )


def _header_of_meta_image(start: bytes) -> bytes | None:
    """The header, to the end of the line that says where the samples are; None where there is none."""
    found = META_IMAGE.search(start)
    # Any other place of this word could be taken for the key, or hide it.
    return start[: found.end()] if found and start.count(b"ElementDataFile", 0, found.end()) == 1 else None


def _header_of_nrrd(start: bytes) -> bytes:
    """The header, with the empty line at its end."""
    end = EMPTY_LINE.search(start)
    return start[: end.end()] if end else start


def _named_by_meta_image(start: bytes, path: Path) -> list[str]:
    header = _header_of_meta_image(start)
    found = META_IMAGE.search(header or b"")
    if header is None or found is None:
        raise FileError(f"the header does not say where the samples are; mend its line ElementDataFile: {path}")
    value = _text(found[1])
    if value.upper() == "LOCAL":
        return []
    if value.upper().startswith("LIST"):
        return _lines(start[len(header) :])
    return _numbered(value, path) if "%" in value and not _is_name(value, path) else [value]


def _named_by_nrrd(start: bytes, path: Path) -> list[str]:
    header = _header_of_nrrd(start)
    if b"\r" in header.replace(b"\r\n", b""):
        raise FileError(f"the header has line ends in the middle of lines; write it again: {path}")
    found = NRRD.findall(header)
    if len(found) > 1:
        raise FileError(f"the header says twice where the samples are; mend its line 'data file': {path}")
    if not found:
        return []
    value = _text(found[0])
    if value.upper().startswith("LIST"):
        place = NRRD.search(header)
        return _lines(start[place.end() :]) if place else []
    return _numbered(value, path) if "%" in value and not _is_name(value, path) else [value]


def _lines(names: bytes) -> list[str]:
    lines = [_text(line) for line in names.split(b"\n", MAX_FILES)]
    return [line for line in lines if line]


def _is_name(value: str, path: Path) -> bool:
    """Whether a value is the name of an existing file, which may have a percent sign in it, and no pattern of names."""
    try:
        return (path.parent / value).is_file()
    except (OSError, ValueError):
        return False


def _numbered(value: str, path: Path) -> list[str]:
    """File names of a pattern that is followed by first number, last number and step, "slice%03d.raw 1 20 1"."""
    pattern, *numbers = value.split()
    if not numbers:
        raise FileError(
            f"the header names a data file that is not there, {value!r}; programs that use ITK write slices under "
            f"other names, or over each other, where a name has a percent sign: save under another one: {path}"
        )
    try:
        first, last, step = (int(number) for number in [*numbers, "1"][:3])
        span = range(first, last + (1 if step > 0 else -1), step)
    except ValueError:
        span = range(0)
    conversions = NUMBER.findall(pattern)
    if len(conversions) != 1 or pattern.count("%") != 1 or not 0 < len(span) <= MAX_FILES:
        raise FileError(
            f"the header names files as {value!r}; write a pattern with one number, its first, last and step, "
            f"as in 'slice%03d.raw 1 20 1': {path}"
        )
    return [NUMBER.sub(conversions[0] % number, pattern) for number in span]


def _text(line: bytes) -> str:
    return line.decode("utf-8", "surrogateescape").strip()
