"""Units that files name: the right length in every format, or a sentence that the unit is unknown."""

import zipfile

import numpy as np
import pytest
from microscope_files import image, save_bdv, save_imaris
from test_facts_of_files import SAMPLES, save_imagej, save_meta, save_nrrd, save_ome, save_ome_zarr
from test_molecules_and_traces import save_segy

import wavesplat as ws
from wavesplat._looks.labels.structure_labels import in_unit_of
from wavesplat._model.volume import units

#: Names as files have them -> metres, by NIST's and ISO's definitions; None: of no size that anybody knows.
SIZES = {
    "micron": 1e-6,
    "millimeter": 1e-3,
    "centimeter": 1e-2,
    "metre": 1.0,
    "Inch": 0.0254,
    "feet": 0.3048,
    "nanometers": 1e-9,
    "Angstrom": 1e-10,
    "Mm": 1e6,
    "furlong": None,
}
#: Metres of the units that volumes are told in.
METRES = {"km": 1e3, "m": 1.0, "cm": 1e-2, "mm": 1e-3, "um": 1e-6, "nm": 1e-9, "angstrom": 1e-10}


def netcdf(folder, unit):
    xarray = pytest.importorskip("xarray")
    places = {axis: (axis, 3.0 * np.arange(n), {"units": unit}) for axis, n in zip("zyx", SAMPLES.shape, strict=True)}
    xarray.DataArray(SAMPLES.astype("f4"), dims=list("zyx"), coords=places, name="t").to_netcdf(
        folder / "a.nc", engine="scipy"
    )
    return folder / "a.nc"


def nrrd(folder, unit, key):
    named = " ".join([f'"{unit}"'] * 3)
    lines = [f"units: {named}"] if key == "units" else [f"unit:={unit}"]
    return save_nrrd(folder / "a.nrrd", "spacings: 3 3 3", *lines)


#: Writers of files whose samples are 3 of a unit apart along x.
FORMATS = {
    "ImageJ": lambda folder, unit: save_imagej(folder / "a.tif", resolution=(1 / 3, 1 / 3), spacing=3, unit=unit),
    "OME-TIFF": lambda folder, unit: save_ome(
        folder / "a.ome.tif", **{f"PhysicalSize{a}{end}": v for a in "XYZ" for end, v in (("", 3.0), ("Unit", unit))}
    ),
    "NGFF": lambda folder, unit: save_ome_zarr(
        folder / "a.zarr", units=dict.fromkeys("zyx", unit), scale=(3.0, 3.0, 3.0)
    ),
    "BDV": lambda folder, unit: save_bdv(folder, image(n_channels=1), unit=unit, voxel="3 3 3", transforms=()),
    "Imaris": lambda folder, unit: save_imaris(
        folder / "a.ims", image(n_channels=1), image_info={"Unit": unit, "ExtMin0": 0, "ExtMax0": 36}
    ),
    "NRRD": lambda folder, unit: nrrd(folder, unit, "units"),
    "NRRD of ITK": lambda folder, unit: nrrd(folder, unit, "unit"),
    "MetaImage": lambda folder, unit: save_meta(folder / "a.mha", f"DistanceUnits = {unit}"),
    "netCDF": netcdf,
}


@pytest.mark.parametrize("name", FORMATS)
def test_distances_of_volumes(tmp_path, name):
    for k, (unit, size) in enumerate(SIZES.items()):
        folder = tmp_path / str(k)
        folder.mkdir()
        volume = ws.open(FORMATS[name](folder, unit))
        step = 2 if name == "MetaImage" else 3
        # An unknown unit is told as it is, with the file's own numbers.
        told = (volume.unit, METRES.get(volume.unit, 1.0) * volume.spacing[0])
        assert told == (volume.unit if size else unit, pytest.approx(step * (size or 1.0), rel=1e-6)), unit


@pytest.mark.parametrize(("code", "step", "unit"), [(1, 12.5, "m"), (2, 3.81, "m"), (9, 12.5, None)])
def test_measurement_systems_of_seismic_traces(tmp_path, code, step, unit):
    segyio = pytest.importorskip("segyio")
    path = save_segy(tmp_path / "a.sgy", np.random.default_rng(2).normal(size=(3, 4, 5)).astype(np.float32))
    with segyio.open(path, "r+") as file:
        file.bin.update({segyio.BinField.MeasurementSystem: code})
    volume = ws.open(path)
    assert (volume.unit, volume.spacing[0]) == (unit, pytest.approx(step))
    assert any("measurement system, 9, is unknown" in guess for guess in volume.guesses) == (code == 9)


