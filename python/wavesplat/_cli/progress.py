"""Long work with a progress bar, which Ctrl-C stops."""

from __future__ import annotations

import os
import signal
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from types import FrameType
from typing import TYPE_CHECKING, Generic, TypeVar

from wavesplat._cli.printing import is_terminal

if TYPE_CHECKING:
    from rich.progress import Progress

T = TypeVar("T")

#: Interval at which the bar moves and, on Windows, Ctrl-C is noticed.
POLL_SECS = 0.05

#: Control sequence that shows a terminal's cursor, which the bar has hidden (DECTCEM of the VT220).
SHOW_CURSOR = b"\x1b[?25h"


def run(work: Callable[[Callable[[float], bool]], T], label: str, *, shown: bool) -> T:
    """Return `work(progress)`, with a progress bar on stderr if `shown`.

    The work runs in a second thread, so that this one is free to receive Ctrl-C: it then makes `progress` return False,
    waits for the work to stop, and raises `KeyboardInterrupt`. A second Ctrl-C ends the process at once.
    """
    task = _Task(work)
    with _interrupts(task):
        task.thread.start()
        if shown:
            _show(task, label)
        while task.thread.is_alive():
            task.thread.join(POLL_SECS)
    if task.cancelled:
        raise KeyboardInterrupt
    if task.error is not None:
        raise task.error
    return task.result[0]


@contextmanager
def bar(label: str, *, shown: bool) -> Iterator[Callable[[float], None]]:
    """A callback that moves a progress bar on stderr, if `shown`: for work in this thread, which so gets Ctrl-C."""
    if not shown:
        yield lambda _fraction: None
        return
    with _bar() as rows:
        row = rows.add_task(label, total=1.0)
        yield lambda fraction: rows.update(row, completed=fraction)


@contextmanager
def _interrupts(task: _Task[T]) -> Iterator[None]:
    """Let Ctrl-C cancel the task, instead of raising an exception.

    In Python 3.11 an exception that comes while `Thread.join` waits marks the thread as ended when it is not
    (`Thread._wait_for_tstate_lock`). Elsewhere than in the main thread, which alone receives signals, and where Ctrl-C
    already means something else than `KeyboardInterrupt`, nothing changes.
    """
    plain = signal.getsignal(signal.SIGINT) is signal.default_int_handler
    if not plain or threading.current_thread() is not threading.main_thread():
        yield
        return

    def cancel(_signal: int, _frame: FrameType | None) -> None:
        if task.cancelled:
            # Work that goes on must not come back into an interpreter that is being taken down.
            os.write(2, SHOW_CURSOR if is_terminal() else b"")
            os._exit(128 + signal.SIGINT)
        task.cancelled = True

    signal.signal(signal.SIGINT, cancel)
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, signal.default_int_handler)


class _Task(Generic[T]):
    """A piece of work in its thread, and its result or error."""

    def __init__(self, work: Callable[[Callable[[float], bool]], T]) -> None:
        self.work = work
        self.fraction = 0.0
        self.cancelled = False
        self.result: list[T] = []
        self.error: BaseException | None = None
        self.thread = threading.Thread(target=self._run, daemon=True)

    def _run(self) -> None:
        try:
            self.result.append(self.work(self._progress))
        except BaseException as error:  # noqa: BLE001 - carried to the waiting thread, which raises it
            self.error = error

    def _progress(self, fraction: float) -> bool:
        self.fraction = fraction
        return not self.cancelled


def _show(task: _Task[T], label: str) -> None:
    with _bar() as rows:
        row = rows.add_task(label, total=1.0)
        while task.thread.is_alive():
            task.thread.join(POLL_SECS)
            rows.update(row, completed=task.fraction)


def _bar() -> Progress:
    from rich.console import Console
    from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn

    columns = (TextColumn("{task.description}"), BarColumn(), TimeElapsedColumn())
    return Progress(*columns, console=Console(stderr=True), transient=True)
