"""Transfer functions as JSON: one object, with a version, whose errors name the field.

    {"version": 1, "opacity_unit": 1.0,
     "opacity": [[150, 0], [400, 0.8]],
     "color": [[150, 0.8, 0.5, 0.3], [400, 1, 1, 0.9]]}

`"values": "fraction"` marks curves whose values are fractions of a volume's robust range (`histogram.robust_range`).
`"gradient_opacity": [[magnitude, factor], ...]` may be left out.
"""

from __future__ import annotations

from os import PathLike
from typing import TYPE_CHECKING, Any

from wavesplat._files import json_object
from wavesplat._looks.transfer_function import TransferFunction
from wavesplat.errors import ArgumentError

if TYPE_CHECKING:
    from wavesplat._model.volume import Volume
    from wavesplat._model.wavelet_volume import WaveletVolume

__all__ = ["load", "parse", "write"]

WHAT = "transfer function"
FIELDS = {"version", "name", "description", "values", "opacity_unit", "opacity", "color", "gradient_opacity"}


def write(transfer_function: TransferFunction) -> str:
    """JSON text of a transfer function; numbers read back exactly."""
    curves: dict[str, Any] = {
        "opacity_unit": transfer_function.opacity_unit,
        "opacity": transfer_function.opacity,
        "color": transfer_function.color,
    }
    if transfer_function.gradient_opacity:
        curves["gradient_opacity"] = transfer_function.gradient_opacity
    return json_object.write(curves)


def load(path: str | PathLike[str], volume: Volume | WaveletVolume | None) -> TransferFunction:
    """The transfer function in a file."""
    return json_object.load(path, WHAT, lambda text: parse(text, volume))


def parse(text: str, volume: Volume | WaveletVolume | None) -> TransferFunction:
    """The transfer function in a JSON text."""
    document = json_object.parse(text, WHAT, "opacity and color")
    _check_fields(document)
    return _build(document, volume)


def _check_fields(document: dict[str, Any]) -> None:
    needed = ("version", "opacity", "color")
    json_object.check_fields(document, WHAT, needed=needed, known=FIELDS, hint="TransferFunction.to_json")
    for name in ("opacity", "color", "gradient_opacity"):
        json_object.check_list(document, WHAT, name, "nodes, [[value, ...], ...]")
    if document.get("values", "samples") not in ("samples", "fraction"):
        raise ArgumentError(
            f'transfer function: field \'values\' is {document["values"]!r}; it is "samples" or "fraction"'
        )


def _build(document: dict[str, Any], volume: Volume | WaveletVolume | None) -> TransferFunction:
    unit = json_object.optional_number(document, WHAT, "opacity_unit")
    gradient = document.get("gradient_opacity", [])
    curves = TransferFunction(document["opacity"], document["color"], unit, gradient)
    if document.get("values") != "fraction":
        return curves
    if volume is None:
        name = document.get("name", "these curves")
        raise ArgumentError(f"transfer function: {name} is relative to a volume's values; pass the volume too")
    from wavesplat._looks.histogram import robust_range

    low, high = robust_range(volume)
    opacity = [(low + value * (high - low), alpha) for value, alpha in curves.opacity]
    color = [(low + value * (high - low), *rgb) for value, *rgb in curves.color]
    # A fitted curve follows the volume: its opacities are per voxel.
    gradient = [(magnitude * (high - low), factor) for magnitude, factor in curves.gradient_opacity]
    return TransferFunction(opacity, color, curves.opacity_unit, gradient)
