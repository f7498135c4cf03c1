"""Impossible DICOM headers: refused by name before time or memory is spent, or mended with a warning."""

from __future__ import annotations

import sys
import time
import tracemalloc
import warnings
import zlib

import numpy as np
import pytest
from dicom_files import base, enhanced, random, save, sequence, slice_at

import wavesplat as ws
from wavesplat.errors import FileError, FileWarning

# Lengths


def test_no_more_is_read_than_there_is(tmp_path):
    folder = save(tmp_path / "ct", [slice_at(random(1)[0], 0)])
    whole = (folder / "000.dcm").read_bytes()
    # An element of a kind whose length has four bytes.
    at = whole.index(b"\xe0\x7f\x10\x00OW")
    (folder / "000.dcm").write_bytes(whole[:at] + b"\x09\x00\x10\x10UN\0\0\xf0\xff\xff\xff" + whole[at:])
    check_refused_at_once(folder, "cannot be read|too little pixel data")


# Numbers of frames


def promising(kind, n_frames):
    """A file of one frame whose header promises many."""
    pixels = random(1, np.uint8, size=(64, 64), most=250)
    if kind == "enhanced":
        dataset = enhanced(pixels, [(0.0,)])
    elif kind == "dose":
        dataset = slice_at(pixels[0], 0, modality="RTDOSE", GridFrameOffsetVector=[0, 1], DoseGridScaling=0.5)
    else:
        modality = {"segmentation": "SEG", "tomogram": "NM"}.get(kind, "US")
        dataset = base(pixels[0], modality=modality, **({"FrameTime": 40} if kind == "ultrasound" else {}))
    if kind == "segmentation":
        dataset.PixelData = np.packbits(pixels[0] > 100, bitorder="little").tobytes()
        dataset.BitsAllocated = dataset.BitsStored = 1
        dataset.HighBit = 0
    if kind == "tomogram":
        dataset.SliceVector, dataset.TimeSlotVector = [1], [1]
        dataset.DetectorInformationSequence = sequence(
            {"ImagePositionPatient": [0, 0, 0], "ImageOrientationPatient": [1, 0, 0, 0, 1, 0]}
        )
    dataset.NumberOfFrames = n_frames
    return dataset


def calls_of(work):
    """Number of calls of functions, in Python and compiled: a cost that is the same on every machine."""
    n = 0

    def count(_, event, __):
        nonlocal n
        n += event in ("call", "c_call")

    sys.setprofile(count)
    try:
        work()
    finally:
        sys.setprofile(None)
    return n


def check_refused_at_once(folder, match):
    def open_it():
        for path in (folder, folder / "000.dcm"):
            with pytest.raises(FileError, match=match):
                ws.open(path)

    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        open_it()  # imports and caches of the first call do not count
        tracemalloc.start()
        open_it()
        peak = tracemalloc.get_traced_memory()[1]
        tracemalloc.stop()
        n_calls = calls_of(open_it)
    assert n_calls < 50_000  # a twentieth of the frames
    assert peak < 50e6


@pytest.mark.parametrize("kind", ["ultrasound", "segmentation", "dose", "tomogram", "enhanced"])
def test_a_million_frames_are_refused_at_once(tmp_path, kind):
    folder = save(tmp_path / "us", [promising(kind, 1_000_000)])
    check_refused_at_once(folder, "too little pixel data: 1000000 x 64 x 64 pixels of")


def test_a_million_compressed_frames_are_refused_at_once(tmp_path):
    from pydicom.uid import RLELossless

    dataset = base(random(2), modality="US", NumberOfFrames=2)
    dataset.compress(RLELossless, generate_instance_uid=False)
    dataset.NumberOfFrames = 1_000_000
    check_refused_at_once(save(tmp_path / "us", [dataset]), "1000000 frames .* fragments, the file holds 2;")


