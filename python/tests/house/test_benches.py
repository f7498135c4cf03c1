"""The scenes that `make bench` may draw, and the decision on its goals."""

import re
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[3]


@pytest.fixture(scope="module")
def goals():
    with pytest.MonkeyPatch.context() as patch:
        patch.syspath_prepend(ROOT / "benches")
        import goals

        yield goals
    for name in ("goals", "growth", "scenes"):
        del sys.modules[name]


def test_what_is_drawn_is_asked_for_by_name(goals):
    cases = goals.scenes.cases()
    assert [case.label for case in cases for how in case.settings if len({"quality", "psnr"} & how.keys()) != 1] == []
    tuned = [case for case in cases for how in case.settings if {"sheets_per_slice", "oversampling"} & how.keys()]
    assert [case.change for case in tuned] == ["twice the sheets"]
    of_goals = [case for case in cases if case.group == goals.GROUP]
    assert [case.settings for case in of_goals] == 6 * [[{"quality": "normal"}, {"quality": "high"}]]


def rows_of(goals, speedups, gains_db):
    """Rows of all cases of the goals at quality normal, from VTK's time over ours, and our PSNR less VTK's."""
    cases = [case for case in goals.scenes.cases() if case.group == goals.GROUP]
    for case, speedup, gain_db in zip(cases, speedups, gains_db, strict=False):
        yield case, "wavesplat", {"quality": "normal"}, {"cpu_ms": 10.0, "psnr_db": 40.0 + gain_db}
        yield case, "vtk", {"sample_distance": 1.0}, {"cpu_ms": 10.0 * speedup, "psnr_db": 40.0}


@pytest.mark.parametrize(
    ("speedups", "gains_db", "wanted"),
    [
        ([9, 2, 8, 4, 7, 1], [0] * 6, "goal 5, met; VTK takes 5.5 times our CPU time, the median of 1.0 to 9.0"),
        ([9, 2, 8, 4, 5, 1], [1] * 6, "goal 5, missed; VTK takes 4.5 times"),
        ([9, 2, 8, 4, 7, 1], [-1, 0, 0, 0, 0, 0], "missed; VTK takes 4.0 times our CPU time, the median of 1.0 to 8.0"),
        ([9, 2, 8, 4, 7, 1], [-1, 0, 0, 0, 0, 0], "not counted, since VTK's PSNR is higher: engine soft (39.0 dB,"),
        ([9] * 6, [-1] * 6, "goal 5, missed; not counted"),
        ([9] * 4, [1] * 4, "goal 5, not decided, without our or VTK's frame of ct hard, mri hard; VTK takes 9.0 times"),
    ],
)
def test_a_goal_is_a_median_over_the_cases_of_equal_quality(goals, speedups, gains_db, wanted):
    text = goals.verdict("normal", 5.0, list(rows_of(goals, speedups, gains_db)))
    assert wanted in text, text


def test_without_cases_of_the_goals_there_is_no_verdict(goals):
    other = next(case for case in goals.scenes.cases() if case.group != goals.GROUP)
    assert goals.verdicts([(other, "wavesplat", {"quality": "normal"}, {"cpu_ms": 1.0})]) == []


@pytest.mark.parametrize("table", ["quality", "bench"])
def test_recorded_tables_have_their_place(table):
    # The commands that write the tables replace the text between these marks.
    page = (ROOT / "benches" / "README.md").read_text(encoding="utf-8")
    assert len(re.findall(rf"<!-- {table} -->\n.*\n<!-- /{table} -->", page, re.DOTALL)) == 1


@pytest.mark.parametrize("page", ["README.md", "benches/README.md", "studies/lod/RESULTS.md"])
def test_links_lead_to_files(page):
    path = ROOT / page
    links = re.findall(r"\]\(([^)#:]+)\)", path.read_text(encoding="utf-8"))
    assert [link for link in links if not (path.parent / link).exists()] == []
