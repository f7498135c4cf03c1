"""A session: one state, the pages that show it, and the thread that draws for them; changes are confirmed to pages.

Latest wins. Every view of every page has room for one request, which a newer one replaces, and at most two frames are
on their way; pages confirm those that they have shown. Frames that were begun while something moves are finished, and
pictures at rest given up when something changes. A session knows no sockets: pages are functions that take messages.
"""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from wavesplat import _native
from wavesplat._model.arguments.sampling import Sampling
from wavesplat._picture.picture import Picture
from wavesplat._system.values import described
from wavesplat._viewer.page_requests.questions import Answering, failure_of
from wavesplat._viewer.server import messages
from wavesplat._viewer.session.info import welcome_of
from wavesplat._viewer.session.pace import BUDGETS_MS, Pace, Refining, Settings, frame_fields, rungs_of
from wavesplat._viewer.session.picturing import picture_of, pictures_at_rest
from wavesplat._viewer.session.previews import has_lazy
from wavesplat._viewer.session.state import ViewerState, changes_picture, changes_slices, is_same
from wavesplat._viewer.slices.slice_values import SliceValues, slice_values
from wavesplat.errors import ArgumentError, CancelledError, WavesplatError

#: Views of a page: the picture in space, and slices across each axis.
VIEWS = ("3d", "z", "y", "x")

# Confirmation of a page's changes: the state after them, and where it differs from what the page has.
#
# A page shows its changes before they are confirmed. The session completes and checks what a page sends, so the state
# that it takes may differ from the page's; the differences go back with the confirmation. `web/src/state/replica.ts`
# does the same for the page. Fields that differ are sent whole, so a page that makes its own changes and then these has
# the session's document, whatever was completed or corrected.


def confirmed(state: ViewerState, operations: Sequence[Any]) -> tuple[ViewerState, list[dict[str, Any]]]:
    """The state after a page's changes, and the operations that turn the page's document into its document.

    Raises
    ------
    ArgumentError
        If the changes cannot be made; the message names the field.
    """
    if not operations:
        return state, []
    of_page = _native.patched(state.document, operations)
    after = state.replaced(of_page)
    return after, [
        {"op": "add", "path": f"/{name}", "value": value}
        for name, value in after.document.items()
        if not is_same(value, of_page[name])
    ]


# A session: one state, the pages that show it, and the thread that draws for them.

#: Function that sends header and payload to a page; called from any thread, and must not wait.
Send = Callable[[dict[str, Any], bytes], None]

#: Seconds that all threads of a session together have to finish when it ends.
CLOSING_S = 2.0
#: Seconds without a change after which a picture is at rest, where the page does not say so before.
REST_S = 0.12
#: Frames on their way to a page, for each view.
MAX_IN_FLIGHT = 2
#: Milliseconds of a picture at rest from which on a quick frame goes before it.
SLOW_MS = 100.0
#: Largest numbers: pixels of a view, along a side and in all; pages.
MAX_SIDE, MAX_PIXELS, MAX_CLIENTS = 8192, 1 << 24, 8
#: JPEG quality, and whether colours have half the resolution, by how long a frame takes to be confirmed, in ms.
LINKS = ((120.0, 90, False), (400.0, 80, True), (float("inf"), 60, True))
NO_BUDGET_MS = float("inf")
#: Coarse sampling until the error is known.
GUESS = Sampling(sheets_per_slice=1.0, oversampling=0.75)


@dataclass
class _Pane:
    """A view of a page."""

    size: tuple[int, int]
    number: int = 0
    in_flight: dict[int, float] = field(default_factory=dict)
    #: Whether the newest state is yet to be drawn, and to be drawn at rest.
    is_stale: bool = True
    wants_rest: bool = True
    #: Time of its newest change, and number of changes, by which drawing notices another one.
    changed_s: float = 0.0
    n_changes: int = 0


class Client:
    """A page of a session."""

    def __init__(self, session: Session, send: Send) -> None:
        self._session, self._send = session, send
        self.panes: dict[str, _Pane] = {}
        self.seq = 0
        self.is_moving = False
        #: Milliseconds from sending a frame to its confirmation.
        self.delay_ms = 0.0
        self.is_open = True

    def send(self, header: dict[str, Any], payload: bytes = b"") -> None:
        """Send a message to the page, if it is still there."""
        if self.is_open:
            self._send(header, payload)

    def welcome(self, **more: Any) -> None:
        """Send the first message to the page."""
        self.send({"type": "welcome", **more, **welcome_of(self._session.state)})

    def receive(self, header: Mapping[str, Any]) -> None:
        """Take a message from the page.

        Raises
        ------
        ArgumentError
            If it is no valid message; the page is broken, or is not ours.
        """
        self._session._receive(self, header)

    def close(self) -> None:
        """Leave the session: the page has gone."""
        self._session._leave(self)


