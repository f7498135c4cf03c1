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


@pytest.mark.parametrize("bits", [8, 16])
def test_tiff_has_the_numbers_of_png(tmp_path, bits):
    for name in ("a.tif", "a.png"):
        PICTURE.save(tmp_path / name, bits=bits)
    np.testing.assert_array_equal(tifffile.imread(tmp_path / "a.tif"), read_png(tmp_path / "a.png"))
    with tifffile.TiffFile(tmp_path / "a.tif") as tiff:
        assert tiff.pages[0].extrasamples == (tifffile.EXTRASAMPLE.UNASSALPHA,)


def test_tiff_is_rgb_with_the_distance_of_pixels(tmp_path):
    """Fault 10 of the microscopist's trial: Fiji's Image > Properties shows `report["pixel"]` and its unit."""
    volume = ws.Volume(np.random.default_rng(1).integers(0, 200, (9, 30, 40), np.uint8), spacing=(0.3,) * 3, unit="um")
    picture = ws.render(volume, "grey", "left", size=(60, 50), background="black")
    picture.save(tmp_path / "a.tif")
    with tifffile.TiffFile(tmp_path / "a.tif") as tiff:
        page = tiff.pages[0]
        assert tiff.is_imagej
        assert tiff.imagej_metadata["unit"] == "um"
        assert (page.shape, page.dtype) == ((50, 60, 3), np.uint8)
        for tag in ("XResolution", "YResolution"):
            n_pixels, n_units = page.tags[tag].value
            assert n_units / n_pixels == pytest.approx(picture.report["pixel"], rel=1e-6)
        assert page.tags["ResolutionUnit"].value == tifffile.RESUNIT.NONE
        np.testing.assert_array_equal(page.asarray(), np.asarray(picture)[..., :3])
    assert picture.report["pixel"] == pytest.approx(picture.camera.parallel_scale / 25)


def test_tiff_in_perspective_has_no_distance_of_pixels(tmp_path):
    volume = ws.Volume(np.eye(8, dtype=np.uint8)[None].repeat(8, axis=0), unit="um")
    camera = ws.Camera.view(volume, "left", view_angle=30)
    ws.render(volume, "grey", camera, size=(20, 20)).save(tmp_path / "a.tif")
    with tifffile.TiffFile(tmp_path / "a.tif") as tiff:
        assert not tiff.is_imagej
        assert tiff.pages[0].tags["XResolution"].value == (1, 1)


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
        ("a.gif", r"as \.gif; use one of: \.png, \.jpg, \.jpeg, \.webp, \.tif, \.tiff, \.exr, \.svg, \.pdf: .*a\.gif$"),
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


@pytest.mark.parametrize("suffix", [".png", ".jpg", ".webp", ".tif", ".exr"])
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


def noise(n=40):
    """Random associated floats, some of them slightly above their range."""
    rng = np.random.default_rng(3)
    rgba = rng.random((n, n, 4), dtype=np.float32)
    rgba[..., :3] *= rgba[..., 3:] * np.float32(1.05)
    rgba[0, :, 3] = 0
    return ws.Picture(rgba)


def test_bytes_are_those_of_the_png(tmp_path):
    picture = noise()
    picture.save(tmp_path / "a.png")
    np.testing.assert_array_equal(np.asarray(picture), read_png(tmp_path / "a.png"))
    np.testing.assert_array_equal(np.asarray(picture.to_pil()), read_png(tmp_path / "a.png"))


def test_what_takes_arrays_takes_pictures():
    from PIL import Image

    picture = noise()
    shown = np.asarray(picture)
    assert (shown.dtype, shown.shape) == (np.uint8, (40, 40, 4))
    assert np.asarray(picture, dtype=np.float32).dtype == np.float32
    np.testing.assert_array_equal(np.array(picture, dtype=int), shown)
    assert Image.fromarray(np.asarray(picture)).mode == "RGBA"
    with pytest.raises(ValueError, match="leave out copy=False"):
        picture.__array__(copy=False)
    assert picture.__array__(copy=True).flags.owndata


@pytest.mark.parametrize("suffix", [".jpg", ".jpeg"])
def test_jpeg_lies_on_white(tmp_path, suffix):
    from PIL import Image

    rgba = np.zeros((16, 16, 4), np.float32)
    rgba[:, 8:] = (0.5, 0, 0, 0.5)
    ws.Picture(rgba).save(tmp_path / f"a{suffix}", dpi=300)
    with Image.open(tmp_path / f"a{suffix}") as read:
        assert (read.format, read.mode, read.info["dpi"]) == ("JPEG", "RGB", (300, 300))
        assert np.abs(np.asarray(read)[:, 2].astype(int) - 255).max() <= 2
        assert np.abs(np.asarray(read)[:, 13].astype(int) - (255, 128, 128)).max() <= 2


