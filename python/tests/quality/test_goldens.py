"""Golden pictures, drawn at the last release, or at the last commit that changed them on purpose (`make golden`)."""

from __future__ import annotations

import golden_scenes
import numpy as np
import pytest
from golden_scenes import FAILURES, GOLDENS, MAX_BYTES, MAX_PIXELS, SCENES, difference, path_of, png

import wavesplat as ws


@pytest.mark.parametrize("name", SCENES)
def test_pictures_are_those_of_before(name):
    want = path_of(name).read_bytes() if path_of(name).exists() else None
    wrong = difference(name, want, png(SCENES[name]()), FAILURES)
    assert wrong is None, wrong


def test_goldens_are_few_and_small_and_none_is_left_over():
    files = sorted(GOLDENS.iterdir())
    assert [path.name for path in files] == sorted(path_of(name).name for name in SCENES)
    for path in files:
        assert path.stat().st_size <= MAX_BYTES, path
        assert max(golden_scenes._levels(path.read_bytes()).shape) <= MAX_PIXELS, path


# Tests that the comparison can fail.


def _png(levels):
    return png(ws.Picture((np.asarray(levels) / 255).astype(np.float32)))


@pytest.fixture
def grey():
    return np.full((6, 8, 4), (100, 100, 100, 255))


@pytest.mark.parametrize("by", [-1, 0, 1])
def test_a_level_is_rounding(grey, tmp_path, by):
    assert difference("grey", _png(grey), _png(np.add(grey, (0, by, 0, 0))), tmp_path) is None
    assert list(tmp_path.iterdir()) == []


def test_two_levels_of_one_channel_of_one_pixel_are_not(grey, tmp_path):
    other = grey.copy()
    other[4, 5, 2] += 2
    wrong = difference("grey", _png(grey), _png(other), tmp_path)
    assert "1 of 48 pixels differ by more than 1 of 255 levels, by 2 at row 4, column 5" in wrong
    assert "[100, 100, 102, 255] instead of [100, 100, 100, 255]" in wrong
    names = ["grey.difference.png", "grey.got.png", "grey.want.png"]
    assert sorted(path.name for path in tmp_path.iterdir()) == names
    shown = golden_scenes._levels((tmp_path / "grey.difference.png").read_bytes())
    assert shown[4, 5].tolist() == [0, 0, 254, 255]
    assert shown[..., :3].sum() == 254


def test_a_missing_golden_and_one_of_another_size_fail(grey, tmp_path):
    assert "there is no golden picture" in difference("grey", None, _png(grey), tmp_path)
    assert [path.name for path in tmp_path.iterdir()] == ["grey.got.png"]
    wrong = difference("grey", _png(grey[:5]), _png(grey), tmp_path)
    assert "shape (5, 8, 4), this one (6, 8, 4)" in wrong
