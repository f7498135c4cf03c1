"""Cameras between key frames, as files, turned, fitted, and those of PyVista."""

import json
from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from test_camera import VOLUME, axes

import wavesplat as ws
from wavesplat._model.camera.views import VIEWS
from wavesplat.errors import ArgumentError, FileError

ANGLES = st.floats(-400, 400)
VIEW_ANGLES = st.none() | st.floats(1, 150)


def same_place(one, other, tolerance=1e-9):
    for got, expected in zip(axes(one), axes(other), strict=True):
        np.testing.assert_allclose(got, expected, atol=tolerance)
    for name in ("position", "focal_point", "parallel_scale", "view_angle"):
        got, expected = getattr(one, name), getattr(other, name)
        assert (got is None) == (expected is None)
        if got is not None:
            np.testing.assert_allclose(got, expected, atol=tolerance * 100)


@given(ANGLES, ANGLES, ANGLES, ANGLES, VIEW_ANGLES)
def test_a_turn_goes_on_with_the_orbit(azimuth, elevation, further, higher, view_angle):
    start = ws.Camera.orbit(VOLUME, azimuth, elevation, view_angle=view_angle)
    end = ws.Camera.orbit(VOLUME, azimuth + further, elevation + higher, view_angle=view_angle)
    same_place(start.turned(further, higher), end)


@pytest.mark.parametrize("name", VIEWS)
def test_turns_from_views_keep_their_scale(name):
    view = ws.Camera.view(VOLUME, name)
    assert view.turned() is view
    turned = view.turned(30, 120, 15)
    assert turned.parallel_scale == view.parallel_scale
    assert np.linalg.norm(np.subtract(turned.position, turned.focal_point)) == pytest.approx(
        np.linalg.norm(np.subtract(view.position, view.focal_point))
    )
    same_place(view.turned(90).turned(90).turned(90).turned(90), view)


def test_quarter_turns_are_exact():
    front = ws.Camera.view(VOLUME, "front")
    np.testing.assert_array_equal(axes(front.turned(90))[2], (-1, 0, 0))
    np.testing.assert_array_equal(axes(front.turned(0, 90))[2], (0, 0, 1))
    # The eye rolls clockwise: its top points to where the picture's right was.
    np.testing.assert_array_equal(axes(front.turned(roll=90))[1], axes(front)[0])


@given(st.lists(st.tuples(ANGLES, ANGLES), min_size=2, max_size=6), VIEW_ANGLES, st.floats(0.2, 5))
def test_an_orbit_has_one_scale_and_shows_all(angles, view_angle, aspect):
    cameras = [ws.Camera.orbit(VOLUME, *pair, view_angle=view_angle, aspect=aspect) for pair in angles]
    corners = np.array(np.meshgrid(*VOLUME.bounds.T)).reshape(3, 8).T
    distances = []
    for camera in cameras:
        assert (camera.parallel_scale, camera.view_angle) == (cameras[0].parallel_scale, cameras[0].view_angle)
        assert camera.focal_point == cameras[0].focal_point
        distances.append(np.linalg.norm(np.subtract(camera.position, camera.focal_point)))
        right, up, back = axes(camera)
        seen = corners - camera.position
        depth = -seen @ back
        half = camera.parallel_scale if view_angle is None else depth * np.tan(np.radians(camera.view_angle) / 2)
        assert depth.min() > 0
        assert np.maximum(np.abs(seen @ up) / half, np.abs(seen @ right) / (half * aspect)).max() <= 1 + 1e-9
    np.testing.assert_allclose(distances, distances[0])


@pytest.mark.parametrize("view_angle", [None, 40])
def test_the_scale_of_an_orbit_is_no_larger_than_it_must_be(view_angle):
    """A corner of the volume that reaches the top of the picture touches its edge."""
    corner = VOLUME.bounds[1] - VOLUME.bounds.mean(axis=0)
    radius = np.linalg.norm(corner)
    camera = ws.Camera.orbit(VOLUME, 0, 0, view_angle=view_angle)
    if view_angle is None:
        assert camera.parallel_scale == pytest.approx(radius)
    else:
        distance = np.linalg.norm(np.subtract(camera.position, camera.focal_point))
        assert np.sin(np.radians(camera.view_angle / 2)) == pytest.approx(radius / distance)


