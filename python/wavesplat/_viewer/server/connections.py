"""Connections to the viewer's server: their limits, tokens of links, the link itself, and requests to another host.

Any program of this machine can connect, so none may take all descriptors of the process or fill its log.
"""

from __future__ import annotations

import contextlib
import hmac
import html
import logging
import math
import secrets
import shutil
import socket
import tempfile
import threading
import weakref
import webbrowser
from collections.abc import Iterable
from pathlib import Path
from time import monotonic
from typing import Any

import tornado.httpserver
import tornado.ioloop
import tornado.iostream

# The page for requests under another address than the server's own: how to reach it over SSH.
#
# Addresses of other hosts and ports are refused, so that no page from elsewhere gets in by a name that resolves to this
# machine. Most requests of this kind come through an SSH tunnel from another port.

WRONG_HOST_PAGE = """<!doctype html>
<html lang="en">
<meta charset="utf-8">
<meta name="viewport" content="width=device-width">
<title>Wavesplat: another address</title>
<h1>This viewer answers at port {port} alone</h1>
<p>The address of this page has another host or port than the viewer&#x27;s own, http://127.0.0.1:{port}/.
Through an SSH tunnel both ends must have the same port: stop the tunnel, run</p>
<pre>ssh -N -L {port}:127.0.0.1:{port} SERVER</pre>
<p>on the machine before you, with the name of the machine that draws for SERVER, and open the link that the command
printed there. If port {port} is taken on your machine, start the command with another one:
<code>wavesplat view --port PORT</code>.</p>
</html>
"""


def page_of(port: int) -> str:
    """The text of the page. It has nothing from the request, and no link that lets in."""
    return WRONG_HOST_PAGE.format(port=port)


# The viewer's link, handed to the browser in a file that only the user can read.
#
# Arguments of a process are public: as one, the link and its token could be read, and used first, by other users of the
# machine. Jupyter hands its links over in the same way.

LINK_PAGE = """<!DOCTYPE html>
<html lang="en">
<meta charset="utf-8">
<meta name="referrer" content="no-referrer">
<meta http-equiv="refresh" content="0; url={link}">
<title>Wavesplat</title>
<p><a href="{link}">Open the viewer</a></p>
</html>
"""


class BrowserLink:
    """A page in a file that sends the browser on to a link, until it is removed or Python ends."""

    def __init__(self, link: str) -> None:
        folder = tempfile.mkdtemp(prefix="wavesplat-")  # only the user can enter it
        self._remove = weakref.finalize(self, shutil.rmtree, folder, ignore_errors=True)
        self.path = Path(folder) / "viewer.html"
        try:
            self.path.touch(0o600, exist_ok=False)
            self.path.write_text(LINK_PAGE.format(link=html.escape(link)), encoding="utf-8")
        except OSError:
            self.remove()
            raise

    def open(self) -> bool:
        """Show the link in the browser; False if there is none."""
        opened = False
        with contextlib.suppress(webbrowser.Error):
            opened = webbrowser.open(self.path.as_uri())
        if not opened:
            self.remove()
        return opened

    def remove(self) -> None:
        """Delete the file and its folder."""
        self._remove()


# Tokens of links, each good once, and keys of the pages that came with one.
#
# Both have 256 random bits. Nobody guesses one, so wrong ones are refused and not counted: a count would let any
# program of this machine keep the right page out.

#: Largest number of tokens, and of keys of pages that have gone, that are remembered.
MAX_KEYS = 64


class Tokens:
    """Tokens that were given out, and keys."""

    def __init__(self) -> None:
        self._tokens: list[str] = []
        #: Keys, and how many connections have each: those that were left longest ago come first.
        self._keys: dict[str, int] = {}

    def new(self) -> str:
        """A token for one page."""
        token = secrets.token_urlsafe(32)
        self._tokens = [*self._tokens, token][-MAX_KEYS:]
        return token

    def key_for(self, token: object, key: object) -> str | None:
        """The key for a page with a valid token, which is used up, or with a valid key; None if neither is valid.

        Call `leave` with the key when the page's connection ends.
        """
        if isinstance(key, str) and _is_in(key, self._keys):
            self._keys[key] += 1
            return key
        if isinstance(token, str) and _is_in(token, self._tokens):
            self._tokens = [one for one in self._tokens if not hmac.compare_digest(one, token)]
            made = secrets.token_urlsafe(32)
            self._keys[made] = 1
            return made
        return None

    def leave(self, key: str) -> None:
        """End a connection of a page, which may come again; keys of pages that are here are never forgotten."""
        self._keys[key] = self._keys.pop(key) - 1
        gone = [one for one, n_connections in self._keys.items() if n_connections == 0]
        for one in gone[:-MAX_KEYS]:
            del self._keys[one]


def _is_in(text: str, known: Iterable[str]) -> bool:
    # All are compared, so that the time reveals nothing.
    data = text.encode("utf-8", "replace")
    return sum(hmac.compare_digest(one.encode(), data) for one in known) > 0


# Limits of the server's connections: how many there are, how long each may take, and what is logged of them.

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
