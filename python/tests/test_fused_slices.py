"""Slices of several volumes, against the mixture by hand."""

import numpy as np
import pytest

import wavesplat as ws
from wavesplat.errors import ArgumentError

SCAN = ws.examples.ct_pelvis()
HOT = ws.TransferFunction([(2, 0), (6, 0.5)], [(2, 1, 0, 0), (6, 1, 1, 0)])


def uptake(spacing: float = 9.0) -> ws.Volume:
    """A hot ball in the middle of the scan, on a coarser grid that ends within it."""
    middle = np.mean(SCAN.bounds, axis=0)
    affine = np.diag([spacing, spacing, spacing, 1.0])
    affine[:3, 3] = middle - 6 * spacing
    z, y, x = np.mgrid[-6:7, -6:7, -6:7]
    values = (8 - 1.2 * np.sqrt(x**2 + y**2 + z**2)).astype(np.float32)
    return ws.Volume(values, world_from_index=affine, unit="mm", anatomical=True, name="uptake")


def mixed(below: ws.Picture, values: np.ndarray, opacity: float) -> np.ndarray:
    rgba = HOT(values.ravel()).reshape(*values.shape, 4)
    alpha = np.where(np.isfinite(values), opacity * rgba[..., 3] / 0.5, 0)[..., None]
    return np.where(alpha > 0, rgba[..., :3], 0) * alpha + (1 - alpha) * below.rgba[..., :3]


@pytest.mark.parametrize("plane", ["axial", "coronal", (tuple(np.mean(SCAN.bounds, axis=0)), (1, 2, 3))])
@pytest.mark.parametrize("opacity", [1.0, 0.6])
def test_a_layer_lies_over_the_slice_at_the_same_places(plane, opacity):
    pet = uptake()
    below = ws.slice(SCAN, plane, size=(90, 80), window="abdomen")
    fused = ws.slice([SCAN, ws.Layer(pet, HOT, opacity=opacity)], plane, size=(90, 80), window="abdomen")
    right, down = (np.array(below.report[name]) * below.report["pixel"] for name in ("right", "down"))
    columns, rows = np.arange(90)[None, :, None], np.arange(80)[:, None, None]
    places = np.array(below.report["origin"]) + columns * right + rows * down
    index = (places - pet.world_from_index[:3, 3]) / 9.0
    values = trilinear(pet.samples, index)
    np.testing.assert_allclose(fused.rgba[..., :3], mixed(below, values, opacity), atol=2e-5)
    assert np.array_equal(fused.value, below.value, equal_nan=True)
    outside = ~np.isfinite(values)
    assert outside.any()
    assert (np.abs(fused.rgba - below.rgba).max(axis=2) > 0.1).any()
    assert np.array_equal(fused.rgba[outside], below.rgba[outside])
    assert [layer["name"] for layer in fused.report["shown"]] == [SCAN.name, "uptake"]


def trilinear(samples: np.ndarray, index: np.ndarray) -> np.ndarray:
    """Values at index positions (x, y, z); NaN outside."""
    last = np.array(samples.shape[::-1]) - 1
    inside = ((index >= -1e-9) & (index <= last + 1e-9)).all(axis=-1)
    first = np.clip(np.floor(index).astype(int), 0, last - 1)
    share = np.clip(index - first, 0, 1)
    total = np.zeros(index.shape[:-1])
    for corner in np.ndindex(2, 2, 2):
        weight = np.prod([share[..., a] if corner[a] else 1 - share[..., a] for a in range(3)], axis=0)
        x, y, z = (first[..., a] + corner[a] for a in range(3))
        total += weight * samples[z, y, x]
    return np.where(inside, total, np.nan)


def test_layers_that_are_not_shown_and_slabs():
    pet = uptake()
    alone = ws.slice(SCAN, size=(60, 50), thickness=20)
    for hidden in (ws.Layer(pet, HOT, visible=False), ws.Layer(pet, HOT, opacity=0)):
        assert np.array_equal(ws.slice([SCAN, hidden], size=(60, 50), thickness=20).rgba, alone.rgba)
    scene = ws.Scene([SCAN, ws.Layer(pet, HOT)])
    above = float(np.mean(SCAN.bounds, axis=0)[2]) + 25
    thin, thick = (ws.slice(scene, "axial", above, size=(60, 50), thickness=t).rgba for t in (0, 60))
    # The maximum across a slab that reaches the middle of the ball is hot in more places.
    assert (thick[..., 0] - thick[..., 2] > 0.3).sum() > (thin[..., 0] - thin[..., 2] > 0.3).sum()


def test_what_cannot_be():
    joint = ws.TransferFunction2D([0, 1], [0, 1], np.zeros((2, 2, 4)) + 0.5)
    with pytest.raises(ArgumentError, match="give the layer 'uptake' a TransferFunction"):
        ws.slice([SCAN, ws.Layer(uptake(), joint)])


def test_the_command_line_fuses(wavesplat, tmp_path):
    SCAN.save(tmp_path / "ct.nii.gz")
    uptake().save(tmp_path / "pet.nii.gz")
    options = ["--layer", f"{tmp_path / 'pet.nii.gz'}:hot:2,8", "--plane", "coronal", "--size", "80x70", "--colorbar"]
    done = wavesplat("slice", tmp_path / "ct.nii.gz", "-o", tmp_path / "fused.png", *options)
    assert done.returncode == 0, done.stderr
    hot = ws.TransferFunction.from_colormap("hot", clim=(2, 8), opacity="linear")
    volumes = [ws.open(tmp_path / name) for name in ("ct.nii.gz", "pet.nii.gz")]
    picture = ws.slice([volumes[0], ws.Layer(volumes[1], hot)], "coronal", size=(80, 70))
    picture.annotated(colorbar=True).save(tmp_path / "python.png")
    assert (tmp_path / "python.png").read_bytes() == (tmp_path / "fused.png").read_bytes()
