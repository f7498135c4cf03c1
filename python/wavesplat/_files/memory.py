"""How much memory this process can still have, asked before much is taken.

Without asking, the system ends the process where it runs out, or the compiled module does, and nothing is said.
"""

from __future__ import annotations

import os
import sys
from pathlib import Path

from wavesplat.errors import LimitError

__all__ = ["check_room", "free_bytes"]

#: Less than this is not worth asking for.
SMALL_BYTES = 1 << 28
GIB = 1 << 30


def check_room(needed: int, what: str, mend: str) -> None:
    """A `LimitError` if so many bytes cannot be had. `what`: such as "the samples"; `mend`: what to do instead."""
    if needed < SMALL_BYTES:
        return
    free = free_bytes()
    if free is not None and needed > free:
        raise LimitError(
            f"{what} need {needed / GIB:.1f} GiB, this machine has {free / GIB:.1f} GiB of memory for them; {mend}"
        )


def free_bytes() -> int | None:
    """Bytes that can still be had: of the machine, of the container, of the process; None where nobody knows."""
    found = [_of_machine(), _of_container(), _of_process()]
    return min((n for n in found if n is not None), default=None)


def _of_machine() -> int | None:
    """What is free or can be made so, disk space for memory included; elsewhere than on Linux all there is."""
    fields = _fields(Path("/proc/meminfo"))
    if "MemAvailable:" in fields:
        return 1024 * (fields["MemAvailable:"] + fields.get("SwapFree:", 0))
    try:
        return os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")
    except (AttributeError, ValueError, OSError):  # not on every system
        return None


def _of_container() -> int | None:
    """Of a Linux control group, version 2: files that it has read can be dropped again."""
    folder = Path("/sys/fs/cgroup")
    limit, used = _number(folder / "memory.max"), _number(folder / "memory.current")
    if limit is None or used is None:
        return None
    return max(limit - used + _fields(folder / "memory.stat").get("inactive_file", 0), 0)


def _of_process() -> int | None:
    """Of address space, as `ulimit -v` and job schedulers limit it."""
    if sys.platform == "win32":
        return None
    import resource

    limit, _ = resource.getrlimit(resource.RLIMIT_AS)
    if limit == resource.RLIM_INFINITY:
        return None
    try:
        n_pages = int(Path("/proc/self/statm").read_text(encoding="ascii").split()[0])
    except (OSError, ValueError, IndexError):
        return int(limit)
    return max(limit - n_pages * os.sysconf("SC_PAGE_SIZE"), 0)


def _number(file: Path) -> int | None:
    try:
        return int(file.read_text(encoding="ascii"))
    except (OSError, ValueError):  # not there, or "max"
        return None


def _fields(file: Path) -> dict[str, int]:
    """Lines of a name and a number."""
    try:
        lines = [line.split() for line in file.read_text(encoding="ascii").splitlines()]
        return {line[0]: int(line[1]) for line in lines if len(line) > 1}
    except (OSError, ValueError):
        return {}
