"""Files of volumes: NIfTI by nibabel, and NRRD.

NRRD is written here, as SimpleITK writes neither units nor a world that is RAS:
https://teem.sourceforge.net/nrrd/format.html, a header of lines and the samples, packed by gzip.
"""

from __future__ import annotations

import sys
import zlib
from collections.abc import Iterable
from os import PathLike
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wavesplat._files.output import check_output, write_atomically
from wavesplat._model import convert_to
from wavesplat._model.grid import Grid

__all__ = ["save"]

#: NumPy's types -> NRRD's.
NRRD_TYPES = {
    "u1": "uint8",
    "i1": "int8",
    "u2": "uint16",
    "i2": "int16",
    "u4": "uint32",
    "i4": "int32",
    "f4": "float",
    "f8": "double",
}
#: Compression level of gzip; levels above take much longer, and save a few percent.
GZIP_LEVEL = 3
#: zlib's `wbits` for gzip with the largest window, and the bytes that are packed at once.
GZIP_WINDOW, PIECE_BYTES = 31, 1 << 20


def save(grid: Grid, samples: NDArray[Any], path: str | PathLike[str]) -> None:
    """Write samples and their place to a file, whole or not at all."""
    suffix = check_output(path, "volumes")
    if suffix == ".nrrd":
        content = _nrrd_header(grid, samples.dtype) + _packed(samples)
    else:
        content = convert_to.to_nibabel(grid, samples).to_bytes()
        content = _packed(content) if suffix == ".nii.gz" else content
    write_atomically(path, lambda part: part.write_bytes(content))


def _packed(content: Any) -> bytes:
    """A gzip file without a time in it, so that equal volumes are equal files; packed in pieces, for Ctrl-C."""
    packer = zlib.compressobj(GZIP_LEVEL, zlib.DEFLATED, GZIP_WINDOW)
    content = memoryview(content).cast("B")
    pieces = [packer.compress(content[first : first + PIECE_BYTES]) for first in range(0, len(content), PIECE_BYTES)]
    return b"".join([*pieces, packer.flush()])


def _nrrd_header(grid: Grid, dtype: np.dtype[Any]) -> bytes:
    matrix = grid.world_from_index
    n_z, n_y, n_x = grid.shape
    lines = [
        "NRRD0005",
        f"type: {NRRD_TYPES[dtype.str[1:]]}",
        "dimension: 3",
        "space: right-anterior-superior" if grid.is_anatomical else "space dimension: 3",
        f"sizes: {n_x} {n_y} {n_z}",
        f"space directions: {' '.join(_vector(column) for column in matrix[:3, :3].T)}",
        "kinds: domain domain domain",
        f"endian: {sys.byteorder}",
        "encoding: gzip",
        f"space origin: {_vector(matrix[:3, 3])}",
    ]
    if grid.unit is not None:
        named = grid.unit.replace("\\", "").replace('"', "")
        lines.append(f'space units: "{named}" "{named}" "{named}"')
    if grid.value_unit is not None:
        lines.append(f"sample units: {' '.join(grid.value_unit.split())}")
    if grid.modality is not None:
        lines.append(f"modality:={' '.join(grid.modality.split())}")
    return ("\n".join(lines) + "\n\n").encode("utf-8", "replace")


def _vector(numbers: Iterable[float]) -> str:
    """A vector of NRRD, with digits enough to read the same numbers back."""
    return f"({','.join(repr(float(number)) for number in numbers)})"
