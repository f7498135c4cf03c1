"""Figures of fields have a colour bar with the name and the unit of their dataset (simulation, F9)."""

import h5py
import numpy as np
import pytest
from PIL import Image

import wavesplat as ws

K, J, I = np.indices((20, 20, 20)) / 10 - 1  # noqa: E741 - indices along the axes
DENSITY = np.exp(-3 * (K * K + J * J + I * I)).astype(np.float32)


@pytest.fixture
def file(tmp_path):
    path = tmp_path / "out_7.h5"
    with h5py.File(path, "w") as made:
        made["fields/density"] = DENSITY
        made["fields/density"].attrs["units"] = "g/cm3"
        made["fields/temperature"] = 300 * DENSITY
        made["fields/temperature"].attrs["units"] = np.bytes_(b"K")
        made["fields/data"] = DENSITY
        made["fields/velocity"] = np.stack([I, J, K], axis=-1).astype(np.float32)
    return path


def texts(picture):
    return [mark.text for mark in picture._canvas.marks if hasattr(mark, "text")]


@pytest.mark.parametrize("memory", [None, "100 MB"])
def test_bars_are_titled_by_the_dataset_and_its_unit(file, memory):
    volume = ws.open(file, dataset="fields/temperature", memory=memory)
    assert (volume.facts.quantity, volume.value_unit) == ("temperature", "K")
    assert "temperature (K)" in texts(ws.render(volume, size=(200, 200)).annotated(colorbar=True))
    assert "temperature (K)" in texts(ws.slice(volume, size=(200, 200)).annotated(colorbar=True))
    named = ws.Scene([ws.Layer(volume, name="T of the flow")]).render(size=(200, 200)).annotated(colorbar=True)
    assert "K" in texts(named), "a layer with a name of its own is no longer its dataset"


def test_several_datasets_of_one_file_differ_by_name(file):
    layers = [ws.Layer(ws.open(file, dataset=f"fields/{name}")) for name in ("density", "temperature")]
    figure = ws.Scene(layers).render(size=(300, 300)).annotated(colorbar=True, legend=True)
    assert {"density (g/cm3)", "temperature (K)", "density", "temperature"} <= set(texts(figure))


def test_names_that_say_nothing_are_no_titles(file):
    assert ws.open(file, dataset="fields/data").facts.quantity is None


def test_components_and_lengths_are_named(file):
    assert ws.open(file, dataset="fields/velocity").facts.quantity == "velocity magnitude"
    assert ws.open(file, dataset="fields/velocity", component="z").facts.quantity == "velocity z"


def test_names_of_other_formats(tmp_path):
    np.savez(tmp_path / "a.npz", pressure=DENSITY)
    for memory in (None, "1 MB"):
        assert ws.open(tmp_path / "a.npz", memory=memory).facts.quantity == "pressure"
    legacy = (
        "# vtk DataFile Version 3.0\nmade\nASCII\nDATASET STRUCTURED_POINTS\nDIMENSIONS 2 2 2\nORIGIN 0 0 0\n"
        "SPACING 1 1 1\nPOINT_DATA 8\nSCALARS vorticity float\nLOOKUP_TABLE default\n0 1 2 3 4 5 6 7\n"
    )
    (tmp_path / "a.vtk").write_text(legacy)
    assert ws.open(tmp_path / "a.vtk").facts.quantity == "vorticity"


def test_names_of_netcdf(tmp_path):
    xarray = pytest.importorskip("xarray")
    field = xarray.DataArray(DENSITY, dims=("z", "y", "x"), attrs={"units": "Pa"})
    field.to_dataset(name="p").to_netcdf(tmp_path / "a.nc", engine="scipy")
    volume = ws.open(tmp_path / "a.nc")
    assert (volume.facts.quantity, volume.value_unit) == ("p", "Pa")


def test_names_of_objects():
    xarray = pytest.importorskip("xarray")
    pyvista = pytest.importorskip("pyvista")
    field = xarray.DataArray(DENSITY, dims=("z", "y", "x"), name="density", attrs={"units": "g/cm3"})
    assert "density (g/cm3)" in texts(ws.render(field, size=(200, 200)).annotated(colorbar=True))
    image = pyvista.ImageData(dimensions=DENSITY.shape[::-1])
    image["temperature"] = DENSITY.ravel()
    assert ws.Volume(image).facts.quantity == "temperature"


def test_images_of_two_datasets_have_two_arrays(file):
    pytest.importorskip("pyvista")
    images = [ws.open(file, dataset=f"fields/{name}").to_pyvista() for name in ("density", "temperature")]
    assert [image.active_scalars_name for image in images] == ["density", "temperature"]


def test_a_figure_of_a_field_has_a_bar_by_itself(wavesplat, file, tmp_path):
    def width(name, *options):
        asked = ("--dataset", "fields/density", "--size", "120x120", *options)
        done = wavesplat("render", file, "-o", tmp_path / name, *asked)
        assert done.returncode == 0, done.stderr
        if name.endswith(".svg"):
            return None
        with Image.open(tmp_path / name) as picture:
            return picture.width

    assert width("plain.png") == 120
    assert width("figure.png", "--figure") > 120
    assert width("mapped.png", "--figure", "--cmap", "viridis") > 120
    # A surface has one colour.
    surface = ("--figure", "--composite", "isosurface", "--iso-value", "0.5")
    assert width("surface.png", *surface) == 120
    # Another field gives one more.
    assert width("colored.png", *surface, "--color-by", "temperature:inferno") > 120
    assert width("both.png", "--figure", "--color-by", "temperature") > 120
    assert width("fast.svg", "--figure", "--color-by", "velocity") is None
    assert ">velocity magnitude</text>" in (tmp_path / "fast.svg").read_text()


def test_a_patient_s_axes_and_millimetres_of_a_header_are_not_those_of_a_simulation(wavesplat, tmp_path):
    """A protein was 20 mm large, and a flame had a right side."""
    ws.Volume(DENSITY, unit="mm", anatomical=True).save(tmp_path / "flame.nrrd")
    for name, asked, has in (("a.svg", (), False), ("b.svg", ("--axes", "--scale-bar"), True)):
        done = wavesplat("render", tmp_path / "flame.nrrd", "--size", "200", "--figure", *asked, "-o", tmp_path / name)
        assert done.returncode == 0, done.stderr
        drawn = (tmp_path / name).read_text()
        assert (" mm</text>" in drawn, ">R</text>" in drawn) == (has, has)


def test_a_figure_of_a_scan_has_letters_and_no_bar(wavesplat, tmp_path):
    ws.examples.mri_head().save(tmp_path / "head.nii.gz")
    for name in ("a.svg", "a.png"):
        done = wavesplat("render", tmp_path / "head.nii.gz", "--size", "120x120", "--figure", "-o", tmp_path / name)
        assert done.returncode == 0, done.stderr
    drawn = (tmp_path / "a.svg").read_text()
    assert all(f">{text}</text>" in drawn for text in ("R", "L", "S", "I"))
    with Image.open(tmp_path / "a.png") as picture:
        assert picture.width == 120
