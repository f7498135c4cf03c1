"""Geometry in the viewer: listed in its state, shown and hidden, and told where the pointer is."""

import json
import time

import numpy as np
import pytest
import viewer_fakes

import wavesplat as ws
from wavesplat._viewer.page_requests import questions
from wavesplat._viewer.session.session import Session
from wavesplat._viewer.session.state import ViewerState, changes_picture
from wavesplat.errors import ArgumentError

#: Looks along -y, 10 world units high, so that a pixel of 100 is 0.1.
FRONT = ws.Camera((0, 100, 0), (0, 0, 0), (0, 0, 1), parallel_scale=5)
EYE = ws.Camera((0, 20, 0), (0, 0, 0), (0, 0, 1), view_angle=30)
SQUARE = np.array([[-2, 0, -2], [2, 0, -2], [2, 0, 2], [-2, 0, 2]])
NEARER = np.array([0, 2, 0])
TRIANGLES = [[0, 1, 2], [0, 2, 3]]


#: Nothing of values below 1 is seen, and values of 2 and more are opaque.
CLEAR_BELOW = ws.Look(transfer_function=ws.TransferFunction([(1, 0), (2, 1)], [(1, 0, 0, 0), (2, 1, 1, 1)]))


def volume_of(samples):
    """A volume of 11 x 11 x 11 samples around the origin of the world."""
    world_from_index = np.eye(4)
    world_from_index[:3, 3] = -5
    return ws.Volume(np.asarray(samples, np.float32), world_from_index=world_from_index)


def clear():
    """A volume in which nothing is seen."""
    return volume_of(np.zeros((11, 11, 11)))


def state_of(*geometry, camera=FRONT, volume=None, **options):
    scene = ws.Scene(clear() if volume is None else volume, CLEAR_BELOW, geometry=geometry, **options)
    return ViewerState.of(scene, camera, {"composite": "over"})


def seen(state, x=0.5, y=0.5):
    answer, _ = questions.answer_of(state, "shape", {"x": x, "y": y, "width": 100, "height": 100})
    return answer["shape"]


def set_visible(number, visible):
    return {"op": "replace", "path": f"/geometry/{number}/visible", "value": visible}


def test_a_state_lists_the_geometry():
    shapes = [ws.Points([[0, 0, 0], [1, 0, 0]]), ws.Points([[0, 0, 0]], name="cells"), ws.Frame(visible=False)]
    assert state_of(*shapes).document["geometry"] == [
        {"kind": "points", "name": "points 1", "count": 2, "visible": True, "id": 2},
        {"kind": "points", "name": "cells", "count": 1, "visible": True, "id": 3},
        {"kind": "frame", "name": "frame 1", "count": 1, "visible": False, "id": 4},
    ]
    assert state_of().document["geometry"] == []


def test_hidden_shapes_are_not_drawn_and_stay_in_files():
    ball = ws.Points([[0, 0, 0]], radius=2, color="red")
    shown = state_of(ball)
    hidden = shown.patched([set_visible(0, False)])
    assert changes_picture(shown, hidden)
    pictures = [state.scene.render(FRONT, size=(20, 20)).rgba for state in (shown, hidden, state_of())]
    assert not np.array_equal(pictures[0], pictures[1])
    assert np.array_equal(pictures[1], pictures[2])
    assert hidden.scene.geometry[0].positions is ball.positions
    (kept,) = hidden.file_document()["geometry"]
    assert kept["points"]["visible"] is False
    assert "visible=False" in questions.answer_of(hidden, "code", {"as": "python", "width": 9, "height": 9})[0]["text"]
    assert hidden.patched([set_visible(0, True)]).scene.geometry[0].visible


def test_scenes_with_hidden_shapes_load_again(tmp_path):
    scene = ws.Scene(ws.examples.ripples(8), geometry=[ws.Points([[0, 0, 0]], visible=False), ws.Frame()])
    scene.save(tmp_path / "scene.json")
    assert [shape.visible for shape in ws.Scene.load(tmp_path / "scene.json").geometry] == [False, True]
    assert scene.render(size=(9, 9)).report["geometry"][0]["visible"] is False


def test_hidden_shapes_are_in_no_camera():
    scales = [
        ws.Scene(clear(), CLEAR_BELOW, geometry=geometry).render(size=(9, 9)).camera.parallel_scale
        for geometry in ([], [ws.Points([[20, 0, 0]], visible=False)], [ws.Points([[20, 0, 0]])])
    ]
    assert scales[0] == scales[1] < scales[2]


@pytest.mark.parametrize(
    ("path", "value", "said"),
    [
        ("/geometry/0/visible", 1, "field 'visible' is 1; it must be true or false"),
        ("/geometry/0/name", "other", "only its field 'visible' can be changed"),
        ("/geometry/0", 3, r"geometry\[0\] is 3"),
        ("/geometry", {}, "must be a list"),
        ("/geometry/0/id", 9, r"field 'id' is 9, which is not open here"),
    ],
)
def test_other_changes_of_the_geometry_are_refused(path, value, said):
    with pytest.raises(ArgumentError, match=said):
        state_of(ws.Frame()).patched([{"op": "replace", "path": path, "value": value}])


