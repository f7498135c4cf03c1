"""Statistics of labels slab by slab: those of all samples at once, in little memory."""

import tracemalloc

import numpy as np
import pytest

from wavesplat._viewer.page_requests import measuring
from wavesplat._viewer.page_requests.measuring import values_of_labels

SHAPES = [(1, 1, 1), (7, 5, 3), (40, 16, 9)]


@pytest.mark.parametrize("shape", SHAPES, ids=str)
@pytest.mark.parametrize("dtype", [np.uint8, np.int16, np.float32, np.float64])
def test_slabs_have_the_statistics_of_the_whole(monkeypatch, shape, dtype):
    monkeypatch.setattr(measuring, "SLAB_SAMPLES", 200)
    random = np.random.default_rng(1)
    codes = random.integers(0, 5, shape).astype(np.uint8)
    codes[: shape[0] // 2][codes[: shape[0] // 2] == 3] = 1  # a label that the first slabs lack
    samples = random.integers(0, 250, shape).astype(dtype)
    wanted = np.array([False, True, True, True, True, True])  # the last one has no voxel
    check(values_of_labels(codes, samples, wanted), codes, samples, wanted)


def check(found, codes, samples, wanted):
    for code in range(len(wanted)):
        values = samples[codes == code].astype(np.float64) if wanted[code] else np.empty(0)
        finite = values[np.isfinite(values)]
        assert (found.n_voxels[code], found.n_finite[code]) == (values.size, finite.size)
        if finite.size:
            got = found.mean[code], found.sd[code], found.min[code], found.max[code]
            assert got == pytest.approx((finite.mean(), finite.std(), finite.min(), finite.max()), rel=1e-12, abs=1e-9)


def test_values_that_are_missing_do_not_count(monkeypatch):
    monkeypatch.setattr(measuring, "SLAB_SAMPLES", 50)
    random = np.random.default_rng(2)
    codes = random.integers(0, 3, (20, 6, 5)).astype(np.uint16)
    samples = random.normal(size=codes.shape).astype(np.float32)
    samples[random.random(codes.shape) < 0.3] = np.nan
    samples[codes == 2] = np.inf
    wanted = np.ones(3, bool)
    found = values_of_labels(codes, samples, wanted)
    check(found, codes, samples, wanted)
    assert found.n_finite[2] == 0


def test_large_means_lose_no_digits(monkeypatch):
    monkeypatch.setattr(measuring, "SLAB_SAMPLES", 1000)
    samples = 1e9 + np.random.default_rng(3).normal(size=(50, 20, 20))
    found = values_of_labels(np.zeros(samples.shape, np.uint8), samples, np.ones(1, bool))
    assert found.sd[0] == pytest.approx(samples.std(), rel=1e-6)


def test_memory_is_that_of_a_slab():
    codes = np.ones((128, 128, 256), np.uint8)
    samples = np.zeros(codes.shape, np.int16)
    tracemalloc.start()
    values_of_labels(codes, samples, np.array([False, True]))
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    # A single array of 64-bit numbers for all samples would be 8 times as many bytes.
    assert peak < 2 * samples.nbytes
    assert peak < 12 * 8 * measuring.SLAB_SAMPLES
