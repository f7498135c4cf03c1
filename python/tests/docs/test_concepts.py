"""The pages docs/concepts.md and docs/limits.md: what they tell in numbers is so."""

from __future__ import annotations

import importlib.util
import re

import pages
import pytest

from wavesplat._looks.labels.labels import MAX_LABELS
from wavesplat._model.arguments.clips import MAX_CLIPS
from wavesplat._model.arguments.sampling import MAX_SIDE_PX
from wavesplat._model.camera.path import MAX_FRAMES
from wavesplat._render.isolines import MAX_VALUES
from wavesplat._scene.documents.geometry_json import MAX_INLINE
from wavesplat._scene.scene import MAX_LAYERS
from wavesplat._scene.slices.lightbox import MAX_SLICES

DOCS = pages.ROOT / "docs"
MAX_PICTURES_BYTES = 300_000


@pytest.fixture(scope="module")
def concepts():
    spec = importlib.util.spec_from_file_location("concepts", DOCS / "concepts.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_numbers_of_the_concepts_are_those_of_their_pictures(concepts):
    page = (DOCS / "concepts.md").read_text(encoding="utf-8")
    numbers = concepts.numbers()
    assert len(numbers) == 5
    assert {what: value for what, value in numbers.items() if value not in page} == {}


def test_pictures_of_the_concepts_are_shown_and_small(concepts):
    page = (DOCS / "concepts.md").read_text(encoding="utf-8")
    files = sorted((DOCS / "concepts").iterdir())
    assert sorted(re.findall(r"\]\(concepts/(\w+\.webp)\)", page)) == [file.name for file in files]
    assert sum(file.stat().st_size for file in files) <= MAX_PICTURES_BYTES


def test_limits_are_those_of_the_code():
    page = (DOCS / "limits.md").read_text(encoding="utf-8")
    table = re.findall(r"^\| .* \| ([\d,]+) \|$", page, re.MULTILINE)
    limits = [MAX_LAYERS, MAX_LABELS, MAX_CLIPS, MAX_SIDE_PX, MAX_FRAMES, MAX_VALUES, MAX_SLICES, MAX_INLINE]
    assert [int(number.replace(",", "")) for number in table] == limits
