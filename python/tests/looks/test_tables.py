"""The table below a patient in a CT leaves pictures by itself, and nothing else does (improvement 9 of the clinic)."""

# ruff: noqa: ARG005 - shapes are functions of three coordinates

from __future__ import annotations

import json
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import wavesplat as ws
from wavesplat._looks.body.table import PROCESSING, _ends, without_table
from wavesplat.errors import ArgumentError

AIR, WATER, BOARD = -1000, 40, 150


def lying(
    *,
    table: bool = True,
    n_slices: int = 24,
    parts: Any = None,
    body: Any = None,
    board: Any = None,
    matrix: Any = None,
    offset: int = 0,
    **facts: Any,
) -> ws.Volume:
    """An elliptic body of water with bones in air, 4 mm samples, and a thin table below it.

    parts, body, board : functions of (x, y, z), mm, y to the front: more of the body, or other shapes instead.
    """
    z, y, x = np.meshgrid(*(4.0 * (np.arange(n) - n / 2) for n in (n_slices, 80, 90)), indexing="ij")
    inside = (x / 130) ** 2 + ((y - 20) / 85) ** 2 < 1 if body is None else body(x, y, z)
    if parts is not None:
        inside |= parts(x, y, z)
    bones = inside & (((np.abs(x) - 60) / 20) ** 2 + ((y - 10) / 20) ** 2 < 1)
    samples = np.where(bones, 700, np.where(inside, WATER, AIR)).astype(np.int16)
    if table:
        plate = (np.abs(x) < 150) & (np.abs(y + 90 - (x / 100) ** 2 * 8) < 4.5) if board is None else board(x, y, z)
        samples[plate & ~inside] = BOARD
    known = {"modality": "CT", "is_anatomical": True, "unit": "mm", **facts}
    place = np.diag([4.0, 4, 4, 1]) if matrix is None else matrix
    return ws.Volume(samples + np.int16(offset), world_from_index=place, facts=ws.Facts(**known))


def notes(volume: Any, look: Any = None, **options: Any) -> list[str]:
    """Notes on a table of a picture of the volume."""
    picture = ws.render(volume, look, size=(24, 24), **options)
    return [note for note in picture.report.get("notes", []) if "table" in note]


def test_the_table_is_left_out_of_the_picture_and_stays_in_the_samples() -> None:
    scan = lying()
    before = scan.samples.copy()
    picture = ws.render(scan, "ct-skin", "left", size=(48, 48))
    bare = ws.render(lying(table=False), "ct-skin", "left", size=(48, 48))
    np.testing.assert_array_equal(picture.rgba, bare.rgba)
    assert picture.report["processing"] == [PROCESSING]
    assert scan.facts.processing == ()
    np.testing.assert_array_equal(scan.samples, before)
    assert ws.slice(scan).report == ws.slice(lying()).report
    (note,) = notes(scan)
    assert "--keep-table" in note
    assert notes(lying(table=False)) == []


def test_kept_it_is_drawn_and_a_note_names_what_takes_it_out() -> None:
    scan = lying()
    kept = ws.render(scan, "ct-skin", "left", size=(48, 48), keep_table=True)
    assert (kept.rgba != ws.render(scan, "ct-skin", "left", size=(48, 48)).rgba).any()
    (note,) = notes(scan, keep_table=True)
    assert "--remove-table" in note
    with pytest.raises(ArgumentError, match="keep_table is 1; give True or False"):
        ws.Scene(scan, keep_table=1)  # type: ignore[arg-type]


def test_documents_draw_the_same_again(tmp_path: Any) -> None:
    import nibabel

    scan = lying()
    nibabel.save(nibabel.Nifti1Image(scan.samples.T, scan.world_from_index), tmp_path / "a.nii.gz")
    opened = ws.open(tmp_path / "a.nii.gz")
    for keep in (False, True):
        picture = ws.render(opened, camera="left", size=(24, 24), keep_table=keep)
        document = picture.report["scene"]
        assert document.get("keep_table", False) is keep
        again = ws.Scene.from_json(json.dumps(document), tmp_path)
        assert again.keep_table is keep
        np.testing.assert_array_equal(again.render("left", size=(24, 24)).rgba, picture.rgba)


