"""The reader of Zarr chunks gives zarr's own samples, for every layout that it takes."""

from __future__ import annotations

import pickle
import shutil
import tracemalloc

import numpy as np
import pytest
import zarr

import wavesplat as ws
from wavesplat._model.lazy.array import lazy_array
from wavesplat._storage.zarr import reading as zarr_decoding
from wavesplat._storage.zarr.reading import read_zarr, zarr_reader
from wavesplat.errors import FileError

numcodecs = pytest.importorskip("numcodecs")
SAMPLES = np.random.default_rng(1).integers(0, 200, (13, 10, 9)).astype(np.uint16)
SAMPLES[4:8] = 0

CODECS = zarr.codecs
LAYOUTS = {
    "zstd": {},
    "zstd with a checksum": {"compressors": CODECS.ZstdCodec(checksum=True)},
    "plain": {"compressors": None},
    "gzip": {"compressors": CODECS.GzipCodec()},
    "blosc": {"compressors": CODECS.BloscCodec(cname="lz4", shuffle="bitshuffle")},
    "crc32c": {"compressors": CODECS.Crc32cCodec()},
    "blosc, then zstd, then crc32c": {
        "compressors": [CODECS.BloscCodec(), CODECS.ZstdCodec(), CODECS.Crc32cCodec()],
    },
    "big-endian": {"serializer": CODECS.BytesCodec(endian="big")},
    "transposed": {"filters": CODECS.TransposeCodec(order=(2, 0, 1))},
    "transposed twice": {
        "filters": [CODECS.TransposeCodec(order=(2, 0, 1)), CODECS.TransposeCodec(order=(1, 0, 2))],
    },
    "names with dots": {"chunk_key_encoding": {"name": "default", "separator": "."}},
    "names of v2": {"chunk_key_encoding": {"name": "v2", "separator": "/"}},
    "fill value": {"fill_value": 7},
    "shards": {"shards": (6, 8, 8)},
    "shards with blosc, transposed": {
        "shards": (6, 8, 8),
        "compressors": CODECS.BloscCodec(),
        "filters": CODECS.TransposeCodec(order=(1, 2, 0)),
    },
    "v2": {"zarr_format": 2},
    "v2, big-endian": {"zarr_format": 2, "dtype": ">u2"},
    "v2, Fortran": {"zarr_format": 2, "order": "F"},
    "v2, plain": {"zarr_format": 2, "compressors": None},
    "v2, names with slashes": {"zarr_format": 2, "chunk_key_encoding": {"name": "v2", "separator": "/"}},
    "v2, no fill value": {"zarr_format": 2, "fill_value": None},
    **{
        f"v2, {name}": {"zarr_format": 2, "compressors": numcodecs.get_codec({"id": name})}
        for name in ("blosc", "bz2", "gzip", "lz4", "lzma", "zlib", "zstd")
    },
}
#: Layouts that are left to zarr.
OTHERS = {
    "v2, delta": {"zarr_format": 2, "filters": numcodecs.Delta("u2")},
    "complex": {"dtype": "c8"},
}


def written(place, layout, **more):
    """The array of a layout, opened for reading; chunks of zeros alone are not stored."""
    options = {"dtype": "u2", "chunks": (3, 4, 4), "fill_value": 0} | layout | more
    array = zarr.create_array(place, shape=SAMPLES.shape, **options)
    array[:] = SAMPLES
    return zarr.open_array(place, mode="r")


BOXES = [((0, 0, 0), (13, 10, 9)), ((2, 3, 1), (9, 9, 8)), ((5, 4, 4), (6, 5, 5)), ((12, 8, 8), (13, 10, 9))]


@pytest.mark.parametrize("layout", LAYOUTS)
def test_samples_are_those_of_zarr(tmp_path, layout):
    array = written(tmp_path / "a.zarr", LAYOUTS[layout])
    reader = zarr_reader(array)
    assert reader is not None
    for lo, hi in BOXES:
        index = tuple(slice(a, b) for a, b in zip(lo, hi, strict=True))
        own = reader[index]
        np.testing.assert_array_equal(own, array[index])
        assert own.dtype == array.dtype
        lazy = lazy_array(array).levels[0].read(lo, hi)
        np.testing.assert_array_equal(lazy, SAMPLES[index])


