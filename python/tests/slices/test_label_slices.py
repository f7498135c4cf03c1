"""Slices with a segmentation over them."""

import json

import nibabel
import numpy as np
import pytest
import SimpleITK

import wavesplat as ws
from wavesplat.errors import ArgumentError

AFFINE = np.array([[0, 2.0, 0, -10], [-1.5, 0, 0, 40], [0, 0, 3.0, 5], [0, 0, 0, 1]])
SHAPE = (9, 20, 24)


def scan():
    z, y, x = np.mgrid[:9, :20, :24]
    return ws.Volume((x + y + z).astype(np.float32), world_from_index=AFFINE, unit="mm", anatomical=True, name="scan")


def numbers():
    found = np.zeros(SHAPE, np.int16)
    found[2:7, 4:12, 5:15] = 3
    found[1:8, 8:18, 8:20][found[1:8, 8:18, 8:20] == 0] = 40
    return found


LOOKS = {3: ws.Label("#ff0000", 0.5, name="liver"), 40: ws.Label((0, 0, 1), 0, tint=1.0, name="spleen")}


def label_at(picture):
    """Label number of the sample nearest to each pixel, -1 outside, by positions from the report."""
    report = picture.report
    height, width = picture.rgba.shape[:2]
    rows, columns = np.mgrid[:height, :width]
    right, down = (np.array(report[name]) * report["pixel"] for name in ("right", "down"))
    places = np.array(report["origin"]) + columns[..., None] * right + rows[..., None] * down
    index = np.rint((places - AFFINE[:3, 3]) @ np.linalg.inv(AFFINE[:3, :3]).T).astype(int)
    inside = ((index >= 0) & (index < np.array(SHAPE)[::-1])).all(axis=-1)
    x, y, z = np.moveaxis(np.where(inside[..., None], index, 0), -1, 0)
    return np.where(inside, numbers()[z, y, x], -1)


@pytest.mark.parametrize("plane", ["axial", "coronal", "sagittal", ((8, 22, 18), (1, 2, 3))])
@pytest.mark.parametrize("looks", [LOOKS, {40: LOOKS[40]}])
@pytest.mark.every_pair
def test_every_pixel_has_the_colour_of_the_sample_next_to_it(plane, looks, monkeypatch):
    monkeypatch.setattr("wavesplat._scene.slices.layers_on_slices.PIXELS_AT_ONCE", 300)
    below = ws.slice(scan(), plane, size=(80, 70))
    shown = ws.slice(ws.Scene(scan(), labels=ws.Labels(numbers(), looks)), plane, size=(80, 70))
    at = label_at(below)
    padded = np.pad(at, 1, mode="edge")
    edge = np.any(
        [padded[1:-1, 1:-1] != padded[1 + a : 71 + a, 1 + b : 81 + b] for a, b in ((0, 1), (0, -1), (1, 0), (-1, 0))],
        axis=0,
    )
    expected = below.rgba.copy()
    for number, share, color in ((3, 0.5, (1, 0, 0, 1)), (40, 1.0, (0, 0, 1, 1))):
        if number in looks:
            assert (at == number).any()
            alpha = np.where(edge, share, 0.4 * share)[..., None]
            expected = np.where((at == number)[..., None], np.array(color) * alpha + (1 - alpha) * expected, expected)
    np.testing.assert_allclose(shown.rgba, expected, atol=1e-6)
    assert np.array_equal(shown.value, below.value, equal_nan=True)
    assert [label["name"] for label in shown.report["labels"]] == [look.name for look in looks.values()]


def test_names_of_labels_make_a_legend():
    picture = ws.slice(ws.Scene(scan(), labels=ws.Labels(numbers(), LOOKS)), size=(200, 200))
    assert not np.array_equal(picture.annotated(legend=True).rgba, picture.rgba)


def test_a_segmentation_of_another_scan_is_refused():
    other = ws.Labels(np.ones((4, 4, 4), np.uint8))
    with pytest.raises(ArgumentError, match=r"the segmentation is \(4, 4, 4\) \(z, y, x\), the scan \(9, 20, 24\)"):
        ws.slice(ws.Scene(scan(), labels=other))


def test_a_legend_names_the_labels_of_the_slice():
    scene = ws.Scene(scan(), labels=ws.Labels(numbers(), LOOKS))

    def names(y_index):
        place = (AFFINE @ (0, y_index, 0, 1))[0]
        return [label["name"] for label in ws.slice(scene, "sagittal", place).report["labels"]]

    assert names(5) == ["liver"]
    assert names(9) == ["liver", "spleen"]
    assert names(16) == ["spleen"]
    assert names(1) == []


