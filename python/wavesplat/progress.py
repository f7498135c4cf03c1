"""Work that shows how far it is and stops at Ctrl-C."""

from __future__ import annotations

import threading
from collections.abc import Callable
from typing import Generic, TypeVar

__all__ = ["run"]

T = TypeVar("T")

#: How often the bar moves and Ctrl-C is noticed.
POLL_SECS = 0.05


def run(work: Callable[[Callable[[float], bool]], T], label: str, *, shown: bool) -> T:
    """What `work(progress)` returns, with a progress bar on stderr if `shown`.

    The work runs in a second thread, so that this one is free to receive Ctrl-C: it then makes `progress` return False,
    waits for the work to stop, and raises `KeyboardInterrupt`.
    """
    task = _Task(work)
    task.thread.start()
    try:
        if shown:
            _show(task, label)
        while task.thread.is_alive():
            task.thread.join(POLL_SECS)
    except KeyboardInterrupt:
        task.cancelled = True
        task.thread.join()
        raise
    if task.error is not None:
        raise task.error
    return task.result[0]


class _Task(Generic[T]):
    """A piece of work in its thread, and what it has come to."""

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
    from rich.console import Console
    from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn

    columns = (TextColumn("{task.description}"), BarColumn(), TimeElapsedColumn())
    with Progress(*columns, console=Console(stderr=True), transient=True) as bar:
        row = bar.add_task(label, total=1.0)
        while task.thread.is_alive():
            task.thread.join(POLL_SECS)
            bar.update(row, completed=task.fraction)
