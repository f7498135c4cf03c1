"""Look for dead links inside of a built site: to pages, to places in them, to pictures and files.

`python docs/site/check_links.py out/site` prints a line for each, and fails if there is one. Addresses of the web are
left alone.
"""

# ruff: noqa: INP001 - a script, not a package
from __future__ import annotations

import sys
from html.parser import HTMLParser
from pathlib import Path
from typing import NamedTuple
from urllib.parse import unquote, urldefrag, urlsplit


class Page(NamedTuple):
    """A page: the addresses that it names, and the names of places in it."""

    links: set[str]
    places: set[str]


class Parser(HTMLParser):
    """Collector of the addresses and places of a page."""

    def __init__(self) -> None:
        super().__init__()
        self.page = Page(set(), set())

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        """Take note of an element."""
        del tag
        for name, value in attrs:
            if value and name in ("href", "src"):
                self.page.links.add(value)
            elif value and name in ("id", "name"):
                self.page.places.add(value)


def main(folder: Path) -> int:
    """Check the pages of a folder; return the number of dead links."""
    # Pages of Rust are checked by rustdoc.
    left_out = {"_static", "rust"}
    found = [path for path in sorted(folder.rglob("*.html")) if not left_out & set(path.relative_to(folder).parts)]
    pages = {path.resolve(): read(path) for path in found}
    if not pages:
        sys.exit(f"{folder} has no pages; build it by `make site`")
    dead = [fault for path, page in pages.items() for fault in dead_links(path, page, pages)]
    print("\n".join(dead) if dead else f"{len(pages)} pages, no dead link inside")
    return len(dead)


def read(path: Path) -> Page:
    """The addresses and places of a page."""
    parser = Parser()
    parser.feed(path.read_text(encoding="utf-8"))
    return parser.page


def dead_links(path: Path, page: Page, pages: dict[Path, Page]) -> list[str]:
    """A line for each address in a page that leads nowhere."""
    found = []
    for link in sorted(page.links):
        if urlsplit(link).scheme or link.startswith("//"):
            continue
        address, place = urldefrag(link)
        target = (path.parent / unquote(urlsplit(address).path)).resolve() if address else path
        if not target.exists():
            found.append(f"{path}: {link} is not there")
        elif place and target in pages and unquote(place) not in pages[target].places:
            found.append(f"{path}: {link}: there is no such place on the page")
    return found


if __name__ == "__main__":
    sys.exit(1 if main(Path(sys.argv[1])) else 0)
