"""Names of labels as names of files, for all file systems, each different from the others."""

from __future__ import annotations

import re
from collections.abc import Sequence

#: Characters that Windows, macOS or Linux refuse in a name, or shells read: all but letters, digits and a few signs.
UNSAFE = re.compile(r"[^\w.+()-]+")
#: Names of devices on Windows, with any suffix.
DEVICES = re.compile(r"(con|prn|aux|nul|com\d|lpt\d)(\..*)?$", re.IGNORECASE)
#: Largest number of characters, of four bytes each at most: names of files have 255 bytes.
MAX_LETTERS = 50


def safe_names(names: Sequence[str], numbers: Sequence[int]) -> list[str]:
    """The names, with `_` for what is not safe; those that differ in case alone end in the label's number."""
    found = [UNSAFE.sub("_", name)[:MAX_LETTERS].strip("._ ") for name in names]
    found = [f"_{name}" if DEVICES.match(name) else name for name in found]
    alike = [name.casefold() for name in found]
    return [
        f"{name or 'label'}_{number}" if not name or alike.count(name.casefold()) > 1 else name
        for name, number in zip(found, numbers, strict=True)
    ]
