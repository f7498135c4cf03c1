"""DICOM: values by each frame's own slope, frames and gaps in their places, and damage that is named."""

from __future__ import annotations

import io
import shutil

import numpy as np
import pytest
from dicom_files import base, enhanced, random, save, slice_at

import wavesplat as ws
from wavesplat._readers.dicom import reading as dicom
from wavesplat._readers.dicom import series as dicom_series
from wavesplat._readers.dicom.header import header_of
from wavesplat._readers.dicom.pixels import frames_in
from wavesplat._readers.dicom.volumes import volumes_of
from wavesplat.errors import FileError, FileWarning

#: World from index of slices by `slice_at`, with LPS turned into RAS.
PLACE = np.array([[-0.7, 0, 0, -10], [0, -0.8, 0, -20], [0, 0, 1.5, 30], [0, 0, 0, 1]])


def check(volume, values, *, dtype=None, place=PLACE):
    np.testing.assert_allclose(volume.samples, values, rtol=1e-6)
    if dtype is not None:
        assert volume.dtype == np.dtype(dtype)
    np.testing.assert_allclose(volume.world_from_index, place, atol=1e-6)


# Values


def test_each_slice_has_its_own_slope(tmp_path):
    import SimpleITK

    pixels = random(4)
    slopes = [0.5, 1.25, 2.5, 40.125]
    scaled = [{"RescaleSlope": slope, "RescaleIntercept": 0} for slope in slopes]
    folder = save(tmp_path / "pet", [slice_at(pixels[n], n, modality="PT", **scaled[n]) for n in range(4)])
    volume = ws.open(folder)
    check(volume, pixels * np.array(slopes)[:, None, None], dtype="f4")
    assert (volume.unit, volume.is_anatomical, volume.modality) == ("mm", True, "PT")
    for n in range(4):  # alone, ITK has them right too
        one = SimpleITK.GetArrayFromImage(SimpleITK.ReadImage(str(folder / f"{n:03}.dcm")))[0]
        np.testing.assert_allclose(volume.samples[n], one, rtol=1e-6)


@pytest.mark.parametrize(
    ("intercepts", "dtype"), [((0, -1024, -1024), "i2"), ((0, 40000, 0), "u2"), ((-5, 70000, 0), "i4")]
)
def test_whole_slopes_keep_whole_numbers_that_hold_all(tmp_path, intercepts, dtype):
    pixels = random(3)
    datasets = [slice_at(pixels[n], n, RescaleSlope=1, RescaleIntercept=intercepts[n]) for n in range(3)]
    folder = save(tmp_path / "ct", datasets)
    check(ws.open(folder), pixels.astype(np.int64) + np.array(intercepts)[:, None, None], dtype=dtype)


def test_slices_of_different_types(tmp_path):
    pixels = [
        random(1, np.uint8, most=250)[0],
        random(1, np.uint16, most=60000)[0],
        random(1, np.int16)[0] - np.int16(2000),
    ]
    check(ws.open(save(tmp_path / "mixed", [slice_at(p, n) for n, p in enumerate(pixels)])), np.array(pixels, np.int32))


def test_inversion_is_for_display_only(tmp_path):
    pixels = random(3)
    folder = save(
        tmp_path / "m1", [slice_at(p, n, PhotometricInterpretation="MONOCHROME1") for n, p in enumerate(pixels)]
    )
    check(ws.open(folder), pixels, dtype="u2")


def test_bits_beside_those_stored_do_not_count(tmp_path):
    pixels = random(3, most=4096)
    folder = save(tmp_path / "a", [slice_at(p | np.uint16(0xF000), n, bits_stored=12) for n, p in enumerate(pixels)])
    check(ws.open(folder), pixels, dtype="u2")
    signed = (pixels << 4).astype(np.int16) >> 4
    datasets = [slice_at(p.astype(np.int16) & np.int16(0x0FFF), n, bits_stored=12) for n, p in enumerate(pixels)]
    check(ws.open(save(tmp_path / "b", datasets)), signed, dtype="i2")


