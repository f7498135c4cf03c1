"""Segmentations on other grids than the scan's: they lie where their affines say."""

from itertools import permutations, product

import numpy as np
import pytest
from dicom_files import save, slice_at

import wavesplat as ws
from wavesplat.errors import ArgumentError

SIZE = {"size": (60, 50)}
SCAN_FROM_INDEX = np.array([[-1.5, 0, 0, 30], [0, 2.0, 0, -10], [0, 0, 2.5, 7], [0, 0, 0, 1]])
SHAPE = (14, 16, 18)
LOOKS = {3: ws.Label("#ff2020", 0.7, name="liver"), 9: ws.Label("#2040ff", 0.9, name="spleen")}
CLEAR = ws.TransferFunction([(0, 0), (60, 0.3)], [(0, 0, 0, 0), (60, 1, 1, 1)])


@pytest.fixture(scope="module")
def scan():
    z, y, x = np.indices(SHAPE)
    return ws.Volume((x + y + z).astype(np.float32), world_from_index=SCAN_FROM_INDEX, unit="mm", name="scan")


def numbers():
    """Labels without symmetry, none at the faces."""
    found = np.zeros(SHAPE, np.uint8)
    found[3:9, 2:9, 4:11] = 3
    found[5:12, 9:14, 8:16] = 9
    found[3:5, 10:12, 3:5] = 3
    return found


def volume(samples, matrix, **facts):
    return ws.Volume(np.ascontiguousarray(samples), world_from_index=matrix, **{"unit": "mm", **facts})


def labels_of(samples, matrix, **facts):
    return ws.Labels(volume(samples, matrix, **facts), LOOKS)


def turned(samples, matrix, order, flips):
    """Samples with index axes in another order, some of them flipped, and the affine that leaves them where they are.

    order, flips : of x, y, z.
    """
    matrix = matrix.copy()
    samples = samples.transpose([2 - axis for axis in reversed(order)])
    matrix[:, :3] = matrix[:, list(order)]
    for axis in (axis for axis, flip in enumerate(flips) if flip):
        samples = np.flip(samples, 2 - axis)
        matrix[:3, 3] += matrix[:3, axis] * (samples.shape[2 - axis] - 1)
        matrix[:3, axis] *= -1
    return samples, matrix


def pictures(scan, labels):
    """Bytes of a picture in space and of two slices, one oblique, and the notes of each."""
    scene = ws.Scene(ws.Layer(scan, CLEAR), labels=labels)
    plane = ((8, 6, 22), (1, 2, 3))
    made = [ws.render(scene, **SIZE), ws.slice(scene, "coronal", **SIZE), ws.slice(scene, plane, **SIZE)]
    notes = [
        note
        for picture in made
        for note in picture.report.get("notes", [])
        if "label" in note or "segmentation" in note
    ]
    return [picture.rgba.tobytes() for picture in made], notes


@pytest.mark.parametrize("order", list(permutations(range(3))))
@pytest.mark.parametrize("flips", list(product((False, True), repeat=3)))
def test_codes_in_any_order_of_axes_are_the_same_fault_3(scan, order, flips):
    labels = labels_of(*turned(numbers(), SCAN_FROM_INDEX, order, flips)).on_samples_of(scan)
    assert np.array_equal(np.array(labels.numbers)[labels._codes], numbers())
    assert labels.notes == []


@pytest.mark.parametrize(("order", "flips"), [((0, 1, 2), (True, True, False)), ((2, 1, 0), (True, False, True))])
def test_labels_with_flipped_and_exchanged_axes_draw_the_same_bytes_fault_3(scan, order, flips):
    expected, notes = pictures(scan, labels_of(numbers(), SCAN_FROM_INDEX))
    plain, _ = pictures(scan, None)
    assert all(one != other for one, other in zip(expected, plain, strict=True))
    found, more = pictures(scan, labels_of(*turned(numbers(), SCAN_FROM_INDEX, order, flips)))
    assert found == expected
    assert notes == more == []


