"""Contents of files, for `wavesplat info`: every array with its type, components, place and range."""

from __future__ import annotations

import json

import h5py
import numpy as np
import pytest
from test_netcdf import save_netcdf3
from vti_files import save_vti

import wavesplat as ws
from wavesplat._readers import file_contents
from wavesplat._readers.opening import contents
from wavesplat._readers.plain import arrays
from wavesplat._readers.request import requested
from wavesplat._readers.vtk import vti

#: Points along z, y, x, and cells between them.
SHAPE, CELLS = (4, 5, 6), (3, 4, 5)
RANDOM = np.random.default_rng(0)
PRESSURE = RANDOM.normal(size=SHAPE)
VELOCITY = RANDOM.normal(size=(*SHAPE, 3)).astype(np.float32)
MATERIAL = RANDOM.integers(0, 9, CELLS).astype(np.int16)
PRESSURE[0, 0, 0] = np.nan


def found(path, **options):
    """The arrays of a file by their names: type, components, place, and ranges."""
    listed = contents(requested(path, **options))
    return {
        one.name: (one.dtype, one.n_components, one.place, np.array(one.ranges)) for one in listed.arrays
    }, listed.grid


def check(arrays, name, numbers, place, n_components=1):
    dtype, n, where, ranges = arrays[name]
    assert (dtype, n, where) == (str(numbers.dtype), n_components, place)
    rows = np.reshape(numbers, (-1, n_components))
    np.testing.assert_allclose(
        ranges, np.stack([np.nanmin(rows, axis=0), np.nanmax(rows, axis=0)], axis=1), rtol=1e-5
    )  # text has 6 digits


def put_all(grid):
    support = pytest.importorskip("vtkmodules.util.numpy_support")
    for part, name, numbers in (
        (grid.GetPointData(), "p", PRESSURE.ravel()),
        (grid.GetPointData(), "u", VELOCITY.reshape(-1, 3)),
        (grid.GetCellData(), "m", MATERIAL.ravel()),
    ):
        array = support.numpy_to_vtk(numbers, deep=1)
        array.SetName(name)
        part.AddArray(array)
    return grid


def grid_of(kind):
    model = pytest.importorskip("vtkmodules.vtkCommonDataModel")
    filters = pytest.importorskip("vtkmodules.vtkFiltersCore")
    support = pytest.importorskip("vtkmodules.util.numpy_support")
    image = model.vtkImageData()
    image.SetDimensions(*SHAPE[::-1])
    if kind == "image":
        return put_all(image)
    grid = model.vtkRectilinearGrid()
    grid.SetDimensions(*SHAPE[::-1])
    for axis, n in zip("XYZ", SHAPE[::-1], strict=True):
        getattr(grid, f"Set{axis}Coordinates")(support.numpy_to_vtk(np.arange(n) ** 2.0, deep=1))
    grid = put_all(grid)
    if kind == "unstructured":
        append = filters.vtkAppendFilter()
        append.AddInputData(grid)
        append.Update()
        return append.GetOutput()
    if kind == "blocks":
        whole = model.vtkMultiBlockDataSet()
        whole.SetBlock(0, grid)
        return whole
    return grid


@pytest.mark.parametrize(
    ("kind", "suffix", "writer"),
    [
        ("image", ".vti", "vtkIOXML.vtkXMLImageDataWriter"),
        ("image", ".vtk", "vtkIOLegacy.vtkGenericDataObjectWriter"),
        ("rectilinear", ".vtr", "vtkIOXML.vtkXMLRectilinearGridWriter"),
        ("rectilinear", ".vtk", "vtkIOLegacy.vtkGenericDataObjectWriter"),
        ("unstructured", ".vtu", "vtkIOXML.vtkXMLUnstructuredGridWriter"),
        ("blocks", ".vtm", "vtkIOXML.vtkXMLMultiBlockDataWriter"),
        ("unstructured", ".pvtu", "vtkIOParallelXML.vtkXMLPUnstructuredGridWriter"),
    ],
)
def test_all_arrays_of_a_vtk_grid_are_listed_without_a_choice(tmp_path, wavesplat, kind, suffix, writer):
    module, _, name = writer.partition(".")
    writer = getattr(pytest.importorskip(f"vtkmodules.{module}"), name)()
    path = tmp_path / f"a{suffix}"
    writer.SetFileName(str(path))
    writer.SetInputData(grid_of(kind))
    writer.Write()
    arrays, grid = found(path)
    check(arrays, "p", PRESSURE, "points")
    check(arrays, "u", VELOCITY, "points", 3)
    check(arrays, "m", MATERIAL, "cells")
    assert (grid.n_points, grid.n_cells) == (np.prod(SHAPE), np.prod(CELLS))
    top = [n - 1 if kind == "image" else (n - 1) ** 2 for n in SHAPE[::-1]]
    np.testing.assert_allclose(grid.bounds, [[0, 0, 0], top])
    said = wavesplat("info", path)
    assert said.returncode == 0, said.stderr
    assert "arrays       3, choose with --dataset:\n" in said.stdout
    assert "float32, 3 components, points, " in said.stdout
    assert ("resample=N" in said.stdout) == (kind != "image")


