"""Links of pages to folders of the checkout, and to files that are no pages.

On the web page of a repository a link to a folder lists it; a site has no such lists.
"""

# ruff: noqa: INP001 - a script, not a package
from __future__ import annotations

import posixpath
from typing import Any

from docutils import nodes
from sphinx.addnodes import pending_xref
from sphinx.application import Sphinx

#: The page for each folder that pages link to; with None the link is shown as text.
PAGES = {
    ".github/ISSUE_TEMPLATE": None,
    "benches/records": "docs/site/benchmarks",
    "crates/wavesplat": None,
    "docs/design": "docs/site/method",
}


def setup(app: Sphinx) -> dict[str, Any]:
    """Connect to Sphinx, before links are resolved."""
    app.connect("doctree-read", mend_links)
    return {"parallel_read_safe": True, "parallel_write_safe": True}


def mend_links(app: Sphinx, tree: nodes.document) -> None:
    """Lead links to folders to the page for each, and show those to files that are no pages as text."""
    for link in list(tree.findall(pending_xref)):
        if link["reftype"] != "myst":
            continue
        if link["refdomain"] == "doc":
            page = link["reftarget"]
        else:
            folder = posixpath.normpath(posixpath.join(posixpath.dirname(link["refdoc"]), link["reftarget"]))
            if folder not in PAGES:
                continue
            page = PAGES[folder]
            link["refdomain"], link["reftarget"], link["reftargetid"] = "doc", page, None
        if page not in app.env.found_docs:
            link.replace_self(nodes.inline("", "", *link.children))
