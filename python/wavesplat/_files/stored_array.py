"""Arrays that lie in a file as they are, read by slicing.

The file is not mapped: pages of a map count as memory of the process.
"""

from __future__ import annotations

import math
import os
import threading
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray


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
