"""Answers to the questions of a session's pages, in threads of their own.

Names, arguments and answers are `Questions` in `web/src/engine/engine.ts`.
"""

from __future__ import annotations

import json
import threading
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Any, Protocol, TypeAlias

import numpy as np

from wavesplat import _native
from wavesplat._looks import look_files, presets
from wavesplat._looks.kinds.histogram import finite_samples
from wavesplat._looks.look import Look
from wavesplat._model.camera.camera import Camera
from wavesplat._scene.documents import scene_json
from wavesplat._scene.scene import names_by_themselves
from wavesplat._storage import json_texts
from wavesplat._system.threads import collected_notes
from wavesplat._system.values import described, whole
from wavesplat._viewer.page_requests import code, export_html, layer_rows
from wavesplat._viewer.page_requests.code import USUAL, short_document
from wavesplat._viewer.page_requests.measuring import label_statistics, region_statistics
from wavesplat._viewer.page_requests.seen import Shown, check_shown, name_of, seen
from wavesplat._viewer.page_requests.under_pointer import depth_of_matter, label_at, shape_seen, sight_at, values_at
from wavesplat._viewer.server import messages
from wavesplat._viewer.session.framed_cameras import framed, kept_in_view
from wavesplat._viewer.session.info import data_of, fingerprint_of
from wavesplat._viewer.session.picturing import picture_of
from wavesplat._viewer.session.previews import preview_of
from wavesplat._viewer.session.state import ViewerState
from wavesplat.errors import ArgumentError, CancelledError, WavesplatError

# Answers to the questions of a session's pages, in threads of their own.
#
# Questions about cameras, which a page asks before it moves one, have a thread of their own, since others may take
# long: small pictures of presets wait until all views are at rest. Each thread answers in the order in which it was
# asked.

#: Largest number of questions that wait.
MAX_QUESTIONS = 64
#: Least seconds between two messages of progress.
PROGRESS_S = 0.1


class Page(Protocol):
    """The page that asks."""

    is_open: bool

    def send(self, header: dict[str, Any], payload: bytes = b"") -> None:
        """Send a message to the page."""


@dataclass(eq=False)
class _Question:
    """A question of a page. state : the state it is about; None: the newest one when it is answered."""

    page: Page
    number: int
    name: str
    arguments: Any
    state: ViewerState | None
    is_cancelled: bool = False


