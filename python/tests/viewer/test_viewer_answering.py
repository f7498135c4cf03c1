"""Questions of pages are answered by threads of their own, in the order in which they were asked."""

import threading

import pytest
import viewer_fakes
from viewer_fakes import Page

from wavesplat._viewer.page_requests import questions
from wavesplat._viewer.session.session import Session


@pytest.fixture
def session():
    made = Session(viewer_fakes.state_of())
    yield made
    made.close()


class Slow:
    """Answers that wait until they may go on, and the cameras of the states that they are about."""

    def __init__(self, monkeypatch):
        self.is_asked, self.may_go, self.cameras = threading.Event(), threading.Event(), []
        monkeypatch.setattr(questions, "answer_of", self._answer)

    def _answer(self, state, question, _arguments, progress):
        self.cameras.append(state.camera)
        self.is_asked.set()
        assert self.may_go.wait(60)
        progress(0.5)
        return {"asked": question}, b""


def ask(page, number, question, **arguments):
    page.client.receive({"type": "ask", "id": number, "question": question, "arguments": arguments})


def told_of(page, *numbers):
    """The answers and refusals to questions by number, in the order in which they came."""
    page.wait(lambda header: header.get("id") == numbers[-1] and header["type"] != "progress", 60)
    told = [header for _, header, _ in list(page.messages) if header["type"] in ("answer", "failed")]
    return [header["id"] for header in told if header.get("id") in numbers]


def test_slow_framing_keeps_no_message_waiting(session, monkeypatch):
    page, slow = Page(session), Slow(monkeypatch)
    first = session.state.camera
    # In this thread, as a server's loop does: it returns before the answer is there.
    ask(page, 1, "framed")
    ask(page, 2, "kept_in_view")
    assert slow.is_asked.wait(60)
    page.patch(viewer_fakes.turned(first, 30))
    page.wait(lambda header: header["type"] == "confirmed")
    ask(page, 3, "first_view")
    slow.may_go.set()
    assert told_of(page, 1, 2, 3) == [1, 2, 3]
    # Each is about the state of the moment in which it was asked.
    assert slow.cameras == [first, first, session.state.camera]


def test_cameras_do_not_wait_for_other_questions(session, monkeypatch):
    page, slow = Page(session), Slow(monkeypatch)
    ask(page, 1, "picture")
    assert slow.is_asked.wait(60)
    slow.is_asked.clear()
    ask(page, 2, "framed")
    assert slow.is_asked.wait(60)
    slow.may_go.set()
    assert sorted(told_of(page, 1, 2)) in ([1, 2], [2])


def test_a_question_that_waits_is_cancelled_with_an_answer(session, monkeypatch):
    page, slow = Page(session), Slow(monkeypatch)
    ask(page, 1, "picture")
    assert slow.is_asked.wait(60)
    ask(page, 2, "picture")
    ask(page, 3, "picture")
    for number in (2, 7):  # the last one was never asked
        page.client.receive({"type": "cancel", "id": number})
    slow.may_go.set()
    assert told_of(page, 1, 2, 3) == [1, 2, 3]
    failed = [header for _, header, _ in page.messages if header["type"] == "failed"]
    assert [(one["id"], one["code"]) for one in failed] == [(2, "cancelled")]
    assert len(slow.cameras) == 2


def test_too_many_questions_are_told(session, monkeypatch):
    page, slow = Page(session), Slow(monkeypatch)
    for number in range(70):
        ask(page, number, "picture")
    failed, _ = page.wait(lambda header: header["type"] == "failed")
    assert failed["code"] == "busy"
    slow.may_go.set()


def test_a_page_that_has_gone_gets_no_answer(session, monkeypatch):
    page, slow = Page(session), Slow(monkeypatch)
    ask(page, 1, "picture")
    assert slow.is_asked.wait(60)
    ask(page, 2, "picture")
    page.client.close()
    slow.may_go.set()
    other = Page(session)
    ask(other, 3, "picture")
    assert told_of(other, 3) == [3]
    assert [header for _, header, _ in page.messages if header["type"] == "answer"] == []
    assert len(slow.cameras) == 2