class Session:
    """One state and its pages.

    on_change : called with each new state and its cause ("page" or "python"), in the thread of the change.
    """

    def __init__(self, state: ViewerState, on_change: Callable[[ViewerState, str], object] | None = None) -> None:
        self._state = state
        self._on_change = on_change
        self._clients: list[Client] = []
        self._changed = threading.Condition(threading.RLock())
        self._pace = Pace()
        #: The scene whose error is known for a wanted PSNR, and the sampling that the last such picture had.
        self._measured_scene: Any = None
        self._last_sampling = GUESS
        self._is_open = True
        self._answering = Answering(self._changed, lambda: self._state, self._is_at_rest)
        drawing = threading.Thread(target=self._draw_all, name="wavesplat-viewer-drawing", daemon=True)
        drawing.start()
        self._threads = [drawing, *self._answering.threads]

    # Called by others

    @property
    def state(self) -> ViewerState:
        """The newest state."""
        return self._state

    @property
    def n_clients(self) -> int:
        """Number of pages that show the session."""
        return len(self._clients)

    def connect(self, send: Send) -> Client:
        """Connect a new page.

        Raises
        ------
        ArgumentError
            If there are too many pages.
        """
        with self._changed:
            if not self._is_open:
                raise ArgumentError("the viewer is closed; open it again")
            if len(self._clients) >= MAX_CLIENTS:
                raise ArgumentError(f"{MAX_CLIENTS} pages show this viewer, and no more can; close one of them")
            client = Client(self, send)
            self._clients.append(client)
            return client

    def change(self, state: ViewerState) -> None:
        """Set another state, from Python; pages follow."""
        self._become(state, None, "python")

    def close(self) -> None:
        """End the session: no page is answered any more, and threads end."""
        with self._changed:
            self._is_open = False
            self._answering.close()
            for client in self._clients:
                client.is_open = False
            self._clients.clear()
            self._changed.notify_all()
        # One time limit for all threads; those that still run are abandoned, which is safe: none of them writes a file.
        until = time.monotonic() + CLOSING_S
        for thread in self._threads:
            if thread is not threading.current_thread():
                thread.join(timeout=max(until - time.monotonic(), 0.0))

    # Messages of pages

    def _receive(self, client: Client, header: Mapping[str, Any]) -> None:
        kind = header.get("type")
        if kind == "patch":
            self._patch(client, header)
        elif kind == "view":
            self._show(client, header)
        elif kind == "shown":
            self._shown(client, header)
        elif kind == "ask":
            self._answering.ask(client, _whole(header, "id"), str(header.get("question")), header.get("arguments", {}))
        elif kind == "cancel":
            self._answering.cancel(client, _whole(header, "id"))
        else:
            raise ArgumentError(f"message: type is {described(kind)}; use patch, view, shown, ask or cancel")

    def _patch(self, client: Client, header: Mapping[str, Any]) -> None:
        seq, operations, moving = _whole(header, "seq"), header.get("operations"), header.get("moving", False)
        if not isinstance(operations, list):
            raise ArgumentError(f"message: operations is {described(operations)}; it must be a list")
        with self._changed:
            client.is_moving = bool(moving)
            client.seq = seq
            try:
                state, corrections = confirmed(self._state, operations)
            except WavesplatError as error:
                client.send({"type": "failed", "id": None, "seq": seq, "code": "refused", "message": str(error)})
                return
            if operations:
                self._become(state, client, "page", [*operations, *corrections])
            client.send({"type": "confirmed", "seq": seq, "corrections": corrections})
            # The end of a gesture: what moves no more is drawn at rest at once.
            for pane in client.panes.values():
                if not moving and pane.wants_rest:
                    pane.changed_s = 0.0
            self._changed.notify_all()

    def _show(self, client: Client, header: Mapping[str, Any]) -> None:
        view, size = header.get("view"), header.get("size")
        if view not in VIEWS:
            raise ArgumentError(f"message: view is {described(view)}; use one of: {', '.join(VIEWS)}")
        with self._changed:
            if size is None:
                client.panes.pop(view, None)
                return
            if not (isinstance(size, list) and len(size) == 2 and all(_is_side(n) for n in size)):
                raise ArgumentError(f"message: size is {described(size)}; it must be [width, height], up to {MAX_SIDE}")
            width, height = size
            if width * height > MAX_PIXELS:
                raise ArgumentError(f"message: {width} x {height} are more than {MAX_PIXELS} pixels")
            before = client.panes.get(view)
            if before is None or before.size != (width, height):
                pane = _Pane((width, height)) if before is None else before
                pane.size = (width, height)
                client.panes[view] = pane
                self._touch(pane)
                # Another page has a view of another shape, or comes back with what was turned in it.
                if view == "3d" and len(self._clients) == 1:
                    self._frame_first(width / height)
            self._changed.notify_all()

    def _frame_first(self, aspect: float) -> None:
        """Frame a first picture that nobody has turned for the shape of its view, as in a file of that size."""
        state = self._state.framed_first(aspect)
        if state is not self._state:
            operation = {"op": "replace", "path": "/camera", "value": state.document["camera"]}
            self._become(state, None, "python", [operation])

    def _shown(self, client: Client, header: Mapping[str, Any]) -> None:
        with self._changed:
            pane = client.panes.get(str(header.get("view")))
            sent = None if pane is None else pane.in_flight.pop(_whole(header, "frame"), None)
            if sent is not None:
                delay = (time.monotonic() - sent) * 1e3
                client.delay_ms = delay if client.delay_ms == 0 else 0.8 * client.delay_ms + 0.2 * delay
            self._changed.notify_all()

    def _leave(self, client: Client) -> None:
        with self._changed:
            client.is_open = False
            client.panes.clear()
            if client in self._clients:
                self._clients.remove(client)
            self._changed.notify_all()

    # The state

    def _become(
        self, state: ViewerState, client: Client | None, cause: str, operations: Sequence[Any] | None = None
    ) -> None:
        with self._changed:
            before, self._state = self._state, state
            picture, slices = changes_picture(before, state), changes_slices(before, state)
            for one in self._clients:
                for view, pane in one.panes.items():
                    if picture if view == "3d" else slices:
                        self._touch(pane)
                if one is not client:
                    changes = operations or [{"op": "replace", "path": "", "value": state.document}]
                    one.send(
                        {
                            "type": "patch",
                            "operations": list(changes),
                            "cause": "python" if client is None else "other view",
                            # The page's later changes come after this one, and are made again on top of it.
                            "seq": one.seq,
                        }
                    )
            self._changed.notify_all()
        if self._on_change is not None:
            self._on_change(state, cause)

    @staticmethod
    def _touch(pane: _Pane) -> None:
        pane.is_stale = pane.wants_rest = True
        pane.changed_s = time.monotonic()
        pane.n_changes += 1

    # Drawing

    def _draw_all(self) -> None:
        while True:
            with self._changed:
                task = None
                while self._is_open and (task := self._next()) is None:
                    self._changed.wait(self._until_rest())
                if not self._is_open or task is None:
                    return
            client, view, pane, at_rest = task
            try:
                if client is None:
                    self._measure()
                else:
                    self._draw(client, view, pane, at_rest)
            except Exception as error:  # noqa: BLE001 - the thread must go on, and the error is reported
                with self._changed:
                    pane.wants_rest = pane.is_stale
                if client is not None:
                    client.send({**failure_of(error), "seq": client.seq})
            with self._changed:  # questions that wait for rest
                self._changed.notify_all()

    def _next(self) -> tuple[Client | None, str, _Pane, bool] | None:
        """The next task: first what moves, then pictures at rest; then errors are measured for the next move."""
        ready = [
            (client, view, pane)
            for client in self._clients
            for view, pane in client.panes.items()
            if len(pane.in_flight) < MAX_IN_FLIGHT
        ]
        # The oldest change first, so that every view gets its turn.
        for client, view, pane in sorted(ready, key=lambda one: one[2].changed_s):
            if pane.is_stale and (client.is_moving or self._is_slow(view, pane)):
                return client, view, pane, False
        now = time.monotonic()
        for client, view, pane in sorted(ready, key=lambda one: one[1] != "3d"):
            if pane.wants_rest and (not client.is_moving or now - pane.changed_s >= REST_S):
                return client, view, pane, True
        if self._should_measure(ready):
            return None, "3d", _Pane((1, 1)), False
        return None

    def _is_at_rest(self) -> bool:
        """Whether no view waits for its picture at rest."""
        panes = [pane for client in self._clients for pane in client.panes.values()]
        # A page that confirms no frames gets none, and keeps nobody waiting.
        return not any(pane.wants_rest and len(pane.in_flight) < MAX_IN_FLIGHT for pane in panes)

    def _is_slow(self, view: str, pane: _Pane) -> bool:
        """Whether the picture at rest takes so long that a quick one goes before."""
        expected = self._pace.expected_ms(self._look(view), Settings(None), pane.size[0] * pane.size[1])
        # A look that was never drawn is prepared first, and slow for once.
        return expected is None or expected > SLOW_MS

    def _until_rest(self) -> float | None:
        """Seconds until a picture is at rest; None if none waits for that."""
        due = [
            pane.changed_s + REST_S - time.monotonic()
            for client in self._clients
            for pane in client.panes.values()
            if pane.wants_rest and len(pane.in_flight) < MAX_IN_FLIGHT
        ]
        return max(min(due), 0.001) if due else None

    def _look(self, view: str) -> tuple[Any, ...]:
        """Key of measured times of frames: all that they depend on besides pixels."""
        state = self._state
        looks = tuple(str(layer["look"]["name"]) for layer in state.document["layers"] if layer["visible"])
        return "3d" if view == "3d" else "slice", looks, str(state.options["composite"]), state.options["kernel"]

    def _draw(self, client: Client, view: str, pane: _Pane, at_rest: bool) -> None:
        with self._changed:
            state, seq, size, n_changes = self._state, client.seq, pane.size, pane.n_changes
            waited_ms = (time.monotonic() - pane.changed_s) * 1e3 if pane.changed_s else 0.0
            pane.is_stale = False
            moving = state.view["quality"]["moving"]
            rungs = rungs_of(moving, is_slice=view != "3d")
            look = self._look(view)
            settings = Settings(None) if at_rest else self._pace.chosen(look, rungs)
        begun = time.monotonic()
        refining = Refining(client.send, view, is_long=at_rest and view == "3d" and has_lazy(state.scene))

        def goes_on(part: float) -> bool:
            if at_rest:
                refining.advance(part)
            # A picture at rest is given up when something changes.
            return self._is_open and (not at_rest or (pane.n_changes == n_changes and client.is_open))

        try:
            pictures = self._pictures(state, view, size, settings, goes_on, at_rest=at_rest)
            picture = next(pictures)
            # For lazy volumes, coarser pictures and parts of the last one go before it.
            for better in pictures:
                self._send_part(client, view, state, seq, picture)
                picture = better
        except CancelledError:
            return
        except Exception as error:  # noqa: BLE001 - whatever fails, the page gets a message
            with self._changed:
                pane.wants_rest = pane.n_changes != n_changes and pane.wants_rest
            client.send({**failure_of(error), "seq": seq})
            return
        finally:
            refining.end()
        drawn = time.monotonic()
        fmt, payload = self._encoded(client, picture, at_rest)
        encoded = time.monotonic()
        n_px = size[0] * size[1]
        with self._changed:
            budget_ms = BUDGETS_MS.get(moving, NO_BUDGET_MS) if not at_rest else NO_BUDGET_MS
            self._pace.record(look, rungs, settings, ms=(encoded - begun) * 1e3, n_px=n_px, budget_ms=budget_ms)
            if pane.n_changes == n_changes and at_rest:
                pane.wants_rest = False
            if not client.is_open or client.panes.get(view) is not pane:
                return
            ms = {"wait": waited_ms, "render": (drawn - begun) * 1e3, "encode": (encoded - drawn) * 1e3}
            header = {
                **self._counted(pane, view, seq),
                **frame_fields(state, view, picture, settings, at_rest=at_rest),
                "format": fmt,
                "at_rest": at_rest and size == picture.size,
                "ms": {name: round(value, 2) for name, value in ms.items()},
            }
        client.send(header, payload)

    def _pictures(
        self,
        state: ViewerState,
        view: str,
        size: tuple[int, int],
        settings: Settings,
        goes_on: Callable[[float], bool],
        *,
        at_rest: bool,
    ) -> Iterator[Picture | SliceValues]:
        if view != "3d" and at_rest:
            yield slice_values(state, view, size)
        elif view == "3d" and at_rest and has_lazy(state.scene):
            yield from pictures_at_rest(state, size, goes_on)
        else:
            yield self._picture(state, view, size, settings, goes_on)

    def _send_part(
        self, client: Client, view: str, state: ViewerState, seq: int, picture: Picture | SliceValues
    ) -> None:
        """Send a picture that a better one follows, if the page has shown those before."""
        fmt, payload = self._encoded(client, picture, at_rest=False)
        with self._changed:
            pane = client.panes.get(view)
            if not client.is_open or pane is None or len(pane.in_flight) >= MAX_IN_FLIGHT:
                return
            header = {
                **self._counted(pane, view, seq),
                **frame_fields(state, view, picture, Settings(None), at_rest=False),
                "format": fmt,
                "at_rest": False,
                "ms": {"wait": 0.0, "render": 0.0, "encode": 0.0},
            }
        client.send(header, payload)

    @staticmethod
    def _counted(pane: _Pane, view: str, seq: int) -> dict[str, Any]:
        """The first fields of a frame, which is on its way from now on."""
        pane.number += 1
        pane.in_flight[pane.number] = time.monotonic()
        return {"type": "frame", "view": view, "number": pane.number, "seq": seq}

    def _picture(
        self, state: ViewerState, view: str, size: tuple[int, int], settings: Settings, goes_on: Callable[[float], bool]
    ) -> Picture:
        if view != "3d" or settings.psnr is None:
            return picture_of(state, view, size, scale=settings.scale, progress=goes_on)
        if self._measured_scene is state.scene and settings.scale > 0.7:
            picture = picture_of(state, view, size, psnr=settings.psnr, scale=settings.scale)
            self._keep_sampling(picture)
            return picture
        # While a look is being changed its error is unknown: the last sampling whose error was known is used.
        return picture_of(state, view, size, sampling=self._last_sampling, scale=settings.scale)

    def _should_measure(self, ready: Sequence[tuple[Client, str, _Pane]]) -> bool:
        if self._measured_scene is self._state.scene or self._state.view["quality"]["moving"] == "exact":
            return False
        return any(view == "3d" and not client.is_moving for client, view, _ in ready)

    def _measure(self) -> None:
        """Draw once with a wanted PSNR, which measures the errors of the scene's pictures and keeps them."""
        with self._changed:
            state = self._state
            pane = next((client.panes["3d"] for client in self._clients if "3d" in client.panes), None)
            if pane is None:
                return
            n_changes = pane.n_changes

        def goes_on(_: float) -> bool:
            return pane.n_changes == n_changes and self._is_open

        try:
            picture = picture_of(state, "3d", pane.size, psnr=35.0, progress=goes_on)
        except CancelledError:
            return
        except Exception:
            # Errors are not measured again; the next frame reports what is wrong.
            self._measured_scene = state.scene
            raise
        self._keep_sampling(picture)
        self._measured_scene = state.scene

    def _keep_sampling(self, picture: Picture) -> None:
        """Keep the sampling of a picture whose error is known; its report has none where nothing is visible."""
        report = picture.report
        if "sheets_per_slice" in report and "oversampling" in report:
            self._last_sampling = Sampling(
                sheets_per_slice=report["sheets_per_slice"], oversampling=abs(report["oversampling"])
            )

    def _encoded(self, client: Client, picture: Picture | SliceValues, at_rest: bool) -> tuple[str, bytes]:
        if isinstance(picture, SliceValues):
            return "values", picture.payload
        if at_rest:
            return "png", messages.png_bytes(picture.rgba)
        _, quality, subsampled = next(link for link in LINKS if client.delay_ms <= link[0])
        return "jpeg", messages.jpeg_bytes(picture.rgba, quality, subsampled=subsampled)


def _whole(header: Mapping[str, Any], name: str) -> int:
    value = header.get(name)
    if not isinstance(value, int) or isinstance(value, bool) or not 0 <= value < 1 << 53:
        raise ArgumentError(f"message: {name} is {described(value)}; it must be a whole number")
    return value


def _is_side(value: object) -> bool:
    return isinstance(value, int) and not isinstance(value, bool) and 1 <= value <= MAX_SIDE