@pytest.mark.parametrize("reaches_beyond", [False, True])
def test_a_crop_draws_the_bytes_of_the_crop_padded_to_the_scan(scan, reaches_beyond):
    part = (slice(4, 10), slice(0, 11), slice(6, 18))
    padded = np.zeros(SHAPE, np.uint8)
    padded[part] = numbers()[part]
    first = np.array([part[2].start, part[1].start, part[0].start])
    samples = numbers()[part]
    if reaches_beyond:
        samples = np.pad(samples, ((0, 0), (3, 0), (0, 5)), constant_values=9)
        first = first - (0, 3, 0)
    matrix = SCAN_FROM_INDEX.copy()
    matrix[:3, 3] += matrix[:3, :3] @ first
    found, notes = pictures(scan, labels_of(samples, matrix))
    assert found == pictures(scan, labels_of(padded, SCAN_FROM_INDEX))[0]
    share = 100 * (1 - np.count_nonzero(padded) / np.count_nonzero(samples))
    told = [f"{share:.2g} % of the labelled samples lie outside of the scan"]
    assert notes == (3 * told if reaches_beyond else [])


def test_a_crop_without_a_background_gets_one(scan):
    matrix = SCAN_FROM_INDEX.copy()
    matrix[:3, 3] += matrix[:3, :3] @ (4, 2, 3)
    labels = ws.Labels(volume(np.full((2, 3, 4), 3, np.uint8), matrix))
    on_scan = labels.on_samples_of(scan)
    expected = np.zeros(SHAPE, np.uint8)
    expected[3:5, 2:5, 4:8] = 3
    assert np.array_equal(np.array(on_scan.numbers)[on_scan._codes], expected)
    assert set(labels.labels) == {3}


def finer_by_two(samples):
    matrix = SCAN_FROM_INDEX.copy()
    matrix[:3, :3] /= 2
    matrix[:3, 3] -= matrix[:3, :3] @ (0.5, 0.5, 0.5)
    return samples.repeat(2, 0).repeat(2, 1).repeat(2, 2), matrix


def test_a_segmentation_twice_as_fine_is_resampled_with_a_note(scan):
    labels = labels_of(*finer_by_two(numbers()))
    on_scan = labels.on_samples_of(scan)
    assert np.array_equal(np.array(on_scan.numbers)[on_scan._codes], numbers())
    (in_space, *_), notes = pictures(scan, labels)
    (expected, *_), _ = pictures(scan, labels_of(numbers(), SCAN_FROM_INDEX))
    assert in_space == expected
    assert notes[0] == (
        "labels resampled by nearest neighbour from their samples, 0.75 x 1 x 1.25, to the scan's, 1.5 x 2 x 2.5"
    )
    assert "finer than the scan's" in notes[1]


def test_slices_show_what_only_the_finer_grid_has(scan):
    samples, matrix = finer_by_two(np.zeros(SHAPE, np.uint8))
    samples[13, 15, :] = 3  # a line half as thick as a sample of the scan
    looks = {3: ws.Label("#ff0000", 1.0)}
    _, y, z = matrix[:3, :3] @ (18, 15, 13) + matrix[:3, 3]
    scene = ws.Scene(scan, labels=ws.Labels(volume(samples, matrix), looks))
    picture = ws.slice(scene, "coronal", y, size=(171, 131))
    column = int((picture.rgba[:, 85, 0] - picture.rgba[:, 85, 1] > 0.3).sum())
    assert column * picture.report["pixel"] == pytest.approx(1.25, abs=0.5)
    row = int(np.argmax(picture.rgba[:, 85, 0] - picture.rgba[:, 85, 1]))
    place = picture.report["origin"][2] + row * picture.report["pixel"] * picture.report["down"][2]
    assert place == pytest.approx(z, abs=0.8)