class Answering:
    """The questions of a session, and the threads that answer them.

    changed : guards the session, and is notified of changes. state : gives the newest state. is_at_rest : whether no
    view waits for a picture at rest.
    """

    def __init__(
        self, changed: threading.Condition, state: Callable[[], ViewerState], is_at_rest: Callable[[], bool]
    ) -> None:
        self._changed, self._state, self._is_at_rest = changed, state, is_at_rest
        self._about_cameras, self._others = list[_Question](), list[_Question]()
        self._being_answered: list[_Question] = []
        self._is_open = True
        lanes = (("cameras", self._about_cameras), ("answers", self._others))
        self.threads = [
            threading.Thread(target=self._work, args=(lane,), name=f"wavesplat-viewer-{name}", daemon=True)
            for name, lane in lanes
        ]
        for thread in self.threads:
            thread.start()

    def ask(self, page: Page, number: int, name: str, arguments: Any) -> None:
        """Answer a question, later; at once where too many wait."""
        is_about_camera = name in OF_CAMERAS
        waiting = self._about_cameras if is_about_camera else self._others
        with self._changed:
            if len(waiting) >= MAX_QUESTIONS:
                message = "too many questions wait for an answer; ask again"
                page.send({"type": "failed", "id": number, "code": "busy", "message": message})
                return
            state = self._state() if is_about_camera else None
            waiting.append(_Question(page, number, name, arguments, state))
            self._changed.notify_all()

    def cancel(self, page: Page, number: int) -> None:
        """Cancel a question that waits or is being answered; others, such as answered ones, are left alone."""
        with self._changed:
            for question in (*self._about_cameras, *self._others, *self._being_answered):
                if question.page is page and question.number == number:
                    question.is_cancelled = True
            self._changed.notify_all()

    def close(self) -> None:
        """End the threads, after what is being answered."""
        with self._changed:
            self._is_open = False
            self._changed.notify_all()

    def _work(self, waiting: list[_Question]) -> None:
        while self._answer_next(waiting):
            pass

    def _answer_next(self, waiting: list[_Question]) -> bool:
        """Wait for a question and answer it; False at the end. A thread that waits holds no state, hence no volumes."""
        question = self._next(waiting)
        if question is None:
            return False
        self._answer(question)
        with self._changed:
            self._being_answered.remove(question)
        return True

    def _next(self, waiting: list[_Question]) -> _Question | None:
        """The oldest question that need not wait; None at the end."""
        with self._changed:
            while self._is_open:
                at_rest = self._is_at_rest()
                for question in waiting:
                    is_needless = question.is_cancelled or not question.page.is_open
                    if at_rest or is_needless or question.name != "preset_picture":
                        waiting.remove(question)
                        self._being_answered.append(question)
                        return question
                self._changed.wait()
            return None

    def _answer(self, question: _Question) -> None:
        page, number = question.page, question.number
        reported_s = 0.0

        def progress(part: float) -> bool:
            nonlocal reported_s
            if time.monotonic() - reported_s > PROGRESS_S:
                reported_s = time.monotonic()
                page.send({"type": "progress", "id": number, "part": part, "text": ""})
            return page.is_open and self._is_open and not question.is_cancelled

        try:
            if question.is_cancelled:
                raise CancelledError("the page cancelled its question")
            if not page.is_open:
                return
            state = self._state() if question.state is None else question.state
            answer, payload = answer_of(state, question.name, question.arguments, progress)
        except CancelledError:
            page.send({"type": "failed", "id": number, "code": "cancelled", "message": "it was cancelled"})
        except Exception as error:  # noqa: BLE001 - whatever fails, the page has to be reported_s
            page.send(failure_of(error, number))
        else:
            page.send({"type": "answer", "id": number, **answer}, payload)


def failure_of(error: Exception, number: int | None = None) -> dict[str, Any]:
    """The message to a page about an error. number : of the question that failed; None of a picture."""
    is_ours = isinstance(error, WavesplatError | MemoryError)
    message = str(error) if is_ours else f"the renderer failed: {type(error).__name__}: {error}"
    return {"type": "failed", "id": number, "code": "failed", "message": message or type(error).__name__}


# Answers to the page's questions: histograms, statistics, what is seen at a pixel, presets, files, code.

Answer: TypeAlias = tuple[dict[str, Any], bytes]
Progress: TypeAlias = Callable[[float], object] | None

MAX_BINS, MAX_PX, MAX_TEXT, MAX_CORNERS = 4096, 8192, 1 << 20, 200
QUALITIES = ("draft", "normal", "fine", "high")


def answer_of(state: ViewerState, question: str, arguments: Mapping[str, Any], progress: Progress = None) -> Answer:
    """The fields of the answer, and its bytes where it has any.

    Raises
    ------
    ArgumentError
        If there is no such question, or an argument cannot be.
    CancelledError
        If `progress` returned False.
    """
    if question not in ANSWERS:
        raise ArgumentError(f"unknown question {question!r}; the viewer answers {', '.join(sorted(ANSWERS))}")
    if not isinstance(arguments, Mapping):
        raise ArgumentError(f"{question}: the arguments are {described(arguments)}; give an object")
    _native.check_values(arguments, question)
    return ANSWERS[question](state, arguments, progress)