def test_a_million_frames_packed_as_a_whole_are_refused_at_once(tmp_path):
    from pydicom.uid import DeflatedExplicitVRLittleEndian

    dataset = promising("ultrasound", 1_000_000)
    dataset.file_meta.TransferSyntaxUID = DeflatedExplicitVRLittleEndian
    check_refused_at_once(save(tmp_path / "us", [dataset]), "too little pixel data: 1000000 x 64 x 64 pixels of")


def test_frames_packed_as_a_whole(tmp_path):
    from pydicom.uid import DeflatedExplicitVRLittleEndian

    pixels = random(3)
    dataset = enhanced(pixels, [(0.0,), (1.5,), (3.0,)])
    dataset.file_meta.TransferSyntaxUID = DeflatedExplicitVRLittleEndian
    np.testing.assert_array_equal(ws.open(save(tmp_path / "mr", [dataset])).samples, pixels)


def repacked(path, change):
    """Change the unpacked data set of a file that is packed as a whole."""
    content = path.read_bytes()
    begin = 144 + int.from_bytes(content[140:144], "little")  # behind the length of the meta information
    packer = zlib.compressobj(9, zlib.DEFLATED, -zlib.MAX_WBITS)
    packed = packer.compress(change(zlib.decompress(content[begin:], -zlib.MAX_WBITS))) + packer.flush()
    path.write_bytes(content[:begin] + packed)


def packed_series(folder, pixels):
    from pydicom.uid import DeflatedExplicitVRLittleEndian

    slices = [slice_at(one, n) for n, one in enumerate(pixels)]
    for dataset in slices:
        dataset.file_meta.TransferSyntaxUID = DeflatedExplicitVRLittleEndian
        # An element of any length, before the transfer syntax is found.
        dataset.file_meta.PrivateInformationCreatorUID = "2.25.1"
        dataset.file_meta.PrivateInformation = bytes(5000)
    return save(folder, slices)


def test_no_more_is_unpacked_than_there_are_pixels(tmp_path):
    pixels = random(3)
    folder = packed_series(tmp_path / "ct", pixels)
    wanted = ws.open(folder).samples
    for path in folder.iterdir():
        repacked(path, lambda content: content + bytes(200 << 20))
    tracemalloc.start()
    np.testing.assert_array_equal(ws.open(folder).samples, wanted)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert peak < 50 << 20
    for path in folder.iterdir():
        repacked(path, lambda content: content[: -(200 << 20) - 7])
    with pytest.raises(FileError, match="too little pixel data"):
        ws.open(folder)


def test_no_longer_header_is_unpacked(tmp_path, monkeypatch):
    from wavesplat._readers.dicom import pixel_data

    monkeypatch.setattr(pixel_data, "MAX_HEADER_BYTES", 1 << 22)
    folder = packed_series(tmp_path / "ct", random(3))
    first = b"\x08\x00\x01\x00OB\0\0" + (100 << 20).to_bytes(4, "little") + bytes(100 << 20)
    for path in folder.iterdir():
        repacked(path, lambda content: first + content)
    check_refused_at_once(folder, "header unpacks to more than 4 MiB before the pixel data")


@pytest.mark.parametrize("said", ["1e400", "many", "nan"])
def test_a_number_of_frames_that_is_none(tmp_path, said):
    from pydicom.dataelem import DataElement

    dataset = base(random(2), modality="US")
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        dataset[0x00280008] = DataElement(0x00280008, "LO", said)
        folder = save(tmp_path / "us", [dataset])
    with pytest.raises(FileError, match=f"NumberOfFrames is '{said}', and is a whole number"):
        ws.open(folder)


def test_more_frames_than_are_described(tmp_path):
    dataset = enhanced(random(4), [(0.0,), (1.5,), (3.0,), (4.5,)])
    del dataset.PerFrameFunctionalGroupsSequence[3]
    with pytest.raises(FileError, match="says 4 frames .* describes 3 of them"):
        ws.open(save(tmp_path / "mr", [dataset]))


def cpu_seconds(path):
    start = time.process_time()
    assert ws.open(path).shape[1:] == (4, 4)
    return time.process_time() - start


