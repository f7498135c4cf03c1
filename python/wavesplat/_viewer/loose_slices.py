"""Slices that were sent without a folder: they are moved into one, whose name the page shows.

Without it their folder would be that of the upload, which has a number for a name.
"""

from __future__ import annotations

import os
from collections.abc import Sequence
from itertools import takewhile
from pathlib import Path

from wavesplat._readers.dicom_header import header_of

#: Headers that are read to see whether all slices are of one series, and letters of a name, at most.
MAX_HEADERS, MAX_LETTERS = 16, 60
#: Name of slices whose files have nothing in common.
NAMELESS = "slices"


def gathered(files: Sequence[Path], folder: Path) -> Path:
    """The folder that holds some files of an upload; where it is that of the upload itself, they get one of their own.

    files : two or more. folder : of the upload.
    """
    common = Path(os.path.commonpath([file.parent for file in files]))
    if common != folder:
        return common
    made = _free(folder / (_description(files) or _common_start(files) or NAMELESS))
    for file in files:
        place = made / file.relative_to(folder)
        place.parent.mkdir(mode=0o700, parents=True, exist_ok=True)
        file.rename(place)
    return made


def _free(place: Path) -> Path:
    """A place beside others that is not taken."""
    number, wanted = 2, place
    while place.exists():
        number, place = number + 1, wanted.with_name(f"{wanted.name} {number}")
    return place


def _description(files: Sequence[Path]) -> str:
    """The description of the series (DICOM) that all of some files have; "" without one."""
    step = -(-len(files) // MAX_HEADERS)
    found = set[str]()
    for file in files[::step]:
        try:
            header = header_of(file)
        except Exception:  # noqa: BLE001 - parsers of damaged files raise nearly anything; the reader says what is wrong
            return ""
        found.add("" if header is None else _as_name(header.description))
    return found.pop() if len(found) == 1 else ""


def _common_start(files: Sequence[Path]) -> str:
    """The beginning of all names without the numbers at its end, at least two letters of it."""
    stems = sorted(file.stem for file in files)
    # What the first and the last one have in common in the order of letters, all between them have.
    same = takewhile(lambda pair: pair[0] == pair[1], zip(stems[0], stems[-1], strict=False))
    start = "".join(letter for letter, _ in same).rstrip("0123456789 ._-")
    return _as_name(start) if len(start) > 1 else ""


def _as_name(text: str) -> str:
    """The text as the name of a folder on any system."""
    plain = "".join(letter if letter.isalnum() or letter in " ._-+()" else " " for letter in text)
    return " ".join(plain.split())[:MAX_LETTERS].strip(" .")
