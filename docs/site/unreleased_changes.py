"""Extension that shows the notes of `changes/` on the page of the changelog, whose file only names the folder."""

# ruff: noqa: INP001 - a script, not a package
from __future__ import annotations

import runpy
from pathlib import Path
from typing import Any

from sphinx.application import Sphinx

ROOT = Path(__file__).resolve().parents[2]
INSTEAD_OF = "See `changes/`."


def setup(app: Sphinx) -> dict[str, Any]:
    """Listen for pages that are read."""
    app.connect("source-read", show_notes)
    return {"parallel_read_safe": True, "parallel_write_safe": True}


def show_notes(app: Sphinx, page: str, source: list[str]) -> None:
    """Put the notes into the text of the changelog."""
    if page != "CHANGELOG":
        return
    for path in (ROOT / "changes").glob("*.md"):
        app.env.note_dependency(str(path))
    notes = runpy.run_path(str(ROOT / "python" / "tools" / "changelog.py"))["section"](ROOT)
    source[0] = source[0].replace(INSTEAD_OF, notes)