def state_from_text(state: ViewerState, text: str) -> ViewerState:
    """The state in the text of a file, with the volumes that are open.

    Raises
    ------
    ArgumentError
        If it is no state, or one of other volumes.
    """
    if len(text) > MAX_TEXT:
        raise ArgumentError(f"the file has {len(text)} characters, which is more than a state has; choose another one")
    found = json_texts.decode(text, "the file is no state of the viewer")
    document = scene_json.inside(_with_looks_of_maps(state, found))
    layers = document.get("layers")
    if not isinstance(layers, list) or len(layers) != len(state.scene.layers):
        n = len(layers) if isinstance(layers, list) else 0
        raise ArgumentError(
            f"the file has {n} layers, and {len(state.scene.layers)} volumes are open; open its own with "
            "`wavesplat view --state FILE`"
        )
    open_now = state.document
    whole: dict[str, Any] = {
        name: value for name, value in document.items() if name not in ("figure", "keep_table", "geometry")
    }
    whole["layers"] = [
        {
            **USUAL,
            "name": names_by_themselves(state.scene.layers)[n],
            **{name: value for name, value in layer.items() if name != "color_from"},
            "volume": now["volume"],
            "look": now["look"] if layer.get("look") is None else _look(state, n, layer),
        }
        if isinstance(layer, dict)
        else layer
        for n, (layer, now) in enumerate(zip(layers, open_now["layers"], strict=True))
    ]
    if open_now["labels"] is None:
        whole["labels"] = None
    elif isinstance(whole.get("labels"), dict):
        whole["labels"] = {**whole["labels"], "volume": open_now["labels"]["volume"]}
    else:
        whole["labels"] = open_now["labels"]
    if isinstance(whole.get("render"), dict):
        whole["render"] = {"quality": "normal", "kernel": "linear", **whole["render"]}
    if "geometry" in document:
        whole["geometry"] = _shown_shapes(open_now["geometry"], document["geometry"])
    return state.replaced(
        {
            **open_now,
            **{
                name: value
                for name, value in whole.items()
                if value is not None or name in ("labels", "shading", "background")
            },
        }
    )


def _shown_shapes(open_now: list[dict[str, Any]], given: Any) -> list[dict[str, Any]]:
    """The geometry that is open, shown as in the text of a file: a scene's shapes, or the list of a state."""
    listed = given if isinstance(given, list) else []
    shapes = [next(iter(one.values())) if isinstance(one, dict) and len(one) == 1 else one for one in listed]
    if len(shapes) != len(open_now):
        raise ArgumentError(
            f"the file has {len(shapes)} shapes, and {len(open_now)} are open; open its own with `wavesplat view "
            "--state FILE`"
        )
    return [
        {**now, "visible": shape.get("visible", True) if isinstance(shape, dict) else None}
        for now, shape in zip(open_now, shapes, strict=True)
    ]


def _with_looks_of_maps(state: ViewerState, found: Any) -> Any:
    """The document of a link with looks of maps written out that have fields which scenes' documents have not."""
    layers = found.get("layers") if isinstance(found, dict) else None
    if not isinstance(layers, list):
        return found

    def written_out(number: int, layer: Any) -> Any:
        look = layer.get("look") if isinstance(layer, dict) else None
        if not (isinstance(look, dict) and "map" in look and look.keys() & {"threshold", "gamma", "background"}):
            return layer
        if number >= len(state.scene.layers):
            return layer
        of_map = {name: value for name, value in look.items() if name != "background"}
        made = layer_rows.look_of_map(of_map, state.scene.layers[number].looked_at)
        made = replace(made, background=look.get("background"))
        return {**layer, "look": json.loads(json.dumps(look_files.fields_of(made)))}

    return {**found, "layers": [written_out(number, layer) for number, layer in enumerate(layers)]}


