"""Zarr chunks that were cut short are named in the error, whatever codec packed them."""

from __future__ import annotations

import numpy as np
import pytest
import zarr
from test_readers import ome_attributes

import wavesplat as ws
from wavesplat.errors import FileError

SAMPLES = np.random.default_rng(1).integers(0, 60000, (8, 8, 8)).astype(np.uint16)


def blosc():
    import numcodecs

    return numcodecs.Blosc()


def lz4():
    import numcodecs

    return numcodecs.LZ4()


CASES = {
    "plain, v2": lambda: {"zarr_format": 2, "compressors": None},
    "plain, v3": lambda: {"zarr_format": 3, "compressors": None},
    "blosc, v2": lambda: {"zarr_format": 2, "compressors": blosc()},
    "blosc, v3": lambda: {"zarr_format": 3, "compressors": zarr.codecs.BloscCodec()},
    "zstd": lambda: {"zarr_format": 3},
    "lz4": lambda: {"zarr_format": 2, "compressors": lz4()},
    "shards": lambda: {"zarr_format": 3, "shards": (4, 8, 8)},
}


@pytest.mark.parametrize("case", CASES)
@pytest.mark.parametrize("has_axes", [False, True])
def test_cut_chunks(tmp_path, case, has_axes):
    options = CASES[case]()
    chunks = (2, 4, 4) if "shards" in options else (4, 8, 8)
    group = zarr.open_group(tmp_path / "a.zarr", mode="w", zarr_format=options.pop("zarr_format"))
    group.create_array("0", data=SAMPLES, chunks=chunks, **options)
    if has_axes:
        group.attrs.update(ome_attributes("0.4", "zyx", [{"path": "0"}]))
    how = {} if has_axes else {"dataset": "0"}
    np.testing.assert_array_equal(ws.open(tmp_path / "a.zarr", **how).samples, SAMPLES)
    folder = tmp_path / "a.zarr" / "0"
    file = next(entry for entry in folder.rglob("*") if entry.is_file() and entry.name not in ("zarr.json", ".zarray"))
    whole = file.read_bytes()
    for kept in (0, 1, 15, 17, len(whole) // 2, len(whole) - 2, len(whole) - 1):
        file.write_bytes(whole[:kept])
        with pytest.raises(FileError, match="truncated") as caught:
            ws.open(tmp_path / "a.zarr", **how)
        if "shards" not in case:
            assert f"chunk {file.relative_to(folder).as_posix()!r}" in str(caught.value)


def test_chunks_that_are_not_there_are_fill(tmp_path):
    group = zarr.open_group(tmp_path / "a.zarr", mode="w")
    array = group.create_array("0", shape=(8, 8, 8), chunks=(4, 8, 8), dtype="u2", fill_value=7)
    array[:4] = SAMPLES[:4]
    assert ws.open(tmp_path / "a.zarr" / "0").samples[4:].tolist() == np.full((4, 8, 8), 7).tolist()
