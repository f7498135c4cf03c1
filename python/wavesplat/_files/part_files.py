"""Hidden files and folders beside an output, in which it is written until it is whole.

A name holds the process and its machine: `.PID-NUMBER-MACHINE.part`. What a killed process left is removed by the next
output in that folder.
"""

from __future__ import annotations

import hashlib
import os
import re
import shutil
import sys
from contextlib import suppress
from functools import cache
from itertools import count
from pathlib import Path

#: Numbers that distinguish files written at the same time.
_NUMBERS = count()
#: Folders that this process has already searched for left-over files: a movie writes thousands of files into one.
_SEEN: set[str] = set()


def part_beside(target: Path, ending: str = ".part") -> Path:
    """A hidden name beside an output.

    Without the output's name in it, which may be as long as names can be; threads may write the same output at once.
    """
    return target.with_name(f".{os.getpid()}-{next(_NUMBERS)}-{_machine()}{ending}")


def remove_left_over(folder: Path, *, again: bool = True) -> None:
    """Remove unfinished outputs of killed processes of this machine from a folder; outputs in progress stay.

    again : whether a folder is looked through that this process has looked through before.
    """
    if sys.platform == "win32" or (not again and str(folder) in _SEEN):  # `os.kill(pid, 0)` would end the process there
        return
    _SEEN.add(str(folder))
    name = re.compile(rf"\.(\d{{1,9}})-\d+-{_machine()}\.part(\.\w+)*")
    with suppress(OSError), os.scandir(folder) as entries:
        for entry in entries:
            if (found := name.fullmatch(entry.name)) and not _is_alive(int(found[1])):
                with suppress(OSError):
                    removed(Path(entry.path))


def removed(part: Path) -> None:
    """Remove a file or folder, if it is there."""
    if part.is_dir() and not part.is_symlink():
        shutil.rmtree(part, ignore_errors=True)
    else:
        part.unlink(missing_ok=True)


def _is_alive(pid: int) -> bool:
    try:
        os.kill(pid, 0)
    except ProcessLookupError:
        return False
    except OSError:  # of another user
        return True
    return True


@cache
def _machine() -> str:
    """Eight hexadecimal digits that identify the machine or container in which process numbers are unique."""
    try:
        numbers_of = os.readlink("/proc/self/ns/pid")  # noqa: PTH115 - no path, but a name
    except OSError:
        numbers_of = ""
    name = os.uname().nodename if hasattr(os, "uname") else ""
    return hashlib.blake2b(f"{name} {numbers_of}".encode(), digest_size=4).hexdigest()
