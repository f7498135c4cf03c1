"""The renderer against `numpy_caster`, a ray caster that shares nothing with it and so detects the usual mistakes.

Volumes and curves are soft, so that both converge; errors at hard edges are for `test_quality.py`.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from numpy_caster import Eye, Light, Scene, face_normals, over, phong, project, trilinear, unit

import wavesplat as ws

SIZE = (48, 40)
SOFT = [(10, 0), (60, 0.05), (200, 0.3)]
COLOR = [(0, 0, 0.2, 0.6), (80, 0.9, 0.5, 0.2), (200, 1, 1, 0.9)]
GREY = ws.TransferFunction([(0, 1)], [(0, 0, 0, 0), (300, 1, 1, 1)])
#: Step of the caster, a sixth of a sample: with half of it pictures change by less than 1e-5 on average.
STEP = 0.2

#: World from index: anisotropic, sheared, turned about two axes, off the origin.
SHEARED = np.array(
    [
        [0.725043, -0.420876, -0.233447, -3.0],
        [0.338095, 0.902572, 0.774437, 5.0],
        [0.0, -0.835624, 1.684717, 11.0],
        [0.0, 0.0, 0.0, 1.0],
    ]
)


def _blobs(shape=(16, 18, 20)):
    """Seven Gaussian blobs that look different from every side, and are nearly 0 at the faces."""
    rng = np.random.default_rng(3)
    z, y, x = np.mgrid[: shape[0], : shape[1], : shape[2]]
    total = np.zeros(shape)
    for _ in range(7):
        center = (0.3 + 0.4 * rng.random(3)) * (np.array(shape[::-1]) - 1)
        radius, height = rng.uniform(2, 3.5), rng.uniform(60, 160)
        squared = (x - center[0]) ** 2 + (y - center[1]) ** 2 + (z - center[2]) ** 2
        total += height * np.exp(-squared / (2 * radius**2))
    return total.astype(np.float32)


SCENE = Scene(_blobs(), SHEARED, SOFT, COLOR)


def _eye(towards, view_angle=None):
    middle = (SHEARED @ [9.5, 8.5, 7.5, 1])[:3] + 0.3
    scale = 14.0 if view_angle is None else None
    return Eye(middle + 45 * unit(np.array(towards)), middle, (0.1, 0.2, 1), scale, view_angle)


#: Eyes that look along different axes of the grid, and from both ends.
EYES = {
    "orthographic": _eye((1, 0.7, 0.5)),
    "orthographic, from below": _eye((-0.3, 0.9, -0.6)),
    "perspective": _eye((1, 0.7, 0.5), 30.0),
    "perspective, from below": _eye((-0.3, 0.9, -0.6), 30.0),
}


def _draw(scene, eye, quality="high", **options):
    """The renderer's picture of a scene of the caster, seen from the caster's eye."""
    camera = ws.Camera(
        eye.position, eye.focal_point, eye.view_up, parallel_scale=eye.parallel_scale, view_angle=eye.view_angle
    )
    volume = ws.Volume(scene.samples, world_from_index=scene.world_from_index)
    return ws.render(volume, camera=camera, size=SIZE, quality=quality, **options)


def _draw_over(scene, eye, **options):
    light = scene.light
    # The caster lights with the differences of neighbours and one headlight.
    shading = light and ws.Shading.headlight(
        ambient=light.ambient,
        diffuse=light.diffuse,
        specular=light.specular,
        specular_power=light.power,
        gradient_offset=light.gradient_offset,
    )
    curves = ws.TransferFunction(scene.opacity, scene.color, scene.opacity_unit)
    return _draw(scene, eye, ws.Sampling(3, 2), look=curves, shading=shading, **options).rgba


def _check_over(got, scene, eye):
    """Check that a picture agrees with the caster's picture of the scene.

    Texels lie half a pixel apart and sheets a third of a slice, and both errors are of second order; measured are 70 to
    77 dB and mean errors of 5e-5 to 1e-4. The limits are half as strict; half a sample of shift is 42 dB and 4e-3.
    """
    difference = got - over(scene, eye, SIZE, step=STEP)
    assert -10 * np.log10(np.mean(difference[..., :3] ** 2)) > 66
    assert np.abs(difference).mean() < 2e-4


@pytest.mark.parametrize(
    ("eye", "light"),
    [
        *[pytest.param(eye, None, id=eye) for eye in EYES],
        *[pytest.param(eye, Light(), id=f"{eye}, lit") for eye in EYES],
        pytest.param("perspective", Light(0.2, 0.5, 0.4, 25.0, 0.5), id="perspective, glossy"),
    ],
)
def test_soft_pictures_are_those_of_the_caster(eye, light):
    scene = replace(SCENE, light=light)
    got = _draw_over(scene, EYES[eye])
    assert got[..., 3].max() > 0.9, "some of it is dense"
    assert 0.1 < got[..., 3].mean() < 0.4, "some of it is not"
    _check_over(got, scene, EYES[eye])


@pytest.mark.parametrize("opacity_unit", [0.5, 4.0])
def test_opacity_belongs_to_a_thickness(opacity_unit):
    """The same curve makes thick or thin fog, by the unit of its opacity."""
    scene = replace(SCENE, opacity_unit=opacity_unit, opacity=[(10, 0), (60, 0.03 * opacity_unit), (200, 0.2)])
    _check_over(_draw_over(scene, EYES["orthographic"]), scene, EYES["orthographic"])


def _cuts():
    """Cuts through the middle of the blobs, not along samples."""
    middle = np.asarray(EYES["orthographic"].focal_point)
    box = ((3.3, 2.41, 0.7), (11.6, 15.5, 12.2))
    lower, upper = middle - (4.1, 6.2, 5.7), np.add(middle, (6.1, 3.9, 4.3))
    planes = ((middle, (0.3, 2.0, -0.4)),)
    return {
        "index crop": ({"crop_index": box}, {"clip": ws.Crop(*box, space="index")}),
        "world crop": ({"crop_world": (lower, upper)}, {"clip": ws.Crop(lower, upper)}),
        "clip plane": ({"clip_planes": planes}, {"clip": [ws.ClipPlane(*plane) for plane in planes]}),
    }


@pytest.mark.parametrize("light", [None, Light()], ids=["unlit", "lit"])
@pytest.mark.parametrize("cut", _cuts())
@pytest.mark.every_pair
def test_cut_pictures_are_those_of_the_caster(cut, light):
    """A cut face ends abruptly, so at its outline pixels differ by what lies between two texels; the others do not.

    Across an outline the picture changes by most of its range within a texel, half a pixel, so these pixels may be
    wrong by a fraction of it: 46 dB on the whole, 52 to 77 measured. They are few: half of all numbers are as near as
    without a cut.
    """
    kept, options = _cuts()[cut]
    eye, scene = EYES["orthographic"], replace(SCENE, light=light, **kept)
    want = over(scene, eye, SIZE, step=STEP)
    difference = _draw_over(scene, eye, **options) - want
    assert -10 * np.log10(np.mean(difference[..., :3] ** 2)) > 46
    assert np.median(np.abs(difference[want[..., 3] > 0])) < 3e-4
    if light is None:
        assert np.abs(over(SCENE, eye, SIZE, step=1.0) - want).max() > 0.3, "something is cut off"


def _inner(numbers):
    """Mask of the pixels all of whose neighbours have a number too."""
    pad = np.pad(np.isfinite(numbers), 1)
    height, width = numbers.shape
    return np.all([pad[y : y + height, x : x + width] for y in range(3) for x in range(3)], axis=0)


def _check_projection(got, scene, eye, operator):
    """Check that numbers agree with the caster's, away from the outline, where rays are cut off between two texels.

    Errors are shares of the picture's range. Mean and sum are smooth: errors of second order, 6e-5 on average,
    2e-3 at most. Where the largest value passes from one blob to another, the picture has a crease, which
    interpolation between texels rounds off: 2.5e-4 on average. The smallest value of these blobs lies where rays
    enter or leave, so it has many creases and little range: 4e-4 on average, 3e-2 at one. Half a sample of shift is
    7e-3 to 2e-2.
    """
    most, on_average = {"maximum": (1e-2, 4e-4), "minimum": (5e-2, 1e-3)}.get(operator, (3e-3, 2e-4))
    want = project(scene, eye, SIZE, operator, step=0.1)
    inner = _inner(want) & np.isfinite(got)
    assert inner.sum() > 500
    error = np.abs(got - want)[inner] / np.ptp(want[inner])
    assert error.max() < most
    assert error.mean() < on_average


@pytest.mark.parametrize("operator", ["maximum", "minimum", "mean", "sum"])
@pytest.mark.parametrize("eye", ["orthographic", "perspective"])
def test_projections_are_those_of_the_caster(eye, operator):
    value = _draw(SCENE, EYES[eye], look=GREY, composite=operator).value
    _check_projection(value, SCENE, EYES[eye], operator)


# Tests that the caster detects mistakes.


def _wrong_scenes():
    """Changed scenes, each of which a renderer with a usual mistake would draw instead."""
    shifted = SHEARED.copy()
    shifted[:3, 3] += 0.5 * SHEARED[:3, 0]
    # Slices lie across the axis of which a ray crosses most; without 1 / cos a slab is as thick as their distance.
    normals = [unit(normal) for normal in face_normals(SCENE.edges)]
    forward = EYES["orthographic"].axes()[2]
    crossed = [abs(forward @ n) / abs(n @ edge) for n, edge in zip(normals, SCENE.edges, strict=True)]
    cos = abs(forward @ normals[int(np.argmax(crossed))])
    spacings = [np.linalg.norm(edge) for edge in SCENE.edges]
    return {
        "half a sample of shift": {"world_from_index": shifted},
        "a flipped axis": {"samples": SCENE.samples[:, :, ::-1]},
        "no 1 / cos": {"opacity_unit": np.prod(spacings) ** (1 / 3) / cos},
        "the unit of the first axis": {"opacity_unit": spacings[0]},
        "opacity instead of its power": {"opacity": [(v, 1 - np.exp(-a)) for v, a in SOFT]},
    }


@pytest.mark.parametrize("mistake", _wrong_scenes())
def test_wrong_pictures_are_noticed(mistake):
    got = _draw_over(SCENE, EYES["orthographic"])
    with pytest.raises(AssertionError):
        _check_over(got, replace(SCENE, **_wrong_scenes()[mistake]), EYES["orthographic"])


@pytest.mark.parametrize("operator", ["maximum", "minimum", "mean", "sum"])
@pytest.mark.parametrize("mistake", ["half a sample of shift", "a flipped axis"])
def test_wrong_projections_are_noticed(mistake, operator):
    got = _draw(SCENE, EYES["orthographic"], look=GREY, composite=operator).value
    with pytest.raises(AssertionError):
        _check_projection(got, replace(SCENE, **_wrong_scenes()[mistake]), EYES["orthographic"], operator)


@pytest.mark.parametrize("mistake", [{"diffuse": 0.6}, {"power": 12.0}, {"gradient_offset": 0.5}])
def test_wrong_light_is_noticed(mistake):
    scene = replace(SCENE, light=Light())
    got = _draw_over(scene, EYES["orthographic"])
    with pytest.raises(AssertionError):
        _check_over(got, replace(scene, light=replace(Light(), **mistake)), EYES["orthographic"])


def test_a_picture_upside_down_is_noticed():
    got = _draw_over(SCENE, EYES["orthographic"])
    for wrong in (got[::-1], got[:, ::-1]):
        with pytest.raises(AssertionError):
            _check_over(wrong, SCENE, EYES["orthographic"])


# Tests of the caster's own parts against results by hand.


def test_trilinear_interpolation_is_exact_for_what_is_trilinear():
    z, y, x = np.mgrid[:4, :5, :6].astype(float)
    index = np.random.default_rng(1).uniform(0, (5, 4, 3), (50, 3))
    i, j, k = index.T
    np.testing.assert_allclose(trilinear(x * y * z + 2 * x - y, index), i * j * k + 2 * i - j, atol=1e-12)


def test_light_from_the_eye_on_a_slanted_surface():
    """At 60 degrees the cosine is 1/2, and the reflection is 120 degrees off the eye, so there is no highlight."""
    light = Light(ambient=0.1, diffuse=0.6, specular=0.3, power=2.0)
    eye = np.array([0.0, 0.0, 1.0])
    color = np.array([1.0, 0.5, 0.0])
    slanted = np.array([np.sqrt(3), 0.0, 1.0])
    np.testing.assert_allclose(phong(light, color, slanted, eye, eye), 0.4 * color)
    np.testing.assert_allclose(phong(light, color, -eye, eye, eye), 0.7 * color + 0.3)
    np.testing.assert_allclose(phong(light, color, 0 * eye, eye, eye), 0.1 * color)
