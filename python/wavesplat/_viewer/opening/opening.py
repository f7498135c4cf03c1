"""Opening files in the page: what pages send, examples, recent files, and the changes of the state that show them.

A page asks in two steps, since what is done with a file depends on what it is: "open" reads it and answers what was
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

from wavesplat import _native
from wavesplat._scene.scene import Scene
from wavesplat._system.threads import cancelled_by, check_cancelled
from wavesplat._system.values import described
from wavesplat._viewer.opening import start_page
from wavesplat._viewer.opening.open_paths import Found, Several, found_at, scene_with
from wavesplat._viewer.opening.start_page import Recent, last_part
from wavesplat._viewer.opening.upload_contents import paths_in, readers_of
from wavesplat._viewer.opening.uploads import Upload, Uploads
from wavesplat._viewer.session.state import ViewerState
from wavesplat.errors import ArgumentError, CancelledError, FileError, WavesplatError

Send: TypeAlias = Callable[[dict[str, Any], bytes], None]
Answer: TypeAlias = tuple[dict[str, Any], bytes]

#: Seconds that the reading thread has to finish when the viewer ends; its files are removed before.
CLOSING_S = 1.0
#: Largest number of files that are read and not shown yet, and of questions that wait.
MAX_READ, MAX_WAITING = 4, 64
HOWS = ("replace", "overlay", "labels")


@dataclass(frozen=True)
class _Read:
    """The contents of a path that was opened, the number of its upload, and the page that asked, by which question."""

    found: tuple[Found, ...]
    upload: int | None
    owner: Any
    question: int


@dataclass(eq=False)
class _Asked:
    """A question that waits or is being answered."""

    owner: Any
    number: int
    name: str
    arguments: Mapping[str, Any]
    payload: bytes
    is_cancelled: bool = False


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
        self._asked: list[_Asked] = []
        self._questions: dict[str, Callable[[_Asked], Answer]] = {
            "offered": lambda _: (self.offered(), b""),
            "clear_recent": self._clear_recent,
            "example_picture": self._example_picture,
            "upload_begin": self._upload_begin,
            "upload": self._upload,
            "discard": self._discard,
            "open": self._open,
            "show": self._show,
        }
        self._thread: threading.Thread | None = None

    def offered(self) -> dict[str, Any]:
        """The offers of the start page."""
        return start_page.offered(self._recent)

    def answers(self, header: Mapping[str, Any]) -> bool:
        """Whether a message is a question that is answered here."""
        return header.get("type") == "ask" and header.get("question") in self._questions

    def cancel(self, owner: Any, header: Mapping[str, Any]) -> None:
        """Cancel what a message of the type "cancel" names, if it is a question that is answered here.

        A reader stops between files and slices, where it can; else its result is thrown away. What was read and is not
        shown is forgotten. The files of its upload go with it.
        """
        number = header.get("id")
        for asked in list(self._asked):
            if (asked.owner, asked.number) == (owner, number):
                asked.is_cancelled = True
        for key in [key for key, read in list(self._read.items()) if (read.owner, read.question) == (owner, number)]:
            self._forget(key)

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
        asked = _Asked(owner, number, question, arguments, payload)

        def answer() -> None:
            self._answer(send, asked)

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
        self._asked.append(asked)
        # Pictures of examples take a while, and a file that is opened should not wait for them.
        self._waiting.put((int(question == "example_picture"), next(self._order), answer))

    def leave(self, owner: Any) -> None:
        """A page has gone: its unfinished uploads, and what it opened and did not show, are removed."""
        for asked in list(self._asked):
            asked.is_cancelled = asked.is_cancelled or asked.owner == owner
        self._uploads.leave(owner)
        for number in [number for number, read in list(self._read.items()) if read.owner == owner]:
            self._forget(number)

    def close(self) -> None:
        """Remove all files that pages sent."""
        for asked in list(self._asked):
            asked.is_cancelled = True
        self._uploads.close()
        if self._thread is not None:
            self._waiting.put((-1, next(self._order), None))
            if self._thread is not threading.current_thread():
                self._thread.join(timeout=CLOSING_S)

    def _work(self) -> None:
        while (task := self._waiting.get()[2]) is not None:
            task()

    def _answer(self, send: Send, asked: _Asked) -> None:
        number = asked.number
        try:
            _native.check_values(asked.arguments, asked.name)
            with cancelled_by(lambda: asked.is_cancelled):
                fields, payload = self._questions[asked.name](asked)
        except CancelledError:
            send({"type": "failed", "id": number, "code": "cancelled", "message": "it was cancelled"}, b"")
            return
        except Exception as error:  # noqa: BLE001 - whatever fails, the page gets a message
            is_ours = isinstance(error, WavesplatError | MemoryError)
            text = str(error) if is_ours else f"opening failed: {type(error).__name__}: {error}"
            message = text or "there is not enough memory for it"
            send({"type": "failed", "id": number, "code": "open", "message": message}, b"")
            return
        finally:
            if asked in self._asked:
                self._asked.remove(asked)
        send({"type": "answer", "id": number, **fields}, payload)

    # Questions

    def _clear_recent(self, _: _Asked) -> Answer:
        if self._recent is not None:
            self._recent.clear()
        return self.offered(), b""

    @staticmethod
    def _example_picture(asked: _Asked) -> Answer:
        return {}, start_page.example_picture(str(asked.arguments.get("name")))

    def _upload_begin(self, asked: _Asked) -> Answer:
        n_files, n_bytes = asked.arguments.get("files"), asked.arguments.get("bytes")
        return {"upload": self._uploads.begin(asked.owner, n_files, n_bytes).number}, b""

    def _upload(self, asked: _Asked) -> Answer:
        path, offset = asked.arguments.get("path"), asked.arguments.get("offset")
        return {"received": self._own_upload(asked).write(path, offset, asked.payload)}, b""

    def _discard(self, asked: _Asked) -> Answer:
        """Forget an upload, or what was read and is not shown, with its upload."""
        if (number := asked.arguments.get("opened")) is not None:
            read = self._read.get(number) if isinstance(number, int) else None
            if read is not None and read.owner == asked.owner:
                self._forget(number)
            return {}, b""
        upload = self._own_upload(asked)
        self._read = {key: read for key, read in self._read.items() if read.upload != upload.number}
        self._uploads.discard(upload.number)
        return {}, b""

    def _own_upload(self, asked: _Asked) -> Upload:
        upload = self._uploads.get(asked.arguments.get("upload"))
        if upload.owner != asked.owner:
            raise ArgumentError("upload: it is another page's")
        return upload

    def _shown(self, found: Sequence[Found], upload: int | None) -> None:
        """Let the files of an upload go with the last object that reads on from them."""
        if upload is not None:
            self._uploads.discard_after(upload, (reader for one in found for reader in readers_of(one)))

    def _open(self, asked: _Asked) -> Answer:
        state = self._state()
        upload = self._own_upload(asked).number if "upload" in asked.arguments else None
        try:
            found = self._found(asked, state)
            check_cancelled()  # a reader that could not stop
        except Several as several:
            return {
                "several": {"option": several.option, "names": several.names, "described": several.described},
                "message": str(several),
            }, b""
        except Exception:
            self._uploads.discard(upload)
            raise
        notes = [note for one in found for note in one.notes]
        contents = {"found": [{"kind": one.kind, "name": one.name} for one in found], "notes": notes}
        if state is None and self._begin is not None:
            with_volumes = any(one.kind == "volume" for one in found)
            self._begin(ViewerState.of(scene_with(None, found, as_labels=with_volumes)))
            self._shown(found, upload)
            return {**contents, "shown": True}, b""
        while len(self._read) >= MAX_READ:
            self._forget(next(iter(self._read)))
        number, self._next = self._next, self._next + 1
        self._read[number] = _Read(found, upload, asked.owner, asked.number)
        if asked.is_cancelled:  # since the reader has ended
            self._forget(number)
            check_cancelled()
        return {**contents, "shown": False, "opened": number}, b""

    def _show(self, asked: _Asked) -> Answer:
        arguments = asked.arguments
        state, how, number = self._state(), arguments.get("how"), arguments.get("opened")
        if how not in HOWS:
            raise ArgumentError(f"show: how is {described(how)}; use one of: {', '.join(HOWS)}")
        read = self._read.get(number) if isinstance(number, int) else None
        if state is None or read is None:
            raise ArgumentError("show: this is not open any more; open it again")
        try:
            operations = self._changes(state, read.found, how, _aspect(arguments.get("aspect")))
            check_cancelled()
        except CancelledError:
            self._forget(number)  # type: ignore[arg-type]
            raise
        self._read.pop(number, None)  # type: ignore[arg-type]
        self._shown(read.found, read.upload)
        return {"operations": operations}, b""

    @staticmethod
    def _changes(state: ViewerState, found: tuple[Found, ...], how: str, aspect: float | None) -> list[dict[str, Any]]:
        """The changes that show what was found."""
        check_cancelled()
        if how == "replace":
            with_volumes = any(one.kind == "volume" for one in found)
            return replaced(state, scene_with(None, found, as_labels=with_volumes), aspect)
        return added(state, scene_with(state.scene, found, as_labels=how == "labels"))

    def _forget(self, number: int) -> None:
        read = self._read.pop(number, None)
        if read is not None:
            self._uploads.discard(read.upload)

    def _found(self, asked: _Asked, state: ViewerState | None) -> tuple[Found, ...]:
        """The contents of the upload, the example or the recent file that a question names."""
        arguments = asked.arguments
        check_cancelled()
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
        upload = self._own_upload(asked)
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
    except CancelledError:
        raise
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


# Changes of a state (JSON Patch) that show another scene, or further layers, labels and shapes beside what is open.

Operations: TypeAlias = list[dict[str, Any]]

#: Fields that another scene brings; settings of the page and of drawing stay.
OF_SCENE = ("layers", "labels", "shading", "clip", "background", "geometry", "camera")


def replaced(state: ViewerState, scene: Scene, aspect: float | None = None) -> Operations:
    """Changes that show another scene as it would be opened: with its own looks, background and camera.

    aspect : width over height of the page's view in space; None where it has none.
    """
    kept = {name: state.options[name] for name in ("quality", "kernel")}
    begun = ViewerState.of(scene, options=kept, catalogue=state.catalogue)
    other = (begun if aspect is None else begun.framed_first(aspect)).document
    return [
        *[_set(f"/{name}", other[name]) for name in OF_SCENE],
        _set("/render/composite", other["render"]["composite"]),
        _set("/view/slices", other["view"]["slices"]),
        _set("/view/measures", []),
    ]


def added(state: ViewerState, scene: Scene) -> Operations:
    """Changes that show what a scene has more than the state, all of which it holds: layers, labels and shapes.

    The looks of new layers are found in a state of their own: those that are open stay as they are.
    """
    other = ViewerState.of(scene, state.camera, state.options)
    known, document = state.catalogue, other.document
    operations: Operations = []
    for n in range(len(state.scene.layers), len(scene.layers)):
        entry = other.entries[n]
        mine = known.add(scene.layers[n], _without_id(entry.fields), entry.source, entry.color_field)
        operations.append(_add("/layers/-", {**document["layers"][n], "volume": dict(mine.fields)}))
    if scene.labels is not state.scene.labels and other.label_entry is not None:
        mine = known.add(scene.labels, {"path": None}, other.label_source)
        operations.append(_set("/labels", {**document["labels"], "volume": dict(mine.fields)}))
    for n in range(len(state.scene.geometry), len(scene.geometry)):
        mine = known.add(scene.geometry[n], _without_id(other.shape_entries[n].fields))
        operations.append(_add("/geometry/-", dict(mine.fields)))
    return operations


def _without_id(fields: Any) -> dict[str, Any]:
    return {name: value for name, value in fields.items() if name != "id"}


def _set(path: str, value: Any) -> dict[str, Any]:
    return {"op": "replace", "path": path, "value": value}


def _add(path: str, value: Any) -> dict[str, Any]:
    return {"op": "add", "path": path, "value": value}
