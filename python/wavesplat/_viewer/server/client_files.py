"""The files of the page, as the server sends them: read once, compressed once, with how long browsers may keep them."""

from __future__ import annotations

import gzip
from dataclasses import dataclass
from importlib.resources import files

#: Types of files by their suffixes.
TYPES = {"html": "text/html", "js": "text/javascript", "svg": "image/svg+xml"}
#: Scripts have the hash of their content in their names, so they never change; the page itself is always asked for.
KEPT, NOT_KEPT = "private, max-age=31536000, immutable", "no-store"


@dataclass(frozen=True)
class ClientFile:
    """A file of the page: its bytes as they are and by gzip, its type, and the header `Cache-Control`."""

    content: bytes
    compressed: bytes
    media_type: str
    cache: str


def client_files() -> dict[str, ClientFile]:
    """All files of the page by their paths in the address, "/" and "/page-HASH.js" for example."""
    folder = files("wavesplat") / "_viewer" / "client"
    found = {"/": folder / "index.html", "/favicon.svg": folder / "favicon.svg"}
    scripts = {f"/{script.name}": script for script in (folder / "page").iterdir() if script.name.endswith(".js")}
    return {
        path: _read(file.read_bytes(), file.name, is_kept=path in scripts) for path, file in (found | scripts).items()
    }


def widget_source() -> str:
    """The module that notebooks load, in one file."""
    return (files("wavesplat") / "_viewer" / "client" / "widget.js").read_text(encoding="utf-8")


def _read(content: bytes, name: str, *, is_kept: bool) -> ClientFile:
    media_type = f"{TYPES[name.rpartition('.')[2]]}; charset=utf-8"
    return ClientFile(content, gzip.compress(content, 9, mtime=0), media_type, KEPT if is_kept else NOT_KEPT)
