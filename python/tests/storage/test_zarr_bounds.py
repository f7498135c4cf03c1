"""Chunks in folders: only regular files, and no larger than their samples can be."""

from __future__ import annotations

import os
import sys
from pathlib import PureWindowsPath

import numpy as np
import pytest
import zarr

import wavesplat as ws
from wavesplat._storage.zarr import place as zarr_place
from wavesplat._storage.zarr.place import ZarrPlace
from wavesplat.errors import FileError

SAMPLES = np.random.default_rng(5).integers(0, 250, (8, 8, 8)).astype(np.uint8)
WAYS = [{}, {"memory": "50 MB"}]


def opened(path, options):
    """Open a volume and return all samples, read at once or in parts."""
    volume = ws.open(path, **options)
    return (volume.read() if isinstance(volume, ws.LazyVolume) else volume).samples


@pytest.fixture
def chunk(tmp_path):
    zarr.create_array(tmp_path / "a.zarr", data=SAMPLES, chunks=(4, 4, 4))
    return tmp_path / "a.zarr" / "c" / "1" / "0" / "1"


def read(chunk, options):
    return opened(chunk.parents[3], options)


@pytest.mark.skipif(sys.platform == "win32", reason="has no such devices")
@pytest.mark.parametrize("options", WAYS)
@pytest.mark.parametrize("what", ["/dev/zero", "/dev/full", "pipe", "folder"])
@pytest.mark.every_pair
def test_chunks_that_are_no_files(chunk, options, what):
    chunk.unlink()
    if what == "folder":
        chunk.mkdir()
    elif what == "pipe":
        os.mkfifo(chunk)
    else:
        chunk.symlink_to(what)
    with pytest.raises(FileError, match=r"'c/1/0/1' is a (folder|device)"):
        read(chunk, options)


@pytest.mark.parametrize("options", WAYS)
def test_chunks_that_are_too_long(chunk, options):
    with chunk.open("ab") as file:
        file.truncate(1 << 32)  # takes no room
    with pytest.raises(FileError, match=r"'c/1/0/1' has 4294967296 bytes, and there can be at most \d{4,6}"):
        read(chunk, options)


@pytest.mark.parametrize("options", WAYS)
def test_metadata_that_are_no_file(chunk, options):
    (chunk.parents[3] / "zarr.json").unlink()
    (chunk.parents[3] / "zarr.json").mkdir()
    with pytest.raises(FileError, match=r"'zarr\.json' is a folder"):
        read(chunk, options)


@pytest.mark.parametrize("options", WAYS)
@pytest.mark.parametrize(
    "made",
    [
        {"compressors": None},
        {"compressors": zarr.codecs.GzipCodec(level=0)},
        {"compressors": zarr.codecs.BloscCodec(clevel=0)},
        {"chunks": (1, 1, 1), "shards": (8, 8, 8)},
        {"chunks": (1, 1, 2), "shards": (8, 8, 8), "compressors": zarr.codecs.BloscCodec()},
    ],
)
@pytest.mark.every_pair
def test_chunks_that_do_not_shrink_are_read(tmp_path, options, made):
    zarr.create_array(tmp_path / "a.zarr", data=SAMPLES, **{"chunks": (8, 8, 8)} | made)
    np.testing.assert_array_equal(opened(tmp_path / "a.zarr", options), SAMPLES)


@pytest.mark.parametrize("options", WAYS)
def test_filters_may_store_wider_samples(tmp_path, options):
    import numcodecs

    side = 64
    samples = np.random.default_rng(6).integers(0, 250, (side,) * 3).astype(np.uint8)
    wide = [numcodecs.AsType(encode_dtype="f8", decode_dtype="u1")]
    array = zarr.create_array(
        tmp_path / "a.zarr", shape=samples.shape, dtype="u1", chunks=samples.shape, zarr_format=2, filters=wide,
        compressors=None,
    )  # fmt: skip
    array[:] = samples
    np.testing.assert_array_equal(opened(tmp_path / "a.zarr", options), samples)


def test_keys_do_not_lead_out(tmp_path):
    (tmp_path / "a").mkdir()
    (tmp_path / "zarr.json").write_text("{}")
    place = ZarrPlace(tmp_path / "a")
    for key in ("../zarr.json", "b/../../zarr.json", str(tmp_path / "zarr.json")):
        with pytest.raises(FileError, match="leads out of the Zarr folder"):
            place.read(key)
    assert place.read("zarr.json") is None


def test_keys_do_not_lead_out_by_the_paths_of_windows(tmp_path, monkeypatch):
    monkeypatch.setattr(zarr_place, "PurePath", PureWindowsPath)
    place = ZarrPlace(tmp_path)
    for key in ("C:/zarr.json", "C:zarr.json", "b\\..\\..\\zarr.json", "\\zarr.json", "\\\\host\\share\\zarr.json"):
        with pytest.raises(FileError, match="leads out of the Zarr folder"):
            place.read(key)
    assert place.read("b/zarr.json") is None


def test_buckets_are_read_by_their_library(monkeypatch):
    """Without a bucket this checks keys, the bound, ranges, and keys that may not be read."""
    import fsspec
    from fsspec.implementations.asyn_wrapper import AsyncFileSystemWrapper
    from fsspec.implementations.memory import MemoryFileSystem

    files = MemoryFileSystem(skip_instance_cache=True)
    files.store, files.pseudo_dirs = {}, [""]
    files.pipe({"/bucket/a.zarr/.zarray": b"{}", "/bucket/a.zarr/0.0.0": b"0123456789"})
    asked = []

    def filesystem(protocol):
        asked.append(protocol)
        return AsyncFileSystemWrapper(files, asynchronous=False)

    monkeypatch.setattr(fsspec, "filesystem", filesystem)
    place = ZarrPlace("s3://bucket/a.zarr/")
    assert (place.read(".zarray"), place.read("0.0.1")) == (b"{}", None)
    place.expect("", 10)
    assert (place.read("0.0.0"), place.read("0.0.0", (2, 4)), place.read("0.0.0", (-3, None))) == (
        b"0123456789",
        b"23",
        b"789",
    )
    read = []
    cat_file = files.cat_file
    monkeypatch.setattr(files, "cat_file", lambda *given, **how: read.append(cat_file(*given, **how)) or read[-1])
    place.expect("", 3)
    assert place.read("0.0.0", (-3, None)) == b"789"
    for part in (None, (1, None), (1, 9), (-4, None)):
        with pytest.raises(FileError, match="there can be at most 3"):
            place.read("0.0.0", part)
    assert max(map(len, read)) == 4, "a byte more than there can be"

    def refuse(*_, **__):
        raise PermissionError("Access Denied")

    monkeypatch.setattr(files, "cat_file", refuse)
    assert place.read("0.0.0") is None
    assert list(place.refused) == ["0.0.0"]
    assert set(asked) == {"s3"}