def test_time_grows_with_frames_not_with_their_square(tmp_path):
    few, many = 800, 8800
    pixels = np.zeros((many, 4, 4), np.uint8)
    for n in (few, many):
        offsets = {"GridFrameOffsetVector": [*range(n)], "DoseGridScaling": 1}
        dose = slice_at(pixels[0], 0, modality="RTDOSE", NumberOfFrames=n, **offsets)
        dose.PixelData = pixels[:n].tobytes()
        save(tmp_path / f"dose{n}", [dose])
    cpu_seconds(tmp_path / f"dose{few}")
    taken = [min(cpu_seconds(tmp_path / f"dose{n}") for _ in range(2)) for n in (few, many)]
    assert taken[1] < 4 * many / few * max(taken[0], 0.01)


# Bits and bytes


def test_half_the_bits_are_refused(tmp_path):
    """Else noise from every first byte would be drawn."""
    datasets = [slice_at(pixels, number) for number, pixels in enumerate(random(3))]
    for dataset in datasets:
        dataset.BitsAllocated = dataset.BitsStored = 8
        dataset.HighBit = 7
    match = r"too much pixel data: 1 x 6 x 7 pixels of 8 bits need 42 bytes, the file holds 84, so BitsAllocated \(8\)"
    with pytest.raises(FileError, match=match):
        ws.open(save(tmp_path / "ct", datasets))


def test_half_the_bits_of_compressed_pixels_are_refused(tmp_path):
    """RLE has a segment for each byte of a pixel."""
    from pydicom.uid import RLELossless

    datasets = [slice_at(pixels, number) for number, pixels in enumerate(random(3))]
    for dataset in datasets:
        dataset.compress(RLELossless, generate_instance_uid=False)
        dataset.BitsAllocated = dataset.BitsStored = 8
        dataset.HighBit = 7
    with pytest.raises(FileError, match=r"compressed pixels \(RLE\) do not unpack: .*segments") as caught:
        ws.open(save(tmp_path / "ct", datasets))
    assert "truncated, damaged" not in str(caught.value)


@pytest.mark.parametrize(("syntax", "marker"), [("1.2.840.10008.1.2.4.70", 0xC3), ("1.2.840.10008.1.2.4.51", 0xC1)])
def test_precision_of_jpeg_is_that_of_the_header(tmp_path, syntax, marker, monkeypatch):
    """Decoders return the low bits of 12 or 16 as 8; that the stream has more is written in its own header."""
    from pydicom.encaps import encapsulate
    from pydicom.uid import UID

    from wavesplat._readers.dicom import pixels as dicom_pixels

    def decoded(header, shape, fragments):
        return np.zeros(shape, np.uint8)

    monkeypatch.setattr(dicom_pixels, "_by_neutral_copy", decoded)
    comment = b"\xff\xfe\x00\x04hi"
    for precision in (8, 12):
        stream = b"\xff\xd8" + comment + bytes([0xFF, marker, 0, 11, precision, 0, 6, 0, 7, 1, 1, 0x11, 0])
        datasets = [slice_at(pixels, number) for number, pixels in enumerate(random(2, np.uint8, most=250))]
        for dataset in datasets:
            dataset.file_meta.TransferSyntaxUID = UID(syntax)
            dataset.PixelData = encapsulate([stream])
            dataset["PixelData"].is_undefined_length = True
        folder = save(tmp_path / str(precision), datasets)
        if precision == 8:
            assert ws.open(folder).shape == (2, 6, 7)
        else:
            with pytest.raises(FileError, match=r"compressed pixels have 12 bits, the header says 8 \(BitsAllocated"):
                ws.open(folder)


def test_a_frame_too_many_is_refused(tmp_path):
    dataset = enhanced(random(4), [(0.0,), (1.5,), (3.0,), (4.5,)])
    dataset.NumberOfFrames = 2
    del dataset.PerFrameFunctionalGroupsSequence[2:]
    with pytest.raises(FileError, match="too much pixel data: 2 x 6 x 7 .* NumberOfFrames"):
        ws.open(save(tmp_path / "mr", [dataset]))


