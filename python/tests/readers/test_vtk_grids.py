"""VTK's grids that are no images: read where they are even, sampled where it is asked for, not called damaged (F5)."""

import sys

import numpy as np
import pytest

import wavesplat as ws
from wavesplat.errors import ArgumentError, FileError

pytest.importorskip("vtkmodules")

import vtkmodules.vtkCommonDataModel as data_model  # noqa: N813
from vtkmodules import vtkIOLegacy, vtkIOParallelXML, vtkIOXML
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkPoints
from vtkmodules.vtkFiltersCore import vtkAppendFilter, vtkProbeFilter

# VTK, PyVista and xarray take seconds to load: one process does.
pytestmark = pytest.mark.xdist_group("vtk")

#: Samples along z, y, x, and their places.
SHAPE = (4, 5, 6)
EVEN = {"x": 0.5 + 0.25 * np.arange(6), "y": -1 + 0.5 * np.arange(5), "z": 2.0 * np.arange(4)}
UNEVEN = {**EVEN, "x": np.array([0, 0.1, 0.3, 0.7, 1.5, 3.1])}


def values_at(x, y, z):
    """A function that is linear along x, y and z, so that VTK interpolates it exactly."""
    return (1 + x) * (2 - y) + 3 * z


def put(grid, name, values, *, of_cells=False):
    flat = np.reshape(values, (-1, values.shape[-1])) if values.ndim == 4 else np.ravel(values)
    array = numpy_to_vtk(np.ascontiguousarray(flat), deep=1)
    array.SetName(name)
    (grid.GetCellData() if of_cells else grid.GetPointData()).AddArray(array)
    return grid


def places(axes):
    return np.meshgrid(axes["z"], axes["y"], axes["x"], indexing="ij")


def rectilinear(axes):
    grid = data_model.vtkRectilinearGrid()
    grid.SetDimensions(*(len(axes[axis]) for axis in "xyz"))
    for axis in "xyz":
        getattr(grid, f"Set{axis.upper()}Coordinates")(numpy_to_vtk(axes[axis], deep=1))
    return grid


def structured(axes, move=lambda x, y, z: (x, y, z)):
    grid = data_model.vtkStructuredGrid()
    grid.SetDimensions(*(len(axes[axis]) for axis in "xyz"))
    z, y, x = places(axes)
    points = vtkPoints()
    points.SetData(numpy_to_vtk(np.stack([np.ravel(part) for part in move(x, y, z)], -1), deep=1))
    grid.SetPoints(points)
    return grid


def unstructured(grid):
    append = vtkAppendFilter()
    append.AddInputData(grid)
    append.Update()
    return append.GetOutput()


def filled(grid, axes):
    z, y, x = places(axes)
    return put(grid, "v", values_at(x, y, z))


def write(path, grid, writer=None):
    made = (writer or getattr(vtkIOXML, f"vtkXML{grid.GetClassName().removeprefix('vtk')}Writer"))()
    made.SetFileName(str(path))
    made.SetInputData(grid)
    made.Write()
    return path


def write_legacy(path, grid, *, as_text=False):
    writer = vtkIOLegacy.vtkGenericDataObjectWriter()
    (writer.SetFileTypeToASCII if as_text else writer.SetFileTypeToBinary)()
    writer.SetFileName(str(path))
    writer.SetInputData(grid)
    writer.Write()
    return path


def world_places(volume):
    k, j, i = np.indices(volume.shape)
    matrix = volume.world_from_index
    return tuple(matrix[a, 0] * i + matrix[a, 1] * j + matrix[a, 2] * k + matrix[a, 3] for a in range(3))


WAYS = {
    ".vtr": lambda folder, axes: write(folder / "a.vtr", filled(rectilinear(axes), axes)),
    ".vts": lambda folder, axes: write(folder / "a.vts", filled(structured(axes), axes)),
    "rectilinear.vtk": lambda folder, axes: write_legacy(folder / "a.vtk", filled(rectilinear(axes), axes)),
    "structured.vtk": lambda folder, axes: write_legacy(folder / "a.vtk", filled(structured(axes), axes), as_text=True),
}


