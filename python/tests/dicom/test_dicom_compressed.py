"""Compressed pixels of DICOM as others write them: several fragments a frame, numbers beyond their bits, YBR."""

import numpy as np
import pytest
from dicom_files import base, save
from pydicom.uid import UID

import wavesplat as ws
from wavesplat._readers.request import taking_planes

#: 0, 7, 14, ... in 6 rows of 8, by CharLS; and 8 x 8 of 4000 with 4 x 4 of 4100 in the middle, by OpenJPEG, 16 bits.
RAMP = bytes.fromhex(
    "ffd8ffe800205350494646000200000100000006000000080a0806010000012c0000012cffe8000800000001ffd8fff7000b08000600"
    "0801011100ffda0008010100000000851562ad3e000002de33148ec18000005bf336d982edb6914d9248291aab0000005be400ffd9"
)
SQUARE = bytes.fromhex(
    "ff4fff5100290000000000080000000800000000000000000000000800000008000000000000000000010f0101ff52000c0000000100"
    "0004040001ff5c00044080ff90000a00000000005e0001ff93cffc3130115054af6eaef328a73a6c8883a09642351db4b258fd360073"
    "6964b1fa6c00e6d2c963f4d801cda592c7e9b0039b22212425e33c0000492a5231c1b2aa512c7e9b0039b4b258fd3600736a41ffd9"
)


def compressed(folder, pixels, syntax, fragments, **attributes):
    """A file of pixels in fragments, without a table of offsets."""
    dataset = base(pixels, modality="US", **attributes)
    dataset.file_meta.TransferSyntaxUID = UID(f"1.2.840.10008.1.2.4.{syntax}")
    dataset.PixelData = b"\xfe\xff\x00\xe0\0\0\0\0"
    for fragment in fragments:
        even = fragment + b"\0" * (len(fragment) % 2)
        dataset.PixelData += b"\xfe\xff\x00\xe0" + len(even).to_bytes(4, "little") + even
    dataset["PixelData"].VR, dataset["PixelData"].is_undefined_length = "OB", True
    return save(folder, [dataset]) / "000.dcm"


@pytest.mark.parametrize("cut", [None, 40])
def test_frames_of_jpeg_ls_in_one_fragment_or_in_two(tmp_path, cut):
    frames = np.stack([np.arange(48, dtype=np.uint8).reshape(6, 8) * np.uint8(7)] * 2)
    fragments = [RAMP] * 2 if cut is None else [RAMP[:cut], RAMP[cut:]] * 2
    path = compressed(tmp_path / "ls", frames, 80, fragments, NumberOfFrames=2)
    with taking_planes():
        np.testing.assert_array_equal(ws.open(path, time=1).samples[0], frames[1])


def test_bright_pixels_that_lossy_compression_made_brighter_do_not_turn_black(tmp_path):
    pixels = np.full((8, 8), 4000, np.uint16)
    pixels[2:6, 2:6] = 4100  # more than 12 bits hold
    path = compressed(tmp_path / "j2k", pixels, 91, [SQUARE], bits_stored=12)
    with taking_planes():
        np.testing.assert_array_equal(ws.open(path).samples[0], pixels)


@pytest.mark.parametrize(("photometric", "red"), [("YBR_FULL", 200), ("RGB", 83)])
def test_colours_by_rle_are_turned_into_red_green_and_blue(tmp_path, photometric, red):
    from pydicom.uid import RLELossless

    stored = np.tile(np.array([83, 98, 211], np.uint8), (6, 8, 1))  # Y, Cb and Cr of (200, 34, 30), by ITU-R BT.601
    dataset = base(stored[..., 0], modality="US", SamplesPerPixel=3, PlanarConfiguration=0)
    dataset.PhotometricInterpretation, dataset.PixelData = photometric, stored.tobytes()
    dataset.compress(RLELossless, generate_instance_uid=False)
    with taking_planes():
        samples = ws.open(save(tmp_path / "rle", [dataset]) / "000.dcm", channel=0).samples
    assert np.abs(samples.astype(int) - red).max() <= 1


@pytest.mark.parametrize("start", ["bare", "tiff"])
def test_files_without_a_suffix_are_known_by_their_bytes(tmp_path, start):
    """Without the head of 132 bytes, as before 1993 and on some networks; or with that of a TIFF file in it."""
    from pydicom.uid import ImplicitVRLittleEndian

    pixels = np.arange(48, dtype=np.uint16).reshape(6, 8)
    dataset = base(pixels, SpecificCharacterSet="ISO_IR 100")
    (tmp_path / "one").mkdir()
    path = tmp_path / "one" / "IMAGE"
    if start == "bare":
        dataset.file_meta.TransferSyntaxUID = ImplicitVRLittleEndian
        del dataset.file_meta
        dataset.save_as(path, implicit_vr=True, little_endian=True)
    else:
        dataset.preamble = b"II*\0" + bytes(124)
        dataset.save_as(path, enforce_file_format=True)
    with taking_planes():
        np.testing.assert_array_equal(ws.open(path).samples[0], pixels)


def test_info_of_a_picture_beside_a_damaged_file(tmp_path, wavesplat):
    path = save(tmp_path / "some", [base(np.arange(48, dtype=np.uint16).reshape(6, 8))]) / "000.dcm"
    (path.parent / "001.dcm").write_bytes(path.read_bytes()[:400])
    done = wavesplat("info", str(path))
    assert (done.returncode, "8 x 6 x 1" in done.stdout) == (0, True), done.stderr