def test_bytes_after_the_pixels_are_told(tmp_path):
    pixels = random(3)
    datasets = [slice_at(one, number) for number, one in enumerate(pixels)]
    datasets[1].PixelData += bytes(10)
    volume = ws.open(save(tmp_path / "ct", datasets))
    np.testing.assert_array_equal(volume.samples, pixels)
    assert "pixels of 1 of the files from the beginning of longer pixel data" in volume.guesses[0]


def test_an_odd_number_of_bytes_is_filled_up_without_a_word(tmp_path):
    pixels = random(3, np.uint8, size=(5, 7), most=250)
    volume = ws.open(save(tmp_path / "ct", [slice_at(one, number) for number, one in enumerate(pixels)]))
    np.testing.assert_array_equal(volume.samples, pixels)
    assert volume.guesses == ()


# Values


@pytest.mark.parametrize(("slope", "intercept"), [("0", "5"), ("nan", "5"), ("inf", "0"), ("1", "nan"), ("x", "0")])
def test_slopes_that_cannot_be(tmp_path, slope, intercept):
    pixels = random(3)

    def with_scale(dataset):
        for tag, value in ((0x00281053, slope), (0x00281052, intercept)):
            dataset.add_new(tag, "LO", value)  # DS refuses to be written
        return dataset

    datasets = [with_scale(slice_at(one, number)) for number, one in enumerate(pixels)]
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        folder = save(tmp_path / "ct", datasets)
    with pytest.warns(FileWarning, match="values as they are stored: slope .* cannot be"):
        volume = ws.open(folder)
    np.testing.assert_array_equal(volume.samples, pixels)
    assert volume.dtype == np.uint16
    save(folder, [*datasets[:2], slice_at(pixels[2], 2, RescaleSlope=2, RescaleIntercept=0)])
    with pytest.raises(FileError, match=r"values of 2 files are unknown: 000.dcm has slope"):
        ws.open(folder)


@pytest.mark.parametrize("fill", [63536, 0xFFFF, 4000])
def test_padding_brighter_than_the_scan_is_not_shown_as_such(tmp_path, fill):
    pixels = random(3, most=3000)
    pixels[:, 0, :2] = fill
    scale = {"RescaleSlope": 1, "RescaleIntercept": -1024, "PixelPaddingValue": fill}
    datasets = [slice_at(one, number, **scale) for number, one in enumerate(pixels)]
    volume = ws.open(save(tmp_path / "ct", datasets))
    wanted = pixels.astype(np.int32) - 1024
    low = wanted[pixels != fill].min()
    wanted[pixels == fill] = low
    np.testing.assert_array_equal(volume.samples, wanted)
    assert volume.dtype == np.int16
    assert volume.guesses == (f"6 samples outside of the scan (PixelPaddingValue) as the lowest value in it, {low}",)


def test_padding_is_a_range_with_its_limit(tmp_path):
    pixels = random(3, most=3000)
    pixels[:, 0, :3] = (60000, 60500, 61000)
    limits = {"PixelPaddingValue": 61000, "PixelPaddingRangeLimit": 60000}
    volume = ws.open(save(tmp_path / "ct", [slice_at(one, number, **limits) for number, one in enumerate(pixels)]))
    low = pixels[pixels < 3000].min()
    np.testing.assert_array_equal(volume.samples, np.where(pixels < 3000, pixels, low))


@pytest.mark.parametrize(("dtype", "fill"), [(np.uint16, 63536), (np.int16, -32768)])
def test_padding_that_stored_bits_cannot_hold(tmp_path, dtype, fill):
    """The low twelve bits of 63536 are 2096, a value of tissue."""
    pixels = random(3, dtype, most=2000)
    pixels[:, 0, :2] = fill
    datasets = [slice_at(one, number, bits_stored=12, PixelPaddingValue=fill) for number, one in enumerate(pixels)]
    volume = ws.open(save(tmp_path / "ct", datasets))
    np.testing.assert_array_equal(volume.samples, np.where(pixels == fill, 0 if fill > 0 else -2048, pixels))
    assert "for which there are too few stored bits" in volume.guesses[0]