@pytest.mark.parametrize("composite", ["maximum", "depth-shaded-maximum", "local-maximum", "mean", "sum", "x-ray"])
def test_projections_leave_it_out(composite: Any) -> None:
    """An x-ray from the side had a bright line of table below the body."""
    scan, bare = lying(), lying(table=False)
    grey = ws.TransferFunction([(-1000, 1.0)], [(-1000, 0, 0, 0), (900, 1, 1, 1)])
    options: Any = {"composite": composite, "size": (48, 48)}
    got = ws.render(scan, grey, "left", **options)
    np.testing.assert_array_equal(got.rgba, ws.render(bare, grey, "left", **options).rgba)
    assert (got.rgba != ws.render(scan, grey, "left", keep_table=True, **options).rgba).any()
    assert got.report["processing"] == [PROCESSING]
    (note,) = notes(scan, composite=composite)
    assert "--keep-table" in note


def test_minima_are_those_of_the_samples() -> None:
    """A table of air would be darker than a board in a ray that runs through nothing else."""
    assert notes(lying(), composite="minimum") == []


def pet() -> ws.Volume:
    """Uptake on a coarser grid, 6 mm, in the body of `lying`."""
    z, y, x = np.meshgrid(*(6.0 * (np.arange(n) - n / 2) for n in (16, 53, 60)), indexing="ij")
    inside = (x / 120) ** 2 + ((y - 20) / 75) ** 2 < 1
    samples = np.where(inside, 2.0, 0.0) + 18.0 * ((x - 30) ** 2 + (y - 20) ** 2 + z**2 < 20**2)
    facts = ws.Facts(unit="mm", is_anatomical=True, modality="PT")
    return ws.Volume(samples.astype(np.float32), world_from_index=np.diag([6.0, 6, 6, 1]), facts=facts)


@pytest.mark.parametrize("composite", [None, "maximum"])
@pytest.mark.parametrize("is_first", [True, False])
def test_layers_leave_it_out(composite: Any, is_first: bool) -> None:
    """PET over CT, and CT over PET."""

    def drawn(**scan: Any) -> ws.Picture:
        ct, uptake = ws.Layer(lying(**scan), "ct-skin"), ws.Layer.overlay(pet(), "hot", (4, 15))
        layers = [ct, uptake] if is_first else [uptake, ct]
        return ws.Scene(layers).render("left", size=(48, 48), composite=composite)

    picture = drawn()
    np.testing.assert_array_equal(picture.rgba, drawn(table=False).rgba)
    assert [note for note in picture.report["notes"] if "--keep-table" in note]
    if is_first:
        assert picture.report["processing"] == [PROCESSING]


def lazily(scan: ws.Volume, n_levels: int = 1) -> ws.LazyVolume:
    """A lazy copy, of several levels, each of every second sample of the one before."""
    levels = [np.array(scan.samples)]
    for _ in range(n_levels - 1):
        levels.append(levels[-1][::2, ::2, ::2].copy())
    what = levels if n_levels > 1 else levels[0]
    return ws.Volume.lazy(what, world_from_index=scan.world_from_index, facts=scan.facts, name="lazy", cache=False)


@pytest.mark.parametrize("turned", [False, True])
def test_lazy_scans_leave_it_out_by_the_same_decision(turned: bool) -> None:
    scan, bare = lying(), lying(table=False)
    if turned:
        scan, bare = (
            ws.Volume(
                one.samples.transpose(1, 0, 2)[::-1].copy(),
                world_from_index=one.world_from_index
                @ np.array([[1.0, 0, 0, 0], [0, 0, -1, one.shape[1] - 1], [0, 1, 0, 0], [0, 0, 0, 1]]),
                facts=one.facts,
            )
            for one in (scan, bare)
        )
    lazy = lazily(scan)
    for look, options in (("ct-skin", {}), ("ct-bone", {"composite": "maximum"})):
        got, want, alone = (ws.render(one, look, "left", size=(32, 32), **options) for one in (lazy, scan, bare))
        np.testing.assert_array_equal(got.rgba, want.rgba)
        np.testing.assert_array_equal(got.rgba, alone.rgba)
        assert got.report["processing"] == [PROCESSING]
        assert [note for note in got.report["notes"] if "--keep-table" in note]
    kept = ws.render(lazy, "ct-skin", "left", size=(32, 32), keep_table=True)
    np.testing.assert_array_equal(kept.rgba, ws.render(scan, "ct-skin", "left", size=(32, 32), keep_table=True).rgba)
    np.testing.assert_array_equal(lazy.read().samples, scan.samples)


