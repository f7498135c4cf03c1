"""Lazy sources that are no volumes, or return other samples than they promise: an error, never wrong samples."""

from __future__ import annotations

import os
import sys

import numpy as np
import pytest

import wavesplat as ws
from wavesplat.errors import ArgumentError, FileError

SAMPLES = np.random.default_rng(2).integers(0, 200, (16, 16, 16)).astype(np.float32)


class Source:
    """An array of a shape, a type and chunks, whose reads return `made(samples)`."""

    def __init__(self, made=lambda part: part, samples=SAMPLES, **said):
        self._made, self._samples = made, samples
        self.shape, self.dtype = samples.shape, samples.dtype
        vars(self).update(said)

    def __getitem__(self, index):
        return self._made(self._samples[index])


def range_of(source):
    return ws.Volume.lazy(source, memory="50 MB", cache=False).value_range


@pytest.mark.parametrize(
    ("source", "message"),
    [
        (Source(lambda part: part + 5j), "came as complex64, not as real numbers; take .real"),
        (Source(lambda part: part.astype("U8")), "came as <U8, not as real numbers"),
        (Source(lambda part: part.astype("S8")), "not as real numbers"),
        (Source(lambda part: part.astype(object)), "came as object"),
        (Source(lambda part: np.ones(part.shape, "datetime64[s]")), "not as real numbers"),
        (
            Source(dtype="u1", made=lambda part: part + 0.5),
            "came as float32, .* dtype, uint8, cannot hold; mend its dtype",
        ),
        (Source(dtype="i2", made=lambda part: part.astype(np.int64) + 70000), "came as int64.*int16, cannot hold"),
        (Source(dtype="u2", made=lambda part: np.where(part > 50, part, np.nan)), "cannot hold"),
        (Source(dtype="c8"), "samples are complex64, not real numbers"),
        (Source(dtype="U3"), "not real numbers"),
        (Source(dtype="M8[s]"), "not real numbers"),
        (Source(dtype="nonsense"), "its dtype is 'nonsense'; give a type of NumPy"),
        (Source(dtype=7), "its dtype is 7"),
        (Source(dtype=object()), "its dtype is a object"),
        (Source(shape=None), "its shape is None"),
        (Source(shape=16), "its shape is 16"),
        (Source(shape=(16, 16, "16")), "its shape is .*whole numbers"),
        (Source(shape=(16, 16, -16)), "its shape is"),
        (Source(shape=(16, 16, 16.5)), "its shape is"),
        (Source(shape=(16, 16, float("inf"))), "its shape is"),
        (Source(shape=(16, float("nan"), 16)), "compute_chunk_sizes"),
        (Source(shape=()), "its shape is"),
        (Source(shape=(0, 16, 16)), "holds no samples"),
        (Source(chunks=(0, 4, 4)), "its chunks are"),
        (Source(chunks=(4, 4)), "its chunks are"),
        (Source(chunks=(4, 4, "x")), "its chunks are"),
        (Source(chunks=(4, 4, float("nan"))), "its chunks are"),
        (Source(chunks=((4, 12), (), (16,))), "its chunks are"),
        (Source(chunks=7), "its chunks are 7"),
    ],
)
def test_what_is_no_volume_is_refused_in_a_sentence(source, message):
    with pytest.raises(ArgumentError, match=message):
        range_of(source)


@pytest.mark.parametrize(
    "source",
    [
        Source(dtype="f8"),
        Source(dtype="u1", made=lambda part: part.astype(np.float64)),
        Source(dtype="i4", made=lambda part: part.astype(">i8")),
        Source(dtype="f4", made=lambda part: part.astype(np.float64) * (1 + 1e-12)),
        Source(chunks=[4, 5, 6]),
        Source(chunks=((4, 12), (16,), (8, 8))),
        Source(chunks=(np.int64(4),) * 3, shape=[np.int32(16)] * 3),
        Source(chunks=None),
    ],
)
def test_other_types_of_the_same_values_are_read(source):
    assert range_of(source) == (SAMPLES.min(), SAMPLES.max())