def test_padding_that_is_darker_than_the_scan_stays(tmp_path):
    pixels = random(3, np.int16, most=3000)
    pixels[:, 0, :2] = -2000
    datasets = [slice_at(one, number, PixelPaddingValue=-2000) for number, one in enumerate(pixels)]
    volume = ws.open(save(tmp_path / "ct", datasets))
    np.testing.assert_array_equal(volume.samples, pixels)
    assert volume.guesses == ()


def test_padding_that_is_darker_in_every_slice_stays(tmp_path):
    pixels = random(2, np.int16, most=3000)
    pixels[:, 0, :2] = -2000
    scales = [{"RescaleSlope": slope, "RescaleIntercept": 0, "PixelPaddingValue": -2000} for slope in (1, 0.5)]
    datasets = [slice_at(one, number, **scales[number]) for number, one in enumerate(pixels)]
    volume = ws.open(save(tmp_path / "pt", datasets))
    np.testing.assert_allclose(volume.samples, pixels * np.array([1, 0.5])[:, None, None])


def test_padding_with_a_slope_for_each_slice(tmp_path):
    """Each slice has its own lowest value; the volume's lowest is that of the padding, and slopes stay right."""
    pixels = random(3, most=3000) + np.uint16(10)
    pixels[1, 2, 3] = 50000
    scales = [{"RescaleSlope": slope, "RescaleIntercept": 0, "PixelPaddingValue": 50000} for slope in (0.5, 2.0, 8.0)]
    datasets = [slice_at(one, number, **scales[number]) for number, one in enumerate(pixels)]
    wanted = pixels * np.array([0.5, 2.0, 8.0])[:, None, None]
    wanted[1, 2, 3] = np.delete(wanted.ravel(), 42 + 2 * 7 + 3).min()
    np.testing.assert_allclose(ws.open(save(tmp_path / "pt", datasets)).samples, wanted)


# Places


def test_directions_that_are_no_unit_vectors(tmp_path):
    datasets = [
        slice_at(one, number, ImageOrientationPatient=[2, 0, 0, 0, 0.5, 0]) for number, one in enumerate(random(3))
    ]
    volume = ws.open(save(tmp_path / "ct", datasets))
    assert volume.spacing == pytest.approx((0.7, 0.8, 1.5))
    assert "directions alone: in 3 files its vectors have lengths 2 and 0.5, and must have 1" in volume.guesses[0]


def test_directions_at_no_right_angle(tmp_path):
    datasets = [
        slice_at(one, number, ImageOrientationPatient=[1, 0, 0, 0.6, 0.8, 0]) for number, one in enumerate(random(3))
    ]
    with pytest.raises(FileError, match="ImageOrientationPatient of 000.dcm is not two directions at right angles"):
        ws.open(save(tmp_path / "ct", datasets))


def test_directions_of_no_length_are_none(tmp_path):
    datasets = [slice_at(one, number, ImageOrientationPatient=[0] * 6) for number, one in enumerate(random(3))]
    volume = ws.open(save(tmp_path / "ct", datasets))
    assert "does not say where they lie" in volume.guesses[0]


@pytest.mark.parametrize("spacing", [(-0.8, 0.7), (0.8, 0)])
def test_pixel_spacing_that_is_not_positive(tmp_path, spacing):
    folder = save(tmp_path / "ct", [slice_at(one, n, spacing=spacing) for n, one in enumerate(random(3))])
    with pytest.raises(FileError, match=r"PixelSpacing of 000.dcm is .* must be positive; pass spacing="):
        ws.open(folder)
    assert ws.open(folder, spacing=(1, 2, 3)).spacing == (1, 2, 3)


def test_a_slice_beside_the_others_is_named(tmp_path):
    datasets = [slice_at(one, number) for number, one in enumerate(random(6))]
    datasets[2].ImagePositionPatient = [13.0, 20.0, 33.0]
    with pytest.raises(FileError, match=r"shifted against each other: 002.dcm lies 3 mm beside the line"):
        ws.open(save(tmp_path / "ct", datasets))


