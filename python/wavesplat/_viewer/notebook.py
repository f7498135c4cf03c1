"""The viewer as a widget of a notebook. Messages travel through the widget's own channel, so that no port is needed.

They are what the socket carries (`framing`), header as content and payload as buffer, with the field `page`: a cell may
show the widget more than once, and a notebook may be open in two windows.
"""

from __future__ import annotations

import base64
import threading
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from wavesplat._system.libraries import library
from wavesplat._viewer.opening.opening import Opener
from wavesplat._viewer.server import messages
from wavesplat._viewer.server.client_files import widget_source
from wavesplat._viewer.server.messages import PROTOCOL
from wavesplat._viewer.session.picturing import picture_of
from wavesplat._viewer.session.session import Client, Session
from wavesplat.errors import WavesplatError

if TYPE_CHECKING:
    from wavesplat._viewer.viewer import Viewer

#: Pixels of the picture that a saved notebook shows.
STILL_SIZE = (640, 480)
#: Largest number of pages of a widget: they may go without a message.
MAX_PAGES = 8


def check() -> None:
    """Raise a `LibraryError` where notebooks cannot be served."""
    library("anywidget", extra="notebook")


def bundle_of(viewer: Viewer, **options: Any) -> Any:
    """The output of a cell: the widget, and a still picture for where notebooks are only read."""
    if viewer._widget is None:
        viewer._widget = widget_of(viewer._session, viewer._opener)
    found = viewer._widget._repr_mimebundle_(**options)
    data, metadata = found if isinstance(found, tuple) else (found, {})
    still = messages.png_bytes(picture_of(viewer._session.state, "3d", STILL_SIZE).rgba)
    return {**data, "text/plain": repr(viewer), "image/png": base64.b64encode(still).decode()}, metadata


def widget_of(session: Session, opener: Opener) -> Any:
    """A widget that shows a session, and opens files in it."""
    anywidget = library("anywidget", extra="notebook")
    kind = _widget_class(anywidget)
    widget = kind()
    _Pages(session, widget, opener)
    return widget


_CLASSES: dict[str, Any] = {}


def _widget_class(anywidget: Any) -> Any:
    """The widget's class, made when the first widget is needed, since the library may be missing."""
    if "viewer" not in _CLASSES:
        fields = {"_esm": widget_source(), "__module__": __name__}
        _CLASSES["viewer"] = type("ViewerWidget", (anywidget.AnyWidget,), fields)
    return _CLASSES["viewer"]


class _Pages:
    """The pages of a widget, by the name that each gives itself."""

    def __init__(self, session: Session, widget: Any, opener: Opener) -> None:
        self._session, self._widget, self._opener = session, widget, opener
        self._clients: dict[str, Client] = {}
        # Handlers may run in several threads.
        self._lock = threading.RLock()
        widget.on_msg(self._receive)

    def _receive(self, _widget: Any, content: Any, buffers: Any) -> None:
        if not isinstance(content, Mapping) or not isinstance(content.get("page"), str):
            return
        page = content["page"][:64]
        with self._lock:
            kind = content.get("type")
            client = self._clients.get(page)
            try:
                if kind == "bye":
                    if client is not None:
                        self._drop(page)
                elif kind == "hello":
                    self._hello(page, client, content)
                elif client is not None and self._opener.answers(content):
                    payload = bytes(buffers[0]) if buffers else b""
                    self._opener.receive(page, lambda header, sent: self._send(page, header, sent), content, payload)
                elif client is not None:
                    if kind == "cancel":
                        self._opener.cancel(page, content)
                    client.receive(content)
                else:
                    self._send(
                        page, {"type": "failed", "id": None, "code": "unknown", "message": "say hello first"}, b""
                    )
            except WavesplatError as error:
                self._send(page, {"type": "failed", "id": None, "code": "message", "message": str(error)}, b"")

    def _hello(self, page: str, client: Client | None, content: Mapping[str, Any]) -> None:
        if content.get("protocol") != PROTOCOL:
            message = f"this kernel speaks protocol {PROTOCOL} of the viewer; run the cell again"
            self._send(page, {"type": "failed", "id": None, "code": "protocol", "message": message}, b"")
            return
        if client is None:
            # The oldest pages, which may have gone without a message, make room.
            while len(self._clients) >= MAX_PAGES:
                self._drop(next(iter(self._clients)))
            client = self._clients[page] = self._session.connect(
                lambda header, payload: self._send(page, header, payload)
            )
        client.welcome(session="")

    def _drop(self, page: str) -> None:
        """Forget a page, and what it sent."""
        self._clients.pop(page).close()
        self._opener.leave(page)

    def _send(self, page: str, header: dict[str, Any], payload: bytes) -> None:
        self._widget.send({**header, "page": page}, [payload] if payload else [])
