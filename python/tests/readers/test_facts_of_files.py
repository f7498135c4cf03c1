"""Units, anatomy, channels and times from files, each written by its own library."""

from __future__ import annotations

import json

import numpy as np
import pytest
from test_readers import ome_attributes, save_nifti
from vti_files import save_vti

import wavesplat as ws
from wavesplat.errors import ArgumentError, FileError

SAMPLES = np.random.default_rng(3).integers(1, 200, (5, 6, 7)).astype(np.uint8)


def facts(volume):
    return volume.unit, volume.is_anatomical, volume.modality


# NIfTI


@pytest.mark.parametrize("units", ["mm", "micron", "meter"])
def test_nifti_is_of_a_patient_in_millimetres(tmp_path, units):
    volume = ws.open(save_nifti(tmp_path / "a.nii", SAMPLES, np.eye(4), units=units))
    assert facts(volume) == ("mm", True, None)
    assert volume.facts.conventions == volume.guesses == ()


def test_nifti_without_a_unit_takes_the_custom(tmp_path):
    volume = ws.open(save_nifti(tmp_path / "a.nii", SAMPLES, np.eye(4), units=0))
    assert facts(volume) == ("mm", True, None)
    assert "names none" in volume.facts.conventions[0]
    assert volume.guesses == ()


@pytest.mark.parametrize(("units", "unit"), [("mm", "mm"), (0, None)])
def test_nifti_without_orientation_has_distances_and_no_anatomy(tmp_path, units, unit):
    import nibabel

    image = nibabel.Nifti1Image(SAMPLES.T, None)
    image.header.set_zooms((0.7, 0.8, 1.5))
    image.header.set_xyzt_units(units)
    nibabel.save(image, tmp_path / "a.nii")
    volume = ws.open(tmp_path / "a.nii")
    assert nibabel.load(tmp_path / "a.nii").header.get_zooms() == pytest.approx(volume.spacing)
    assert facts(volume) == (unit, False, None)
    assert "codes are 0" in volume.guesses[0]


def test_analyze_has_distances_and_no_anatomy(tmp_path):
    import nibabel

    image = nibabel.AnalyzeImage(SAMPLES.T, None)
    image.header.set_zooms((0.7, 0.8, 1.5))
    nibabel.save(image, tmp_path / "a.img")
    volume = ws.open(tmp_path / "a.img")
    np.testing.assert_array_equal(volume.samples, SAMPLES)
    assert volume.spacing == pytest.approx((0.7, 0.8, 1.5))
    assert facts(volume) == (None, False, None)
    assert len(volume.guesses) == 1


def test_nifti_times(tmp_path):
    import nibabel

    image = nibabel.Nifti1Image(np.stack([SAMPLES.T] * 3, axis=-1), np.eye(4))
    image.header.set_zooms((1, 1, 1, 2500))
    image.header.set_xyzt_units("mm", "msec")
    nibabel.save(image, tmp_path / "a.nii")
    found = ws.open(tmp_path / "a.nii", time=1).facts
    assert (found.n_times, found.time_step, found.time_unit) == (3, 2500, "ms")


# NRRD, MetaImage, VTK


def save_nrrd(path, *lines, samples=SAMPLES, ends="\n"):
    head = ["NRRD0005", "type: uchar", "dimension: 3", "sizes: 7 6 5", "encoding: raw", *lines, "", ""]
    path.write_bytes(ends.join(head).encode("latin-1") + samples.tobytes())
    return path


OBLIQUE = ("space directions: (0,2,0) (3,0,0) (0,0,4)", "space origin: (10,20,30)")
#: World from index of these lines, as it is written.
AS_WRITTEN = np.array([[0, 3, 0, 10], [2, 0, 0, 20], [0, 0, 4, 30], [0, 0, 0, 1]], float)


