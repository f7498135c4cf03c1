"""Fields of a picture's report for figures: view, layers with their colours, labels."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from typing import Any

from wavesplat._looks.curves.colors import Rgba
from wavesplat._looks.curves.transfer_function import TransferFunction
from wavesplat._looks.curves.transfer_function_2d import TransferFunction2D
from wavesplat._looks.kinds.kinds import unit_of_values
from wavesplat._looks.labels.labels import Labels
from wavesplat._model.arguments.operators import Operator, name_of
from wavesplat._model.camera.camera import Camera
from wavesplat._model.volume.series import TimeStamp, time_stamp_of
from wavesplat._picture.annotating import TIME
from wavesplat._picture.report_facts import facts_of_view, shown_layer
from wavesplat._scene.drawing.drawn_layers import DrawnLayer
from wavesplat._scene.drawing.volumes_of_layers import identity_of
from wavesplat._scene.layer import Layer
from wavesplat._scene.scene import Scene


def facts_of_picture(
    scene: Scene, camera: Camera, size: tuple[int, int], background: Rgba | None, labels: Labels | None
) -> dict[str, Any]:
    """The report's camera, pixels and background, and the names of labels."""
    facts = [layer.drawn.facts for layer in scene.layers]
    view = facts_of_view(camera, size, next((one for one in facts if one.unit is not None), facts[0]))
    return {**view, "background": background, "labels": names_of(labels), **facts_of_time(scene)}


def facts_of_time(scene: Scene) -> dict[str, Any]:
    """The report's time point; empty where no layer is one of several."""
    stamp = _time_stamp(scene)
    return {} if stamp is None else {"time": {"number": stamp.number, "text": stamp.text}}


def stamped(title: str, scene: Scene) -> str:
    """A title with the scene's time in place of `{time}`, as wide as at every other time of the scene's series."""
    stamp = _time_stamp(scene) if TIME in title else None
    return title if stamp is None else title.replace(TIME, stamp.padded)


def _time_stamp(scene: Scene) -> TimeStamp | None:
    stamps = (time_stamp_of(layer.volume, layer.time) for layer in scene.layers)
    return next((stamp for stamp in stamps if stamp is not None), None)


def names_of(labels: Labels | None, numbers: Collection[int] | None = None) -> list[dict[str, Any]]:
    """Names and colours of the labels that have a colour in the picture. `numbers`: those that count; None is all."""
    looks = {} if labels is None else labels.labels
    return [
        {"name": look.name or str(number), "color": list(look.color)}
        for number, look in looks.items()
        if (look.opacity or look.tint) and (numbers is None or number in numbers)
    ]


def facts_of_layers(
    scene: Scene,
    layers: Sequence[DrawnLayer],
    functions: Sequence[TransferFunction | TransferFunction2D],
    operator: Operator,
) -> dict[str, Any]:
    """The report's list of visible layers with the colours that they are drawn with."""
    return {
        "shown": [
            _shown(scene, layer, function, operator)
            for layer, function in zip(layers, functions, strict=True)
            if layer.opacity > 0
        ]
    }


def quantity_of(layer: Layer) -> str | None:
    """The name of a layer's values by its file; None where there is none, or the layer has a name of its own."""
    return None if layer._has_own_name else layer.drawn.facts.quantity


def _shown(
    scene: Scene, layer: DrawnLayer, function: TransferFunction | TransferFunction2D, operator: Operator
) -> dict[str, Any]:
    """The report's entry of a layer; of one that another field colours, that field's name, colours and unit."""
    color, composite, own = layer.color, name_of(operator), layer.layer
    is_of_both = isinstance(function, TransferFunction2D) and composite == "over"
    if color is None or is_of_both:
        return shown_layer(own.name or "", composite, function, _unit(scene, own), quantity_of(own))
    # A surface that another field colours has as many colours as matter.
    of_field, colors = color.layer, color.function_at(function, operator).color
    # This field's values do not decide what is seen, so a bar has all of its colours.
    curves = TransferFunction([(colors[0][0], 1.0)], colors)
    # Its name distinguishes the colouring field from the one that is seen, so a colour bar says it beside the unit.
    named = color.name if of_field._has_own_name else None
    return shown_layer(color.name, "over", curves, _unit(scene, of_field), quantity_of(of_field) or named)


def _unit(scene: Scene, layer: Layer) -> str:
    """The unit of a layer's values, found once for all pictures of a scene."""
    # A series has the unit of one of its volumes, which is kept anyway.
    volume = layer.looked_at
    key: Any = id(volume), "unit"
    return scene._cache.get_or_compute(key, identity_of(volume), lambda: unit_of_values(volume))