def test_points_of_an_orbit_keep_its_focal_point():
    points = VOLUME.bounds[0] + [[0, 0, 0], [10, 4, 2], [3, 8, 9]]
    cameras = [ws.Camera.orbit(VOLUME, angle, points=points) for angle in (0, 45, 200)]
    assert {camera.focal_point for camera in cameras} == {cameras[0].focal_point}
    assert {camera.parallel_scale for camera in cameras} == {cameras[0].parallel_scale}


@given(ANGLES, ANGLES, VIEW_ANGLES, st.floats(0.2, 5), st.floats(0.5, 4))
def test_fitted_is_the_tight_orbit_of_that_side(azimuth, elevation, view_angle, aspect, zoom):
    far = ws.Camera.orbit(VOLUME, azimuth, elevation, view_angle=view_angle, zoom=1)
    tight = ws.Camera.orbit(VOLUME, azimuth, elevation, view_angle=view_angle, aspect=aspect, zoom=zoom, fit="view")
    same_place(far.fitted(VOLUME, aspect=aspect, zoom=zoom), tight, 1e-7)


def test_what_has_a_box_can_be_looked_at():
    scene = SimpleNamespace(bounds=VOLUME.bounds)
    assert ws.Camera.view(VOLUME, "left").fitted(scene) == ws.Camera.view(VOLUME, "left")
    box = type("Scene", (), {"bounds": VOLUME.bounds})()
    assert ws.Camera.orbit(box, 20, 10) == ws.Camera.orbit(VOLUME, 20, 10)
    with pytest.raises(ArgumentError, match="volume is .*; give a wavesplat.Volume"):
        ws.Camera.view(VOLUME, "left").fitted(SimpleNamespace(bounds=3))


def test_zooming():
    flat = ws.Camera.orbit(VOLUME, 20, 10)
    assert flat.zoomed(4).parallel_scale == flat.parallel_scale / 4
    assert flat.zoomed(4).position == flat.position
    deep = ws.Camera.orbit(VOLUME, 20, 10, view_angle=40)
    same_place(deep.zoomed(3), ws.Camera.orbit(VOLUME, 20, 10, view_angle=40, zoom=3))
    with pytest.raises(ArgumentError, match="zoom is 0"):
        flat.zoomed(0)


# Between key frames.


def keys(*angles, **options):
    return [ws.Camera.orbit(VOLUME, *pair, **options) for pair in angles]


@pytest.mark.parametrize("view_angle", [None, 30])
@pytest.mark.parametrize("closed", [False, True])
def test_paths_go_through_their_keys(view_angle, closed):
    cameras = keys((0, 0), (70, 40), (150, -20), (90, 0), view_angle=view_angle)
    cameras[2] = cameras[2].zoomed(3)
    per_key = 7
    n = per_key * 4 if closed else per_key * 3 + 1
    way = ws.Camera.interpolate(cameras, n, closed=closed)
    assert len(way) == n
    assert [way[k * per_key] for k in range(4)] == cameras


def test_a_closed_turn_is_the_orbit():
    """Keys a quarter of a turn apart: the eye goes on evenly, through the longest way that is clear."""
    cameras = keys((0, 10), (90, 10), (180, 10), (270, 10))
    way = ws.Camera.interpolate(cameras, 36, closed=True)
    for k, camera in enumerate(way):
        # Quaternion splines leave the cone of constant elevation a little.
        assert np.degrees(np.arccos(min(1, axes(camera)[2] @ axes(ws.Camera.orbit(VOLUME, 10 * k, 10))[2]))) < 1
    level = ws.Camera.interpolate(keys((0, 0), (90, 0), (180, 0), (270, 0)), 36, closed=True)
    for k, camera in enumerate(level):
        same_place(camera, ws.Camera.orbit(VOLUME, 10 * k, 0), 1e-7)


