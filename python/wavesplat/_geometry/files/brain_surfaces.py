"""Surfaces of brains: FreeSurfer's and GIfTI, with values and labels of their vertices, by nibabel.

FreeSurfer's surfaces have coordinates of their own (tkregister's), whose middle is the middle of the volume that they
were made of. Its header says where that is for the scanner: turned by its axes and moved by c_ras, they lie in the
world of NIfTI and MGH volumes.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wavesplat._geometry.files.read_shape import Asked, ReadShape
from wavesplat._storage.paths import check_within
from wavesplat._storage.size_checks import check_readable
from wavesplat._system.libraries import library
from wavesplat.errors import ArgumentError, FileError

#: Ends of names of FreeSurfer's surfaces.
FREESURFER = (".pial", ".white", ".inflated", ".orig", ".smoothwm", ".sphere", ".midthickness")
#: First bytes of its surfaces of triangles and of quadrilaterals, and of its values.
TRIANGLES, QUADS, CURVATURES = b"\xff\xff\xfe", (b"\xff\xff\xff", b"\xff\xff\xfd"), b"\xff\xff\xff"
#: Axes of the coordinates of its surfaces: right, down and front of the slices.
TKREGISTER = np.array([[-1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0]])
SCANNER = 1
#: Letters of a line in the header of a surface of FreeSurfer, at most.
MAX_LINE_BYTES = 1 << 12


def is_freesurfer(path: Path) -> bool:
    """Whether a file begins as FreeSurfer's surfaces do."""
    with path.open("rb") as file:
        head = file.read(3)
    return head == TRIANGLES or (head in QUADS and path.name.lower().endswith(FREESURFER))


def read_freesurfer(asked: Asked) -> ReadShape:
    """A surface of FreeSurfer, in the scanner's world."""
    nib: Any = library("nibabel", extra="geometry")
    _check_counts(asked.file)
    vertices, faces, meta = nib.freesurfer.read_geometry(str(asked.file), read_metadata=True)
    moved, guesses = _in_scanner(np.asarray(vertices, np.float64), meta or {})
    fields = {"vertices": moved, "faces": np.asarray(faces)}
    values, values_from = _values(asked, len(moved))
    return ReadShape("surface", fields | values, "mm", guesses, values_from)


def _check_counts(path: Path) -> None:
    """Raise a `ValueError` if a file of triangles is shorter than its counts say: readers allocate memory by them."""
    with path.open("rb") as file:
        if file.read(len(TRIANGLES)) != TRIANGLES:
            return
        file.readline(MAX_LINE_BYTES)
        file.readline(MAX_LINE_BYTES)
        vertices, triangles = (int.from_bytes(file.read(4), "big", signed=True) for _ in range(2))
        held = path.stat().st_size - file.tell()
    if min(vertices, triangles) < 0 or 12 * (vertices + triangles) > held:
        raise ValueError(
            f"truncated: its header promises {vertices} vertices and {triangles} triangles, and it holds {held} bytes"
        )


def _in_scanner(vertices: NDArray[np.float64], meta: Any) -> tuple[NDArray[np.float64], tuple[str, ...]]:
    """Vertices in the scanner's world, and what was done."""
    center = meta.get("cras")
    if center is None or str(meta.get("valid", "1")).strip().startswith("0"):
        return vertices, ("FreeSurfer's own coordinates: the header does not say where they lie in the scanner",)
    axes = np.stack([np.asarray(meta[name], np.float64) for name in ("xras", "yras", "zras")], axis=1)
    turn = axes @ np.linalg.inv(TKREGISTER)
    c_ras = np.asarray(center, np.float64)
    x, y, z = c_ras.tolist()
    return vertices @ turn.T + c_ras, (f"moved by c_ras ({x:g}, {y:g}, {z:g}) mm into the scanner's world",)