def test_levels_of_a_lazy_scan_leave_it_out_alike() -> None:
    lazy, bare = (lazily(lying(table=has_one, n_slices=48), 2) for has_one in (True, False))
    for size, quality in (((32, 32), "draft"), ((160, 160), "normal")):
        got, want = (ws.render(one, "ct-skin", "left", size=size, quality=quality) for one in (lazy, bare))
        np.testing.assert_array_equal(got.rgba, want.rgba)
        assert got.report["lazy"]["levels"] == want.report["lazy"]["levels"]


def test_wavelets_of_a_scan_leave_it_out() -> None:
    coefficients = ws.WaveletVolume.from_volume(lying())
    got = ws.render(coefficients, "ct-skin", "left", size=(32, 32))
    want = ws.render(ws.WaveletVolume.from_volume(lying(table=False)), "ct-skin", "left", size=(32, 32))
    np.testing.assert_allclose(got.rgba, want.rgba, atol=0.02)
    assert [note for note in got.report["notes"] if "--keep-table" in note]


def test_what_is_in_doubt_keeps_it_with_a_note_that_names_what_takes_it_out() -> None:
    """The same of samples that are read or decoded, whose table stays."""
    scan = lying()
    (note,) = notes(lazily(scan), "ct-skin", keep_table=True)
    assert "open it without memory=" in note
    (note,) = notes(ws.WaveletVolume.from_volume(scan), "ct-skin", keep_table=True)
    assert "draw the scan itself" in note
    assert notes(ws.largest_body(scan)) == []


def moving(table: bool = True) -> list[ws.Volume]:
    """A body that breathes; at the last time a phantom, whose table is in doubt by itself."""

    def breathing(deeper: float) -> ws.Volume:
        return lying(table=table, body=lambda x, y, z: (x / 130) ** 2 + ((y - 20) / (85 + deeper)) ** 2 < 1)

    rails = lying(table=table, body=lambda x, y, z: np.abs(np.hypot(x, y - 20) - 80) < 4.5)
    return [*map(breathing, (0.0, 8.0, 4.0)), rails]


def test_times_of_a_series_have_one_decision() -> None:
    """Of a 4-D CT the table came and went, where single times were in doubt."""
    assert without_table(moving()[-1]) is None
    layer = ws.Layer(ws.Series(moving()), "ct-skin")
    bare = ws.Layer(ws.Series(moving(table=False)), "ct-skin")
    for time in range(4):
        got, want = (ws.Scene(replace(one, time=time)).render("left", size=(48, 48)) for one in (layer, bare))
        np.testing.assert_array_equal(got.rgba, want.rgba)


def test_times_of_a_lazy_series_have_one_decision() -> None:
    layer = ws.Layer(ws.Series([lazily(one) for one in moving()]), "ct-skin")
    in_memory = ws.Layer(ws.Series(moving()), "ct-skin")
    for time in (0, 3):
        got, want = (ws.Scene(replace(one, time=time)).render("left", size=(48, 48)) for one in (layer, in_memory))
        np.testing.assert_array_equal(got.rgba, want.rgba)


def test_what_is_thick_at_another_time_stays() -> None:
    still = lying()
    on_it = lying(parts=lambda x, y, z: ((np.abs(x) - 60) / 25) ** 2 + ((y + 74) / 18) ** 2 < 1)
    found = without_table(on_it, still)
    assert found is not None
    hands = (on_it.samples == WATER) & (lying(table=False).samples == AIR)
    np.testing.assert_array_equal(found.samples[hands], on_it.samples[hands])
    assert without_table(on_it, still) is found
    # What is below at one time only cannot be told from mechanics: all stays.
    assert without_table(lying(parts=lambda x, y, z: (x / 60) ** 2 + ((y + 120) / 25) ** 2 < 1), still) is None
    other = lying(n_slices=30)
    assert without_table(other, still) is without_table(other)


