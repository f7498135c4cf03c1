"""Threads: work that is no longer wanted is cancelled, and warnings of one thread can be collected.

Not an argument of functions that open files, which would pass it through every reader; a context variable belongs to
one thread alone. Readers that are one call of a library end by themselves.
"""

from __future__ import annotations

import warnings
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar

from wavesplat.errors import CancelledError, WavesplatWarning

_IS_CANCELLED: ContextVar[Callable[[], bool] | None] = ContextVar("is_cancelled", default=None)


@contextmanager
def cancelled_by(is_cancelled: Callable[[], bool]) -> Iterator[None]:
    """Cancel what reads files in the block as soon as the function returns True."""
    token = _IS_CANCELLED.set(is_cancelled)
    try:
        yield
    finally:
        _IS_CANCELLED.reset(token)


@contextmanager
def cancelled_by_progress(progress: Callable[[float], object] | None) -> Iterator[None]:
    """Cancel reading for a picture, before drawing begins, when its progress callback returns False."""
    if progress is None:
        yield
        return
    with cancelled_by(lambda: progress(0.0) is False):
        yield


def check_cancelled() -> None:
    """Raise a `CancelledError` if nobody wants the result any more."""
    is_cancelled = _IS_CANCELLED.get()
    if is_cancelled is not None and is_cancelled():
        raise CancelledError("reading was cancelled; draw the picture again to read the file")


# Warnings of Wavesplat, which a thread can collect instead.
#
# `warnings.catch_warnings` replaces the filters of the whole process, so a thread that used it would take the warnings
# of other threads, and two of them would put each other's filters back. A context variable belongs to one thread alone.

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
