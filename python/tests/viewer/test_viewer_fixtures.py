"""The fixtures of the viewer's page, as committed, are those that Python writes."""

import importlib.util
import json
from pathlib import Path

import pytest

TOOL = Path(__file__).parents[2] / "tools" / "make_viewer_fixtures.py"


def leaves(value, path=()):
    """Numbers and texts of a JSON value, each with the keys that lead to it."""
    pairs = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else None
    if pairs is None:
        yield path, value
    else:
        yield path, type(value)
        for key, part in pairs:
            yield from leaves(part, (*path, key))


def test_the_fixtures_are_those_of_python():
    spec = importlib.util.spec_from_file_location("make_viewer_fixtures", TOOL)
    tool = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(tool)
    for name, text in tool.texts().items():
        kept, made = (list(leaves(json.loads(of))) for of in ((tool.SCHEMA / name).read_text(encoding="utf-8"), text))
        assert [path for path, _ in kept] == [path for path, _ in made]
        for (path, one), (_, other) in zip(kept, made, strict=True):
            # The last bits of products of matrices are other ones on other processors.
            is_number = isinstance(one, float) and isinstance(other, float)
            assert one == (pytest.approx(other, rel=1e-12, abs=1e-12) if is_number else other), path
