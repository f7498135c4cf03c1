"""Vectors in HDF5 are drawn by their length or one component, not as channels or times (F6, F12); openPMD's records."""

import h5py
import numpy as np
import pytest

import wavesplat as ws
from wavesplat.errors import ArgumentError, FileError

SHAPE = (6, 5, 7)


@pytest.fixture
def vectors():
    """A rotation about z, and a flow along it."""
    z, y, x = np.indices(SHAPE) - 2.5
    return np.stack([-y, x, 0.3 * z], axis=-1).astype(np.float32)


@pytest.fixture
def in_one_array(tmp_path, vectors):
    with h5py.File(tmp_path / "a.h5", "w") as file:
        file["flow"] = vectors
    return tmp_path / "a.h5"


@pytest.fixture
def record(tmp_path, vectors):
    """A mesh of openPMD whose components lie at the same places."""
    with h5py.File(tmp_path / "b.h5", "w") as file:
        mesh = file.create_group("data/1/meshes/B")
        mesh.attrs.update(axisLabels=["z", "y", "x"], gridSpacing=[3.0, 2.0, 1.0], gridGlobalOffset=[0.0, 0, 0])
        mesh.attrs.update(gridUnitSI=1e-3, geometry="cartesian")
        for number, axis in enumerate("xyz"):
            mesh[axis] = vectors[..., number]
            mesh[axis].attrs["position"] = [0.0, 0, 0]
    return tmp_path / "b.h5"


def test_length_and_components_f12(in_one_array, vectors):
    volume = ws.open(in_one_array)
    np.testing.assert_array_almost_equal_nulp(volume.samples, np.linalg.norm(vectors, axis=-1), 1)
    assert "'flow' holds vectors, of which the length is drawn" in volume.guesses[0]
    assert ws.open(in_one_array, component="magnitude").guesses == ()
    for number, axis in enumerate("xyz"):
        np.testing.assert_array_equal(ws.open(in_one_array, component=axis).samples, vectors[..., number])
        np.testing.assert_array_equal(ws.open(in_one_array, channel=number).samples, vectors[..., number])
        lazy = ws.open(in_one_array, component=axis, memory="1 MB")
        np.testing.assert_array_equal(lazy.read().samples, vectors[..., number])
    np.testing.assert_array_equal(ws.open(in_one_array, memory="1 MB").read().samples, volume.samples)
    assert len(ws.open_scene(in_one_array).layers) == 1


def test_times_are_still_times(tmp_path, vectors):
    with h5py.File(tmp_path / "a.h5", "w") as file:
        file["flow"] = np.moveaxis(vectors, -1, 0)
        file["scalars"] = vectors[..., 0]
    assert len(ws.open_series(tmp_path / "a.h5", dataset="flow")) == 3
    np.testing.assert_array_equal(ws.open(tmp_path / "a.h5", dataset="flow", time=1).samples, vectors[..., 1])
    with pytest.raises(ArgumentError, match="holds no vectors"):
        ws.open(tmp_path / "a.h5", dataset="scalars", component="x")


def test_whole_numbers_at_the_end_are_channels_not_times(tmp_path, vectors):
    np.save(tmp_path / "a.npy", (10 * vectors).astype(np.int16))
    with h5py.File(tmp_path / "a.h5", "w") as file:
        file["rgb"] = vectors.astype(np.uint8)
    for name in ("a.npy", "a.h5"):
        with pytest.raises(FileError) as error:
            ws.open(tmp_path / name)
        assert error.value.option == "channel"


def test_records_of_openpmd(record, vectors):
    volume = ws.open(record, dataset="data/1/meshes/B")
    np.testing.assert_array_almost_equal_nulp(volume.samples, np.linalg.norm(vectors, axis=-1), 1)
    assert (volume.spacing, volume.unit) == ((1, 2, 3), "mm")
    assert len(volume.guesses) == 1
    for number, axis in enumerate("xyz"):
        for options in ({"dataset": "data/1/meshes/B", "component": axis}, {"dataset": f"data/1/meshes/B/{axis}"}):
            np.testing.assert_array_equal(ws.open(record, **options).samples, vectors[..., number])
    lazy = ws.open(record, dataset="data/1/meshes/B", component="y", memory="1 MB")
    np.testing.assert_array_equal(lazy.read().samples, vectors[..., 1])
    with pytest.raises(ArgumentError, match="with memory= choose one component"):
        ws.open(record, dataset="data/1/meshes/B", memory="1 MB")


def test_components_at_other_places_of_a_cell_are_said(record):
    with h5py.File(record, "r+") as file:
        file["data/1/meshes/B/y"].attrs["position"] = [0.5, 0, 0]
    assert any("different places of a cell" in guess for guess in ws.open(record, dataset="data/1/meshes/B").guesses)


