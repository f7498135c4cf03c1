"""Arguments of `Volume.lazy`: arrays of Zarr, Dask, h5py, xarray, memory maps, and anything that slices."""

from __future__ import annotations

import pickle
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

import wavesplat as ws

SAMPLES = np.random.default_rng(5).integers(0, 4000, (21, 34, 27)).astype(np.uint16)


def _memmap(tmp_path):
    np.save(tmp_path / "a.npy", SAMPLES)
    return np.load(tmp_path / "a.npy", mmap_mode="r")


def _fortran(tmp_path):
    np.save(tmp_path / "f.npy", np.asfortranarray(SAMPLES))
    return np.load(tmp_path / "f.npy", mmap_mode="r")


def _big_endian(tmp_path):
    SAMPLES.astype(">u2").tofile(tmp_path / "b.raw")
    return np.memmap(tmp_path / "b.raw", ">u2", "r", shape=SAMPLES.shape)


def _zarr(tmp_path):
    import zarr

    array = zarr.create_array(tmp_path / "a.zarr", shape=SAMPLES.shape, chunks=(8, 9, 10), dtype="u2")
    array[:] = SAMPLES
    return array


def _sharded(tmp_path):
    import zarr

    array = zarr.create_array(
        tmp_path / "s.zarr", shape=SAMPLES.shape, chunks=(4, 5, 5), shards=(8, 10, 10), dtype="u2"
    )
    array[:] = SAMPLES
    return array


def _zarr_2(tmp_path):
    import zarr

    array = zarr.create_array(tmp_path / "two.zarr", shape=SAMPLES.shape, chunks=(8, 9, 10), dtype="u2", zarr_format=2)
    array[:] = SAMPLES
    return array


def _dask(tmp_path):
    return pytest.importorskip("dask.array").from_array(SAMPLES, chunks=(8, (20, 14), 10))


def _hdf5(tmp_path):
    import h5py

    with h5py.File(tmp_path / "a.h5", "w") as file:
        file.create_dataset("x", data=SAMPLES, chunks=(5, 6, 7), compression="gzip")
    return h5py.File(tmp_path / "a.h5")["x"]


def _xarray(tmp_path):
    xarray = pytest.importorskip("xarray")
    return xarray.DataArray(
        SAMPLES, dims=("z", "y", "x"), coords={"z": np.arange(21)[::-1] * 2.0, "y": np.arange(34), "x": np.arange(27)}
    )


def _xarray_of_dask(tmp_path):
    return _xarray(tmp_path).chunk({"z": 8, "y": 9, "x": 10})


class Slicing:
    """An array with nothing but a shape, a type and slicing, such as TensorStore's."""

    shape, dtype = SAMPLES.shape, SAMPLES.dtype

    def __getitem__(self, index):
        return SAMPLES[index]


KINDS = {
    "memory map": _memmap,
    "Fortran order": _fortran,
    "big-endian": _big_endian,
    "Zarr": _zarr,
    "Zarr in shards": _sharded,
    "Zarr 2": _zarr_2,
    "Dask": _dask,
    "HDF5": _hdf5,
    "xarray": _xarray,
    "xarray of Dask": _xarray_of_dask,
    "slicing alone": lambda _: Slicing(),
    "in memory": lambda _: SAMPLES,
}


@pytest.mark.parametrize("kind", KINDS)
def test_boxes_are_those_of_the_array(kind, tmp_path):
    lazy = ws.Volume.lazy(KINDS[kind](tmp_path), memory="50 MB")
    array = lazy.arrays(0)
    assert (array.shape, array.dtype) == (SAMPLES.shape, np.dtype(np.uint16))
    boxes = [((0, 0, 0), SAMPLES.shape), ((3, 5, 7), (11, 6, 27)), ((20, 33, 26), (21, 34, 27))]
    for lo, hi in boxes:
        wanted = SAMPLES[tuple(slice(a, b) for a, b in zip(lo, hi, strict=True))]
        got = array.read(lo, hi)
        assert np.array_equal(got, wanted)
        assert got.flags.c_contiguous
        assert got.dtype == np.uint16
    for box, got in zip(boxes, array.read_many(boxes), strict=True):
        assert np.array_equal(got, SAMPLES[tuple(slice(a, b) for a, b in zip(*box, strict=True))])
    with ThreadPoolExecutor(4) as pool:
        for box, got in zip(boxes * 5, pool.map(lambda box: array.read(*box), boxes * 5), strict=True):
            assert np.array_equal(got, SAMPLES[tuple(slice(a, b) for a, b in zip(*box, strict=True))])
    again = pickle.loads(pickle.dumps(lazy))  # noqa: S301 - its own
    assert np.array_equal(again.arrays(0).read(*boxes[1]), array.read(*boxes[1]))
    assert lazy.value_range == (float(SAMPLES.min()), float(SAMPLES.max()))


