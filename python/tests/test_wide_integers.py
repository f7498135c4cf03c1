"""64-bit integers, NumPy's own, look the same in memory, in parts, of Zarr and of Dask."""

import numpy as np
import pytest

import wavesplat as ws

N = 24
Z, Y, X = np.indices((N, N, N)) - (N - 1) / 2
R = np.sqrt(X**2 + Y**2 + Z**2)
NOISE = np.random.default_rng(1).normal(0, 5, R.shape)
VOLUMES = {
    "labels": 3 * (R < 10) * (1 + (X > 0) + 2 * (Y > 0)),
    "scan": np.round(90 * (R < 8) + abs(NOISE)),
    "below zero": np.round(300 * (R < 8) + 8 * NOISE),
    "field": np.round(1e5 * np.exp(-(R**2) / 50)),
}


def seen(volume):
    look = ws.Look.auto(volume)
    nodes = None if look.labels is None else sorted(look.labels.labels)
    curves = (look.transfer_function.opacity, look.transfer_function.color)
    return look.reason, nodes, curves, ws.render(volume, size=(24, 24)).rgba.tobytes()


@pytest.mark.parametrize("dtype", ["i8", "u8", ">i8", "i4"])
@pytest.mark.parametrize("name", VOLUMES)
@pytest.mark.every_pair
def test_one_look_and_one_picture_wherever_samples_lie(name, dtype, tmp_path):
    """Eight labels were one beige lump in parts, and a scan was a field: their samples are float64 there."""
    if dtype == "u8" and VOLUMES[name].min() < 0:
        pytest.skip("no unsigned numbers")
    samples = VOLUMES[name].astype(dtype)
    np.save(tmp_path / "a.npy", samples)
    in_memory = seen(ws.Volume(samples))
    assert seen(ws.open(tmp_path / "a.npy", memory="50 MB")) == in_memory
    assert seen(ws.Volume.lazy(samples)) == in_memory


def test_zarr_and_dask_too(tmp_path):
    import zarr

    dask = pytest.importorskip("dask.array")
    samples = VOLUMES["labels"].astype(np.int64)
    stored = zarr.open(tmp_path / "a.zarr", mode="w", shape=samples.shape, chunks=(8, 8, 8), dtype=samples.dtype)
    stored[:] = samples
    lazily = dask.from_array(samples, chunks=8)
    in_memory = seen(ws.Volume(samples))
    for volume in (ws.open(tmp_path / "a.zarr", memory="50 MB"), ws.Volume(lazily), ws.Volume.lazy(lazily)):
        assert seen(volume) == in_memory
