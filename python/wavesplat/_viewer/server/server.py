"""The viewer's server on this machine: the page's files, and one WebSocket for its session.

It listens on the loopback interface alone. Host and Origin must be its own, so that no page from elsewhere gets in, not
even by a name that resolves to this machine; the token stands in the link's fragment, which browsers send nobody.
"""

from __future__ import annotations

import asyncio
import contextlib
import os
import re
import socket
import threading
from collections.abc import Callable
from typing import Any

import tornado.web
import tornado.websocket

from wavesplat._system.values import described
from wavesplat._viewer.opening.opening import Opener
from wavesplat._viewer.server import connections
from wavesplat._viewer.server.client_files import ClientFile, client_files
from wavesplat._viewer.server.connections import ANSWER_S, BoundedServer, BrowserLink, Listener, QuietLog, Tokens
from wavesplat._viewer.server.messages import MAX_BYTES, PROTOCOL, packed, unpacked
from wavesplat._viewer.session.session import Client, Session
from wavesplat.errors import ArgumentError, WavesplatError

HOST = "127.0.0.1"
#: Seconds in which a page must say who it is; largest number of patches a second from one.
HELLO_S, MAX_PATCHES_PER_S = 5.0, 240
#: Largest number of pages at once.
MAX_PAGES = 16


class Server:
    """A server for one session, in a thread of its own.

    port : 0 is any that is free.
    """

    def __init__(self, port: int = 0) -> None:
        self.tokens = Tokens()
        # Read now: later the process may have no descriptor left to open a file.
        self.files = client_files()
        self._session: Session | None = None
        #: Opens files for the pages; with it and without a session, pages show the start page.
        self._opener: Opener | None = None
        self._failure: str | None = None
        #: Set when a page was sent the error with which the volume could not be opened.
        self.has_reported = threading.Event()
        self._progress: dict[str, Any] | None = None
        self._sockets: set[_Socket] = set()
        self._handed_over: BrowserLink | None = None
        if not 0 <= port < 1 << 16:
            raise ArgumentError(f"port is {described(port)}; give a whole number from 0, any that is free, to 65535")
        listener = Listener(socket.AF_INET, socket.SOCK_STREAM)
        try:
            if os.name != "nt":  # where it would let others in
                listener.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
            listener.setblocking(False)
            listener.bind((HOST, port))
            listener.listen(128)
        except OSError as error:
            listener.close()
            raise ArgumentError(
                f"port {port} of this machine cannot be used: {error.strerror}; choose another one, or leave it out"
            ) from None
        self.port: int = listener.getsockname()[1]
        self._loop = asyncio.new_event_loop()
        self._thread = threading.Thread(target=self._run, args=(listener,), name="wavesplat-viewer-server", daemon=True)
        self._thread.start()

    @property
    def link(self) -> str:
        """A link that lets one page in."""
        return f"http://{HOST}:{self.port}/#token={self.tokens.new()}"

    def open_in_browser(self) -> bool:
        """Open a page in the browser; False if there is no browser."""
        self._handed_over = BrowserLink(self.link)
        return self._handed_over.open()

    def is_own(self, host: str) -> bool:
        """Whether a Host header names this server."""
        return host in {f"{name}:{self.port}" for name in (HOST, "localhost", "[::1]")}

    def offer(self, opener: Opener) -> None:
        """Let pages open files; those that wait for a session show the start page."""
        self._opener = opener
        self._later(lambda: self._each(lambda page: page.join()))

    def show(self, session: Session) -> None:
        """Show a session to the pages that wait and to those that come."""
        self._session = session
        self._later(lambda: self._each(lambda page: page.join()))

    def send_progress(self, text: str, part: float | None = None) -> None:
        """Send pages the progress of opening the volume."""
        self._progress = {"type": "progress", "id": None, "part": part, "text": text}
        self._later(lambda: self._each(lambda page: page.send_progress(self._progress)))

    def fail(self, message: str) -> None:
        """Send pages the error with which the volume could not be opened."""
        self._failure = message
        self._later(lambda: self._each(lambda page: page.fail(message)))

    def close(self) -> None:
        """Stop serving."""
        self.forget_handed_over()
        if self._loop.is_closed():
            return

        def stop() -> None:
            for page in tuple(self._sockets):
                page.close(1001, "the viewer was closed")
            self._loop.call_later(0.05, self._loop.stop)

        self._later(stop)
        if threading.current_thread() is not self._thread:
            self._thread.join(timeout=5)

    def forget_handed_over(self) -> None:
        """Delete the file that handed the link to the browser."""
        if self._handed_over is not None:
            self._handed_over.remove()

    def _each(self, call: Callable[[_Socket], None]) -> None:
        for page in tuple(self._sockets):
            call(page)

    def _later(self, call: Callable[[], object]) -> None:
        with contextlib.suppress(RuntimeError):  # the loop is closed
            self._loop.call_soon_threadsafe(call)

    def _run(self, listener: socket.socket) -> None:
        asyncio.set_event_loop(self._loop)
        routes: list[Any] = [
            (re.escape(path), _File, {"server": self, "file": file}) for path, file in self.files.items()
        ]
        application = tornado.web.Application(
            [*routes, ("/socket", _Socket, {"server": self})],
            default_handler_class=_Nothing,
            default_handler_args={"server": self},
            websocket_max_message_size=MAX_BYTES,
            websocket_ping_interval=20,
            log_function=lambda _handler: None,
            compress_response=False,
        )
        http = BoundedServer(application)
        http.add_socket(listener)
        with QuietLog():
            try:
                self._loop.run_forever()
            finally:
                http.stop()
                self._loop.run_until_complete(http.close_all_connections())
                self._loop.close()


