"""Surfaces in STL, PLY, OBJ, OFF and glTF files, by trimesh, whose counts are checked first.

Files are read from memory, so that none can make a library read others that it names: textures, buffers.
"""

from __future__ import annotations

import io
import json
import re
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wavesplat._geometry.files.read_shape import Asked, ReadShape
from wavesplat._geometry.foreign_shapes import kind_of, points_of, surface_of
from wavesplat._model.volume import units
from wavesplat._storage.size_checks import check_memory
from wavesplat._system.libraries import library
from wavesplat.errors import ArgumentError, FileError

# Checks the counts in the headers of meshes written as text against the lines in the file.
#
# A file whose copy broke off reads as a smaller shape, or as another one, since readers take what comes.
# Formats: PLY (Turk 1994), a line for each element; OFF (Geomview), the same behind the line of counts; STL.

#: Letters of the header of a PLY file, at most.
COUNTED_HEAD_BYTES = 1 << 16
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
    lines = [line.split() for line in head[:COUNTED_HEAD_BYTES].splitlines()]
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


# Surfaces in STL, PLY, OBJ, OFF and glTF files, by trimesh.

SUFFIXES = (".stl", ".ply", ".obj", ".off", ".glb", ".gltf", ".3mf")
#: How 3D Slicer writes that x points to the patient's left, and y to the back.
SPACE = re.compile(rb"SPACE\s*=\s*(LPS|RAS)")
HEAD_BYTES = 1 << 12
#: Bytes of a mesh in memory for each byte of its file, at most as a rule.
BYTES_PER_BYTE = 6
LPS_NOTE = "turned from LPS, as its header says, to RAS"


def read(asked: Asked) -> ReadShape:
    """The surface in a file; all parts of it together."""
    path = asked.file
    check_memory(BYTES_PER_BYTE * path.stat().st_size, path)
    content = path.read_bytes()
    suffix = path.suffix.lower()
    trimesh: Any = library("trimesh", extra="geometry")
    if suffix == ".3mf":  # what trimesh reads it by
        library("lxml", extra="geometry")
        library("networkx", extra="geometry")
    if suffix == ".stl":
        _check_stl(content)
    if suffix == ".gltf":
        _check_gltf(content)
    check_text(content, suffix)
    made = trimesh.load(io.BytesIO(content), file_type=suffix[1:], process=False)
    if isinstance(made, trimesh.Scene):
        parts = [part for part in made.dump() if kind_of(part) == "surface"]
        if not parts:
            raise ValueError("it holds no triangles")
        made = parts[0] if len(parts) == 1 else trimesh.util.concatenate(parts)
    if not len(getattr(made, "faces", ())):
        return _points(made, asked)
    fields = surface_of(made, None)
    if asked.values is not None:
        fields["values"] = _values(made, asked)
        fields.pop("color", None)
    guesses: tuple[str, ...] = ()
    if (space := SPACE.search(content[:HEAD_BYTES])) and space[1] == b"LPS":
        fields["vertices"] = np.asarray(fields["vertices"]) * (-1, -1, 1)
        guesses = (LPS_NOTE,)
    if suffix == ".stl":
        fields |= _merged(fields["vertices"], fields["faces"])
    unit = units.canonical(getattr(made, "units", None)) if suffix == ".3mf" else None
    return ReadShape("surface", fields, unit, guesses)


def _check_stl(content: bytes) -> None:
    """Refuse a binary STL file with fewer bytes than its header promises, or none of its triangles."""
    if content[:6].lower().startswith(b"solid") and b"facet" in content[:HEAD_BYTES].lower():
        return
    promised = int.from_bytes(content[80:84], "little")
    if len(content) < 84 + 50 * promised:
        raise ValueError(f"truncated: its header promises {promised} triangles, and it holds {len(content)} bytes")


def _check_gltf(content: bytes) -> None:
    """Refuse a glTF file whose numbers lie in other files."""
    named = [one.get("uri", "") for one in json.loads(content).get("buffers", [])]
    elsewhere = [name for name in named if name and not name.startswith("data:")]
    if elsewhere:
        raise FileError(f"its numbers lie in other files ({elsewhere[0][:60]!r}); export it as .glb, in one file")


def _points(made: Any, asked: Asked) -> ReadShape:
    """A cloud of points, as PLY files may hold."""
    if not len(getattr(made, "vertices", ())):
        raise ValueError("it holds neither triangles nor points")
    fields = points_of(made, None)
    if asked.values is not None:
        fields["values"] = _values(made, asked)
    return ReadShape("points", fields)


def _values(made: Any, asked: Asked) -> Any:
    """A property of the vertices of a PLY file, by name."""
    raw = (getattr(made, "metadata", None) or {}).get("_ply_raw", {})
    data = raw.get("vertex", {}).get("data", {})
    names = list(getattr(getattr(data, "dtype", None), "names", None) or (data if isinstance(data, dict) else ()))
    if asked.values not in names:
        listed = ", ".join(name for name in names if name not in "xyz") or "none"
        raise ArgumentError(f"the vertices have no values {asked.values!r}; there are: {listed}: {asked.file}")
    return np.asarray(data[asked.values], np.float64).ravel()


def _merged(vertices: Any, faces: Any) -> dict[str, Any]:
    """Vertices and faces of STL, which repeats each vertex in every triangle: one for each place."""
    places: NDArray[Any]
    places, numbers = np.unique(np.asarray(vertices), axis=0, return_inverse=True)
    merged = numbers.ravel()[np.asarray(faces)]
    whole = (merged[:, 0] != merged[:, 1]) & (merged[:, 1] != merged[:, 2]) & (merged[:, 0] != merged[:, 2])
    if not whole.any():
        raise FileError("all its triangles are without area")
    return {"vertices": places, "faces": merged[whole]}
