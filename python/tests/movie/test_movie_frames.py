"""The frames of a movie: turns, key frames, and the interpolation between them."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from test_camera import axes

import wavesplat as ws
from wavesplat._movie.seen import what_is_seen
from wavesplat._movie.timeline import Timeline, blended_clips, blended_look
from wavesplat._movie.turn import cameras_of
from wavesplat.errors import ArgumentError

VOLUME = ws.Volume(np.random.default_rng(5).integers(0, 255, (11, 21, 31)).astype(np.uint8), spacing=(1, 2, 3))
SOFT = ws.Look(transfer_function=ws.TransferFunction([(0, 0), (200, 0.5)], [(0, 1, 0, 0), (200, 1, 1, 1)]))
HARD = ws.Look(
    transfer_function=ws.TransferFunction([(100, 0), (100, 1)], [(50, 0, 0, 1)], opacity_unit=2),
    shading=ws.Shading(ambient=0.5, diffuse=0.5, specular=0),
)
SCENE = ws.Scene(VOLUME, SOFT)


# Turns.


def in_view(camera, points, aspect):
    """The largest share of the half height, or half width, that points reach."""
    right, up, back = axes(camera)
    seen = points - camera.position
    depth = -seen @ back
    half = camera.parallel_scale if camera.view_angle is None else depth * np.tan(np.radians(camera.view_angle) / 2)
    assert depth.min() > 0
    return np.maximum(np.abs(seen @ up) / half, np.abs(seen @ right) / (half * aspect)).max()


@given(
    st.floats(-90, 90),
    st.sampled_from([(0, 0, 1), (0, 1, 0), (1, -1, 0.5)]),
    st.none() | st.floats(10, 90),
    st.floats(0.4, 3),
    st.sampled_from([None, "left", "superior", "isometric"]),
)
def test_a_turn_has_one_scale_and_all_of_it_in_view(elevation, axis, view_angle, aspect, start):
    turn = ws.Turn(frames=23, elevation=elevation, axis=axis, view_angle=view_angle, start=start)
    cameras = cameras_of(turn, SCENE, None, aspect)
    assert len(cameras) == 23
    _, points = what_is_seen(SCENE, None)
    filled = []
    for camera in cameras:
        assert (camera.parallel_scale, camera.view_angle) == (cameras[0].parallel_scale, cameras[0].view_angle)
        assert camera.focal_point == cameras[0].focal_point
        np.testing.assert_allclose(
            np.linalg.norm(np.subtract(camera.position, camera.focal_point)),
            np.linalg.norm(np.subtract(cameras[0].position, cameras[0].focal_point)),
        )
        filled.append(in_view(camera, points, aspect))
    assert max(filled) <= 0.93
    assert max(filled) >= 0.85


def test_a_turn_goes_to_the_patients_left_and_all_the_way():
    cameras = cameras_of(ws.Turn(frames=4, start="front"), SCENE, None, 1.0)
    for camera, azimuth in zip(cameras, (0, 90, 180, 270), strict=True):
        np.testing.assert_allclose(axes(camera), axes(ws.Camera.orbit(VOLUME, azimuth)), atol=1e-12)
    back = cameras_of(ws.Turn(frames=3, degrees=-90, start="front"), SCENE, None, 1.0)
    for camera, azimuth in zip(back, (0, -45, -90), strict=True):
        np.testing.assert_allclose(axes(camera), axes(ws.Camera.orbit(VOLUME, azimuth)), atol=1e-12)


def test_a_turn_from_a_camera_keeps_it():
    start = ws.Camera.orbit(VOLUME, 20, 10, view_angle=30)
    cameras = cameras_of(ws.Turn(frames=6, start=start), SCENE, None, 1.0)
    assert cameras[0] == start
    for k, camera in enumerate(cameras):
        np.testing.assert_allclose(camera.position, start.turned(60 * k).position)
    further = ws.Turn(frames=2, start=start, azimuth=30, elevation=5, zoom=2)
    assert cameras_of(further, SCENE, None, 1.0)[0] == start.turned(30, 5).zoomed(2)
    named = cameras_of(ws.Turn(frames=2, start="front", azimuth=30, elevation=5), SCENE, None, 1.0)[0]
    np.testing.assert_allclose(axes(named), axes(start.turned(10, -5)), atol=1e-12)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"frames": 0}, "frames of the turn is 0"),
        ({"frames": 2.5}, "frames of the turn is 2.5"),
        ({"degrees": float("nan")}, "degrees of the turn is nan"),
        ({"elevation": "up"}, "elevation of the turn is 'up'"),
        ({"axis": (0, 0, 0)}, "axis of the turn"),
        ({"axis": 3}, "axis of the turn is 3; give three numbers"),
        ({"start": 3}, "start of the turn is 3"),
        ({"zoom": 0}, "zoom is 0"),
        ({"view_angle": 200}, "view_angle is 200"),
        ({"start": ws.Camera.view(VOLUME, "left"), "view_angle": 30}, "leave out view_angle"),
    ],
)
def test_turns_that_cannot_be(options, message):
    with pytest.raises(ArgumentError, match=message):
        ws.Turn(**options)


# Key frames.


def timeline(*keys, scene=SCENE, fps=10, name="over"):
    return Timeline(keys, scene, fps=fps, composite=None, name=name, aspect=1.0)


def test_key_frames_are_met_and_frames_are_evenly_in_time():
    cameras = [ws.Camera.orbit(VOLUME, angle) for angle in (0, 50, 200)]
    frames = timeline(*(ws.KeyFrame(t, camera=c) for t, c in zip((0, 0.5, 2), cameras, strict=True)))
    assert len(frames) == 21
    assert [frames[k].camera for k in (0, 5, 20)] == cameras
    # Nothing else changes: the scene is the same object, and so are its caches.
    assert frames[3].scene is SCENE


def test_what_no_key_frame_says_is_the_scenes():
    frames = timeline(ws.KeyFrame(0, look=SOFT), ws.KeyFrame(1, look=HARD), scene=ws.Scene(VOLUME, SOFT))
    assert len({frames[k].camera for k in range(11)}) == 1
    assert frames[0].scene.layers[0].look == SOFT
    assert frames[10].scene.layers[0].look == HARD
    assert frames[5].scene._cache is frames[0].scene._cache


def test_tracks_rest_before_their_first_and_after_their_last_key():
    frames = timeline(
        ws.KeyFrame(0, camera="front"),
        ws.KeyFrame(1, look=SOFT),
        ws.KeyFrame(2, look=HARD),
        ws.KeyFrame(3, camera="left"),
    )
    looks = [frames[k].scene.layers[0].look for k in range(31)]
    assert looks[0] == looks[10] == SOFT
    assert looks[20] == looks[30] == HARD
    assert looks[15].shading.ambient == pytest.approx((SOFT.shading.ambient + 0.5) / 2)


def test_times_of_a_series_are_the_nearest():
    series = ws.Series([VOLUME, VOLUME, VOLUME])
    frames = timeline(ws.KeyFrame(0, time=0), ws.KeyFrame(1, time=2), scene=ws.Scene(ws.Layer(series, SOFT)))
    assert [frames[k].scene.layers[0].time for k in range(11)] == [0, 0, 0, 1, 1, 1, 1, 1, 2, 2, 2]
    with pytest.raises(ArgumentError, match="time of a key frame is 3; the series has 0 to 2"):
        timeline(ws.KeyFrame(0, time=3), scene=ws.Scene(ws.Layer(series, SOFT)))
    with pytest.raises(ArgumentError, match="the scene has none"):
        timeline(ws.KeyFrame(0, time=0))


def test_looks_of_several_layers():
    scene = ws.Scene([ws.Layer(VOLUME, SOFT), ws.Layer(VOLUME, HARD)])
    frames = timeline(ws.KeyFrame(0, look=[SOFT, None]), ws.KeyFrame(1, look=[HARD, None]), scene=scene)
    assert [layer.look for layer in frames[10].scene.layers] == [HARD, HARD]
    with pytest.raises(ArgumentError, match="give one for each of the 2 layers"):
        timeline(ws.KeyFrame(0, look=[SOFT]), scene=scene)


def test_key_frames_clear_the_looks_of_further_layers():
    scene = ws.Scene([ws.Layer(VOLUME, SOFT), ws.Layer(VOLUME, "grey")])
    frames = timeline(ws.KeyFrame(0, look=[SOFT, "pet"]), ws.KeyFrame(1, look=[SOFT, "pet-hot-iron"]), scene=scene)
    for number in (0, 10):
        function = frames[number].scene.layers[1].look.transfer_function
        assert function(VOLUME.value_range)[:, 3].tolist() == [0, 1]


@pytest.mark.parametrize(
    ("keys", "message"),
    [
        ([ws.KeyFrame(0), ws.KeyFrame(0)], "key frame 1 is at 0 s, after one at 0 s"),
        ([ws.KeyFrame(0), ws.KeyFrame(1e9)], "give at most 432000"),
        ([ws.KeyFrame(0, camera="sideways")], "unknown view 'sideways'"),
        ([ws.KeyFrame(0, look="nothing")], "nothing"),
        (
            [ws.KeyFrame(0, clip=ws.Crop((0, 0, 0), (1, 1, 1))), ws.KeyFrame(1, clip=())],
            "clip of key frames is a Crop .world. and nothing",
        ),
        (
            [
                ws.KeyFrame(0, camera=ws.Camera.orbit(VOLUME)),
                ws.KeyFrame(1, camera=ws.Camera.orbit(VOLUME, view_angle=30)),
            ],
            "camera 0 is orthographic and camera 1 in perspective",
        ),
    ],
)
def test_key_frames_that_cannot_be(keys, message):
    with pytest.raises(ArgumentError, match=message):
        timeline(*keys)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"time_s": "now"}, "time_s of the key frame is 'now'"),
        ({"time_s": float("inf")}, "time_s of the key frame is inf"),
        ({"time_s": 0, "camera": 3}, "camera of the key frame is 3"),
        ({"time_s": 0, "clip": 3}, "clip is 3"),
        ({"time_s": 0, "time": 1.5}, "time of the key frame is 1.5"),
    ],
)
def test_one_key_frame_that_cannot_be(options, message):
    with pytest.raises(ArgumentError, match=message):
        ws.KeyFrame(**options)


# Between two looks.

CURVES = st.lists(st.tuples(st.integers(0, 8), st.floats(0, 1)), min_size=1, max_size=6).map(
    lambda nodes: sorted(nodes, key=lambda node: node[0])
)


@given(CURVES, CURVES, st.floats(0, 1))
def test_curves_mix_value_by_value(a, b, t):
    """Steps are included: curves are compared on both sides of every value."""
    looks = [
        ws.Look(transfer_function=ws.TransferFunction(nodes, [(v, x, x / 2, 0) for v, x in nodes], opacity_unit=1))
        for nodes in (a, b)
    ]
    mixed = blended_look(*looks, t, (1, 1, 1)).transfer_function
    values = np.concatenate([np.arange(-1, 10) + shift for shift in (-1e-7, 1e-7, 0.3, 0.5)])
    expected = (1 - t) * looks[0].transfer_function(values) + t * looks[1].transfer_function(values)
    np.testing.assert_allclose(mixed(values), expected, atol=1e-5)


def test_what_belongs_to_opacities_is_mixed_too():
    mixed = blended_look(SOFT, HARD, 0.5, (1, 2, 4))
    assert mixed.transfer_function.opacity_unit == pytest.approx(2)  # of 2, the mean of the spacings, and 2
    assert mixed.shading.diffuse == pytest.approx((SOFT.shading.diffuse + 0.5) / 2)
    assert blended_look(SOFT, SOFT, 0.5, (1, 1, 1)) is SOFT
    curved = ws.Look(
        transfer_function=ws.TransferFunction([(0, 1)], [(0, 1, 1, 1)], gradient_opacity=[(0, 0), (10, 1)])
    )
    assert blended_look(SOFT, curved, 0.5, (1, 1, 1)).transfer_function.gradient_opacity == ((0, 0.5), (10, 1))


def test_looks_that_do_not_mix():
    table = ws.TransferFunction2D([0, 1], [0, 1], np.ones((2, 2, 4)))
    other = ws.TransferFunction2D([0, 2], [0, 1], np.ones((2, 2, 4)))
    with pytest.raises(ArgumentError, match='composite="over" and "maximum"'):
        blended_look(SOFT, ws.Look(transfer_function=SOFT.transfer_function, composite="maximum"), 0.5, (1, 1, 1))
    with pytest.raises(ArgumentError, match="one of two"):
        blended_look(SOFT, ws.Look(transfer_function=table), 0.5, (1, 1, 1))
    with pytest.raises(ArgumentError, match="one grid"):
        blended_look(ws.Look(transfer_function=other), ws.Look(transfer_function=table), 0.5, (1, 1, 1))
    faint = ws.TransferFunction2D([0, 1], [0, 1], np.zeros((2, 2, 4)))
    mixed = blended_look(ws.Look(transfer_function=faint), ws.Look(transfer_function=table), 0.25, (1, 1, 1))
    np.testing.assert_allclose(mixed.transfer_function.rgba, 0.25)


def test_backgrounds_mix():
    black, white = (ws.Look(transfer_function=SOFT.transfer_function, background=name) for name in ("black", "#ffffff"))
    scene = ws.Scene(VOLUME, blended_look(black, white, 0.5, (1, 1, 1)))
    rgba = scene.render(ws.Camera.orbit(VOLUME, zoom=0.2), size=(8, 8)).rgba
    np.testing.assert_allclose(rgba[0, 0], (0.5, 0.5, 0.5, 1), atol=1e-3)


# Between two clips.


def test_clips_mix():
    a = (ws.ClipPlane((0, 0, 0), (0, 0, 2)), ws.Crop((0, 0, 0), (4, 4, 4)), ws.CutOut(ws.Crop((0, 0, 0), (2, 2, 2))))
    b = (ws.ClipPlane((0, 0, 10), (0, 3, 0)), ws.Crop((2, 0, 0), (4, 8, 4)), ws.CutOut(ws.Crop((2, 2, 2), (4, 4, 4))))
    plane, crop, cut = blended_clips(a, b, 0.5)
    assert plane.point == (0, 0, 5)
    np.testing.assert_allclose(np.divide(plane.normal, np.linalg.norm(plane.normal)), (0, 0.5**0.5, 0.5**0.5))
    assert (crop.lower, crop.upper) == ((1, 0, 0), (4, 6, 4))
    assert (cut.crop.lower, cut.crop.upper) == ((1, 1, 1), (3, 3, 3))
    with pytest.raises(ArgumentError, match="opposite"):
        blended_clips([ws.ClipPlane((0, 0, 0), (0, 0, 1))], [ws.ClipPlane((0, 0, 0), (0, 0, -1))], 0.5)
    with pytest.raises(ArgumentError, match=r"a Crop \(world\) and a Crop \(index\)"):
        blended_clips([ws.Crop((0, 0, 0), (1, 1, 1))], [ws.Crop((0, 0, 0), (1, 1, 1), space="index")], 0.5)


def test_a_plane_that_moves_uncovers_more_and_more():
    low, high = VOLUME.bounds
    keys = [ws.KeyFrame(t, clip=ws.ClipPlane(p, (0, 0, 1))) for t, p in ((0, low - 1), (1, high + 1))]
    frames = timeline(*keys)
    covered = [
        float(frames[k].scene.render(frames[k].camera, size=(24, 24), composite="maximum").rgba[..., 3].mean())
        for k in (0, 5, 10)
    ]
    assert covered[0] > covered[1] > covered[2] == 0