@pytest.mark.parametrize("photometric", ["MONOCHROME1", "MONOCHROME2"])
def test_lossy_jpeg_is_as_another_decoder_has_it(tmp_path, photometric):
    """Decoders of JPEG may differ by one step of the stored numbers, so that values differ by the slope."""
    from PIL import Image
    from pydicom.encaps import encapsulate
    from pydicom.uid import JPEGBaseline8Bit

    y, x = np.mgrid[:64, :48]
    pixels = [(120 + 60 * np.sin(x / (5 + n)) + 40 * np.cos(y / 7)).astype(np.uint8) for n in range(3)]
    datasets, decoded = [], []
    for number, one in enumerate(pixels):
        stream = io.BytesIO()
        Image.fromarray(one).save(stream, "JPEG", quality=80)
        decoded.append(np.asarray(Image.open(stream)))
        dataset = slice_at(
            one, number, PhotometricInterpretation=photometric, RescaleSlope=32.125, RescaleIntercept=-4047
        )
        dataset.file_meta.TransferSyntaxUID = JPEGBaseline8Bit
        dataset.PixelData = encapsulate([stream.getvalue()])
        dataset["PixelData"].is_undefined_length = True
        datasets.append(dataset)
    volume = ws.open(save(tmp_path / "jpeg", datasets))
    np.testing.assert_allclose(volume.samples, np.array(decoded) * 32.125 - 4047, atol=32.125)
    assert np.abs(volume.samples - (np.array(decoded) * 32.125 - 4047)).mean() < 1


def test_rle(tmp_path):
    from pydicom.uid import RLELossless

    pixels = random(3)
    datasets = [slice_at(p, n) for n, p in enumerate(pixels)]
    for dataset in datasets:
        dataset.compress(RLELossless, generate_instance_uid=False)
    check(ws.open(save(tmp_path / "rle", datasets)), pixels, dtype="u2")


def test_colours_are_channels(tmp_path):
    pixels = np.random.default_rng(2).integers(0, 255, (3, 6, 7, 3)).astype(np.uint8)
    datasets = []
    for number, one in enumerate(pixels):
        dataset = slice_at(
            one[..., 0], number, SamplesPerPixel=3, PhotometricInterpretation="RGB", PlanarConfiguration=0
        )
        dataset.PixelData = one.tobytes()
        datasets.append(dataset)
    folder = save(tmp_path / "rgb", datasets)
    volume = ws.open(folder, channel=1)
    check(volume, pixels[..., 1], dtype="u1")
    assert volume.facts.channel.name == "green"
    with pytest.raises(FileError, match="3 channels"):
        ws.open(folder)


# Frames


def test_frames_are_sorted_by_position_and_have_their_own_slopes(tmp_path):
    pixels = random(5)
    places = [3.0, 0.0, 12.0, 6.0, 9.0]
    slopes = [1.0, 2.5, 3.0, 0.5, 7.0]
    dataset = enhanced(pixels, [(z, s, -100.0) for z, s in zip(places, slopes, strict=True)])
    save(tmp_path / "mr", [dataset])
    order = np.argsort(places)
    place = PLACE.copy()
    place[2, 2] = 3
    volume = ws.open(tmp_path / "mr" / "000.dcm")
    check(volume, (pixels * np.array(slopes)[:, None, None] - 100)[order], dtype="f4", place=place)
    assert (volume.unit, volume.is_anatomical, volume.modality) == ("mm", True, "MR")
    check(ws.open(tmp_path / "mr"), volume.samples, place=place)  # a folder with this one file


