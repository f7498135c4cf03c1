"""Structure sets of radiotherapy (RTSTRUCT): regions of closed lines as labels, beside scikit-image's polygons."""

from __future__ import annotations

import json

import numpy as np
import pytest
from dicom_files import save, slice_at, structure_set
from skimage.draw import polygon2mask

import wavesplat as ws
from wavesplat.errors import ArgumentError, FileError, FileWarning

N_SLICES, ROWS, COLUMNS = 8, 40, 48
#: LPS from (column, row, slice), as `slice_at` places them.
PLACE, STEPS = np.array([10.0, 20.0, 30.0]), np.array([0.7, 0.8, 1.5])


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    pixels = np.random.default_rng(1).integers(-100, 100, (N_SLICES, ROWS, COLUMNS)).astype(np.int16)
    return save(tmp_path_factory.mktemp("rt") / "ct", [slice_at(pixels[n], n) for n in range(N_SLICES)])


@pytest.fixture(scope="module")
def scan(folder):
    return ws.open(folder)


def wavy(center, radius, seed):
    """A closed line of points (column, row): a circle with bays."""
    random = np.random.default_rng(seed)
    angles = np.linspace(0, 2 * np.pi, 37)[:-1]
    lengths = radius * (1 + 0.3 * np.sin(3 * angles + random.uniform(0, 6)) + 0.05 * random.normal(size=36))
    return np.array(center) + lengths[:, None] * np.array([np.cos(angles), np.sin(angles)]).T


def at(line, k):
    """Points (column, row) of a slice in the patient, LPS."""
    return PLACE + np.column_stack([line, np.full(len(line), k)]) * STEPS


#: Lines (column, row) of each slice: an organ with a hole that has an island, and a tumour in the organ.
ORGAN = {k: [wavy((24, 20), 15, k), wavy((24, 20), 8, 20 + k), wavy((24, 20), 3, 40 + k)] for k in range(1, 7)}
TUMOUR = {k: [wavy((36, 20), 3.5, 60 + k)] for k in (3, 4)}
BODY = {k: [np.array([(1.5, 1.5), (46.5, 1.5), (46.5, 38.5), (1.5, 38.5)])] for k in range(N_SLICES)}


def regions():
    def lines(planes):
        return [at(line, k) for k, listed in planes.items() for line in listed]

    return [
        ("BODY", (0, 255, 0), "EXTERNAL", lines(BODY)),
        ("PTV tumour", (255, 0, 0), "PTV", lines(TUMOUR)),
        ("organ", None, "ORGAN", lines(ORGAN)),
        ("isocentre", (0, 0, 255), "ISOCENTER", [("POINT", [PLACE + 3])]),
    ]


def expected(planes):
    """Voxels by scikit-image: lines of a slice laid over each other, those in two of them left out."""
    mask = np.zeros((N_SLICES, ROWS, COLUMNS), bool)
    for k, listed in planes.items():
        for line in listed:
            mask[k] ^= polygon2mask((ROWS, COLUMNS), np.round(line, 6)[:, ::-1])
    return mask


@pytest.fixture(scope="module")
def file(folder):
    return save(folder.parent / "rt", [structure_set(regions())]) / "000.dcm"


def shown(labels, number):
    return np.array(labels.numbers)[labels._codes] == number


def opened(file, scan, *names):
    return ws.Labels.open(file, scan=scan, segments=list(names))


@pytest.mark.parametrize(("name", "number", "planes"), [("BODY", 1, BODY), ("PTV*", 2, TUMOUR), (3, 3, ORGAN)])
def test_voxels_are_those_of_scikit_image(file, scan, name, number, planes):
    labels = opened(file, scan, name)
    assert list(labels.labels) == [number]
    assert expected(planes).sum() > 50
    np.testing.assert_array_equal(shown(labels, number), expected(planes))
    assert labels.shape == scan.shape
    assert labels.on_samples_of(scan) is labels


def test_the_smallest_of_overlapping_regions_is_shown(file, scan):
    with pytest.warns(FileWarning) as warned:
        labels = ws.Labels.open(file, scan=scan)
    told = " ".join(str(one.message) for one in warned)
    n_hidden = (expected(ORGAN) & expected(TUMOUR)).sum()
    assert n_hidden > 20
    assert f"the smallest is shown: hidden are {n_hidden} of {expected(ORGAN).sum()} voxels of 'organ'" in told
    assert "outline of the patient is left out, since all else lies in it: BODY" in told
    assert "without closed lines: isocentre" in told
    np.testing.assert_array_equal(shown(labels, 2), expected(TUMOUR))
    np.testing.assert_array_equal(shown(labels, 3), expected(ORGAN) & ~expected(TUMOUR))
    assert {number: look.name for number, look in labels.labels.items()} == {2: "PTV tumour", 3: "organ"}
    assert labels.labels[2].color == (1.0, 0.0, 0.0)


