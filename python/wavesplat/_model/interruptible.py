"""Ctrl-C while compiled code runs, which does not check for signals itself."""

from __future__ import annotations

import threading
from collections.abc import Callable
from concurrent.futures import Future, wait
from typing import TypeVar

T = TypeVar("T")

#: Seconds between checks for signals; on Windows waiting itself is not interrupted.
POLL_S = 0.1


def interruptible(work: Callable[[], T]) -> T:
    """The result of `work`; on Ctrl-C a `KeyboardInterrupt` is raised at once, and the result is dropped.

    It must release the interpreter lock while it runs, and change nothing but its result: after Ctrl-C it goes on in
    its thread until it is done.
    """
    if threading.current_thread() is not threading.main_thread():
        return work()  # only the main thread gets signals
    done: Future[T] = Future()

    def run() -> None:
        try:
            done.set_result(work())
        except BaseException as error:  # noqa: BLE001 - carried to the thread that waits, which raises it
            done.set_exception(error)

    threading.Thread(target=run, name="wavesplat-work", daemon=True).start()
    while not wait([done], POLL_S).done:
        pass
    return done.result()
