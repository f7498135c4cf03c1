"""The page docs/radiology.md: its blocks run, and its tables say what the package does."""

from __future__ import annotations

import re
import warnings

import pages
import pytest

from wavesplat._looks.presets import catalogue
from wavesplat._readers.opening import SUFFIXES
from wavesplat._render.windows import CT_WINDOWS

PAGE = pages.ROOT / "docs" / "radiology.md"
TEXT = PAGE.read_text(encoding="utf-8")


def _section(name):
    return TEXT.split(f"## {name}\n")[1].split("\n## ")[0]


@pytest.mark.nightly  # by day: `test_named_in_blocks.py`, and the tests of meshes, slices and labels
def test_its_blocks_run(tmp_path, monkeypatch, wavesplat):
    monkeypatch.chdir(tmp_path)
    names = {}
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        pages.run(PAGE, pages.blocks_of(PAGE), wavesplat, tmp_path, names)
    made = {path.name for path in tmp_path.iterdir()}
    assert {"urinary_bladder.stl", "kidney_right.stl", "kidney.glb", "hippocampi.3mf", "planes.png"} <= made
    # The bladder is a ball of 36 mm.
    assert abs(names["volumes_ml"]["urinary_bladder"] / (4 / 3 * 3.14159 * 3.6**3) - 1) < 0.02


def test_its_windows_are_those_of_the_package():
    rows = re.findall(r"^\| `([a-z-]+)` \| (-?\d+) \| (\d+) \|$", _section("Windows"), re.MULTILINE)
    assert {name: (float(level), float(width)) for name, level, width in rows} == CT_WINDOWS


def test_its_presets_exist():
    named = set(re.findall(r"`((?:ct|mr|pet)-[a-z-]+)`", _section("Which look for which scan")))
    assert len(named) >= 12
    assert named <= set(catalogue())


def test_its_formats_are_read():
    suffixes = {one.lower() for one in re.findall(r"`(\.[A-Za-z0-9.]+)`", _section("Formats"))}
    known = set(SUFFIXES) | {".seg.nrrd"}
    assert suffixes <= known
    medical = {one for one, family in SUFFIXES.items() if family in ("nifti", "neuroimaging", "itk")}
    assert medical - {".img.gz"} <= suffixes
