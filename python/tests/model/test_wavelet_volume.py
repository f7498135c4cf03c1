"""Volumes of wavelet coefficients: the coefficients that are kept, and the decoded samples."""

from __future__ import annotations

import copy
import pickle
import subprocess
import sys

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
    """The method's paper keeps 19.95 % of the ripples at threshold 12."""
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


def test_levels_and_bands(ct):
    wavelets = ws.WaveletVolume.from_volume(ct, "cdf53", threshold=5)
    n = wavelets.n_levels
    whole = wavelets.to_volume().samples.astype(float)
    only = lambda level: [float(k == level) for k in range(n + 1)]  # noqa: E731
    parts = [wavelets.bands(only(level)).to_volume().samples for level in range(n + 1)]
    assert np.allclose(sum(parts), whole, atol=1e-2)
    dropped = wavelets.level(2).to_volume().samples
    assert np.allclose(dropped, sum(parts[2:]), atol=1e-2)
    details = wavelets.bands([1] * n + [0])
    assert details.is_detail
    assert not wavelets.is_detail
    assert details.value_range[0] < 0 < details.value_range[1]
    assert details.value_range == details.to_volume().value_range
    assert wavelets.value_range == wavelets.to_volume().value_range
    assert np.allclose(details.bands([2]).to_volume().samples, sum(parts[:n]) + parts[0], atol=1e-2)


@pytest.mark.parametrize(("family", "keep"), [("cdf53", 1.0), ("cdf97", 1.0), ("cdf97", 0.03), ("haar", 0.03)])
def test_memory_is_that_of_what_is_kept(ct, family, keep):
    """At shares that are worth storing, most of the memory is the coefficients, 4 bytes each."""
    wavelets = ws.WaveletVolume.from_volume(ct, family, keep=keep)
    assert 4 * sum(wavelets.kept_by_level) < wavelets.nbytes < 3 * 4 * sum(wavelets.kept_by_level)


def test_the_shares_of_the_paper_fit_into_three_times_their_bytes(ct):
    for volume, keep in [(ct, 0.0355), (ws.examples.mri_head(), 0.0127)]:
        wavelets = ws.WaveletVolume.from_volume(volume, keep=keep)
        assert wavelets.kept_fraction == pytest.approx(keep, rel=1e-3)
        assert wavelets.nbytes <= 3 * 4 * sum(wavelets.kept_by_level)


@pytest.mark.skipif(sys.platform != "linux", reason="the peak of memory is read from /proc")
def test_analysis_takes_one_copy_of_the_samples():
    script = """
import pathlib
import numpy as np
import wavesplat as ws
def peak_bytes():
    status = pathlib.Path("/proc/self/status").read_text()
    return 1024 * int(status.split("VmHWM:")[1].split()[0])
samples = np.zeros((256, 256, 256), np.uint8)
samples[::3, ::5] = 200
volume = ws.Volume(samples)
before = peak_bytes()
ws.WaveletVolume.from_volume(volume, keep=0.03)
print((peak_bytes() - before) / (4 * samples.size))
"""
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True)
    assert 0.9 < float(done.stdout) < 1.4


@pytest.mark.parametrize("how", [copy.copy, copy.deepcopy, lambda held: pickle.loads(pickle.dumps(held))])  # noqa: S301
def test_copies_hold_the_same(how):
    wavelets = ws.WaveletVolume.from_volume(ws.examples.ripples(20), "spline4", threshold=5).bands([2.0, 0.5])
    wavelets.cache_bytes = 1e6
    other = how(wavelets)
    assert repr(other) == repr(wavelets)
    assert other.cache_bytes == wavelets.cache_bytes == 1_000_000
    assert np.array_equal(other.world_from_index, wavelets.world_from_index)
    assert np.array_equal(other.to_volume().samples, wavelets.to_volume().samples)
    # A result that took decoding everything is not computed again.
    assert how(wavelets)._core.parts()[-1] is None
    found = wavelets._core.value_range
    assert how(wavelets)._core.parts()[-1] == found


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"family": "db4"}, "the families are haar, cdf53"),
        ({"normalisation": "max"}, "one of l2, peak"),
        ({"threshold": 1, "keep": 0.1}, "threshold and keep; give one"),
        ({"keep": 1.5}, "keep is 1.5; give a number from 0 to 1"),
        ({"psnr": float("nan")}, "psnr is nan"),
        ({"threshold": -1}, "threshold is -1.0"),
        ({"threshold": "low"}, "threshold is 'low'; give a number"),
        ({"levels": -1}, "levels is -1"),
        ({"levels": 1.5}, "levels is 1.5; give a whole number"),
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
        wavelets.level(4)
    with pytest.raises(ws.errors.ArgumentError, match="at most 4 finite numbers"):
        wavelets.bands([1] * 5)
    with pytest.raises(ws.errors.ArgumentError, match="weights of bands is 'ab'; give numbers"):
        wavelets.bands("ab")
    with pytest.raises(ws.errors.ArgumentError, match="volume: wavelet coefficients are no samples; decode them first"):
        ws.WaveletVolume.from_volume(wavelets)


@pytest.mark.parametrize("left_out", [-1, 4, 1.5, "1", None])
def test_only_levels_that_are_there_are_drawn(left_out):
    wavelets = ws.WaveletVolume.from_volume(ws.examples.ripples(8))
    with pytest.raises(ws.errors.ArgumentError, match="left_out is"):
        wavelets.level(left_out)


