"""Lines over slices: regions, outlines of labels, and lines of equal value."""

from __future__ import annotations

import numpy as np
import pytest
from dicom_files import base, save, slice_at, structure_set

import wavesplat as ws
from wavesplat._cli.options.slices import isolines_of
from wavesplat.errors import ArgumentError, FileError, FileWarning

#: Slices, rows, columns, and distances along x, y, z.
SHAPE, SPACING = (9, 40, 48), (1.0, 1.5, 3.0)
CENTER = np.array([23.0, 30.0, 12.0])
SIZE = (240, 200)


def volume(samples, name="scan.nii", modality=None):
    facts = ws.Facts(unit="mm", is_anatomical=True, modality=modality)
    return ws.Volume(samples, world_from_index=np.diag([*SPACING, 1.0]), name=name, facts=facts)


@pytest.fixture(scope="module")
def scan():
    return volume(np.zeros(SHAPE, np.int16))


def away():
    """Distance of each sample from the centre, world units."""
    z, y, x = np.indices(SHAPE)
    return np.linalg.norm(np.stack([x, y, z], axis=-1) * SPACING - CENTER, axis=-1)


def circle(radius, z, n=72):
    angles = np.linspace(0, 2 * np.pi, n, endpoint=False)
    return CENTER + np.column_stack([radius * np.cos(angles), radius * np.sin(angles), np.full(n, z - CENTER[2])])


def world_of(picture):
    """World position of each pixel."""
    report = picture.report
    height, width = picture.rgba.shape[:2]
    rows, columns = np.mgrid[:height, :width]
    right, down = (np.array(report[name]) * report["pixel"] for name in ("right", "down"))
    return np.array(report["origin"]) + columns[..., None] * right + rows[..., None] * down


def widened(mask, n):
    """The pixels of a mask and those up to n beside them."""
    height, width = mask.shape
    padded = np.pad(mask, n)
    shifts = [(i, j) for i in range(2 * n + 1) for j in range(2 * n + 1)]
    return np.any([padded[i : i + height, j : j + width] for i, j in shifts], axis=0)


def check_line(picture, distance, off=0.0):
    """Red is along the whole line, and nowhere else. `distance`: to it, in pixels; `off`: how far it may be beside."""
    red = picture.rgba[..., 0]
    assert widened(red > 0.5, 1)[distance < 0.5].all()
    assert red[distance > 1.25 / 2 + 0.75 + off].max() == 0
    assert red[red > 0].mean() > 0.4
    assert not picture.rgba[..., 1:3].any()


@pytest.mark.parametrize("z", [12, 13.4, 10.6])
def test_lines_of_the_nearest_plane(scan, z):
    """Between planes of lines the nearest one is shown, as it was drawn."""
    region = ws.Region([circle(9, 12), circle(15, 15), circle(4, 9)], "red", name="organ")
    picture = ws.slice(scan, "axial", z, contours=region, size=SIZE)
    distance = np.abs(np.linalg.norm((world_of(picture) - CENTER)[..., :2], axis=-1) - 9) / picture.report["pixel"]
    check_line(picture, distance, off=0.1)  # the circle has corners
    assert picture.report["lines"] == [{"name": "organ", "color": [1.0, 0.0, 0.0]}]
    assert "notes" not in picture.report or "contours" not in str(picture.report["notes"])


@pytest.mark.parametrize("z", [4.4, 19.6])
def test_no_lines_far_from_all_planes(scan, z):
    region = ws.Region([circle(9, 12), circle(15, 15), circle(4, 9)], "red", name="organ")
    picture = ws.slice(scan, "axial", z, contours=[region], size=SIZE)
    assert not picture.rgba[..., 0].any()
    assert picture.report["lines"] == []
    assert "no line of the contours lies in the slice" in picture.report["notes"]


@pytest.mark.parametrize("plane", ["coronal", "sagittal", (tuple(CENTER), (0.3, 0.2, 1))])
def test_outlines_on_other_planes_are_those_of_the_voxels(scan, plane):
    """A ball of circles, one in each slice, cut by planes that none of them lies in."""
    heights = np.arange(1, 8) * 3.0
    region = ws.Region([circle(np.sqrt(14**2 - (z - CENTER[2]) ** 2), z) for z in heights], "red")
    position = {"coronal": CENTER[1], "sagittal": CENTER[0]}.get(plane if isinstance(plane, str) else "")
    picture = ws.slice(scan, plane, position, contours=region, size=SIZE)
    found = picture.rgba[..., 0] > 0.5
    from_center = world_of(picture) - CENTER
    distance = np.linalg.norm(from_center, axis=-1) - 14
    is_between = np.abs(from_center[..., 2]) < 8.9
    # Voxels are 1 x 1.5 x 3 mm, and circles reach half way to the next ones.
    assert np.abs(distance[found & is_between]).max() < 3
    assert found.sum() > 200
    labels = ws.Labels((away() < 14).astype(np.uint8) * (np.arange(9) % 8 > 0)[:, None, None], {1: ws.Label("red")})
    both = ws.slice(scan, plane, position, contours=labels, size=SIZE).rgba[..., 0] > 0.5
    assert (found & ~widened(both, 6)).sum() == 0


