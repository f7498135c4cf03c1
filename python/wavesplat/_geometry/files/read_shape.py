"""Questions to readers of surfaces, lines and points, and their answers."""

from __future__ import annotations

from pathlib import Path
from typing import Any, NamedTuple


class Asked(NamedTuple):
    """A question to a reader: the path of a file, the values of vertices or points by name, and the kind of shape."""

    file: Path
    values: str | None = None
    kind: str | None = None
    #: The folder of the document that names the file, in which all that is read must lie; None: the user names it.
    within: Path | None = None


class ReadShape(NamedTuple):
    """A shape in a file: its kind, the fields that it is made with, and what was assumed."""

    kind: str
    fields: dict[str, Any]
    #: Unit of the positions, where the file or its format says it.
    unit: str | None = None
    #: Assumptions where the file says nothing, and what was done to its numbers; a sentence each.
    guesses: tuple[str, ...] = ()
    #: File that the values of the vertices come from, of a surface in another.
    values_from: Path | None = None
