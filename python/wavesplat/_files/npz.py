"""Headers of NumPy's files, .npy and archives of them, checked before samples are read."""

from __future__ import annotations

import zipfile
from collections.abc import Iterable
from typing import Any

import numpy as np

from wavesplat._files import size_checks

__all__ = ["check_members", "npy_header"]


def npy_header(file: Any) -> tuple[tuple[int, ...], bool, np.dtype[Any]]:
    """Shape, whether the first axis is the fastest, and type in the header of a .npy file."""
    version = np.lib.format.read_magic(file)
    read_header = np.lib.format.read_array_header_1_0 if version == (1, 0) else np.lib.format.read_array_header_2_0
    found: tuple[tuple[int, ...], bool, np.dtype[Any]] = read_header(file)
    return found


def check_members(archive: zipfile.ZipFile, names: Iterable[str], path: object) -> None:
    """Raise an error if arrays of an archive cannot be as large as their headers say, or do not fit into memory."""
    total = 0
    for name in names:
        with archive.open(name) as file:
            shape, _, dtype = npy_header(file)
        if dtype.hasobject:
            continue  # a pickle, which NumPy refuses
        member = archive.getinfo(name)
        size_checks.check_stored(shape, dtype, member.file_size, path)
        size_checks.check_stored(shape, dtype, member.compress_size, path, ratio=size_checks.ANY_RATIO)
        total += size_checks.n_bytes(shape, dtype)
    size_checks.check_memory(total, path)
