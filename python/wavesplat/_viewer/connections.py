"""Limits of the server's connections: how many there are, how long each may take, and what is logged of them.

Any program of this machine can connect, so none may take all descriptors of the process or fill its log.
"""

from __future__ import annotations

import logging
import math
import socket
import threading
from time import monotonic
from typing import Any

import tornado.httpserver
import tornado.ioloop
import tornado.iostream

#: Connections that may be open at once; further ones are closed as they come.
MAX_CONNECTIONS = 64
#: Seconds in which the header of a request must come, also of the next one of a connection.
HEADER_S = 10.0
#: Seconds in which a client must have read an answer.
ANSWER_S = 30.0
#: Seconds without accepting anybody after the process has no descriptor or no memory left.
PAUSE_S = 1.0
#: Least seconds between two lines of the log about one kind of trouble.
LINE_S = 60.0

log = logging.getLogger("tornado.general")


class Listener(socket.socket):
    """A listening socket that pauses where the process has no descriptor left for another connection.

    The waiting connection keeps such a socket readable, so the loop would call `accept` without a break.
    """

    def accept(self) -> tuple[socket.socket, Any]:
        """A new connection; a `BlockingIOError` where there is none, or none can be had now."""
        try:
            return super().accept()
        except (BlockingIOError, ConnectionAbortedError):
            raise
        except OSError as error:
            loop = tornado.ioloop.IOLoop.current()
            loop.update_handler(self, 0)
            loop.call_later(PAUSE_S, self._go_on)
            log.warning("the viewer cannot accept a connection: %s", error.strerror)
            raise BlockingIOError from None

    def _go_on(self) -> None:
        if self.fileno() >= 0:
            tornado.ioloop.IOLoop.current().update_handler(self, tornado.ioloop.IOLoop.READ)


class BoundedServer(tornado.httpserver.HTTPServer):
    """An HTTP server with at most `MAX_CONNECTIONS`, each of which must send its header within `HEADER_S`."""

    def initialize(self, *args: Any, **kwargs: Any) -> None:
        """Set the limits; Tornado sets up its servers by this method, not by `__init__`."""
        limits = {"max_header_size": 1 << 14, "max_body_size": 0, "idle_connection_timeout": HEADER_S}
        super().initialize(*args, **{**kwargs, **limits})
        self._streams: list[tornado.iostream.IOStream] = []

    def handle_stream(self, stream: tornado.iostream.IOStream, address: Any) -> None:
        """Take a connection, or close it."""
        self._streams = [one for one in self._streams if not one.closed()]
        if len(self._streams) >= MAX_CONNECTIONS:
            stream.close()
            return
        self._streams.append(stream)
        super().handle_stream(stream, address)


class QuietLog(logging.Filter):
    """At most one line a minute for each kind of trouble with connections, of the thread that makes it.

    What clients do wrong goes to the loggers below. Our own failures go to "tornado.application": all of them are
    written, with their tracebacks. A notebook's own server, in another thread, logs to the same loggers as before.
    """

    LOGGERS = ("tornado.general", "asyncio")

    def __init__(self) -> None:
        super().__init__()
        self._thread = threading.get_ident()
        #: When a line of each kind was written last, by the monotonic clock.
        self._written: dict[tuple[str, str, str], float] = {}

    def __enter__(self) -> None:
        for name in self.LOGGERS:
            logging.getLogger(name).addFilter(self)

    def __exit__(self, *_: object) -> None:
        for name in self.LOGGERS:
            logging.getLogger(name).removeFilter(self)

    def filter(self, record: logging.LogRecord) -> bool:
        """Whether to write a record; its traceback is reduced to the error."""
        if record.thread != self._thread:
            return True
        error = record.exc_info[1] if record.exc_info else None
        # Further lines name sockets and addresses, which differ each time.
        kind = (record.name, str(record.msg).partition("\n")[0], type(error).__name__)
        now = monotonic()
        if now - self._written.get(kind, -math.inf) < LINE_S:
            return False
        self._written[kind] = now
        text = record.getMessage().partition("\n")[0]
        record.msg = text if error is None else f"{text}: {type(error).__name__}: {error}"
        record.args, record.exc_info, record.exc_text = (), None, None
        return True
