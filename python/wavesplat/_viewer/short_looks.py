"""Short forms of a state for links and commands: looks by the name of a preset, or of a colour map and its window.

A look in full has some hundred numbers, one of a colour map 256 colours. Where the named look of the same volume has
the very same fields, the name says as much.
"""

from __future__ import annotations

import json
from typing import Any

from wavesplat._files.notes import collected_notes
from wavesplat._looks import look_json, overlays, presets
from wavesplat._looks.look import Look
from wavesplat._scene.scene import names_by_themselves
from wavesplat._viewer.state import ViewerState
from wavesplat.errors import WavesplatError

#: Fields of a layer that may be left out where they have these values.
USUAL: dict[str, Any] = {"visible": True, "opacity": 1.0, "time": 0}


def short_document(state: ViewerState, document: dict[str, Any]) -> dict[str, Any]:
    """The document, or its form for files, without what is usual and with named looks."""
    layers = []
    for number, layer in enumerate(document["layers"]):
        kept = {name: value for name, value in layer.items() if name not in USUAL or value != USUAL[name]}
        if layer["name"] == names_by_themselves(state.scene.layers)[number]:
            kept.pop("name")
        layers.append({**kept, "look": short_look(state, number)})
    usual: dict[str, Any] = {"labels": None, "shading": "look", "clip": [], "geometry": []}
    rest = {name: value for name, value in document.items() if name not in usual or value != usual[name]}
    return {**rest, "layers": layers}


def short_look(state: ViewerState, number: int) -> dict[str, Any] | str:
    """The look of a layer: a preset's name, or {"map": name, "window": [low, high]}, or all its fields."""
    fields: dict[str, Any] = state.document["layers"][number]["look"]
    name, layer = str(fields.get("name", "")), state.scene.layers[number]
    if layer.time != 0:
        return fields
    if name in presets.catalogue() and _fields(lambda: Look.preset(name, layer.looked_at)) == fields:
        return name
    if name == "auto" and number == 0 and _fields(lambda: Look.auto(layer.looked_at)) == fields:
        return name
    curves = fields["transfer_function"]
    if "color" not in curves:
        return fields
    window = [curves["color"][0][0], curves["color"][-1][0]]
    for ends in (window, None):
        if _fields(lambda: overlays.overlay(layer.looked_at, name, ends)) == fields:  # noqa: B023 - called at once
            return {"map": name} if ends is None else {"map": name, "window": window}
    return fields


def _fields(make: Any) -> Any:
    """The fields of a look in JSON's types; None where there is no such look."""
    try:
        with collected_notes():
            return json.loads(json.dumps(look_json.fields_of(make())))
    except WavesplatError:
        return None