def test_files_are_not_sent_as_samples(tmp_path):
    for kind in ("memory map", "Zarr", "HDF5"):
        lazy = ws.Volume.lazy(KINDS[kind](tmp_path), memory="50 MB")
        assert len(pickle.dumps(lazy)) < SAMPLES.nbytes / 4, kind


def test_names_and_coordinates_say_where_samples_lie(tmp_path):
    lazy = ws.Volume.lazy(_xarray(tmp_path), memory="50 MB")
    whole = ws.Volume(_xarray(tmp_path))
    assert np.array_equal(lazy.world_from_index, whole.world_from_index)
    look = ws.TransferFunction([(0, 0.0), (4000, 0.4)], [(0, 1, 1, 1)])
    picture = ws.render(lazy, look, "front", size=(20, 20))
    assert np.array_equal(picture.rgba, ws.render(whole, look, "front", size=(20, 20)).rgba)


@pytest.mark.parametrize("dtype", ["?", "<f2", ">f4", "<i8", "<u8"])
def test_other_types_become_those_of_the_renderer(dtype, tmp_path):
    samples = (np.arange(6 * 7 * 8).reshape(6, 7, 8) % 2 if dtype == "?" else np.arange(336).reshape(6, 7, 8)).astype(
        dtype
    )
    samples.tofile(tmp_path / "t.raw")
    lazy = ws.Volume.lazy(np.memmap(tmp_path / "t.raw", dtype, "r", shape=samples.shape), memory="20 MB")
    assert np.array_equal(lazy.read().samples, samples.astype(np.float64))


@pytest.mark.parametrize(
    ("thing", "match"),
    [
        (np.zeros((4, 5)), "2-D"),
        (np.zeros((2, 3, 4, 5)), "4-D"),
        (np.zeros((3, 4, 5), complex), "not real"),
        (np.zeros((3, 1, 5)), "fewer than 2 samples"),
        ("a name", "give an array"),
        (42, "give an array"),
        ([], "give an array"),
    ],
)
def test_what_is_no_volume_is_refused(thing, match):
    with pytest.raises(ws.errors.ArgumentError, match=match):
        ws.Volume.lazy(thing, memory="20 MB")


def test_axes_with_one_place_are_dropped():
    lazy = ws.Volume.lazy(SAMPLES[None, None], memory="20 MB")
    assert np.array_equal(lazy.read().samples, SAMPLES)


def _halved(samples):
    z, y, x = (n // 2 * 2 for n in samples.shape)
    blocks = samples[:z, :y, :x].astype(np.float32).reshape(z // 2, 2, y // 2, 2, x // 2, 2)
    return blocks.mean((1, 3, 5)).astype(samples.dtype)


def test_levels_fill_the_same_box():
    levels = [SAMPLES, _halved(SAMPLES), _halved(_halved(SAMPLES))]
    lazy = ws.Volume.lazy(levels, spacing=(1, 2, 3), memory="50 MB")
    assert lazy.levels == tuple(level.shape for level in levels)
    assert any("coarser levels" in guess for guess in lazy.guesses)
    first = lazy._levels[1].world_from_index
    assert np.allclose(first[:3, 3], [0.5, 1.0, 1.5])
    assert np.allclose(np.diag(first)[:3], [2, 4, 6])
    with pytest.raises(ws.errors.ArgumentError, match="finest first"):
        ws.Volume.lazy(levels[::-1], memory="50 MB")


def test_pictures_take_the_coarsest_level_that_will_do():
    volume = ws.examples.ct_pelvis()
    samples = np.array(volume.samples)
    levels = [samples, _halved(samples), _halved(_halved(samples))]
    lazy = ws.Volume.lazy(levels, world_from_index=volume.world_from_index, memory="50 MB", cache=False)
    camera = ws.Camera.orbit(volume, 30, 20)
    taken = [ws.render(lazy, "ct-bone", camera, size=(n, n)).report["lazy"]["levels"] for n in (30, 80, 160, 400)]
    assert taken == [[2], [1], [0], [0]]
    assert ws.render(lazy.at_level(2), "ct-bone", camera, size=(400, 400)).report["lazy"]["levels"] == [2]
    with pytest.raises(ws.errors.ArgumentError, match="3 levels"):
        lazy.at_level(3)
    # The level must be as bright as the finest one: bones are thin, and could fade.
    whole = ws.render(volume, "ct-bone", camera, size=(300, 300)).rgba[..., :3].mean()
    for level in (1, 2):
        coarse = ws.render(lazy.at_level(level), "ct-bone", camera, size=(300, 300)).rgba[..., :3].mean()
        assert abs(coarse / whole - 1) < 0.05, level