@pytest.mark.parametrize("way", WAYS)
def test_even_grids_are_read_as_they_are_f5(tmp_path, way):
    path = WAYS[way](tmp_path, EVEN)
    volume = ws.open(path)
    z, y, x = places(EVEN)
    np.testing.assert_array_equal(volume.samples, values_at(x, y, z))
    for got, expected in zip(world_places(volume), (x, y, z), strict=True):
        np.testing.assert_allclose(got, expected, atol=1e-12)
    assert volume.guesses == ()


def test_places_off_by_less_than_a_ten_thousandth_are_even(tmp_path):
    axes = {**EVEN, "x": EVEN["x"] + 0.25 * 0.9e-4 * np.array([0, 1, -1, 1, -1, 0])}
    assert ws.open(WAYS[".vtr"](tmp_path, axes)).spacing == pytest.approx((0.25, 0.5, 2))
    assert ws.open(WAYS[".vts"](tmp_path, axes)).spacing == pytest.approx((0.25, 0.5, 2))
    axes["x"] = EVEN["x"] + 0.25 * 3e-4 * np.array([0, 1, -1, 1, -1, 0])
    with pytest.raises(FileError, match="resample=N"):
        ws.open(WAYS[".vtr"](tmp_path, axes))


@pytest.mark.parametrize("suffix", [".vtr", ".vts"])
def test_single_precision_is_even_within_its_rounding(tmp_path, suffix):
    """Near 5e6, a place of a map in metres, numbers of single precision are multiples of a half."""
    x = (5e6 + 1.7 * np.arange(6)).astype(np.float32)
    assert np.ptp(np.diff(x)) == 0.5
    axes = {"x": x, "y": np.arange(5, dtype=np.float32), "z": np.arange(4, dtype=np.float32)}
    made = {".vtr": rectilinear, ".vts": structured}[suffix]
    volume = ws.open(write(tmp_path / f"a{suffix}", filled(made(axes), axes)))
    assert volume.spacing == pytest.approx((1.7, 1, 1), rel=0.1)
    assert volume.shape == (4, 5, 6)
    axes["y"] = np.array([0, 1, 2.1, 3, 4], np.float32)  # not rounded at all
    with pytest.raises(FileError, match="resample=N"):
        ws.open(write(tmp_path / f"b{suffix}", filled(made(axes), axes)))


def test_cells_have_their_samples_in_their_middles(tmp_path):
    cells = np.arange(3 * 4 * 5, dtype=np.int16).reshape(3, 4, 5)
    for grid, name in ((rectilinear(EVEN), "a.vtr"), (structured(EVEN), "a.vts")):
        volume = ws.open(write(tmp_path / name, put(grid, "c", cells, of_cells=True)))
        np.testing.assert_array_equal(volume.samples, cells)
        assert volume.samples.dtype == np.int16
        np.testing.assert_allclose(volume.world_from_index[:3, 3], (0.625, -0.75, 1))


def test_skewed_grids_are_even_too(tmp_path):
    grid = filled(structured(EVEN, lambda x, y, z: (x + 0.5 * y, y, z - 0.25 * x)), EVEN)
    volume = ws.open(write(tmp_path / "a.vts", grid))
    z, y, x = places(EVEN)
    np.testing.assert_array_equal(volume.samples, values_at(x, y, z))
    for got, expected in zip(world_places(volume), (x + 0.5 * y, y, z - 0.25 * x), strict=True):
        np.testing.assert_allclose(got, expected, atol=1e-12)


