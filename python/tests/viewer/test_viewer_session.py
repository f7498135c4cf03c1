"""The session: the latest change wins, two frames in flight, exact pictures at rest that newer changes cancel."""

import gc
import io
import threading
import time
import weakref
from pathlib import Path

import numpy as np
import pytest
import viewer_fakes
from PIL import Image
from viewer_fakes import Page

import wavesplat as ws
from wavesplat._viewer.session import session as session_module
from wavesplat._viewer.session.pace import Pace, Settings, rungs_of
from wavesplat._viewer.session.picturing import picture_of
from wavesplat._viewer.session.session import Session
from wavesplat.errors import ArgumentError


@pytest.fixture
def session():
    made = Session(viewer_fakes.state_of())
    yield made
    made.close()


def pixels(payload):
    return np.asarray(Image.open(io.BytesIO(payload)).convert("RGBA"))


def test_the_picture_at_rest_is_that_of_render_to_the_byte(session):
    page = Page(session)
    page.show()
    header, payload = page.at_rest()
    assert header["format"] == "png"
    state = session.state
    picture = state.scene.render(state.camera, size=(64, 48), **state.options)
    assert np.array_equal(pixels(payload), np.asarray(picture))
    assert header["camera"] == state.document["camera"]


def test_any_changes_end_in_the_picture_of_the_last_one(session):
    page = Page(session)
    page.show()
    camera = session.state.camera
    for degrees in range(0, 60, 3):
        page.patch(viewer_fakes.turned(camera, degrees), moving=True)
        time.sleep(0.002)
    page.patch({"op": "replace", "path": "/render/kernel", "value": "bspline2"})
    _, payload = page.at_rest()
    picture = ws.render(session.state.scene, camera=camera.turned(azimuth=57), size=(64, 48), kernel="bspline2")
    assert np.array_equal(pixels(payload), np.asarray(picture))


def test_what_moves_comes_as_jpeg_with_the_camera_that_it_shows(session):
    page = Page(session)
    page.show()
    page.at_rest()
    camera = session.state.camera
    page.patch(viewer_fakes.turned(camera, 30), moving=True)
    header, payload = page.wait(lambda header: header["type"] == "frame" and header["seq"] == 1)
    assert header["format"] == "jpeg"
    assert not header["at_rest"]
    assert header["camera"] == camera.turned(azimuth=30).as_json()
    assert Image.open(io.BytesIO(payload)).format == "JPEG"
    # Without another change the view comes to rest by itself.
    page.at_rest(seq=1)


def test_a_page_that_confirms_nothing_gets_two_frames_and_costs_nothing(session):
    page = Page(session, confirms=False)
    page.show()
    camera = session.state.camera
    for degrees in range(40):
        page.patch(viewer_fakes.turned(camera, degrees), moving=True)
        time.sleep(0.01)
    time.sleep(0.3)
    assert len(page.frames()) == 2
    used = []
    while min(used, default=9.0) >= 0.1 and len(used) < 5:  # threads of other tests may end meanwhile
        begun = time.process_time()
        time.sleep(0.5)
        used.append(time.process_time() - begun)
    assert min(used) < 0.1, used


def test_a_slow_renderer_is_never_more_than_one_request_behind(session, monkeypatch):
    drawn = []
    original = picture_of

    def slow(state, *args, **more):
        drawn.append(state)
        time.sleep(0.05)
        return original(state, *args, **more)

    monkeypatch.setattr(session_module, "picture_of", slow)
    page = Page(session)
    page.show()
    page.at_rest()
    camera = session.state.camera
    drawn.clear()
    sent = []
    for degrees in range(1, 61):
        page.patch(viewer_fakes.turned(camera, degrees), moving=True)
        sent.append(time.monotonic())
        time.sleep(0.01)
    page.at_rest()
    # Changes for 0.6 s at 0.05 s a frame: far fewer than 60 frames, each of the newest state when it began.
    moving = page.frames(at_rest=False)
    assert len(moving) < 30
    assert [header["seq"] for header, _ in moving] == sorted({header["seq"] for header, _ in moving})


