"""Looks as JSON: one object, with a version, whose errors name the field. The presets are files of this kind.

    {"version": 1, "name": "ct-bone", "description": "Skeleton.", "kind": "ct",
     "transfer_function": {"values": "hounsfield", "opacity_unit": 1.0, "opacity": [...], "color": [...]},
     "shading": {"diffuse": 0.9, "lights": [{"direction": [-1, 1, 2]}]},
     "composite": "over", "view": null, "background": null, "part": null}

All but the version and the transfer function may be left out; `"shading": null` draws the colours as given.
A transfer function of two dimensions has the field `rgba`; `transfer_function_json` describes one of the value alone.
"""

from __future__ import annotations

from dataclasses import fields
from typing import TYPE_CHECKING, Any, get_args

from wavesplat._files import json_object
from wavesplat._looks import transfer_function_json
from wavesplat._looks.look import Look
from wavesplat._looks.shading import Light, Shading
from wavesplat._looks.transfer_function import TransferFunction
from wavesplat._looks.transfer_function_2d import TransferFunction2D
from wavesplat._model.options import Composite
from wavesplat.errors import ArgumentError

if TYPE_CHECKING:
    from wavesplat._model.volume import Volume
    from wavesplat._model.wavelet_volume import WaveletVolume

WHAT = "look"
TEXTS = ("name", "description", "kind", "view", "composite", "background", "part")
FIELDS = {"version", "transfer_function", "shading", *TEXTS}


def write(look: Look) -> str:
    """JSON text of a look; numbers read back exactly."""
    return json_object.write(fields_of(look))


def fields_of_curves(curves: TransferFunction | TransferFunction2D) -> dict[str, Any]:
    """The fields of a transfer function of one or two dimensions."""
    return curves._fields() if isinstance(curves, TransferFunction2D) else transfer_function_json.fields_of(curves)


def fields_of(look: Look, curves: dict[str, Any] | None = None) -> dict[str, Any]:
    """The fields of a look's JSON object, but the version. `curves`: fields of its transfer function, if known."""
    if look.labels is not None:
        raise ArgumentError("this look has labels, which are as large as a volume; save the look without them")
    return {
        "name": look.name,
        "description": look.reason,
        "transfer_function": fields_of_curves(look.transfer_function) if curves is None else curves,
        "shading": None if look.shading is None else fields_of_shading(look.shading),
        "composite": look.composite,
        "view": look.view,
        "background": look.background,
        **({} if look.part is None else {"part": look.part}),
    }


def parse(text: str, volume: Volume | WaveletVolume | None) -> Look:
    """The look in a JSON text."""
    return build(json_object.parse(text, WHAT, "transfer_function"), volume)


def build(document: dict[str, Any], volume: Volume | WaveletVolume | None) -> Look:
    """The look that an object describes."""
    needed = ("version", "transfer_function")
    json_object.check_fields(document, WHAT, needed=needed, known=FIELDS, hint="Look.to_json")
    for name in TEXTS:
        if not isinstance(document.get(name), str | None):
            raise ArgumentError(f"{WHAT}: field {name!r} is {document[name]!r}; it must be a text or null")
    composite: Any = document.get("composite") or "over"
    part: Any = document.get("part")
    if composite not in get_args(Composite):
        raise ArgumentError(f"{WHAT}: field 'composite' is {composite!r}; use one of: {', '.join(get_args(Composite))}")
    curves = document["transfer_function"]
    if not isinstance(curves, dict):
        raise ArgumentError(f"{WHAT}: field 'transfer_function' is {curves!r}; it must be an object")
    transfer_function: TransferFunction | TransferFunction2D
    if "rgba" in curves:
        transfer_function = TransferFunction2D._of_fields(curves)
    else:
        named = {"name": document.get("name") or "this look", **curves}
        transfer_function = transfer_function_json.build(named, volume, needed=("opacity", "color"))
    return Look(
        transfer_function=transfer_function,
        shading=build_shading(document["shading"]) if "shading" in document else Shading(),
        composite=composite,
        view=document.get("view"),
        background=document.get("background"),
        part=part,
        name=document.get("name") or "",
        reason=document.get("description") or "",
    )


def fields_of_shading(light: Any) -> dict[str, Any]:
    """Settings of a `Shading` or `Light`."""
    settings = {field.name: getattr(light, field.name) for field in fields(light) if field.name != "_core"}
    if "lights" in settings:
        settings["lights"] = [fields_of_shading(one) for one in settings["lights"]]
    return settings


def build_shading(document: Any) -> Shading | None:
    if document is None:
        return None
    lights = document.get("lights", []) if isinstance(document, dict) else None
    if not isinstance(lights, list):
        raise ArgumentError(f"{WHAT}: field 'shading' is {document!r}; it must be an object, its lights a list")
    shading: Shading = _made(Shading, {**document, "lights": [_made(Light, one) for one in lights]})
    return shading


def _made(kind: Any, document: Any) -> Any:
    name = kind.__name__.lower()
    known = {field.name for field in fields(kind)} - {"_core"}
    if not isinstance(document, dict):
        raise ArgumentError(f"{WHAT}: {document!r} is no {name}; write an object")
    unknown = sorted(set(document) - known)
    if unknown:
        raise ArgumentError(f"{WHAT}: {name} has no {unknown[0]!r}; it has {', '.join(sorted(known))}")
    try:
        return kind(**document)
    except TypeError as error:
        raise ArgumentError(f"{WHAT}: {name} is {document!r}: {error}") from None
