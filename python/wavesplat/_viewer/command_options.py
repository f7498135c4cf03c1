"""Options of `wavesplat render` that draw a state, where its looks have names and nothing else is unusual."""

from __future__ import annotations

import json
import shlex
from typing import Any

from wavesplat._scene.scene import names_by_themselves
from wavesplat._viewer.short_looks import short_look
from wavesplat._viewer.state import ViewerState


def options_of(state: ViewerState, size: tuple[int, int]) -> str | None:
    """The arguments of the command, but for the output; None where options cannot say what the state says.

    Options are for volumes that are files opened without options of their own; the first with a preset, others with a
    preset or a colour map; no labels, cuts, geometry or light that were changed.
    """
    document, options = state.document, state.options
    is_plain = (
        document["labels"] is None
        and document["shading"] == "look"
        and not document["clip"]
        and not document["geometry"]
        and not state.scene.keep_table
        and all(field is None for field in state.color_fields)
        and isinstance(options["composite"], str)
        and isinstance(options["quality"], str)
    )
    names = names_by_themselves(state.scene.layers)
    if not is_plain or not all(map(_is_plain_layer, document["layers"], state.sources, names)):
        return None
    looks = [short_look(state, number) for number in range(len(state.sources))]
    first, *others = zip(looks, state.sources, strict=True)
    if not isinstance(first[0], str):
        return None
    layers = [_layer(look, source["path"]) for look, source in others]
    if None in layers:
        return None
    look = document["layers"][0]["look"]
    arguments = [first[1]["path"], "--preset", first[0], *[part for text in layers for part in ("--layer", str(text))]]
    if document["background"] != (look["background"] or "black"):
        if not isinstance(document["background"], str):
            return None
        arguments += ["--background", document["background"]]
    given = (("quality", "normal"), ("kernel", "linear"), ("composite", look["composite"]))
    for name, usual in given:
        arguments += [] if options[name] == usual else [f"--{name}", options[name]]
    camera = json.dumps(document["camera"], separators=(",", ":"))
    arguments += ["--size", f"{size[0]}x{size[1]}", "--camera", camera]
    return shlex.join(arguments)


def _is_plain_layer(layer: dict[str, Any], source: dict[str, Any], name: str) -> bool:
    """Whether a layer is a file without options, shown in full under the name that it has by itself."""
    path = source.get("path")
    return (
        isinstance(path, str)
        and not path.startswith("-")
        and set(source) == {"path"}
        and layer["visible"]
        and layer["opacity"] == 1
        and layer["time"] == 0
        and layer["name"] == name
    )


def _layer(look: dict[str, Any] | str, path: str) -> str | None:
    """The text of `--layer`: FILE:LOOK:LOW,HIGH."""
    if any(sign in path for sign in ":#,"):
        return None
    if isinstance(look, str):
        return f"{path}:{look}"
    if "map" not in look or any(sign in look["map"] for sign in ":#,"):
        return None
    window = look.get("window")
    return ":".join([path, look["map"], *([] if window is None else [",".join(map(_number, window))])])


def _number(value: float) -> str:
    """A number in as few letters as read back to it."""
    short = f"{value:g}"
    return short if float(short) == value else repr(value)
