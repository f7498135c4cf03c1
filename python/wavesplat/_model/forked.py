"""Volumes in a child made by `fork` while another thread drew them.

`fork` copies the process but of its threads only the one that calls. The compiled module makes helpers of its own in
the child; what another thread was just making for a volume stays locked there, so it is made anew. multiprocessing on
Linux before Python 3.14, PyTorch's loaders, and web servers fork.
"""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager

__all__ = ["drawing"]

#: What is being drawn by threads of this process.
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
    """While volumes are drawn."""
    DRAWN.extend(volumes)
    try:
        yield
    finally:
        for volume in volumes:
            # Not in a child that was forked meanwhile by this very thread.
            if volume in DRAWN:
                DRAWN.remove(volume)
