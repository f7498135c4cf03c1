"""Repair of volumes in a child made by `fork` while another thread drew them.

`fork` copies the process, but only the thread that calls it. The compiled module starts pool threads of its own in the
child; data that another thread was just preparing for a volume stay locked there, so they are made anew.
multiprocessing on Linux before Python 3.14, PyTorch's loaders, and web servers fork.
"""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager

#: Volumes that threads of this process are drawing.
DRAWN: list[object] = []


def _begin_as_child() -> None:
    drawn = DRAWN.copy()
    DRAWN.clear()
    for volume in drawn:
        # What the compiled module keeps for it may be locked by a thread that is no more.
        if hasattr(volume, "_renew"):
            volume._renew()


if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=_begin_as_child)


@contextmanager
def drawing(*volumes: object) -> Iterator[None]:
    """Register volumes as being drawn."""
    DRAWN.extend(volumes)
    try:
        yield
    finally:
        for volume in volumes:
            # A child that was forked meanwhile by this very thread has cleared the list.
            if volume in DRAWN:
                DRAWN.remove(volume)