def test_opposite_keys_turn_as_an_azimuth_grows():
    way = ws.Camera.interpolate(keys((0, 0), (180, 0)), 5)
    same_place(way[1], ws.Camera.orbit(VOLUME, 45, 0), 1e-7)
    way = ws.Camera.interpolate(keys((200, 0), (20, 0)), 3)
    same_place(way[1], ws.Camera.orbit(VOLUME, 290, 0), 1e-7)


@pytest.mark.parametrize("closed", [False, True])
def test_paths_are_smooth(closed):
    """Just before and just after a key the velocities of the direction and of the focal point agree."""
    cameras = keys((0, 0), (70, 40), (150, -20), (100, 10))
    cameras[1] = ws.Camera(
        np.add(cameras[1].position, 20), np.add(cameras[1].focal_point, 20), cameras[1].view_up, parallel_scale=9
    )
    per_key = 2000
    n = per_key * 4 if closed else per_key * 3 + 1
    way = ws.Camera.interpolate(cameras, n, closed=closed)
    at = [per_key, 2 * per_key] + ([0, 3 * per_key] if closed else [])
    for part in (lambda camera: np.array(axes(camera)).ravel(), lambda camera: np.array(camera.focal_point)):
        for k in at:
            before, here, after = part(way[k - 1]), part(way[k]), part(way[(k + 1) % n])
            np.testing.assert_allclose(per_key * (after - here), per_key * (here - before), atol=0.1)


@given(st.lists(st.tuples(ANGLES, st.floats(-80, 80), st.floats(0.1, 10)), min_size=2, max_size=5), VIEW_ANGLES)
def test_nothing_overshoots(angles, view_angle):
    cameras = [ws.Camera.orbit(VOLUME, a, e, view_angle=view_angle).zoomed(z) for a, e, z in angles]
    way = ws.Camera.interpolate(cameras, 23)
    name = "parallel_scale" if view_angle is None else "view_angle"
    bounds = [getattr(camera, name) for camera in cameras]
    assert all(min(bounds) * (1 - 1e-9) <= getattr(camera, name) <= max(bounds) * (1 + 1e-9) for camera in way)
    for camera in way:
        np.testing.assert_allclose(camera.focal_point, cameras[0].focal_point, atol=1e-9)


def test_zooms_are_even_in_their_logarithm():
    near, far = keys((0, 0), (0, 0))
    way = ws.Camera.interpolate([far, near.zoomed(16)], 5)
    scales = np.array([camera.parallel_scale for camera in way])
    np.testing.assert_allclose(scales[1:] / scales[:-1], 0.5)


def test_paths_that_cannot_be():
    flat, deep = ws.Camera.orbit(VOLUME), ws.Camera.orbit(VOLUME, view_angle=30)
    with pytest.raises(ArgumentError, match="camera 0 is orthographic and camera 2 in perspective"):
        ws.Camera.interpolate([flat, flat, deep], 5)
    with pytest.raises(ArgumentError, match="camera 1 is 3"):
        ws.Camera.interpolate([flat, 3], 5)
    with pytest.raises(ArgumentError, match="give the key frames"):
        ws.Camera.interpolate([], 5)
    with pytest.raises(ArgumentError, match="n is 0"):
        ws.Camera.interpolate([flat], 0)
    assert ws.Camera.interpolate([flat], 3) == [flat] * 3
    assert ws.Camera.interpolate([flat, flat], 3)[1].parallel_scale == pytest.approx(flat.parallel_scale)


# Paths as JSON.