def _look(state: ViewerState, number: int, layer: dict[str, Any]) -> Any:
    look = layer["look"]
    if isinstance(look, dict) and "map" not in look:
        return look
    if isinstance(look, str):
        return _fields_of_preset(state, number, look)
    what = f"{scene_json.WHAT}: layers[{number}]"
    _native.check_part({**layer, "volume": {"path": None}}, what, "layer")
    made: Any = scene_json.layer_of(layer, what, state.scene.layers[number].volume).look
    return json.loads(json.dumps(look_files.fields_of(made)))


def _histogram(state: ViewerState, arguments: Mapping[str, Any], _: Progress) -> Answer:
    layer = _whole(arguments, "layer", 0, len(state.scene.layers) - 1)
    n_bins = _whole(arguments, "bins", 1, MAX_BINS)
    low, high = (_number(arguments, name) for name in ("low", "high"))
    if not low < high:
        raise ArgumentError(f"histogram: low is {low:g} and high {high:g}; low must be less")
    counts, _edges = np.histogram(finite_samples(state.scene.layers[layer].drawn), bins=n_bins, range=(low, high))
    return {"counts": counts.tolist(), "low": low, "high": high}, b""


def _region(state: ViewerState, arguments: Mapping[str, Any], _: Progress) -> Answer:
    points = arguments.get("points")
    if not isinstance(points, list) or not 3 <= len(points) <= MAX_CORNERS:
        raise ArgumentError(f"points is {described(points)}; give 3 to {MAX_CORNERS} points")
    return {"layers": region_statistics(state, np.array([_point({"point": one}, "point") for one in points]))}, b""


def _label_statistics(state: ViewerState, _: Mapping[str, Any], __: Progress) -> Answer:
    return {"labels": label_statistics(state)}, b""


def _pick(state: ViewerState, arguments: Mapping[str, Any], progress: Progress) -> Answer:
    """The world point where opacity reaches one half at a pixel, in projections none; values and label there."""
    sight = sight_at(state.camera, _place(arguments, "pick"), _size(arguments))
    near = depth_of_matter(state, sight, progress)
    if near is None:
        return {"point": None, "values": [], "label": None}, b""
    point = sight.point_at(near)
    told = {"values": values_at(state.scene, point), "label": label_at(state.scene, point)}
    return {"point": point.tolist(), **told}, b""


def _shape(state: ViewerState, arguments: Mapping[str, Any], progress: Progress) -> Answer:
    """The shape that is seen at a pixel; None without any."""
    sight = sight_at(state.camera, _place(arguments, "shape"), _size(arguments))
    return {"shape": shape_seen(state, sight, progress)}, b""


def _preset(state: ViewerState, arguments: Mapping[str, Any], _: Progress) -> Answer:
    layer = _whole(arguments, "layer", 0, len(state.scene.layers) - 1)
    return {"look": _fields_of_preset(state, layer, _text(arguments, "name"))}, b""


def _fields_of_preset(state: ViewerState, layer: int, name: str) -> dict[str, Any]:
    fields: dict[str, Any] = json.loads(json.dumps(look_files.fields_of(_chosen(state, layer, name))))
    return fields


def _chosen(state: ViewerState, layer: int, name: str) -> Look:
    volume = state.scene.layers[layer].looked_at
    with collected_notes():  # the page has been sent which presets fit
        return Look.auto(volume) if name.lower() == "auto" else presets.preset(name, volume)


def _layer_rows(state: ViewerState, _: Mapping[str, Any], __: Progress) -> Answer:
    return layer_rows.rows(state), b""


def _layer_change(state: ViewerState, arguments: Mapping[str, Any], _: Progress) -> Answer:
    layer = _whole(arguments, "layer", 0, len(state.scene.layers) - 1)
    return layer_rows.answer_change(state, layer, arguments), b""