def test_masked_samples_are_no_values():
    masked = Source(lambda part: np.ma.masked_greater(part, 100))
    assert range_of(masked) == (SAMPLES.min(), SAMPLES[SAMPLES <= 100].max())
    whole = Source(lambda part: np.ma.masked_greater(part, 100), samples=SAMPLES.astype(np.int16))
    with pytest.raises(ArgumentError, match="masked, and int16 has no value for what is missing; give them as float32"):
        range_of(whole)
    assert range_of(Source(lambda part: np.ma.masked_greater(part, 999), samples=SAMPLES.astype(np.int16)))[1] < 200


def test_dask_arrays_whose_chunks_are_not_known(tmp_path):
    dask = pytest.importorskip("dask.array")
    array = dask.from_array(SAMPLES, chunks=8)
    for chosen in (array[array > 50], array[array[:, 0, 0] > 50]):
        with pytest.raises(ArgumentError, match=r"call compute_chunk_sizes\(\) on the Dask array first"):
            ws.Volume.lazy(chosen)
    some = array[array[:, 0, 0] > 50]
    assert ws.Volume.lazy(some.compute_chunk_sizes(), memory="50 MB").shape[1:] == (16, 16)


@pytest.mark.parametrize("memory", [1e300, 2.0**64, 10**400, "1e30 GB", "9999999999 GB"])
def test_memory_beyond_all_machines_is_refused_where_it_is_given(memory, tmp_path):
    np.save(tmp_path / "a.npy", SAMPLES)
    for make in (
        lambda: ws.Volume.lazy(SAMPLES, memory=memory),
        lambda: ws.open(tmp_path / "a.npy", memory=memory),
        lambda: ws.Volume.lazy(SAMPLES).with_memory(memory),
    ):
        with pytest.raises(ArgumentError, match="memory is .*give a"):
            make()


# Chunks of Zarr arrays that are no files: zarr takes them for chunks that were never written.


def _chunk(tmp_path, **options):
    import zarr

    zarr.create_array(tmp_path / "a.zarr", data=SAMPLES, chunks=(8, 8, 8), fill_value=7, **options)
    return tmp_path / "a.zarr" / "c" / "1" / "0" / "1"


def _folder(chunk):
    chunk.unlink()
    chunk.mkdir()


def _link(chunk):
    chunk.unlink()
    chunk.symlink_to("objects/sha256/that/was/never/got")


def _linked_folder(chunk):
    chunk.parent.rename(chunk.parent.with_name("moved"))
    chunk.parent.symlink_to("nowhere")


def _file_for_folder(chunk):
    for one in chunk.parent.iterdir():
        one.unlink()
    chunk.parent.rmdir()
    chunk.parent.write_bytes(b"")


def _pipe(chunk):
    chunk.unlink()
    os.mkfifo(chunk)


@pytest.mark.skipif(sys.platform == "win32", reason="links and pipes of POSIX")
@pytest.mark.parametrize("shards", [None, (8, 16, 8)])
@pytest.mark.parametrize(
    ("damage", "message"),
    [
        (_folder, "is a folder and no file"),
        (_link, "behind a link to what is not there; get the linked files"),
        (_linked_folder, "behind a link to what is not there"),
        (_file_for_folder, "a file has the name of its folder"),
        (_pipe, "is a device, a pipe or a socket"),
    ],
)
@pytest.mark.every_pair
def test_chunks_that_are_no_files_are_named(tmp_path, damage, message, shards):
    chunk = _chunk(tmp_path, shards=shards)
    damage(chunk)
    named = "chunk 'c/1/0/[01]'"
    with pytest.raises(FileError, match=rf"{named} {'can' if 'its folder' in message else ''}.*{message}"):
        ws.open(tmp_path / "a.zarr")
    with pytest.raises(FileError, match=f"{named}.*{message}"):
        ws.render(ws.open(tmp_path / "a.zarr", memory="50 MB"), size=(16, 16))


def test_chunks_that_were_never_written_are_fill(tmp_path):
    _chunk(tmp_path).unlink()
    whole, lazy = ws.open(tmp_path / "a.zarr"), ws.open(tmp_path / "a.zarr", memory="50 MB")
    assert np.array_equal(whole.samples, lazy.read().samples)
    assert (whole.samples[8:, :8, 8:] == 7).all()
