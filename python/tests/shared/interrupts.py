"""Ctrl-C at a point of some work, and the processor time until it is answered.

Both are measured in processor time of the process, which does not depend on other work of the machine.
"""

from __future__ import annotations

import os
import signal
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager

#: Largest processor time until an answer, seconds: 0.2 s on each processor, and some for clearing up.
ANSWER_S = 5 + 0.2 * (os.cpu_count() or 1)


@contextmanager
def ctrl_c_after(seconds: float) -> Iterator[Callable[[], float]]:
    """Send SIGINT to the main thread after this much processor time; yield a function of the seconds since then."""
    begun, sent, is_over = time.process_time(), [], threading.Event()

    def send():
        while time.process_time() < begun + seconds:
            if is_over.wait(0.002):
                return
        sent.append(time.process_time())
        signal.pthread_kill(threading.main_thread().ident, signal.SIGINT)

    sender = threading.Thread(target=send)
    sender.start()
    try:
        yield lambda: time.process_time() - sent[0]
    finally:
        is_over.set()
        sender.join()
