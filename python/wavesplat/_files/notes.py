"""Warnings of Wavesplat, which a thread can collect instead.

`warnings.catch_warnings` replaces the filters of the whole process, so a thread that used it would take the warnings of
other threads, and two of them would put each other's filters back. A context variable belongs to one thread alone.
"""

from __future__ import annotations

import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar

from wavesplat.errors import WavesplatWarning

_COLLECTED: ContextVar[list[WavesplatWarning] | None] = ContextVar("collected_notes", default=None)


def warn(text: str, category: type[WavesplatWarning] = WavesplatWarning, *, stacklevel: int = 2) -> None:
    """Warn as `warnings.warn` does, with its `stacklevel`; where the thread collects notes, add it to these instead."""
    collected = _COLLECTED.get()
    if collected is None:
        warnings.warn(text, category, stacklevel=stacklevel + 1)
    else:
        collected.append(category(text))


@contextmanager
def collected_notes() -> Iterator[list[WavesplatWarning]]:
    """Collect Wavesplat's warnings of this thread, in their order, instead of warning; a block inside has its own."""
    collected = list[WavesplatWarning]()
    token = _COLLECTED.set(collected)
    try:
        yield collected
    finally:
        _COLLECTED.reset(token)