def test_axes_of_the_file_do_not_matter() -> None:
    scan = lying()
    want = without_table(scan)
    assert want is not None
    turned = np.diag([-4.0, -4, 4, 1])
    flipped = ws.Volume(scan.samples[:, ::-1, ::-1].copy(), world_from_index=turned, facts=scan.facts)
    found = without_table(flipped)
    assert found is not None
    np.testing.assert_array_equal(found.samples[:, ::-1, ::-1], want.samples)
    sagittal = np.zeros((4, 4))
    sagittal[[1, 2, 0, 3], [0, 1, 2, 3]] = [4, 4, 4, 1]
    across = ws.Volume(scan.samples.transpose(2, 0, 1).copy(), world_from_index=sagittal, facts=scan.facts)
    found = without_table(across)
    assert found is not None
    np.testing.assert_array_equal(found.samples.transpose(1, 2, 0), want.samples)


def test_stored_units_may_have_an_offset() -> None:
    body = lying(body=lambda x, y, z: (x / 130) ** 2 + ((y - 20) / 85) ** 2 < 1)
    fat = body.samples.copy()
    fat[(fat == WATER) & (np.random.default_rng(0).random(fat.shape) < 0.4)] = -100
    facts = body.facts
    found = without_table(ws.Volume(fat + np.int16(1000), world_from_index=body.world_from_index, facts=facts))
    assert found is not None
    assert found.samples.min() == 0
    assert not (found.samples == BOARD + 1000).any()


def test_what_lies_on_the_end_of_a_table_is_no_rail() -> None:
    table, below = np.zeros((2, 20, 40), bool)
    table[10:12, 5:31] = True
    below[12:, 5:33] = True
    for rows, columns, is_rail in (
        (slice(6, 12), slice(31, 34), True),
        (slice(6, 10), slice(28, 32), False),  # on it
        (slice(6, 10), slice(15, 18), False),  # on its middle
        (slice(3, 18), slice(31, 39), False),  # as large as an arm
    ):
        matter = np.zeros((10, 20, 40), bool)
        matter[:, 10, 5:31] = True
        matter[:, rows, columns] = True
        assert _ends(matter, table, below, 9.0)[rows, columns].any() == is_rail
        matter[:4, rows, columns] = False  # not in all slices
        assert not _ends(matter, table, below, 9.0).any()


@pytest.mark.parametrize("end", [150, 174])
def test_a_rail_at_the_end_of_the_table_leaves_with_it(end: float) -> None:
    """A rail is thick, and was left in `ct_pelvis_right` where the scan cuts it: a strip beside the bones."""

    def board(x: Any, y: Any, z: Any) -> Any:
        return (np.abs(x) < end) & (np.abs(y + 90) < 4.5) | (np.abs(x - end + 8) < 9) & (np.abs(y + 84) < 14)

    found = without_table(lying(board=board))
    assert found is not None
    assert not (found.samples == BOARD).any()


@pytest.mark.parametrize(
    "parts",
    [
        pytest.param(
            lambda x, y, z: ((np.abs(x) - 155) / 22) ** 2 + ((y + 45) / 20) ** 2 < 1, id="arms beside the body"
        ),
        pytest.param(lambda x, y, z: (np.abs(x - 120) < 8) & (np.abs(y + 64) < 9) & (z > -20), id="a finger"),
        pytest.param(lambda x, y, z: (np.abs(x + 130) < 40) & (np.abs(y + 58) < 9) & (z < 0), id="a flat hand"),
    ],
)
def test_arms_and_hands_stay(parts: Any) -> None:
    scan, bare = lying(parts=parts), lying(parts=parts, table=False)
    found = without_table(scan)
    drawn = scan if found is None else found
    assert ((drawn.samples > -400) | (bare.samples <= -400)).all()


@pytest.mark.parametrize(
    "body",
    [
        pytest.param(lambda x, y, z: (np.abs(x) - 80) ** 2 + (y - 10) ** 2 < 50**2, id="legs apart"),
        pytest.param(lambda x, y, z: (x**2 + y**2 < 75**2) & (np.abs(z) < 36), id="a solid phantom"),
    ],
)
def test_bodies_of_several_parts_and_phantoms_stay(body: Any) -> None:
    scan = lying(body=body)
    found = without_table(scan)
    assert found is not None
    inside = scan.samples != BOARD
    np.testing.assert_array_equal(found.samples[inside], scan.samples[inside])
    assert not (found.samples == BOARD).any()


