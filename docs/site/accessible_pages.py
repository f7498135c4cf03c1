"""Mend built pages for those who hear them read: what Sphinx and the theme write against the rules of HTML.

- Sphinx writes long signatures as `<dl>` with descriptions and no terms; they are lists, and are given that role.
- The theme's button of search shows its keys, which its label must have, too; without a label it is its text.
"""

# ruff: noqa: INP001 - a script, not a package
from __future__ import annotations

import re
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from sphinx.application import Sphinx

PARAMETERS = re.compile(r"<dl>\n((?:<dd>(?:(?!</?d[dlt]>).)*</dd>\n)+)</dl>")
BUTTON = re.compile(r'(<button [^>]*\bsearch-button-field\b[^>]*?) aria-label="Search"')


def setup(app: Sphinx) -> dict[str, Any]:
    """Connect to Sphinx, after the pages are written."""
    app.connect("build-finished", mend_pages)
    return {"parallel_read_safe": True, "parallel_write_safe": True}


def mend_pages(app: Sphinx, exception: Exception | None) -> None:
    """Mend every page of a build that did not fail."""
    if exception is None:
        for path in Path(app.outdir).rglob("*.html"):
            text = path.read_text(encoding="utf-8")
            if (better := mended(text)) != text:
                path.write_text(better, encoding="utf-8")


def mended(text: str) -> str:
    """The text of a page as it should be."""
    text = PARAMETERS.sub(lambda found: f'<dl role="list">\n{_as_items(found[1])}</dl>', text)
    return BUTTON.sub(r"\1", text)


def _as_items(descriptions: str) -> str:
    return descriptions.replace("<dd>", '<dd role="listitem">')