def _preset_picture(state: ViewerState, arguments: Mapping[str, Any], progress: Progress) -> Answer:
    layer = _whole(arguments, "layer", 0, len(state.scene.layers) - 1)
    size = _whole(arguments, "size", 16, 512)
    look = _chosen(state, layer, _text(arguments, "name"))
    scene = state.scene.with_(
        layers=[type(state.scene.layers[layer])(state.scene.layers[layer].drawn, look)],
        labels=None,
        shading="look",
        background=look.background or "black",
    )
    camera = state.camera.fitted(scene)
    picture = preview_of(scene).render(camera, size=(size, size), quality="draft", progress=progress)
    return {}, messages.png_bytes(picture.rgba)


def _framed(state: ViewerState, arguments: Mapping[str, Any], _: Progress) -> Answer:
    width, height = _size(arguments)
    camera = framed(state.scene, state.options["composite"], _camera(arguments, "framed"), width / height)
    return {"camera": camera.as_json()}, b""


def _first_view(state: ViewerState, arguments: Mapping[str, Any], _: Progress) -> Answer:
    width, height = _size(arguments)
    camera = state.first_view.camera_for(state.scene, state.options["composite"], width / height)
    return {"camera": camera.as_json()}, b""


def _kept_in_view(state: ViewerState, arguments: Mapping[str, Any], _: Progress) -> Answer:
    width, height = _size(arguments)
    before = _number(arguments, "aspect")
    if not before > 0:
        raise ArgumentError(f"kept_in_view: aspect is {before:g}; give width over height, which is positive")
    camera = _camera(arguments, "kept_in_view")
    kept = kept_in_view(state.scene, state.options["composite"], camera, before, width / height)
    return {"camera": kept.as_json()}, b""


def _picture(state: ViewerState, arguments: Mapping[str, Any], progress: Progress) -> Answer:
    wanted, shown, marks = _wanted(state, arguments, "picture")
    picture = seen(wanted, shown, _size(arguments), marks=marks, progress=progress)
    notes = list(picture.report.get("notes", []))
    return {"notes": notes, "name": f"{name_of(state, shown)}.png"}, messages.png_bytes(picture.rgba)


def _wanted(state: ViewerState, arguments: Mapping[str, Any], question: str) -> tuple[ViewerState, Shown, bool]:
    """The state with the camera, quality and background of a picture, the view it shows, and whether with marks."""
    if "camera" in arguments:
        camera = _camera(arguments, question).as_json()
        state = state.patched([{"op": "replace", "path": "/camera", "value": camera}])
    quality = arguments.get("quality")
    if quality is not None and quality != state.options["quality"]:
        if quality not in QUALITIES:
            raise ArgumentError(f"{question}: quality is {described(quality)}; use one of: {', '.join(QUALITIES)}")
        state = state.patched([{"op": "replace", "path": "/render/quality", "value": quality}])
    if _flag(arguments, "transparent"):
        state = state.patched([{"op": "replace", "path": "/background", "value": "#00000000"}])
    return state, check_shown(arguments.get("shown", "3d")), _flag(arguments, "annotated")


def _in_window(state: ViewerState, arguments: Mapping[str, Any]) -> ViewerState:
    """The state with the layout and panels of the page's window, where the page says that they are others."""
    window = arguments.get("window")
    if window is None:
        return state
    if not isinstance(window, Mapping) or not set(window) <= {"layout", "interface"}:
        raise ArgumentError(f"code: window is {described(window)}; give an object of layout and interface")
    return state.patched([{"op": "add", "path": f"/view/{name}", "value": value} for name, value in window.items()])


def _code(state: ViewerState, arguments: Mapping[str, Any], progress: Progress) -> Answer:
    size = _size(arguments)
    kind = _text(arguments, "as")
    state = _in_window(state, arguments)
    wanted, shown, marks = _wanted(state, arguments, "code")
    name = name_of(state, shown)
    makers: dict[str, tuple[str, Callable[[], str]]] = {
        "python": (f"{name}.py", lambda: code.python_of(wanted, size, shown, marks=marks)),
        "command": (f"{name}.sh", lambda: code.command_of(wanted, size, shown, marks=marks)),
        "movie": (f"{name}.sh", lambda: code.movie_command_of(wanted, size)),
        "state": (f"{name}.json", lambda: scene_json.write(state.file_document(size))),
        "link": (name, lambda: _link_text(state)),
        "html": (f"{name}.html", lambda: export_html.page_of(state, picture_of(state, "3d", size, progress=progress))),
    }
    if kind not in makers:
        raise ArgumentError(f"code: as is {kind!r}; use one of: {', '.join(makers)}")
    name, make = makers[kind]
    return {"text": make(), "name": name}, b""


