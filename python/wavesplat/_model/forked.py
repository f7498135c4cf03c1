"""What is left of the renderer in a forked child: its own thread.

`fork` copies the process but of its threads only the one that calls. A child that shares work among the others waits
for ever, and so does one that wants what another thread was just making: multiprocessing on Linux before Python 3.14,
PyTorch's loaders, and web servers fork.
"""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager

from wavesplat.errors import LimitError

__all__ = ["check_threads", "drawing", "threads_here"]


class _Process:
    """What a child must know of the process that it was forked from."""

    def __init__(self) -> None:
        #: Whether the threads of all were made, and whether it was a process before this one that made them.
        self.has_threads = False
        self.lost_threads = False
        #: What is being drawn by threads of this process.
        self.drawn: list[object] = []

    def begin_as_child(self) -> None:
        self.lost_threads |= self.has_threads
        drawn, self.drawn = self.drawn, []
        for volume in drawn:
            # What the compiled module keeps for it may be locked by a thread that is no more.
            if hasattr(volume, "_renew"):
                volume._renew()


_PROCESS = _Process()
if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=_PROCESS.begin_as_child)


def threads_here(wanted: int | None) -> int | None:
    """How many threads work is shared among: those that are wanted, in a forked child the one that there is."""
    _PROCESS.has_threads = True
    return 1 if _PROCESS.lost_threads else wanted


def check_threads(work: str) -> None:
    """A `LimitError` where work needs the threads that a forked child lacks."""
    _PROCESS.has_threads = True
    if _PROCESS.lost_threads:
        raise LimitError(
            f"this process was forked from one that had used the renderer, whose threads it lacks to {work}; "
            'do that before, or start processes by "spawn" or "forkserver" (multiprocessing.set_start_method)'
        )


@contextmanager
def drawing(*volumes: object) -> Iterator[None]:
    """While volumes are drawn."""
    _PROCESS.drawn.extend(volumes)
    try:
        yield
    finally:
        for volume in volumes:
            # Not in a child that was forked meanwhile by this very thread.
            if volume in _PROCESS.drawn:
                _PROCESS.drawn.remove(volume)
