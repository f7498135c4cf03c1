"""`wavesplat info` of OME-Zarr images: few bytes of a server, statistics of the coarsest level, what else is there."""

from __future__ import annotations

import json

import numpy as np
import pytest
from test_lazy_files import ome_zarr
from test_lazy_http import serve  # noqa: F401 - a fixture

import wavesplat as ws
from wavesplat._cli import describe

pytest.importorskip("aiohttp")
RNG = np.random.default_rng(4)


def test_info_of_a_server_reads_the_coarsest_level_alone(serve, tmp_path, wavesplat):  # noqa: F811
    """Microscopy, section 5: the finest level was read whole for its percentiles, 29.6 MB in 439 requests."""
    samples = RNG.integers(50, 200, (64, 128, 128), np.uint8)
    ome_zarr(tmp_path / "a.zarr", samples, n_levels=4, chunk=32)
    address, sent = serve()
    done = wavesplat("info", f"{address}/a.zarr", "--json")
    facts = json.loads(done.stdout)
    assert facts["shape_zyx"] == [64, 128, 128]
    assert facts["levels"][-1] == [8, 16, 16]
    assert facts["level_of_values"] == 3
    assert 50 <= facts["value_range"][0] < facts["percentiles"]["50"] < facts["value_range"][1] < 200
    n_bytes = sum(n for _, n in sent)
    assert n_bytes < samples.nbytes / 20, n_bytes
    assert len(sent) < 60, "documents are asked for once for each time that the image is opened"
    assert not any("/0/c/" in path or "/1/c/" in path for path, _ in sent)
    text = wavesplat("info", f"{address}/a.zarr").stdout
    assert "of level 3 alone, the coarsest; --level 0 reads all" in text


def test_info_of_a_small_folder_reads_all(tmp_path, wavesplat):
    samples = RNG.integers(50, 200, (16, 16, 16), np.uint8)
    samples[3, 5, 7] = 255
    ome_zarr(tmp_path / "a.zarr", samples, n_levels=2, chunk=8)
    facts = json.loads(wavesplat("info", tmp_path / "a.zarr", "--channel", "0", "--json").stdout)
    assert facts["level_of_values"] is None
    assert facts["value_range"] == [50, 255]


def test_statistics_of_a_large_folder_are_those_of_the_coarsest_level(tmp_path, monkeypatch):
    samples = RNG.integers(50, 200, (16, 32, 32), np.uint8)
    ome_zarr(tmp_path / "a.zarr", samples, n_levels=3, chunk=8)
    volume = ws.open(tmp_path / "a.zarr", channel=0, memory="100 MB", cache=False)
    assert not describe.is_large_pyramid(volume)
    monkeypatch.setattr(describe, "MAX_OVERVIEW", samples.size - 1)
    assert describe.is_large_pyramid(volume)
    facts = describe.describe(volume, of_coarsest=True)
    assert (facts["shape_zyx"], facts["level_of_values"]) == ([16, 32, 32], 2)
    assert facts["value_range"] == list(volume.read(level=2).value_range)
    monkeypatch.setattr(describe, "MAX_OVERVIEW", 100)
    assert not describe.is_large_pyramid(volume), "its coarsest level is large too"