def test_times_and_kinds_of_frames_are_chosen(tmp_path):
    pixels = random(8)
    frames = [(1.5 * (n // 2), 1.0, 0.0, "1", n % 2 + 1, "MP"[n % 2]) for n in range(8)]
    save(tmp_path / "mr", [enhanced(pixels, frames)])
    for time in (0, 1):
        volume = ws.open(tmp_path / "mr", time=time)
        check(volume, pixels[time::2], dtype="u2")
        assert volume.facts.n_times == 2
    with pytest.raises(FileError, match="2 time points"):
        ws.open(tmp_path / "mr")


def test_stacks_of_frames_are_chosen(tmp_path):
    pixels = random(6)
    frames = [(1.5 * (n // 2), 1.0, 0.0, "12"[n % 2]) for n in range(6)]
    save(tmp_path / "mr", [enhanced(pixels, frames)])
    check(ws.open(tmp_path / "mr", time=0), pixels[::2])
    other = ws.open(tmp_path / "mr", time=1)
    np.testing.assert_array_equal(other.samples, pixels[1::2])
    assert other.orientation == "PSL"


def test_info_tells_kinds_of_frames(wavesplat, tmp_path):
    frames = [(1.5 * (n // 2), 1.0, 0.0, "1", n % 2 + 1, ("MAGNITUDE", "PHASE")[n % 2]) for n in range(8)]
    save(tmp_path / "mr", [enhanced(random(8), frames)])
    done = wavesplat("info", tmp_path / "mr")
    assert done.returncode == 0
    assert "times        2, choose with --time: 0 MAGNITUDE, 1 PHASE" in done.stdout
    assert "modality     MR" in done.stdout


def test_frames_without_places_are_slices_by_guess(tmp_path):
    pixels = random(4, np.uint8, most=250)
    save(tmp_path / "ct", [base(pixels, NumberOfFrames=4, PixelSpacing=[0.5, 0.5], SliceThickness=2)])
    volume = ws.open(tmp_path / "ct")
    # No patient's world: x to the right, y down, the first frame in front.
    check(volume, pixels, place=np.diag([0.5, 0.5, 2, 1]))
    assert (volume.unit, volume.is_anatomical, volume.modality) == ("mm", False, "CT")
    assert "frames as slices, 2 mm apart, with x to the right and y down" in volume.guesses[0]


def test_doses_have_offsets_and_a_scaling(tmp_path):
    pixels = random(3)
    placed = {
        "ImagePositionPatient": [10, 20, 30],
        "ImageOrientationPatient": [1, 0, 0, 0, 1, 0],
        "PixelSpacing": [0.8, 0.7],
    }
    dose = base(
        pixels, modality="RTDOSE", NumberOfFrames=3, GridFrameOffsetVector=[0, 1.5, 3], DoseGridScaling=0.25, **placed
    )
    check(ws.open(save(tmp_path / "dose", [dose])), pixels * 0.25, dtype="f4")


# Gaps and damage


def test_a_missing_slice_is_filled_in_where_it_is(tmp_path):
    pixels = random(7)
    folder = save(tmp_path / "ct", [slice_at(p, n) for n, p in enumerate(pixels)])
    (folder / "002.dcm").unlink()
    (folder / "003.dcm").unlink()
    with pytest.warns(FileWarning, match=r"2 slices are missing .*between 001.dcm and 004.dcm: filled in.*ct$"):
        volume = ws.open(folder)
    wanted = pixels.astype(float)
    wanted[2], wanted[3] = (2 * wanted[1] + wanted[4]) / 3, (wanted[1] + 2 * wanted[4]) / 3
    check(volume, np.rint(wanted), dtype="u2")
    assert "2 slices are missing" in volume.guesses[0]
    with pytest.raises(FileError, match="not evenly spaced"):
        ws.open(folder, gaps="refuse")


def test_uneven_distances_are_resampled(tmp_path):
    z = np.array([0, 1, 2, 3, 4.5, 6, 7.0])
    ramp = np.round(100 * z).astype(np.uint16)[:, None, None] + np.zeros((1, 6, 7), np.uint16)
    folder = save(tmp_path / "ct", [slice_at(p, n, z=float(at)) for n, (p, at) in enumerate(zip(ramp, z, strict=True))])
    with pytest.warns(
        FileWarning, match=r"not evenly spaced \(distances 1 mm \(4x\), 1.5 mm \(2x\)\): resampled to 1 mm"
    ):
        volume = ws.open(folder)
    np.testing.assert_array_equal(volume.samples[:, 0, 0], 100 * np.arange(8))
    assert volume.spacing[2] == pytest.approx(1)


@pytest.mark.parametrize("step", [0.625, 0.04, 1 / 3])
def test_a_slice_is_missing_among_many_at_any_distance(tmp_path, step):
    pixels = random(200)
    folder = save(tmp_path / "ct", [slice_at(p, n, z=round(step * n, 6)) for n, p in enumerate(pixels)])
    (folder / "002.dcm").unlink()
    with pytest.warns(FileWarning, match=r"1 slice is missing .*between 001.dcm and 003.dcm"):
        volume = ws.open(folder)
    assert volume.shape[0] == 200
    np.testing.assert_array_equal(volume.samples[3:], pixels[3:])


def test_a_stray_slice_is_no_gap(tmp_path):
    folder = save(tmp_path / "ct", [slice_at(p, n) for n, p in enumerate(random(4))])
    save(folder / "far", [slice_at(random(1)[0], 9, z=900.0)])
    (folder / "far" / "000.dcm").rename(folder / "900.dcm")
    (folder / "far").rmdir()
    with pytest.raises(FileError, match="not evenly spaced.*between 003.dcm and 900.dcm"):
        ws.open(folder)


def test_a_survey_of_three_directions_says_how_to_name_one(tmp_path):
    pixels = random(9)
    directions = ([1, 0, 0, 0, 1, 0], [1, 0, 0, 0, 0, -1], [0, 1, 0, 0, 0, -1])
    datasets = [
        slice_at(one, n, ImagePositionPatient=[4 * (n % 3)] * 3, ImageOrientationPatient=directions[n // 3])
        for n, one in enumerate(pixels)
    ]
    folder = save(tmp_path / "survey", datasets)
    told = r"000.dcm and 003.dcm, 3 directions in all .*; {}name one file .*, such as 000.dcm, and others are left out"
    with pytest.raises(FileError, match=told.format("")):
        ws.open(folder)
    archive = shutil.make_archive(str(tmp_path / "survey"), "zip", folder)
    with pytest.raises(FileError, match=told.format("unpack the archive, and ")):
        ws.open(archive)
    volume = ws.open(folder / "003.dcm")
    np.testing.assert_array_equal(np.sort(volume.samples, axis=None), np.sort(pixels[3:6], axis=None))
    assert "without 6 files" in volume.guesses[0]


def test_pixel_spacing_that_changes_is_refused(tmp_path):
    datasets = [slice_at(p, n, spacing=(0.8, 0.7) if n < 2 else (1.6, 1.4)) for n, p in enumerate(random(4))]
    folder = save(tmp_path / "ct", datasets)
    with pytest.raises(
        FileError, match=r"spacing of their pixels: 000.dcm has \(0.8, 0.7\) mm, 002.dcm has \(1.6, 1.4\)"
    ):
        ws.open(folder)
    assert ws.open(folder, spacing=(1, 1, 1)).shape == (4, 6, 7)


def cut_in_the_pixels(path):
    path.write_bytes(path.read_bytes()[:-40])


def cut_in_the_header(path):
    path.write_bytes(path.read_bytes()[:300])


def emptied(path):
    path.write_bytes(b"")


def garbage(path):
    path.write_bytes(np.random.default_rng(1).bytes(2000))


@pytest.mark.parametrize("harm", [cut_in_the_pixels, cut_in_the_header, emptied, garbage])
@pytest.mark.parametrize("compressed", [False, True])
@pytest.mark.every_pair
def test_damaged_files_of_a_series_are_named(tmp_path, harm, compressed):
    from pydicom.uid import RLELossless

    pixels = random(6)
    datasets = [slice_at(p, n) for n, p in enumerate(pixels)]
    for dataset in datasets if compressed else ():
        dataset.compress(RLELossless, generate_instance_uid=False)
    folder = save(tmp_path / "ct", datasets)
    harm(folder / "002.dcm")
    with pytest.warns(FileWarning) as caught:
        volume = ws.open(folder)
    told = [str(warning.message) for warning in caught]
    assert len(told) == 2
    assert "1 file of the folder is damaged and cannot be read (002.dcm), and left out" in told[0]
    assert "1 slice is missing" in told[1]
    assert volume.shape == (6, 6, 7)
    np.testing.assert_array_equal(volume.samples[[0, 1, 3, 4, 5]], pixels[[0, 1, 3, 4, 5]])
    assert len(volume.guesses) == 2


def test_every_second_file_cut(tmp_path):
    folder = save(tmp_path / "ct", [slice_at(p, n) for n, p in enumerate(random(8))])
    for n in range(1, 8, 2):
        cut_in_the_pixels(folder / f"{n:03}.dcm")
    with pytest.warns(FileWarning, match=r"4 files of the folder are damaged and cannot be read \(001.dcm, 003.dcm, "):
        assert ws.open(folder).shape == (4, 6, 7)


def test_a_damaged_slice_of_one_time_is_named(tmp_path, monkeypatch):
    read = []
    monkeypatch.setattr(dicom, "frames_in", lambda header: read.append(header.file) or frames_in(header))
    pixels = random(6)
    folder = save(tmp_path / "ct", [slice_at(p, n, z=1.5 * (n // 2)) for n, p in enumerate(pixels)])
    check(ws.open(folder, time=1), pixels[1::2])
    cut_in_the_pixels(folder / "002.dcm")
    with pytest.raises(FileError, match=r"\(002.dcm\), and left out; then 2 slices at position .* missing or doubled"):
        ws.open(folder, time=0)
    assert len(read) == 3 + 6, "each file once, of the whole volume and of the damaged one"
    check(ws.open(folder, time=1), pixels[1::2])  # whose files are whole


def test_each_header_is_read_once(tmp_path, monkeypatch):
    read = []
    for module in (dicom, dicom_series):
        monkeypatch.setattr(module, "header_of", lambda file: read.append(file.name) or header_of(file))
    folder = save(tmp_path / "ct", [slice_at(p, n) for n, p in enumerate(random(3))])
    ws.open(folder / "001.dcm")
    assert sorted(read) == ["000.dcm", "001.dcm", "002.dcm"]


@pytest.mark.parametrize("kind", ["slices", "frames"])
def test_headers_of_a_series_are_read_once_for_all_times_fault_15(tmp_path, monkeypatch, kind):
    read, split = [], []
    monkeypatch.setattr(dicom_series, "header_of", lambda file: read.append(file.name) or header_of(file))
    monkeypatch.setattr(dicom, "volumes_of", lambda *args: split.append(1) or volumes_of(*args))
    pixels = random(60)
    if kind == "slices":
        slices = [slice_at(one, n, z=1.5 * (n % 3), AcquisitionTime=f"12{n // 3:02}00") for n, one in enumerate(pixels)]
        folder = save(tmp_path / "mr", slices)
    else:
        files = [enhanced(pixels[3 * t : 3 * t + 3], [(0.0,), (1.5,), (3.0,)]) for t in range(20)]
        for t, one in enumerate(files):
            one.SOPInstanceUID, one.AcquisitionDateTime = f"1.2.3.{t}", f"2020010112{t:02}00"
        folder = save(tmp_path / "mr", files)
    series = ws.open_series(folder)
    for t, volume in enumerate(series):
        np.testing.assert_array_equal(volume.samples, pixels[3 * t : 3 * t + 3])
    assert len(series) == 20
    assert (len(read), len(split)) == (60 if kind == "slices" else 20, 1), "each header once, and one split into times"
    # What has changed meanwhile is read again.
    changed = slice_at(pixels[0] + np.uint16(1), 0, AcquisitionTime="120000") if kind == "slices" else None
    if changed is not None:
        changed.save_as(folder / "000.dcm", enforce_file_format=True)
        assert series._volumes[0].samples[0, 0, 0] == pixels[0, 0, 0] + 1
        assert len(read) == 61


def test_too_little_pixel_data(tmp_path):
    dataset = enhanced(random(4), [(0.0,), (1.5,), (3.0,), (4.5,)])
    dataset.PixelData = dataset.PixelData[:-100]
    save(tmp_path / "mr", [dataset])
    with pytest.raises(FileError, match=r"4 x 6 x 7 pixels of 16 bits need 336 bytes, the file holds 236.*000.dcm$"):
        ws.open(tmp_path / "mr" / "000.dcm")
    huge = [slice_at(p, n, Rows=8000, Columns=8000) for n, p in enumerate(random(3))]
    with pytest.raises(FileError, match="need 128000000 bytes, the file holds 84"):
        ws.open(save(tmp_path / "ct", huge))


def test_notes_name_what_is_damaged(wavesplat, tmp_path):
    folder = save(tmp_path / "ct", [slice_at(p, n) for n, p in enumerate(random(6))])
    cut_in_the_pixels(folder / "002.dcm")
    done = wavesplat("slice", folder, "-o", tmp_path / "a.png")
    assert done.returncode == 0
    lines = done.stderr.splitlines()
    assert len(lines) == 2
    assert all(line.startswith("wavesplat: note: ") for line in lines)
    assert "(002.dcm)" in lines[0]
    done = wavesplat("slice", folder, "-o", tmp_path / "a.png", "--gaps", "refuse")
    assert done.returncode == 1
    assert "not evenly spaced" in done.stderr


def test_other_files_in_the_folder_do_not_count(tmp_path):
    pixels = random(3)
    folder = save(tmp_path / "ct", [slice_at(p, n) for n, p in enumerate(pixels)])
    (folder / "readme.txt").write_text("a note")
    report = base(random(1)[0], 99, modality="SR", series="1.2.4")
    for name in ("Rows", "Columns", "PixelData", "BitsAllocated"):
        delattr(report, name)
    report.save_as(folder / "report.dcm", enforce_file_format=True)
    check(ws.open(folder), pixels)
