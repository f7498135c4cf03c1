"""Data without anatomy are shown as they are stored: row 0 on top, column 0 on the left (microscopy, faults 1, 1b)."""

import numpy as np
import pytest
from PIL import Image

import wavesplat as ws


def letter():
    """A letter F in every plane of a stack, shape (10, 60, 48)."""
    samples = np.zeros((10, 60, 48), np.uint16)
    samples[:, 8:52, 10:16] = samples[:, 8:14, 10:38] = samples[:, 26:32, 10:30] = 1000
    return samples


def like(picture, array):
    """Correlation of a picture with an array, magnified to its size from edge to edge of the samples."""
    grey = np.asarray(Image.open(picture).convert("L"), float)
    rows, columns = (np.linspace(0, n - 1, m).round().astype(int) for n, m in zip(array.shape, grey.shape, strict=True))
    return np.corrcoef(grey.ravel(), array[np.ix_(rows, columns)].ravel())[0, 1]


def body(samples):
    return ws.Volume(samples, unit="mm", anatomical=True)


@pytest.fixture
def stack(tmp_path):
    tifffile = pytest.importorskip("tifffile")
    path = tmp_path / "F.tif"
    how = {"axes": "ZYX", "spacing": 0.5, "unit": "um"}
    tifffile.imwrite(path, letter(), imagej=True, resolution=(2, 2), metadata=how)
    return path


NAMES = ("xy", "xz", "yz")
ARRAYS = {"xy": letter()[5], "xz": letter()[:, 30], "yz": letter()[:, :, 24]}


@pytest.mark.parametrize("plane", NAMES)
def test_slices_are_the_arrays(plane):
    np.testing.assert_array_equal(ws.slice(ws.Volume(letter()), plane).value, ARRAYS[plane])


@pytest.mark.parametrize("view", NAMES)
def test_views_show_what_slices_show(view):
    # A letter that differs along all axes: only the right one of 48 turns and mirrors correlates.
    samples = letter() * np.linspace(1, 0.2, 10)[:, None, None]
    volume = ws.Volume(samples.astype(np.float32), spacing=(1, 1, 4))
    seen = ws.render(volume, camera=view, composite="mean", size=(300, 300)).value
    along = {"xy": 0, "xz": 1, "yz": 2}[view]
    want = samples.mean(axis=along).astype(np.float32)
    rows, columns = np.nonzero(seen > 0)
    seen = seen[rows.min() : rows.max() + 1, columns.min() : columns.max() + 1]
    rows, columns = np.nonzero(want > 0)
    want = want[rows.min() : rows.max() + 1, columns.min() : columns.max() + 1]
    scaled = np.asarray(Image.fromarray(want).resize(seen.shape[::-1], Image.Resampling.BILINEAR))
    others = [np.corrcoef(seen.ravel(), other.ravel())[0, 1] for other in (scaled[::-1], scaled[:, ::-1])]
    assert np.corrcoef(seen.ravel(), scaled.ravel())[0, 1] > max(0.9, *(other + 0.05 for other in others if other < 1))


def test_commands_show_the_letter(wavesplat, stack, tmp_path):
    wavesplat("slice", stack, "-o", tmp_path / "s.png")
    wavesplat("render", stack, "--view", "xy", "-o", tmp_path / "r.png", "--size", "384x480")
    wavesplat("render", stack, "-o", tmp_path / "thin.png", "--size", "384x480")
    assert like(tmp_path / "s.png", letter()[0]) > 0.99
    with Image.open(tmp_path / "s.png") as slice_:
        assert slice_.size == (48, 60)
    # The view frames the letter, not the box.
    framed = letter()[0, 8:52, 10:38]
    for name in ("r.png", "thin.png"):
        grey = np.asarray(Image.open(tmp_path / name).convert("L"))
        rows, columns = np.nonzero(grey > 20)
        Image.fromarray(grey[rows.min() : rows.max() + 1, columns.min() : columns.max() + 1]).save(tmp_path / "cut.png")
        assert like(tmp_path / "cut.png", framed) > 0.95


def test_slices_of_a_patient_are_large_enough_to_be_read(wavesplat, tmp_path):
    nibabel = pytest.importorskip("nibabel")
    image = nibabel.Nifti1Image(np.random.default_rng(0).integers(0, 99, (40, 60, 7)).astype(np.int16), np.eye(4))
    nibabel.save(image, tmp_path / "small.nii")
    wavesplat("slice", tmp_path / "small.nii", "-o", tmp_path / "s.png")
    with Image.open(tmp_path / "s.png") as picture:
        assert picture.size == (39 * 9 + 1, 59 * 9 + 1)


def test_planes_of_patients_are_understood_with_a_note():
    picture = ws.slice(ws.Volume(letter()), "axial")
    np.testing.assert_array_equal(picture.value, letter()[5])
    assert picture.report["notes"][0].startswith("axial is taken for xy, row 0 on top")
    assert "notes" not in ws.slice(ws.Volume(letter()), "xy").report


