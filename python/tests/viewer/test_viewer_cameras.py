"""Cameras of the viewer: the first picture, standard views and "fit" have one frame, which keeps what is in view."""

import json
import threading
from dataclasses import replace

import numpy as np
import pytest
import viewer_fakes

import wavesplat as ws
from wavesplat._movie.seen import what_is_seen
from wavesplat._viewer.page_requests import questions
from wavesplat._viewer.session.session import Session
from wavesplat._viewer.session.state import ViewerState

SIZES = [(400, 300), (1280, 500), (390, 388), (300, 700)]


@pytest.fixture(scope="module")
def pelvis():
    return ViewerState.of(ws.Scene(ws.examples.ct_pelvis(), "ct-bone"))


def ask(state, question, size, **arguments):
    told, _ = questions.answer_of(state, question, {"width": size[0], "height": size[1], **arguments})
    return ws.Camera.from_json(told["camera"])


def same(one, other):
    for a, b in zip(json_numbers(one), json_numbers(other), strict=True):
        assert a == pytest.approx(b, rel=1e-9, abs=1e-6)


def json_numbers(camera):
    fields = camera.as_json()
    lens = [fields.get("parallel_scale", 0.0), fields.get("view_angle", 0.0)]
    return [*fields["position"], *fields["focal_point"], *fields["view_up"], *lens]


@pytest.mark.parametrize("size", SIZES, ids=str)
def test_the_first_picture_the_front_and_the_first_view_are_what_a_picture_of_that_size_has(pelvis, size):
    drawn = pelvis.scene.render(size=size, quality="draft", composite=pelvis.options["composite"]).camera
    front = ws.Camera.view(pelvis.scene, "front", aspect=3)
    same(pelvis.framed_first(size[0] / size[1]).camera, drawn)
    same(ask(pelvis, "framed", size, camera=front.as_json()), drawn)
    same(ask(pelvis, "first_view", size), drawn)


def test_a_view_from_elsewhere_goes_back_to_the_first_one_of_fields():
    state = ViewerState.of(ws.Scene(ws.examples.ripples(24)))
    drawn = state.scene.render(size=(400, 300), quality="draft").camera
    same(ask(state.with_camera(drawn.turned(azimuth=70)), "first_view", (400, 300)), drawn)


def test_a_camera_that_was_given_is_the_first_view_as_it_is(pelvis):
    given = pelvis.camera.turned(azimuth=20).zoomed(3)
    state = ViewerState.of(pelvis.scene, given)
    assert state.framed_first(2.5) is state
    assert ask(state, "first_view", (500, 200)) == given


@pytest.mark.parametrize("angle", [None, 30.0])
def test_a_frame_is_framed_again_and_any_other_camera_keeps_its_picture_in_view(pelvis, angle):
    seen = {"camera": pelvis.camera.as_json(), "aspect": 4 / 3}
    same(ask(pelvis, "kept_in_view", (300, 400), **seen), ask(pelvis, "framed", (300, 400), camera=seen["camera"]))
    near = pelvis.camera.turned(azimuth=33).zoomed(7)
    if angle is not None:
        near = replace(near, parallel_scale=None, view_angle=angle)
    kept = ask(pelvis, "kept_in_view", (300, 400), camera=near.as_json(), aspect=4 / 3)
    # The middles of the left and the right edge are at the edges of the narrower picture.
    before = near.unproject([[-0.5, 149.5], [399.5, 149.5]], depth_of(near), size=(400, 300))
    places, _ = kept.project(before, size=(300, 400))
    np.testing.assert_allclose(places, [[-0.5, 199.5], [299.5, 199.5]], atol=1e-6)
    # In a wider picture nothing has to change.
    assert ask(pelvis, "kept_in_view", (800, 300), camera=near.as_json(), aspect=4 / 3) == near


