"""Confirmation of a page's changes, progress of pictures at rest, and small pictures that wait for rest."""

import threading
import time

import pytest
import viewer_fakes
from viewer_fakes import Page

from wavesplat._viewer.session import session as session_module
from wavesplat._viewer.session.pace import Refining
from wavesplat._viewer.session.picturing import picture_of
from wavesplat._viewer.session.session import Session, confirmed


@pytest.fixture
def session():
    made = Session(viewer_fakes.state_of())
    yield made
    made.close()


def headers(page, kind):
    return [header for _, header, _ in page.messages if header["type"] == kind]


def test_every_change_is_confirmed_also_one_that_draws_nothing(session):
    page = Page(session)
    page.patch({"op": "replace", "path": "/view/interface/panels", "value": ["layers"]})
    page.patch(moving=False)
    page.patch({"op": "replace", "path": "/view/interface/theme", "value": "light"})
    assert [(header["seq"], header["corrections"]) for header in headers(page, "confirmed")] == [
        (1, []),
        (2, []),
        (3, []),
    ]


def test_changes_by_others_carry_the_number_that_the_page_had_reached(session):
    page, other = Page(session), Page(session)
    page.patch({"op": "replace", "path": "/render/kernel", "value": "bspline2"})
    other.patch({"op": "replace", "path": "/render/kernel", "value": "linear"})
    session.change(session.state.with_camera(session.state.camera.turned(azimuth=5)))
    assert [header["seq"] for header in headers(page, "patch")] == [1, 1]
    assert [header["seq"] for header in headers(other, "patch")] == [0, 1]
    # A refused change counts as reached: the page took it back when it was told so.
    page.patch({"op": "replace", "path": "/layers/0/opacity", "value": 3})
    session.change(session.state.with_camera(session.state.camera.turned(azimuth=5)))
    assert headers(page, "patch")[-1]["seq"] == 2


def test_what_the_session_completes_goes_back_to_the_page_and_to_others(session):
    page, other = Page(session), Page(session)
    view = {"layout": {"name": "two-by-two"}}
    page.patch({"op": "replace", "path": "/view", "value": view})
    (correction,) = headers(page, "confirmed")[0]["corrections"]
    assert correction == {"op": "add", "path": "/view", "value": session.state.view}
    assert session.state.view["layout"] == {"name": "two-by-two", "main": "3d"}
    assert headers(other, "patch")[0]["operations"][-1] == correction


@pytest.mark.parametrize("document", [5, [], None, "state"])
def test_documents_that_are_none_are_refused(session, document):
    page = Page(session)
    page.patch({"op": "replace", "path": "", "value": document})
    assert headers(page, "failed")[0]["code"] == "refused"


def test_a_turn_of_the_camera_needs_no_correction():
    state = viewer_fakes.state_of()
    after, corrections = confirmed(state, [viewer_fakes.turned(state.camera, 20)])
    assert corrections == []
    assert after.scene is state.scene


def test_the_share_of_a_long_picture_rises_and_ends():
    sent = []
    refining = Refining(sent.append, "3d", is_long=True)
    until = time.monotonic() + 0.5
    while time.monotonic() < until:
        refining.advance(0.4)
        refining.advance(0.6)
        refining.advance(0.2)
        time.sleep(0.01)
    refining.end()
    refining.end()
    parts = [header["part"] for header in sent]
    assert parts[0] == 0.0
    assert parts[-1] is None
    assert parts.count(None) == 1
    assert parts[1:-1] == sorted(set(parts[1:-1]))
    assert parts[1] == 0.4
    assert {header["view"] for header in sent} == {"3d"}


def test_nothing_is_said_of_a_quick_picture():
    sent = []
    refining = Refining(sent.append, "3d", is_long=False)
    refining.advance(0.5)
    refining.end()
    assert sent == []


def test_small_pictures_of_presets_wait_for_the_picture_at_rest(session, monkeypatch):
    page = Page(session)
    page.show()
    page.at_rest()
    gate, began = threading.Event(), threading.Event()
    original = picture_of

    def slow(state, view, size, *, progress=None, **more):
        if progress is not None and "psnr" not in more:
            began.set()
            gate.wait(10)
        return original(state, view, size, progress=progress, **more)

    monkeypatch.setattr(session_module, "picture_of", slow)
    page.patch(viewer_fakes.turned(session.state.camera, 5))
    assert began.wait(10)
    page.client.receive(
        {"type": "ask", "id": 1, "question": "preset_picture", "arguments": {"layer": 0, "name": "auto", "size": 32}}
    )
    # Other questions do not wait.
    page.ask("histogram", number=2, layer=0, bins=4, low=0, high=1)
    assert not [header for header in headers(page, "answer") if header["id"] == 1]
    gate.set()
    page.wait(lambda header: header["type"] == "answer" and header["id"] == 1)
    kinds = [header for _, header, _ in page.messages if header["type"] in ("frame", "answer")]
    rest = next(
        n for n, header in enumerate(kinds) if header["type"] == "frame" and header["at_rest"] and header["seq"] == 1
    )
    assert rest < next(n for n, header in enumerate(kinds) if header["type"] == "answer" and header["id"] == 1)


def test_a_kernel_that_there_is_not_is_refused_and_not_drawn(session):
    page = Page(session)
    page.patch({"op": "replace", "path": "/render/kernel", "value": "none"})
    assert "'kernel' is 'none'; use one of: " in headers(page, "failed")[0]["message"]