def test_a_picture_at_rest_is_given_up_for_what_comes_next(session, monkeypatch):
    began, went_on = threading.Event(), []
    original = picture_of

    def endless(state, view, size, *, progress=None, **more):
        if progress is None or more.get("psnr") is not None:
            return original(state, view, size, progress=progress, **more)
        began.set()
        until = time.monotonic() + 5
        while time.monotonic() < until:
            if progress(0.5) is False:
                went_on.append(time.monotonic())
                raise ws.errors.CancelledError("given up")
            time.sleep(0.001)
        return original(state, view, size, **more)

    page = Page(session)
    page.show()
    page.at_rest()
    monkeypatch.setattr(session_module, "picture_of", endless)
    page.patch(viewer_fakes.turned(session.state.camera, 5))
    assert began.wait(5)
    changed = time.monotonic()
    page.patch(viewer_fakes.turned(session.state.camera, 9))
    while not went_on:
        assert time.monotonic() - changed < 5
        time.sleep(0.001)
    assert went_on[0] - changed < 0.2


def test_what_is_hidden_comes_back(session):
    page = Page(session)
    page.show()
    _, before = page.at_rest()
    page.patch({"op": "replace", "path": "/layers/0/visible", "value": False})
    header, payload = page.at_rest()
    assert "no layer of the scene is visible" in header["notes"]
    assert pixels(payload)[..., :3].max() == 0
    time.sleep(0.3)  # in which errors are measured
    page.patch({"op": "replace", "path": "/layers/0/visible", "value": True})
    assert page.at_rest()[1] == before


def test_a_renderer_that_fails_is_told_and_goes_on(session, monkeypatch):
    original = picture_of
    page = Page(session)
    page.show()
    page.at_rest()
    monkeypatch.setattr(session_module, "picture_of", lambda *_, **__: 1 / 0)
    page.patch(viewer_fakes.turned(session.state.camera, 5))
    failed, _ = page.wait(lambda header: header["type"] == "failed")
    assert "the renderer failed: ZeroDivisionError" in failed["message"]
    monkeypatch.setattr(session_module, "picture_of", original)
    page.patch(viewer_fakes.turned(session.state.camera, 6))
    page.at_rest()


def test_windows_share_the_state_and_have_their_own_views(session):
    one, other = Page(session), Page(session)
    one.show(size=(64, 48))
    other.show("z", size=(40, 30))
    one.patch(viewer_fakes.turned(session.state.camera, 12))
    header, _ = other.wait(lambda header: header["type"] == "patch")
    assert header["cause"] == "other view"
    assert header["operations"][0]["path"] == "/camera"
    one.at_rest()
    other.at_rest("z", seq=0)
    assert not other.frames(view="3d")
    one.client.close()
    assert session.n_clients == 1


def test_python_changes_are_told(session):
    page = Page(session)
    page.show()
    session.change(session.state.with_camera(session.state.camera.turned(azimuth=20)))
    header, _ = page.wait(lambda header: header["type"] == "patch")
    assert header["cause"] == "python"
    assert header["operations"][0]["value"]["camera"] == session.state.document["camera"]


def test_changes_that_cannot_be_are_refused_by_their_number(session):
    page = Page(session)
    before = session.state.document
    page.patch({"op": "replace", "path": "/layers/0/opacity", "value": 3})
    failed, _ = page.wait(lambda header: header["type"] == "failed")
    assert "opacity" in failed["message"]
    assert (failed["code"], failed["seq"]) == ("refused", 1)
    assert session.state.document is before


@pytest.mark.parametrize(
    "message",
    [
        {},
        {"type": "dance"},
        {"type": "patch", "seq": "1", "operations": []},
        {"type": "patch", "seq": 1, "operations": {}},
        {"type": "view", "view": "oblique", "size": [1, 1]},
        {"type": "view", "view": "3d", "size": [0, 5]},
        {"type": "view", "view": "3d", "size": [9000, 5]},
        {"type": "view", "view": "3d", "size": [8000, 8000]},
        {"type": "view", "view": "3d", "size": "large"},
        {"type": "shown", "view": "3d", "frame": -1},
        {"type": "ask", "id": None, "question": "histogram"},
        {"type": "cancel"},
    ],
    ids=str,
)
def test_messages_that_are_none_are_errors(session, message):
    page = Page(session)
    page.show()
    with pytest.raises(ArgumentError, match="message"):
        page.client.receive(message)


def test_there_is_an_end_to_the_number_of_pages(session):
    pages = [Page(session) for _ in range(session_module.MAX_CLIENTS)]
    with pytest.raises(ArgumentError, match="close one of them"):
        Page(session)
    pages[0].client.close()
    Page(session)


