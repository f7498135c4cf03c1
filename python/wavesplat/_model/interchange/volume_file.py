"""Files of volumes: NIfTI by nibabel, NRRD, OME-TIFF and OME-Zarr; the last two also of channels and times.

NRRD is written here, as SimpleITK writes neither units nor a world that is RAS:
https://teem.sourceforge.net/nrrd/format.html, a header of lines and the samples, packed by gzip.
"""

from __future__ import annotations

import sys
import zlib
from collections.abc import Callable, Iterable
from dataclasses import replace
from os import PathLike
from typing import Any, get_args

import numpy as np

from wavesplat._model.interchange import convert_to, ome_files
from wavesplat._model.interchange import ome_files as ome_tiff_file
from wavesplat._model.interchange import ome_files as ome_zarr_file
from wavesplat._model.interchange.ome_files import Downsampling
from wavesplat._model.volume.grid import Grid
from wavesplat._model.volume.stack import Stack, WiderType
from wavesplat._storage.output import check_output, write_atomically, write_folder_atomically
from wavesplat._system.values import described
from wavesplat.errors import ArgumentError

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


def save(
    stack: Stack,
    path: str | PathLike[str],
    downsampling: Downsampling | None = None,
    progress: Callable[[float], object] = lambda _fraction: None,
) -> None:
    """Write volumes and their place to a file, whole or not at all; the suffix chooses the format.

    downsampling : None is "nearest" for segmentations (modality SEG), else "mean".
    """
    suffix = check_output(path, "volumes")
    if downsampling is not None and downsampling not in get_args(Downsampling):
        raise ArgumentError(f'downsampling is {described(downsampling)}; it is "mean" or "nearest"')
    if downsampling is not None and suffix != ".ome.zarr":
        raise ArgumentError(f"downsampling is for .ome.zarr, which has levels of detail; leave it out: {path}")
    if suffix.startswith(".ome"):
        ome_files.warn_of_lost(stack, path, is_zarr=suffix == ".ome.zarr")
    _save_in_type_of_all(stack, suffix, path, downsampling, progress)


def _save_in_type_of_all(
    stack: Stack,
    suffix: str,
    path: str | PathLike[str],
    downsampling: Downsampling | None,
    progress: Callable[[float], object],
) -> None:
    """Write volumes in the type of the stack, or again in a wider one where a time does not fit into it."""
    try:
        _save_in_type(stack, suffix, path, downsampling, progress)
    except WiderType as wider:
        wide = replace(stack, dtype=wider.dtype)
        _save_in_type_of_all(wide, suffix, path, downsampling, progress)


def _save_in_type(
    stack: Stack,
    suffix: str,
    path: str | PathLike[str],
    downsampling: Downsampling | None,
    progress: Callable[[float], object],
) -> None:
    """Write volumes in the type of the stack."""
    if suffix == ".ome.zarr":
        how = downsampling or ("nearest" if stack.facts.modality == "SEG" else "mean")
        write_folder_atomically(path, lambda part: ome_zarr_file.write_zarr(stack, part, how, progress))
    elif suffix.startswith(".ome"):
        write_atomically(path, lambda part: ome_tiff_file.write_tiff(stack, part, progress))
    else:
        _save_one(stack, suffix, path)


def _save_one(stack: Stack, suffix: str, path: str | PathLike[str]) -> None:
    """Write a file of a format that holds one volume."""
    if stack.n_times * stack.n_channels > 1:
        n = f"{stack.n_channels} channels" if stack.n_channels > 1 else f"{stack.n_times} times"
        raise ArgumentError(f"{suffix} holds one volume, not {n}; write .ome.tif or .ome.zarr, or choose one: {path}")
    grid = stack.grid
    samples = stack.read(0, 0, ((0, 0, 0), grid.shape))
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