# Files with other contents


def without_image(modality, **attributes):
    dataset = base(random(1)[0], 99, modality=modality, series="1.2.4", **attributes)
    for name in ("Rows", "Columns", "PixelData", "BitsAllocated"):
        delattr(dataset, name)
    return dataset


@pytest.mark.parametrize(
    ("modality", "sop_class", "what", "instead"),
    [
        ("RTSTRUCT", "481.3", "a structure set", "--contours FILE, or --labels FILE"),
        ("RTPLAN", "481.5", "a plan of a radiotherapy", "--layer DOSE"),
        ("SR", "88.33", "a structured report", "segmentation"),
        ("PR", "11.1", "a presentation state", "--window"),
        ("ECG", "9.1.1", "an electrocardiogram", "waveform_array"),
        ("SEG", "66.5", "a segmentation as surfaces", "as a segmentation of voxels"),
        ("XYZ", "91.1", "something else \\(Microscopy Bulk Simple Annotations\\)", "name the images"),
    ],
)
def test_files_without_an_image_say_what_they_hold_and_what_to_name_instead(
    tmp_path, modality, sop_class, what, instead
):
    dataset = without_image(modality)
    dataset.SOPClassUID = dataset.file_meta.MediaStorageSOPClassUID = f"1.2.840.10008.5.1.4.1.1.{sop_class}"
    folder = save(tmp_path / "others", [dataset])
    for path in (folder, folder / "000.dcm"):
        with pytest.raises(FileError, match=f"holds {what}.*; .*{instead}") as caught:
            ws.open(path)
        assert "damaged" not in str(caught.value)


def test_a_single_slice_names_the_files_that_are_damaged(tmp_path):
    folder = save(tmp_path / "ct", [slice_at(one, number) for number, one in enumerate(random(2))])
    (folder / "001.dcm").write_bytes((folder / "001.dcm").read_bytes()[:-40])
    with pytest.raises(FileError, match=r"a single slice, .* \(1 file of the folder is damaged .*001.dcm"):
        ws.open(folder)


def test_mosaics_are_named(tmp_path):
    datasets = [
        slice_at(one, number, z=0.0, ImageType=["ORIGINAL", "PRIMARY", "M", "MOSAIC"], AcquisitionNumber=number)
        for number, one in enumerate(random(3))
    ]
    folder = save(tmp_path / "mr", datasets)
    with pytest.raises(FileError, match="each file holds a mosaic .*, the slices of a volume side by side"):
        ws.open(folder)
    (folder / "001.dcm").unlink()
    (folder / "002.dcm").unlink()
    with pytest.raises(FileError, match="mosaic"):
        ws.open(folder)


def test_videos_and_codecs_that_are_not_read_are_named(tmp_path):
    from pydicom.uid import UID

    for syntax, match in (
        ("1.2.840.10008.1.2.4.102", "holds a video .*MPEG-4"),
        ("1.2.840.10008.1.2.4.201", "compressed as High-Throughput JPEG 2000.*convert the files"),
    ):
        datasets = [slice_at(one, number) for number, one in enumerate(random(2))]
        for dataset in datasets:
            dataset.file_meta.TransferSyntaxUID = UID(syntax)
            dataset.PixelData = b"\xfe\xff\x00\xe0\0\0\0\0\xfe\xff\x00\xe0\x04\0\0\0abcd"
            dataset["PixelData"].VR = "OB"
            dataset["PixelData"].is_undefined_length = True
        with pytest.raises(FileError, match=match) as caught:
            ws.open(save(tmp_path / syntax, datasets))
        assert "damaged" not in str(caught.value)


def test_tiles_of_a_slide_are_no_volume(tmp_path):
    tiles = base(random(4, np.uint8, most=250), modality="SM", NumberOfFrames=4)
    tiles.SOPClassUID = tiles.file_meta.MediaStorageSOPClassUID = "1.2.840.10008.5.1.4.1.1.77.1.6"
    with pytest.raises(FileError, match="tiles of a slide"):
        ws.open(save(tmp_path / "sm", [tiles]))
