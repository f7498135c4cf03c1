"""Pages of the documentation whose blocks run, in order."""

from __future__ import annotations

import warnings

import pages
import pytest

PAGES = [
    "dicom.md",
    "gpu.md",
    "ome_zarr.md",
    "report.md",
    "movies.md",
    "channels_and_time.md",
    "scenes.md",
    "radiotherapy.md",
    "coming_from.md",
    "coming_from_paraview.md",
    "coming_from_slicer.md",
    "simulations.md",
    "geometry.md",
    "accuracy.md",
    "privacy.md",
    "faq.md",
]


@pytest.mark.parametrize("name", PAGES)
def test_all_blocks_of_a_page_run(name, tmp_path, monkeypatch, wavesplat):
    monkeypatch.chdir(tmp_path)
    page = pages.ROOT / "docs" / name
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        pages.run(page, pages.blocks_of(page), wavesplat, tmp_path, {})


def test_blocks_are_found(tmp_path):
    page = tmp_path / "a.md"
    page.write_text("```python\na = 1\n```\n## One\ntext\n```sh\nwavesplat info x\n\n```\n### Two\n```\n## no\n```\n")
    assert pages.blocks_of(page) == [
        ("", "python", "a = 1", 1),
        ("One", "sh", "wavesplat info x\n", 6),
        ("One", "", "## no", 11),
    ]


def test_what_fails_is_said(tmp_path, wavesplat):
    block = pages.Block("", "sh", "wavesplat info none.nii", 7)
    with pytest.raises(AssertionError, match=r"(?s)a\.md, line 7: wavesplat info none\.nii.*no such file"):
        pages.run(tmp_path / "a.md", [block], wavesplat, tmp_path, {})
    with pytest.raises(AssertionError, match="no command of ours"):
        pages.run(tmp_path / "a.md", [block._replace(code="rm x")], wavesplat, tmp_path, {})
