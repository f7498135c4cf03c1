"""Scenes as JSON: one object, with a version, whose errors name the field. `scene.schema.json` describes it.

    {"wavesplat": "scene", "version": 1,
     "layers": [{"volume": {"path": "ct.nii.gz", "then": [{"smoothed": {"deviation": 0.7}}]},
                 "name": "ct", "look": {"transfer_function": {...}}, "visible": true, "opacity": 1, "time": 0,
                 "color_from": {"volume": {...}, "name": "dose", "look": "auto"}}],
     "labels": null, "shading": "look", "clip": [{"plane": {"point": [0, 0, 0], "normal": [0, 1, 0]}}],
     "background": "black", "keep_table": false,
     "geometry": [{"surface": {"file": {"path": "liver.stl"}, "color": "red", "opacity": 0.5}}],
     "camera": {...}, "render": {"size": [512, 512], "quality": "normal", "kernel": "linear", "composite": "over"}}

A volume is a file and the options that it is opened with, or an example, and what is done to it then. A look is an
object as `Look.to_json` writes it, the name of a preset, or null: by the kind of data. `color_from` is the field that
colours a layer, if there is one. `geometry` are shapes in space, of files or written out (`geometry_json`). `camera`
and `render` may be left out; the documents in reports and PNG files have them, and `figure`, the arguments of
`Picture.annotated`, where something was drawn on the picture; documents of the viewer have `view`, which only it reads.
Relative paths start from the document's folder, and files lie in it (`named_volumes.py`).
"""

from __future__ import annotations

import json
from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass, fields, replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from wavesplat import _native
from wavesplat._looks import look_files, presets
from wavesplat._looks.curves.materials import Materials
from wavesplat._looks.labels.labels import Label, Labels
from wavesplat._looks.look import Look
from wavesplat._looks.shading import Shading
from wavesplat._model.arguments.clips import Clip, ClipPlane, Crop, CutOut
from wavesplat._model.arguments.operators import WITH_DEFAULTS, FirstHit, Operator, checked_operator
from wavesplat._model.arguments.sampling import Sampling
from wavesplat._model.camera import files as camera_json
from wavesplat._model.camera.camera import Camera
from wavesplat._model.camera.stereo import Stereo, checked_eyes
from wavesplat._scene.documents import geometry_json
from wavesplat._scene.documents.named_volumes import Reach, made_at, volume_named
from wavesplat._scene.layer import Layer
from wavesplat._storage import json_texts
from wavesplat.errors import ArgumentError

if TYPE_CHECKING:
    from wavesplat._scene.scene import Scene

KIND, VERSION = "scene", 1
WHAT = "scene"
COLOR = ("volume", "name", "look")
OPERATORS: dict[str, Any] = {FirstHit.name: FirstHit} | WITH_DEFAULTS


@dataclass(frozen=True)
class Document:
    """Contents of a document: a scene and, if there are any, a camera, and options of pictures, figures and viewers."""

    scene: Scene
    camera: Camera | None
    options: dict[str, Any]
    figure: dict[str, Any]
    view: dict[str, Any]


# Writing


def write(document: Mapping[str, Any]) -> str:
    """The JSON text of a document; numbers read back exactly."""
    return json.dumps(document, indent=2, ensure_ascii=False) + "\n"


def document_of(scene: Scene, *, strict: bool = True, look_of: Callable[[Layer], Any] | None = None) -> dict[str, Any]:
    """The document of a scene, paths absolute.

    strict : raise an `ArgumentError` for volumes and labels that come from no file; else their path is null.
    look_of : fields of the look of a layer; None is as it was given.
    """
    layers = [
        _fields_of_layer(layer, f"layer {number}", strict, look_of or given_look)
        for number, layer in enumerate(scene.layers)
    ]
    shading = scene.shading
    kept: dict[str, Any] = {"keep_table": True} if scene.keep_table else {}
    if scene.geometry:
        kept["geometry"] = geometry_json.fields_of(scene.geometry, strict=strict)
    return {
        "wavesplat": KIND,
        "version": VERSION,
        "layers": layers,
        "labels": None if scene.labels is None else _fields_of_labels(scene.labels, strict),
        "shading": look_files.fields_of_shading(shading) if isinstance(shading, Shading) else shading,
        "clip": [_fields_of_clip(clip) for clip in scene.clip],
        "background": list(scene.background) if isinstance(scene.background, tuple) else scene.background,
        **kept,
    }


