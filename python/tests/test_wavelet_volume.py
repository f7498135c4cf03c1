"""Volumes of wavelet coefficients: what is kept, what comes back, what is drawn."""

from __future__ import annotations

import numpy as np
import pytest

import wavesplat as ws

FAMILIES = ["haar", "cdf53", "cdf97", "spline4", "bspline2", "bspline3", "bspline4"]


@pytest.fixture(scope="module")
def ct() -> ws.Volume:
    return ws.examples.ct_pelvis()


@pytest.mark.parametrize("family", FAMILIES)
@pytest.mark.parametrize("normalisation", ["l2", "peak"])
def test_with_nothing_dropped_the_volume_comes_back_in_its_place(ct, family, normalisation):
    wavelets = ws.WaveletVolume.from_volume(ct, family, normalisation=normalisation)
    back = wavelets.to_volume()
    extent = ct.value_range[1] - ct.value_range[0]
    assert np.abs(back.samples - ct.samples).max() < 1e-5 * extent
    assert np.array_equal(back.world_from_index, ct.world_from_index)
    assert wavelets.kept_fraction > 0.5
    assert sum(wavelets.kept_by_level) == round(wavelets.kept_fraction * ct.samples.size)
    assert len(wavelets.kept_by_level) == wavelets.n_levels + 1


def test_the_printed_share_is_kept():
    """19.95 % of the ripples at threshold 12, in the method's paper."""
    wavelets = ws.WaveletVolume.from_volume(ws.examples.ripples(32), "cdf53", threshold=12)
    assert 0.199 <= wavelets.kept_fraction <= 0.202
    assert wavelets.nbytes < 3 * 4 * wavelets.kept_fraction * 32**3


def test_a_psnr_and_a_share_are_kept(ct):
    wavelets = ws.WaveletVolume.from_volume(ct, psnr=45)
    error = wavelets.to_volume().samples - ct.samples.astype(float)
    extent = ct.value_range[1] - ct.value_range[0]
    assert 45 <= 10 * np.log10(extent**2 / np.mean(error**2)) < 45.5
    assert ws.WaveletVolume.from_volume(ct, keep=0.05).kept_fraction == pytest.approx(0.05, abs=1e-3)
    assert ws.WaveletVolume.from_volume(ct, keep=0.05, levels=2).n_levels == 2


@pytest.mark.parametrize("family", ["cdf53", "cdf97", "bspline3"])
def test_with_nothing_dropped_the_picture_is_that_of_the_samples(ct, family):
    colors = [(-75, 0.9, 0.6, 0.4), (1000, 1.0, 1.0, 1.0)]
    soft = ws.TransferFunction([(-75, 0.0), (255, 0.05), (1000, 0.2)], colors)
    draw = {"transfer_function": soft, "size": (96, 96)}
    wavelets = ws.WaveletVolume.from_volume(ct, family)
    want = ws.render(ct, **draw).rgba
    got = ws.render(wavelets, **draw).rgba
    assert 255 * np.abs(got - want).max() < 0.1
    assert 255 * np.abs(got - want).mean() < 0.01
    assert want[..., 3].max() > 0.9, "the picture shows something"


def test_levels_and_bands(ct):
    wavelets = ws.WaveletVolume.from_volume(ct, "cdf53", threshold=5)
    n = wavelets.n_levels
    whole = wavelets.to_volume().samples.astype(float)
    only = lambda level: [float(k == level) for k in range(n + 1)]  # noqa: E731
    parts = [wavelets.to_volume(band_weights=only(level)).samples for level in range(n + 1)]
    assert np.allclose(sum(parts), whole, atol=1e-2)
    dropped = wavelets.to_volume(drop_levels=2).samples
    assert np.allclose(dropped, sum(parts[2:]), atol=1e-2)
    picture = ws.render(wavelets, drop_levels=2, size=(48, 48)).rgba
    want = ws.render(wavelets.to_volume(drop_levels=2), size=(48, 48)).rgba
    assert np.array_equal(picture, want)
    assert not np.array_equal(picture, ws.render(wavelets, size=(48, 48)).rgba)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"family": "db4"}, "the families are haar, cdf53"),
        ({"normalisation": "max"}, "one of l2, peak"),
        ({"threshold": 1, "keep": 0.1}, "threshold and keep; give one"),
        ({"keep": 1.5}, "keep is 1.5; give a number from 0 to 1"),
        ({"psnr": float("nan")}, "psnr is nan"),
        ({"threshold": -1}, "threshold is -1.0"),
        ({"levels": -1}, "levels is -1"),
    ],
)
def test_what_cannot_work_is_refused(arguments, message):
    with pytest.raises(ws.errors.ArgumentError, match=message):
        ws.WaveletVolume.from_volume(ws.examples.ripples(8), **arguments)


def test_holes_and_levels_that_are_not_there_are_refused():
    samples = np.ones((4, 4, 4), np.float32)
    samples[1, 2, 3] = np.nan
    with pytest.raises(ws.errors.ArgumentError, match="1 samples that are NaN"):
        ws.WaveletVolume.from_volume(ws.Volume(samples))
    wavelets = ws.WaveletVolume.from_volume(ws.examples.ripples(8))
    with pytest.raises(ws.errors.ArgumentError, match="has 3 levels, so give 0 to 3"):
        wavelets.to_volume(drop_levels=4)
    with pytest.raises(ws.errors.ArgumentError, match="at most 4 finite numbers"):
        wavelets.to_volume(band_weights=[1] * 5)
    with pytest.raises(ws.errors.ArgumentError, match="are for a WaveletVolume"):
        ws.render(ws.examples.ripples(8), drop_levels=1)
