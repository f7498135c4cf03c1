"""Memory: how much is free, and amounts as people write them.

Unchecked, the system or the compiled module ends the process where memory runs out, without a message.
"""

from __future__ import annotations

import ctypes
import math
import os
import re
import sys
from functools import cache
from pathlib import Path
from typing import Any

from wavesplat.errors import ArgumentError, LimitError

# Amounts of memory as people write them: 512 MB, 1.5 GiB, or a number of bytes.

UNITS = {"b": 1, "kb": 10**3, "mb": 10**6, "gb": 10**9, "tb": 10**12, "kib": 1 << 10, "mib": 1 << 20, "gib": 1 << 30}
UNITS |= {"": 1, "k": 10**3, "m": 10**6, "g": 10**9, "t": 10**12, "tib": 1 << 40}
#: Bound of amounts: more than any machine addresses.
MAX_BYTES = 1 << 63
AMOUNT = re.compile(r"\s*((?:[0-9]+(?:\.[0-9]+)?|\.[0-9]+)(?:e[0-9]+)?)\s*([a-z]*)\s*", re.IGNORECASE)


def bytes_of(given: float | str, what: str = "memory") -> int:
    """Bytes, from a number of them or a text such as "2 GB"; decimal units, and binary ones with an i.

    what : name of the argument in messages.
    """
    if isinstance(given, str):
        found = AMOUNT.fullmatch(given)
        factor = UNITS.get(found[2].lower()) if found else None
        number = float(found[1]) * factor if found and factor else math.nan
    else:
        try:
            number = float(given)
        except (TypeError, ValueError, OverflowError):
            number = math.nan
    if not 1 <= number < MAX_BYTES:
        raise ArgumentError(
            f'{what} is {_named(given)}; give an amount such as "2 GB" or "512 MiB", or a number of bytes'
        )
    return int(number)


def _named(given: object) -> str:
    """A value in a message, or its type where it is long; Python writes no whole numbers of more than 4300 digits."""
    is_long = isinstance(given, int) and abs(given) > MAX_BYTES**2
    return f"a {type(given).__name__}" if is_long or len(repr(given)) > 60 else repr(given)


def byte_size(n_bytes: float) -> str:
    """A number of bytes as text, in decimal units."""
    for factor, unit in ((10**12, "TB"), (10**9, "GB"), (10**6, "MB"), (10**3, "kB")):
        if n_bytes >= factor:
            return f"{n_bytes / factor:.3g} {unit}"
    return f"{n_bytes:.0f} bytes"


# Free memory of this process, checked before large allocations.

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