@pytest.mark.parametrize(
    "scan",
    [
        pytest.param(lying(table=False), id="no table"),
        pytest.param(lying(n_slices=12), id="too short to tell"),
        pytest.param(lying(modality="MR"), id="MR"),
        pytest.param(lying(unit="um"), id="micrometres"),
        pytest.param(lying(is_anatomical=False), id="no patient"),
        pytest.param(
            lying(board=lambda x, y, z: (np.abs(x) < 25) & (np.abs(y + 90) < 4.5)), id="a narrow bar, such as a splint"
        ),
        pytest.param(lying(board=lambda x, y, z: np.abs(np.hypot(x, y) - 150) < 4.5), id="a thin wall all around"),
        pytest.param(lying(body=lambda x, y, z: np.abs(np.hypot(x, y) - 60) < 4.5, table=False), id="a hollow phantom"),
        pytest.param(
            lying(
                table=False,
                parts=lambda x, y, z: (np.abs(y + 90 + z / 2) < 4.5) & (np.abs(x) < 100),
            ),
            id="thin, but not the same from slice to slice",
        ),
        pytest.param(lying(board=lambda x, y, z: (np.abs(x) < 150) & (np.abs(y - 130) < 4.5)), id="above a prone body"),
    ],
)
def test_in_doubt_all_stays(scan: ws.Volume) -> None:
    assert without_table(scan) is None


def test_what_is_found_is_found_again_after_a_change() -> None:
    samples = lying().samples.copy()
    scan = ws.Volume(samples, world_from_index=np.diag([4.0, 4, 4, 1]), facts=lying().facts)
    assert without_table(scan) is not None
    samples[samples == BOARD] = AIR
    scan.changed()
    assert without_table(scan) is None


def test_the_options_exclude_each_other(wavesplat: Any, tmp_path: Any) -> None:
    import nibabel

    scan = lying()
    nibabel.save(nibabel.Nifti1Image(scan.samples.T, scan.world_from_index), tmp_path / "a.nii.gz")
    command = ("render", tmp_path / "a.nii.gz", "-o", tmp_path / "a.png", "--size", "16x16")
    done = wavesplat(*command)
    assert "--keep-table" in done.stderr
    done = wavesplat(*command, "--keep-table")
    assert "left out" not in done.stderr
    done = wavesplat(*command, "--keep-table", "--remove-table")
    assert done.returncode == 2
    assert "give one of them" in done.stderr


@pytest.mark.parametrize(("x", "y", "radius"), [(70, 10, 105), (70, 0, 95), (80, 10, 95), (60, 0, 95)])
def test_a_chest_wall_that_a_round_field_of_view_cuts_thin_stays(x, y, radius):
    """Lung above and padding below make a thin crescent of it, alike in all slices, as a table is."""
    columns, rows = np.meshgrid((np.arange(256) - 128) * 1.5, (np.arange(256) - 128) * 1.5)
    body = (columns / 160) ** 2 + (rows / 110) ** 2 < 1
    lungs = ((np.abs(columns) - 75) / 58) ** 2 + ((rows + 15) / 73) ** 2 < 1
    plane = np.where(body, np.where(lungs, -850, 40), -1000)
    noisy = plane + np.random.default_rng(0).normal(0, 15, (24, 256, 256))
    noisy[:, (columns - x) ** 2 + (rows - y) ** 2 > radius**2] = -1024
    facts = ws.Facts(unit="mm", is_anatomical=True, modality="CT")
    scan = ws.Volume(noisy.astype(np.int16), world_from_index=np.diag([1.5, 1.5, 3, 1]), facts=facts)
    assert without_table(scan) is None


def test_pictures_from_inside_of_the_body_have_no_note_on_a_table() -> None:
    scan = lying()
    middle = scan.bounds.mean(axis=0)
    inside = ws.Camera(tuple(middle), tuple(np.add(middle, (0, 50, 0))), (0, 0, 1), view_angle=90.0)
    outside = ws.Camera(tuple(np.add(middle, (0, 900, 0))), tuple(middle), (0, 0, 1), view_angle=30.0)
    scene = ws.Scene(scan, "ct-skin", keep_table=True)

    def told(camera: ws.Camera) -> list[str]:
        notes = scene.render(camera, size=(24, 24)).report.get("notes", [])
        return [note for note in notes if "seems to show the table" in note]

    assert len(told(outside)) == 1
    assert told(inside) == []