def test_levels_and_bands_stay_chosen():
    wavelets = ws.WaveletVolume.from_volume(ws.examples.ripples(8))
    chosen = wavelets.level(2).bands([1, 1, 0.5])
    assert (chosen.left_out, wavelets.left_out, chosen.level(1).left_out) == (2, 0, 1)
    again = pickle.loads(pickle.dumps(chosen))  # noqa: S301 - our own bytes
    assert again.left_out == 2
    np.testing.assert_array_equal(again.to_volume().samples, chosen.to_volume().samples)
    np.testing.assert_array_equal(chosen.to_volume().samples, wavelets.bands([0, 0, 0.5]).to_volume().samples)


@pytest.mark.parametrize("n_bytes", [-1, "many", float("nan"), float("inf"), None])
def test_only_numbers_of_bytes_are_kept(n_bytes):
    wavelets = ws.WaveletVolume.from_volume(ws.examples.ripples(8))
    with pytest.raises(ws.errors.ArgumentError, match="cache_bytes is"):
        wavelets.cache_bytes = n_bytes


@pytest.mark.parametrize(("dtype", "largest"), [(np.float64, 1e300), (np.float32, 3e38)])
def test_samples_too_large_for_coefficients_are_refused(dtype, largest):
    samples = np.linspace(-1, 1, 125).reshape(5, 5, 5) * largest
    with pytest.raises(ws.errors.ArgumentError, match="too large for coefficients"):
        ws.WaveletVolume.from_volume(ws.Volume(samples.astype(dtype)))


def test_levels_are_kept_as_long_as_they_fit() -> None:
    """Drawing coarse to fine, again and again, decodes each level once; all together stay below `cache_bytes`."""
    wavelets = ws.WaveletVolume.from_volume(ws.examples.ripples(32), levels=4)
    first = [wavelets._decoded(n) for n in (3, 2, 1, 0)]
    assert [wavelets._decoded(n) for n in (3, 2, 1, 0)] == first
    assert sum(level.cache_bytes for level in first) <= wavelets.cache_bytes
    for cache_bytes in (0, 1 << 16, 1 << 18):
        wavelets.cache_bytes = cache_bytes
        for n in (3, 2, 1, 0, 2, 1):
            latest = wavelets._decoded(n)
            assert wavelets._decoded(n) is latest
            assert sum(level.cache_bytes for level in wavelets._decoded_levels.values()) <= cache_bytes
    # Bands are cached like levels, and their number has no bound.
    for weight in range(9):
        wavelets.bands([weight])._decoded()
    assert len(wavelets._decoded_levels) <= 6


@pytest.mark.parametrize("family", ["cdf97", "cdf53", "haar"])
@pytest.mark.parametrize(("offset", "psnr"), [(0, 60), (1e4, 60), (-3e5, 40)])
def test_samples_far_from_zero_reach_the_psnr(family, offset, psnr, tmp_path):
    """The middle of the samples is subtracted before they become float32."""
    z, y, x = np.mgrid[-1:1:13j, -1:1:17j, -1:1:22j]
    samples = np.sin(4 * x) * np.cos(5 * y) + z + offset
    wavelets = ws.WaveletVolume.from_volume(samples, family, psnr=psnr)
    wavelets.save(tmp_path / "w.wavelets")
    for kept in (wavelets, ws.WaveletVolume.load(tmp_path / "w.wavelets"), pickle.loads(pickle.dumps(wavelets))):  # noqa: S301 - its own
        error = np.mean((kept.to_volume().samples - samples) ** 2)
        got = 10 * np.log10(np.ptp(samples) ** 2 / error)
        assert got >= psnr - 0.01
        assert wavelets.psnr == pytest.approx(got, abs=0.05)
    assert wavelets.kept_fraction < 1


@pytest.mark.parametrize(("offset", "version"), [(0, "1"), (1e4, "2")])
def test_files_say_whether_readers_must_know_the_offset(offset, version, tmp_path):
    samples = np.random.default_rng(5).normal(size=(8, 9, 10)) + offset
    wavelets = ws.WaveletVolume.from_volume(samples)
    wavelets.save(tmp_path / "w.wavelets")
    with np.load(tmp_path / "w.wavelets") as parts:
        assert parts["format"][1] == version
        assert (parts["offset"][0] != 0) == (version == "2")
    back = ws.WaveletVolume.load(tmp_path / "w.wavelets").to_volume().samples
    np.testing.assert_array_equal(back, wavelets.to_volume().samples)


def test_pickles_and_parts_keep_the_psnr_that_was_reached():
    wavelets = ws.WaveletVolume.from_volume(ws.examples.ripples(16), psnr=50)
    assert wavelets.psnr >= 50
    for part in (wavelets, wavelets.level(1), wavelets.bands([1])):
        assert part.psnr == wavelets.psnr
        assert pickle.loads(pickle.dumps(part)).psnr == wavelets.psnr  # noqa: S301 - our own bytes


def test_a_psnr_beyond_float32_is_refused():
    samples = np.random.default_rng(4).random((8, 9, 10)) + 1e6
    with pytest.raises(
        ws.errors.ArgumentError, match=r"volume .*60 dB is more than the 3\d\.\d dB .* in float32; ask for"
    ):
        ws.WaveletVolume.from_volume(samples, psnr=60)
    # Integers that float32 cannot represent, from 2^24 + 1 on; without their offset they are small.
    counts = np.arange(2**24 + 1, 2**24 + 65, dtype=np.int32).reshape(4, 4, 4)
    back = ws.WaveletVolume.from_volume(counts).to_volume().samples
    assert np.abs(back - counts.astype(np.float64)).max() <= 1
    assert ws.WaveletVolume.from_volume(counts).psnr is None
