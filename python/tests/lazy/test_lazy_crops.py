"""Crops of pyramids: what the crop hides is not read, neither for the picture nor for its range and bounds."""

from __future__ import annotations

import numpy as np
import pytest

import wavesplat as ws
from wavesplat._model.lazy import parts as lazy_parts

SIDE, CHUNK = 160, 20


class Counted:
    """An array that counts the samples that are read of it."""

    def __init__(self, samples):
        self.samples, self.n = samples, 0
        self.shape, self.dtype, self.chunks = samples.shape, samples.dtype, (CHUNK,) * 3

    def __getitem__(self, part):
        found = self.samples[part]
        self.n += found.size
        return found


@pytest.fixture(scope="module")
def levels():
    """Noisy balls, each level with the means of eight samples of the finer one."""
    rng = np.random.default_rng(1)
    z, y, x = np.ogrid[:SIDE, :SIDE, :SIDE]
    samples = rng.normal(100, 5, (SIDE,) * 3)
    for at in rng.integers(10, SIDE - 10, (20, 3)):
        samples += 900 * np.exp(-((z - at[0]) ** 2 + (y - at[1]) ** 2 + (x - at[2]) ** 2) / 72)
    found = [samples]
    for _ in range(2):
        n = len(found[-1]) // 2
        found.append(found[-1].reshape(n, 2, n, 2, n, 2).mean((1, 3, 5)))
    return [own.astype(np.uint16) for own in found]


def crop_of(levels, side=16):
    """A box around the brightest sample, in samples."""
    at = np.array(np.unravel_index(np.argmax(levels[0]), levels[0].shape))[::-1]
    low = np.clip(at - side // 2, 0, SIDE - side)
    return ws.Crop(low, low + side, space="index")


@pytest.mark.parametrize(("kernel", "share"), [("linear", 0.5), ("bspline3", 1.0)])
def test_a_crop_is_drawn_from_its_own_chunks(levels, kernel, share):
    arrays = [Counted(own) for own in levels]
    volume, crop = ws.Volume.lazy(arrays, memory="300 MB", cache=False), crop_of(levels)
    look = ws.Look.auto(volume)
    arrays[0].n = 0
    picture = ws.render(volume, look, clip=crop, size=(64, 64), kernel=kernel)
    assert picture.report["lazy"]["levels"] == [0]
    # Up to three reads of the chunks: for the range, for coefficients and for the picture, with samples around.
    assert arrays[0].n <= share * levels[0].size
    assert arrays[1].n == 0
    in_memory = ws.render(ws.Volume(levels[0]), look, picture.camera, clip=crop, size=(64, 64), kernel=kernel)
    # Light alone sees coarser samples, beyond the crop.
    np.testing.assert_allclose(picture.rgba, in_memory.rgba, atol=1 / 255)
    assert picture.rgba[..., 3].mean() > 0.05


def test_a_crop_of_a_coarser_level_is_as_bright_as_with_all_of_it(levels, monkeypatch):
    monkeypatch.setattr(lazy_parts, "MIN_CROPPED", 1)
    arrays = [Counted(own) for own in levels]
    volume, crop = ws.Volume.lazy(arrays, memory="300 MB", cache=False).at_level(1), crop_of(levels, 16)
    look, camera = ws.Look.auto(ws.Volume(levels[0])), ws.Camera.view(volume, "xy")
    parts = ws.render(volume.at_level(None).at_level(1), look, camera, clip=crop, size=(64, 64))
    monkeypatch.setattr(lazy_parts, "MIN_CROPPED", 1 << 40)
    whole = ws.render(volume.at_level(None).at_level(1), look, camera, clip=crop, size=(64, 64))
    np.testing.assert_allclose(parts.rgba, whole.rgba, atol=2 / 255)


def test_missing_samples_in_a_crop_are_filled_as_in_memory(levels):
    holed = levels[0].astype(np.float32)
    holed[np.random.default_rng(3).random(holed.shape) < 0.01] = np.nan
    arrays = [Counted(holed), *(Counted(own.astype(np.float32)) for own in levels[1:])]
    volume, crop = ws.Volume.lazy(arrays, memory="300 MB", cache=False), crop_of(levels)
    look = ws.Look.auto(ws.Volume(levels[0]))
    arrays[0].n = 0
    picture = ws.render(volume, look, clip=crop, size=(48, 48))
    assert arrays[0].n < holed.size
    in_memory = ws.render(ws.Volume(holed), look, picture.camera, clip=crop, size=(48, 48))
    np.testing.assert_allclose(picture.rgba, in_memory.rgba, atol=1 / 255)


def test_the_plan_of_a_crop_counts_its_chunks_alone(levels):
    volume, crop = ws.Volume.lazy(levels, memory="300 MB", cache=False), crop_of(levels)
    rates = {"read_rate": "1 GB", "draw_ns": 4.0}
    whole = ws.plan(volume, size=(256, 256), **rates)
    part = ws.plan(volume, size=(256, 256), crop=crop, **rates)
    assert part.level == whole.level == 0
    assert whole.bytes_surveyed == levels[0].nbytes
    assert part.bytes_surveyed < levels[0].nbytes / 2
    assert part.bytes_read < whole.bytes_read / 4