@pytest.mark.parametrize("ends", ["\n", "\r\n"])
@pytest.mark.parametrize(
    ("space", "to_ras"),
    [
        ("space: left-posterior-superior", (-1, -1, 1)),
        ("space: LPS", (-1, -1, 1)),
        ("space: RAS", (1, 1, 1)),
        ("space: left-anterior-superior", (-1, 1, 1)),
        ("space: scanner-xyz", None),
        ("space: 3D-right-handed", None),
        ("space: 3D-left-handed", None),
        ("space dimension: 3", None),
    ],
)
def test_nrrd_spaces(tmp_path, space, to_ras, ends):
    volume = ws.open(save_nrrd(tmp_path / "a.nrrd", space, *OBLIQUE, ends=ends))
    np.testing.assert_array_equal(volume.samples, SAMPLES)
    assert facts(volume) == (("mm", True, None) if to_ras else (None, False, None))
    np.testing.assert_allclose(volume.world_from_index, np.diag([*(to_ras or (1, 1, 1)), 1.0]) @ AS_WRITTEN)


@pytest.mark.parametrize(
    "line",
    [
        'note:="a: b"',
        "space:=LPS",
        "data file:=none.raw",
        "encoding:=gzip",
        "# space: RAS",
        'content: "x: y',
        "k:=\x85space: LPS",
    ],
)
def test_nrrd_lines_that_are_no_fields_say_nothing(tmp_path, line):
    volume = ws.open(save_nrrd(tmp_path / "a.nrrd", "spacings: 2 3 4", line))
    np.testing.assert_array_equal(volume.samples, SAMPLES)
    np.testing.assert_allclose(volume.world_from_index, np.diag([2, 3, 4, 1]))
    assert facts(volume) == (None, False, None)


def test_nrrd_units_become_one(tmp_path):
    lines = ("space: LPS", *OBLIQUE, 'space units: "um" "um" "nm"')
    volume = ws.open(save_nrrd(tmp_path / "a.nrrd", *lines))
    assert facts(volume) == ("um", True, None)
    np.testing.assert_allclose(volume.world_from_index, np.diag([-1, -1, 0.001, 1]) @ AS_WRITTEN)
    volume = ws.open(save_nrrd(tmp_path / "b.nrrd", "spacings: 2 3 4", 'units: "mm" "microns" "mm"'))
    assert (volume.unit, volume.spacing) == ("mm", pytest.approx((2, 0.003, 4)))


def test_nrrd_without_distances_is_a_guess(tmp_path):
    path = save_nrrd(tmp_path / "a.nrrd")
    assert ws.open(path).guesses == ("distances of samples 1, 1, 1: the file has none",)
    assert ws.open(path, spacing=(1, 2, 3)).guesses == ()


def test_nrrd_modality(tmp_path):
    assert ws.open(save_nrrd(tmp_path / "a.nrrd", "spacings: 1 1 1", "modality:=DWMRI")).modality == "MR"


def save_meta(path, *lines, data=None):
    head = ["ObjectType = Image", "NDims = 3", "DimSize = 7 6 5", "ElementSpacing = 2 3 4", "ElementType = MET_UCHAR"]
    lines = [*head, "BinaryData = True", *lines, "ElementDataFile = LOCAL", ""]
    path.write_bytes("\n".join(lines).encode() + (SAMPLES.tobytes() if data is None else data))
    return path


def test_metaimage_is_itks(tmp_path):
    volume = ws.open(save_meta(tmp_path / "a.mha", "Modality = MET_MOD_CT"))
    assert facts(volume) == ("mm", True, "CT")
    assert ["convention" in text or "ITK" in text for text in volume.facts.conventions] == [True, True]
    volume = ws.open(save_meta(tmp_path / "b.mha", "DistanceUnits = um"))
    assert (volume.unit, len(volume.facts.conventions)) == ("um", 1)


def test_metaimage_without_the_length_of_its_zlib_stream(tmp_path):
    import zlib

    packed = zlib.compress(SAMPLES.tobytes())
    volume = ws.open(save_meta(tmp_path / "a.mha", "CompressedData = True", data=packed))
    np.testing.assert_array_equal(volume.samples, SAMPLES)
    np.testing.assert_allclose(volume.world_from_index, np.diag([-2, -3, 4, 1]))
    for data in (packed[:-20], zlib.compress(SAMPLES.tobytes()[:-1]), zlib.compress(SAMPLES.tobytes() + b"1")):
        with pytest.raises(FileError, match="truncated|damaged"):
            ws.open(save_meta(tmp_path / "b.mha", "CompressedData = True", data=data))