class _Guarded(tornado.web.RequestHandler):
    """Base of the handlers: checks of the request, and headers of security."""

    def initialize(self, server: Server) -> None:
        self._server = server
        self._guard()

    def _guard(self) -> None:
        port = self._server.port
        # The server's name is hidden; the page loads nothing from elsewhere, and no frame shows it.
        self.clear_header("Server")
        policy = (
            "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' blob: data:; "
            f"connect-src 'self' ws://127.0.0.1:{port} ws://localhost:{port}; base-uri 'none'; form-action 'none'; "
            "frame-ancestors 'none'"
        )
        self.set_header("Content-Security-Policy", policy)
        self.set_header("X-Content-Type-Options", "nosniff")
        self.set_header("Referrer-Policy", "no-referrer")
        self.set_header("Cross-Origin-Opener-Policy", "same-origin")
        self.set_header("Cross-Origin-Embedder-Policy", "require-corp")
        self.set_header("Cross-Origin-Resource-Policy", "same-origin")
        self.set_header("Cache-Control", "no-store")

    def prepare(self) -> None:
        if not self._server.is_own(self.request.host):
            self._guard()
            self.set_status(403)
            self.set_header("Content-Type", "text/html; charset=utf-8")
            self.finish(connections.page_of(self._server.port))
            return
        if self.request.method != "GET":
            raise tornado.web.HTTPError(405)

    def write_error(self, status_code: int, **_: Any) -> None:
        self._guard()  # errors begin with a clean slate
        self.set_header("Content-Type", "text/plain; charset=utf-8")
        self.finish(f"{status_code}: {self._reason}\n")


class _File(_Guarded):
    def initialize(self, server: Server, file: ClientFile) -> None:  # type: ignore[override]
        super().initialize(server)
        self._file = file

    async def get(self) -> None:
        """Send the content of the file; a client that does not read it is not waited for."""
        file = self._file
        self.set_header("Content-Type", file.media_type)
        self.set_header("Cache-Control", file.cache)
        self.set_header("Vary", "Accept-Encoding")
        is_compressed = takes_gzip(self.request.headers.get("Accept-Encoding", ""))
        if is_compressed:
            self.set_header("Content-Encoding", "gzip")
        written = self.finish(file.compressed if is_compressed else file.content)
        try:
            await asyncio.wait_for(written, ANSWER_S)
        except TimeoutError:
            self.detach().close()


def takes_gzip(accepted: str) -> bool:
    """Whether a header `Accept-Encoding` takes gzip (RFC 9110, 12.5.3)."""
    for one in accepted.split(","):
        name, _, weight = one.partition(";")
        if name.strip().lower() in ("gzip", "*"):
            return weight.replace(" ", "") not in ("q=0", "q=0.0", "q=0.00", "q=0.000")
    return False


class _Nothing(_Guarded):
    def prepare(self) -> None:
        super().prepare()
        if not self._finished:
            raise tornado.web.HTTPError(404)


