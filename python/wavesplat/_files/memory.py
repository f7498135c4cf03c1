"""Free memory of this process, checked before large allocations.

Unchecked, the system or the compiled module ends the process where memory runs out, without a message.
"""

from __future__ import annotations

import ctypes
import os
import sys
from functools import cache
from pathlib import Path
from typing import Any

from wavesplat.errors import LimitError

#: Allocations below this are not checked.
SMALL_BYTES = 1 << 28
GIB = 1 << 30


def check_room(needed: int, what: str, mend: str) -> None:
    """Raise a `LimitError` if `needed` bytes are not free. `what`: such as "the samples"; `mend`: advice."""
    if needed < SMALL_BYTES:
        return
    free = free_bytes()
    if free is not None and needed > free:
        raise LimitError(
            f"{what} need {needed / GIB:.1f} GiB, this machine has {free / GIB:.1f} GiB of memory for them; {mend}"
        )


def free_bytes() -> int | None:
    """Free bytes: the least of the machine's, the container's and the process's; None where none is known."""
    found = [_of_machine(), _of_container(), _of_process()]
    return min((n for n in found if n is not None), default=None)


def resident_bytes() -> int | None:
    """Bytes of memory that this process takes; None where the system does not report it."""
    try:
        return int(Path("/proc/self/statm").read_text(encoding="ascii").split()[1]) * os.sysconf("SC_PAGE_SIZE")
    except (OSError, ValueError, IndexError, AttributeError):
        return None


def trim_heap() -> None:
    """Return freed memory to the system, where the C library is glibc; elsewhere nothing.

    glibc keeps what each thread has freed in an arena of that thread, and chunks are unpacked by many threads: 110 MB
    of a picture within 100 MB were such memory.
    """
    trim = _malloc_trim()
    if trim is not None:
        trim(0)


@cache
def _malloc_trim() -> Any:
    """The function `malloc_trim` of glibc; None elsewhere."""
    if sys.platform != "linux":
        return None
    try:
        return ctypes.CDLL(None).malloc_trim
    except (OSError, AttributeError):  # musl
        return None


def _of_machine() -> int | None:
    """Free and reclaimable memory of the machine, swap included; elsewhere than on Linux all of its memory."""
    fields = _fields(Path("/proc/meminfo"))
    if "MemAvailable:" in fields:
        return 1024 * (fields["MemAvailable:"] + fields.get("SwapFree:", 0))
    try:
        return os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")
    except (AttributeError, ValueError, OSError):  # not on every system
        return None


def _of_container() -> int | None:
    """Free memory of a Linux control group, version 2; inactive file pages count as free, as they can be dropped."""
    folder = Path("/sys/fs/cgroup")
    limit, used = _number(folder / "memory.max"), _number(folder / "memory.current")
    if limit is None or used is None:
        return None
    return max(limit - used + _fields(folder / "memory.stat").get("inactive_file", 0), 0)


def _of_process() -> int | None:
    """Free address space, as `ulimit -v` and job schedulers limit it; None without a limit."""
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
    """Numbers by name, of a file of such lines; empty where it cannot be read."""
    try:
        lines = [line.split() for line in file.read_text(encoding="ascii").splitlines()]
        return {line[0]: int(line[1]) for line in lines if len(line) > 1}
    except (OSError, ValueError):
        return {}