@pytest.mark.parametrize("way", [*WAYS, ".vtu", "unstructured.vtk"])
def test_other_grids_are_refused_or_sampled(tmp_path, way):
    if way == ".vtu":
        path = write(tmp_path / "a.vtu", unstructured(filled(rectilinear(UNEVEN), UNEVEN)))
    elif way == "unstructured.vtk":
        path = write_legacy(tmp_path / "a.vtk", unstructured(filled(structured(UNEVEN), UNEVEN)))
    else:
        path = WAYS[way](tmp_path, UNEVEN)
    with pytest.raises(FileError, match=r"grid.* resample=N \(--resample N\)") as error:
        ws.open(path)
    assert "damaged" not in str(error.value)
    volume = ws.open(path, resample=25)
    assert max(volume.shape) == 25
    np.testing.assert_allclose(volume.samples, values_at(*world_places(volume)), atol=1e-4)
    np.testing.assert_allclose(volume.bounds, [[0, -1, 0], [3.1, 1, 6]], atol=1e-4)
    (told,) = volume.guesses
    # The smallest cell is 0.1 x 0.5 x 2, the largest 1.6 x 0.5 x 2.
    for words in ("grid", "13 x 9 x 25 places", "cells are 0.464 to 1.17 wide", "0.0% of the samples lie outside"):
        assert words in told


def test_samples_outside_of_a_grid_are_missing(tmp_path):
    grid = filled(structured(EVEN, lambda x, y, z: (x, y + x, z)), EVEN)
    grid.GetPoints().SetPoint(30 + 2 * 6 + 2, 1, 0.51, 2)  # one inside is off: no longer even
    volume = ws.open(write(tmp_path / "a.vts", grid), resample=40)
    x, y, _ = world_places(volume)
    inside = np.abs(y - x) < 0.9
    outside = np.abs(y - x) > 1.1
    assert np.isfinite(volume.samples[:, inside[0]]).all()
    assert np.isnan(volume.samples[:, outside[0]]).all()
    share = np.isnan(volume.samples).mean()
    assert f"{share:.1%} of the samples lie outside" in volume.guesses[0]


def test_sampled_values_are_those_of_vtk_itself(tmp_path):
    grid = structured(EVEN, lambda x, y, z: (x, y, z + 0.3 * np.sin(3 * x) * y))
    put(grid, "v", np.random.default_rng(1).random(SHAPE))
    volume = ws.open(write(tmp_path / "a.vts", grid), resample=20)
    points = vtkPoints()
    points.SetData(numpy_to_vtk(np.stack([np.ravel(part) for part in world_places(volume)], -1), deep=1))
    places_of_samples = data_model.vtkPolyData()
    places_of_samples.SetPoints(points)
    probe = vtkProbeFilter()
    probe.SetInputData(places_of_samples)
    probe.SetSourceData(grid)
    probe.Update()
    expected = vtk_to_numpy(probe.GetOutput().GetPointData().GetArray("v"))
    is_valid = vtk_to_numpy(probe.GetOutput().GetPointData().GetArray("vtkValidPointMask")) != 0
    got = np.ravel(volume.samples)
    both = is_valid & np.isfinite(got)
    assert both.mean() > 0.8
    assert (is_valid != np.isfinite(got)).mean() < 0.05  # on the very border one of both may say outside
    np.testing.assert_allclose(got[both], expected[both], atol=1e-5)


def image(first, size):
    grid = data_model.vtkImageData()
    grid.SetExtent(*(end for a, n in zip(first, size, strict=True) for end in (a, a + n - 1)))
    grid.SetSpacing(0.25, 0.5, 2)
    grid.SetOrigin(0.5, -1, 0)
    return grid


def test_an_image_in_several_files(tmp_path):
    writer = vtkIOParallelXML.vtkXMLPImageDataWriter()
    grid = filled(image((0, 0, 0), SHAPE[::-1]), EVEN)
    writer.SetFileName(str(tmp_path / "a.pvti"))
    writer.SetInputData(grid)
    writer.SetNumberOfPieces(1)
    writer.Write()
    assert len(list(tmp_path.iterdir())) > 1
    volume = ws.open(tmp_path / "a.pvti")
    z, y, x = places(EVEN)
    np.testing.assert_array_equal(volume.samples, values_at(x, y, z))
    np.testing.assert_allclose(world_places(volume)[0], x)