@pytest.mark.parametrize("dtype", ["?", "i1", "<i4", ">i8", "<u8", "<f4", ">f8", "<f2"])
@pytest.mark.parametrize("zarr_format", [2, 3])
@pytest.mark.every_pair
def test_types(tmp_path, dtype, zarr_format):
    array = written(tmp_path / "a.zarr", {}, dtype=dtype, zarr_format=zarr_format)
    whole = tuple(slice(0, n) for n in array.shape)
    np.testing.assert_array_equal(zarr_reader(array)[whole], array[:])
    np.testing.assert_array_equal(lazy_array(array).levels[0].read((0, 0, 0), array.shape), array[:])


@pytest.mark.parametrize("layout", OTHERS)
def test_other_layouts_are_left_to_zarr(tmp_path, layout):
    assert zarr_reader(written(tmp_path / "a.zarr", OTHERS[layout])) is None


def test_arrays_in_memory_are_left_to_zarr():
    assert zarr_reader(zarr.create_array({}, shape=(4, 4, 4), chunks=(2, 2, 2), dtype="u1")) is None


def test_axes_of_an_image_and_picked_channels(tmp_path):
    five = np.random.default_rng(2).integers(0, 200, (2, 3, 5, 6, 7)).astype(np.uint8)
    array = zarr.create_array(tmp_path / "a.zarr", data=five, chunks=(1, 2, 2, 3, 4))
    reader = zarr_reader(array)
    index = (1, 2, slice(1, 5), slice(0, 4), slice(3, 7))
    np.testing.assert_array_equal(reader[index], five[index])
    lazy = lazy_array(zarr.create_array(tmp_path / "b.zarr", data=five[:1, :1], chunks=(1, 1, 2, 3, 4))).levels[0]
    np.testing.assert_array_equal(lazy.read((0, 0, 0), (5, 6, 7)), five[0, 0])


@pytest.mark.parametrize("layout", [*LAYOUTS, *OTHERS])
def test_whole_arrays_are_read_by_threads(tmp_path, layout):
    array = written(tmp_path / "a.zarr", (LAYOUTS | OTHERS)[layout])
    for index in ([slice(None)] * 3, [slice(2, 9), 5, slice(3, None)], [7, slice(1, 2), 0]):
        own = read_zarr(array, index)
        np.testing.assert_array_equal(own, array[tuple(index)])
        assert own.dtype == array.dtype
    if layout in LAYOUTS:
        np.testing.assert_array_equal(ws.Volume(array).samples, SAMPLES)
        np.testing.assert_array_equal(ws.open(tmp_path / "a.zarr").samples, SAMPLES)


def test_a_reader_is_sent_to_other_processes(tmp_path):
    array = written(tmp_path / "a.zarr", LAYOUTS["shards"])
    index = tuple(slice(0, n) for n in SAMPLES.shape)
    np.testing.assert_array_equal(pickle.loads(pickle.dumps(zarr_reader(array)))[index], SAMPLES)  # noqa: S301


def test_samples_are_read_into_an_array(tmp_path):
    level = lazy_array(written(tmp_path / "a.zarr", {"zarr_format": 2, "order": "F"})).levels[0]
    out = np.zeros((20, 20, 20), level.dtype)
    level.read_into((2, 3, 1), (9, 9, 8), out[4:11, 5:11, 6:13])
    np.testing.assert_array_equal(out[4:11, 5:11, 6:13], SAMPLES[2:9, 3:9, 1:8])
    assert np.count_nonzero(out) == np.count_nonzero(SAMPLES[2:9, 3:9, 1:8])


@pytest.mark.parametrize("layout", LAYOUTS)
def test_a_damaged_chunk_is_named(tmp_path, layout):
    array = written(tmp_path / "a.zarr", LAYOUTS[layout])
    level = lazy_array(array).levels[0]
    files = sorted(one for one in (tmp_path / "a.zarr").rglob("*") if one.is_file() and one.name[0] not in "z.")[:2]
    for kept in (0, 1, 15, 0.5, -1):
        for file in files:
            whole = file.read_bytes()
            file.write_bytes(whole[: int(len(whole) * kept) if kept == 0.5 else kept])
            with pytest.raises(FileError, match=r"samples z .*\(chunk \(\d, \d, \d\)\)"):
                level.read((0, 0, 0), SAMPLES.shape)
            file.write_bytes(whole)
    np.testing.assert_array_equal(level.read((0, 0, 0), SAMPLES.shape), SAMPLES)


