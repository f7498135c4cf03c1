"""A Zarr store may not run code: arrays packed by `pickle` are refused before anything is decoded."""

from __future__ import annotations

import base64
import json
import pickle
from pathlib import Path

import numpy as np
import pytest

import wavesplat as ws
from wavesplat.errors import FileError

PICKLE = {"id": "pickle", "protocol": 5}
ARRAY = {
    "zarr_format": 2,
    "shape": [2, 2, 2],
    "chunks": [2, 2, 2],
    "dtype": "|O",
    "compressor": None,
    "fill_value": None,
    "order": "C",
    "filters": [{"id": "vlen-utf8"}, PICKLE],
}


class Touch:
    """An object that makes a file when it is unpickled."""

    def __init__(self, path):
        self.path = path

    def __reduce__(self):
        return Path.touch, (self.path,)


@pytest.fixture
def marker(tmp_path, monkeypatch):
    """Path of the file that code in a store would make; the library's own guard, which older releases lack, is off."""
    pickles = pytest.importorskip("numcodecs.pickles")
    monkeypatch.setattr(pickles, "ALLOW_UNSAFE_PICKLE_DECODE", True, raising=False)
    return tmp_path / "ran"


def save(folder, marker, **fields):
    folder.mkdir(parents=True)
    (folder / ".zarray").write_text(json.dumps(ARRAY | fields))
    (folder / "0.0.0").write_bytes(pickle.dumps(Touch(marker)))


@pytest.mark.parametrize(
    "fields",
    [
        {},
        {"filters": [PICKLE]},
        {"filters": None, "compressor": PICKLE},
        {"dtype": "<i4", "filters": [{"id": "any", "inner": [PICKLE]}]},
    ],
)
def test_pickles_are_not_opened(tmp_path, marker, fields):
    save(tmp_path / "a.zarr", marker, **fields)
    with pytest.raises(FileError, match=r"packed by 'pickle', which would run what the file says.*a\.zarr$"):
        ws.open(tmp_path / "a.zarr")
    assert not marker.exists()


def test_a_pickle_as_fill_value_is_not_opened(tmp_path, marker):
    fill = base64.b64encode(pickle.dumps(Touch(marker))).decode()
    save(tmp_path / "a.zarr", marker, filters=[PICKLE], fill_value=fill)
    with pytest.raises(FileError, match="packed by 'pickle'"):
        ws.open(tmp_path / "a.zarr")
    assert not marker.exists()


def test_pickles_below_are_not_opened(tmp_path, marker):
    (tmp_path / "a.zarr").mkdir()
    (tmp_path / "a.zarr" / ".zgroup").write_text('{"zarr_format": 2}')
    levels = {"multiscales": [{"version": "0.4", "axes": list("zyx"), "datasets": [{"path": "s/0"}]}]}
    (tmp_path / "a.zarr" / ".zattrs").write_text(json.dumps(levels))
    save(tmp_path / "a.zarr" / "s" / "0", marker)
    for options in ({}, {"dataset": "s/0"}):
        with pytest.raises(FileError, match="packed by 'pickle'"):
            ws.open(tmp_path / "a.zarr", **options)
    # The error lists the arrays without opening any.
    (tmp_path / "a.zarr" / ".zattrs").unlink()
    with pytest.raises(FileError, match="there is: s: |--dataset\\): s: "):
        ws.open(tmp_path / "a.zarr")
    assert not marker.exists()


def test_pickles_in_other_levels_are_not_opened(tmp_path, marker):
    # The shapes of all levels are reported, so the other levels are read too.
    import zarr

    group = zarr.open_group(tmp_path / "a.zarr", mode="w", zarr_format=2)
    group.create_array("0", data=np.zeros((4, 4, 4), np.int16))
    group.attrs["multiscales"] = [{"version": "0.4", "axes": list("zyx"), "datasets": [{"path": "0"}, {"path": "1"}]}]
    fill = base64.b64encode(pickle.dumps(Touch(marker))).decode()
    save(tmp_path / "a.zarr" / "1", marker, filters=[PICKLE], fill_value=fill)
    with pytest.raises(FileError, match="packed by 'pickle'"):
        ws.open(tmp_path / "a.zarr")
    assert not marker.exists()


def test_pickles_of_zarr_3_are_not_opened(tmp_path, marker):
    (tmp_path / "a.zarr").mkdir()
    document = {
        "zarr_format": 3,
        "node_type": "array",
        "shape": [2, 2, 2],
        "data_type": "int32",
        "chunk_grid": {"name": "regular", "configuration": {"chunk_shape": [2, 2, 2]}},
        "chunk_key_encoding": {"name": "default"},
        "fill_value": 0,
        "codecs": [{"name": "sharding", "configuration": {"codecs": [{"name": "numcodecs.pickle"}]}}],
        "attributes": {},
    }
    (tmp_path / "a.zarr" / "zarr.json").write_text(json.dumps(document))
    with pytest.raises(FileError, match=r"packed by 'numcodecs\.pickle'"):
        ws.open(tmp_path / "a.zarr")


def test_objects_without_a_pickle_are_not_samples(tmp_path):
    import zarr

    array = zarr.create_array(tmp_path / "a.zarr", shape=(2, 2, 2), dtype=str, zarr_format=2)
    array[:] = "a"
    with pytest.raises(FileError, match=r"samples of type .* are not numbers; store them as integers or floats"):
        ws.open(tmp_path / "a.zarr")


def test_numbers_beside_text_are_read(tmp_path):
    import zarr

    group = zarr.open_group(tmp_path / "a.zarr", mode="w", zarr_format=2)
    group.create_array("names", shape=(3,), dtype=str)
    group.create_array("raw", data=np.arange(8, dtype=np.int16).reshape(2, 2, 2))
    zarr.consolidate_metadata(tmp_path / "a.zarr")
    assert ws.open(tmp_path / "a.zarr", dataset="raw").value_range == (0, 7)
