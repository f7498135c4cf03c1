"""Transfer functions as JSON: one object, with a version, whose errors name the field.

    {"version": 1, "opacity_unit": 1.0,
     "opacity": [[150, 0], [400, 0.8]],
     "color": [[150, 0.8, 0.5, 0.3], [400, 1, 1, 0.9]]}

`"values": "fraction"` marks curves whose values are fractions of a volume's robust range; `value_scale` has others.
`"opacity_unit_share": 0.01` instead of a unit is a share of the longest side of the volume's box.
`"gradient_opacity": [[magnitude, factor], ...]` may be left out.
"""

from __future__ import annotations

from collections.abc import Collection
from typing import TYPE_CHECKING, Any

from wavesplat._files import json_object
from wavesplat._looks import value_scale
from wavesplat._looks.transfer_function import TransferFunction
from wavesplat.errors import ArgumentError

if TYPE_CHECKING:
    from wavesplat._model.volume import Volume
    from wavesplat._model.wavelet_volume import WaveletVolume

WHAT = "transfer function"
FIELDS = {
    "version",
    "name",
    "description",
    "values",
    "opacity_unit",
    "opacity_unit_share",
    "opacity",
    "color",
    "gradient_opacity",
}
NEEDED = ("version", "opacity", "color")


def write(transfer_function: TransferFunction) -> str:
    """JSON text of a transfer function; numbers read back exactly."""
    return json_object.write(fields_of(transfer_function))


def fields_of(transfer_function: TransferFunction) -> dict[str, Any]:
    """The curves of a transfer function as the fields of its JSON object."""
    curves: dict[str, Any] = {
        "opacity_unit": transfer_function.opacity_unit,
        "opacity": transfer_function.opacity,
        "color": transfer_function.color,
    }
    if transfer_function.gradient_opacity:
        curves["gradient_opacity"] = transfer_function.gradient_opacity
    return curves


def parse(text: str, volume: Volume | WaveletVolume | None) -> TransferFunction:
    """The transfer function in a JSON text."""
    return build(json_object.parse(text, WHAT, "opacity and color"), volume)


def build(
    document: dict[str, Any], volume: Volume | WaveletVolume | None, needed: Collection[str] = NEEDED
) -> TransferFunction:
    """The transfer function that an object describes. `needed`: fields that it must have."""
    json_object.check_fields(document, WHAT, needed=needed, known=FIELDS, hint="TransferFunction.to_json")
    for name in ("opacity", "color", "gradient_opacity"):
        json_object.check_list(document, WHAT, name, "nodes, [[value, ...], ...]")
    scale = document.get("values", "samples")
    if scale not in value_scale.NAMES:
        names = ", ".join(f'"{name}"' for name in value_scale.NAMES)
        raise ArgumentError(f"transfer function: field 'values' is {scale!r}; it is one of: {names}")
    unit = json_object.optional_number(document, WHAT, "opacity_unit")
    share = json_object.optional_number(document, WHAT, "opacity_unit_share")
    curves = TransferFunction(document["opacity"], document["color"], unit, document.get("gradient_opacity", []))
    if scale in value_scale.ABSOLUTE and share is None:
        return curves
    if volume is None:
        name = document.get("name", "these curves")
        raise ArgumentError(f"transfer function: {name} is relative to a volume's values; pass the volume too")
    if share is not None:
        lower, upper = volume.bounds
        unit = share * float(max(upper - lower))
    return TransferFunction(
        value_scale.nodes_on(scale, curves.opacity, volume),
        value_scale.nodes_on(scale, curves.color, volume),
        unit,
        value_scale.widths_on(scale, curves.gradient_opacity, volume),
    )
