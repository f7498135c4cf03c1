import pickle

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import wavesplat as ws
from wavesplat._model.camera.views import PLANES, VIEWS, planes_of
from wavesplat.errors import ArgumentError

VOLUME = ws.Volume(np.zeros((11, 21, 31), np.uint8), spacing=(1, 2, 3))  # 30 x 40 x 30 world units


def axes(camera):
    """Right, up and towards the eye, in the world."""
    back = np.subtract(camera.position, camera.focal_point)
    back /= np.linalg.norm(back)
    right = np.cross(camera.view_up, back)
    right /= np.linalg.norm(right)
    return right, np.cross(back, right), back


# In RAS, +x is the patient's right, +y anterior, +z superior.
#: Name of a view -> the world directions to the right and to the top of its picture, and towards the eye.
VIEWS_ALONG_AXES = [
    ("anterior", (-1, 0, 0), (0, 0, 1), (0, 1, 0)),
    ("posterior", (1, 0, 0), (0, 0, 1), (0, -1, 0)),
    ("left", (0, -1, 0), (0, 0, 1), (-1, 0, 0)),
    ("right", (0, 1, 0), (0, 0, 1), (1, 0, 0)),
    ("superior", (1, 0, 0), (0, 1, 0), (0, 0, 1)),
    ("inferior", (-1, 0, 0), (0, 1, 0), (0, 0, -1)),
    ("front", (-1, 0, 0), (0, 0, 1), (0, 1, 0)),
    ("back", (1, 0, 0), (0, 0, 1), (0, -1, 0)),
    ("top", (1, 0, 0), (0, 1, 0), (0, 0, 1)),
    ("bottom", (-1, 0, 0), (0, 1, 0), (0, 0, -1)),
    ("xy", (1, 0, 0), (0, -1, 0), (0, 0, -1)),
    ("xz", (1, 0, 0), (0, 0, -1), (0, 1, 0)),
    ("yz", (0, 1, 0), (0, 0, -1), (-1, 0, 0)),
]


@pytest.mark.parametrize(("name", "right", "up", "front"), VIEWS_ALONG_AXES)
def test_named_views(name, right, up, front):
    camera = ws.Camera.view(VOLUME, name)
    for got, expected in zip(axes(camera), (right, up, front), strict=True):
        np.testing.assert_array_equal(got, expected)
    np.testing.assert_array_equal(camera.focal_point, VOLUME.bounds.mean(axis=0))


def test_views_of_planes_are_those_of_slices():
    body = ws.Volume(VOLUME.samples, spacing=VOLUME.spacing, anatomical=True)
    for volume in (VOLUME, body):
        for name, plane in zip(("yz", "xz", "xy"), planes_of(is_anatomical=volume.is_anatomical)[::-1], strict=True):
            for got, expected in zip(axes(ws.Camera.view(volume, name)), PLANES[plane].axes, strict=True):
                np.testing.assert_array_equal(got, expected)
            assert ws.Camera.view(ws.Scene(volume), name) == ws.Camera.view(volume, name)


def test_every_view_is_tested():
    assert set(VIEWS) == {name for name, *_ in VIEWS_ALONG_AXES} | {"isometric"}


def test_the_isometric_view_shows_three_faces_and_what_is_up():
    right, up, front = axes(ws.Camera.view(VOLUME, "isometric"))
    assert front[0] < 0 > front[1]
    assert front[2] == pytest.approx(0.5)
    assert right[2] == pytest.approx(0, abs=1e-12)
    assert up[2] > 0
    np.testing.assert_allclose(front, axes(ws.Camera.orbit(VOLUME, *VIEWS["isometric"]))[2])


def test_azimuth_turns_to_the_patients_left_and_elevation_lifts():
    _, _, front = axes(ws.Camera.orbit(VOLUME, 30, 40))
    assert front[0] < 0 < front[1]
    assert front[2] == pytest.approx(np.sin(np.radians(40)))


@given(st.floats(-720, 720), st.floats(-90, 90), st.none() | st.floats(1, 150), st.floats(0.2, 5))
def test_the_whole_volume_is_just_in_view(azimuth, elevation, view_angle, aspect):
    camera = ws.Camera.orbit(VOLUME, azimuth, elevation, view_angle=view_angle, aspect=aspect, fit="view")
    corners = np.array(np.meshgrid(*VOLUME.bounds.T)).reshape(3, 8).T - camera.position
    right, up, back = axes(camera)
    depth = -corners @ back
    half = camera.parallel_scale if view_angle is None else depth * np.tan(np.radians(camera.view_angle) / 2)
    filled = np.maximum(np.abs(corners @ up) / half, np.abs(corners @ right) / (half * aspect))
    assert filled.max() == pytest.approx(1, abs=1e-6)
    assert depth.min() > 0


def test_zoom_narrows_the_view_but_keeps_the_eye():
    wide, near = (ws.Camera.orbit(VOLUME, 20, 10, zoom=zoom) for zoom in (1, 4))
    assert near.parallel_scale == pytest.approx(wide.parallel_scale / 4)
    wide, near = (ws.Camera.orbit(VOLUME, 20, 10, zoom=zoom, view_angle=40) for zoom in (1, 4))
    assert near.position == wide.position
    assert np.tan(np.radians(near.view_angle / 2)) == pytest.approx(np.tan(np.radians(20)) / 4)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"zoom": 0}, "zoom is 0"),
        ({"zoom": float("nan")}, "zoom is nan"),
        ({"aspect": -1}, "aspect is -1"),
        ({"view_angle": 180}, "view_angle is 180"),
        ({"azimuth": float("inf")}, "azimuth is inf"),
        ({"fit": "tight"}, """fit is 'tight'; it is "turn" or "view\""""),
    ],
)
def test_bad_orbits_are_refused(arguments, message):
    with pytest.raises(ArgumentError, match=message):
        ws.Camera.orbit(VOLUME, **arguments)


def test_unknown_views_list_the_known():
    with pytest.raises(ArgumentError, match="unknown view 'sideways'.*anterior"):
        ws.Camera.view(VOLUME, "sideways")


@pytest.mark.parametrize(
    ("position", "up", "lens", "message"),
    [
        ((0, 0, 0), (0, 0, 1), {"parallel_scale": 1}, "position and focal point"),
        ((0, 0, 5), (0, 0, 1), {"parallel_scale": 1}, "parallel to the view"),
        ((0, 5, 0), (0, 0, 1), {}, "parallel_scale.*or view_angle"),
        ((0, 5, 0), (0, 0, 1), {"parallel_scale": 1, "view_angle": 30}, "one of the two"),
        ((0, 5, 0), (0, 0, 1), {"view_angle": 0}, "view_angle"),
        ((0, 5), (0, 0, 1), {"view_angle": 30}, "position of the camera is .*three numbers"),
    ],
)
def test_bad_cameras_are_refused(position, up, lens, message):
    with pytest.raises(ArgumentError, match=message):
        ws.Camera(position, (0, 0, 0), up, **lens)


def test_cameras_are_values():
    camera = ws.Camera.orbit(VOLUME, 20, 10, view_angle=40)
    assert pickle.loads(pickle.dumps(camera)) == camera  # noqa: S301 - our own bytes
    assert camera == ws.Camera(
        np.array(camera.position), camera.focal_point, camera.view_up, view_angle=camera.view_angle
    )
