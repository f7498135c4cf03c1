"""Several frames at once: those that are drawn, and the one that is encoded, in threads of their own.

A small frame does not keep several threads busy to its end; two frames at once do.
"""

from __future__ import annotations

import queue
import threading
from collections import deque
from collections.abc import Callable, Generator, Iterable, Iterator
from concurrent.futures import Future, ThreadPoolExecutor
from concurrent.futures import TimeoutError as NotYetError
from contextlib import suppress
from typing import Generic, TypeVar, cast

from wavesplat.errors import CancelledError

T = TypeVar("T")

#: Largest number of frames that are made at once.
MAX_AT_ONCE = 4
#: Largest number of items that wait to be used.
N_WAITING = 2
#: Interval at which a wait checks whether another thread has ended.
POLL_SECS = 0.1


class Progress:
    """Progress of all frames, reported to the callback always by the thread that waits for them."""

    def __init__(self, callback: Callable[[float], object] | None, n: int) -> None:
        self._callback = callback
        self._n = n
        self._parts: dict[int, float] = {}
        self._stopped = threading.Event()
        self._reported = -1.0

    def of(self, number: int) -> Callable[[float], bool]:
        """Progress callback of a frame: takes the part that is done, returns False to stop it."""

        def note(done: float) -> bool:
            self._parts[number] = done
            return not self._stopped.is_set()

        return note

    def finish(self, number: int) -> None:
        """Count a frame as done."""
        self._parts[number] = 1.0

    def report(self) -> None:
        """Report progress; raise `CancelledError` if the callback returns False."""
        # A copy: other threads add to it.
        done = sum(self._parts.copy().values()) / self._n
        if self._callback is None or done <= self._reported:
            return
        self._reported = done
        if self._callback(min(done, 1.0)) is False:
            raise CancelledError("the movie was stopped by progress")

    def stop(self) -> None:
        """Ask all frames to stop."""
        self._stopped.set()


def made_ahead(
    make: Callable[[int], T], numbers: Iterable[int], at_once: Callable[[], int], progress: Progress
) -> Generator[T]:
    """Results of `make` for numbers, in their order, up to `at_once()` of them computed at a time in threads.

    The first is made alone, since it prepares what all others share; `at_once` is called only after it.
    """
    waiting: deque[tuple[int, Future[T]]] = deque()

    def first() -> T:
        number, future = waiting.popleft()
        while True:
            progress.report()
            with suppress(NotYetError):
                made = future.result(timeout=POLL_SECS)
                progress.finish(number)
                return made

    with ThreadPoolExecutor(MAX_AT_ONCE, thread_name_prefix="wavesplat movie") as pool:
        try:
            for place, number in enumerate(numbers):
                if place == 1 or (place > 1 and len(waiting) == at_once()):
                    yield first()
                waiting.append((number, pool.submit(make, number)))
            while waiting:
                yield first()
            progress.report()
        except BaseException:
            progress.stop()
            pool.shutdown(cancel_futures=True)
            raise


def work_beside(work: Callable[[Iterator[T]], object], items: Generator[T]) -> None:
    """Make items here while `work` takes them, in order, in a thread; what fails in it is raised here."""
    worker = _Worker(work)
    worker.thread.start()
    try:
        for item in items:
            if not worker.hand("item", item):
                break
        worker.hand("end")
    except BaseException:
        worker.hand("stop")
        raise
    finally:
        items.close()
        worker.thread.join()
    if worker.failed is not None:
        raise worker.failed


class _StoppedError(Exception):
    """Raised in the worker's thread where no item will come any more."""


class _Worker(Generic[T]):
    """A thread, and the queue of items for it."""

    def __init__(self, work: Callable[[Iterator[T]], object]) -> None:
        self.failed: BaseException | None = None
        self.thread = threading.Thread(target=self._run, name="wavesplat movie", daemon=True)
        self._work = work
        self._waiting: queue.Queue[tuple[str, T | None]] = queue.Queue(N_WAITING)

    def hand(self, what: str, item: T | None = None) -> bool:
        """Queue an item; False if the thread has ended."""
        while self.thread.is_alive():
            with suppress(queue.Full):
                self._waiting.put((what, item), timeout=POLL_SECS)
                return True
        return False

    def _run(self) -> None:
        try:
            self._work(self._come())
        except _StoppedError:
            pass
        except BaseException as error:  # noqa: BLE001 - carried to the thread that waits, which raises it
            self.failed = error

    def _come(self) -> Iterator[T]:
        while True:
            what, item = self._waiting.get()
            if what == "stop":
                raise _StoppedError
            if what == "end":
                return
            yield cast(T, item)