def test_vtk_says_no_more_than_the_name_of_the_array(tmp_path):
    import SimpleITK

    SimpleITK.WriteImage(SimpleITK.GetImageFromArray(SAMPLES), str(tmp_path / "a.vtk"))
    assert ws.open(tmp_path / "a.vtk").facts == ws.Facts()
    assert ws.open(save_vti(tmp_path / "a.vti", {"d": SAMPLES})).facts == ws.Facts(quantity="d")


# TIFF


def save_imagej(path, samples=SAMPLES, resolution=(4, 2), **metadata):
    import tifffile

    tifffile.imwrite(path, samples, imagej=True, resolution=resolution, metadata={"axes": "ZYX", **metadata})
    return path


@pytest.mark.parametrize(
    ("name", "unit", "steps"),
    [
        ("micron", "um", (0.25, 0.5, 3)),
        ("\\u00B5m", "um", (0.25, 0.5, 3)),
        ("nm", "nm", (0.25, 0.5, 3)),
        ("inch", "mm", (6.35, 12.7, 76.2)),
        ("pixel", None, (0.25, 0.5, 3)),
    ],
)
def test_imagej_units(tmp_path, name, unit, steps):
    volume = ws.open(save_imagej(tmp_path / "a.tif", unit=name, spacing=3.0))
    assert facts(volume) == (unit, False, None)
    assert volume.spacing == pytest.approx(steps)
    assert volume.guesses == ()


def test_imagej_without_a_distance_of_slices_is_a_guess(tmp_path):
    path = save_imagej(tmp_path / "a.tif", unit="um")
    assert ws.open(path).guesses == ("distance of slices 0.25: the file has none, taken from x",)
    assert ws.open(path, spacing=(0.25, 0.5, 1)).guesses == ()


def test_imagej_negative_distances_mirror(tmp_path):
    volume = ws.open(save_imagej(tmp_path / "a.tif", spacing=-3.0, unit="um"))
    np.testing.assert_array_equal(volume.samples, SAMPLES)
    np.testing.assert_allclose(volume.world_from_index, np.diag([0.25, 0.5, -3, 1]))
    assert volume.guesses == ("axes z mirrored: their distances in the file are negative",)


@pytest.mark.parametrize("spacing", [0, "nan", "inf", "abc"])
def test_imagej_distances_that_are_none_are_told(tmp_path, spacing):
    volume = ws.open(save_imagej(tmp_path / "a.tif", spacing=spacing, unit="um"))
    assert volume.spacing == (0.25, 0.5, 0.25)
    assert f"distance along z: the file says '{spacing}', which is none" in volume.guesses


def test_an_unknown_unit_beside_a_known_one_is_told(tmp_path):
    path = save_imagej(tmp_path / "a.tif", spacing=3.0, unit="um", zunit="furlong")
    assert ws.open(path).guesses == ("distances along z in um: their unit in the file, 'furlong', is unknown",)
    path = save_nrrd(tmp_path / "a.nrrd", "space dimension: 3", *OBLIQUE, 'space units: "mm" "mm" "furlong"')
    assert "distances along z in mm: their unit in the file, 'furlong', is unknown" in ws.open(path).guesses


def test_imagej_channels_and_times(tmp_path):
    stack = np.stack([np.stack([SAMPLES, SAMPLES], axis=1)] * 3)
    red, green = np.zeros((2, 3, 256), np.uint8)
    red[0] = green[1] = np.arange(256)
    path = save_imagej(tmp_path / "a.tif", stack, axes="TZCYX", LUTs=[red, green], finterval=1.5, mode="composite")
    found = ws.open(path, time=2, channel=1).facts
    assert found.channels == (ws.Channel("", (1, 0, 0)), ws.Channel("", (0, 1, 0)))
    assert found.channel == found.channels[1]
    assert (found.n_times, found.time_step, found.time_unit) == (3, 1.5, "s")


