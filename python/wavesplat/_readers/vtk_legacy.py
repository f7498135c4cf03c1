"""Whether a legacy VTK file holds as many samples as its header says: ITK draws what memory holds where it ends.

Format: "VTK file formats", https://docs.vtk.org/en/latest/vtk_file_formats/vtk_legacy_file_format.html.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from wavesplat._files import payload
from wavesplat.errors import FileError

__all__ = ["check_samples"]

#: The last line before the samples.
BEFORE_SAMPLES = re.compile(rb"\n(?:LOOKUP_TABLE|COLOR_SCALARS|VECTORS|TENSORS)[^\n]*\n", re.IGNORECASE)
#: Headers are a few hundred bytes.
MOST_HEADER_BYTES = 1 << 16


def check_samples(path: Path, shape: Sequence[int], dtype: np.dtype[Any]) -> None:
    """A `FileError` if there are too few."""
    with path.open("rb") as file:
        start = file.read(MOST_HEADER_BYTES)
    found = BEFORE_SAMPLES.search(start)
    if found is None:
        return  # ITK says what is missing
    stored = path.stat().st_size - found.end()
    is_text = start.split(b"\n", 3)[2:3] and start.split(b"\n", 3)[2].strip().upper() == b"ASCII"
    if not is_text:
        payload.check_stored(shape, dtype, stored, path)
        return
    # A digit and a space for each.
    payload.check_stored(shape, np.dtype("u1"), (stored + 1) // 2, path)
    payload.check_memory(payload.n_bytes(shape, dtype), path)
    n_samples, needed = len(path.read_bytes()[found.end() :].split()), payload.n_bytes(shape, np.dtype("u1"))
    if n_samples < needed:
        raise FileError(f"truncated: {needed} samples are promised, {n_samples} are there; copy it again: {path}")
