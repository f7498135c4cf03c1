import numpy as np
import pytest
import tifffile

import wavesplat as ws
from wavesplat.errors import ArgumentError, FileError

RGBA = np.zeros((3, 5, 4), np.float32)
RGBA[1, 2] = (0.25, 0.125, 0.0, 0.5)
PICTURE = ws.Picture(RGBA, depth=np.full((3, 5), np.nan, np.float32))


def read_png(path):
    import SimpleITK

    return SimpleITK.GetArrayFromImage(SimpleITK.ReadImage(str(path)))


@pytest.mark.parametrize(("bits", "top"), [(8, 255), (16, 65535)])
def test_png_is_not_associated(tmp_path, bits, top):
    PICTURE.save(tmp_path / "a.png", bits=bits)
    pixels = read_png(tmp_path / "a.png")
    np.testing.assert_allclose(pixels[1, 2] / top, (0.5, 0.25, 0, 0.5), atol=1 / top)
    assert pixels[0, 0].tolist() == [0, 0, 0, 0]


def test_tiff_keeps_the_floats(tmp_path):
    PICTURE.save(tmp_path / "a.tif")
    np.testing.assert_array_equal(tifffile.imread(tmp_path / "a.tif"), RGBA)
    with tifffile.TiffFile(tmp_path / "a.tif") as tiff:
        assert tiff.pages[0].extrasamples == (tifffile.EXTRASAMPLE.ASSOCALPHA,)


def test_exr_keeps_the_floats_and_the_depth(tmp_path):
    import OpenEXR

    PICTURE.save(tmp_path / "a.exr")
    with OpenEXR.File(str(tmp_path / "a.exr")) as file:
        channels = file.channels()
        np.testing.assert_array_equal(channels["RGBA"].pixels, RGBA)
        assert np.isinf(channels["Z"].pixels).all()


def test_notebooks_get_a_png():
    assert PICTURE._repr_png_().startswith(b"\x89PNG")


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("a.jpg", r"as \.jpg; use one of: \.png, \.tif, \.tiff, \.exr: .*a\.jpg$"),
        ("a", "without a suffix"),
        ("nowhere/a.png", "folder does not exist.*a.png$"),
        ("folder.png", "this is a folder.*folder.png$"),
    ],
)
def test_paths_that_cannot_be_written(tmp_path, name, message):
    (tmp_path / "folder.png").mkdir()
    with pytest.raises(FileError, match=message):
        PICTURE.save(tmp_path / name)


def test_devices_are_not_replaced():
    with pytest.raises(FileError, match="device"):
        ws.TransferFunction([(0, 1)], [(0, 1, 1, 1)]).save("/dev/null")


@pytest.mark.parametrize("suffix", [".png", ".tif", ".exr"])
def test_a_failure_leaves_the_old_file_and_no_other(tmp_path, monkeypatch, suffix):
    from pathlib import Path

    path = tmp_path / f"a{suffix}"
    path.write_bytes(b"old")

    def full_disk(*_):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(Path, "replace", full_disk)
    with pytest.raises(FileError, match=f"No space left.*a{suffix}$"):
        PICTURE.save(path)
    assert [entry.name for entry in tmp_path.iterdir()] == [path.name]
    assert path.read_bytes() == b"old"


def test_bits_are_8_or_16(tmp_path):
    with pytest.raises(ArgumentError, match="bits is 12"):
        PICTURE.save(tmp_path / "a.png", bits=12)
    with pytest.raises(ArgumentError, match="bits is 12"):
        PICTURE.save(tmp_path / "a.tif", bits=12)