def test_webp_keeps_transparency_and_may_lose_nothing(tmp_path):
    from PIL import Image

    picture = noise()
    for quality in (95, 100):
        picture.save(tmp_path / f"{quality}.webp", quality=quality)
    with Image.open(tmp_path / "100.webp") as read:
        got = np.asarray(read)
        seen = got[..., 3] > 0
        np.testing.assert_array_equal(got[seen], np.asarray(picture)[seen])
        np.testing.assert_array_equal(got[..., 3], np.asarray(picture)[..., 3])
    assert (tmp_path / "95.webp").stat().st_size < (tmp_path / "100.webp").stat().st_size


def test_pixels_per_inch_are_in_the_file(tmp_path):
    from PIL import Image

    for suffix in ("png", "tif"):
        PICTURE.save(tmp_path / f"a.{suffix}", dpi=600)
    with Image.open(tmp_path / "a.png") as read:
        assert read.info["dpi"] == pytest.approx((600, 600), abs=0.1)
        np.testing.assert_array_equal(np.asarray(read), np.asarray(PICTURE))
    with tifffile.TiffFile(tmp_path / "a.tif") as tiff:
        assert tiff.pages[0].get_resolution("INCH") == (600, 600)


@pytest.mark.parametrize(
    ("given", "message"),
    [({"dpi": 0}, "dpi is 0; give pixels per inch"), ({"quality": 0}, "quality is 0; give 1 to 100")],
)
def test_settings_that_cannot_be(tmp_path, given, message):
    with pytest.raises(ArgumentError, match=message):
        PICTURE.save(tmp_path / "a.jpg", **given)
    assert list(tmp_path.iterdir()) == []


def test_a_short_text_says_what_a_picture_is():
    assert repr(PICTURE) == "Picture(5 x 3 pixels, with depth)"
    ct = ws.slice(ws.examples.ct_pelvis())
    assert repr(ct) == "Picture(122 x 101 pixels of 3 mm, with value)"
    assert (ct.pixel, ct.unit) == (3.0, "mm")
    assert (PICTURE.pixel, PICTURE.unit) == (None, None)


def test_the_systems_viewer_shows_it(monkeypatch):
    from PIL import ImageShow

    shown = []
    monkeypatch.setattr(ImageShow, "show", lambda image, title: shown.append((image.size, title)) or True)
    PICTURE.show()
    assert shown == [((5, 3), "wavesplat")]
    monkeypatch.setattr(ImageShow, "show", lambda *_, **__: False)
    with pytest.raises(ws.errors.LibraryError, match="no viewer of pictures; write a file"):
        PICTURE.show()


def test_axes_of_a_figure_are_the_worlds():
    volume = ws.Volume(np.arange(60).reshape(3, 4, 5), spacing=(2, 2, 2), unit="um")
    axes = ws.slice(volume, "xy").figure().axes[0]
    # As an array is shown: y grows downwards. Samples lie at the middles of pixels.
    assert (axes.get_xlabel(), axes.get_ylabel()) == ("x (µm)", "y (µm)")
    assert axes.get_xlim() == (-1, 9)
    assert axes.get_ylim() == (7, -1)
    body = ws.Volume(volume.samples, spacing=(2, 2, 2), unit="mm", anatomical=True)
    axes = ws.slice(body, "axial").figure().axes[0]
    # Seen from below, as radiologists do: x grows to the left.
    assert (axes.get_xlim(), axes.get_ylim()) == ((9, -1), (-1, 7))
    assert PICTURE.figure().axes[0].axison is False
    seen = ws.Picture(RGBA, report={"pixel": 0.5}).figure().axes[0]
    assert (seen.get_xlim(), seen.get_ylim(), seen.get_xlabel()) == ((-1.25, 1.25), (-0.75, 0.75), "right")


def test_figures_need_matplotlib(monkeypatch):
    import sys

    monkeypatch.setitem(sys.modules, "matplotlib", None)
    with pytest.raises(ws.errors.LibraryError, match=r'matplotlib is not installed.*pip install "wavesplat\[figure\]"'):
        PICTURE.figure()


@pytest.mark.parametrize(("unit", "spacing"), [("Ω", 1.0), (None, 1e-12)])
def test_tiff_leaves_out_what_it_cannot_hold(tmp_path, unit, spacing):
    volume = ws.Volume(np.arange(64, dtype=np.uint8).reshape(4, 4, 4), spacing=(spacing,) * 3, unit=unit)
    ws.render(volume, "grey", size=(8, 8)).save(tmp_path / "p.tif")
    assert (tmp_path / "p.tif").stat().st_size > 100
