"""Checks the counts in the headers of meshes written as text against the lines in the file.

A file whose copy broke off reads as a smaller shape, or as another one, since readers take what comes.
Formats: PLY (Turk 1994), a line for each element; OFF (Geomview), the same behind the line of counts; STL.
"""

from __future__ import annotations

import re
from collections.abc import Sequence

#: Letters of the header of a PLY file, at most.
HEAD_BYTES = 1 << 16
#: The first word of an OFF file, and what may stand before OFF in it.
OFF = re.compile(rb"(?:ST|C|N|4|n){0,5}OFF(?![A-Za-z])")


def check_text(content: bytes, suffix: str) -> None:
    """Raise a `ValueError` if a mesh written as text has fewer vertices or faces than it promises."""
    if suffix == ".ply":
        _check_ply(content)
    elif suffix == ".off":
        _check_off(content)
    elif suffix == ".stl" and content[:6].lower().startswith(b"solid"):
        text = content.lower()
        begun, ended = text.count(b"facet normal"), text.count(b"endfacet")
        if begun > ended:
            raise ValueError(f"truncated: {begun} triangles begin, and {ended} end")


def _check_ply(content: bytes) -> None:
    head, ends, body = content.partition(b"end_header")
    lines = [line.split() for line in head[:HEAD_BYTES].splitlines()]
    if not ends or [b"format", b"ascii"] not in [line[:2] for line in lines]:
        return
    names: list[str] = []
    counts: list[int] = []
    #: For each element, whether each of its properties is a list.
    properties: list[list[bool]] = []
    for line in lines:
        if line[:1] == [b"element"] and len(line) == 3 and line[2].isdigit():
            names.append(line[1].decode("latin-1"))
            counts.append(int(line[2]))
            properties.append([])
        elif line[:1] == [b"property"] and properties:
            properties[-1].append(line[1:2] == [b"list"])
    rows = [line for line in body.splitlines()[1:] if line.strip()]
    _check_counts(names, counts, rows)
    if any(counts):
        last = max(number for number, count in enumerate(counts) if count)
        _check_last(rows[sum(counts) - 1], properties[last], names[last])


def _check_off(content: bytes) -> None:
    lines = [line.split(b"#")[0].strip() for line in content.splitlines()]
    rows = [line for line in lines if line]
    if not rows or (found := OFF.match(rows[0])) is None:
        return
    rest = rows[0][found.end() :].split()
    words, rows = (rest, rows[1:]) if rest else (rows[1].split() if len(rows) > 1 else [], rows[2:])
    if len(words) < 2 or not all(word.isdigit() for word in words[:2]):
        return
    counts = [int(word) for word in words[:2]]
    _check_counts(["vertex", "face"], counts, rows)
    if counts[1]:
        _check_last(rows[sum(counts) - 1], [True], "face")


def _check_counts(names: Sequence[str], counts: Sequence[int], rows: Sequence[bytes]) -> None:
    if sum(counts) > len(rows):
        promised = " and ".join(f"{count} of {name}" for name, count in zip(names, counts, strict=True) if count)
        raise ValueError(f"truncated: its header promises {promised}, a line each, and it holds {len(rows)} lines")


def _check_last(row: bytes, are_lists: Sequence[bool], name: str) -> None:
    """Raise a `ValueError` if the last line of the file is incomplete."""
    words, at = row.split(), 0
    for is_list in are_lists:
        length = int(words[at]) if is_list and at < len(words) and words[at].isdigit() else 0
        at += 1 + length
    if len(words) < at:
        raise ValueError(f"truncated: its last line, of {name}, has {len(words)} numbers, not the {at} of it")