def test_files_say_what_is_hidden_and_the_shapes_stay():
    state = state_of(ws.Points([[0, 0, 0]]), ws.Frame())
    hidden = state.patched([set_visible(1, False)])
    file = questions.answer_of(hidden, "code", {"as": "state", "width": 9, "height": 9})[0]["text"]
    for text in (file, json.dumps(hidden.document)):
        again = questions.state_from_text(state, text)
        assert [shape["visible"] for shape in again.document["geometry"]] == [True, False]
        assert again.scene.geometry[0] is state.scene.geometry[0]
    with pytest.raises(ArgumentError, match="the file has 2 shapes, and 1 are open"):
        questions.state_from_text(state_of(ws.Frame()), file)


def test_a_page_hides_and_shows():
    session = Session(state_of(ws.Points([[0, 0, 0]], radius=2)))
    page = viewer_fakes.Page(session)
    try:
        page.patch(set_visible(0, False))
        found, _ = page.ask("shape", x=0.5, y=0.5, width=100, height=100)
        assert found["shape"] is None
        page.patch(set_visible(0, True))
        found, _ = page.ask("shape", number=2, x=0.5, y=0.5, width=100, height=100)
        assert found["shape"]["name"] == "points 1"
    finally:
        session.close()


@pytest.mark.parametrize("camera", [FRONT, EYE], ids=["parallel", "perspective"])
def test_a_ball_is_met_where_it_begins(camera):
    cells = ws.Points([[3, 0, 0], [0, 1, 0]], radius=[1, 2], labels=["A", "B"], values=[5, 7], name="cells")
    found = seen(state_of(cells, camera=camera))
    assert found == {
        "kind": "points",
        "name": "cells",
        "part": 1,
        "label": "B",
        "value": 7.0,
        "point": pytest.approx([0, 3, 0]),
        "text": "points cells, B, 7",
    }
    assert seen(state_of(cells, camera=camera), y=0.1) is None


def test_discs_have_their_size_in_pixels():
    spots = state_of(ws.Points([[0, 0, 0]], size=20))
    assert seen(spots, x=0.59)["text"] == "points 1, point 0"
    assert seen(spots, x=0.62) is None


@pytest.mark.parametrize("camera", [FRONT, EYE], ids=["parallel", "perspective"])
def test_values_of_surfaces_are_those_at_the_place(camera):
    plane = ws.Surface(SQUARE, TRIANGLES, values=[0, 4, 4, 0])  # the value is x + 2
    state = state_of(plane, camera=camera)
    assert seen(state)["value"] == pytest.approx(2)
    left = seen(state, x=0.6)
    assert left["value"] == pytest.approx(left["point"][0] + 2)
    assert left["point"][1] == pytest.approx(0, abs=1e-12)
    assert seen(state, y=0.02) is None


def test_random_triangles_are_met_as_by_determinants():
    rng = np.random.default_rng(4)
    vertices, faces = rng.normal(0, 2, (60, 3)), rng.permutation(60).reshape(-1, 3)
    state = state_of(ws.Surface(vertices, faces))
    n_met = 0
    for x, y in rng.uniform(0.2, 0.8, (40, 2)):
        origin, direction = np.array([-(10 * x - 5), 100, 5 - 10 * y]), np.array([0.0, -1, 0])
        depths = []
        for a, b, c in vertices[faces]:
            t, u, v = np.linalg.solve(np.stack([-direction, b - a, c - a], axis=1), origin - a)
            if u >= 0 and v >= 0 and u + v <= 1:
                depths.append(t)
        found = seen(state, x, y)
        assert (found is None) == (not depths)
        if found:
            n_met += 1
            assert 100 - found["point"][1] == pytest.approx(min(depths))
    assert n_met > 10


def test_tubes_and_strokes():
    paths = [[[-4, 0, 2], [4, 0, 2]], [[-4, 0, 0], [4, 0, 0]]]
    values = [0, 8, 10, 18]  # of the second path x + 14
    tubes = seen(state_of(ws.Lines(paths, values=values, radius=1)))
    assert (tubes["part"], tubes["value"]) == (1, pytest.approx(14))
    assert tubes["point"] == pytest.approx([0, 1, 0])
    assert tubes["text"] == "lines 1, path 1, 14"
    strokes = state_of(ws.Lines(paths, width=10))
    assert seen(strokes, y=0.54)["part"] == 1
    assert seen(strokes, y=0.57) is None


def test_holes_are_looked_through():
    plane = ws.Surface(SQUARE + NEARER, TRIANGLES, values=[np.nan, np.nan, np.nan, 1], name="torn")
    behind = ws.Points([[0, 0, 0]], radius=1)
    assert seen(state_of(plane, behind))["name"] == "points 1"