@pytest.mark.parametrize("tilt", [0.0, 0.3])
def test_other_grids_are_looked_up_at_the_nearest_sample(scan, tilt, monkeypatch):
    monkeypatch.setattr("wavesplat._looks.labels.label_grids.SAMPLES_AT_ONCE", 50)
    rng = np.random.default_rng(5)
    samples = rng.integers(0, 5, (9, 7, 8)).astype(np.uint8)
    c, s = np.cos(tilt), np.sin(tilt)
    turn = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]]) @ np.diag([2.9, 4.1, 3.7])
    matrix = np.eye(4)
    matrix[:3, :3], matrix[:3, 3] = turn, (2, -8, 9)
    on_scan = ws.Labels(volume(samples, matrix)).on_samples_of(scan)
    n_inside = 0
    for k, j, i in product(*map(range, SHAPE)):
        place = SCAN_FROM_INDEX[:3, :3] @ (i, j, k) + SCAN_FROM_INDEX[:3, 3]
        x, y, z = np.floor(np.linalg.solve(turn, place - matrix[:3, 3]) + 0.5).astype(int)
        inside = 0 <= x < 8 and 0 <= y < 7 and 0 <= z < 9
        n_inside += inside
        assert on_scan.numbers[on_scan._codes[k, j, i]] == (samples[z, y, x] if inside else 0)
    assert 0 < n_inside < np.prod(SHAPE)
    assert "resampled by nearest neighbour" in on_scan.notes[0]


def test_rounded_affines_are_the_same_grid(scan):
    matrix = np.array(SCAN_FROM_INDEX)
    matrix[:3, :3] *= 1 + 1e-4
    matrix[:3, 3] += 0.01
    on_scan = labels_of(numbers(), matrix).on_samples_of(scan)
    assert on_scan.notes == []
    assert np.array_equal(np.array(on_scan.numbers)[on_scan._codes], numbers())


def test_only_a_box_that_does_not_touch_is_refused(scan):
    matrix = SCAN_FROM_INDEX.copy()
    matrix[2, 3] += 2.5 * 14
    assert "none of the labels lies in the scan" in labels_of(numbers(), matrix).on_samples_of(scan).notes[0]
    matrix[2, 3] += 2.5
    boxes = r"\(4.5, -10, 44.5\) to \(30, 20, 77\), does not touch the scan 'scan', \(4.5, -10, 7\) to \(30, 20, 39.5\)"
    with pytest.raises(ArgumentError, match=boxes):
        ws.render(ws.Scene(scan, labels=labels_of(numbers(), matrix)), **SIZE)
    with pytest.raises(ArgumentError, match=boxes):
        ws.slice(ws.Scene(scan, labels=labels_of(numbers(), matrix)))
    with pytest.raises(ArgumentError, match="are in um, the scan 'scan' is in mm"):
        labels_of(numbers(), SCAN_FROM_INDEX, unit="um").on_samples_of(scan)


def test_a_segmentation_that_says_nothing_of_its_place_lies_on_the_scan(scan):
    bare = ws.Labels(ws.Volume(numbers()), LOOKS)  # as from a .npy file
    found, notes = pictures(scan, bare)
    assert found == pictures(scan, ws.Labels(numbers(), LOOKS))[0]
    assert all(note.startswith("guess: the segmentation says nothing of its place") for note in notes)
    assert len(notes) == 3
    with pytest.raises(
        ArgumentError, match=r"is \(13, 16, 18\) \(z, y, x\), the scan \(14, 16, 18\), and nothing says"
    ):
        ws.render(scan, labels=ws.Labels(numbers()[1:]))


def test_other_looks_keep_what_was_resampled(scan):
    labels = labels_of(*finer_by_two(numbers()))
    first = labels.on_samples_of(scan)
    other = labels.with_looks({3: ws.Label("white")}).on_samples_of(scan)
    assert other._codes is first._codes
    assert other.labels[3].color == (1, 1, 1)


def test_boxes_are_cut_out_of_resampled_labels(scan):
    samples, matrix = turned(numbers(), SCAN_FROM_INDEX, (1, 0, 2), (True, False, False))
    box = ws.CutOut(ws.Crop((4, 2, 3), (12, 9, 9), space="index"))
    made = [
        ws.render(ws.Scene(ws.Layer(scan, CLEAR), labels=labels, clip=box), **SIZE).rgba
        for labels in (labels_of(numbers(), SCAN_FROM_INDEX), labels_of(samples, matrix))
    ]
    assert np.array_equal(*made)


