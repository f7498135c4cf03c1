"""Lengths of rays inside of a box, a crop and between clip planes, measured by fog of a known density.

The lengths are those of `numpy_caster`, which cuts rays with planes of the world; no code is shared with the renderer.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from numpy_caster import Eye, Scene, length, unit

import wavesplat as ws

SIZE = (32, 24)
#: Texels of the renderer, and rays of the caster, along each side of a pixel.
READS = 8
OPACITY, OPACITY_UNIT = 0.06, 1.5
TAU = -np.log(1 - OPACITY) / OPACITY_UNIT


def _affine(*, mirrored=False):
    """World from index: anisotropic, sheared, turned about two axes, off the origin."""
    a, b = np.radians(25), np.radians(-40)
    turn = [[np.cos(a), -np.sin(a), 0], [np.sin(a), np.cos(a), 0], [0, 0, 1]]
    tilt = [[1, 0, 0], [0, np.cos(b), -np.sin(b)], [0, np.sin(b), np.cos(b)]]
    shear = [[1, 0, 0.2], [0, 1, -0.35], [0, 0, 1]]
    affine = np.eye(4)
    affine[:3, :3] = np.array(turn) @ tilt @ shear * [-0.8 if mirrored else 0.8, 1.3, 1.7]
    affine[:3, 3] = (-3, 5, 11)
    return affine


AFFINES = {"upright": np.diag([0.7, 0.8, 1.5, 1.0]), "sheared": _affine(), "mirrored": _affine(mirrored=True)}
SHAPE = (9, 11, 13)


def _middle(affine):
    return (affine @ [6, 5, 4, 1])[:3]


def _eyes(middle):
    return {
        "orthographic": Eye(middle + 40 * unit(np.array([1, 0.7, 0.5])), middle, (0, 0, 1), parallel_scale=9.0),
        "perspective": Eye(middle + 30 * unit(np.array([-0.3, 0.9, -0.6])), middle, (0, 0, 1), view_angle=35.0),
        "inside": Eye(np.add(middle, (0.4, -0.7, 0.9)), np.add(middle, (1, 2, 3)), (0, 0, 1), view_angle=110.0),
    }


#: Cuts of the box, as fields of the caster's scene and as options of the renderer.
def _cuts(middle):
    lower, upper = middle - [3.1, 2.2, 4.7], middle + 2.9
    between = ((1.3, 2.41, 0.7), (9.0, 9.5, 7.2))
    planes = ((middle, (0.3, 2.0, -0.4)), (middle - [1, 0, 1], (0.7, 0.1, 0.2)))
    return {
        "whole": ({}, {}),
        "index crop": ({"crop_index": between}, {"clip": ws.Crop(*between, space="index")}),
        "world crop": ({"crop_world": (lower, upper)}, {"clip": ws.Crop(lower, upper)}),
        "clip planes": ({"clip_planes": planes}, {"clip": [ws.ClipPlane(*plane) for plane in planes]}),
    }


def _camera(eye):
    lens = {"parallel_scale": eye.parallel_scale, "view_angle": eye.view_angle}
    return ws.Camera(eye.position, eye.focal_point, eye.view_up, **lens)


def _neighbourhood(pixels):
    """Each pixel's own rays and those of the pixels around it, [row, column, all of these]; the border is repeated."""
    pad = np.pad(pixels, ((1, 1), (1, 1), *[(0, 0)] * (pixels.ndim - 2)), mode="edge")
    height, width = pixels.shape[:2]
    return np.concatenate([pad[y : y + height, x : x + width] for y in range(3) for x in range(3)], axis=2)


def _check_fog(affine, eye_name, cut_name, *, wrong=1.0):
    """Check the opacity of fog against the lengths of rays, which `wrong` multiplies to test the test."""
    middle = _middle(affine)
    eye, (cut, options) = _eyes(middle)[eye_name], _cuts(middle)[cut_name]
    scene = replace(Scene(np.full(SHAPE, 100, np.uint8), affine), **cut)
    draw = {"size": SIZE, "shading": None, "quality": ws.Sampling(1, READS), **options}
    volume = ws.Volume(scene.samples, world_from_index=affine)
    fog = ws.TransferFunction([(0, OPACITY)], [(0, 1, 1, 1)], OPACITY_UNIT)
    got = ws.render(volume, fog, _camera(eye), **draw).rgba[..., 3]
    # The sum of ones is the length itself; it is read once, in the middle of the pixel.
    lengths = ws.render(volume, fog, _camera(eye), composite="sum", **draw).value / 100

    way, faces = length(scene, eye, SIZE, READS)
    alpha = 1 - np.exp(-TAU * wrong * way)
    want = alpha.mean(axis=2)
    faces = _neighbourhood(np.where(way[..., None] > 0, faces, -1))
    plain = np.all(faces == faces[:, :, :1], axis=(2, 3))
    full = plain & (way.min(axis=2) > 0)
    assert full.sum() >= 5, "rays that pass by the same faces as all around them"
    # Between texels 1/8 of a pixel apart the depth is linear or, in perspective, nearly so; what is left is rounding.
    error = np.abs(got - want)
    assert error[plain].max() < 1e-5
    middle_way = length(scene, eye, SIZE)[0][..., 0] * wrong
    np.testing.assert_allclose(lengths[full], middle_way[full], rtol=1e-5)
    # An edge of the box runs through the cells of a quarter of a pixel's reads or fewer; each is wrong by half of what
    # there is around it at most.
    around = np.ptp(_neighbourhood(alpha), axis=2)
    assert np.all(error <= around / 8 + 1e-5)


CASES = [
    (affine, eye, cut)
    for affine in AFFINES
    for eye in ("orthographic", "perspective", "inside")
    for cut in ("whole", "index crop", "world crop", "clip planes")
]


@pytest.mark.parametrize(("affine", "eye", "cut"), CASES)
def test_fog_is_as_thick_as_the_way_through_the_box_is_long(affine, eye, cut):
    _check_fog(AFFINES[affine], eye, cut)


def test_a_way_that_is_too_long_by_a_thousandth_is_noticed():
    with pytest.raises(AssertionError):
        _check_fog(AFFINES["sheared"], "orthographic", "whole", wrong=1.001)


def test_the_length_in_a_cube_is_known_on_paper():
    """The caster's lengths along an axis, along the diagonal, beside the cube, and from the inside."""
    cube = Scene(np.ones((3, 3, 3)), np.eye(4))
    for position, focal_point, want in (
        ((1, 1, 9), (1, 1, 1), 2.0),
        ((9, 9, 9), (1, 1, 1), 2 * 3**0.5),
        ((9, 1, 5), (9, 1, 1), 0.0),
        ((1, 1, 1.5), (1, 1, 0), 1.5),
    ):
        eye = Eye(position, focal_point, (0.1, 1, 0.2), view_angle=1.0)
        assert length(cube, eye, (1, 1))[0].item() == pytest.approx(want, abs=1e-12)