def blocks(path):
    whole = data_model.vtkMultiBlockDataSet()
    for number, first in enumerate((0, 5)):
        axes = {**EVEN, "x": 0.5 + 0.25 * (first + np.arange(6))}
        whole.SetBlock(number, filled(rectilinear(axes), axes))
    return write(path, whole, vtkIOXML.vtkXMLMultiBlockDataWriter)


def test_blocks_are_sampled_together(tmp_path):
    path = blocks(tmp_path / "a.vtm")
    with pytest.raises(FileError, match="several blocks"):
        ws.open(path)
    volume = ws.open(path, resample=25)
    np.testing.assert_allclose(volume.bounds[:, 0], (0.5, 3), atol=1e-4)
    np.testing.assert_allclose(volume.samples, values_at(*world_places(volume)), atol=1e-4)


def test_files_do_not_name_others_elsewhere(tmp_path):
    (tmp_path / "own").mkdir()
    path = blocks(tmp_path / "own" / "a.vtm")
    piece = next((tmp_path / "own" / "a").glob("*_0.vtr"))
    piece.rename(tmp_path / "secret.vtr")
    text = path.read_text()
    for name in ("../secret.vtr", "&#46;&#46;/secret.vtr"):
        path.write_text(text.replace(f"a/{piece.name}", name))
        with pytest.raises(FileError, match="external_files=True"):
            ws.open(path, resample=10)
        assert ws.open(path, resample=10, external_files=True).shape
    path.write_text(text)
    with pytest.raises(FileError, match="which is not there; copy it too"):
        ws.open(path, resample=10)


def test_several_arrays_and_vectors(tmp_path):
    grid = filled(rectilinear(UNEVEN), UNEVEN)
    z, y, x = places(UNEVEN)
    put(grid, "u", np.stack([x, 2 * y, z], -1))
    path = write(tmp_path / "a.vtr", grid)
    assert ws.open(path, resample=10).guesses[0].startswith("shown: v, the first of 2 arrays (v, u); dataset=NAME")
    volume = ws.open(path, resample=10, dataset="u", component="y")
    np.testing.assert_allclose(volume.samples, 2 * world_places(volume)[1], atol=1e-4)
    volume = ws.open(path, resample=10, dataset="u")
    assert "holds vectors, of which the length is drawn" in volume.guesses[-1]
    with pytest.raises(ArgumentError, match="'v' has 1 number"):
        ws.open(path, resample=10, dataset="v", component="y")


def test_arrays_that_number_points_and_cells_come_last(tmp_path):
    grid = rectilinear(UNEVEN)
    for name in ("vtkOriginalPointIds", "GlobalNodeId"):
        put(grid, name, np.arange(grid.GetNumberOfPoints(), dtype=float))
    grid.GetPointData().SetActiveScalars("GlobalNodeId")
    assert "shown: GlobalNodeId, the active one of 2" in ws.open(write(tmp_path / "a.vtr", grid), resample=8).guesses[0]
    z, y, x = places(UNEVEN)
    path = write(tmp_path / "b.vtr", put(grid, "v", values_at(x, y, z)))
    assert ws.open(path, resample=8).guesses[0].startswith("shown: v, one of 3 arrays")


def test_cells_in_bytes_need_no_end_of_a_line(tmp_path):
    """The first cells of a file in bytes have no byte of value 10, so no line ends there."""
    corners = np.array([[0, 0, 0], [4, 0, 0], [0, 4, 0], [0, 0, 4]])
    points = np.concatenate([np.zeros((11, 3)), *[corners] * 20]).astype(">f4")
    numbers = 11 + np.arange(80).reshape(20, 4)
    content = f"# vtk DataFile Version 3.0\n\nBINARY\nDATASET UNSTRUCTURED_GRID\nPOINTS {len(points)} float\n".encode()
    content += points.tobytes() + b"\nCELLS 20 100\n" + np.insert(numbers, 0, 4, axis=1).astype(">i4").tobytes()
    content += b"\nCELL_TYPES 20\n" + np.full(20, 10, ">i4").tobytes() + b"\nPOINT_DATA 91\nSCALARS v float\n"
    (tmp_path / "a.vtk").write_bytes(content + b"LOOKUP_TABLE default\n" + points.sum(axis=1).astype(">f4").tobytes())
    volume = ws.open(tmp_path / "a.vtk", resample=9)
    inside = np.isfinite(volume.samples)
    assert inside.any()
    np.testing.assert_allclose(volume.samples[inside], sum(world_places(volume))[inside], atol=1e-5)


