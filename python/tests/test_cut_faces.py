"""Cut faces show the values of the tissue: fault 2 of the trial in the clinic."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

import wavesplat as ws
from wavesplat.errors import ArgumentError

N = 160


def rank_correlation(a: NDArray[Any], b: NDArray[Any]) -> float:
    """Correlation of the ranks of two arrays of numbers."""
    first, second = (np.argsort(np.argsort(each)).astype(float) for each in (a, b))
    return float(np.corrcoef(first, second)[0, 1])


def brightness(scan: ws.Volume, even_cuts: float, clip: ws.ClipPlane | ws.Crop | ws.CutOut, y: float) -> NDArray[Any]:
    """Luminance of the automatic look, seen along -y, with a plane of constant y in focus."""
    low, high = (np.array(end) for end in scan.bounds)
    middle, half = (low + high) / 2, max(high - low) / 2
    camera = ws.Camera(
        position=(middle[0], y + 4 * half, middle[2]),
        focal_point=(middle[0], y, middle[2]),
        view_up=(0, 0, 1),
        parallel_scale=half,
    )
    shading = ws.Look.auto(scan).shading
    assert shading is not None
    scene = ws.Scene(scan).with_(shading=shading.changed(even_cuts=even_cuts), clip=clip, background="black")
    pixels = np.asarray(scene.render(camera, size=(N, N)))[..., :3].astype(float)
    luminance: NDArray[Any] = pixels @ np.array([0.2126, 0.7152, 0.0722])
    return luminance


def samples_on(scan: ws.Volume, y: float) -> NDArray[Any]:
    """Nearest samples in that plane, by pixel; NaN outside of the box."""
    low, high = (np.array(end) for end in scan.bounds)
    middle, half = (low + high) / 2, max(high - low) / 2
    steps = half * (1 - 2 * (np.arange(N) + 0.5) / N)
    x, z = np.broadcast_arrays(middle[0] + steps[None, :], middle[2] + steps[:, None])
    world = np.stack([x, np.full(x.shape, y), z, np.ones(x.shape)], axis=-1)
    index = np.rint((world @ np.linalg.inv(scan.world_from_index).T)[..., 2::-1]).astype(int)
    inside = np.all((index >= 0) & (index < scan.shape), axis=-1)
    values = np.full(inside.shape, np.nan)
    values[inside] = np.asarray(scan.samples)[tuple(index[inside].T)]
    return values


@pytest.mark.parametrize("kind", ["plane", "crop", "cut-out"])
def test_a_cut_head_shows_its_tissue_fault_2(kind: str) -> None:
    head = ws.examples.mri_head()
    low, high = (np.array(end) for end in head.bounds)
    y = float((low[1] + high[1]) / 2)
    clips: dict[str, ws.ClipPlane | ws.Crop | ws.CutOut] = {
        "plane": ws.ClipPlane((0, y, 0), (0, -1, 0)),
        "crop": ws.Crop(tuple(low - 1), (high[0] + 1, y, high[2] + 1)),
        "cut-out": ws.CutOut(ws.Crop((low[0] - 1, y, low[2] - 1), tuple(high + 1))),
    }
    values = samples_on(head, y)
    tissue = values > 0.2 * np.nanmax(values)
    even, uneven = (rank_correlation(brightness(head, e, clips[kind], y)[tissue], values[tissue]) for e in (1, 0))
    assert even > 0.7, even
    assert uneven < even - 0.15, uneven


def test_a_dense_cut_face_shows_its_tissue_fault_2() -> None:
    """Matter that is opaque within a voxel or two, with a texture."""
    grid = np.indices((40, 40, 40)).astype(float)
    ball = np.linalg.norm(grid - 19.5, axis=0) < 17
    z, y, x = grid
    texture = 150 + 25 * np.sin(0.9 * x + 0.3 * z) + 25 * np.cos(0.8 * z - 0.7 * y)
    samples = np.where(ball, texture, 0).astype(np.float32)
    scan = ws.Volume(samples)
    values = samples_on(scan, 19.0)
    tf = ws.TransferFunction([(50, 0.0), (90, 0.9), (200, 0.95)], [(90, 0.25, 0.06, 0.03), (200, 1, 1, 1)])
    camera = ws.Camera((19.5, 100, 19.5), (19.5, 19.5, 19.5), (0, 0, 1), parallel_scale=19.5)
    low, high = (np.array(end) for end in scan.bounds)
    assert max(high - low) / 2 == 19.5
    found = {}
    for even_cuts in (0.0, 1.0):
        scene = ws.Scene(scan, ws.Look(transfer_function=tf, shading=ws.Shading(even_cuts=even_cuts)))
        cut = scene.with_(clip=ws.ClipPlane((0, 19.0, 0), (0, -1, 0)), background="black")
        pixels = np.asarray(cut.render(camera, size=(N, N)))[..., 1].astype(float)
        inside = values > 90
        found[even_cuts] = rank_correlation(pixels[inside], values[inside])
    assert found[1.0] > 0.85 > found[0.0] + 0.1, found


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