def test_translucent_shapes_are_told_where_nothing_more_opaque_is():
    skin = ws.Surface(SQUARE + NEARER, TRIANGLES, opacity=0.3, name="skin")
    bone = ws.Points([[0, 0, 0]], radius=1, name="bone")
    both = state_of(skin, bone)
    assert seen(both)["name"] == "bone"
    assert seen(both, x=0.65)["name"] == "skin"
    assert seen(state_of(skin.with_(opacity=0), ws.Points([[0, 0, 0]], color=[(1, 0, 0, 0)]))) is None


def test_matter_hides_shapes():
    samples = np.zeros((11, 11, 11))
    samples[:, 7:9, :] = 3  # opaque where y is 2 and 3
    behind, before = ws.Points([[0, -2, 0]], radius=1, name="behind"), ws.Points([[2, 5, 0]], radius=1, name="before")
    state = state_of(behind, before, volume=volume_of(samples))
    assert seen(state) is None
    assert seen(state, x=0.3)["name"] == "before"
    assert seen(state.replaced({**state.document, "render": {**state.document["render"], "composite": "maximum"}}))


@pytest.mark.parametrize(
    "clip",
    [
        ws.ClipPlane((0, 1, 0), (0, -1, 0)),
        ws.ClipPlane((0, -3, 0), (0, -1, 0)),
        ws.Crop((-5, -5, -5), (5, 1.5, 5)),
        ws.Crop((0, 0, 0), (10, 6.5, 10), space="index"),
        ws.CutOut(ws.Crop((4, 4, 4), (10, 10, 10), space="index")),
    ],
)
@pytest.mark.parametrize("is_clipped", [False, True])
@pytest.mark.parametrize(
    "shape",
    [
        ws.Points([[0, 0, 0]], radius=2),
        ws.Points([[0, 0, 0]], size=40),
        ws.Lines([[-3, 0, 0], [3, 0, 0]], radius=2),
        ws.Surface(SQUARE + NEARER, TRIANGLES),
        ws.SlicePlane(clear(), "xz"),
    ],
    ids=repr,
)
def test_clips_and_depths_are_those_of_the_picture(shape, is_clipped, clip):
    state = state_of(shape.with_(clipped=is_clipped), clip=clip)
    picture = state.scene.render(FRONT, size=(101, 101), depth=True, composite="over")
    found, depth = seen(state), picture.depth[50, 50]
    assert (found is None) == np.isnan(depth)
    if found:
        assert 100 - found["point"][1] == pytest.approx(depth, abs=1e-3)


def test_the_eye_in_a_ball_sees_its_far_side():
    eye = ws.Camera((0, 1, 0), (0, 0, 0), (0, 0, 1), view_angle=30)
    assert seen(state_of(ws.Points([[0, 0, 0]], radius=2), camera=eye))["point"] == pytest.approx([0, -2, 0])


def test_slices_tell_the_value_of_their_volume():
    ramp = volume_of(np.mgrid[-5:6, -5:6, -5:6][2] + 10)  # the value is x + 10
    found = seen(state_of(ws.SlicePlane(ramp, "xz")), x=0.7)
    assert (found["kind"], found["value"]) == ("slice plane", 8.0)
    assert found["point"] == pytest.approx([-2, 0, 0], abs=0.51)


def test_slices_on_cuts_are_told_where_they_are_seen():
    ramp = volume_of(np.mgrid[-5:6, -5:6, -5:6][2] + 10)
    clips = [ws.ClipPlane((0, 2, 0), (0, -1, 0)), ws.ClipPlane((1, 0, 0), (-1, 0, 0))]
    state = state_of(
        ws.Points([[9, 9, 9]]), ws.SlicePlane(plane="cuts"), ws.SlicePlane(plane="xy"), volume=ramp, clip=clips
    )
    found = seen(state, x=0.7, y=0.3)
    assert (found["name"], found["value"]) == ("slice plane 1", 8.0)
    assert found["point"] == pytest.approx([-2, 2, 2], abs=0.51)
    assert seen(state, x=0.3, y=0.3) is None  # the other clip has taken the face away
    assert seen(state_of(ws.SlicePlane(plane="cuts"))) is None


def test_frames_are_told_by_name():
    state = state_of(ws.Frame(box=((-3, -3, -3), (3, 3, 3))))
    assert seen(state, x=0.2)["text"] == "frame 1"
    assert seen(state) is None


def test_a_hundred_thousand_points_are_quick():
    rng = np.random.default_rng(1)
    state = state_of(ws.Points(rng.uniform(-4, 4, (100_000, 3)), radius=0.05))
    seen(state)
    times = []
    for _ in range(3):
        begun = time.perf_counter()
        assert seen(state) is not None
        times.append(time.perf_counter() - begun)
    assert min(times) < 2.0


@pytest.mark.parametrize("arguments", [{"x": 2, "y": 0}, {"x": "a", "y": 0}, {"x": 0.5, "y": 0.5, "width": 0}])
def test_places_outside_of_the_picture_are_refused(arguments):
    with pytest.raises(ArgumentError):
        questions.answer_of(state_of(ws.Frame()), "shape", {"width": 9, "height": 9, **arguments})
