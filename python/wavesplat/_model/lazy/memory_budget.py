"""The memory budget of a picture from lazy volumes: its shares, and chunks that are too large for it."""

from __future__ import annotations

import math
from collections.abc import Sequence

from wavesplat._model.lazy.lazy_array import LazyArray
from wavesplat._system.memory import byte_size
from wavesplat.errors import LimitError

#: Share of a budget that is for the samples of two steps; the rest is for bounds, what is being unpacked, and what the
#: allocator keeps. A first picture of 2048^3 from Zarr within 300 MB peaks at 306 MB, Python included, by 0.25 (14
#: blocks, 19.7 s of processor time), at 336 by 0.33 (10, 17.6 s), at 363 by 0.4 (8, 16.6 s): larger blocks share fewer
#: chunks.
FOR_SAMPLES = 0.4
#: Memory that a part takes while it is unpacked, by its size: chunks as they are stored, unpacked, and put together.
UNPACKED_TIMES = 3
#: Share of a budget for what is being unpacked.
FOR_UNPACKING = 0.25


def unpacked_bytes(array: LazyArray) -> int:
    """Bytes that a chunk takes while it is unpacked; 0 where parts of it are read alone."""
    if array.is_in_memory or getattr(array, "reads_parts", False):
        return 0
    return UNPACKED_TIMES * math.prod(array.chunks) * array.dtype.itemsize


def check_budget(arrays: Sequence[LazyArray], memory: int) -> None:
    """Raise a `LimitError` if a chunk of an array takes more than half of the budget while it is unpacked."""
    for array in arrays:
        needed = 2 * unpacked_bytes(array)
        if needed > memory:
            z, y, x = array.chunks
            raise LimitError(
                f"memory is {byte_size(memory)}, and a chunk of {array.name!r} (z {z}, y {y}, x {x}, {array.dtype}) "
                f'needs {byte_size(needed)}; give memory="{-(-needed // 10**6)} MB" or more, or store '
                "the samples in smaller chunks"
            )
