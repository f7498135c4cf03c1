"""Surfaces in STL, PLY, OBJ, OFF and glTF files, by trimesh.

Files are read from memory, so that none can make a library read others that it names: textures, buffers.
"""

from __future__ import annotations

import io
import json
import re
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wavesplat._files.libraries import library
from wavesplat._files.size_checks import check_memory
from wavesplat._geometry import mesh_counts
from wavesplat._geometry.foreign_shapes import kind_of, points_of, surface_of
from wavesplat._geometry.read_shape import Asked, ReadShape
from wavesplat._model import units
from wavesplat.errors import ArgumentError, FileError

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
    mesh_counts.check_text(content, suffix)
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
