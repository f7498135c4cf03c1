"""Libraries of others: those that may be missing, and those that write on the standard error stream."""

from __future__ import annotations

import os
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from importlib import import_module
from typing import Any

from wavesplat.errors import LibraryError

# Optional libraries, which only some functions need.


def library(name: str, *, extra: str) -> Any:
    """The module, or a `LibraryError` that names the extra of the package that installs it."""
    try:
        return import_module(name)
    except ImportError as error:
        missing = (error.name or name).partition(".")[0]
        raise LibraryError(f"{missing} is not installed; {how_to_install(extra)}") from error


def how_to_install(extra: str) -> str:
    """The end of a message about a missing package: the command that installs what an extra has.

    Where Wavesplat is installed, from a wheel or from a checkout, pip finds it there and adds only what is missing.
    Where its modules are run as they lie, pip would look for the name where packages are published.
    """
    from importlib import metadata

    try:
        metadata.version("wavesplat")
    except metadata.PackageNotFoundError:
        return f'in the checkout of Wavesplat, run: pip install ".[{extra}]"'
    return f'run: pip install "wavesplat[{extra}]"'


# Muting the standard error stream, to which libraries in C++ write about damaged files besides raising errors.

STDERR = 2


class _MutedStream:
    """The standard error stream, muted from the first user to the last: threads overlap in any order."""

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
        """Unmute in a forked child, in which the threads that muted it do not go on."""
        self.lock = threading.Lock()
        self.n_asking = 0
        self.restore()


def _redirected() -> int | None:
    """Redirect the stream to nowhere; return a copy of the old one, None for a process that has none."""
    try:
        stream = os.dup(STDERR)
    except OSError:
        return None
    nowhere = os.open(os.devnull, os.O_WRONLY)
    os.dup2(nowhere, STDERR)
    os.close(nowhere)
    return stream


_STREAM = _MutedStream()
if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=_STREAM.begin_anew)


@contextmanager
def muted_stderr() -> Iterator[None]:
    """Hide all that is written to the standard error stream, by libraries too; the standard output stays as it is.

    Text that other threads write there meanwhile is hidden as well.
    """
    _STREAM.begin()
    try:
        yield
    finally:
        _STREAM.end()
