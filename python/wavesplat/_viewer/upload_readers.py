"""Objects that read on from the files that were opened: an upload stays on the disk as long as one of them is there.

Most volumes, segmentations and shapes are in memory and need their files no more.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from wavesplat._model.lazy_volume import LazyVolume
from wavesplat._model.series import Series
from wavesplat._model.volume import Volume
from wavesplat._viewer.open_paths import Found


def readers_of(found: Found) -> Iterator[object]:
    """The objects that read on from the files of what was found; copies, parts and moved volumes share them."""
    for layer in found.layers:
        for thing in (layer.volume, layer.drawn):
            yield from _readers_of(thing)


def _readers_of(thing: object) -> Iterator[object]:
    if isinstance(thing, Series):
        yield thing._volumes
    elif isinstance(thing, LazyVolume):
        yield from (level.array for level in thing._levels)
    elif isinstance(thing, Volume) and (mapped := _mapped(thing.samples)) is not None:
        yield mapped


def _mapped(samples: Any) -> object | None:
    """The map of a file in memory that an array is a view of; None of other arrays."""
    while samples is not None and not isinstance(samples, np.memmap):
        samples = getattr(samples, "base", None)
    return getattr(samples, "_mmap", None)  # one object for all views