def test_slices_at_rest_are_the_values_of_slice(session):
    page = Page(session)
    page.show("y", size=(40, 36))
    header, payload = page.at_rest("y")
    x, y, z = session.state.view["slices"]["crosshair"]
    picture = ws.slice(session.state.scene, "coronal", y, size=(40, 36))
    assert header["format"] == "values"
    assert viewer_fakes.decoded_values(header, payload)[0] == pytest.approx(picture.value, abs=0.01, nan_ok=True)
    assert header["slice"]["position"] == pytest.approx(y)
    assert header["slice"]["origin"] == pytest.approx(picture.report["origin"])
    page.patch({"op": "add", "path": "/view/slices/normals", "value": {"y": [0.3, 1, 0]}})
    header, payload = page.at_rest("y")
    oblique = ws.slice(session.state.scene, ((x, y, z), (0.3, 1, 0)), size=(40, 36))
    assert viewer_fakes.decoded_values(header, payload)[0] == pytest.approx(oblique.value, abs=0.01, nan_ok=True)


def test_closing_lets_go_of_volumes_and_threads():
    session = Session(viewer_fakes.state_of())
    page = Page(session)
    page.show()
    page.at_rest()
    scene = weakref.ref(session.state.scene)
    threads = set(session._threads)
    session.close()
    assert not any(thread.is_alive() for thread in threads)
    page.session = page.client = session = None
    page.messages.clear()
    gc.collect()
    assert scene() is None


def resident():
    """Bytes of memory of this process."""
    return int(Path("/proc/self/statm").read_text().split()[1]) * 4096


@pytest.mark.skipif(not Path("/proc/self/statm").exists(), reason="memory is told by /proc")
def test_a_thousand_frames_need_no_more_memory(session, is_night):
    n_frames = 1000 if is_night else 250  # of 77 kB each, and the bound is 10 MB
    page = Page(session)
    page.show(size=(160, 120))
    camera = session.state.camera

    def draw(n):
        first = page.seq
        for k in range(n):
            page.patch(viewer_fakes.turned(camera, k % 90), moving=True)
            page.wait(lambda header: header["type"] == "frame" and header["seq"] >= page.seq)
            page.messages.clear()
        return page.seq - first

    draw(n_frames // 5)
    before = resident()
    assert draw(n_frames) == n_frames
    assert resident() - before < 10e6


# The pace


def test_the_pace_goes_down_at_once_and_up_when_there_is_time():
    pace, rungs = Pace(), rungs_of("smooth", is_slice=False)
    took = lambda ms: pace.record("look", rungs, pace.chosen("look", rungs), ms=ms, n_px=1000, budget_ms=28.0)  # noqa: E731
    assert pace.chosen("look", rungs) == Settings(30.0)
    took(40.0)
    assert pace.chosen("look", rungs) == Settings(30.0, 0.75)
    took(80.0)
    assert pace.chosen("look", rungs) == Settings(30.0, 0.5)
    for _ in range(4):
        took(10.0)
    assert pace.chosen("look", rungs) == Settings(30.0, 0.5)
    for _ in range(200):
        took(10.0)
    assert pace.chosen("look", rungs) == Settings(None)
    assert pace.chosen("another look", rungs) == Settings(30.0)


@pytest.mark.parametrize("is_slice", [False, True])
def test_frames_of_200_ms_at_half_the_scale_lead_to_a_quarter(is_slice):
    pace, rungs = Pace(), rungs_of("smooth", is_slice=is_slice)
    half = next(one for one in rungs if one.scale == 0.5)
    # A machine that takes 200 ms for half the width and height, and in proportion to the pixels for others.
    took = lambda settings: pace.record(  # noqa: E731
        "look", rungs, settings, ms=200.0 * (settings.scale / 0.5) ** 2, n_px=1000, budget_ms=28.0
    )
    while pace.chosen("look", rungs) != half:
        took(pace.chosen("look", rungs))
    took(half)
    chosen = []
    for _ in range(20):
        chosen.append(pace.chosen("look", rungs))
        took(chosen[-1])
    assert {one.scale for one in chosen} == {0.25}


def test_exact_never_draws_less_than_at_rest():
    pace, rungs = Pace(), rungs_of("exact", is_slice=False)
    for _ in range(5):
        pace.record("look", rungs, pace.chosen("look", rungs), ms=900.0, n_px=1000, budget_ms=float("inf"))
    assert pace.chosen("look", rungs) == Settings(None)


def test_a_rung_that_was_too_slow_is_not_tried_again_at_once():
    pace, rungs = Pace(), rungs_of("balanced", is_slice=False)
    costs = dict(zip(rungs, (100.0, 95.0, 90.0, 70.0, 20.0), strict=True))
    chosen = []
    for _ in range(60):
        settings = pace.chosen("look", rungs)
        chosen.append(settings)
        pace.record("look", rungs, settings, ms=costs[settings], n_px=1000, budget_ms=60.0)
    assert chosen.count(Settings(36.0)) > 45
