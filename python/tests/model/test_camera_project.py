"""`Camera.project`: world points are where the renderer draws them, at the depth that it reports."""

from __future__ import annotations

import numpy as np
import pytest

import wavesplat as ws

SIZE = (97, 64)
POSES = {
    "orthographic": ws.Camera((40, 90, 35), (5, 4, 6), (0.1, 0, 1), parallel_scale=14),
    "perspective": ws.Camera((20, 40, 15), (5, 4, 6), (0.1, 0, 1), view_angle=35),
}
#: A bright voxel, index (z, y, x), and its place in the world.
VOXEL, SPACING = (9, 4, 5), (0.5, 1.0, 0.8)
PLACE = tuple(step * n for step, n in zip(SPACING, reversed(VOXEL), strict=True))


@pytest.mark.parametrize("pose", POSES)
def test_a_bright_voxel_is_drawn_where_it_is_said_to_be(pose):
    """micro.md, section 9, item 5: matplotlib on top of a picture."""
    samples = np.zeros((16, 12, 20), np.float32)
    samples[VOXEL] = 1
    volume = ws.Volume(samples, spacing=SPACING)
    grey = ws.TransferFunction([(0, 1.0)], [(0, 0, 0, 0), (1, 1, 1, 1)])
    camera = POSES[pose]
    light = ws.render(volume, grey, camera, size=SIZE, composite="maximum").value
    light = np.nan_to_num(light)
    rows, columns = np.mgrid[: SIZE[1], : SIZE[0]]
    drawn = [float((light * at).sum() / light.sum()) for at in (columns, rows)]
    ((column, row),), _ = camera.project([PLACE], size=SIZE)
    # The voxel's kernel is a symmetric blob of several pixels, so its centre of light is its place.
    assert np.hypot(drawn[0] - column, drawn[1] - row) < 0.15
    assert light[round(row), round(column)] > 0.8 * light.max()


@pytest.mark.parametrize("pose", POSES)
def test_depth_is_that_of_pictures(pose):
    """A wall that is opaque at once: points on it have the depth of the picture."""
    samples = np.zeros((41, 41, 41), np.float32)
    samples[:, :21] = 1
    volume = ws.Volume(samples, spacing=(0.5, 0.5, 0.5))
    wall = ws.TransferFunction([(0.45, 0.0), (0.5, 1.0)], [(0, 1, 1, 1)], opacity_unit=1e-3)
    camera = POSES[pose]
    picture = ws.render(volume, wall, camera, size=SIZE, shading=None, quality="high", depth=True)
    points = [(x, 10.25, z) for x in (2.0, 5.0, 9.0) for z in (3.0, 6.0, 11.0)]  # where the value is 0.5
    pixels, depths = camera.project(points, size=SIZE)
    inside = [n for n, (column, row) in enumerate(pixels) if 1 < column < SIZE[0] - 2 and 1 < row < SIZE[1] - 2]
    assert len(inside) >= 6
    for n in inside:
        column, row = np.rint(pixels[n]).astype(int)
        # Within the depth that a pixel of the slanted wall spans.
        assert abs(picture.depth[row, column] - depths[n]) < 0.5


@pytest.mark.parametrize("pose", POSES)
def test_corners_of_the_picture(pose):
    camera = POSES[pose]
    right, up = np.cross(np.subtract(camera.focal_point, camera.position), camera.view_up), None
    right /= np.linalg.norm(right)
    forward = np.subtract(camera.focal_point, camera.position)
    distance = np.linalg.norm(forward)
    up = np.cross(right, forward / distance)
    half = 14 if camera.view_angle is None else distance * np.tan(np.radians(35) / 2)
    corner = np.add(camera.focal_point, half * up - half * SIZE[0] / SIZE[1] * right)
    pixels, _ = camera.project([camera.focal_point, corner], size=SIZE)
    # Half a pixel beyond the centre of the first one is the corner of the picture.
    np.testing.assert_allclose(pixels, [[(SIZE[0] - 1) / 2, (SIZE[1] - 1) / 2], [-0.5, -0.5]], atol=1e-9)


def test_what_is_behind_a_perspective_camera_is_nowhere():
    camera = ws.Camera((0, 10, 0), (0, 0, 0), (0, 0, 1), view_angle=30)
    pixels, depths = camera.project([(0, 10, 0), (1, 11, 1), (0, 0, 0)], size=(10, 10))
    assert np.isnan(pixels[:2]).all()
    assert np.isnan(depths[:2]).all()
    assert depths[2] == 10


@pytest.mark.parametrize(
    ("points", "size", "said"),
    [
        ([0, 0, 0], (4, 4), r"points is a list; give finite world positions, shape \(n, 3\)"),
        ([(0, 0, np.nan)], (4, 4), "finite world positions"),
        ([(0, 0, 0)], (4, 0), r"size is \(4, 0\); give \(width, height\)"),
        ([(0, 0, 0)], 4, "size is 4; give"),
    ],
)
def test_bad_arguments(points, size, said):
    with pytest.raises(ws.errors.ArgumentError, match=said):
        POSES["perspective"].project(points, size=size)


@pytest.mark.parametrize("pose", POSES)
def test_unproject_is_the_inverse(pose):
    points = np.random.default_rng(3).uniform(-10, 15, (200, 3))
    pixels, depths = POSES[pose].project(points, size=SIZE)
    assert np.abs(POSES[pose].unproject(pixels, depths, size=SIZE) - points).max() < 1e-11


def test_unproject_takes_the_depths_of_a_picture():
    """A wall across the view: what its pixels see lies on it."""
    wall = ws.Volume(np.ones((4, 40, 40), np.float32), spacing=(1, 1, 1))
    camera = ws.Camera((20, 20, 90), (20, 20, 3), (0, 1, 0), view_angle=20)
    opaque = ws.TransferFunction([(0, 1.0), (1, 1.0)], [(0, 1, 1, 1)])
    picture = ws.render(wall, opaque, camera, size=SIZE, depth=True)
    rows, columns = np.nonzero(np.isfinite(picture.depth))
    seen = camera.unproject(np.stack([columns, rows], axis=1), picture.depth[rows, columns], size=SIZE)
    assert len(seen) > 1000
    # Half is absorbed in the first slab.
    assert np.ptp(seen[:, 2]) < 1e-4
    assert 2.8 < seen[0, 2] < 3


def test_unproject_says_what_is_wrong():
    camera = POSES["perspective"]
    with pytest.raises(ws.errors.ArgumentError, match=r"pixels has shape \(3,\)"):
        camera.unproject([1, 2, 3], 1, size=SIZE)
    with pytest.raises(ws.errors.ArgumentError, match=r"depths \(3,\)"):
        camera.unproject([(1, 2), (3, 4)], [1, 2, 3], size=SIZE)
    assert np.isnan(camera.unproject([(1, 2)], [np.nan], size=SIZE)).all()