def _fields_of_layer(layer: Layer, what: str, strict: bool, look_of: Callable[[Layer], Any]) -> dict[str, Any]:
    entries = {
        "volume": _source_of(layer, f"the volume of {what}", strict),
        "name": str(layer.name),
        "look": look_of(layer),
        "visible": layer.visible,
        "opacity": layer.opacity,
        # A series without a source is written as the volume of its time, which may have one.
        "time": layer.time if layer.volume._source is not None else 0,
    }
    if layer.color_from is not None:
        of_field = _fields_of_layer(layer.color_from, f"color_from of {what}", strict, look_of)
        entries["color_from"] = {name: of_field[name] for name in COLOR}
    return entries


def _source_of(layer: Layer, what: str, strict: bool) -> dict[str, Any]:
    source: dict[str, Any] | None = layer.volume._source or layer.drawn._source
    if source is not None:
        return source
    if strict:
        raise ArgumentError(
            f"{what}, {layer.volume.name!r}, comes from no file, so a document cannot name it; write it to a file that "
            "wavesplat.open reads, and open that"
        )
    return {"path": None, "name": str(layer.name)}


def given_look(layer: Layer) -> Any:
    look = layer.look
    if look is None or isinstance(look, str):
        return look
    if isinstance(look, Look):
        return look_files.fields_of(look)
    function = look.transfer_function() if isinstance(look, Materials) else look
    return look_files.fields_of(Look(transfer_function=function))


def _fields_of_labels(labels: Labels, strict: bool) -> dict[str, Any]:
    looks = {
        str(number): {**settings(label), "color": list(label.color)} for number, label in sorted(labels.labels.items())
    }
    if labels._source is None and strict:
        raise ArgumentError(
            "the labels come from no file, so a document cannot name them; write the segmentation to a file, and open "
            "it with wavesplat.Labels.open, or give wavesplat.Labels(wavesplat.open(path), ...)"
        )
    return {"volume": labels._source or {"path": None}, "labels": looks, "smooth": labels.smooth}


def _fields_of_clip(clip: Clip) -> dict[str, Any]:
    if isinstance(clip, ClipPlane):
        return {"plane": {"point": list(clip.point), "normal": list(clip.normal)}}
    box = clip.crop if isinstance(clip, CutOut) else clip
    corners = {"lower": list(box.lower), "upper": list(box.upper), "space": box.space}
    return {"cut_out" if isinstance(clip, CutOut) else "keep": corners}


def fields_of_operator(operator: Operator) -> Any:
    """An operator as JSON: its name, or an object of one field, the name with the numbers."""
    return operator if isinstance(operator, str) else {operator.name: settings(operator)}


def fields_of_sampling(sampling: Sampling) -> Any:
    """A sampling as JSON: the name of a quality, or an object of the numbers."""
    if sampling.sheets_per_slice is None and sampling.oversampling is None:
        return sampling.quality
    return settings(sampling)


def settings(thing: Any, *, but: Collection[str] = ()) -> dict[str, Any]:
    """The fields of a dataclass, without some."""
    return {field.name: getattr(thing, field.name) for field in fields(thing) if field.name not in but}


# Reading


def parse(text: str, folder: Path | None, *, external_files: bool = False) -> Document:
    """The contents of a JSON text: a document, or a report that has one.

    folder : of the document, where relative paths start, and files must lie; None is the working directory.
    external_files : whether files may lie elsewhere, and name others.
    """
    found = json_texts.decode(text, WHAT)
    return _document(inside(found), Reach(folder or Path.cwd(), external_files))


def inside(found: Any) -> dict[str, Any]:
    """The document itself, or the one in a report, or in the output of `--json`."""
    for _ in range(3):
        if isinstance(found, dict) and found.get("wavesplat") == KIND:
            return found
        if not isinstance(found, dict):
            break
        found = found.get("report", found.get("scene"))
    raise ArgumentError(
        f'{WHAT}: this is no scene; it must be an object with "wavesplat": "scene", or a report with one in "scene"'
    )


