"""The fields that colour the layers of a viewer: facts of them for the page, and the values of both at a point."""

from __future__ import annotations

from math import isfinite
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wavesplat._looks.kinds import unit_of_values
from wavesplat._looks.transfer_function import TransferFunction
from wavesplat._model.volume import Volume
from wavesplat._render.arguments import chosen_look
from wavesplat._scene.layer import Layer
from wavesplat._scene.scene import Scene
from wavesplat._scene.summary import quantity_of
from wavesplat._viewer.previews import preview_of
from wavesplat._viewer.probing import sample_at, value_at


def color_fields_of(scene: Scene) -> list[dict[str, Any] | None]:
    """Facts of the field that colours each layer: name, unit of values, nodes of its colours; None without one."""
    # Looks that are chosen by the values are those of the first picture, which is of copies of what is lazy.
    return [
        None if layer.color_from is None else _facts_of(layer.color_from, seen.color_from)
        for layer, seen in zip(scene.layers, preview_of(scene).layers, strict=True)
    ]


def _facts_of(field: Layer, seen: Layer) -> dict[str, Any]:
    function = chosen_look(seen.look, seen.looked_at, "over").transfer_function
    nodes = function.color if isinstance(function, TransferFunction) else ()
    return {
        "name": _name_of(field),
        "value_unit": unit_of_values(field.drawn) or "",
        "color": [list(node) for node in nodes],
    }


def values_at(scene: Scene, point: NDArray[np.float64]) -> list[dict[str, Any]]:
    """Values of the visible layers that a field colours, each before its field's, at a world point.

    Returns dictionaries of name, value of the nearest sample (None outside, and where it is missing) and unit.
    """
    values = []
    for layer in scene.layers:
        if layer.is_shown and layer.color_from is not None:
            values += [_value_of(layer, point), _value_of(layer.color_from, point)]
    return values


def _value_of(layer: Layer, point: NDArray[np.float64]) -> dict[str, Any]:
    volume = layer.drawn
    place = sample_at(volume.world_from_index, volume.shape, point) if isinstance(volume, Volume) else None
    value = None if place is None or not isinstance(volume, Volume) else value_at(volume, place)
    is_known = value is not None and isfinite(value)
    return {"name": _name_of(layer), "value": value if is_known else None, "unit": unit_of_values(volume) or ""}


def _name_of(layer: Layer) -> str:
    """The layer's own name, else that of its values, which distinguishes datasets of one file."""
    return quantity_of(layer) or layer.name or ""
