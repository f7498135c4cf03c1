"""Cancelling what reads files: readers ask between files and slices whether anybody still wants the result.

Not an argument of functions that open files, which would pass it through every reader; a context variable belongs to
one thread alone. Readers that are one call of a library end by themselves.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar

from wavesplat.errors import CancelledError

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
