"""Tables as text and as Markdown; for the studies."""

# ruff: noqa: INP001 - scripts, not a package
from __future__ import annotations

from collections.abc import Sequence

#: A heading and the lines below it.
Table = Sequence[Sequence[str]]


def as_text(lines: Table) -> str:
    """A table as text, its columns padded with blanks."""
    widths = [max(len(line[i]) for line in lines) for i in range(len(lines[0]))]
    return "\n".join("  ".join(cell.ljust(width) for cell, width in zip(line, widths, strict=True)) for line in lines)


def as_markdown(lines: Table) -> str:
    """A Markdown table."""
    heading, *body = ["| " + " | ".join(line) + " |" for line in lines]
    return "\n".join([heading, "|" + " --- |" * len(lines[0]), *body])
