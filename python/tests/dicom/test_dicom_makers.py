"""Headers that scanners of several makers wrote, without their patients, against the results of other programs.

`fixtures/dicom_headers` holds values of attributes from public files, and names these; the pixels are made up.
"""

from __future__ import annotations

import json
import warnings
from pathlib import Path

import numpy as np
import pytest
from dicom_files import base, random, save, sequence, slice_at
from pydicom import dcmread
from pydicom.data import get_testdata_file
from pydicom.uid import ImplicitVRLittleEndian

import wavesplat as ws
from wavesplat._readers.dicom.header import header_of
from wavesplat.errors import FileError

FOLDER = Path(__file__).parents[1] / "fixtures" / "dicom_headers"
PET = json.loads((FOLDER / "pet.json").read_text())["headers"]
MR = json.loads((FOLDER / "mr.json").read_text())
GRID, MOSAICS = MR["grids"][0], MR["mosaics"]
#: Private elements of Philips by their names.
PHILIPS = {"SUVScaleFactor": 0x00, "ActivityConcentrationScaleFactor": 0x09}


@pytest.mark.parametrize("scan", PET, ids=[scan["name"] for scan in PET])
def test_uptake_of_real_headers_is_that_of_calculate_suv(tmp_path, scan):
    pixels = random(3)
    datasets = []
    for number, one in enumerate(pixels):
        drug = sequence(scan["tracer"])
        own = {"RescaleSlope": 1 + number, "RescaleIntercept": 0, "RadiopharmaceuticalInformationSequence": drug}
        dataset = slice_at(one, number, modality="PT", **scan["header"], **own)
        for name, value in scan["private"].items():
            block = dataset.private_block(0x7053, "Philips PET Private Group", create=True)
            block.add_new(PHILIPS[name], "DS", str(value))
        datasets.append(dataset)
    volume = ws.open(save(tmp_path / "pet", datasets), suv=True)
    slopes = np.arange(1, 4)[:, None, None]
    np.testing.assert_allclose(volume.samples, pixels * slopes * scan["suv_factor"], rtol=1e-3)


@pytest.mark.parametrize("scan", MR["diffusion"], ids=[scan["name"] for scan in MR["diffusion"]])
def test_diffusion_of_real_headers_without_the_names_of_private_blocks(tmp_path, scan):
    """Programs that remove names of persons remove these names, too; the maker says whose elements they are."""

    def found(**changes):
        dataset = slice_at(random(1)[0], 0, modality="MR", **{**scan["header"], **changes})
        for tag, code, value in scan["private"]:
            dataset.add_new(tag, code, value)
        dataset.save_as(tmp_path / "a.dcm", enforce_file_format=True)
        attributes = header_of(tmp_path / "a.dcm").frames[0].attributes
        return attributes.get("b-value"), attributes.get("direction")

    assert found() == (scan["b_value"], tuple(scan["direction"]))
    if scan["private"]:
        assert found(Manufacturer="another")[0] is None


# Slices side by side


def tiled(slices, n_columns, n_rows):
    """A picture of slices [z, y, x] side by side, row by row."""
    rows, columns = slices.shape[1:]
    picture = np.zeros((n_rows * rows, n_columns * columns), slices.dtype)
    for k, one in enumerate(slices):
        row, column = divmod(k, n_columns)
        picture[row * rows : (row + 1) * rows, column * columns : (column + 1) * columns] = one
    return picture


