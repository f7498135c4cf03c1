"""Progress of a picture at rest, for the ring that the page shows in the corner of its view."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any

#: Seconds without a word, since most pictures are done by then; and seconds between two messages.
SILENT_S, EVERY_S = 0.3, 0.1


class Refining:
    """Messages with the share of a picture that is done, which never falls; none of pictures that are quick.

    send : sends a message to the page.
    view : name of the view.
    is_long : whether the picture is known to take long, so that the first message goes at once.
    """

    def __init__(self, send: Callable[[dict[str, Any]], object], view: str, *, is_long: bool) -> None:
        self._send, self._view = send, view
        self._next_s = time.monotonic() + SILENT_S
        self._part: float | None = None
        if is_long:
            self._report(0.0)

    def advance(self, part: float) -> None:
        """Report the share that is done, 0 to 1, if it is time to."""
        if time.monotonic() >= self._next_s and part > (self._part or 0.0):
            self._report(min(part, 1.0))

    def end(self) -> None:
        """Report that nothing is drawn any more, after other messages."""
        if self._part is not None:
            self._part = None
            self._report(None)

    def _report(self, part: float | None) -> None:
        self._part, self._next_s = part, time.monotonic() + EVERY_S
        self._send({"type": "progress", "id": None, "view": self._view, "part": part, "text": ""})