PARTS = {
    "[Content_Types].xml": '<Types xmlns="http://schemas.openxmlformats.org/package/2006/content-types"><Default '
    'Extension="rels" ContentType="application/vnd.openxmlformats-package.relationships+xml"/><Default '
    'Extension="model" ContentType="application/vnd.ms-package.3dmanufacturing-3dmodel+xml"/></Types>',
    "_rels/.rels": '<Relationships xmlns="http://schemas.openxmlformats.org/package/2006/relationships"><Relationship '
    'Target="/3D/3dmodel.model" Id="r" Type="http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"/>'
    "</Relationships>",
    "3D/3dmodel.model": '<model unit="UNIT" xmlns="http://schemas.microsoft.com/3dmanufacturing/core/2015/02">'
    '<resources><object id="1" type="model"><mesh><vertices><vertex x="0" y="0" z="0"/><vertex x="1" y="0" z="0"/>'
    '<vertex x="0" y="2" z="0"/><vertex x="0" y="0" z="3"/></vertices><triangles><triangle v1="0" v2="2" v3="1"/>'
    '<triangle v1="0" v2="1" v3="3"/><triangle v1="1" v2="2" v3="3"/><triangle v1="0" v2="3" v3="2"/></triangles>'
    '</mesh></object></resources><build><item objectid="1"/></build></model>',
}


def threemf(folder, unit):
    pytest.importorskip("trimesh")
    with zipfile.ZipFile(folder / "a.3mf", "w") as archive:
        for name, text in PARTS.items():
            archive.writestr(name, text.replace("UNIT", unit))
    return folder / "a.3mf"


def table(folder, unit):
    (folder / "a.csv").write_text(f"x ({unit}),y ({unit}),z ({unit})\n0,0,0\n1,2,3\n", encoding="utf-8")
    return folder / "a.csv"


@pytest.mark.parametrize("write", [threemf, table])
def test_lengths_of_geometry_in_worlds(tmp_path, write):
    for unit, size in SIZES.items():
        path = write(tmp_path, unit)
        for world in ("um", "mm", "m"):
            shape = ws.open_geometry(path, world_unit=world)
            largest = np.max(shape.vertices if write is threemf else shape.positions, axis=0)
            np.testing.assert_allclose(largest, np.array([1, 2, 3]) * (size / METRES[world] if size else 1))
            assert [f"the size of {unit!r} is unknown" in guess for guess in shape.guesses] == [True] * (size is None)


def test_what_is_saved_as_3mf_comes_back(tmp_path):
    pytest.importorskip("skimage")
    pytest.importorskip("lxml")
    pytest.importorskip("networkx")
    ball = ws.Volume(np.pad(np.ones((6, 6, 6), np.float32), 2), spacing=(0.5, 0.5, 0.5), unit="um")
    mesh = ws.mesh(ball, 0.5)
    mesh.save(tmp_path / "a.3mf")
    surface = ws.open_geometry(tmp_path / "a.3mf", world_unit="mm")
    np.testing.assert_allclose(np.ptp(surface.vertices, axis=0), 1e-3 * np.ptp(mesh.vertices, axis=0), rtol=1e-6)


def test_columns_of_two_units_of_which_one_is_unknown(tmp_path):
    (tmp_path / "a.csv").write_text("x (um),y (um),z (furlong)\n1,2,3\n", encoding="utf-8")
    told = ws.open_geometry(tmp_path / "a.csv", world_unit="mm").guesses
    assert told == ("distances along z in um: their unit in the file, 'furlong', is unknown",)


def test_volumes_in_units_that_do_not_fit_are_no_scene():
    one, other = (ws.Volume(SAMPLES, unit=unit) for unit in ("mm", "furlong"))
    with pytest.raises(ws.errors.ArgumentError, match="in mm, the lengths of .* in furlong; open one of them"):
        ws.render([one, other], size=(8, 8))


def test_regions_of_a_patient_need_a_unit_of_known_size():
    line = np.array([[10.0, 20, 30]])
    for unit, size in (("cm", 0.1), ("um", 1000.0), (None, 1.0)):
        scan = ws.Volume(SAMPLES, anatomical=True, unit=unit)
        np.testing.assert_allclose(in_unit_of(scan, [line])[0], size * line)
    with pytest.raises(ws.errors.ArgumentError, match="size of 'furlong'.* is unknown; open it with spacing="):
        in_unit_of(ws.Volume(SAMPLES, anatomical=True, unit="furlong"), [line])


def test_capital_letters_of_si():
    assert units.canonical("Pm") == "Pm"
    assert units.metres("Pm") is None
    assert (units.canonical("MM"), units.canonical("Mm")) == ("mm", "Mm")
