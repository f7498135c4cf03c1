"""Slices on the faces of cuts, `SlicePlane(plane="cuts")`: they show the samples, where the faces are seen."""

from __future__ import annotations

import importlib.util
import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import wavesplat as ws
from wavesplat._scene.slices.cards import air_around
from wavesplat.errors import ArgumentError

STUDY = Path(__file__).parents[3] / "studies" / "cuts" / "cuts.py"
N = 100
#: Looks along -z at samples 0 to 19 of x and y, 2 pixels a sample.
CAMERA = ws.Camera((9.5, 9.5, 100), (9.5, 9.5, 9.5), (0, 1, 0), parallel_scale=N / 4)
CUTS = ws.SlicePlane(plane="cuts", clim=(0, 20))
#: Matter that is bright red wherever it is.
RED = ws.Look(transfer_function=ws.TransferFunction([(-1, 1), (99, 1)], [(0, 1, 0, 0)]), shading=None)


@pytest.fixture(scope="module")
def ramp():
    """Samples of the value x."""
    return ws.Volume(np.mgrid[:20, :20, :20][2].astype(np.float32))


def seen(volume, clip, geometry=CUTS, **options):
    """Colours by (x, y) of the world, to the middle of each sample."""
    scene = ws.Scene(volume, RED, clip=clip, geometry=geometry, background="black", **options)
    pixels = np.asarray(scene.render(CAMERA, size=(N, N))) / 255
    middle = (N // 2 - 20, N // 2 + 20)
    of_samples = pixels[slice(*middle), slice(*middle), :3].reshape(20, 2, 20, 2, 3).mean(axis=(1, 3))
    return of_samples[::-1].swapaxes(0, 1)


def grey(colors):
    """Where colours are grey."""
    return np.ptp(colors, axis=-1) < 0.05


@pytest.mark.parametrize("kind", ["plane", "crop", "cut-out"])
def test_a_cut_head_shows_its_samples_as_a_slice_does_fault_2(kind: str) -> None:
    spec = importlib.util.spec_from_file_location("cuts", STUDY)
    assert spec is not None
    assert spec.loader is not None
    study: Any = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(study)
    head = ws.examples.mri_head()  # its axes are oblique
    low, high = (np.array(end) for end in head.bounds)
    y = study.middle_of(head)
    clips: dict[str, ws.ClipPlane | ws.Crop | ws.CutOut] = {
        "plane": ws.ClipPlane((0, y, 0), (0, -2, 0)),
        "crop": ws.Crop(tuple(low - 1), (high[0] + 1, y, high[2] + 1)),
        "cut-out": ws.CutOut(ws.Crop((low[0] - 1, y, low[2] - 1), tuple(high + 1))),
    }
    values = study.samples_on_cut(head, 160)
    tissue = study.tissue_of(values)
    light = ws.Look.auto(head).shading
    picture = study.luminance(head, light, clips[kind], 160, geometry=ws.SlicePlane(plane="cuts"))
    found = study.rank_correlation(picture[tissue], values[tissue])
    # The face of a box that is cut out lies up to a sample within it.
    assert found > (0.9 if kind == "cut-out" else 0.98), found


def test_a_face_is_seen_inside_of_the_other_clips(ramp):
    clips = [
        ws.ClipPlane((0, 0, 12.25), (0, 0, -1)),
        ws.ClipPlane((10.5, 0, 0), (-1, 0, 0)),
        ws.Crop((0, 4.5, 0), (99, 99, 99)),
    ]
    colors = seen(ramp, clips)
    assert not colors[:, :4].any()
    assert not colors[12:].any()
    values = np.broadcast_to(np.arange(1, 9)[:, None] / 20, (8, 13))
    np.testing.assert_allclose(colors[1:9, 6:19, 0], values, atol=0.02)
    assert grey(colors[1:9, 6:19]).all()


def test_boxes_that_are_cut_out_show_their_faces_and_hide_others(ramp):
    box = ws.Crop((5.5, 5.5, 5.5), (14.5, 14.5, 99))
    colors = seen(ramp, ws.CutOut(box))
    assert grey(colors[8:13, 8:13]).all()  # the face behind, which the camera sees
    np.testing.assert_allclose(colors[8:13, 10, 0], np.arange(8, 13) / 20, atol=0.02)
    assert not grey(colors[1:4]).any()
    assert not grey(colors[17:, :]).any()
    # A plane in front cuts the box, too: its face has a hole there, in which the face behind is seen.
    colors = seen(ramp, [ws.CutOut(box), ws.ClipPlane((0, 0, 15), (0, 0, -1))])
    assert grey(colors[1:4, 1:19]).all()
    assert grey(colors[8:13, 8:13]).all()
    of_plane_alone = seen(ramp, ws.ClipPlane((0, 0, 15), (0, 0, -1)))
    np.testing.assert_allclose(colors[1:4, 1:19], of_plane_alone[1:4, 1:19], atol=0.01)


@pytest.mark.parametrize("side", [5.0, 5.3, 5.999999, 6.0000001])
def test_no_matter_lies_before_the_face_of_a_box(ramp, side):
    colors = seen(ramp, ws.CutOut(ws.Crop((side, side, side), (99, 99, 99))))
    np.testing.assert_allclose(colors[9:18, 10, 0], np.arange(9, 18) / 20, atol=0.02)
    assert grey(colors[9:18, 9:18]).all()


def test_boxes_in_samples_are_those_of_the_first_volume(ramp):
    turned = ws.Volume(ramp.samples, spacing=(0.5, 1, 2))
    samples, world = (
        seen(turned, ws.Crop((2.5, 3.5, 4.5), (12.5, 13.5, 6.5), space="index")),
        seen(turned, ws.Crop((1.25, 3.5, 9), (6.25, 13.5, 13))),
    )
    assert grey(world[3:5, 5:12]).all()
    assert np.abs(samples - world).max() < 0.02


def test_walls_of_the_volume_are_no_cuts(ramp):
    clips = [
        ws.ClipPlane((0, 0, 19), (0, 0, -1)),
        ws.Crop((-5, -5, -5), (30, 30, 19)),
        ws.ClipPlane((0, 0, 90), (0, 0, -1)),
    ]
    assert not grey(seen(ramp, clips)[1:19, 1:19]).any()


def test_labels_lie_on_the_face(ramp):
    labels = ws.Labels((np.mgrid[:20, :20, :20][1] > 12).astype(np.uint8), {1: ws.Label((0, 1, 0), name="organ")})
    colors = seen(ramp, ws.ClipPlane((0, 0, 8), (0, 0, -1)), labels=labels)
    assert grey(colors[2:18, 2:11]).all()
    assert (colors[2:18, 15:18, 1] > colors[2:18, 15:18, 0] + 0.2).all()


def test_further_layers_lie_over_the_face_as_on_a_slice(ramp):
    spot = ws.Volume((np.abs(np.mgrid[:20, :20, :20] - 10).sum(axis=0) < 4).astype(np.float32) * 9)
    clip = ws.ClipPlane((0, 0, 10), (0, 0, -1))
    layers = [ws.Layer(ramp, RED), ws.Layer.overlay(spot, "green", (2, 8))]

    def colors(layers):
        scene = ws.Scene(layers, clip=clip, geometry=CUTS, background="black")
        pixels = np.asarray(scene.render(CAMERA, size=(N, N)))[30:70, 30:70, :3] / 255
        return pixels[::-2, ::2].swapaxes(0, 1)

    found = colors(layers)
    assert found[10, 10, 1] > found[10, 10, 0] + 0.3
    assert grey(found[1:6, 1:18]).all()
    hidden = [layers[0], replace(layers[1], visible=False)]
    assert grey(colors(hidden)[9:12, 9:12]).all()


def test_faces_show_the_part_that_is_drawn():
    head = ws.examples.mri_head()
    middle = head.bounds.mean(axis=0)
    clip = ws.ClipPlane(middle, (0, -1, 0))

    def n_grey(preset):
        scene = ws.Scene(head, preset, clip=clip, geometry=ws.SlicePlane(plane="cuts"), background="black")
        eye = ws.Camera(middle + np.array((0, 500, 0)), middle, (0, 0, 1), parallel_scale=130)
        colors = np.asarray(scene.render(eye, size=(96, 96)))[..., :3] / 255
        return int((grey(colors) & (colors[..., 0] > 0.1)).sum())

    of_head, of_brain = n_grey("mr-head"), n_grey("mr-brain")
    assert 0.2 * of_head < of_brain < 0.8 * of_head


def test_the_air_around_a_patient_is_clear():
    z, y, x = np.mgrid[:40, :40, :40]
    away = np.sqrt((x - 20) ** 2 + (y - 20) ** 2 + (z - 20) ** 2)
    body = np.where((away < 15) & (away > 6), 100, 0).astype(np.float32)
    behind = ws.Surface(
        [[-50, -50, 1], [90, -50, 1], [90, 90, 1], [-50, 90, 1]], [[0, 1, 2], [0, 2, 3]], color="lime", lit=False
    )
    camera = ws.Camera((20, 20, 200), (20, 20, 20), (0, 1, 0), parallel_scale=19)

    def colors(volume):
        scene = ws.Scene(
            volume, RED, clip=ws.ClipPlane((0, 0, 20), (0, 0, -1)), geometry=[CUTS.with_(clim=None), behind]
        )
        return np.asarray(
            scene.with_(layers=[ws.Layer(volume, ws.TransferFunction([(50, 0), (60, 1)], [(0, 1, 0, 0)]))]).render(
                camera, size=(76, 76)
            )
        )[..., :3]

    patient = colors(ws.Volume(body, unit="mm", anatomical=True))
    assert patient[3, 3].argmax() == 1  # what lies behind
    assert np.allclose(patient[38, 38], 0, atol=0.02)  # air inside
    assert grey(patient[38, 60])
    assert patient[38, 60, 0] > 0.8
    assert np.allclose(colors(ws.Volume(body))[3, 3], 0, atol=0.02)


def test_air_does_not_pass_gaps():
    values = np.zeros((300, 300))
    values[100:200, 100:200] = 10
    values[120:180, 120:180] = 0
    values[100:120, 150:152] = 0
    values[:50, 200] = 0
    air = air_around(values, 5)
    assert air[0].all()
    assert not air[120:180, 120:180].any()
    values[100:120, 140:160] = 0
    assert air_around(values, 5)[125:175, 125:175].all()
    assert not air_around(np.full((30, 30), 10.0), 5).any()
    assert air_around(np.full((30, 30), np.nan), 5).all()


def test_documents_and_the_command_line_know_cuts(wavesplat, tmp_path, ramp):
    ramp.save(tmp_path / "ramp.nrrd")
    told = wavesplat(
        "render", tmp_path / "ramp.nrrd", "-o", tmp_path / "x.png", "--size", 64, "--clip", "0,0,12,0,0,-1",
        "--slice-plane", "cuts:hot:0,19:0.5", "--json",
    )  # fmt: skip
    assert json.loads(told.stdout)["report"]["geometry"] == [{"kind": "slice plane", "name": None, "count": 1}]
    scene = ws.Scene(ws.open(tmp_path / "ramp.nrrd"), RED, clip=ws.ClipPlane((0, 0, 12), (0, 0, -1)), geometry=CUTS)
    again = ws.Scene.from_json(scene.to_json(), external_files=True)
    assert again.geometry[0].plane == "cuts"
    assert again.geometry[0].clim == (0, 20)


def test_other_clips_make_other_faces(ramp):
    scene = ws.Scene(ramp, RED, clip=ws.ClipPlane((0, 0, 12), (0, 0, -1)), geometry=CUTS)
    whole = scene.render(CAMERA, size=(N, N))
    half = scene.with_(clip=ws.ClipPlane((10, 0, 0), (-1, 0, 0))).render(CAMERA, size=(N, N))
    assert grey(np.asarray(whole)[50, 40:60, :3] / 255).all()
    assert not grey(np.asarray(half)[50, 35:45, :3] / 255).any()


def test_what_cannot_be_is_said(ramp):
    for wrong in ({"position": 3.0}, {"index": 3}, {"clipped": True}):
        with pytest.raises(ArgumentError, match=f"{next(iter(wrong))} of the slice plane says which part is seen"):
            ws.SlicePlane(plane="cuts", **wrong)
    picture = ws.Scene(ramp, RED, geometry=CUTS).render(CAMERA, size=(16, 16))
    assert any("nothing is cut" in note for note in picture.report["notes"])


def test_cameras_are_fitted_to_what_is_seen_of_a_face() -> None:
    head = ws.examples.mri_head()
    clip = ws.ClipPlane((5, 0, 0), (-1, 0, 0))
    plain, cut = (
        ws.Scene(head, clip=clip, geometry=shapes).render("left", size=(32, 32)).report["camera"]
        for shapes in ((), CUTS)
    )
    # The plane of the face goes on beside the head, where it shows air.
    assert cut["parallel_scale"] == pytest.approx(plain["parallel_scale"], rel=0.03)


def test_an_unknown_plane_is_told_of_cuts() -> None:
    with pytest.raises(ArgumentError, match="unknown plane 'cutz'; use one of: axial, .*, or 'cuts'"):
        ws.SlicePlane(plane="cutz")
