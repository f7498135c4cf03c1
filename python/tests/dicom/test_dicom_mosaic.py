"""Mosaics of Siemens: slices in their places, as nibabel's reader of mosaics has them."""

from __future__ import annotations

import struct
import warnings

import numpy as np
import pytest
from dicom_files import random, save, slice_at

import wavesplat as ws
from wavesplat.errors import FileError

#: Directions of rows and columns of an oblique picture, and the normal to them, LPS.
ROWS, COLUMNS = np.array([0.96, 0.28, 0.0]), np.array([-0.168, 0.576, -0.8])
NORMAL = np.cross(ROWS, COLUMNS)
N, SIZE = 7, (6, 5)


def private_header(**values):
    """A private header (CSA2) as Siemens writes it, with these values as text."""
    content = b"SV10\4\3\2\1" + struct.pack("<2I", len(values), 77)
    for name, numbers in values.items():
        kind = b"FD\0\0" if "." in str(numbers[0]) else b"IS\0\0"
        content += struct.pack("<64si4s3i", name.encode(), len(numbers), kind, 0, len(numbers), 77)
        for number in numbers:
            text = str(number).encode() + b"\0"
            content += struct.pack("<4i", len(text), len(text), 77, len(text)) + text + b"\0" * (-len(text) % 4)
    return content


def mosaic(slices, number=0, *, direction=1.0, said="CSA", **attributes):
    """A file with slices [z, y, x] side by side."""
    side = int(np.ceil(np.sqrt(len(slices))))
    rows, columns = slices.shape[1:]
    picture = np.zeros((side * rows, side * columns), slices.dtype)
    for k, one in enumerate(slices):
        row, column = divmod(k, side)
        picture[row * rows : (row + 1) * rows, column * columns : (column + 1) * columns] = one
    placed = {
        "ImagePositionPatient": [-20.5, 10.25, 30.125],
        "ImageOrientationPatient": [*ROWS, *COLUMNS],
        "ImageType": ["ORIGINAL", "PRIMARY", "M", "ND", "MOSAIC"],
        "SpacingBetweenSlices": 3.6,
        "modality": "MR",
        "Manufacturer": "SIEMENS",
        "AcquisitionTime": f"1200{2 * number:02}.0",
        "AcquisitionNumber": number + 1,
    }
    dataset = slice_at(picture, number, **{**placed, **attributes})
    if "CSA" in said:
        normal = (direction * NORMAL).tolist()
        block = dataset.private_block(0x0029, "SIEMENS CSA HEADER", create=True)
        block.add_new(0x10, "OB", private_header(NumberOfImagesInMosaic=[len(slices)], SliceNormalVector=normal))
    if "number" in said:
        dataset.private_block(0x0019, "SIEMENS MR HEADER", create=True).add_new(0x0A, "US", len(slices))
    return dataset


def slices_of(number):
    return random(N + number, size=SIZE)[:N]


@pytest.mark.parametrize("direction", [1.0, -1.0])
def test_a_mosaic_is_split_as_nibabel_does(tmp_path, direction):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        from nibabel.nicom.dicomwrappers import MosaicWrapper
    dataset = mosaic(slices_of(0), direction=direction)
    dataset.save_as(tmp_path / "a.dcm", enforce_file_format=True)
    volume = ws.open(tmp_path / "a.dcm")
    theirs = MosaicWrapper(dataset)
    # Its axes are rows, columns and slices as they are stored; LPS.
    values = theirs.get_data()
    ours_from_theirs = np.linalg.inv(volume.world_from_index) @ np.diag([-1, -1, 1, 1]) @ theirs.affine
    for place in np.ndindex(values.shape):
        x, y, z, _ = ours_from_theirs @ (*place, 1)
        np.testing.assert_allclose((x, y, z), np.round((x, y, z)), atol=1e-4)
        assert volume.samples[round(z), round(y), round(x)] == values[place]
    assert volume.shape == (N, *SIZE)
    assert volume.guesses == ()


@pytest.mark.parametrize("said", ["CSA", "number", "CSA number"])
def test_a_series_of_mosaics_is_a_series_of_times(tmp_path, said):
    folder = save(tmp_path / "mr", [mosaic(slices_of(t), t, said=said) for t in range(3)])
    series = ws.open_series(folder)
    assert series.times == (0, 2, 4)
    for t, volume in enumerate(series):
        np.testing.assert_array_equal(volume.samples, slices_of(t))
        np.testing.assert_allclose(volume.spacing, (0.7, 0.8, 3.6))
        assert any("does not say their order" in told for told in volume.guesses) == (said == "number")


def test_mosaics_without_the_private_header_are_named(tmp_path):
    folder = save(tmp_path / "mr", [mosaic(slices_of(t), t, said="") for t in range(3)])
    with pytest.raises(FileError, match=r"each file holds a mosaic .*private 0019,xx0A.* were removed"):
        ws.open(folder)


def test_a_private_header_that_is_damaged_says_nothing(tmp_path):
    dataset = mosaic(slices_of(0))
    dataset[0x0029, 0x1010].value = dataset[0x0029, 0x1010].value[:150]
    dataset.save_as(tmp_path / "a.dcm", enforce_file_format=True)
    with pytest.raises(FileError, match="mosaic"):
        ws.open(tmp_path / "a.dcm")


def test_a_mosaic_that_cannot_be_divided_is_refused(tmp_path):
    dataset = mosaic(slices_of(0), said="number")
    dataset[0x0019, 0x100A].value = 11
    dataset.save_as(tmp_path / "a.dcm", enforce_file_format=True)
    with pytest.raises(FileError, match=r"mosaic \(Siemens\) of 11 slices, whose 15 x 18 pixels are no multiple of 4"):
        ws.open(tmp_path / "a.dcm")
