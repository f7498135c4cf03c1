"""The page docs/privacy.md: files that are written hold no name, number or date of a patient."""

from __future__ import annotations

import json

import dicom_files
import numpy as np
import pages
import pytest
from PIL import Image

import wavesplat as ws

#: Values of elements that name a patient, none of which occurs in files by chance.
PERSON = {
    "PatientName": "Quintessa^Vandermolen",
    "PatientID": "PID-7391824",
    "PatientBirthDate": "19430217",
    "StudyDate": "20190822",
    "AccessionNumber": "ACC5520917",
    "InstitutionName": "Saint Zephyrin",
    "ReferringPhysicianName": "Oberholtzer",
    "StudyID": "STD-66218",
}
WORDS = ["Quintessa", "Vandermolen", *list(PERSON.values())[1:]]


@pytest.fixture
def scan(tmp_path):
    rng = np.random.default_rng(3)
    slices = [dicom_files.slice_at(rng.integers(0, 900, (12, 14)).astype(np.uint16), n, **PERSON) for n in range(9)]
    return dicom_files.save(tmp_path / "Quintessa", slices)


def told(content):
    return [word for word in WORDS if word.encode() in content or word.encode("utf-16-le") in content]


def test_the_scan_holds_what_files_must_not(scan):
    assert all(told(path.read_bytes()) == WORDS for path in scan.iterdir())


@pytest.mark.parametrize("name", ["x.png", "x.jpg", "x.tif", "x.webp", "x.exr", "x.svg", "x.pdf"])
def test_pictures_hold_no_person(scan, tmp_path, name):
    picture = ws.render(ws.open(scan), size=(40, 30))
    picture.save(tmp_path / name)
    assert told((tmp_path / name).read_bytes()) == []
    if name == "x.png":
        with Image.open(tmp_path / name) as image:  # its texts are packed
            assert told(json.dumps(image.info, default=str).encode()) == []


@pytest.mark.filterwarnings("ignore:OME-.* has no place")
@pytest.mark.parametrize("name", ["x.nii", "x.nrrd", "x.ome.tif", "x.ome.zarr", "command.ome.tif", "x.ply", "x.stl"])
def test_volumes_and_meshes_hold_no_person(scan, tmp_path, wavesplat, name):
    volume = ws.open(scan)
    if name in ("x.ply", "x.stl"):
        ws.mesh(volume, 450).save(tmp_path / name)
    elif name == "command.ome.tif":
        wavesplat("convert", str(scan), "-o", name, cwd=tmp_path)
    else:
        volume.save(tmp_path / name)
    files = [path for path in [tmp_path / name, *(tmp_path / name).rglob("*")] if path.is_file()]
    assert files
    assert [word for path in files for word in told(path.read_bytes())] == []


def test_scenes_and_facts_hold_no_person(scan, tmp_path, wavesplat):
    scan = scan.rename(tmp_path / "scan")  # both name the path that is given
    ws.Scene(ws.open(scan)).save(tmp_path / "scene.json")
    assert told((tmp_path / "scene.json").read_bytes()) == []
    for arguments in (["info", str(scan)], ["info", str(scan), "--json"]):
        done = wavesplat(*arguments, cwd=tmp_path)
        assert done.returncode == 0, done.stderr
        assert told((done.stdout + done.stderr).encode()) == []


def test_the_page_says_so():
    page = (pages.ROOT / "docs" / "privacy.md").read_text(encoding="utf-8")
    assert "patients' names, numbers and dates of DICOM" in page
