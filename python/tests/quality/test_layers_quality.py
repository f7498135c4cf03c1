"""Several volumes in one picture, on their own grids, against the ray caster, which mixes media point by point."""

from __future__ import annotations

import numpy as np
import pytest

import wavesplat as ws

#: Settings of `test_quality`: a light whose gradients the ray caster takes fast, and a part of a large picture.
LIGHT = ws.Shading.headlight()
SIZE = (64, 56)
ZOOM = 5


def psnr_db(picture: ws.Picture, reference: np.ndarray) -> float:
    return float(-10 * np.log10(np.mean((picture.rgba[..., :3] - reference) ** 2)))


def uptake(scan: ws.Volume, shape: tuple[int, int, int]) -> ws.Volume:
    """Hot spots in the place of a scan, on a coarser grid, as of PET over CT."""
    lower, upper = scan.bounds
    spacing = (upper - lower) / (np.array(shape[::-1]) - 1)
    affine = np.diag([*spacing, 1.0])
    affine[:3, 3] = lower
    z, y, x = np.meshgrid(*(np.linspace(0, 1, n) for n in shape), indexing="ij")
    spots = [(0.5, 0.6, 0.5, 8), (0.42, 0.6, 0.45, 6), (0.58, 0.5, 0.57, 5)]
    values = sum(peak * np.exp(-((x - cx) ** 2 + (y - cy) ** 2 + (z - cz) ** 2) / 0.001) for cx, cy, cz, peak in spots)
    return ws.Volume(np.asarray(values, np.float32), world_from_index=affine, unit="mm", anatomical=True, name="uptake")


def soft(rgb: tuple[float, float, float], low: float, high: float, most: float = 0.2) -> ws.Look:
    return ws.Look(transfer_function=ws.TransferFunction([(low, 0), (high, most)], [(low, *rgb)], 4.0), shading=LIGHT)


def hard(rgb: tuple[float, float, float], at: float) -> ws.Look:
    function = ws.TransferFunction([(at, 0), (1.02 * at, 0.9)], [(at, *rgb)], 1.0)
    return ws.Look(transfer_function=function, shading=LIGHT)


def scenes() -> dict[str, tuple[ws.Scene, float]]:
    """Scenes, and the PSNR that they are to have against the ray caster."""
    pelvis, head = ws.examples.ct_pelvis(), ws.examples.mri_head()
    hot = uptake(pelvis, (44, 60, 70))
    # Two real scans in one place: the head's middle is put into the pelvis.
    moved = head.world_from_index.copy()
    moved[:3, 3] += np.mean(pelvis.bounds, axis=0) - np.mean(head.bounds, axis=0)
    inside = ws.Volume(head.samples, world_from_index=moved, unit="mm", anatomical=True, name="head")
    bone, bone_hard = soft((1, 0.95, 0.85), 150, 900), hard((1, 0.95, 0.85), 220)
    spots, spots_hard = soft((1, 0.4, 0.1), 1, 6), hard((1, 0.4, 0.1), 3)
    brain, brain_hard = soft((0.5, 0.8, 1), 20, 120), hard((0.5, 0.8, 1), 60)
    veil = soft((0.3, 0.9, 0.4), -100, 200, 0.01)
    return {
        "PET over CT, soft": (ws.Scene([ws.Layer(pelvis, bone), ws.Layer(hot, spots)]), 45),
        "PET over CT, hard": (ws.Scene([ws.Layer(pelvis, bone_hard), ws.Layer(hot, spots_hard)]), 38),
        "CT over PET, hard": (ws.Scene([ws.Layer(hot, spots_hard), ws.Layer(pelvis, bone_hard)]), 38),
        "CT and MR, soft": (ws.Scene([ws.Layer(pelvis, bone), ws.Layer(inside, brain)]), 45),
        "four, soft": (
            ws.Scene([ws.Layer(pelvis, bone), ws.Layer(hot, spots), ws.Layer(inside, brain), ws.Layer(pelvis, veil)]),
            45,
        ),
        "four, hard": (
            ws.Scene(
                [ws.Layer(pelvis, bone_hard), ws.Layer(hot, spots), ws.Layer(inside, brain_hard), ws.Layer(hot, veil)]
            ),
            38,
        ),
    }


