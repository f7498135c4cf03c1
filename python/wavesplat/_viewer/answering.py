"""Answers to the questions of a session's pages, in threads of their own.

Questions about cameras, which a page asks before it moves one, have a thread of their own, since others may take long:
small pictures of presets wait until all views are at rest. Each thread answers in the order in which it was asked.
"""

from __future__ import annotations

import threading
import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Protocol

from wavesplat._viewer import questions
from wavesplat._viewer.state import ViewerState
from wavesplat.errors import CancelledError, WavesplatError

#: Largest number of questions that wait.
MAX_QUESTIONS = 64
#: Least seconds between two messages of progress.
PROGRESS_S = 0.1


class Page(Protocol):
    """The page that asks."""

    is_open: bool

    def send(self, header: dict[str, Any], payload: bytes = b"") -> None:
        """Send a message to the page."""


@dataclass(eq=False)
class _Question:
    """A question of a page. state : the state it is about; None: the newest one when it is answered."""

    page: Page
    number: int
    name: str
    arguments: Any
    state: ViewerState | None
    is_cancelled: bool = False


class Answering:
    """The questions of a session, and the threads that answer them.

    changed : guards the session, and is notified of changes. state : gives the newest state. is_at_rest : whether no
    view waits for a picture at rest.
    """

    def __init__(
        self, changed: threading.Condition, state: Callable[[], ViewerState], is_at_rest: Callable[[], bool]
    ) -> None:
        self._changed, self._state, self._is_at_rest = changed, state, is_at_rest
        self._about_cameras, self._others = list[_Question](), list[_Question]()
        self._being_answered: list[_Question] = []
        self._is_open = True
        lanes = (("cameras", self._about_cameras), ("answers", self._others))
        self.threads = [
            threading.Thread(target=self._work, args=(lane,), name=f"wavesplat-viewer-{name}", daemon=True)
            for name, lane in lanes
        ]
        for thread in self.threads:
            thread.start()

    def ask(self, page: Page, number: int, name: str, arguments: Any) -> None:
        """Answer a question, later; at once where too many wait."""
        is_about_camera = name in questions.OF_CAMERAS
        waiting = self._about_cameras if is_about_camera else self._others
        with self._changed:
            if len(waiting) >= MAX_QUESTIONS:
                message = "too many questions wait for an answer; ask again"
                page.send({"type": "failed", "id": number, "code": "busy", "message": message})
                return
            state = self._state() if is_about_camera else None
            waiting.append(_Question(page, number, name, arguments, state))
            self._changed.notify_all()

    def cancel(self, page: Page, number: int) -> None:
        """Cancel a question that waits or is being answered; others, such as answered ones, are left alone."""
        with self._changed:
            for question in (*self._about_cameras, *self._others, *self._being_answered):
                if question.page is page and question.number == number:
                    question.is_cancelled = True
            self._changed.notify_all()

    def close(self) -> None:
        """End the threads, after what is being answered."""
        with self._changed:
            self._is_open = False
            self._changed.notify_all()

    def _work(self, waiting: list[_Question]) -> None:
        while self._answer_next(waiting):
            pass

    def _answer_next(self, waiting: list[_Question]) -> bool:
        """Wait for a question and answer it; False at the end. A thread that waits holds no state, hence no volumes."""
        question = self._next(waiting)
        if question is None:
            return False
        self._answer(question)
        with self._changed:
            self._being_answered.remove(question)
        return True

    def _next(self, waiting: list[_Question]) -> _Question | None:
        """The oldest question that need not wait; None at the end."""
        with self._changed:
            while self._is_open:
                at_rest = self._is_at_rest()
                for question in waiting:
                    is_needless = question.is_cancelled or not question.page.is_open
                    if at_rest or is_needless or question.name != "preset_picture":
                        waiting.remove(question)
                        self._being_answered.append(question)
                        return question
                self._changed.wait()
            return None

    def _answer(self, question: _Question) -> None:
        page, number = question.page, question.number
        reported_s = 0.0

        def progress(part: float) -> bool:
            nonlocal reported_s
            if time.monotonic() - reported_s > PROGRESS_S:
                reported_s = time.monotonic()
                page.send({"type": "progress", "id": number, "part": part, "text": ""})
            return page.is_open and self._is_open and not question.is_cancelled

        try:
            if question.is_cancelled:
                raise CancelledError("the page cancelled its question")
            if not page.is_open:
                return
            state = self._state() if question.state is None else question.state
            answer, payload = questions.answer(state, question.name, question.arguments, progress)
        except CancelledError:
            page.send({"type": "failed", "id": number, "code": "cancelled", "message": "it was cancelled"})
        except Exception as error:  # noqa: BLE001 - whatever fails, the page has to be reported_s
            page.send(failure_of(error, number))
        else:
            page.send({"type": "answer", "id": number, **answer}, payload)


def failure_of(error: Exception, number: int | None = None) -> dict[str, Any]:
    """The message to a page about an error. number : of the question that failed; None of a picture."""
    is_ours = isinstance(error, WavesplatError | MemoryError)
    message = str(error) if is_ours else f"the renderer failed: {type(error).__name__}: {error}"
    return {"type": "failed", "id": number, "code": "failed", "message": message or type(error).__name__}
