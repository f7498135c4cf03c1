"""Answers to the page's questions: histograms, values, the point seen at a pixel, presets, files, code.

Names, arguments and answers are `Questions` in `web/src/engine/engine.ts`.
"""

from __future__ import annotations

import json
import warnings
from collections.abc import Callable, Mapping
from math import isfinite
from typing import Any, TypeAlias

import numpy as np

from wavesplat._files import json_text
from wavesplat._looks import look_json, presets
from wavesplat._looks.histogram import finite_samples
from wavesplat._looks.look import Look
from wavesplat._model.argument_types import described
from wavesplat._model.camera import Camera
from wavesplat._model.lazy_volume import LazyVolume
from wavesplat._model.volume import Volume
from wavesplat._picture.picture import Picture
from wavesplat._scene import scene_json
from wavesplat._viewer import code, encoding, export_html
from wavesplat._viewer.picturing import picture_of
from wavesplat._viewer.previews import preview_of
from wavesplat._viewer.state import ViewerState
from wavesplat.errors import ArgumentError, WavesplatWarning

__all__ = ["answer", "state_from_text"]

Answer: TypeAlias = tuple[dict[str, Any], bytes]
Progress: TypeAlias = Callable[[float], object] | None

MAX_BINS, MAX_PX, MAX_TEXT = 4096, 8192, 1 << 20
#: Side, pixels, of the small picture around a pixel that finds the depth there.
PICKED_PX = 3
QUALITIES = ("draft", "normal", "fine", "high")


