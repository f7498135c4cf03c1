"""NRRD files with an axis of kind "time", beside three whose place in space is given.

ITK takes such an axis for one of space, and refuses the file, or takes the wrong one for time. An axis of kind "list"
is that of the components of a sample for ITK, wherever it stands; so ITK is handed a header that says so.
"""

from __future__ import annotations

import re
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

__all__ = ["is_time_axis", "seen_as_list"]

#: A field of the format, and not a key of the same name (`kinds:=...`).
FIELD = r"(?mi)^[ \t]*{}[ \t]*:(?!=)[ \t]*(.*?)\r?$"
MOST_HEADER_BYTES = 1 << 16


def is_time_axis(fields: dict[str, str]) -> bool:
    """Whether one of four axes is of kind time and none of space. A space such as RAS-time has it as its fourth."""
    kinds = fields.get("kinds", "").lower().split()
    return len(kinds) == 4 and kinds.count("time") == 1 and not fields.get("space", "").lower().endswith("-time")


@contextmanager
def seen_as_list(path: Path, fields: dict[str, str]) -> Iterator[Path]:
    """The file for ITK: itself or, where it has such an axis, a header beside it for as long as it is read."""
    if not is_time_axis(fields):
        yield path
        return
    with path.open("rb") as file:
        start = file.read(MOST_HEADER_BYTES)
    end = re.search(rb"\r?\n\r?\n", start)
    text = (start[: end.end()] if end else start).decode("latin-1")
    folder = path.parent.absolute()
    kinds = re.search(FIELD.format("kinds"), text)
    named = re.search(FIELD.format("data ?file"), text)
    lines = [line for line in text.splitlines() if line]
    if kinds is not None:
        at = next(number for number, line in enumerate(lines) if re.match(FIELD.format("kinds"), line))
        lines[at] = f"kinds: {re.sub('(?i)time', 'list', kinds[1])}"
    if named is not None:
        at = next(number for number, line in enumerate(lines) if re.match(FIELD.format("data ?file"), line))
        lines[at] = f"data file: {folder / named[1].strip()}"
    else:
        lines = [line for line in lines if not re.match(FIELD.format("line ?skip"), line)]
        skipped = re.search(FIELD.format("line ?skip"), text)
        n_lines = text.count("\n") + int(skipped[1] if skipped else 0)
        lines += [f"line skip: {n_lines}", f"data file: {folder / path.name}"]
    with tempfile.TemporaryDirectory() as made:
        header = Path(made) / "header.nhdr"
        header.write_text("\n".join(lines) + "\n\n", encoding="latin-1", errors="surrogateescape", newline="\n")
        yield header
