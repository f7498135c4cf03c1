"""Libraries in C++ that write about damaged files to the standard error stream, where errors already reach us."""

from __future__ import annotations

import os
import threading
from collections.abc import Iterator
from contextlib import contextmanager

__all__ = ["muted_stderr"]

STDERR = 2


class _Silence:
    """The stream leads nowhere from the first that asks until the last is done: threads overlap in any order."""

    def __init__(self) -> None:
        self.lock = threading.Lock()
        self.n_asking = 0
        self.stream: int | None = None

    def begin(self) -> None:
        with self.lock:
            self.n_asking += 1
            if self.n_asking == 1:
                self.stream = _redirected()

    def end(self) -> None:
        with self.lock:
            self.n_asking -= 1
            if self.n_asking == 0:
                self.restore()

    def restore(self) -> None:
        if self.stream is not None:
            os.dup2(self.stream, STDERR)
            os.close(self.stream)
            self.stream = None

    def begin_anew(self) -> None:
        """In a forked child, in which those who asked do not go on."""
        self.lock = threading.Lock()
        self.n_asking = 0
        self.restore()


def _redirected() -> int | None:
    """Where the stream led; None of a process that has none."""
    try:
        stream = os.dup(STDERR)
    except OSError:
        return None
    nowhere = os.open(os.devnull, os.O_WRONLY)
    os.dup2(nowhere, STDERR)
    os.close(nowhere)
    return stream


_SILENCE = _Silence()
if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=_SILENCE.begin_anew)


@contextmanager
def muted_stderr() -> Iterator[None]:
    """Hide what is written to the standard error stream, past Python; the standard output stays as it is.

    What other threads write there meanwhile is hidden too.
    """
    _SILENCE.begin()
    try:
        yield
    finally:
        _SILENCE.end()