def test_a_mesh_has_its_arrays_listed_though_it_is_no_volume(tmp_path, wavesplat):
    mesh = "# vtk DataFile Version 3.0\nm\nASCII\nDATASET POLYDATA\nPOINTS 3 float\n0 0 0 1 0 0 0 2 0\n"
    path = tmp_path / "a.vtk"
    path.write_text(f"{mesh}POLYGONS 1 4\n3 0 1 2\nPOINT_DATA 3\nSCALARS t float 1\nLOOKUP_TABLE default\n4 5 6\n")
    pytest.importorskip("vtkmodules")
    said = json.loads(wavesplat("info", path, "--json").stdout)
    assert [array["ranges"] for array in said["arrays"]] == [[[4.0, 6.0]]]
    assert said["grid"]["n_points"] == 3
    assert "no samples inside" in said["problem"]


def test_arrays_of_other_files(tmp_path):
    np.savez(tmp_path / "a.npz", p=PRESSURE, u=VELOCITY, m=MATERIAL)
    with h5py.File(tmp_path / "a.h5", "w") as file:
        file["p"], file["u"], file["flat"] = PRESSURE, VELOCITY, np.arange(3)
        mesh = file.create_group("data/1/meshes/E")
        mesh.attrs["gridSpacing"] = np.ones(3)
        for number, axis in enumerate("xyz"):
            mesh[axis] = VELOCITY[..., number]
    for name in ("a.npz", "a.h5"):
        arrays, _ = found(tmp_path / name)
        check(arrays, "p", PRESSURE, None)
        check(arrays, "u", VELOCITY, None, 3)
    check(arrays, "data/1/meshes/E", VELOCITY, None, 3)
    assert set(arrays) == {"p", "u", "data/1/meshes/E"}
    axes = ("lev", "lat", "lon")
    places = {axis: np.arange(n) for axis, n in zip(axes, CELLS, strict=True)}
    save_netcdf3(tmp_path / "a.nc", {"m": (axes, MATERIAL), "t": (axes, 2 * MATERIAL)}, places, scale_factor=0.5)
    arrays, _ = found(tmp_path / "a.nc")
    assert arrays["t"][3].tolist() == [[MATERIAL.min(), MATERIAL.max()]]


def test_of_several_arrays_the_active_one_is_drawn_and_said(tmp_path):
    names = {"a": SHAPE, "b": SHAPE, "c": SHAPE}
    path = save_vti(
        tmp_path / "a.vti", {name: np.full(shape, k, np.uint8) for k, (name, shape) in enumerate(names.items())}
    )
    path.write_bytes(path.read_bytes().replace(b"<PointData", b'<PointData Scalars="b"', 1))
    volume = ws.open(path)
    assert volume.samples.max() == 1
    assert volume.guesses[0].startswith("shown: b, the active one of 3 arrays (a, b, c)")


def test_ranges_of_other_files_samples_are_not_looked_at(tmp_path):
    with h5py.File(tmp_path / "b.h5", "w") as file:
        file["p"] = PRESSURE
    layout = h5py.VirtualLayout(SHAPE, float)
    layout[:] = h5py.VirtualSource(str(tmp_path / "b.h5"), "p", SHAPE)
    with h5py.File(tmp_path / "a.h5", "w") as file:
        file.create_virtual_dataset("v", layout)
    arrays, _ = found(tmp_path / "a.h5")
    assert arrays["v"][3].size == 0


@pytest.mark.parametrize("name", ["a.vti", "a.h5", "a.npz"])
def test_large_files_are_listed_without_reading_all(tmp_path, monkeypatch, name):
    for module in (file_contents, arrays, vti):
        monkeypatch.setattr(module, "MAX_BYTES", 100)
    if name == "a.vti":
        save_vti(tmp_path / name, {"p": np.zeros(SHAPE)})
    elif name == "a.npz":
        np.savez(tmp_path / name, p=np.zeros(SHAPE))
    else:
        with h5py.File(tmp_path / name, "w") as file:
            file["p"] = np.zeros(SHAPE)
    found_arrays, _ = found(tmp_path / name)
    assert found_arrays["p"][:2] == ("float64", 1)
    assert found_arrays["p"][3].size == 0
