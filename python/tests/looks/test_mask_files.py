"""Masks in a file each, named after what they show."""

import numpy as np
import pytest

import wavesplat as ws
from wavesplat.errors import ArgumentError, FileError

SHAPE = (10, 12, 14)
MATRIX = np.array([[-2.0, 0, 0, 30], [0, 2.0, 0, -10], [0, 0, 3.0, 7], [0, 0, 0, 1]])
BOXES = {
    "liver": np.s_[2:6, 2:6, 2:6],
    "vertebra_L10": np.s_[6:9, 6:9, 6:9],
    "vertebra_L2": np.s_[6:9, 9:11, 6:9],
    "spleen": np.s_[4:8, 5:8, 5:9],
}


def mask_of(box):
    mask = np.zeros(SHAPE, np.uint8)
    mask[box] = 1
    return mask


def written(folder, name, samples, matrix=MATRIX):
    volume = ws.Volume(np.ascontiguousarray(samples), world_from_index=matrix, unit="mm", anatomical=True)
    folder.mkdir(exist_ok=True)
    volume.save(folder / f"{name}.nii.gz")


@pytest.fixture
def folder(tmp_path):
    for name, box in BOXES.items():
        written(tmp_path / "organs", name, mask_of(box))
    return tmp_path / "organs"


@pytest.fixture
def scan():
    samples = np.indices(SHAPE).sum(axis=0).astype(np.float32)
    return ws.Volume(samples, world_from_index=MATRIX, unit="mm", anatomical=True, name="scan")


def test_masks_are_labels_with_the_names_of_their_files(folder, scan):
    labels = ws.Labels.open(folder / "*.nii.gz")
    names = ["liver", "spleen", "vertebra_L2", "vertebra_L10"]
    assert [label.name for label in labels.labels.values()] == names
    assert len({label.color for label in labels.labels.values()}) == 4
    expected = np.zeros(SHAPE, int)
    for number, name in enumerate(names, 1):
        expected[BOXES[name]] = number
    on_scan = labels.on_samples_of(scan)
    assert np.array_equal(np.array(on_scan.numbers)[on_scan._codes], expected)
    twice = sum(int(mask_of(BOXES[name])[mask_of(BOXES["spleen"]) > 0].sum()) for name in ("liver", "vertebra_L10"))
    assert labels.notes == [f"labels overlap in {twice} samples, where the later file counts: spleen, vertebra_L10"]
    assert labels.notes[0] in ws.slice(ws.Scene(scan, labels=labels)).report["notes"]


def test_masks_on_other_axes_lie_in_their_place(folder, scan):
    flipped = MATRIX.copy()
    flipped[:3, 3] += MATRIX[:3, 0] * (SHAPE[2] - 1)
    flipped[:3, 0] *= -1
    before = ws.Labels.open(folder / "*.nii.gz")
    written(folder, "spleen", mask_of(BOXES["spleen"])[:, :, ::-1], flipped)
    after = ws.Labels.open(folder / "*.nii.gz")
    assert np.array_equal(before._codes, after._codes)


def test_empty_and_covered_masks_are_told(folder):
    written(folder, "adrenal", np.zeros(SHAPE, np.uint8))
    written(folder, "a_cyst", mask_of(np.s_[3:5, 3:5, 3:5]))
    labels = ws.Labels.open(folder / "*.nii.gz")
    assert "labels without a sample: adrenal" in labels.notes
    assert "labels that later ones cover whole: a_cyst" in labels.notes
    assert {"adrenal", "a_cyst"}.isdisjoint(label.name for label in labels.labels.values())


def test_a_mask_may_have_another_number(folder):
    written(folder, "liver", 255 * mask_of(BOXES["liver"]))
    assert "liver" in [label.name for label in ws.Labels.open(folder / "*.nii.gz").labels.values()]


def test_what_are_no_masks(folder):
    (folder / "table.tsv").write_text("index\tname\n1\tliver\n")
    with pytest.raises(ArgumentError, match="masks have the names of their files; leave out the table"):
        ws.Labels.open(folder / "*.nii.gz", table=folder / "table.tsv")
    with pytest.raises(FileError, match="no file matches"):
        ws.Labels.open(folder / "*.nrrd")
    written(folder, "two", mask_of(BOXES["liver"]) + 2 * mask_of(BOXES["vertebra_L2"]))
    with pytest.raises(ArgumentError, match=r"more than one number beside 0.*two\.nii\.gz"):
        ws.Labels.open(folder / "*.nii.gz")
    # One file is a segmentation as any other.
    assert len(ws.Labels.open(folder / "tw*.nii.gz").labels) == 2
    far = MATRIX.copy()
    far[2, 3] += 1000
    written(folder, "two", mask_of(BOXES["liver"]), far)
    with pytest.raises(ArgumentError, match=r"does not touch.*two\.nii\.gz"):
        ws.Labels.open(folder / "*.nii.gz")


def test_the_command_takes_a_pattern(folder, scan, tmp_path, wavesplat):
    scan.save(tmp_path / "ct.nii.gz")
    done = wavesplat(
        *(
            "render",
            "--size",
            "60x50",
            tmp_path / "ct.nii.gz",
            "--labels",
            folder / "*.nii.gz",
            "--legend",
            "-o",
            tmp_path / "x.png",
        )
    )
    assert done.returncode == 0, done.stderr
    assert "note: labels overlap in" in done.stderr