def test_labels_on_a_grid_of_their_own(scan):
    """A finer segmentation of a part of the scan: its outline lies half way between voxels inside and outside."""
    _, y, x = np.indices((12, 24, 24))
    inside = ((np.abs(x - 11.5) < 6) & (np.abs(y - 11.5) < 4)).astype(np.uint8)
    matrix = np.diag([0.5, 0.5, 1.0, 1.0])
    matrix[:3, 3] = (10, 20, 6)
    part = ws.Volume(inside, world_from_index=matrix, unit="mm", anatomical=True)
    picture = ws.slice(scan, "axial", 12, contours=ws.Labels(part, {1: ws.Label("red", name="box")}), size=SIZE)
    place = world_of(picture)[..., :2] - (10 + 11.5 / 2, 20 + 11.5 / 2)
    beyond = np.abs(place) - (3, 2)  # six voxels of half a millimetre on each side of the middle, and four
    outside = np.linalg.norm(np.maximum(beyond, 0), axis=-1)
    distance = np.abs(np.where(outside > 0, outside, beyond.max(axis=-1))) / picture.report["pixel"]
    corner = np.abs(beyond).max(axis=-1) < 1  # where interpolation rounds it off
    red = picture.rgba[..., 0]
    assert red[(distance < 0.2) & ~corner].min() > 0.9
    assert red[distance > 2.5].max() == 0


@pytest.mark.parametrize("plane", ["axial", "coronal", (tuple(CENTER), (1, 1, 1))])
def test_isolines_lie_where_the_value_is(scan, plane):
    """The distance from a point: lines of equal value are circles."""
    smooth = volume(away().astype(np.float32), modality="XX", name="distance.nii")
    one = ws.Isolines(smooth, [9], color="red")
    position = None if not isinstance(plane, str) else CENTER[2] if plane == "axial" else CENTER[1]
    picture = ws.slice(scan, plane, position, isolines=one, size=SIZE)
    distance = np.abs(np.linalg.norm(world_of(picture) - CENTER, axis=-1) - 9) / picture.report["pixel"]
    # Between samples that are d apart, interpolated distances are too long by d * d / (8 * 9).
    check_line(picture, distance, off=0.16 / picture.report["pixel"])
    assert picture.report["lines"] == [{"name": "distance 9", "color": [1.0, 0.0, 0.0]}]


def test_isolines_have_colours_units_and_names(scan):
    hounsfield = volume((100 * away() - 1000).astype(np.float32), modality="CT")
    values = [-500, 200, -100]
    picture = ws.slice(scan, "axial", 12, isolines=ws.Isolines(hounsfield, values), size=SIZE)
    assert [line["name"] for line in picture.report["lines"]] == ["-500 HU", "-100 HU", "200 HU"]
    assert len({tuple(line["color"]) for line in picture.report["lines"]}) == 3
    named = [ws.Isolines(hounsfield, [200], name="plan"), ws.Isolines(hounsfield, [-100, 99999])]
    picture = ws.slice(scan, "axial", 12, isolines=named, size=SIZE)
    assert [line["name"] for line in picture.report["lines"]] == ["plan 200 HU", "-100 HU"]
    assert any("no isoline 99999 HU of 'scan.nii' lies in the slice" in note for note in picture.report["notes"])
    assert picture.annotated(legend=True).size[0] > SIZE[0]


def test_isolines_of_a_volume_elsewhere(scan):
    matrix = np.eye(4)
    matrix[:3, 3] = 500
    there = ws.Volume(away(), world_from_index=matrix, unit="mm", anatomical=True, name="dose")
    picture = ws.slice(scan, isolines=ws.Isolines(there, [9]))
    assert "it lies elsewhere" in picture.report["notes"][-1]


def test_bad_lines_are_refused(scan):
    dose = volume(away())
    for values in ([], ["x"], [np.nan], None, range(100)):
        with pytest.raises(ArgumentError, match="values of isolines"):
            ws.Isolines(dose, values)
    for color in (None, (2, 0, 0), "no map"):
        with pytest.raises(ArgumentError, match="colou?r"):
            ws.Isolines(dose, [1], color=color)
    for wrong in (dose, [dose], 3, "rs.dcm"):
        with pytest.raises(ArgumentError, match="isolines is .*; give wavesplat.Isolines"):
            ws.slice(scan, isolines=wrong)
        with pytest.raises(ArgumentError, match="contours is .*; give wavesplat.Region.open"):
            ws.slice(scan, contours=wrong)
    for lines in (None, [1], [[(0, 0, 0), (1, 0, 0)]], [[(0, 0), (1, 0), (1, 1)]], [circle(3, np.nan)]):
        with pytest.raises(ArgumentError, match="a line is no list"):
            ws.Region(lines, "red")
    with pytest.raises(ArgumentError, match="region 'organ': the colour is 'transparent'"):
        ws.Region([circle(3, 0)], "transparent", name="organ")