def _link_text(state: ViewerState) -> str:
    """The state for a link, as short as it can be, with the fingerprint of its data."""
    document = short_document(state, state.document, "link")
    content = {"fingerprint": fingerprint_of(state.scene), "state": document}
    return json.dumps(content, ensure_ascii=False, separators=(",", ":"))


def _open_state(state: ViewerState, arguments: Mapping[str, Any], _: Progress) -> Answer:
    return {"state": state_from_text(state, _text(arguments, "text", MAX_TEXT)).document}, b""


def _data(state: ViewerState, _arguments: Mapping[str, Any], _: Progress) -> Answer:
    return data_of(state), b""


ANSWERS: dict[str, Callable[[ViewerState, Mapping[str, Any], Progress], Answer]] = {
    "data": _data,
    "histogram": _histogram,
    "region": _region,
    "label_statistics": _label_statistics,
    "pick": _pick,
    "shape": _shape,
    "layer_rows": _layer_rows,
    "layer_change": _layer_change,
    "preset": _preset,
    "preset_picture": _preset_picture,
    "framed": _framed,
    "first_view": _first_view,
    "kept_in_view": _kept_in_view,
    "picture": _picture,
    "code": _code,
    "open_state": _open_state,
}


#: Questions that the page asks before it moves the camera.
OF_CAMERAS = ("framed", "first_view", "kept_in_view")


def _number(arguments: Mapping[str, Any], name: str) -> float:
    value = arguments.get(name)
    if not _native.is_number(value):
        raise ArgumentError(f"{name} is {described(value)}; give a number")
    return float(value)


def _whole(arguments: Mapping[str, Any], name: str, least: int, most: int) -> int:
    value = arguments.get(name)
    return whole(value, name, f"a whole number from {least} to {most}", least=least, most=most)


def _text(arguments: Mapping[str, Any], name: str, most: int = 200) -> str:
    value = arguments.get(name)
    if not isinstance(value, str) or len(value) > most:
        raise ArgumentError(f"{name} is {described(value)}; give a text of at most {most} characters")
    return value


def _flag(arguments: Mapping[str, Any], name: str) -> bool:
    value = arguments.get(name, False)
    if not isinstance(value, bool):
        raise ArgumentError(f"{name} is {described(value)}; give true or false")
    return value


def _camera(arguments: Mapping[str, Any], question: str) -> Camera:
    camera = scene_json.camera_of(arguments.get("camera"))
    if camera is None:
        raise ArgumentError(f"{question}: field 'camera' is missing")
    return camera


def _place(arguments: Mapping[str, Any], question: str) -> tuple[float, float]:
    x, y = (_number(arguments, name) for name in ("x", "y"))
    if not (0 <= x <= 1 and 0 <= y <= 1):
        raise ArgumentError(f"{question}: ({x:g}, {y:g}) lies outside the picture; x and y are shares, 0 to 1")
    return x, y


def _size(arguments: Mapping[str, Any]) -> tuple[int, int]:
    return _whole(arguments, "width", 1, MAX_PX), _whole(arguments, "height", 1, MAX_PX)


def _point(arguments: Mapping[str, Any], name: str) -> Any:
    point = arguments.get(name)
    if not _native.is_point(point):
        raise ArgumentError(f"{name} is {described(point)}; give three numbers, [x, y, z]")
    return np.array(point, np.float64)
