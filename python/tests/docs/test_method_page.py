"""The page docs/method.md: what it tells of the studies stands in their records."""

from __future__ import annotations

import re

import pages
import pytest

PAGE = (pages.ROOT / "docs" / "method.md").read_text(encoding="utf-8")
WAVELETS = (pages.ROOT / "studies" / "wavelets" / "RESULTS.md").read_text(encoding="utf-8")
METHOD = (pages.ROOT / "studies" / "method" / "RESULTS.md").read_text(encoding="utf-8")


def cells(text, first):
    """The cells of the row of a table that begins with `first`."""
    row = next(line for line in text.splitlines() if line.startswith(f"| {first} |"))
    return [cell.strip() for cell in row.strip("|").split("|")]


#: Rows of the study's goals, in the order of the page's columns.
GOALS = [
    cells(WAVELETS, f"{name} | cdf97") for name in ("ripples, threshold 12", "ct, printed share", "mri, printed share")
]


@pytest.mark.parametrize(
    ("row", "column", "unit"),
    [("here, at the same share or less", 2, " %"), ("here, hard functions", 8, ""), ("here, soft functions", 7, "")],
)
def test_numbers_are_those_of_the_study_of_wavelets(row, column, unit):
    rows = [line for line in PAGE.splitlines() if line.startswith(f"| {row} |")]
    told = [cell.strip() for cell in rows[-1].strip("|").split("|")][1:]
    assert told == [goal[column] + unit for goal in GOALS]


def test_numbers_are_those_of_the_study_of_splatting():
    gains = dict(re.findall(r"^- (\w+, \w+): .* \(\+([\d.]+)\)", METHOD, re.MULTILINE))
    low, high = min(gains, key=lambda name: float(gains[name])), max(gains, key=lambda name: float(gains[name]))
    assert f"{gains[low]} dB ({low.replace('mri', 'MRI')}) to {gains[high]} dB ({high})" in PAGE
    before = [float(n) for n in re.findall(r"standard splatting is ([\d.]+) dB", METHOD)]
    after = [float(n) for n in re.findall(r"in no more time ([\d.]+) dB", METHOD)]
    assert f"{min(before)} to {max(before)} dB" in PAGE
    assert f"{min(after)} to {max(after)} dB" in PAGE
    for row in ("high-resolution splatting", "the same, not corrected"):
        assert f"{cells(METHOD[METHOD.index('## Brightness') :], row)[-1]} %" in PAGE
