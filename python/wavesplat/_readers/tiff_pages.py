"""The chain of pages of a TIFF file: each names the place of the next, and a damaged one may lead back.

tifffile follows such a chain for minutes. Format: TIFF 6.0, section 2, and BigTIFF.
"""

from __future__ import annotations

import struct
from pathlib import Path

from wavesplat.errors import FileError

#: Version of the format -> forms of an offset and of a number of entries, bytes of an entry, place of the first offset.
FORMS = {42: ("I", "H", 12, 4), 43: ("Q", "Q", 20, 8)}


def check_pages(path: Path) -> None:
    """Raise a `FileError` if the chain of pages comes back to a page. What else is wrong, tifffile says."""
    with path.open("rb") as file:
        head = file.read(4)
        order = {b"II": "<", b"MM": ">"}.get(head[:2])
        if order is None or len(head) < 4:
            return
        form = FORMS.get(struct.unpack(f"{order}H", head[2:])[0])
        if form is None:
            return
        offset_form, count_form, entry_bytes, place = form
        seen: set[int] = set()
        while True:
            file.seek(place)
            found = file.read(struct.calcsize(offset_form))
            if len(found) < struct.calcsize(offset_form):
                return
            (offset,) = struct.unpack(order + offset_form, found)
            if offset in seen:
                raise FileError(f"damaged: its pages lead in a circle; copy or export it again: {path}")
            if not 0 < offset < 1 << 62:
                return
            seen.add(offset)
            file.seek(offset)
            count = file.read(struct.calcsize(count_form))
            if len(count) < struct.calcsize(count_form):
                return
            place = offset + len(count) + struct.unpack(order + count_form, count)[0] * entry_bytes
            if place >= 1 << 62:
                return