# Files


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """A scan, the structure set that was drawn on it, and a dose on a coarser grid."""
    place = tmp_path_factory.mktemp("rt")
    save(place / "ct", [slice_at(np.full((40, 48), 40, np.int16), n) for n in range(9)])
    lines = [[(-5 + 3 * dx, 5 + 4 * dy, 30 + 1.5 * k) for dx, dy in CORNERS] for k in range(9)]
    lines = [[(x + 30, y + 30, z) for x, y, z in line] for line in lines]
    regions = [("BODY", None, "EXTERNAL", lines[:8]), ("PTV", (255, 0, 0), "PTV", lines[2:6]), ("empty", None, "", [])]
    save(place / "rs", [structure_set(regions)])
    _, y, x = np.indices((8, 20, 24))
    dose = (1000 * np.exp(-((x - 12) ** 2 + (y - 10) ** 2) / 40)).astype(np.uint16)
    grid = {"ImagePositionPatient": [10, 20, 30], "ImageOrientationPatient": [1, 0, 0, 0, 1, 0]}
    grid |= {"PixelSpacing": [1.6, 1.4], "GridFrameOffsetVector": [2.0 * n for n in range(8)]}
    save(place / "dose", [base(dose, modality="RTDOSE", NumberOfFrames=8, DoseGridScaling=0.06, **grid)])
    return place


CORNERS = ((-1, -1), (1, -1), (1, 1), (-1, 1))


def test_regions_of_a_structure_set(folder):
    with pytest.warns(FileWarning, match="without closed lines: empty"):
        regions = ws.Region.open(folder / "rs" / "000.dcm")
    assert [(region.name, len(region.lines)) for region in regions] == [("BODY", 8), ("PTV", 4)]
    assert regions[1].color == (1.0, 0.0, 0.0)
    assert repr(regions[1]) == "<Region 'PTV': 4 lines>"
    np.testing.assert_allclose(regions[1].lines[0][0], (-22, -31, 33))
    assert [region.name for region in ws.Region.open(folder / "rs" / "000.dcm", segments="P*")] == ["PTV"]
    with pytest.raises(FileError, match="no structure set"):
        ws.Region.open(folder / "dose" / "000.dcm")
    with pytest.raises(FileError, match="no structure set"):
        ws.Region.open(folder / "not there")


def test_regions_of_a_patient_need_a_scan_of_one_in_any_unit(folder, scan):
    scan = ws.open(folder / "ct")
    region = ws.Region.open(folder / "rs" / "000.dcm", segments=["PTV"])
    with pytest.raises(ArgumentError, match="says nothing of a patient"):
        ws.slice(ws.Volume(scan.samples), contours=region)
    matrix = np.array(scan.world_from_index)
    matrix[:3] /= 10
    in_cm = ws.Volume(scan.samples, world_from_index=matrix, unit="cm", anatomical=True)
    here, there = (ws.slice(one, contours=region, size=SIZE).rgba for one in (scan, in_cm))
    assert here[..., 0].any()
    np.testing.assert_allclose(here, there, atol=1e-5)


def test_the_command_line_draws_lines(folder, tmp_path, wavesplat):
    dose = folder / "dose" / "000.dcm"
    options = ["--contours", folder / "rs" / "000.dcm", "--isolines", f"{dose}:20,40:white", "--legend", "--json"]
    options += ["--isolines", f"{dose}:55", "--size", "300x200", "-o", tmp_path / "a.png"]
    done = wavesplat("slice", folder / "ct", *options)
    assert done.returncode == 0, done.stderr
    assert "without closed lines: empty" in done.stderr
    for name in ("BODY", "PTV", "20", "40", "55"):
        assert f'{name}"' in done.stdout
    one = wavesplat("slice", folder / "ct", *options, "--segment", "ptv")
    assert '"PTV"' in one.stdout
    assert '"BODY"' not in one.stdout
    mask = np.zeros((9, 40, 48), np.uint8)
    mask[:, 10:20, 10:20] = 3
    ws.Volume(mask, world_from_index=ws.open(folder / "ct").world_from_index, unit="mm", anatomical=True).save(
        tmp_path / "mask.nii"
    )
    options = ["--contours", tmp_path / "mask.nii", "--json", "-o", tmp_path / "b.png"]
    assert '"name": "3"' in wavesplat("slice", folder / "ct", *options).stdout


def test_texts_of_isolines(tmp_path):
    (tmp_path / "a:b.nii").touch()
    assert isolines_of(f"{tmp_path}/a:b.nii:-20,4e1:jet") == (f"{tmp_path}/a:b.nii", (-20.0, 40.0), "jet", None)
    assert isolines_of(f"{tmp_path}/a:b.nii:.5").color is None
    for text in (f"{tmp_path}/a:b.nii", f"{tmp_path}/a:b.nii:", f"{tmp_path}/a:b.nii:1,x", f"{tmp_path}/a:b.nii:nan"):
        with pytest.raises(ArgumentError, match="it is FILE:VALUE"):
            isolines_of(text)
    with pytest.raises(ArgumentError, match="begins with no file"):
        isolines_of("none.nii:20")