def test_imagej_display_ranges(tmp_path):
    stack = np.stack([SAMPLES, SAMPLES], axis=1)
    path = save_imagej(tmp_path / "a.tif", stack, axes="ZCYX", Ranges=(1.0, 90.5, 7.0, 7.0), mode="composite")
    found = ws.open(path, channel=0).facts
    assert found.channels == (ws.Channel(window=(1, 90.5)), ws.Channel())
    path = save_imagej(tmp_path / "b.tif", min=3.0, max=80.0)
    assert ws.open(path).facts.channel == ws.Channel(window=(3, 80))


def save_ome(path, samples=SAMPLES, **metadata):
    import tifffile

    tifffile.imwrite(path, samples, metadata={"axes": "ZYX", **metadata})
    return path


@pytest.mark.parametrize(
    ("names", "unit", "steps"),
    [
        (("µm", "µm", "nm"), "um", (0.5, 0.5, 0.3)),
        (("mm", "µm", "µm"), "mm", (0.5, 0.0005, 0.3)),
        (("in", "in", "in"), "mm", (12.7, 12.7, 7620)),
        (("reference frame",) * 3, None, (0.5, 0.5, 300)),
    ],
)
def test_ome_tiff_units_become_one(tmp_path, names, unit, steps):
    sizes = {"PhysicalSizeX": 0.5, "PhysicalSizeY": 0.5, "PhysicalSizeZ": 300}
    of_axes = {f"PhysicalSize{axis}Unit": name for axis, name in zip("XYZ", names, strict=True)}
    volume = ws.open(save_ome(tmp_path / "a.ome.tif", **sizes, **of_axes))
    assert volume.unit == unit
    assert volume.spacing == pytest.approx(steps)


def test_ome_tiff_channels(tmp_path):
    channels = {"Name": ["DAPI", "GFP"], "Color": [65535, 16711935], "EmissionWavelength": [461, 0.509]}
    channels["EmissionWavelengthUnit"] = ["nm", "µm"]
    stack = np.stack([SAMPLES, SAMPLES])
    path = save_ome(tmp_path / "a.ome.tif", stack, axes="CZYX", PhysicalSizeX=0.5, PhysicalSizeY=0.5, Channel=channels)
    volume = ws.open(path, channel=1)
    assert volume.facts.channel == ws.Channel("GFP", (0, 1, 0), 509)
    assert volume.facts.channels[0] == ws.Channel("DAPI", (0, 0, 1), 461)
    assert facts(volume) == ("um", False, "fluorescence")
    assert volume.guesses == ("distance of slices 0.5: the file has none, taken from x",)


def test_plain_tiff_has_no_distances(tmp_path):
    import tifffile

    tifffile.imwrite(tmp_path / "a.tif", SAMPLES, photometric="minisblack")
    volume = ws.open(tmp_path / "a.tif")
    assert facts(volume) == (None, False, None)
    assert volume.guesses == ("distances of samples 1, 1, 1: the file has none",)


@pytest.mark.parametrize("byte_order", ["<", ">"])
@pytest.mark.parametrize("rows", [None, 2])
def test_half_precision_tiff_is_exact(tmp_path, byte_order, rows):
    import tifffile

    values = np.array([0, -0.0, 1, 1 / 3, 6e-8, 6.1e-5, 65504, -2, np.inf, -np.inf, np.nan, 0.1], np.float16)
    stack = np.tile(values, 18).reshape(3, 8, 9)
    tifffile.imwrite(tmp_path / "a.tif", stack, byteorder=byte_order, rowsperstrip=rows, photometric="minisblack")
    volume = ws.open(tmp_path / "a.tif")
    assert volume.dtype == np.float32
    np.testing.assert_array_equal(volume.samples, stack.astype(np.float32))


# OME-Zarr, HDF5


def save_ome_zarr(path, samples=SAMPLES, axes="zyx", units=None, scale=(1.0, 1.0, 1.0), **more):
    import zarr

    group = zarr.open_group(path, mode="w", zarr_format=2)
    group.create_array("0", data=samples)
    datasets = [{"path": "0", "coordinateTransformations": [{"type": "scale", "scale": list(scale)}]}]
    attributes = ome_attributes("0.4", axes, datasets)
    for axis in attributes["multiscales"][0]["axes"]:
        if axis["name"] in (units or {}):
            axis["unit"] = units[axis["name"]]
    group.attrs.update(attributes | more)
    return path


