"""Adaptive meshes: levels of VTK files on one grid, and covering grids of yt, beside independent sampling."""

import numpy as np
import pytest
from foreign_fakes import of_library

import wavesplat as ws
from wavesplat.errors import ArgumentError, FileError

# VTK, PyVista and xarray take seconds to load: one process does.
pytestmark = pytest.mark.xdist_group("vtk")

#: Boxes of three levels: level, lowest corner, cells x, y, z. Sides of cells are 1, 1/2, 1/4.
BOXES = [
    (0, (0, 0, 0), (8, 6, 4)),
    (1, (2, 2, 1), (4, 4, 4)),
    (1, (4, 1, 1), (4, 6, 4)),
    (2, (2.5, 2.5, 1.5), (4, 6, 4)),
]


def values_of(number, n):
    return (100 * number + np.random.default_rng(number).random(n[::-1])).astype(np.float32)


def value_at(point, finest):
    """The value of the finest box that holds a point, up to a level; NaN where none does."""
    found = np.nan
    for number, (level, low, n) in enumerate(BOXES):
        index = np.floor((np.array(point) - low) * 2**level + 1e-9).astype(int)
        if level <= finest and (index >= 0).all() and (index < n).all():
            found = values_of(number, n)[tuple(index[::-1])]
    return found


@pytest.fixture
def mesh(tmp_path):
    """A function that writes boxes to a .vthb file."""
    pytest.importorskip("vtkmodules")
    from vtkmodules import vtkCommonDataModel, vtkIOXML
    from vtkmodules.util.numpy_support import numpy_to_vtk

    def write(boxes, *, scale=1.0, name="density", values_of=values_of):
        amr = vtkCommonDataModel.vtkOverlappingAMR()
        counts = [sum(level == k for level, _, _ in boxes) for k in range(1 + max(level for level, _, _ in boxes))]
        try:
            amr.Initialize(counts)
        except TypeError:  # before VTK 9.5
            amr.Initialize(len(counts), counts)
        amr.SetOrigin([0, 0, 0])
        amr.SetGridDescription(8)  # x, y, z
        seen = [0] * len(counts)
        for number, (level, low, n) in enumerate(boxes):
            grid, side = vtkCommonDataModel.vtkUniformGrid(), scale / 2**level
            grid.SetOrigin(scale * np.array(low))
            grid.SetSpacing(side, side, side)
            grid.SetDimensions([cells + 1 for cells in n])
            array = numpy_to_vtk(np.squeeze(values_of(number, n).reshape(np.prod(n), -1)), deep=1)
            array.SetName(name)
            grid.GetCellData().AddArray(array)
            amr.SetSpacing(level, [side] * 3)
            box = vtkCommonDataModel.vtkAMRBox(grid.GetOrigin(), [cells + 1 for cells in n], [side] * 3, [0, 0, 0])
            amr.SetAMRBox(level, seen[level], box)
            amr.SetDataSet(level, seen[level], grid)
            seen[level] += 1
        writer = vtkIOXML.vtkXMLUniformGridAMRWriter()
        writer.SetFileName(str(tmp_path / "a.vthb"))
        writer.SetInputData(amr)
        writer.Write()
        return tmp_path / "a.vthb"

    return write


@pytest.mark.parametrize(("resample", "level"), [(8, 0), (15, 0), (16, 1), (32, 2), (1000, 2), (2, 0)])
def test_levels_are_drawn_on_the_grid_of_the_one_that_is_asked_for(mesh, resample, level):
    volume = ws.open(mesh(BOXES, scale=3.0), resample=resample)
    assert volume.shape == (4 * 2**level, 6 * 2**level, 8 * 2**level)
    assert volume.samples.dtype == np.float32
    assert volume.spacing == pytest.approx((3 / 2**level,) * 3)
    for index in np.random.default_rng(1).integers(0, volume.shape, (200, 3)):
        world = volume.world_from_index @ [*index[::-1], 1]
        assert volume.samples[tuple(index)] == value_at(world[:3] / 3, level)
    (told,) = volume.guesses
    assert f"on the grid of level {level} of 0 to 2" in told
    assert "for 448 cells" in told


def test_a_mesh_without_a_level_says_which_there_are(mesh):
    with pytest.raises(FileError, match=r"level 0: 8 x 6 x 4, 1: 16 x 12 x 8, 2: 32 x 24 x 16; resample=N"):
        ws.open(mesh(BOXES))


def test_cells_that_only_finer_levels_have_are_their_means(mesh):
    # Of a mesh whose coarse boxes leave out what finer ones have.
    boxes = [(0, (0, 0, 0), (4, 4, 4)), (1, (4, 0, 0), (4, 8, 8))]
    volume = ws.open(mesh(boxes), resample=6)
    assert volume.shape == (4, 4, 6)
    np.testing.assert_allclose(volume.samples[:, :, :4], values_of(0, (4, 4, 4)))
    means = values_of(1, (4, 8, 8)).reshape(4, 2, 4, 2, 2, 2).mean(axis=(1, 3, 5))
    np.testing.assert_allclose(volume.samples[:, :, 4:], means, rtol=1e-6)
    assert "50.0%" not in volume.guesses[0]