def view(volume: ws.Volume) -> ws.Camera:
    return ws.Camera.orbit(volume, 25, 15, zoom=ZOOM, fit="view")


@pytest.fixture
def converged(kept_picture):
    """The ray caster's picture; hard steps get a finer step, since a coarse one meets surfaces late."""

    def picture(name: str, scene: ws.Scene, camera: ws.Camera) -> np.ndarray:
        step, rays = (0.03, 9) if "hard" in name else (0.1, 4)
        options = {"size": SIZE, "step": step, "rays_per_pixel": rays}
        return kept_picture(name, lambda: ws.reference.raycast(scene, None, camera, **options).rgba)

    return picture


@pytest.mark.parametrize("name", list(scenes()))
def test_layers_are_those_of_the_ray_caster(name, converged):
    scene, least_db = scenes()[name]
    camera = view(ws.examples.ct_pelvis())
    reference = converged(name, scene, camera)
    picture = scene.render(camera, size=SIZE, quality="high")
    print(f"{name}: {psnr_db(picture, reference):.1f} dB")
    assert psnr_db(picture, reference) >= least_db
    alone = ws.Scene(scene.layers[0]).render(camera, size=SIZE, quality="high")
    assert psnr_db(alone, reference) < least_db - 8


def test_labels_and_layers_together(converged):
    pelvis = ws.examples.ct_pelvis()
    z = np.arange(pelvis.shape[0])[:, None, None]
    codes = np.where((pelvis.samples > 200) & (z > pelvis.shape[0] // 2), 1, 0).astype(np.uint8)
    labels = ws.Labels(codes, {1: ws.Label((0.2, 0.9, 0.3), 0.4, scan=0.3)})
    hot = uptake(pelvis, (44, 60, 70))
    layers = [ws.Layer(pelvis, soft((1, 0.95, 0.85), 150, 900)), ws.Layer(hot, soft((1, 0.4, 0.1), 1, 6))]
    scene = ws.Scene(layers, labels=labels)
    camera = view(pelvis)
    reference = converged("labels", scene, camera)
    picture = scene.render(camera, size=SIZE, quality="high")
    print(f"labels: {psnr_db(picture, reference):.1f} dB")
    assert psnr_db(picture, reference) >= 38
    assert psnr_db(ws.Scene(layers).render(camera, size=SIZE, quality="high"), reference) < 30


def test_a_layer_on_its_own_grid_is_nearer_to_the_truth_than_a_resampled_one(converged):
    """A resampled layer has the error of resampling; a layer on its own grid has none."""
    pelvis = ws.examples.ct_pelvis()
    hot = uptake(pelvis, (44, 60, 70))
    look = soft((1, 0.4, 0.1), 1, 6)
    bone = soft((1, 0.95, 0.85), 150, 900)
    camera = view(pelvis)
    draw = {"camera": camera, "size": SIZE, "quality": "high"}
    own = ws.Scene([ws.Layer(pelvis, bone), ws.Layer(hot, look)])
    # Trilinear values at the samples of the scan: exact there, and linear in between, as on the coarser grid.
    index = np.linalg.inv(hot.world_from_index) @ pelvis.world_from_index
    axes = [np.clip(index[a, a] * np.arange(n) + index[a, 3], 0, None) for a, n in enumerate(pelvis.shape[::-1])]
    values = hot.samples.astype(np.float64)
    for axis, places in zip((2, 1, 0), axes, strict=True):
        first = np.clip(places.astype(int), 0, values.shape[axis] - 2)
        share = (places - first).reshape([-1 if a == axis else 1 for a in range(3)])
        values = np.take(values, first, axis) * (1 - share) + np.take(values, first + 1, axis) * share
    fine = ws.Volume(values.astype(np.float32), world_from_index=pelvis.world_from_index, name="resampled")
    resampled = ws.Scene([ws.Layer(pelvis, bone), ws.Layer(fine, look)])
    reference = converged("own grid", own, camera)
    of_own = psnr_db(own.render(**draw), reference)
    of_resampled = psnr_db(resampled.render(**draw), reference)
    assert of_own >= 45
    assert 30 < of_resampled < of_own