@pytest.mark.parametrize("angle", [None, 30.0])
def test_a_turned_camera_is_scaled_by_no_more_than_what_is_seen_needs(pelvis, angle):
    turned = ws.Camera.view(pelvis.scene, "front", view_angle=angle).turned(azimuth=20).zoomed(0.8)
    seen = what_is_seen(pelvis.scene, "over")[1]
    assert ask(pelvis, "kept_in_view", (600, 400), camera=turned.as_json(), aspect=2) == turned
    # A picture of a fifth of the width would cut it: its outermost points come to the sides.
    kept = ask(pelvis, "kept_in_view", (160, 400), camera=turned.as_json(), aspect=2)
    assert kept != turned
    columns = kept.project(seen, size=(160, 400))[0][:, 0] + 0.5
    assert max(160 - columns.min(), columns.max()) == pytest.approx(160, abs=1e-6)


def depth_of(camera):
    """Depth, along rays at the picture's left and right edge in the middle, of the plane through the focal point."""
    distance = np.linalg.norm(np.subtract(camera.position, camera.focal_point))
    if camera.view_angle is None:
        return distance
    return float(distance * np.hypot(1, 4 / 3 * np.tan(np.radians(camera.view_angle) / 2)))


def test_the_angle_of_view_stays(pelvis):
    eye = ws.Camera.view(pelvis.scene, "left", view_angle=30)
    framed = ask(pelvis, "framed", (400, 300), camera=eye.as_json())
    assert framed.view_angle == pytest.approx(30)
    same(ask(pelvis, "framed", (400, 300), camera=framed.as_json()), framed)


def test_hidden_layers_are_framed_by_the_box(pelvis):
    state = pelvis.patched([{"op": "replace", "path": "/layers/0/visible", "value": False}])
    expected = pelvis.camera.fitted(pelvis.scene, aspect=2, zoom=0.92)
    same(ask(state, "framed", (400, 200), camera=pelvis.camera.as_json()), expected)


def test_what_is_cut_off_is_not_framed(pelvis):
    lower, upper = pelvis.scene.bounds.tolist()
    box = {"lower": lower, "upper": [*upper[:2], (lower[2] + upper[2]) / 2], "space": "world"}
    cut = pelvis.patched([{"op": "add", "path": "/clip/-", "value": {"keep": box}}])
    whole, half = (ask(state, "framed", (300, 600), camera=pelvis.camera.as_json()) for state in (pelvis, cut))
    assert half.focal_point[2] < whole.focal_point[2] - 20


def test_a_session_frames_its_first_picture_for_the_view_that_shows_it():
    session = Session(viewer_fakes.state_of())
    try:
        first = session.state.camera
        page = viewer_fakes.Page(session)
        page.show(size=(48, 96))
        header, _ = page.at_rest()
        assert header["camera"]["parallel_scale"] > first.parallel_scale
        told, _ = page.wait(lambda header: header["type"] == "patch")
        assert told["operations"][0]["value"] == json.loads(json.dumps(session.state.camera.as_json()))
        # What was turned stays as it is in another view.
        page.patch(viewer_fakes.turned(session.state.camera, 30))
        turned = session.state.camera
        page.show(size=(96, 48))
        assert session.state.camera == turned
    finally:
        session.close()


def test_a_second_page_does_not_frame_the_picture_of_the_first_one():
    session = Session(viewer_fakes.state_of())
    try:
        first = session.state.camera
        viewer_fakes.Page(session)
        viewer_fakes.Page(session).show(size=(48, 96))
        assert session.state.camera == first
    finally:
        session.close()


def test_a_camera_is_told_while_a_small_picture_is_drawn(monkeypatch):
    session = Session(viewer_fakes.state_of())
    asked, goes_on = threading.Event(), threading.Event()

    def slow(*_):
        asked.set()
        assert goes_on.wait(20)
        return {}, b""

    monkeypatch.setitem(questions.ANSWERS, "preset_picture", slow)
    try:
        page = viewer_fakes.Page(session)
        page.client.receive({"type": "ask", "id": 1, "question": "preset_picture", "arguments": {}})
        assert asked.wait(20)
        header, _ = page.ask("first_view", 2, width=40, height=30)
        assert header["camera"] == session.state.first_view.camera.as_json()
        assert not any(header.get("id") == 1 for _, header, _ in page.messages)
    finally:
        goes_on.set()
        session.close()
