"""Opening files in the page: what pages send, examples, and the files that the command opened last.

A page asks in two steps, since what is done with a file depends on what it is: "open" reads it and tells what was
found, "show" puts it in the place of what is open, over it, or beside it. The answer to "show" is a list of changes,
which the page makes as one step of undo. Without anything open, "open" begins the session.

Questions that read run in a thread of their own; the bytes of files are written as they come.
"""

from __future__ import annotations

import itertools
import queue
import threading
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeAlias

from wavesplat._files import json_text
from wavesplat._model.argument_types import described
from wavesplat._viewer import start_page
from wavesplat._viewer.open_changes import added, replaced
from wavesplat._viewer.open_paths import Found, Several, found_at, scene_with
from wavesplat._viewer.recent import Recent, last_part
from wavesplat._viewer.state import ViewerState
from wavesplat._viewer.upload_contents import paths_in
from wavesplat._viewer.upload_readers import readers_of
from wavesplat._viewer.uploads import Upload, Uploads
from wavesplat.errors import ArgumentError, FileError, WavesplatError

__all__ = ["Opener"]

Send: TypeAlias = Callable[[dict[str, Any], bytes], None]
Answer: TypeAlias = tuple[dict[str, Any], bytes]

#: Largest number of files that are read and not shown yet, and of questions that wait.
MAX_READ, MAX_WAITING = 4, 64
HOWS = ("replace", "overlay", "labels")


@dataclass(frozen=True)
class _Read:
    """The contents of a path that was opened, the number of its upload, and the page that asked."""

    found: tuple[Found, ...]
    upload: int | None
    owner: Any