@pytest.mark.parametrize("suffix", [".vtr", ".vtu", ".vtm"])
def test_lengths_are_those_of_interpolated_vectors(tmp_path, suffix):
    """Vectors turn round within a cell, where the interpolated length would be far too large."""
    z, y, x = places(UNEVEN)
    grid = put(rectilinear(UNEVEN), "u", np.stack([x - 0.4, 2 * y - 0.5, z - 3], -1))
    grid = unstructured(grid) if suffix == ".vtu" else grid
    if suffix == ".vtm":
        several = data_model.vtkMultiBlockDataSet()
        several.SetBlock(0, grid)
        several.SetBlock(1, unstructured(rectilinear(UNEVEN)))
        grid = several
    path = write(tmp_path / f"a{suffix}", grid, vtkIOXML.vtkXMLMultiBlockDataWriter if suffix == ".vtm" else None)
    volume = ws.open(path, resample=30, component="magnitude")
    x, y, z = world_places(volume)
    inside = np.isfinite(volume.samples)
    assert inside.mean() > 0.8
    expected = np.sqrt((x - 0.4) ** 2 + (2 * y - 0.5) ** 2 + (z - 3) ** 2)
    np.testing.assert_allclose(volume.samples[inside], expected[inside], atol=2e-5)
    assert volume.facts.quantity == "u magnitude"


def test_what_cannot_be_sampled_is_said(tmp_path, monkeypatch):
    with pytest.raises(ArgumentError, match="resample is 1; give a number of samples, 2 to"):
        ws.open(WAYS[".vtr"](tmp_path, UNEVEN), resample=1)
    with pytest.raises(ArgumentError, match="parts cannot be read"):
        ws.open(tmp_path / "a.vtr", memory="1 MB")
    flat = {**UNEVEN, "z": np.array([0.0])}
    with pytest.raises(FileError, match="the grid is flat"):
        ws.open(WAYS[".vtr"](tmp_path, flat), resample=9)
    surface = data_model.vtkPolyData()
    surface.SetPoints(structured(EVEN).GetPoints())
    with pytest.raises(FileError, match="a mesh of surfaces or lines.*no samples inside"):
        ws.open(write(tmp_path / "a.vtp", surface))
    with pytest.raises(FileError, match="a mesh of surfaces or lines.*no samples inside"):
        ws.open(write_legacy(tmp_path / "b.vtk", surface))
    monkeypatch.setitem(sys.modules, "vtkmodules", None)
    with pytest.raises(ws.errors.LibraryError, match=r"vtk\]"):
        ws.open(WAYS[".vts"](tmp_path, EVEN))


def test_arrays_of_points_and_cells_of_one_name(tmp_path):
    grid = filled(rectilinear(EVEN), EVEN)
    name, n_cells = grid.GetPointData().GetArray(0).GetName(), grid.GetNumberOfCells()
    put(grid, name, np.arange(n_cells, dtype=float), of_cells=True)
    path = write(tmp_path / "a.vtr", grid)
    assert ws.open(path, dataset=name).samples.size == grid.GetNumberOfPoints()
    np.testing.assert_array_equal(np.ravel(ws.open(path, dataset=f"{name} of cells").samples), np.arange(n_cells))