def grid(slices, number=0, *, leave_out=(), n_said=None):
    """A file of UIH with slices side by side, the b-value and the direction those of the real one."""
    positions, times = GRID["positions"][: len(slices)], GRID["times"]
    n_columns = int(np.ceil(np.sqrt(len(slices))))
    picture = tiled(slices, n_columns, -(-len(slices) // n_columns))
    placed = {**GRID["header"], "Rows": picture.shape[0], "Columns": picture.shape[1]}
    dataset = slice_at(picture, number, modality="MR", Manufacturer="UIH", **placed)
    del dataset.ImagePositionPatient
    items = sequence(
        *({"ImagePositionPatient": at, "AcquisitionTime": time} for at, time in zip(positions, times, strict=False))
    )
    block = dataset.private_block(0x0065, "Image Private Header", create=True)
    elements = {
        0x09: ("FD", 0.0 if number == 0 else GRID["b_value"]),
        0x37: ("FD", [0.0, 0.0, 0.0] if number == 0 else np.roll(GRID["direction"], number).tolist()),
        0x50: ("DS", str(n_said or len(slices))),
        0x51: ("SQ", items),
    }
    for element, (code, value) in elements.items():
        if element not in leave_out:
            block.add_new(element, code, value)
    return dataset


@pytest.mark.parametrize("is_implicit", [False, True])
def test_a_grid_of_uih_lies_where_dcm2niix_puts_it(tmp_path, is_implicit):
    x, y, z = GRID["shape"]
    slices = random(z, size=(y, x))
    dataset = grid(slices)
    if is_implicit:  # which hides that the private element is a sequence
        dataset.file_meta.TransferSyntaxUID = ImplicitVRLittleEndian
    dataset.save_as(tmp_path / "a.dcm", enforce_file_format=True)
    volume = ws.open(tmp_path / "a.dcm")
    np.testing.assert_array_equal(volume.samples, slices)
    # dcm2niix turns the rows around.
    theirs = np.linalg.inv([*GRID["affine"], [0, 0, 0, 1]]) @ volume.world_from_index
    wanted = np.array([[1, 0, 0, 0], [0, -1, 0, y - 1], [0, 0, 1, 0], [0, 0, 0, 1]])
    np.testing.assert_allclose(theirs, wanted, atol=1e-3)
    assert volume.guesses == ()


def test_grids_of_uih_are_a_series_in_the_order_of_the_files(tmp_path):
    slices = [random(5 + t, size=(6, 7))[:5] for t in range(4)]  # in three columns and two rows
    series = ws.open_series(save(tmp_path / "mr", [grid(one, t) for t, one in enumerate(slices)]))
    for volume, one in zip(series, slices, strict=True):
        np.testing.assert_array_equal(volume.samples, one)


@pytest.mark.parametrize(
    ("changes", "told"),
    [
        ({"leave_out": [0x51]}, r"holds a grid \(United Imaging\), .* were removed"),
        ({"n_said": 6}, r"of 6 slices \(0065,xx50\), and describes 5"),
    ],
)
def test_grids_that_cannot_be_split_are_refused(tmp_path, changes, told):
    folder = save(tmp_path / "mr", [grid(random(5), t, **changes) for t in range(2)])
    with pytest.raises(FileError, match=told):
        ws.open(folder)


@pytest.mark.parametrize("end", ["last", "first"])
@pytest.mark.parametrize("scan", MOSAICS, ids=[scan["name"] for scan in MOSAICS])
def test_mosaics_by_the_protocol_of_their_series(tmp_path, scan, end):
    """The picture's position is that of its first slice, at one of the ends of the protocol's list."""
    words = [line.replace(" ", "").split("=") for line in scan["protocol"]]
    said = {
        name.removeprefix("sSliceArray."): float(int(value, 0) if "x" in value else float(value))
        for name, value in words
    }
    n = int(said["lSize"])
    ends = np.array([[said[f"asSlice[{k}].sPosition.d{axis}"] for axis in ("Sag", "Cor", "Tra")] for k in (0, n - 1)])
    side = int(np.ceil(np.sqrt(n)))
    rows = scan["header"]["Rows"] // side
    slices = random(n, size=(rows, rows))
    place = np.array(scan["header"]["ImagePositionPatient"])
    if end == "first":
        place, ends = place + ends[0] - ends[1], ends[::-1]
    own = {**scan["header"], "ImagePositionPatient": place.tolist()}
    dataset = slice_at(tiled(slices, side, side), modality="MR", Manufacturer="SIEMENS", number=0, **own)
    text = "\n".join(["### ASCCONV BEGIN ###", *scan["protocol"], "### ASCCONV END ###"])
    dataset.private_block(0x0029, "SIEMENS CSA HEADER", create=True).add_new(0x20, "OB", text.encode())
    del dataset[0x00290010]  # as in the public files
    dataset.save_as(tmp_path / "a.dcm", enforce_file_format=True)
    volume = ws.open(tmp_path / "a.dcm")
    # Slices are in order upwards.
    np.testing.assert_array_equal(volume.samples, slices[::-1] if end == "last" else slices)
    upwards = sorted(ends.tolist(), key=lambda centre: centre[2])
    normal = np.cross(*np.reshape(scan["header"]["ImageOrientationPatient"], (2, 3)))
    for k, centre in zip((0, n - 1), upwards, strict=True):
        ours = (volume.world_from_index @ [rows / 2 - 0.5, rows / 2 - 0.5, k, 1])[:3] * [-1, -1, 1]
        assert abs((ours - centre) @ normal) < 0.01
        np.testing.assert_allclose(ours, centre, atol=0.51 * scan["header"]["PixelSpacing"][0])


def test_a_mosaic_of_several_files_is_no_stack_of_pictures(tmp_path):
    """Also where each file lies elsewhere, as of a head that moves."""
    header = MOSAICS[0]["header"]
    datasets = []
    for t in range(3):
        place = np.add(header["ImagePositionPatient"], [0, 0, 2.5 * t]).tolist()
        own = {**header, "Rows": 8, "Columns": 8, "ImagePositionPatient": place}
        datasets.append(slice_at(random(3, size=(8, 8))[t], t, modality="MR", **own))
    with pytest.raises(FileError, match=r"holds a mosaic \(Siemens\), .* were removed"):
        ws.open(save(tmp_path / "mr", datasets))


# Doses and segmentations, of files that come with pydicom


def test_a_dose_of_a_planning_system():
    file = get_testdata_file("rtdose.dcm", download=False)
    said = dcmread(file)
    volume = ws.open(file)
    np.testing.assert_allclose(volume.samples, said.pixel_array * float(said.DoseGridScaling), rtol=1e-12)
    assert (said.DoseUnits, volume.value_unit, volume.guesses) == ("RELATIVE", "relative dose", ())


def test_a_segmentation_of_dcmqi():
    file = get_testdata_file("liver_1frame.dcm", download=False)
    said = dcmread(file)
    volume = ws.open(file)
    np.testing.assert_array_equal(volume.samples, [0 * said.pixel_array, said.pixel_array, 0 * said.pixel_array])
    assert ws.Labels.open(file).labels[1].name == said.SegmentSequence[0].SegmentLabel == "Liver"


def test_raw_data_of_the_scanner_beside_a_series_are_no_slice(tmp_path):
    """Philips writes a file of the class Raw Data, with rows, columns and the UID of the series, without pixels."""
    pixels = np.random.default_rng(1).integers(0, 3000, (3, 6, 7), np.uint16)
    slices = [slice_at(pixels[number], number) for number in range(3)]
    raw = base(pixels[0], 3, sop_class="1.2.840.10008.5.1.4.1.1.66", modality="CT")
    del raw.PixelData
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        volume = ws.open(save(tmp_path / "some", [*slices, raw]))
    np.testing.assert_array_equal(volume.samples, pixels)
    np.testing.assert_allclose(volume.world_from_index[:3, 3], (-10, -20, 30))
    with pytest.raises(FileError, match=r"holds something else \(Raw Data\), no image"):
        ws.open(tmp_path / "some" / "003.dcm")
