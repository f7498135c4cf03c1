"""Pages of the documentation whose blocks run, in order."""

from __future__ import annotations

import warnings

import pages
import pytest
from cases_of_the_day import nightly
from PIL import Image

import wavesplat as ws

PAGES = [
    "gpu.md",
    "ome_zarr.md",
    "report.md",
    "scenes.md",
    "coming_from_paraview.md",
    "accuracy.md",
    "privacy.md",
    "five_minutes.md",
    # Each of these takes several seconds. By day `test_named_in_blocks.py` checks the names, keywords, commands and
    # options in their blocks; the pages above have blocks of each language.
    *nightly(
        "dicom.md",
        "movies.md",
        "channels_and_time.md",
        "radiotherapy.md",
        "coming_from.md",
        "coming_from_slicer.md",
        "simulations.md",
        "geometry.md",
        "faq.md",
        "wrong_picture.md",
    ),
]


@pytest.mark.parametrize("name", PAGES)
def test_all_blocks_of_a_page_run(name, tmp_path, monkeypatch, wavesplat):
    monkeypatch.chdir(tmp_path)
    page = pages.ROOT / "docs" / name
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        pages.run(page, pages.blocks_of(page), wavesplat, tmp_path, {})


def test_the_python_of_the_page_on_the_viewer_runs(tmp_path, monkeypatch, wavesplat):
    """Its commands wait for a browser; the browser tests start them."""
    monkeypatch.chdir(tmp_path)
    ws.examples.ct_pelvis().save("scan.nii.gz")
    page = pages.ROOT / "docs" / "viewer.md"
    blocks = [block for block in pages.blocks_of(page) if block.language == "python"]
    assert len(blocks) == 2
    pages.run(page, blocks, wavesplat, tmp_path, {})
    with Image.open("figure.png") as figure, Image.open("axial.png") as axial:
        assert figure.size == (1600, 1200)
        assert axial.getextrema() != ((0, 0),) * 3
    assert (tmp_path / "view.json").stat().st_size > 0


def test_the_first_blocks_of_the_page_on_large_volumes_run(tmp_path, monkeypatch, wavesplat):
    """Others need a cluster (MPI has a test of its own); `view` waits for a browser."""
    monkeypatch.chdir(tmp_path)
    volumes = [ws.examples.ripples(24), ws.examples.ripples(24)]
    ws.Scene(volumes).save_volumes("embryo.ome.zarr")
    page = pages.ROOT / "docs" / "large_volumes.md"
    first, commands = pages.blocks_of(page)[:2]
    shown = "\n".join(line for line in commands.code.splitlines() if not line.startswith("wavesplat view"))
    names = {}
    pages.run(page, [first, commands._replace(code=shown)], wavesplat, tmp_path, names)
    assert names["picture"].report["lazy"] is not None
    assert (tmp_path / "embryo.png").exists()


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