@pytest.mark.parametrize("of_cells", [True, False])
def test_what_a_file_hides_is_not_drawn(tmp_path, of_cells):
    grid = filled(rectilinear(EVEN), EVEN)
    n_cells = grid.GetNumberOfCells()
    put(grid, "c", np.arange(n_cells, dtype=np.int16), of_cells=True)
    ghosts = np.zeros((3, 4, 5), np.uint8)
    ghosts[1:, 2:, :3], ghosts[0, 0, 0] = 32, 1  # hidden, and only a copy of another block's
    put(grid, "vtkGhostType", ghosts, of_cells=True)
    volume = ws.open(write(tmp_path / "a.vtr", grid), dataset="c" if of_cells else "v")
    hidden = np.zeros(volume.shape, bool)
    if of_cells:
        hidden[1:, 2:, :3] = True
    else:  # points that touch no cell that is seen
        hidden[2:, 3:, :3] = True
    np.testing.assert_array_equal(np.isnan(volume.samples), hidden)
    assert "are hidden by the file" in volume.guesses[-1]


def test_what_an_image_hides_is_not_drawn(tmp_path):
    picture = data_model.vtkImageData()
    picture.SetDimensions(6, 5, 4)
    put(picture, "c", np.arange(60, dtype=np.int16), of_cells=True)
    ghosts = np.zeros((3, 4, 5), np.uint8)
    ghosts[1:, 2:, :3] = 32
    put(picture, "vtkGhostType", ghosts, of_cells=True)
    volume = ws.open(write(tmp_path / "a.vti", picture))
    np.testing.assert_array_equal(np.isnan(volume.samples), ghosts == 32)
    np.testing.assert_array_equal(volume.samples[ghosts == 0], np.arange(60).reshape(3, 4, 5)[ghosts == 0])


def test_cells_of_a_flat_image_are_a_plane(tmp_path):
    picture = data_model.vtkImageData()
    picture.SetDimensions(6, 5, 1)
    put(picture, "c", np.arange(20.0), of_cells=True)
    with pytest.raises(FileError, match="a single plane of x 5, y 4, z 1 samples"):
        ws.open(write(tmp_path / "a.vti", picture))


def test_one_even_block_is_read_as_it_is(tmp_path):
    whole = data_model.vtkMultiBlockDataSet()
    whole.SetBlock(1, filled(rectilinear(EVEN), EVEN))
    writer = vtkIOXML.vtkXMLMultiBlockDataWriter()
    writer.SetFileName(str(tmp_path / "a.vtm"))
    writer.SetInputData(whole)
    writer.Write()
    volume = ws.open(tmp_path / "a.vtm")
    np.testing.assert_allclose(volume.samples, values_at(*world_places(volume)), rtol=1e-6)


def test_grids_that_hold_nothing_to_draw(tmp_path):
    with pytest.raises(FileError, match="a grid without an array of numbers"):
        ws.open(write(tmp_path / "a.vtr", rectilinear(EVEN)))
    surfaces = data_model.vtkUnstructuredGrid()
    points = vtkPoints()
    points.SetData(numpy_to_vtk(np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]), deep=1))
    surfaces.SetPoints(points)
    for corners in ((0, 1, 2), (0, 1, 3), (0, 2, 3)):
        surfaces.InsertNextCell(5, 3, corners)
    put(surfaces, "v", np.arange(4.0))
    path = write(tmp_path / "a.vtu", surfaces)
    for resample in (None, 9):
        with pytest.raises(FileError, match="surfaces or lines .* no samples inside"):
            ws.open(path, resample=resample)
    (tmp_path / "a.pvd").write_text('<VTKFile type="Collection"><Collection/></VTKFile>')
    with pytest.raises(FileError, match="the list names no file"):
        ws.open(tmp_path / "a.pvd")


def test_damage_is_said_without_words_of_vtk(tmp_path, capfd):
    for save in WAYS.values():
        path = save(tmp_path, EVEN)
        content = path.read_bytes()
        for part in (0.1, 0.3, 0.6, 0.8, 0.95):
            path.write_bytes(content[: int(part * len(content))])
            with pytest.raises(FileError):
                ws.open(path)
    for text in (
        '<?xml version="1.0"?><!DOCTYPE a [<!ENTITY b "c">]><VTKFile type="RectilinearGrid"></VTKFile>',
        '<VTKFile type="UnstructuredGrid"><UnstructuredGrid><Piece NumberOfPoints="99999999999" NumberOfCells="0"/>',
        '<VTKFile type="RectilinearGrid"><RectilinearGrid><Piece Extent="0 9999 0 9999 0 9999"/></RectilinearGrid>',
    ):
        (tmp_path / "b.vtr").write_text(text)
        with pytest.raises(FileError):
            ws.open(tmp_path / "b.vtr")
    assert capfd.readouterr().err == ""


