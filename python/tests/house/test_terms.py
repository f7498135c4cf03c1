"""Terms of the field and files are found by search: terms where they are implemented, files that texts name."""

from __future__ import annotations

import re
import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[3]
DOCS = ("docs/glossary.md", "README.md")
NAMED_FILE = re.compile(r"`((?:\w+/)*\w+\.(?:py|rs|ts|tsx|wgsl))`")

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


def test_files_that_texts_name_exist():
    """Names and ends of paths in backticks, in code and docs: files that move leave none behind."""
    listed = subprocess.check_output(["git", "-C", ROOT, "ls-files", "-co", "--exclude-standard"], encoding="utf-8")
    files = [f"/{path}" for path in listed.splitlines() if (ROOT / path).is_file()]
    ends = {path[place:] for path in files for place, letter in enumerate(path) if letter == "/"}
    texts = [path for path in files if path.endswith((".py", ".rs", ".ts", ".tsx", ".md")) and "/client/" not in path]
    named = {(path, name) for path in texts for name in NAMED_FILE.findall((ROOT / path[1:]).read_text("utf-8"))}
    assert len(named) > 200
    # `core/picture.rs` is `crates/core/src/picture.rs`.
    missing = {one for one in named if not {f"/{one[1]}", "/" + one[1].replace("/", "/src/", 1)} & ends}
    assert missing == set()