class _Socket(tornado.websocket.WebSocketHandler):
    """The WebSocket of a page."""

    def initialize(self, server: Server) -> None:
        self._server = server
        self._client: Client | None = None
        self._key: str | None = None
        self._deadline: Any = None
        self._n_patches, self._second = 0, 0

    def prepare(self) -> None:
        if not self._server.is_own(self.request.host):
            raise tornado.web.HTTPError(403, reason="this is not the host that was asked for")
        # Only pages that have said who they are count: others cannot keep out a page that has the key.
        if sum(page._key is not None for page in self._server._sockets) >= MAX_PAGES:
            raise tornado.web.HTTPError(503, reason="too many pages are open")

    def check_origin(self, origin: str) -> bool:
        """Whether an Origin is this very server's: other pages are refused."""
        scheme, _, host = origin.partition("://")
        return scheme == "http" and host == self.request.host and self._server.is_own(host)

    async def get(self, *args: Any, **kwargs: Any) -> None:
        """Upgrade to a WebSocket; programs without an Origin are refused too."""
        # Here too, since Tornado lets in what has the same host, whatever the scheme.
        if not self.check_origin(self.request.headers.get("Origin", "")):
            raise tornado.web.HTTPError(403, reason="this is not a page of the viewer")
        await super().get(*args, **kwargs)

    def open(self, *_: Any, **__: Any) -> None:
        """Wait for the page to say who it is, now that the socket is there."""
        self._server._sockets.add(self)
        self.set_nodelay(True)
        self._deadline = self._server._loop.call_later(HELLO_S, self._refuse, 4401, "no hello came")

    def write_error(self, status_code: int, **_: Any) -> None:
        """Send a refusal before there is a socket."""
        self.clear_header("Server")
        self.set_header("Content-Type", "text/plain; charset=utf-8")
        self.finish(f"{status_code}: {self._reason}\n")

    def on_message(self, message: str | bytes) -> None:
        """Take a message of the page."""
        if isinstance(message, str):
            self._refuse(4400, "messages are binary")
            return
        try:
            header, payload = unpacked(message)
            if self._key is None:
                self._hello(header)
            elif self._server._opener is not None and self._server._opener.answers(header):
                self._server._opener.receive(self, self._send, header, payload)
            else:
                if self._server._opener is not None and header.get("type") == "cancel":
                    self._server._opener.cancel(self, header)
                if self._client is not None:
                    self._to_session(self._client, header)
        except WavesplatError as error:
            self._refuse(4400, str(error))

    def _to_session(self, client: Client, header: dict[str, Any]) -> None:
        if header.get("type") == "patch" and self._is_too_fast():
            raise ArgumentError(f"more than {MAX_PATCHES_PER_S} patches a second")
        if header.get("type") == "ask" and header.get("question") == "token":
            # The session knows no links: they are the server's.
            token = self._server.tokens.new()
            self._send({"type": "answer", "id": header.get("id"), "token": token}, b"")
        else:
            client.receive(header)

    def on_close(self) -> None:
        """Let go of a page that has gone."""
        self._server._sockets.discard(self)
        if self._key is not None:
            self._server.tokens.leave(self._key)
        if self._deadline is not None:
            self._deadline.cancel()
        if self._server._opener is not None:
            self._server._opener.leave(self)
        if self._client is not None:
            self._client.close()
            self._client = None

    def join(self) -> None:
        """Show the session, as soon as both are there."""
        session, opener = self._server._session, self._server._opener
        if self._key is None or self._client is not None:
            return
        if session is None:
            if opener is not None:
                self._write(packed({"type": "start", "session": self._key, **opener.offered()}))
            return
        try:
            self._client = session.connect(self._send)
        except ArgumentError as error:
            self.fail(str(error))
            return
        self._client.welcome(session=self._key)

    def send_progress(self, message: dict[str, Any] | None) -> None:
        """Send the progress of opening the volume."""
        if self._key is not None and self._client is None and message is not None:
            self._write(packed(message))

    def fail(self, message: str) -> None:
        """Send the error with which the volume could not be opened."""
        if self._key is not None:
            self._write(packed({"type": "failed", "id": None, "code": "open", "message": message}))
            self._server.has_reported.set()

    def _hello(self, header: dict[str, Any]) -> None:
        if header.get("type") != "hello":
            raise ArgumentError("the first message must be a hello")
        if header.get("protocol") != PROTOCOL:
            raise ArgumentError(f"this server speaks protocol {PROTOCOL}; load the page again")
        self._key = self._server.tokens.key_for(header.get("token"), header.get("session"))
        if self._key is None:
            self._refuse(4401, "the link was used, or is not of this viewer")
            return
        self._deadline.cancel()
        self._server.forget_handed_over()
        if self._server._failure is not None:
            self.fail(self._server._failure)
        self.send_progress(self._server._progress)
        self.join()

    def _is_too_fast(self) -> bool:
        second = int(self._server._loop.time())
        self._n_patches = self._n_patches + 1 if second == self._second else 1
        self._second = second
        return self._n_patches > MAX_PATCHES_PER_S

    def _send(self, header: dict[str, Any], payload: bytes) -> None:
        """Send a message, from any thread."""
        message = packed(header, payload)
        self._server._later(lambda: self._write(message))

    def _write(self, message: bytes) -> None:
        with contextlib.suppress(tornado.websocket.WebSocketClosedError):
            self.write_message(message, binary=True)

    def _refuse(self, code: int, reason: str) -> None:
        # A reason may have 123 bytes.
        self.close(code, reason.encode()[:120].decode(errors="ignore"))
