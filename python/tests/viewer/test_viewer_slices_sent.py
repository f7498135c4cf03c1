"""Slices of DICOM and TIFF that pages send, in folders and without: one volume, called by what it shows."""

import io
import json

import numpy as np
import pytest
import tifffile
from dicom_files import random, save, slice_at
from opening_pages import nifti_of, started_page

from wavesplat._model.volume.private_names import without_folders

started = pytest.fixture(started_page)


def dicom(tmp_path, n=5, **attributes):
    """Bytes of slices by their names, and their samples."""
    pixels = random(n)
    save(tmp_path, [slice_at(one, number, **attributes) for number, one in enumerate(pixels)])
    return {file.name: file.read_bytes() for file in sorted(tmp_path.iterdir())}, pixels


def tiff(n=4):
    """Bytes of slices by their names, and their samples."""
    samples = np.random.default_rng(1).integers(0, 255, (n, 9, 8), np.uint8)
    files = {}
    for number, one in enumerate(samples):
        content = io.BytesIO()
        tifffile.imwrite(content, one)
        files[f"em_{number:03}.tif"] = content.getvalue()
    return files, samples


def within(folder, files):
    return {f"{folder}/{name}": data for name, data in files.items()}


def check(page, begun, files, name, samples, *, layer="CT"):
    """`name`: what the page is told that it sent; `layer`: the name in the picture."""
    told = page.open(files)
    assert told["shown"]
    assert told["found"] == [{"kind": "volume", "name": name}]
    shown = begun[0].scene.layers[0]
    assert shown.name == layer == begun[0].document["layers"][0]["name"]
    assert begun[0].document["layers"][0]["volume"]["name"] == layer
    assert np.array_equal(shown.drawn.samples, samples)
    return begun[0].file_document()["layers"][0]["volume"]["path"]


@pytest.mark.parametrize("folder", ["study/series 7", "CT"])
def test_a_folder_of_dicom_has_its_name(started, tmp_path, folder):
    files, pixels = dicom(tmp_path, SeriesDescription="AX T1")
    assert check(*started, within(folder, files), folder.split("/")[-1], pixels) == f"{folder}/"


def test_a_folder_of_tiff_has_its_name(started):
    files, samples = tiff()
    check(*started, within("em stack", files), "em stack", samples, layer="EM")


def test_loose_dicom_has_the_description_of_its_series(started, tmp_path):
    files, pixels = dicom(tmp_path, SeriesDescription="AX T1 / post: 3")
    check(*started, files, "AX T1 post 3", pixels)


@pytest.mark.parametrize("description", ["", "..", "/"])
def test_loose_dicom_without_a_description_has_the_beginning_of_its_names(started, tmp_path, description):
    files, pixels = dicom(tmp_path, SeriesDescription=description)
    named = {f"IM{number:04}": data for number, data in enumerate(files.values())}
    check(*started, named, "IM", pixels)


def test_slices_without_anything_in_common_are_called_slices(started, tmp_path):
    files, pixels = dicom(tmp_path)
    named = {f"{number:04}": data for number, data in enumerate(files.values())}
    check(*started, named, "slices", pixels)


def test_loose_tiff_is_one_volume_beside_another_file(started):
    files, samples = tiff()
    page, begun = started
    mask = (samples > 100).astype(np.uint8)
    told = page.open({**files, "mask.nii.gz": nifti_of(mask, 1.0)})
    assert sorted(one["name"] for one in told["found"]) == ["em", "mask.nii.gz"]
    assert np.array_equal(begun[0].scene.layers[0].drawn.samples, samples)


def test_loose_slices_of_several_series_are_a_question_and_named_after_it(started, tmp_path):
    page, begun = started
    files, expected = {}, {}
    for number, text in ((2, "AX T2"), (3, "AX T1")):
        place = tmp_path / str(number)
        place.mkdir()
        uid = f"1.2.{number}"
        some, expected[uid] = dicom(place, SeriesDescription=text, SeriesNumber=number, series=uid)
        files |= {f"IM{number}{name}": data for name, data in some.items()}
    upload = page.send(files)
    several = page.answer("open", upload=upload)[0]["several"]
    assert (several["option"], sorted(several["names"])) == ("series", ["1.2.2", "1.2.3"])
    told = page.answer("open", upload=upload, choice={"option": "series", "value": "1.2.3"})[0]
    assert told["found"] == [{"kind": "volume", "name": "IM"}]
    assert np.array_equal(begun[0].scene.layers[0].drawn.samples, expected["1.2.3"])


def test_slices_that_differ_are_said_by_their_names(started):
    files, _ = tiff()
    content = io.BytesIO()
    tifffile.imwrite(content, np.zeros((5, 5), np.uint8))
    page, _ = started
    message = page.refusal("open", upload=page.send({**files, "em_900.tif": content.getvalue()}))
    assert "em_900.tif is (5, 5)" in message
    assert "wavesplat-open" not in message


def test_pictures_of_a_folder_that_was_sent_do_not_hold_its_name(started, tmp_path):
    files, pixels = dicom(tmp_path, SeriesDescription="AX T1 of Doe")
    page, begun = started
    check(page, begun, within("DOE^JANE", files), "DOE^JANE", pixels)
    document = without_folders(begun[0].file_document())
    assert "DOE" not in json.dumps(document)
    assert document["layers"][0]["name"] == "CT"


def test_pictures_of_loose_slices_do_not_hold_the_description_of_their_series(started, tmp_path):
    files, pixels = dicom(tmp_path, SeriesDescription="AX T1 of Doe")
    check(*started, files, "AX T1 of Doe", pixels)
    assert "Doe" not in json.dumps(without_folders(started[1][0].file_document()))