@pytest.mark.parametrize("view_angle", [None, 33.3])
def test_json_gives_the_same_camera(tmp_path, view_angle):
    camera = ws.Camera.orbit(VOLUME, 12.3, 4.5, view_angle=view_angle)
    assert ws.Camera.from_json(camera.as_json()) == camera
    assert ws.Camera.from_json(json.dumps(camera.as_json())) == camera
    camera.save(tmp_path / "camera.json")
    assert ws.Camera.load(tmp_path / "camera.json") == camera
    assert camera.as_json()["version"] == 1


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"position": None}, "field 'position' is None; it must be three numbers"),
        ({"position": [1, 2]}, "field 'position'.*three numbers"),
        ({"view_up": [1, 2, "x"]}, "field 'view_up'"),
        ({"view_up": [0, 0, float("nan")]}, "field 'view_up'"),
        ({"view_angle": 30}, "one of the fields 'parallel_scale' and 'view_angle'"),
        ({"parallel_scale": None}, "one of the fields 'parallel_scale' and 'view_angle'"),
        ({"parallel_scale": "3"}, "field 'parallel_scale' is '3'"),
        ({"parallel_scale": -1}, "camera: .*parallel_scale"),
        ({"zoom": 3}, "unknown field 'zoom'"),
        ({"version": 2}, "field 'version' is 2"),
    ],
)
def test_what_is_wrong_with_a_document_is_named(tmp_path, change, message):
    document = ws.Camera.orbit(VOLUME).as_json() | change
    with pytest.raises(ArgumentError, match=message):
        ws.Camera.from_json(document)
    path = tmp_path / "camera.json"
    path.write_text(json.dumps(document))
    with pytest.raises(ArgumentError, match=f"{message}.*camera.json"):
        ws.Camera.load(path)


def test_what_is_no_document(tmp_path):
    document = ws.Camera.orbit(VOLUME).as_json()
    del document["focal_point"]
    with pytest.raises(ArgumentError, match="field 'focal_point' is missing"):
        ws.Camera.from_json(document)
    with pytest.raises(ArgumentError, match="not JSON"):
        ws.Camera.from_json("{")
    with pytest.raises(ArgumentError, match="document is 3"):
        ws.Camera.from_json(3)
    with pytest.raises(FileError):
        ws.Camera.load(tmp_path / "none.json")


# PyVista's cameras.

CPOS = [(1.5, 500, 2), (0.25, 0, 0), (0, 0, 2)]


class VtkCamera:
    """A stand-in for vtkCamera, with the methods that return its position."""

    def __init__(self, *, parallel=False, horizontal=False):
        self.GetPosition, self.GetFocalPoint, self.GetViewUp = (lambda part=part: tuple(part) for part in CPOS)
        self.GetParallelProjection = lambda: int(parallel)
        self.GetParallelScale = lambda: 12.5
        self.GetViewAngle = lambda: 25.0
        self.GetUseHorizontalViewAngle = lambda: int(horizontal)


def test_cameras_of_pyvista():
    expected = ws.Camera(*CPOS, view_angle=25)
    assert ws.Camera.from_pyvista(VtkCamera()) == expected
    assert ws.Camera.from_pyvista(SimpleNamespace(camera=VtkCamera())) == expected
    assert ws.Camera.from_pyvista(VtkCamera(parallel=True)) == ws.Camera(*CPOS, parallel_scale=12.5)
    assert ws.Camera.from_pyvista(VtkCamera(), parallel_scale=3) == ws.Camera(*CPOS, parallel_scale=3)
    assert ws.Camera.from_pyvista(CPOS) == ws.Camera(*CPOS, view_angle=30)
    assert ws.Camera.from_pyvista(np.array(CPOS), view_angle=40) == ws.Camera(*CPOS, view_angle=40)
    with pytest.raises(ArgumentError, match="horizontal"):
        ws.Camera.from_pyvista(VtkCamera(horizontal=True))
    with pytest.raises(ArgumentError, match="give one of them"):
        ws.Camera.from_pyvista(CPOS, view_angle=3, parallel_scale=3)
    for bad in ("xy", 3, None, [1, 2, 3], [(1, 2, 3)]):
        with pytest.raises(ArgumentError, match="give a pyvista.Plotter"):
            ws.Camera.from_pyvista(bad)


def test_cpos_is_exact():
    camera = ws.Camera(*CPOS, view_angle=30)
    assert camera.cpos == tuple(tuple(map(float, part)) for part in CPOS)
    assert ws.Camera.from_pyvista(camera.cpos) == camera
