"""Ctrl-C at a point of some work, and what is spent until it is answered.

Both are told by the processor time of the process, which says the same on a machine that does other things too.
"""

from __future__ import annotations

import os
import signal
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager

#: Processor seconds until an answer, at most: a tenth of a second of all processors, and some for what is cleared away.
ANSWER_S = 5 + 0.2 * (os.cpu_count() or 1)


@contextmanager
def ctrl_c_after(seconds: float) -> Iterator[Callable[[], float]]:
    """Send SIGINT to the main thread once so much processor time was used; gives the seconds used since then."""
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
