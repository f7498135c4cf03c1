"""Arrays that lie in files as they are: headers of NumPy's files, and reading by slicing.

The file is not mapped: pages of a map count as memory of the process.
"""

from __future__ import annotations

import math
import os
import threading
import zipfile
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wavesplat._storage import size_checks

# Headers of NumPy's files, .npy and archives of them, checked before samples are read.


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


# Arrays that lie in a file as they are, read by slicing.


class StoredArray:
    """An array of a file from byte `offset` on, the last axis fastest; indices are whole numbers and plain slices."""

    def __init__(self, path: Path, dtype: np.dtype[Any], offset: int, shape: Sequence[int]) -> None:
        self.dtype, self.shape = np.dtype(dtype), tuple(int(n) for n in shape)
        self._path, self._offset = path, offset
        self._file = path.open("rb", buffering=0)
        self._lock = threading.Lock()

    def __getitem__(self, index: tuple[int | slice, ...]) -> NDArray[Any]:
        lows = [part if isinstance(part, int) else part.start or 0 for part in index]
        ends = [
            part + 1 if isinstance(part, int) else n if part.stop is None else part.stop
            for part, n in zip(index, self.shape, strict=True)
        ]
        out = np.empty([b - a for a, b in zip(lows, ends, strict=True)], self.dtype)
        # Numbers that lie side by side in the file are read at once: the axes that are whole, and one before them.
        last = len(self.shape) - 1
        while last > 0 and (lows[last], ends[last]) == (0, self.shape[last]):
            last -= 1
        # Where a quarter of a row or more is wanted, whole rows are read at once, and cut.
        takes_rows = last == len(self.shape) - 1 and last > 0 and out.shape[last] * 4 >= self.shape[last]
        first = last - 1 if takes_rows else last
        strides = [math.prod(self.shape[axis + 1 :]) for axis in range(len(self.shape))]
        for place in np.ndindex(*out.shape[:first]):
            start = sum((low + k) * s for low, k, s in zip(lows, place, strides, strict=False))
            if takes_rows:
                rows = self._read(start + lows[first] * strides[first], out.shape[first] * strides[first])
                out[place] = rows.reshape(out.shape[first], self.shape[last])[:, lows[last] : ends[last]]
            else:
                n = out.shape[first] * strides[first]
                out[place] = self._read(start + lows[first] * strides[first], n).reshape(out[place].shape)
        return out[tuple(0 if isinstance(part, int) else slice(None) for part in index)]

    def _read(self, first: int, n: int) -> NDArray[Any]:
        """Read `n` numbers, from number `first` on."""
        place, n_bytes = self._offset + first * self.dtype.itemsize, n * self.dtype.itemsize
        if hasattr(os, "pread"):
            found = os.pread(self._file.fileno(), n_bytes, place)
            # The system gives at most 2 GB at once, and may give less.
            while 0 < len(found) < n_bytes:
                more = os.pread(self._file.fileno(), n_bytes - len(found), place + len(found))
                if not more:
                    break
                found += more
        else:
            with self._lock:
                self._file.seek(place)
                found = self._file.read(n_bytes) or b""
        if len(found) < n_bytes:
            raise ValueError(f"the file ends {n_bytes - len(found)} bytes too early")
        return np.frombuffer(found, self.dtype)

    def __del__(self) -> None:
        file = getattr(self, "_file", None)
        if file is not None:
            file.close()