def test_lengths_are_those_of_averaged_vectors(mesh):
    """Of vectors that cancel each other in a cell of the grid nothing is left."""

    def opposite(number, n):
        signs = (-1.0) ** np.indices(n[::-1]).sum(axis=0)
        return np.stack([signs if number else np.full(n[::-1], 3.0), np.full(n[::-1], 4.0), 0 * signs], axis=-1)

    path = mesh([(0, (0, 0, 0), (4, 4, 4)), (1, (4, 0, 0), (4, 8, 8))], name="B", values_of=opposite)
    volume = ws.open(path, resample=6)
    assert volume.facts.quantity == "B magnitude"
    assert np.allclose(volume.samples[:, :, :4], 5)
    assert np.allclose(volume.samples[:, :, 4:], 4)
    parts = [ws.open(path, resample=6, component=axis).samples for axis in "xyz"]
    assert np.allclose(volume.samples, np.sqrt(sum(np.square(part) for part in parts)))


def test_places_without_cells_are_missing(mesh):
    volume = ws.open(mesh([(0, (0, 0, 0), (2, 2, 2)), (0, (4, 0, 0), (2, 2, 2))]), resample=9)
    assert np.isnan(volume.samples[:, :, 2:4]).all()
    assert np.isfinite(volume.samples[:, :, :2]).all()
    assert "33.3% lie outside" in volume.guesses[0]


def test_boxes_between_cells_are_refused(mesh):
    with pytest.raises(FileError, match="a box of level 1 does not begin at a cell"):
        ws.open(mesh([(0, (0, 0, 0), (4, 4, 4)), (1, (1.2, 1, 1), (4, 4, 4))]), resample=8)


# yt


@of_library("unyt")
class Quantity(np.ndarray):
    """An array with a unit, as unyt has."""

    units = "g/cm**3"


def with_unit(values, units):
    array = np.asarray(values).view(Quantity)
    array.units = units
    return array


@of_library("yt")
class CoveringGrid:
    """A covering grid of yt: cells [x, y, z]."""

    ds = object()

    def __init__(self, unit="code_length", **fields):
        self.field_data = {("gas", name): values for name, values in fields.items()}
        self.ActiveDimensions = np.array([4, 5, 6])
        self.left_edge = with_unit([1.0, 2, 3], unit)
        self.dds = with_unit([0.5, 0.25, 0.125], unit)


DENSITY = with_unit(np.arange(120.0).reshape(4, 5, 6), "g/cm**3")


def test_covering_grids_of_yt_are_taken_in_their_order_of_axes():
    volume = ws.Volume(CoveringGrid(density=DENSITY))
    assert volume.shape == (6, 5, 4)
    assert np.array_equal(volume.samples, np.asarray(DENSITY).T)
    assert volume.world_from_index[:3, 3] == pytest.approx((1.25, 2.125, 3.0625))
    assert volume.spacing == pytest.approx((0.5, 0.25, 0.125))
    assert (volume.name, volume.facts.value_unit, volume.unit) == ("density", "g/cm^3", None)
    assert ws.Volume(CoveringGrid("cm", density=DENSITY)).unit == "cm"


def test_arrays_of_yt_say_which_order_they_are_taken_in():
    (told,) = ws.Volume(DENSITY).guesses
    assert "give the grid itself, or array.T" in told
    assert ws.Volume(DENSITY).shape == (4, 5, 6)


def test_objects_of_yt_that_are_no_grid_say_how_to_make_one():
    class Dataset:
        pass

    with pytest.raises(ArgumentError, match=r"a Dataset of yt has no evenly spaced samples.*covering_grid\(level"):
        ws.Volume(of_library("yt")(Dataset)())
    with pytest.raises(ArgumentError, match=r"0 fields in memory \(none\); read the one to draw first"):
        ws.Volume(CoveringGrid())
    with pytest.raises(ArgumentError, match=r"2 fields in memory .*choose one, as grid.to_xarray"):
        ws.Volume(CoveringGrid(a=DENSITY, b=DENSITY))


def test_yt_itself():
    yt = pytest.importorskip("yt")
    yt.set_log_level(50)
    boxes = [
        {"left_edge": [0, 0, 0], "right_edge": [1, 1, 1], "level": 0, "dimensions": [8, 8, 8]},
        {"left_edge": [0.25] * 3, "right_edge": [0.5, 0.5, 0.75], "level": 1, "dimensions": [4, 4, 8]},
    ]
    for number, box in enumerate(boxes):
        box["gas", "density"] = (np.random.default_rng(number).random(box["dimensions"]), "g/cm**3")
    data = yt.load_amr_grids(boxes, [8, 8, 8])
    grid = data.covering_grid(1, data.domain_left_edge, data.domain_dimensions * 2)
    values = grid["gas", "density"]
    volume = ws.Volume(grid)
    assert np.array_equal(volume.samples, np.asarray(values).T)
    assert np.allclose(volume.bounds, [[1 / 32] * 3, [31 / 32] * 3])
    named = ws.Volume(grid.to_xarray(fields=[("gas", "density")])["gas", "density"])
    assert np.array_equal(named.samples, volume.samples)
    assert np.allclose(named.world_from_index, volume.world_from_index)
    with pytest.raises(ArgumentError, match="covering_grid"):
        ws.Volume(data)
