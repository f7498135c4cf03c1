"""Cut faces show the values of the tissue: fault 2 of the trial in the clinic."""

from __future__ import annotations

import importlib.util
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import wavesplat as ws
from wavesplat.errors import ArgumentError

STUDY = Path(__file__).parents[3] / "studies" / "cuts" / "cuts.py"
N = 160


@pytest.fixture(scope="module")
def study() -> Any:
    """The study of cuts, which has the measure."""
    spec = importlib.util.spec_from_file_location("cuts", STUDY)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.mark.parametrize("kind", ["plane", "crop", "cut-out"])
def test_a_cut_head_shows_its_tissue_fault_2(study: Any, kind: str) -> None:
    head = ws.examples.mri_head()
    low, high = (np.array(end) for end in head.bounds)
    y = study.middle_of(head)
    clips: dict[str, ws.ClipPlane | ws.Crop | ws.CutOut] = {
        "plane": ws.ClipPlane((0, y, 0), (0, -1, 0)),
        "crop": ws.Crop(tuple(low - 1), (high[0] + 1, y, high[2] + 1)),
        "cut-out": ws.CutOut(ws.Crop((low[0] - 1, y, low[2] - 1), tuple(high + 1))),
    }
    values = study.samples_on_cut(head, N)
    tissue = study.tissue_of(values)
    light = ws.Look.auto(head).shading
    assert light is not None
    even, uneven = (
        study.rank_correlation(study.luminance(head, one, clips[kind], N)[tissue], values[tissue])
        for one in (light, light.changed(even_cuts=0))
    )
    assert even > 0.8, even
    assert uneven < even - 0.4, uneven


def test_a_dense_cut_face_shows_its_tissue_fault_2(study: Any) -> None:
    """Matter that is opaque within a voxel or two, with a texture."""
    z, y, x = np.indices((40, 40, 40)).astype(float)
    ball = np.sqrt((x - 19.5) ** 2 + (y - 19.5) ** 2 + (z - 19.5) ** 2) < 17
    texture = 150 + 25 * np.sin(0.9 * x + 0.3 * z) + 25 * np.cos(0.8 * z - 0.7 * y)
    scan = ws.Volume(np.where(ball, texture, 0).astype(np.float32))
    values = study.samples_on_cut(scan, N)
    tf = ws.TransferFunction([(50, 0.0), (90, 0.9), (200, 0.95)], [(90, 0.25, 0.06, 0.03), (200, 1, 1, 1)])
    camera = ws.Camera((19.5, 100, 19.5), (19.5, 19.5, 19.5), (0, 0, 1), parallel_scale=19.5)
    found = {}
    for even_cuts in (0.0, 1.0):
        scene = ws.Scene(scan, ws.Look(transfer_function=tf, shading=ws.Shading(even_cuts=even_cuts)))
        cut = scene.with_(clip=ws.ClipPlane((0, 19.5, 0), (0, -1, 0)), background="black")
        pixels = np.asarray(cut.render(camera, size=(N, N)))[..., 1].astype(float)
        inside = values > 90
        found[even_cuts] = study.rank_correlation(pixels[inside], values[inside])
    assert found[1.0] > 0.95 > found[0.0] + 0.1, found


def test_surfaces_near_the_wall_of_the_volume_are_lit_as_before() -> None:
    """A ray that comes through air meets a surface, however near the wall is."""
    grid = np.indices((32, 32, 32)).astype(float)
    ball = np.clip(13.2 - np.linalg.norm(grid - 15.5, axis=0), -0.5, 0.5) + 0.5
    scan = ws.Volume((200 * ball).astype(np.float32))
    tf = ws.TransferFunction([(60, 0.0), (140, 0.6)], [(0, 1, 1, 1)])
    pictures = [
        np.asarray(ws.render(scan, ws.Look(transfer_function=tf, shading=ws.Shading(even_cuts=e)), size=(64, 64)))
        for e in (0.0, 1.0)
    ]
    assert np.array_equal(pictures[0], pictures[1])


def test_the_light_of_other_renderers_is_left_alone() -> None:
    assert ws.Shading.headlight().even_cuts == 0.0
    with pytest.raises(ArgumentError, match="even_cuts"):
        ws.Shading(even_cuts=1.5)
