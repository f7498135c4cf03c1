"""Changes of a state (JSON Patch) that show another scene, or further layers, labels and shapes beside what is open."""

from __future__ import annotations

from typing import Any, TypeAlias

from wavesplat._scene.scene import Scene
from wavesplat._viewer.state import ViewerState

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
    """Changes that show the further layers, the labels and the shapes of a scene that holds those of the state.

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