def _document(document: dict[str, Any], reach: Reach) -> Document:
    from wavesplat._scene.scene import Scene

    _native.check_part(document, WHAT, "scene")
    built = [_layer(layer, f"{WHAT}: layers[{number}]", reach) for number, layer in enumerate(document["layers"])]
    clips = clips_of(document)
    shading = shading_of(document.get("shading", "look"))
    geometry = geometry_json.shapes_of(document.get("geometry", []), f"{WHAT}: geometry", reach)
    scene = made_at(
        f"{WHAT}",
        lambda: Scene(
            built,
            labels=_labels(document.get("labels"), f"{WHAT}: labels", reach),
            shading=shading,
            clip=clips,
            background=document.get("background"),
            keep_table=document.get("keep_table", False),
            geometry=geometry,
        ),
    )
    eye = camera_of(document.get("camera"))
    figure = document.get("figure") or {}
    if figure.get("font") is not None:
        figure = {**figure, "font": reach.of_name(figure["font"]).path(figure["font"], f"{WHAT}: figure.font")}
    return Document(scene, eye, options_of(document.get("render") or {}), figure, document.get("view") or {})


def _layer(layer: Any, what: str, reach: Reach) -> Layer:
    made = layer_of(layer, what, volume_named(layer["volume"], f"{what}.volume", reach))
    field, what = layer.get("color_from"), f"{what}.color_from"
    if field is None:
        return made
    return replace(made, color_from=layer_of(field, what, volume_named(field["volume"], f"{what}.volume", reach)))


def layer_of(layer: Any, what: str, volume: Any) -> Layer:
    """The layer that fields describe, of a volume that is open."""
    look = layer.get("look")
    if isinstance(look, dict) and "map" in look:
        colors = look["map"], look.get("window")
        made: Any = made_at(f"{what}.look", lambda: Layer.overlay(volume, *colors))
        look = made.look
    elif isinstance(look, dict):
        fields_of_look = {"version": 1, **look}
        look = made_at(f"{what}.look", lambda: look_files.build(fields_of_look, None))
    elif look is not None and layer.get("visible", True):  # a hidden layer is read as it was written
        made_at(f"{what}: field 'look'", lambda: presets.checked_name(look))
    given = {name: layer[name] for name in ("visible", "opacity", "time", "name") if layer.get(name) is not None}
    return made_at(what, lambda: Layer(volume, look, **given))


def _labels(labels: Any, what: str, reach: Reach) -> Labels | None:
    if labels is None:
        return None
    segmentation = volume_named(labels["volume"], f"{what}.volume", reach)
    chosen = looks_of_labels(labels, what)
    return made_at(what, lambda: Labels(segmentation, chosen, smooth=labels.get("smooth", True)))


def looks_of_labels(labels: Any, what: str) -> dict[int, Label] | None:
    """The looks by number that fields of labels describe; None if they have none."""
    looks = labels.get("labels")
    if looks is None:
        return None
    return {int(number): made_at(f"{what}: labels", partial(Label, **look)) for number, look in looks.items()}


def camera_of(camera: Any) -> Camera | None:
    """The camera that fields describe, if there are any."""
    return None if camera is None else made_at(WHAT, lambda: camera_json.build(camera))


def clips_of(document: Mapping[str, Any]) -> list[Clip]:
    """The clips that the document's field `clip` describes."""
    return [_clip(clip, f"{WHAT}: clip[{number}]") for number, clip in enumerate(document.get("clip", []))]


def shading_of(shading: Any) -> Any:
    """The light of a scene: "look", or what fields describe."""
    return shading if isinstance(shading, str) and shading == "look" else _shading(shading)


def _clip(clip: dict[str, Any], what: str) -> Clip:
    ((kind, numbers),) = clip.items()
    if kind == "plane":
        return made_at(what, lambda: ClipPlane(**numbers))
    box = made_at(what, lambda: Crop(**numbers))
    return box if kind == "keep" else made_at(what, lambda: CutOut(box))


def _shading(shading: Any) -> Shading | None:
    return made_at(WHAT, lambda: look_files.build_shading(shading))


def options_of(render: Mapping[str, Any]) -> dict[str, Any]:
    """Arguments of `Scene.render` that the field `render` describes."""
    what = f"{WHAT}: render"
    options = {name: value for name, value in render.items() if value is not None}
    if "size" in options:
        options["size"] = tuple(options["size"])
    for name, kind in (("quality", Sampling), ("stereo", Stereo)):
        if isinstance(options.get(name), dict):
            options[name] = made_at(f"{what}.{name}", partial(kind, **options[name]))
    made_at(what, lambda: checked_eyes(options.get("stereo"), options.get("panorama", False)))
    if "composite" in options:
        options["composite"] = made_at(f"{what}.composite", lambda: _operator(options["composite"]))
    return options


def _operator(given: Any) -> Operator | None:
    if not isinstance(given, dict):
        return checked_operator(given)
    ((name, numbers),) = given.items()
    operator: Operator = OPERATORS[name](**numbers)
    return operator
