"""The fixtures that the viewer's page is held to are those of Python."""

import importlib.util
from pathlib import Path

TOOL = Path(__file__).parents[1] / "tools" / "make_viewer_fixtures.py"


def test_the_fixtures_are_those_of_python():
    spec = importlib.util.spec_from_file_location("make_viewer_fixtures", TOOL)
    tool = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(tool)
    for name, text in tool.texts().items():
        assert (tool.SCHEMA / name).read_text(encoding="utf-8") == text
