"""Automatic looks and cameras of lazy volumes are those of the same samples in memory (F10)."""

from __future__ import annotations

import numpy as np
import pytest
from lazy_fakes import Chunked

import wavesplat as ws
from wavesplat._looks.kinds.kinds import evidence
from wavesplat._model.lazy.survey import LookSamples

#: Of more samples than looks take, so that they are thinned, and by steps that divide no side.
SHAPE = (151, 140, 133)


def _radius():
    z, y, x = np.ogrid[-1 : 1 : 1j * SHAPE[0], -1 : 1 : 1j * SHAPE[1], -1 : 1 : 1j * SHAPE[2]]
    return np.sqrt(z * z + y * y + x * x), x, y, z


def _made(kind):
    radius, x, y, z = _radius()
    if kind == "shell":
        return 200 * np.exp(-(((radius - 0.6) / 0.1) ** 2))
    if kind == "noise":
        return np.random.default_rng(0).normal(100, 20, SHAPE).clip(0)
    if kind == "signs":
        return 1500 * np.sin(9 * x + 4 * y) * np.cos(7 * z)
    if kind == "labels":
        return np.floor(4 * (x + 1)) * (radius < 0.8)
    field = np.exp(3 * np.sin(5 * x) * np.cos(6 * y + z))
    field[20:40] = np.nan
    return field


#: By day every kind and every type, not every pair of them.
OF_THE_NIGHT = [("shell", "f4"), ("noise", "f4"), ("noise", "f8"), ("signs", "i2"), ("labels", "u2")]
CASES = [
    *(("shell", dtype) for dtype in ("u1", "i2", "f8")),
    ("noise", "u2"),
    *(("signs", dtype) for dtype in ("i4", "f4")),
    ("labels", "u1"),
    ("holes", "f4"),
    *(pytest.param(*case, marks=pytest.mark.nightly) for case in OF_THE_NIGHT),
]


@pytest.mark.parametrize(("kind", "dtype"), CASES)
def test_look_camera_and_picture_are_those_in_memory(kind, dtype):
    samples = _made(kind).astype(dtype)
    volume, lazy = ws.Volume(samples), ws.Volume.lazy(Chunked(samples), memory="60 MB", cache=False)
    mine, theirs = evidence(volume), evidence(lazy)
    assert (mine.kind, mine.reason) == (theirs.kind, theirs.reason)
    assert np.array_equal(mine.values, theirs.values)
    assert np.array_equal(mine.gradients, theirs.gradients)
    if mine.kind != "labels":  # looks of labels hold volumes, which are compared by identity
        for composite in (None, "maximum", "mean"):
            assert ws.Look.auto(volume, composite) == ws.Look.auto(lazy, composite)
    first, second = (ws.render(one, size=(60, 60), device="cpu") for one in (volume, lazy))
    assert first.report["camera"] == second.report["camera"]
    assert np.array_equal(first.rgba, second.rgba)
    assert first.rgba[..., 3].max() > 0.1


def _pyramid(samples, is_of_means):
    """Three levels, each half as fine: means of eight samples, or every second one."""
    levels = [samples]
    for _ in range(2):
        finer = levels[-1]
        z, y, x = (n // 2 for n in finer.shape)
        cut = finer[: 2 * z, : 2 * y, : 2 * x]
        mean = cut.reshape(z, 2, y, 2, x, 2).mean(axis=(1, 3, 5)).round().astype(finer.dtype)
        levels.append(mean if is_of_means else cut[::2, ::2, ::2].copy())
    return ws.Volume.lazy([Chunked(one) for one in levels], memory="60 MB", cache=False)


@pytest.mark.parametrize(
    ("kind", "dtype", "is_of_means", "wanted"),
    [
        ("jets", "u1", True, "field"),
        ("noise", "u1", True, "EM"),
        ("labels", "u1", False, "labels"),
        ("labels", "u2", False, "labels"),
    ],
)
def test_noise_and_labels_of_a_pyramid_are_told_by_its_finest_level(kind, dtype, is_of_means, wanted):
    """A jet of heptane, a field of bytes, became "a scan of no fixed scale" when it was opened as OME-Zarr."""
    samples = _jets() if kind == "jets" else _made(kind)
    samples = samples.astype(dtype)
    lazy = _pyramid(samples, is_of_means)
    assert lazy._surveyed_level() > 0
    assert evidence(ws.Volume(samples)).kind == wanted
    assert evidence(lazy).kind == wanted


def _jets():
    """Sheets that bend over some samples, so that every fourth one is rough."""
    radius, x, y, z = _radius()
    return 250 * np.exp(-(((radius - 0.5 - 0.1 * np.sin(9 * x + 5 * z) * np.cos(8 * y)) / 0.035) ** 2))


def test_a_kept_survey_gives_the_same_look(tmp_path):
    samples = _made("noise").astype(np.float32)
    array = Chunked(samples)
    array.token = "noise"  # noqa: S105 - no secret
    wanted = ws.Look.auto(ws.Volume(samples))
    assert wanted == ws.Look.auto(ws.Volume.lazy(array, memory="60 MB", cache=tmp_path))
    array.counts.clear()
    assert wanted == ws.Look.auto(ws.Volume.lazy(array, memory="60 MB", cache=tmp_path))
    assert not array.counts, "the second one reads nothing"


@pytest.mark.parametrize("shape", [(151, 140, 133), (2, 900, 1200), (3, 2, 2), (64, 64, 64)])
def test_thinned_samples_are_gathered_from_any_boxes(shape):
    samples = np.random.default_rng(1).random(shape)
    looks = LookSamples(shape, samples.dtype)
    for z in range(0, shape[0], 17):
        for y in range(0, shape[1], 230):
            for x in range(0, shape[2], 31):
                looks.take(samples[z : z + 17, y : y + 230, x : x + 31], (z, y, x))
    step, finest = looks.finest
    assert np.array_equal(finest, samples[::step, ::step, ::step])
    ((before, after), *_), n = looks.with_neighbours[1], looks.neighbour_step
    axis = next(axis for axis, size in enumerate(shape) if size >= 3)
    moved = [slice(1, size - 1, n) if size >= 3 else slice(None, None, n) for size in shape]
    for side, own in ((before, slice(0, shape[axis] - 2, n)), (after, slice(2, None, n))):
        moved[axis] = own
        assert np.array_equal(side, samples[tuple(moved)].ravel())