def test_bodies_stay_as_radiologists_read_them():
    for plane, view in (("axial", "xy"), ("coronal", "xz"), ("sagittal", "yz")):
        own, named = ws.slice(body(letter()), plane), ws.slice(body(letter()), view)
        np.testing.assert_array_equal(own.value, named.value)
        assert "notes" not in named.report
    np.testing.assert_array_equal(ws.slice(body(letter())).value, letter()[5, ::-1, ::-1])


@pytest.mark.parametrize("is_body", [False, True])
def test_three_planes_are_aligned(is_body):
    samples = np.random.default_rng(0).integers(0, 200, (11, 21, 31)).astype(np.uint8)
    volume = body(samples) if is_body else ws.Volume(samples)
    sheet = ws.lightbox(volume, "ortho", letters=False, reference_lines=False, clim=(0, 255), size=(61, 61))
    first, beside, below = sheet.report["panels"]
    assert (first["top"], first["height"]) == (beside["top"], beside["height"])
    assert (first["left"], first["width"]) == (below["left"], below["width"])
    assert sheet.size == (first["width"] + 2 + beside["width"], first["height"] + 2 + below["height"])

    def shown(panel, array):
        top, left = panel["top"], panel["left"]
        rows = sheet.rgba[top : top + panel["height"] : 2, left : left + panel["width"] : 2, 0]
        np.testing.assert_allclose(rows * 255, array, atol=1e-3)

    middle = samples[5], samples[:, 10], samples[:, :, 15]
    if is_body:
        shown(first, middle[1][::-1, ::-1])
        shown(beside, middle[2][::-1, ::-1])
        shown(below, middle[0][::-1, ::-1])
    else:
        shown(first, middle[0])
        shown(beside, middle[2].T)
        shown(below, middle[1])
    with pytest.raises(ws.errors.ArgumentError, match="two columns"):
        ws.lightbox(volume, "ortho", columns=3)


def two_channels():
    rng = np.random.default_rng(1)
    volumes = [ws.Volume(rng.integers(0, 1000, (6, 20, 24)).astype(np.uint16), name=name) for name in "ab"]
    looks = [ws.Look.channel(volumes[0], "green", (100, 900)), ws.Look.channel(volumes[1], "magenta", (0, 500))]
    return volumes, ws.Scene([ws.Layer(volume, look) for volume, look in zip(volumes, looks, strict=True)])


def test_channels_are_added_in_their_colours():
    volumes, scene = two_channels()
    picture = ws.slice(scene, "xy", 3)
    green = np.clip((volumes[0].samples[3] - 100.0) / 800, 0, 1)
    magenta = np.clip(volumes[1].samples[3] / 500.0, 0, 1)
    np.testing.assert_allclose(picture.rgba[..., 1], green, atol=1e-5)
    # Pure magenta is a little lighter on black than (1, 0, 1).
    assert np.abs(picture.rgba[..., 0] - magenta).max() < 0.2
    assert [one["name"] for one in picture.report["shown"]] == ["a", "b"]
    with pytest.raises(ws.errors.ArgumentError, match="for one volume, and the scene has 2 channels"):
        ws.slice(scene, clim=(0, 1))


def test_the_command_draws_all_channels(wavesplat, tmp_path):
    tifffile = pytest.importorskip("tifffile")
    volumes, _ = two_channels()
    stacked = np.stack([volume.samples for volume in volumes], axis=1)
    tifffile.imwrite(tmp_path / "two.tif", stacked, imagej=True, metadata={"axes": "ZCYX"})
    wavesplat("slice", tmp_path / "two.tif", "-o", tmp_path / "all.png", "--plane", "ortho")
    wavesplat("slice", tmp_path / "two.tif", "--channel", "1", "-o", tmp_path / "one.png")
    colors = np.asarray(Image.open(tmp_path / "all.png").convert("RGB"), int)
    assert np.ptp(colors, axis=2).max() > 100
    assert np.ptp(np.asarray(Image.open(tmp_path / "one.png").convert("RGB"), int), axis=2).max() == 0


@pytest.mark.parametrize(("spacing", "view"), [((1, 1, 3), "xy"), ((4, 1, 1), "yz"), ((1, 1, 2), "isometric")])
def test_stacks_with_distant_slices_are_seen_as_slices(spacing, view):
    """Their sides are blurred, as those of confocal stacks and of sections for electron microscopy."""
    rng = np.random.default_rng(0)
    volume = ws.Volume(rng.normal(500, 100, (30, 40, 40)).astype(np.float32), spacing=spacing, unit="um")
    shown = ws.render(volume, size=(20, 20)).report["camera"]
    there = ws.Camera.view(volume, view)
    seen, along = (
        np.subtract(position, focal) / np.linalg.norm(np.subtract(position, focal))
        for position, focal in ((shown["position"], shown["focal_point"]), (there.position, there.focal_point))
    )
    np.testing.assert_allclose(seen, along, atol=1e-9)
    body = ws.Volume(volume.samples, spacing=spacing, unit="mm", anatomical=True)
    assert ws.render(body, ws.Look.auto(body, "over"), size=(20, 20)).report["camera"]["view_up"] == [0, 0, 1]
