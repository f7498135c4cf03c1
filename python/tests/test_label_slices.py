"""Slices with a segmentation over them."""

import numpy as np
import pytest

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
def test_every_pixel_has_the_colour_of_the_sample_next_to_it(plane, looks, monkeypatch):
    monkeypatch.setattr("wavesplat._scene.label_slices.PIXELS_AT_ONCE", 300)
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
