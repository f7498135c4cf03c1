"""Definitions say what they define: no doc comment begins with an ellipsis."""

from pathlib import Path

import pytest
from first_words import ellipses, sources


def test_no_definition_begins_with_an_ellipsis():
    assert ellipses(sources()) == []


@pytest.mark.parametrize(
    ("name", "text", "n"),
    [
        ("a.rs", "/// What is left.\n/// Those of it.\nfn a() {}\n\n//! Theirs.\n", 2),
        ("a.rs", "/// The rest of the slab.\nfn a() {} // What is this\n", 0),
        ("a.wgsl", "// Of it.\nfn a() {}\n", 1),
        ("a.ts", "/** As those of the page. */\nconst a = 1;\n/** Whatever. */\n", 1),
        ("a.py", '"""What is here."""\n\n#: That of a.\nA = 1\n\n\ndef a():\n    """Those."""\n', 3),
    ],
)
def test_it_is_found(tmp_path: Path, name: str, text: str, n: int):
    path = tmp_path / name
    path.write_text(text)
    assert len(ellipses([path])) == n