@pytest.mark.parametrize(
    ("geometry", "route"), [("thetaMode", r"resample=N \(--resample N\)"), ("cylindrical", "sample it on a box")]
)
def test_meshes_about_an_axis_are_refused_by_name(record, geometry, route):
    with h5py.File(record, "r+") as file:
        file["data/1/meshes/B"].attrs["geometry"] = np.bytes_(geometry)
    for name in ("data/1/meshes/B", "data/1/meshes/B/x"):
        for options in ({}, {"memory": "1 MB"}):
            with pytest.raises(FileError, match=f"{geometry}.*{route}"):
                ws.open(record, dataset=name, **options)


def add_constant(mesh, part, value, shape=SHAPE):
    """A component that is one number everywhere, as openPMD writes those of symmetric fields."""
    made = mesh.create_group(part)
    made.attrs.update(value=value, shape=np.array(shape, np.uint64), position=[0.0, 0, 0])


def test_the_only_mesh_of_openpmd_needs_no_name(record, vectors):
    named = ws.open(record, dataset="data/1/meshes/B")
    for options in ({}, {"dataset": "B"}):
        volume = ws.open(record, **options)
        np.testing.assert_array_equal(volume.samples, named.samples)
        assert volume.guesses == named.guesses
    np.testing.assert_array_equal(ws.open(record, component="y").samples, vectors[..., 1])
    np.testing.assert_array_equal(ws.open(record, component="y", memory="1 MB").read().samples, vectors[..., 1])
    with h5py.File(record, "r+") as file:
        file["data/1/meshes/rho"] = vectors[..., 0]
    with pytest.raises(FileError, match=r"2 datasets .* data/1/meshes/B \(6, 5, 7\) of x, y, z, data/1/meshes/rho"):
        ws.open(record)


@pytest.mark.parametrize("value", [0.0, 2.5])
def test_components_that_are_one_number_everywhere(record, vectors, value):
    with h5py.File(record, "r+") as file:
        mesh = file["data/1/meshes/B"]
        del mesh["y"]
        add_constant(mesh, "y", value)
    vectors[..., 1] = value
    np.testing.assert_allclose(ws.open(record).samples, np.linalg.norm(vectors, axis=-1), rtol=1e-6)
    for options in ({}, {"memory": "1 MB"}):
        with pytest.raises(FileError, match=f"component y of 'data/1/meshes/B' is {value:g} everywhere"):
            ws.open(record, component="y", **options)
    with h5py.File(record, "r+") as file:
        for part in "xz":
            del file["data/1/meshes/B"][part]
            add_constant(file["data/1/meshes/B"], part, value)
    with pytest.raises(FileError, match="is the same everywhere"):
        ws.open(record, dataset="data/1/meshes/B")


def test_modes_with_a_component_that_is_one_number_everywhere(tmp_path):
    with h5py.File(tmp_path / "a.h5", "w") as file:
        mesh = file.create_group("data/1/meshes/B")
        mesh.attrs.update(axisLabels=["r", "z"], gridSpacing=[0.5, 1.0], gridGlobalOffset=[0.0, 0], gridUnitSI=1.0)
        mesh.attrs.update(geometry=np.bytes_("thetaMode"), geometryParameters=np.bytes_("m=1;imag=+"))
        mesh["r"], mesh["z"] = np.full((1, 5, 6), 3.0), np.full((1, 5, 6), 4.0)
        add_constant(mesh, "t", 0.0, (1, 5, 6))
    samples = ws.open(tmp_path / "a.h5", resample=9).samples
    np.testing.assert_allclose(samples[np.isfinite(samples)], 5.0, rtol=1e-6)
    along = ws.open(tmp_path / "a.h5", resample=9, component="z").samples
    np.testing.assert_allclose(along[np.isfinite(along)], 4.0)


def test_hdf5_without_a_volume_says_what_it_holds(tmp_path):
    with h5py.File(tmp_path / "a.h5", "w") as file:
        file["particles/x"] = np.arange(10.0)
    for groups, what in ((("coordsets", "topologies"), "Blueprint"), (("results", "settings"), r"Fluent.*cas\.h5")):
        with h5py.File(tmp_path / "mesh.h5", "w") as file:
            for group in groups:
                file[f"{group}/values"] = np.arange(4.0)
        with pytest.raises(FileError, match=what):
            ws.open(tmp_path / "mesh.h5")
    with pytest.raises(FileError, match=r"no dataset with three axes .* particles/x \(10,\); if one is a flattened"):
        ws.open(tmp_path / "a.h5")