def test_ome_zarr_units_become_one(tmp_path):
    units = {"z": "nanometer", "y": "micrometer", "x": "micrometer"}
    volume = ws.open(save_ome_zarr(tmp_path / "a.zarr", units=units, scale=(300.0, 0.5, 0.5)))
    assert facts(volume) == ("um", False, None)
    assert volume.spacing == pytest.approx((0.5, 0.5, 0.3))
    volume = ws.open(save_ome_zarr(tmp_path / "b.zarr", units={"y": "millimeter", "x": "millimeter"}))
    assert volume.unit == "mm"
    assert volume.guesses == ("distances along z in mm: the file names no unit for them",)


def test_ome_zarr_channels_and_times(tmp_path):
    stack = np.stack([np.stack([SAMPLES, SAMPLES])] * 3)
    omero = {"channels": [{"label": "DAPI", "color": "0000FF"}, {"label": "GFP", "color": "00ff00", "window": {}}]}
    path = save_ome_zarr(
        tmp_path / "a.zarr",
        stack,
        axes="tczyx",
        units={"t": "second", **dict.fromkeys("zyx", "micrometer")},
        scale=(2.5, 1.0, 1.0, 1.0, 1.0),
        omero=omero,
    )
    found = ws.open(path, time=0, channel=1).facts
    assert found.channels == (ws.Channel("DAPI", (0, 0, 1)), ws.Channel("GFP", (0, 1, 0)))
    assert found.channel.name == "GFP"
    assert (found.n_times, found.time_step, found.time_unit) == (3, 2.5, "s")


@pytest.mark.parametrize(
    ("window", "ours"),
    [
        ({"min": 0, "max": 65535, "start": 100, "end": 900.5}, (100, 900.5)),
        ({"start": 9, "end": 9}, None),
        ({"start": 9, "end": 1}, None),
        ({"start": "x", "end": 9}, None),
        ({"start": float("nan"), "end": 9}, None),
        ({}, None),
        ([1, 2], None),
    ],
)
def test_ome_zarr_windows(tmp_path, window, ours):
    omero = {"channels": [{"label": "DAPI", "active": False, "window": window}, {"active": True}]}
    path = save_ome_zarr(tmp_path / "a.zarr", np.stack([SAMPLES] * 2), axes="czyx", scale=(1.0,) * 4, omero=omero)
    found = ws.open(path, channel=0).facts
    assert found.channels == (ws.Channel("DAPI", window=ours, is_active=False), ws.Channel())
    again = ws.Facts.from_json(json.loads(json.dumps(found.as_json())))
    assert again == found


def test_info_tells_windows(tmp_path, wavesplat):
    omero = {"channels": [{"label": "DAPI", "window": {"start": 10, "end": 90}}, {"label": "GFP", "active": False}]}
    path = save_ome_zarr(tmp_path / "a.zarr", np.stack([SAMPLES] * 2), axes="czyx", scale=(1.0,) * 4, omero=omero)
    done = wavesplat("info", path)
    assert "channel 0    DAPI, shown from 10 to 90" in done.stdout
    assert "channel 1    GFP, not shown" in done.stdout
    done = wavesplat("info", path, "--json")
    assert json.loads(done.stdout)["channels"][0]["window"] == [10, 90]


def test_hdf5_units(tmp_path):
    import h5py

    with h5py.File(tmp_path / "a.h5", "w") as file:
        file["raw"] = SAMPLES
    assert ws.open(tmp_path / "a.h5").facts == ws.Facts()
    with h5py.File(tmp_path / "a.h5", "a") as file:
        file["raw"].attrs["element_size_um"] = (3.0, 2.0, 1.0)
    assert ws.open(tmp_path / "a.h5").unit == "um"


