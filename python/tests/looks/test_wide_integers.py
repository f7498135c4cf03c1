"""Samples of all types, NumPy's own integers of 64 bits too, look the same in memory, in parts, of Zarr and of Dask."""

from dataclasses import replace

import numpy as np
import pytest

import wavesplat as ws

N = 16
Z, Y, X = np.indices((N, N, N)) - (N - 1) / 2
R = np.sqrt(X**2 + Y**2 + Z**2)
NOISE = np.random.default_rng(1).normal(0, 5, R.shape)
#: Whole numbers from 0 to 127, which all types hold, and those that types with more room or a sign have instead.
VOLUMES = {
    "labels": 3 * (R < 8) * (1 + (X > 0) + 2 * (Y > 0)),
    "scan": np.round(90 * (R < 7) + abs(NOISE)),
    "field": np.round(120 * np.exp(-(R**2) / 30)),
    "counts": np.random.default_rng(2).poisson(5 + 60 * (R < 5)),
}
OTHERS = {
    "scan": np.round(-1000 * (R > 9) + 300 * (R < 6) + 40 * (R <= 9) + 8 * NOISE),
    "field": np.round(1e5 * np.exp(-(R**2) / 30) * np.sign(X)),
}
TYPES = ("i1", "i2", "i4", "i8", "u1", "u2", "u4", "u8", "f4", "f8")


def seen(volume):
    look = ws.Look.auto(volume)
    labels = None if look.labels is None else sorted(look.labels.labels)
    return replace(look, labels=None).to_json(), labels, ws.render(volume, size=(16, 16)).rgba.tobytes()


@pytest.mark.parametrize("name", VOLUMES)
@pytest.mark.parametrize("dtype", TYPES)
@pytest.mark.every_pair
def test_one_look_and_one_picture_wherever_samples_lie(dtype, name, tmp_path):
    """Eight labels were one beige lump in parts, and a scan was a field: their samples are float64 there."""
    zarr, dask = pytest.importorskip("zarr"), pytest.importorskip("dask.array")
    has_room = np.dtype(dtype).itemsize > 2 and np.dtype(dtype).kind != "u"
    samples = (OTHERS if has_room and name in OTHERS else VOLUMES)[name].astype(dtype)
    np.save(tmp_path / "a.npy", samples)
    stored = zarr.open(tmp_path / "a.zarr", mode="w", shape=samples.shape, chunks=(8, 8, 8), dtype=samples.dtype)
    stored[:] = samples
    in_parts = dask.from_array(samples, chunks=8)
    in_memory = seen(ws.Volume(samples))
    for number, volume in enumerate(
        (
            ws.open(tmp_path / "a.npy"),
            ws.open(tmp_path / "a.npy", memory="50 MB", cache=False),
            ws.open(tmp_path / "a.zarr", memory="50 MB", cache=False),
            ws.Volume.lazy(samples),
            ws.Volume.lazy(in_parts),
        )
    ):
        assert seen(volume) == in_memory, number
    assert seen(ws.Volume(in_parts)) == in_memory
