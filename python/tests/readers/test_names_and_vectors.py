"""Datasets by the last part of their name, and vectors in files of NumPy and plain Zarr arrays (F6 of sim.md)."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest
import zarr

import wavesplat as ws
from wavesplat._readers.components import length_of
from wavesplat.errors import ArgumentError

VECTORS = np.random.default_rng(0).normal(size=(6, 7, 8, 3)).astype(np.float32)


@pytest.mark.parametrize("lazily", [{}, {"memory": "10 MB"}])
def test_the_last_part_of_a_name_will_do_where_one_dataset_has_it(tmp_path: Path, lazily: Any) -> None:
    with h5py.File(tmp_path / "a.h5", "w") as file:
        for number, name in enumerate(("fields/density", "fields/heat", "other/heat", "other/place")):
            file[name] = np.full((4, 5, 6), number + 1, np.float32)
        file["place"] = np.full((4, 5, 6), 9, np.float32)
    opened = ws.open(tmp_path / "a.h5", dataset="density", **lazily)
    assert opened.value_range == (1, 1)
    assert opened.facts.quantity == "density"
    # A name of its own counts first.
    assert ws.open(tmp_path / "a.h5", dataset="place", **lazily).value_range == (9, 9)
    for name in ("heat", "ensity", "fields"):
        with pytest.raises(ArgumentError, match="no dataset .* fields/heat"):
            ws.open(tmp_path / "a.h5", dataset=name, **lazily)


@pytest.mark.parametrize("name", ["v.npy", "v.npz", "v.zarr"])
def test_vectors_are_drawn_by_their_length(tmp_path: Path, name: str) -> None:
    path = tmp_path / name
    if name == "v.npy":
        np.save(path, VECTORS)
    elif name == "v.npz":
        np.savez(path, velocity=VECTORS)
    else:
        zarr.create_array(path, data=VECTORS, chunks=(4, 7, 5, 3))
    length = ws.open(path)
    np.testing.assert_array_equal(np.asarray(length), np.sqrt((VECTORS**2).sum(-1, dtype=np.float32)))
    assert any("of which the length is drawn" in guess for guess in length.facts.guesses)
    assert not ws.open(path, component="magnitude").facts.guesses
    for number, component in enumerate("xyz"):
        assert np.array_equal(np.asarray(ws.open(path, component=component)), VECTORS[..., number])
        lazy = ws.open(path, component=component, memory="10 MB", cache=False)
        assert np.array_equal(np.asarray(lazy.read()), VECTORS[..., number])
        assert lazy.facts.quantity == ("velocity " + component if name == "v.npz" else None)
    lazy = ws.open(path, memory="10 MB", cache=False)
    assert np.array_equal(np.asarray(lazy.read()), np.asarray(length))
    assert (lazy.facts, lazy.dtype) == (length.facts, length.dtype)
    assert np.array_equal(np.asarray(ws.open(path, channel=1)), VECTORS[..., 1])


def test_colours_and_times_in_files_of_numpy_are_no_vectors(tmp_path: Path) -> None:
    for name, samples in (("colours", (255 * np.abs(VECTORS)).astype(np.uint8)), ("times", VECTORS[..., :2])):
        np.save(tmp_path / f"{name}.npy", samples)
        with pytest.raises(ws.errors.WavesplatError, match="choose one volume with"):
            ws.open(tmp_path / f"{name}.npy")
    np.save(tmp_path / "plain.npy", VECTORS[..., 0])
    for lazily in ({}, {"memory": "10 MB"}):
        with pytest.raises(ArgumentError, match=r"'plain\.npy' holds no vectors"):
            ws.open(tmp_path / "plain.npy", component="x", **lazily)  # type: ignore[arg-type]


def test_the_largest_float_as_a_filler_is_no_warning():
    large = np.float32(np.finfo(np.float32).max)
    parts = [np.array([3, 3e30, large, large], np.float32), np.array([4, 4e30, 0, large], np.float32)]
    np.testing.assert_allclose(length_of(parts), [5, 5e30, large, np.inf], rtol=1e-6)
