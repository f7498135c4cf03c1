"""The fixtures that the cameras of the viewer's page are held to."""

import importlib.util
from pathlib import Path

TOOL = Path(__file__).parents[1] / "tools" / "make_viewer_cameras.py"


def test_the_fixtures_are_those_of_python():
    spec = importlib.util.spec_from_file_location("make_viewer_cameras", TOOL)
    tool = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(tool)
    assert tool.PATH.read_text(encoding="utf-8") == tool.text()