def blocks():
    found = np.zeros((24, 24, 24), np.uint8)
    for number, corner in {1: (2, 2, 2), 2: (2, 2, 13), 3: (2, 13, 2), 7: (13, 13, 13)}.items():
        z, y, x = corner
        found[z : z + 9, y : y + 9, x : x + 9] = number
    return found


def in_colours(picture):
    return bool(np.ptp(picture.rgba[..., :3], axis=-1).max() > 0.1)


@pytest.mark.parametrize("dtype", [np.float32, np.float64, np.int64, np.uint64])
def test_a_label_map_of_any_type_gives_the_picture_and_the_slice_of_its_bytes(dtype):
    small, wide = (ws.Volume(blocks().astype(one), spacing=(1, 1, 2), unit="mm") for one in (np.uint8, dtype))
    assert np.array_equal(np.asarray(ws.render(small, size=(40, 40))), np.asarray(ws.render(wide, size=(40, 40))))
    cut = ws.slice(wide, "xy", 8.0)
    assert np.array_equal(cut.rgba, ws.slice(small, "xy", 8.0).rgba)
    looks = ws.Labels(blocks()).labels
    expected = np.array([looks[number].color if number else (0, 0, 0) for number in blocks()[4].ravel()])
    np.testing.assert_allclose(cut.rgba[..., :3].reshape(-1, 3), expected, atol=1e-6)
    assert {one["name"] for one in cut.report["labels"]} == {"1", "2", "3"}


def test_whole_numbers_that_are_no_labels_stay_grey():
    random = np.random.default_rng(1)
    counts = random.poisson(0.5, (24, 24, 24)).astype(np.float32)
    hounsfield = np.rint(np.where(blocks() > 0, 40, -1000) + random.normal(0, 8, (24, 24, 24)))
    fraction = np.repeat(blocks().astype(np.float32), 3, axis=2)
    fraction[4, 4, 7] += 0.25  # between the samples that are looked at first
    measured = ws.Volume(blocks().astype(np.float32), facts=ws.Facts(unit="m", value_unit="kg/m3"))
    for volume in (measured, *(ws.Volume(samples) for samples in (counts, hounsfield, fraction))):
        assert not in_colours(ws.slice(volume))
        assert ws.Look.auto(volume).labels is None


def test_a_mask_is_in_colour_where_its_file_names_it(tmp_path):
    mask = (blocks() > 0).astype(np.uint8)
    assert not in_colours(ws.slice(ws.Volume(mask)))
    image = nibabel.Nifti1Image(mask.T, np.eye(4))
    table = b'<CaretExtension><LabelTable><Label Key="1" Red="1" Green="0" Blue="0">liver</Label></LabelTable>'
    image.header.extensions.append(nibabel.nifti1.Nifti1Extension(30, table + b"</CaretExtension>"))
    nibabel.save(image, tmp_path / "mask.nii")
    cut = ws.slice(ws.open(tmp_path / "mask.nii"), "axial", 5)
    assert [one["name"] for one in cut.report["labels"]] == ["liver"]
    assert cut.rgba[..., 0].max() == 1
    assert cut.rgba[..., 1:3].max() == 0


@pytest.mark.parametrize("name", ["a.nii.gz", "a.nrrd", "a.mha", "a.ome.tif", "a.ome.zarr"])
def test_info_lists_the_labels_of_any_file(tmp_path, wavesplat, name):
    dtype = np.float32 if name == "a.nii.gz" else np.int64 if name == "a.ome.zarr" else np.uint16
    unit = "um" if name in ("a.ome.tif", "a.ome.zarr") else "mm"
    if name == "a.mha":
        image = SimpleITK.GetImageFromArray(blocks())
        image.SetSpacing((1, 1, 2))
        SimpleITK.WriteImage(image, str(tmp_path / name))
    else:
        ws.Volume(blocks().astype(dtype), spacing=(1, 1, 2), unit=unit).save(tmp_path / name)
    answer = wavesplat("info", tmp_path / name, "--json")
    assert answer.returncode == 0, answer.stderr
    labels = json.loads(answer.stdout)["labels"]
    looks = ws.Labels(blocks()).labels
    ml = 9**3 * 2 * (1e-12 if unit == "um" else 1e-3)
    assert [(one["number"], one["name"], one["n_voxels"]) for one in labels] == [(n, str(n), 729) for n in (1, 2, 3, 7)]
    assert [tuple(one["color"]) for one in labels] == [looks[number].color for number in (1, 2, 3, 7)]
    np.testing.assert_allclose([one["volume_ml"] for one in labels], ml)
