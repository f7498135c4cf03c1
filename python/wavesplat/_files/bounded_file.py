"""Files as streams for libraries that read as many bytes as a file says, and take the memory for them first.

A damaged length of four bytes is up to 4 GB: of an element of DICOM, or of the header of a .npy file.
"""

from __future__ import annotations

import io
from pathlib import Path


class BoundedFile(io.BufferedReader):
    """A file to read, in parts that are no longer than the file."""

    def __init__(self, path: Path) -> None:
        super().__init__(io.FileIO(path))
        self._n_bytes = path.stat().st_size

    def read(self, n: int | None = -1, /) -> bytes:
        """The next bytes, fewer at the end."""
        return super().read(n if n is None else min(n, self._n_bytes))