def answer(state: ViewerState, question: str, arguments: Mapping[str, Any], progress: Progress = None) -> Answer:
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
    json_text.check_values(arguments, question)
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
    found = json_text.decode(text, "the file is no state of the viewer")
    document = scene_json.inside(found)
    layers = document.get("layers")
    if not isinstance(layers, list) or len(layers) != len(state.scene.layers):
        n = len(layers) if isinstance(layers, list) else 0
        raise ArgumentError(
            f"the file has {n} layers, and {len(state.scene.layers)} volumes are open; open its own with "
            "`wavesplat view --state FILE`"
        )
    open_now = state.document
    whole: dict[str, Any] = {name: value for name, value in document.items() if name != "figure"}
    whole["layers"] = [
        {**layer, "volume": now["volume"], "look": now["look"] if layer.get("look") is None else _look(state, n, layer)}
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


def _look(state: ViewerState, number: int, layer: dict[str, Any]) -> Any:
    look = layer["look"]
    return look if isinstance(look, dict) else _fields_of_preset(state, number, str(look))


def _histogram(state: ViewerState, arguments: Mapping[str, Any], _: Progress) -> Answer:
    layer = _whole(arguments, "layer", 0, len(state.scene.layers) - 1)
    n_bins = _whole(arguments, "bins", 1, MAX_BINS)
    low, high = (_number(arguments, name) for name in ("low", "high"))
    if not low < high:
        raise ArgumentError(f"histogram: low is {low:g} and high {high:g}; low must be less")
    counts, _edges = np.histogram(finite_samples(state.scene.layers[layer].drawn), bins=n_bins, range=(low, high))
    return {"counts": counts.tolist(), "low": low, "high": high}, b""


def _probe(state: ViewerState, arguments: Mapping[str, Any], _: Progress) -> Answer:
    point = _point(arguments, "point")
    values: list[float | None] = []
    for layer in state.scene.layers:
        volume = layer.drawn
        if not isinstance(volume, Volume):
            values.append(None)
            continue
        place = _sample_at(volume.world_from_index, volume.shape, point)
        value = None if place is None else _value_at(volume, place)
        values.append(value if value is not None and isfinite(value) else None)
    first = state.scene.layers[0].drawn
    matrix = np.linalg.inv(first.world_from_index)
    index = (matrix[:3, :3] @ point + matrix[:3, 3]).round(3).tolist()
    label = None
    labels = state.scene.labels
    place = _sample_at(first.world_from_index, first.shape, point)
    if labels is not None and place is not None:
        on_scan = labels.on_samples_of(first)
        number = on_scan.numbers[int(on_scan._codes[place])]
        look = labels.labels.get(number)
        if number or look is not None:
            label = {"number": number, "name": (look.name if look else "") or str(number)}
    return {"values": values, "label": label, "index": index}, b""


def _value_at(volume: Volume, place: tuple[int, int, int]) -> float:
    if isinstance(volume, LazyVolume):
        z, y, x = place
        return float(volume.arrays(0).read(place, (z + 1, y + 1, x + 1))[0, 0, 0])
    return float(volume.samples[place])


def _sample_at(world_from_index: Any, shape: tuple[int, ...], point: Any) -> tuple[int, int, int] | None:
    """The index [z, y, x] of the sample nearest to a point; None outside."""
    matrix = np.linalg.inv(world_from_index)
    index = np.rint(matrix[:3, :3] @ point + matrix[:3, 3])[::-1]
    if not all(0 <= at < n for at, n in zip(index, shape, strict=True)):
        return None  # also what is beyond whole numbers
    z, y, x = (int(at) for at in index)
    return z, y, x


def _pick(state: ViewerState, arguments: Mapping[str, Any], progress: Progress) -> Answer:
    """The world point where opacity reaches one half at a pixel; in projections none."""
    width, height = _size(arguments)
    x, y = (_number(arguments, name) for name in ("x", "y"))
    if not (0 <= x <= 1 and 0 <= y <= 1):
        raise ArgumentError(f"pick: ({x:g}, {y:g}) lies outside the picture; x and y are shares, 0 to 1")
    composite = state.options["composite"]
    name = composite if isinstance(composite, str | None) else composite.name
    if name not in (None, "over", "first-hit"):
        return {"point": None}, b""
    camera = state.camera
    # A camera that sees only what is around the pixel, with pixels of the same size.
    picture, ray = _around(state, camera, (x, y), (width, height), progress)
    depth = picture.depth
    if depth is None:
        return {"point": None}, b""
    near = depth[PICKED_PX // 2, PICKED_PX // 2]
    if not np.isfinite(near):
        finite = depth[np.isfinite(depth)]
        if not finite.size:
            return {"point": None}, b""
        near = np.median(finite)
    origin, direction = ray
    return {"point": (origin + float(near) * direction).tolist()}, b""


def _around(
    state: ViewerState, camera: Camera, at: tuple[float, float], size: tuple[int, int], progress: Progress
) -> tuple[Picture, tuple[Any, Any]]:
    """A few pixels around a place in the picture, with depths, and the ray of the middle one."""
    width, height = size
    back, up, right = _axes(camera)
    eye, focal = np.array(camera.position), np.array(camera.focal_point)
    across, upward = (2 * at[0] - 1) * width / height, 1 - 2 * at[1]
    share = PICKED_PX / height
    if camera.view_angle is None:
        assert camera.parallel_scale is not None
        shift = camera.parallel_scale * (across * right + upward * up)
        small = Camera(eye + shift, focal + shift, camera.view_up, parallel_scale=camera.parallel_scale * share)
        origin, direction = eye + shift, -back
    else:
        half = np.tan(np.radians(camera.view_angle) / 2)
        direction = -back + half * (across * right + upward * up)
        direction /= np.linalg.norm(direction)
        distance = float(np.linalg.norm(focal - eye))
        angle = float(np.degrees(2 * np.arctan(half * share)))
        small = Camera(eye, eye + distance * direction, camera.view_up, view_angle=max(angle, 1e-3))
        origin = eye
    arguments = {"quality": "normal", "kernel": state.options["kernel"], "composite": state.options["composite"]}
    picture = preview_of(state.scene).render(
        small, size=(PICKED_PX, PICKED_PX), depth=True, progress=progress, **arguments
    )
    return picture, (origin, direction)


def _axes(camera: Camera) -> Any:
    back = np.array(camera.position) - np.array(camera.focal_point)
    back = back / np.linalg.norm(back)
    up = np.array(camera.view_up, float)
    up = up - (up @ back) * back
    up /= np.linalg.norm(up)
    return back, up, np.cross(up, back)


def _preset(state: ViewerState, arguments: Mapping[str, Any], _: Progress) -> Answer:
    layer = _whole(arguments, "layer", 0, len(state.scene.layers) - 1)
    return {"look": _fields_of_preset(state, layer, _text(arguments, "name"))}, b""


def _fields_of_preset(state: ViewerState, layer: int, name: str) -> dict[str, Any]:
    fields: dict[str, Any] = json.loads(json.dumps(look_json.fields_of(_chosen(state, layer, name))))
    return fields


def _chosen(state: ViewerState, layer: int, name: str) -> Look:
    volume = state.scene.layers[layer].looked_at
    with warnings.catch_warnings():
        # The page has been sent which presets fit.
        warnings.simplefilter("ignore", WavesplatWarning)
        return Look.auto(volume) if name.lower() == "auto" else presets.preset(name, volume)


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
    return {}, encoding.png_bytes(picture.rgba)


def _fitted(state: ViewerState, arguments: Mapping[str, Any], _: Progress) -> Answer:
    width, height = _size(arguments)
    camera = scene_json.camera_of(arguments.get("camera"))
    if camera is None:
        raise ArgumentError("fitted: field 'camera' is missing")
    return {"camera": camera.fitted(state.scene, aspect=width / height).as_json()}, b""


def _picture(state: ViewerState, arguments: Mapping[str, Any], progress: Progress) -> Answer:
    size = _size(arguments)
    quality = _text(arguments, "quality")
    if quality not in QUALITIES:
        raise ArgumentError(f"picture: quality is {quality!r}; use one of: {', '.join(QUALITIES)}")
    if quality != state.options["quality"]:
        state = state.patched([{"op": "replace", "path": "/render/quality", "value": quality}])
    if _flag(arguments, "transparent"):
        state = state.patched([{"op": "replace", "path": "/background", "value": "#00000000"}])
    picture = picture_of(state, "3d", size, progress=progress)
    notes = list(picture.report.get("notes", []))
    if _flag(arguments, "annotated"):
        picture = picture.annotated(**_figure(state, picture))
    return {"notes": notes}, encoding.png_bytes(picture.rgba)


def _figure(state: ViewerState, picture: Picture) -> dict[str, Any]:
    """The overlays that a figure can have, as arguments of `Picture.annotated`."""
    overlays, report = state.view["overlays"], picture.report
    is_parallel = state.camera.view_angle is None
    letters = "letters" if overlays["letters"] and report.get("anatomical") else None
    several = len(state.scene.layers) > 1
    return {
        "scale_bar": overlays["scale_bar"] and is_parallel,
        "orientation": "cube" if overlays["cube"] and letters is None else letters,
        "colorbar": overlays["color_bar"],
        "legend": overlays["legend"] and bool(report.get("labels") or several),
    }


def _code(state: ViewerState, arguments: Mapping[str, Any], progress: Progress) -> Answer:
    size = _size(arguments)
    wanted = _text(arguments, "as")
    makers: dict[str, tuple[str, Callable[[], str]]] = {
        "python": ("picture.py", lambda: code.python_of(state, size)),
        "command": ("picture.sh", lambda: code.command_of(state, size)),
        "state": ("view.json", lambda: scene_json.write(state.file_document(size))),
        "html": ("view.html", lambda: export_html.page_of(state, picture_of(state, "3d", size, progress=progress))),
    }
    if wanted not in makers:
        raise ArgumentError(f"code: as is {wanted!r}; use one of: {', '.join(makers)}")
    name, make = makers[wanted]
    return {"text": make(), "name": name}, b""


def _open_state(state: ViewerState, arguments: Mapping[str, Any], _: Progress) -> Answer:
    return {"state": state_from_text(state, _text(arguments, "text", MAX_TEXT)).document}, b""


ANSWERS: dict[str, Callable[[ViewerState, Mapping[str, Any], Progress], Answer]] = {
    "histogram": _histogram,
    "probe": _probe,
    "pick": _pick,
    "preset": _preset,
    "preset_picture": _preset_picture,
    "fitted": _fitted,
    "picture": _picture,
    "code": _code,
    "open_state": _open_state,
}


def _number(arguments: Mapping[str, Any], name: str) -> float:
    value = arguments.get(name)
    if not isinstance(value, int | float) or isinstance(value, bool) or not abs(value) < 1e30:
        raise ArgumentError(f"{name} is {described(value)}; give a number")
    return float(value)


def _whole(arguments: Mapping[str, Any], name: str, least: int, most: int) -> int:
    value = arguments.get(name)
    if not isinstance(value, int) or isinstance(value, bool) or not least <= value <= most:
        raise ArgumentError(f"{name} is {described(value)}; give a whole number from {least} to {most}")
    return value


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


def _size(arguments: Mapping[str, Any]) -> tuple[int, int]:
    return _whole(arguments, "width", 1, MAX_PX), _whole(arguments, "height", 1, MAX_PX)


def _point(arguments: Mapping[str, Any], name: str) -> Any:
    point = arguments.get(name)
    if not isinstance(point, list) or len(point) != 3:
        raise ArgumentError(f"{name} is {described(point)}; give three numbers, [x, y, z]")
    return np.array([_number({"coordinate": value}, "coordinate") for value in point])
