"""Terms of the field can be found by search: in the head of the file that implements them, and in the docs."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[3]
DOCS = ("docs/glossary.md", "README.md")

TERMS = [
    "opacity correction",
    "early ray termination",
    "empty-space skipping",
    "min-max bricks",
    "occupancy",
    "pre-integration",
    "supersampling",
    "premultiplied",
    "shear-warp",
    "transmittance",
    "trilinear",
    "isosurface",
]


def _plain(text: str) -> str:
    """Text in lower case, with a space for every break, hyphens unchanged."""
    return re.sub(r"\s+", " ", text).lower()


def _head(path: Path) -> str:
    """The comment that a file of Rust begins with."""
    lines = path.read_text(encoding="utf-8").splitlines()
    head = []
    for line in lines:
        if not line.startswith("//!"):
            break
        head.append(line.removeprefix("//!"))
    return _plain(" ".join(head))


@pytest.fixture(scope="module")
def heads():
    paths = sorted((ROOT / "crates").glob("*/src/**/*.rs"))
    assert paths
    return {path.relative_to(ROOT).as_posix(): _head(path) for path in paths}


def test_the_code_has_the_terms_where_files_begin(heads):
    assert [term for term in TERMS if not any(term in head for head in heads.values())] == []


def test_the_docs_have_the_terms():
    texts = [_plain((ROOT / name).read_text(encoding="utf-8")) for name in DOCS]
    assert [term for term in TERMS if not any(term in text for text in texts)] == []


def test_every_file_of_rust_says_what_it_is(heads):
    silent = [path for path, head in heads.items() if not head.strip()]
    assert silent == []


def test_files_that_the_glossary_names_exist():
    """`core/picture.rs` is of another crate, the others are of the renderer."""
    sources = re.findall(r"`([a-z_/]+\.rs)`", (ROOT / "docs/glossary.md").read_text("utf-8"))
    assert len(sources) > 40
    places = {one: (ROOT / "crates/splat/src" / one, ROOT / "crates" / one.replace("/", "/src/", 1)) for one in sources}
    assert [one for one, both in places.items() if not any(place.is_file() for place in both)] == []