@pytest.mark.parametrize(("axes", "flips"), [((2, 1, 0), ()), ((1, 0, 2), (0,)), ((0, 2, 1), (1, 2))])
def test_scans_with_exchanged_and_flipped_axes(file, scan, axes, flips):
    """Regions lie where they are in the patient, however the samples are stored."""
    samples, matrix = scan.samples.transpose(axes), scan.world_from_index.copy()
    matrix[:, :3] = matrix[:, [2 - axes[2], 2 - axes[1], 2 - axes[0]]]
    mask = expected(ORGAN).transpose(axes)
    for axis in flips:
        samples, mask = np.flip(samples, axis), np.flip(mask, axis)
        matrix[:, 3] += matrix[:, 2 - axis] * (samples.shape[axis] - 1)
        matrix[:, 2 - axis] *= -1
    turned = ws.Volume(samples, world_from_index=matrix, unit="mm", anatomical=True)
    found = shown(opened(file, turned, "organ"), 3)
    # Centres on a line lie in the region on two of its sides, which are others now.
    assert (found ^ mask).sum() <= 2
    assert found.sum() > 1000


@pytest.mark.parametrize("finer", [2, 3])
def test_finer_slices_show_the_nearest_plane(file, scan, finer):
    """A scan with more slices than planes of lines has no empty slices between them."""
    matrix = scan.world_from_index.copy()
    matrix[:3, 2] /= finer
    samples = np.repeat(scan.samples, finer, axis=0)
    labels = opened(file, ws.Volume(samples, world_from_index=matrix, unit="mm", anatomical=True), "organ")
    wanted = np.zeros(samples.shape, bool)
    for k in ORGAN:
        begin = k * finer - (finer - 1) // 2  # of two planes at the same distance the lower one
        wanted[begin : begin + finer] = expected(ORGAN)[k]
    np.testing.assert_array_equal(shown(labels, 3), wanted)


def test_lines_in_metres(file, scan):
    """A scan whose world is in another unit than millimetres."""
    matrix = scan.world_from_index.copy()
    matrix[:3] /= 1000
    metres = ws.Volume(scan.samples, world_from_index=matrix, unit="m", anatomical=True)
    np.testing.assert_array_equal(shown(opened(file, metres, "organ"), 3), expected(ORGAN))


def test_what_cannot_be_filled_is_refused(file, scan, folder):
    with pytest.raises(ArgumentError, match="give the scan"):
        ws.Labels.open(file)
    with pytest.raises(ArgumentError, match="says nothing of a patient"):
        opened(file, ws.Volume(scan.samples), "organ")
    with pytest.raises(ArgumentError, match="no segment 'liver'; there are: 1 'BODY', 2 'PTV tumour', 3 'organ'"):
        opened(file, scan, "liver")
    with pytest.raises(FileError, match="no closed lines"), pytest.warns(FileWarning, match="without closed lines"):
        opened(file, scan, "isocentre")
    matrix = scan.world_from_index.copy()
    matrix[0, 3] += 1000
    far = ws.Volume(scan.samples, world_from_index=matrix, unit="mm", anatomical=True)
    with pytest.raises(FileError, match="no region of the structure set"):
        opened(file, far, "organ")
    turned = np.eye(4)
    turned[:3, :3] = [[0.8, 0, -0.6], [0, 1, 0], [0.6, 0, 0.8]]
    oblique = ws.Volume(scan.samples, world_from_index=turned @ scan.world_from_index, unit="mm", anatomical=True)
    with pytest.raises(FileError, match="no region of the structure set"):
        opened(file, oblique, "organ")
    broken = structure_set([("a", None, "", [at(ORGAN[1][0], 1)])])
    broken.ROIContourSequence[0].ContourSequence[0].ContourData = ["1", "2", "3", "4"]
    with pytest.raises(FileError, match="a contour has 4 numbers"):
        opened(save(folder.parent / "broken", [broken]) / "000.dcm", scan, "a")


def test_regions_over_their_scan(file, folder, tmp_path, wavesplat):
    """A structure set beside its scan makes a legend of its regions, in space and on slices."""
    for command in ("render", "slice"):
        options = ["--labels", file, "--legend", "--size", "200x200", "-o", tmp_path / f"{command}.png"]
        done = wavesplat(command, folder, *options)
        assert done.returncode == 0, done.stderr
        assert "note: regions overlap" in done.stderr
    picked = wavesplat("slice", folder, "--labels", file, "--segment", "ptv*", "--json", "-o", tmp_path / "a.png")
    assert '"PTV tumour"' in picked.stdout
    assert '"organ"' not in picked.stdout


def test_info_lists_the_regions(file, wavesplat):
    told = json.loads(wavesplat("info", file, "--json").stdout)
    assert [(one["number"], one["name"], one["n_lines"]) for one in told["regions"]] == [
        (1, "BODY", N_SLICES), (2, "PTV tumour", 2), (3, "organ", 18), (4, "isocentre", 0)
    ]  # fmt: skip
    lower, upper = told["regions"][0]["bounds_xyz"]
    np.testing.assert_allclose(sorted([lower[2], upper[2]]), [30, 30 + 1.5 * (N_SLICES - 1)], atol=1e-3)
    listed = wavesplat("info", file).stdout
    assert "region 2     PTV tumour, #ff0000, PTV, 2 lines, (" in listed
    assert "region 4     isocentre, #0000ff, ISOCENTER, no closed lines" in listed