class Opener:
    """Opens files for the pages of a viewer.

    state : gives the newest state of the session; None while nothing is open.
    begin : shows a first state; None where something is open from the beginning.
    recent : files that the command opened; None where there is no command.
    """

    def __init__(
        self,
        state: Callable[[], ViewerState | None],
        begin: Callable[[ViewerState], object] | None = None,
        recent: Recent | None = None,
    ) -> None:
        self._state, self._begin, self._recent = state, begin, recent
        self._uploads = Uploads()
        self._read: dict[int, _Read] = {}
        self._next = 1
        #: Questions by urgency, then by their order; None ends the thread.
        self._waiting: queue.PriorityQueue[tuple[int, int, Callable[[], None] | None]] = queue.PriorityQueue()
        self._order = itertools.count()
        self._questions: dict[str, Callable[[Any, Mapping[str, Any], bytes], Answer]] = {
            "offered": lambda *_: (self.offered(), b""),
            "clear_recent": self._clear_recent,
            "example_picture": self._example_picture,
            "upload_begin": self._upload_begin,
            "upload": self._upload,
            "upload_discard": self._upload_discard,
            "open": self._open,
            "show": self._show,
        }
        self._thread: threading.Thread | None = None

    def offered(self) -> dict[str, Any]:
        """The offers of the start page."""
        return start_page.offered(self._recent)

    def takes(self, header: Mapping[str, Any]) -> bool:
        """Whether a message is a question that is answered here."""
        return header.get("type") == "ask" and header.get("question") in self._questions

    def receive(self, owner: Any, send: Send, header: Mapping[str, Any], payload: bytes) -> None:
        """Answer a question, now or in the thread that reads. owner : the page, whose uploads end with it.

        Raises
        ------
        ArgumentError
            If the message is none; the page is broken, or is not ours.
        """
        number, question, arguments = header.get("id"), str(header.get("question")), header.get("arguments", {})
        if not isinstance(number, int) or isinstance(number, bool) or not 0 <= number < 1 << 53:
            raise ArgumentError(f"message: id is {described(number)}; it must be a whole number")
        if not isinstance(arguments, Mapping):
            raise ArgumentError(f"{question}: the arguments are {described(arguments)}; give an object")
        json_text.check_values(arguments, question)

        def answer() -> None:
            self._answer(send, number, lambda: self._questions[question](owner, arguments, payload))

        if question in ("upload", "upload_begin"):
            answer()
            return
        if self._thread is None:
            self._thread = threading.Thread(target=self._work, name="wavesplat-viewer-opening", daemon=True)
            self._thread.start()
        if self._waiting.qsize() >= MAX_WAITING:
            message = "too many questions wait for an answer; ask again"
            send({"type": "failed", "id": number, "code": "busy", "message": message}, b"")
            return
        # Pictures of examples take a while, and a file that is opened should not wait for them.
        self._waiting.put((int(question == "example_picture"), next(self._order), answer))

    def leave(self, owner: Any) -> None:
        """A page has gone: its unfinished uploads, and what it opened and did not show, are removed."""
        self._uploads.leave(owner)
        for number in [number for number, read in list(self._read.items()) if read.owner == owner]:
            self._forget(number)

    def close(self) -> None:
        """Remove all files that pages sent."""
        self._uploads.close()
        if self._thread is not None:
            self._waiting.put((-1, next(self._order), None))
            if self._thread is not threading.current_thread():
                self._thread.join(timeout=5)

    def _work(self) -> None:
        while (task := self._waiting.get()[2]) is not None:
            task()

    @staticmethod
    def _answer(send: Send, number: int, make: Callable[[], Answer]) -> None:
        try:
            fields, payload = make()
        except Exception as error:  # noqa: BLE001 - whatever fails, the page has to be told
            is_ours = isinstance(error, WavesplatError | MemoryError)
            text = str(error) if is_ours else f"opening failed: {type(error).__name__}: {error}"
            message = text or "there is not enough memory for it"
            send({"type": "failed", "id": number, "code": "open", "message": message}, b"")
            return
        send({"type": "answer", "id": number, **fields}, payload)

    # Questions

    def _clear_recent(self, *_: Any) -> Answer:
        if self._recent is not None:
            self._recent.clear()
        return self.offered(), b""

    @staticmethod
    def _example_picture(_owner: Any, arguments: Mapping[str, Any], _payload: bytes) -> Answer:
        return {}, start_page.example_picture(str(arguments.get("name")))

    def _upload_begin(self, owner: Any, arguments: Mapping[str, Any], _: bytes) -> Answer:
        return {"upload": self._uploads.begin(owner, arguments.get("files"), arguments.get("bytes")).number}, b""

    def _upload(self, owner: Any, arguments: Mapping[str, Any], payload: bytes) -> Answer:
        upload = self._uploads.get(arguments.get("upload"))
        if upload.owner != owner:
            raise ArgumentError("upload: it is another page's")
        return {"received": upload.write(arguments.get("path"), arguments.get("offset"), payload)}, b""

    def _upload_discard(self, owner: Any, arguments: Mapping[str, Any], _: bytes) -> Answer:
        upload = self._own_upload(owner, arguments)
        self._read = {key: read for key, read in self._read.items() if read.upload != upload.number}
        self._uploads.discard(upload.number)
        return {}, b""

    def _own_upload(self, owner: Any, arguments: Mapping[str, Any]) -> Upload:
        upload = self._uploads.get(arguments.get("upload"))
        if upload.owner != owner:
            raise ArgumentError("upload: it is another page's")
        return upload

    def _shown(self, found: Sequence[Found], upload: int | None) -> None:
        """Let the files of an upload go with the last object that reads on from them."""
        if upload is not None:
            self._uploads.discard_after(upload, (reader for one in found for reader in readers_of(one)))

    def _open(self, owner: Any, arguments: Mapping[str, Any], _: bytes) -> Answer:
        state = self._state()
        upload = self._own_upload(owner, arguments).number if "upload" in arguments else None
        try:
            found = self._found(owner, arguments, state)
        except Several as several:
            return {
                "several": {"option": several.option, "names": several.names, "described": several.described},
                "message": str(several),
            }, b""
        except Exception:
            self._uploads.discard(upload)
            raise
        notes = [note for one in found for note in one.notes]
        told = {"found": [{"kind": one.kind, "name": one.name} for one in found], "notes": notes}
        if state is None and self._begin is not None:
            with_volumes = any(one.kind == "volume" for one in found)
            self._begin(ViewerState.of(scene_with(None, found, as_labels=with_volumes)))
            self._shown(found, upload)
            return {**told, "shown": True}, b""
        while len(self._read) >= MAX_READ:
            self._forget(next(iter(self._read)))
        number, self._next = self._next, self._next + 1
        self._read[number] = _Read(found, upload, owner)
        return {**told, "shown": False, "opened": number}, b""

    def _show(self, _owner: Any, arguments: Mapping[str, Any], _: bytes) -> Answer:
        state, how, number = self._state(), arguments.get("how"), arguments.get("opened")
        if how not in HOWS:
            raise ArgumentError(f"show: how is {described(how)}; use one of: {', '.join(HOWS)}")
        read = self._read.get(number) if isinstance(number, int) else None
        if state is None or read is None:
            raise ArgumentError("show: this is not open any more; open it again")
        if how == "replace":
            with_volumes = any(one.kind == "volume" for one in read.found)
            scene = scene_with(None, read.found, as_labels=with_volumes)
            operations = replaced(state, scene, _aspect(arguments.get("aspect")))
        else:
            operations = added(state, scene_with(state.scene, read.found, as_labels=how == "labels"))
        del self._read[number]  # type: ignore[arg-type]
        self._shown(read.found, read.upload)
        return {"operations": operations}, b""

    def _forget(self, number: int) -> None:
        self._uploads.discard(self._read.pop(number).upload)

    def _found(self, owner: Any, arguments: Mapping[str, Any], state: ViewerState | None) -> tuple[Found, ...]:
        """The contents of the upload, the example or the recent file that a question names."""
        unit = None if state is None else state.scene.layers[0].drawn.facts.unit
        choice = _choice(arguments.get("choice"))
        if (example := arguments.get("example")) is not None:
            scene = start_page.example_scene(str(example))
            return (Found("volume", scene.layers[0].volume.name, str(example), scene.layers),)
        if (place := arguments.get("recent")) is not None:
            path = self._recent_path(place, arguments.get("name"))
            found = found_at(path, unit=unit, choice=choice)
            if self._recent is not None:
                self._recent.add(path)
            return (found,)
        upload = self._own_upload(owner, arguments)
        if (upload.received, upload.begun) != (upload.n_bytes, upload.n_files):
            raise ArgumentError(
                f"upload: {upload.received} of {upload.n_bytes} bytes came, in {upload.begun} of {upload.n_files} files"
            )
        upload.is_complete = True
        return tuple(_found_in(path, upload.folder, unit, choice) for path in paths_in(upload.folder))

    def _recent_path(self, place: object, name: object) -> str:
        paths = [] if self._recent is None else self._recent.paths()
        # The list may have changed since the page got it: the name says which one is meant.
        named = [path for n, path in enumerate(paths) if n == place and last_part(path) == name]
        if not named or isinstance(place, bool):
            raise ArgumentError("the list of recent files is another one now; open the start page again")
        return named[0]


def _found_in(path: Path, folder: Path, unit: str | None, choice: Mapping[str, Any]) -> Found:
    """The contents of a path in an upload; errors come without the folder, which the user does not know."""
    try:
        return found_at(path, folder=folder, unit=unit, choice=choice)
    except WavesplatError as error:
        text = str(error).replace(f"{folder}/", "").replace(str(folder), "what was sent")
        raise (ArgumentError if isinstance(error, ArgumentError) else FileError)(text) from error


def _aspect(given: object) -> float | None:
    """Width over height of a page's view."""
    if given is None:
        return None
    if not isinstance(given, int | float) or isinstance(given, bool) or not 1e-3 < given < 1e3:
        raise ArgumentError(f"show: aspect is {described(given)}; give width over height, which is positive")
    return float(given)


def _choice(given: object) -> dict[str, Any]:
    """The option and its value that a page chose among several."""
    if given is None:
        return {}
    option, value = (given.get("option"), given.get("value")) if isinstance(given, Mapping) else (None, None)
    if option not in ("series", "dataset") or not isinstance(value, str | int) or isinstance(value, bool):
        raise ArgumentError(f"open: choice is {described(given)}; give the option, series or dataset, and its value")
    return {str(option): value}
