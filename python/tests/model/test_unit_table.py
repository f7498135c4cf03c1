"""Texts of scale bars and letters of directions for fifteen files of ten formats, against a table.

Each has 40 samples along x, 0.5 of its unit apart where it names one: the bar is at most 0.3 of the picture's width.
"""

from __future__ import annotations

import json

import numpy as np
import pytest
from dicom_files import save as save_dicom
from dicom_files import slice_at
from test_facts_of_files import save_imagej, save_meta, save_nrrd, save_ome, save_ome_zarr
from test_readers import save_nifti
from vti_files import save_vti

import wavesplat as ws
from wavesplat.errors import ArgumentError

SAMPLES = np.random.default_rng(3).integers(1, 200, (30, 36, 40)).astype(np.uint8)
STEP = np.diag([0.5, 0.5, 0.5, 1])


def bare_nifti(path):
    import nibabel

    image = nibabel.Nifti1Image(SAMPLES.T, None)
    image.header.set_zooms((0.5, 0.5, 0.5))
    nibabel.save(image, path)
    return path


def dicom(path):
    datasets = [slice_at(pixels, n, z=0.5 * n, spacing=(0.5, 0.5)) for n, pixels in enumerate(SAMPLES)]
    return save_dicom(path, datasets)


def nrrd(path, *lines):
    whole = save_nrrd(path, *lines, samples=SAMPLES).read_bytes()
    path.write_bytes(whole.replace(b"sizes: 7 6 5", b"sizes: 40 36 30"))
    return path


def meta(path):
    whole = save_meta(path, data=SAMPLES.tobytes()).read_bytes()
    path.write_bytes(whole.replace(b"DimSize = 7 6 5", b"DimSize = 40 36 30").replace(b"= 2 3 4", b"= 0.5 0.5 0.5"))
    return path


def imagej(path, unit):
    return save_imagej(path, SAMPLES, resolution=(2, 2), spacing=0.5, unit=unit)


def ome(path, unit):
    sizes = {f"PhysicalSize{axis}": 0.5 for axis in "XYZ"}
    return save_ome(path, SAMPLES, **sizes, **{f"{name}Unit": unit for name in sizes})


def ome_zarr(path, unit, step=0.5):
    return save_ome_zarr(path, SAMPLES, units=dict.fromkeys("zyx", unit), scale=(step,) * 3)


def hdf5(path):
    import h5py

    with h5py.File(path, "w") as file:
        file["raw"] = SAMPLES
        file["raw"].attrs["element_size_um"] = (0.5, 0.5, 0.5)
    return path


def npy(path):
    np.save(path, SAMPLES)
    return path


def vti(path):
    return save_vti(path, {"d": SAMPLES}, attributes='Origin="0 0 0" Spacing="0.5 0.5 0.5"')


DIRECTIONS = "space directions: (0.5,0,0) (0,0.5,0) (0,0,0.5)"
#: Name of the file, the function that writes it, text of the bar, letters at the axial slice's edges.
TABLE = [
    ("ct", dicom, "5 mm", "RLAP"),
    ("a.nii.gz", lambda path: save_nifti(path, SAMPLES, STEP), "5 mm", "RLAP"),
    ("bare.nii", bare_nifti, "5 units", None),
    ("lps.nrrd", lambda path: nrrd(path, "space: LPS", DIRECTIONS), "5 mm", "RLAP"),
    ("um.nrrd", lambda path: nrrd(path, "spacings: 0.5 0.5 0.5", 'units: "um" "um" "um"'), "5 µm", None),
    ("none.nrrd", lambda path: nrrd(path, "space: 3D-right-handed", DIRECTIONS), "5 units", None),
    ("a.mha", meta, "5 mm", "RLAP"),
    ("micron.tif", lambda path: imagej(path, "micron"), "5 µm", None),
    ("escaped.tif", lambda path: imagej(path, "\\u00B5m"), "5 µm", None),
    ("a.ome.tif", lambda path: ome(path, "nm"), "5 nm", None),
    ("um.zarr", lambda path: ome_zarr(path, "micrometer"), "5 µm", None),
    ("brain.zarr", lambda path: ome_zarr(path, "micrometer", 250.0), "2 mm", None),
    ("a.h5", hdf5, "5 µm", None),
    ("a.vti", vti, "5 units", None),
    ("a.npy", npy, "10 units", None),
]


@pytest.mark.parametrize(("name", "make", "bar", "letters"), TABLE, ids=[row[0] for row in TABLE])
def test_bars_and_letters(tmp_path, name, make, bar, letters):
    volume = ws.open(make(tmp_path / name))
    picture = ws.slice(volume, size=(200, 200))
    assert picture.annotated(scale_bar=True).report["scale_bar"]["text"] == bar
    assert volume.is_anatomical == (letters is not None)
    if letters is None:
        assert picture.report["letters"] is None
        with pytest.raises(ArgumentError, match="has no letters: the file does not say how its axes lie in a patient"):
            picture.annotated(orientation="letters")
    else:
        report = picture.annotated(orientation="letters").report
        assert "".join(report["letters"].values()) == letters


def test_the_command_line_says_the_same(wavesplat, tmp_path):
    out = tmp_path / "a.png"
    brain = ome_zarr(tmp_path / "brain.zarr", "micrometer", 250.0)
    done = wavesplat("slice", brain, "-o", out, "--size", "200x200", "--scale-bar", "--json")
    assert (done.returncode, done.stderr) == (0, "")
    assert json.loads(done.stdout)["report"]["scale_bar"]["text"] == "2 mm"
    done = wavesplat("slice", brain, "-o", out, "--size", "200x200", "--letters")
    assert done.returncode == 2
    assert "has no letters" in done.stderr
    array = npy(tmp_path / "a.npy")
    done = wavesplat("slice", array, "-o", out, "--size", "200x200", "--scale-bar", "--json")
    assert json.loads(done.stdout)["report"]["scale_bar"]["text"] == "10 units"
    assert "note: the scale bar has no unit" in done.stderr
    assert "--unit" in done.stderr
    done = wavesplat(
        "slice",
        array,
        "-o",
        out,
        "--size",
        "200x200",
        "--scale-bar",
        "--json",
        "--spacing",
        "0.24,0.24,1",
        "--unit",
        "um",
    )
    assert (json.loads(done.stdout)["report"]["scale_bar"]["text"], done.stderr) == ("2 µm", "")


def test_a_text_is_the_unit_that_is_shown():
    picture = ws.slice(ws.Volume(SAMPLES, spacing=(250, 250, 250), unit="um"), size=(200, 200))
    texts = {unit: picture.annotated(scale_bar=unit).report["scale_bar"]["text"] for unit in (True, "um", "nm", "cm")}
    assert texts == {True: "2 mm", "um": "2000 µm", "nm": "2000000 nm", "cm": "0.2 cm"}
    with pytest.raises(ArgumentError, match="wanted in 'parsec', but the world's unit is 'um'"):
        picture.annotated(scale_bar="parsec")
    unknown = ws.slice(ws.Volume(SAMPLES), size=(200, 200))
    assert unknown.annotated(scale_bar="kpc").report["scale_bar"]["text"] == "10 kpc"
    assert unknown.annotated(scale_bar=True, unit="um").report["scale_bar"]["text"] == "10 µm"
