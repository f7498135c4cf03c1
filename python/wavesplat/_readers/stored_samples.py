"""Samples that lie in a file as they are, read in parts: by their place in the file, and the order of their axes."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from wavesplat._files import size_checks
from wavesplat._files.file_states import StoredFiles
from wavesplat._files.stored_array import StoredArray
from wavesplat._model.lazy_array import SlicedArray

__all__ = ["stored_samples"]


def stored_samples(
    path: Path,
    dtype: np.dtype[Any],
    offset: int,
    shape: Sequence[int],
    *,
    order: tuple[int, int, int],
    picked: Sequence[int | None],
    convert: Any = None,
    made: np.dtype[Any] | None = None,
) -> SlicedArray:
    """Samples that lie in a file as they are, the last axis fastest."""
    size_checks.check_stored(shape, dtype, max(path.stat().st_size - offset, 0), path, held=(1,))
    z, y, x = (int(shape[axis]) for axis in order)
    # A chunk is a slice across the slowest of the three axes.
    slowest = min(range(3), key=lambda k: order[k])
    chunks = [1 if k == slowest else n for k, n in enumerate((z, y, x))]
    return SlicedArray(
        None,
        name=path.name,
        chunks=chunks,
        order=order,
        picked=picked,
        opened=partial(StoredArray, path, dtype, offset, tuple(shape)),
        convert=convert,
        dtype=made if made is not None else dtype,
        shape=(z, y, x),
        token=f"stored {path} {dtype.str} {offset} {tuple(shape)} {getattr(convert, 'keywords', None)}",
        files=StoredFiles([path]),
        reads_parts=True,
    )