def read_gifti(asked: Asked) -> ReadShape:
    """The surface in a GIfTI file."""
    nib: Any = library("nibabel", extra="geometry")
    image = nib.GiftiImage.from_bytes(asked.file.read_bytes())
    points = image.get_arrays_from_intent("NIFTI_INTENT_POINTSET")
    triangles = image.get_arrays_from_intent("NIFTI_INTENT_TRIANGLE")
    if not points or not triangles:
        raise FileError("it holds values and no surface; open the surface, and give this file as values=")
    vertices = np.asarray(points[0].data, np.float64)
    system = points[0].coordsys
    guesses: tuple[str, ...] = ()
    if system is not None and system.xformspace == SCANNER != system.dataspace and system.xform is not None:
        matrix = np.asarray(system.xform, np.float64)
        vertices = vertices @ matrix[:3, :3].T + matrix[:3, 3]
        guesses = ("moved by the file's own transform into the scanner's world",)
    elif (system is None or system.dataspace != SCANNER) and (center := _center_of(points[0].meta)) is not None:
        vertices = vertices + center
        x, y, z = center.tolist()
        guesses = (f"moved by c_ras ({x:g}, {y:g}, {z:g}) mm into the scanner's world",)
    fields = {"vertices": vertices, "faces": np.asarray(triangles[0].data)}
    values, values_from = _values(asked, len(vertices))
    return ReadShape("surface", fields | values, "mm", guesses, values_from)


def _center_of(meta: Any) -> NDArray[np.float64] | None:
    """The c_ras that FreeSurfer writes into a GIfTI file beside its own coordinates."""
    try:
        return np.array([float(meta[f"VolGeomC_{axis}"]) for axis in "RAS"])
    except (KeyError, TypeError, ValueError):
        return None


def _values(asked: Asked, n: int) -> tuple[dict[str, Any], Path | None]:
    """Values or colours of `n` vertices, and their file, which `values` names: FreeSurfer's, GIfTI's, numbers as text.

    A relative name starts from the surface's folder or, where there is none of that name, from the working directory.
    """
    if asked.values is None:
        return {}, None
    path = Path(asked.values).expanduser()
    beside = asked.file.parent / path
    path = beside if beside.exists() else path.absolute()
    check_within(path, asked.within)
    if not path.exists():
        raise ArgumentError(
            f"values is {asked.values!r}, and there is no such file; give the file of a value for each vertex, such as "
            f"lh.thickness, lh.aparc.annot or .shape.gii: {asked.file}"
        )
    check_readable(path)
    found = _fields_of_values(path)
    count = len(found.get("values", found.get("color", ())))
    if count != n:
        raise FileError(f"it has values of {count} vertices, and the surface has {n}; do they belong together: {path}")
    return found, path.absolute()


def _fields_of_values(path: Path) -> dict[str, Any]:
    nib: Any = library("nibabel", extra="geometry")
    name = path.name.lower()
    if name.endswith(".annot"):
        numbers, table, _ = nib.freesurfer.read_annot(str(path))
        colors = np.full((len(numbers), 4), 0.5, np.float32)
        colors[:, 3] = 1
        known = numbers >= 0
        colors[known, :3] = table[numbers[known], :3] / 255
        return {"color": colors}
    if name.endswith(".gii"):
        return _of_gifti(nib.GiftiImage.from_bytes(path.read_bytes()))
    with path.open("rb") as file:
        is_binary = file.read(3) == CURVATURES
    return {"values": nib.freesurfer.read_morph_data(str(path)) if is_binary else np.loadtxt(path, ndmin=1)}


def _of_gifti(image: Any) -> dict[str, Any]:
    """The first values of a GIfTI file; of labels, their colours."""
    labels = image.get_arrays_from_intent("NIFTI_INTENT_LABEL")
    if not labels:
        return {"values": np.asarray(image.darrays[0].data, np.float64).ravel()}
    colors = {label.key: label.rgba for label in image.labeltable.labels}
    numbers = np.asarray(labels[0].data).ravel()
    rgba = np.array([[1.0 if part is None else part for part in colors.get(n, (0.5,) * 3 + (1,))] for n in numbers])
    return {"color": rgba}