def test_labels_lie_on_the_level_that_is_drawn():
    samples = np.full((32, 32, 32), 50.0, np.float32)
    half = samples[::2, ::2, ::2]
    codes = np.zeros((32, 32, 32), np.uint8)
    codes[20:30, 8:24, 16:26] = 1
    red = {1: ws.Label("red", 0.9)}
    lazy = ws.Volume.lazy([samples, half], world_from_index=np.eye(4), unit="mm")
    nothing = ws.TransferFunction([(0, 0)], [(0, 1, 1, 1)], opacity_unit=1.0)
    for labels in (ws.Labels(codes, red), ws.Labels(volume(codes, np.eye(4)), red)):
        made = [
            ws.render(
                ws.Scene(ws.Layer(one, nothing), labels=labels), camera=ws.Camera.view(lazy, "front"), size=(8, 8)
            )
            for one in (lazy.at_level(1), lazy.at_level(0))
        ]
        assert [picture.report["lazy"]["levels"] for picture in made] == [[1], [0]]
        assert made[1].rgba[..., 3].max() > 0.9
        assert np.abs(made[0].rgba - made[1].rgba).mean() < 0.03


@pytest.mark.parametrize("composite", ["over", "maximum"])
def test_labels_of_a_part_need_no_more_than_the_level_that_is_drawn(composite):
    samples = np.random.default_rng(3).random((32, 32, 32), np.float32)
    lazy = ws.Volume.lazy([samples, samples[::2, ::2, ::2]], world_from_index=np.eye(4), unit="mm")
    matrix = np.eye(4)
    matrix[:3, 3] = 6, 8, 10
    labels = ws.Labels(volume(np.ones((8, 9, 10), np.uint8), matrix), {1: ws.Label("red", 0.9)})
    layers = [ws.Layer(lazy.at_level(1), CLEAR), ws.Layer(lazy.at_level(1), CLEAR)]
    for count in (1, 2):
        picture = ws.render(ws.Scene(layers[:count], labels=labels), composite=composite, size=(20, 20))
        assert (picture.rgba[..., 0] - picture.rgba[..., 1]).max() > 0.3
        assert {shape for shape, _ in labels._codes_on_scans} == {(16, 16, 16)}
        assert "labels resampled by nearest neighbour" in " ".join(picture.report["notes"])


def test_a_dicom_scan_takes_its_nifti_segmentation_fault_3(tmp_path):
    """A DICOM series has its axes along L, P, S, the segmentation that TotalSegmentator makes of it along L, A, S."""
    import nibabel
    from typer.testing import CliRunner

    from wavesplat._cli import app

    rng = np.random.default_rng(2)
    pixels = rng.integers(0, 900, (10, 12, 14)).astype(np.int16)
    save(tmp_path / "ct", [slice_at(one, number) for number, one in enumerate(pixels)])
    scan = ws.open(tmp_path / "ct")
    found = np.zeros(scan.shape, np.uint8)
    found[2:7, 1:5, 3:9] = 1
    samples, matrix = turned(found, scan.world_from_index, (0, 1, 2), (False, True, False))
    assert (scan.orientation, volume(samples, matrix).orientation) == ("LPS", "LAS")

    def written(samples, matrix, name):
        nibabel.save(nibabel.Nifti1Image(np.transpose(samples, (2, 1, 0)), matrix), tmp_path / name)
        return str(tmp_path / name)

    names = [written(found, scan.world_from_index, "lps.nii"), written(samples, matrix, "las.nii")]
    for command in ("render", "slice"):
        made = []
        for number, name in enumerate(names):
            output = tmp_path / f"{command}{number}.png"
            arguments = [command, str(tmp_path / "ct"), "--labels", name, "--size", "40x40", "-o", str(output)]
            result = CliRunner().invoke(app, arguments)
            assert result.exit_code == 0, result.output
            made.append(_pixels(output))
        assert np.array_equal(*made)


def _pixels(path):
    from PIL import Image

    return np.asarray(Image.open(path))
