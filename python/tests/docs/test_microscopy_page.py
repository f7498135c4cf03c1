"""The page docs/microscopy.md: its blocks run, in order, and print what its comments say."""

from __future__ import annotations

import contextlib
import io
import re
import warnings

import numpy as np
import pages
import pytest
import tifffile

PAGE = pages.ROOT / "docs" / "microscopy.md"


@pytest.mark.nightly  # by day: `test_named_in_blocks.py`, and the tests of ImageJ files
def test_its_blocks_run(tmp_path, monkeypatch, wavesplat):
    pytest.importorskip("matplotlib")
    monkeypatch.chdir(tmp_path)
    said, names = io.StringIO(), {}
    with warnings.catch_warnings(), contextlib.redirect_stdout(said):
        warnings.simplefilter("error")
        pages.run(PAGE, pages.blocks_of(PAGE), wavesplat, tmp_path, names)
    told = re.findall(r"print\(.*\)  # (.*)", PAGE.read_text(encoding="utf-8"))
    assert said.getvalue().split("\n")[: len(told)] == told
    # The letter is the right way up in both; the view shows what there is of it, without the empty rows around it.
    letter = _box_of(names["letter"][0] > 0)
    for name in ("f_slice.png", "f_view.png"):
        seen = _box_of(_grey(tmp_path / name) > 380)
        rows, columns = (
            (2 * np.arange(n) + 1) * shown // (2 * n) for n, shown in zip(letter.shape, seen.shape, strict=True)
        )
        assert (seen[np.ix_(rows, columns)] == letter).mean() > 0.9  # 0.74 and less where it is flipped
    with tifffile.TiffFile(tmp_path / "measured.tif") as tiff:
        assert tiff.imagej_metadata["unit"] == "um"


def _box_of(mask):
    """The part of a mask that has all of what it shows."""
    rows, columns = (np.flatnonzero(mask.any(axis=axis)) for axis in (1, 0))
    return mask[rows[0] : rows[-1] + 1, columns[0] : columns[-1] + 1]


def _grey(path):
    from PIL import Image

    with Image.open(path) as picture:
        return np.asarray(picture.convert("RGB"), float).sum(axis=2)