@pytest.mark.parametrize(
    ("old", "new"),
    [
        (b"0.1 -1 0", b"0j1 -1 0"),
        (b"0.1 -1 0", b"0_1 -1 0"),
        (b"DIMENSIONS 6 5 4", b"DIMENSIONS 6 5 5"),
        (b"POINT_DATA 120", b"POINT_DATA 100"),
        (b"Version 5", b"VersionR5"),
        (b"Version 5.1\nvtk output\nASCII\nDATASET UNSTR", b"Version 3.0\nvtk output\nASCII\nDATASET UNSTR"),
        (b"0 1 7 6 ", b"0 1 7 999 "),
        (b"0 8 16 24 ", b"0 8 6 24 "),
        (b"\n12\n12", b"\n12\n10"),
    ],
)
def test_what_would_end_the_process_is_refused(tmp_path, old, new):
    grids = (filled(structured(UNEVEN), UNEVEN), unstructured(filled(structured(UNEVEN), UNEVEN)))
    n_changed = 0
    for grid in grids:
        path = write_legacy(tmp_path / "a.vtk", grid, as_text=True)
        content = path.read_bytes()
        n_changed += old in content
        path.write_bytes(content.replace(old, new, 1))
        if old in content:
            with pytest.raises(FileError):
                ws.open(path, resample=9)
    assert n_changed > 0


@pytest.mark.parametrize(("first", "second"), [("f4", "f8"), ("i2", "i4"), ("u1", "f4"), ("f4", None)])
def test_blocks_may_differ_in_type_and_lack_an_array(tmp_path, first, second):
    whole = data_model.vtkMultiBlockDataSet()
    for number, (start, dtype) in enumerate(((0, first), (5, second))):
        axes = {**EVEN, "x": start + np.arange(6.0), "y": np.arange(5.0), "z": np.arange(4.0)}
        grid = rectilinear(axes)
        _, y, x = places(axes)
        if dtype is not None:
            put(grid, "v", (x + 2 * y).astype(dtype))
        put(grid, "w", x)
        whole.SetBlock(number, grid)
    path = write(tmp_path / "a.vtm", whole, vtkIOXML.vtkXMLMultiBlockDataWriter)
    volume = ws.open(path, resample=11, dataset="v")
    x, y, _ = world_places(volume)
    assert volume.bounds[1, 0] == pytest.approx(5 if second is None else 10, abs=1e-4)
    np.testing.assert_allclose(volume.samples, x + 2 * y, atol=1e-3)
    assert ("blocks without 'v', which are left out: 1 of 2" in volume.guesses) == (second is None)


def test_an_image_in_several_files_has_directions(tmp_path):
    grid = filled(image((0, 0, 0), SHAPE[::-1]), EVEN)
    grid.SetDirectionMatrix([0, -1, 0, 1, 0, 0, 0, 0, 1])
    whole = ws.open(write(tmp_path / "a.vti", grid))
    writer = vtkIOParallelXML.vtkXMLPImageDataWriter()
    writer.SetFileName(str(tmp_path / "a.pvti"))
    writer.SetInputData(grid)
    writer.SetNumberOfPieces(1)
    writer.Write()
    volume = ws.open(tmp_path / "a.pvti")
    np.testing.assert_array_equal(volume.world_from_index, whole.world_from_index)
    np.testing.assert_array_equal(volume.samples, whole.samples)
    # Said in the file itself, as others write it.
    text = (tmp_path / "a.pvti").read_text()
    (tmp_path / "a.pvti").write_text(text.replace("<PImageData ", '<PImageData Direction="1 0 0 0 1 0 0 0 1" '))
    with pytest.raises(FileError, match="2 different directions"):
        ws.open(tmp_path / "a.pvti")
