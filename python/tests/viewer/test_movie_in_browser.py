"""A movie plays in Chromium, from its first frame to its last, in the colours of the pictures."""

import browser
import numpy as np
import pytest
from cases_of_the_day import nightly

import wavesplat as ws

pytest.importorskip("av")
pytestmark = pytest.mark.skipif(browser.chromium() is None, reason="no Chromium: apt-get install chromium")


# By day one kind of video plays.
@pytest.mark.parametrize("suffix", [".mp4", *nightly(".webm")])
def test_a_turn_plays_in_chromium(tmp_path, suffix):
    volume, look, n = ws.examples.ripples(24), ws.TransferFunction.from_colormap("viridis", clim=(0, 255)), 12
    turn = ws.Turn(frames=n, elevation=20)
    # The height is odd, as those of figures may be.
    path = ws.movie(volume, tmp_path / f"turn{suffix}", turn, look, size=(64, 49), fps=24, crf=8)
    facts = browser.played(path)
    assert "error" not in facts, facts
    assert facts["size"] == [64, 50]
    assert facts["seconds"] == pytest.approx(n / 24, abs=0.05)
    assert facts["frames"] >= n - 1  # a busy machine may drop one
    shown = np.array(facts["first"], float).reshape(50, 64, 4)[:49, :, :3]
    pattern = ws.movie(volume, tmp_path / "frames", turn, look, size=(64, 49), fps=24)
    from PIL import Image

    drawn = np.asarray(Image.open(pattern.parent / "0000.png").convert("RGB"), float)
    np.testing.assert_allclose(shown.mean(axis=(0, 1)), drawn.mean(axis=(0, 1)), atol=3)
    assert np.abs(shown - drawn).mean() < 6