def test_a_chunk_that_unpacks_to_another_size_is_damaged(tmp_path):
    level = lazy_array(written(tmp_path / "a.zarr", {"zarr_format": 2})).levels[0]
    file = tmp_path / "a.zarr" / "0.0.0"
    for n in (3 * 4 * 4 * 2 - 2, 3 * 4 * 4 * 2 + 2):
        file.write_bytes(numcodecs.Zstd().encode(bytes(n)))
        with pytest.raises(FileError, match=f"unpacks to {n} bytes instead of 96"):
            level.read((0, 0, 0), SAMPLES.shape)


@pytest.mark.parametrize("name", ["zstd", "blosc", "lz4"])
def test_a_chunk_that_says_it_is_long_is_not_unpacked(tmp_path, name):
    codec = numcodecs.get_codec({"id": name})
    level = lazy_array(written(tmp_path / "a.zarr", {"zarr_format": 2, "compressors": codec})).levels[0]
    (tmp_path / "a.zarr" / "0.0.0").write_bytes(codec.encode(np.zeros(10_000_000, np.uint8)))
    tracemalloc.start()
    with pytest.raises(FileError, match="unpacks to 10000000 bytes instead of 96"):
        level.read((0, 0, 0), (3, 4, 4))
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert peak < 1_000_000


@pytest.mark.parametrize("n", [0, 1, 100, 255, 256, 300, 65791, 65792, 100_000])
@pytest.mark.parametrize("name", ["zstd", "blosc", "lz4"])
def test_headers_say_how_long_the_content_is(name, n):
    packed = bytes(numcodecs.get_codec({"id": name}).encode(np.zeros(n, np.uint8) if n else b"\0"))
    assert zarr_decoding.UNPACKED_SIZES[name](packed) in {max(n, 1), None if len(packed) < 18 else max(n, 1)}


def test_frames_without_a_size_are_unpacked(tmp_path):
    level = lazy_array(written(tmp_path / "a.zarr", {"zarr_format": 2})).levels[0]
    # A frame of one raw block of 96 bytes, whose header has a window and no size.
    raw = bytes(range(96))
    frame = zarr_decoding.ZSTD_MAGIC + bytes([0, 0]) + (96 << 3 | 1).to_bytes(3, "little") + raw
    (tmp_path / "a.zarr" / "0.0.0").write_bytes(frame)
    assert level.read((0, 0, 0), (3, 4, 4)).tobytes() == raw


def test_a_link_to_nothing_is_no_empty_chunk(tmp_path):
    level = lazy_array(written(tmp_path / "a.zarr", {})).levels[0]
    chunk = tmp_path / "a.zarr" / "c" / "0" / "1" / "2"
    chunk.unlink()
    np.testing.assert_array_equal(level.read((0, 4, 8), (3, 8, 9)), 0)
    chunk.symlink_to("nothing")
    with pytest.raises(FileError, match="link to what is not there"):
        level.read((0, 0, 0), SAMPLES.shape)
    shutil.rmtree(chunk.parent)
    chunk.parent.symlink_to("nothing")
    with pytest.raises(FileError, match="link to what is not there"):
        level.read((0, 0, 0), SAMPLES.shape)


def test_the_index_of_a_shard_is_checked(tmp_path):
    level = lazy_array(written(tmp_path / "a.zarr", LAYOUTS["shards"])).levels[0]
    file = tmp_path / "a.zarr" / "c" / "0" / "0" / "0"
    whole = bytearray(file.read_bytes())
    whole[-20] ^= 1
    file.write_bytes(whole)
    with pytest.raises(FileError, match="checksum"):
        level.read((0, 0, 0), SAMPLES.shape)


def test_a_picture_is_that_of_the_samples_in_memory(tmp_path):
    samples = np.zeros((40, 40, 40), np.uint8)
    samples[8:30, 10:33, 12:35] = np.random.default_rng(3).integers(90, 255, (22, 23, 23))
    array = zarr.create_array(tmp_path / "a.zarr", data=samples, chunks=(16, 16, 16))
    look = ws.Look(transfer_function=ws.TransferFunction([(80, 0.0), (255, 0.4)], [(0, 0, 0, 1), (255, 1, 1, 0)]))
    lazy = ws.Volume.lazy(array, memory="20 MB", cache=False)
    camera = ws.Camera.orbit(ws.Volume(samples), 30, 20)
    pictures = [ws.render(volume, look, camera, size=(64, 64)).rgba for volume in (ws.Volume(samples), lazy)]
    np.testing.assert_array_equal(*pictures)