@pytest.mark.parametrize(("labels", "order"), [("zyx", "C"), ("xyz", "C"), ("xyz", "F")])
@pytest.mark.parametrize("is_component", [False, True])
def test_openpmd_meshes(tmp_path, labels, order, is_component):
    import h5py

    axes = "zyx" if order == "F" else labels
    stored = SAMPLES.transpose(["zyx".index(name) for name in axes])
    with h5py.File(tmp_path / "a.h5", "w") as file:
        dataset = file.create_dataset("data/0/fields/E/x" if is_component else "data/0/fields/rho", data=stored)
        mesh = dataset.parent if is_component else dataset
        mesh.attrs["axisLabels"] = np.array(list(labels), dtype="S1")
        mesh.attrs["dataOrder"] = np.bytes_(order)
        mesh.attrs["gridSpacing"] = [{"x": 1.0, "y": 2.0, "z": 4.0}[name] for name in labels]
        mesh.attrs["gridGlobalOffset"] = [{"x": 10.0, "y": 20.0, "z": 30.0}[name] for name in labels]
        mesh.attrs["gridUnitSI"] = 2e-6
        dataset.attrs["position"] = [0.5, 0.5, 0.5]
    volume = ws.open(tmp_path / "a.h5")
    np.testing.assert_array_equal(volume.samples, SAMPLES)
    assert facts(volume) == ("um", False, None)
    expected = np.diag([2.0, 4, 8, 1])
    expected[:3, 3] = 21, 42, 64
    np.testing.assert_allclose(volume.world_from_index, expected)


# Any format


def test_a_unit_can_be_given(tmp_path):
    np.save(tmp_path / "a.npy", SAMPLES)
    assert ws.open(tmp_path / "a.npy").unit is None
    volume = ws.open(tmp_path / "a.npy", spacing=(0.24, 0.24, 1), unit="micron")
    assert (volume.unit, volume.spacing) == ("um", pytest.approx((0.24, 0.24, 1)))
    with pytest.raises(ArgumentError, match="unit is 3"):
        ws.open(tmp_path / "a.npy", unit=3)


def test_notes_tell_what_was_guessed(wavesplat, tmp_path):
    path = save_imagej(tmp_path / "a.tif", unit="um")
    out = tmp_path / "a.png"
    done = wavesplat("slice", path, "-o", out)
    assert done.returncode == 0
    assert done.stderr == "wavesplat: note: distance of slices 0.25: the file has none, taken from x\n"
    for quiet in (["--quiet"], ["--spacing", "0.25,0.5,1"]):
        assert wavesplat("slice", path, "-o", out, *quiet).stderr == ""
    assert json.loads(wavesplat("info", path, "--json").stdout)["guesses"] == list(ws.open(path).guesses)


def test_info_lists_what_there_is_to_choose(wavesplat, tmp_path):
    import h5py

    stack = np.stack([np.stack([SAMPLES, SAMPLES], axis=1)] * 3)
    with h5py.File(tmp_path / "b.h5", "w") as file:
        file["raw"], file["label"] = np.stack([SAMPLES, SAMPLES]), SAMPLES
    for path, options in [
        (save_imagej(tmp_path / "a.tif", stack, axes="TZCYX"), {"time": [0, 1, 2], "channel": [0, 1]}),
        (tmp_path / "b.h5", {"dataset": ["label", "raw"]}),
    ]:
        done = wavesplat("info", path, "--json")
        assert done.returncode == 0
        told = json.loads(done.stdout)
        assert {choice["option"]: choice["names"] for choice in told["choices"]} == options
        assert told["shape_zyx"] == list(SAMPLES.shape)
        done = wavesplat("info", path)
        assert done.returncode == 0
        assert all(f"choose with --{option}" in done.stdout for option in options)


def test_info_of_several_of_which_the_first_is_none(wavesplat, tmp_path):
    np.savez(tmp_path / "a.npz", flat=SAMPLES[0, 0], whole=SAMPLES)
    done = wavesplat("info", tmp_path / "a.npz")
    assert done.returncode == 0
    assert "datasets     2, choose with --dataset: flat, whole" in done.stdout
    assert "the first cannot be shown: " in done.stdout


@pytest.mark.parametrize("metadata", [{}, {"spacing": 2.0, "finterval": 60.0}])
def test_planes_at_several_times_are_told(tmp_path, metadata):
    volume = ws.open(save_imagej(tmp_path / "a.tif", axes="TYX", **metadata))
    np.testing.assert_array_equal(volume.samples, SAMPLES)
    assert any("a time series of 5 planes: time points are drawn as slices" in guess for guess in volume.guesses)
