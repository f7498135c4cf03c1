"""Looks in files: our JSON, and files of 3D Slicer and ParaView; the content of a file decides, not its name.

    {"version": 1, "name": "ct-bone", "description": "Skeleton.", "kind": "ct",
     "transfer_function": {"values": "hounsfield", "opacity_unit": 1.0, "opacity": [...], "color": [...]},
     "shading": {"diffuse": 0.9, "lights": [{"direction": [-1, 1, 2]}]},
     "composite": "over", "view": null, "background": null, "part": null}

All but the version and the transfer function may be left out; `"shading": null` draws the colours as given.
A transfer function of two dimensions has the field `rgba`; `transfer_function_json` describes one of the value alone.
"""

from __future__ import annotations

from dataclasses import fields
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any

from wavesplat import _native
from wavesplat._looks.curves import transfer_function
from wavesplat._looks.curves import transfer_function as transfer_function_json
from wavesplat._looks.curves.transfer_function import TransferFunction
from wavesplat._looks.curves.transfer_function_2d import TransferFunction2D
from wavesplat._looks.interchange import paraview_files, slicer_files
from wavesplat._looks.look import Look
from wavesplat._looks.shading import Light, Shading
from wavesplat._model.interchange import paraview_state
from wavesplat._storage import json_texts
from wavesplat._storage import json_texts as json_text
from wavesplat._storage import reading as xml_text
from wavesplat.errors import ArgumentError

if TYPE_CHECKING:
    from wavesplat._model.volume.volume import Volume
    from wavesplat._model.volume.wavelet_volume import WaveletVolume

WHAT = "look"


def write(look: Look) -> str:
    """JSON text of a look; numbers read back exactly."""
    return json_texts.write(fields_of(look))


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
    return build(json_texts.parse(text, WHAT, "transfer_function"), volume)


def build(document: dict[str, Any], volume: Volume | WaveletVolume | None) -> Look:
    """The look that an object describes."""
    name, description, _, view, composite, background, part = _native.look_texts(document)
    curves = document["transfer_function"]
    transfer_function: TransferFunction | TransferFunction2D
    if "rgba" in curves:
        transfer_function = TransferFunction2D._of_fields(curves)
    else:
        named = {"name": name or "this look", **curves}
        transfer_function = transfer_function_json.build(named, volume, in_look=True)
    operator: Any = composite or "over"
    opened: Any = part
    return Look(
        transfer_function=transfer_function,
        shading=build_shading(document["shading"]) if "shading" in document else Shading(),
        composite=operator,
        view=view,
        background=background,
        part=opened,
        name=name or "",
        reason=description or "",
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
    lights = [_made(Light, one) for one in _native.lights_of(document)]
    shading: Shading = _made(Shading, {**document, "lights": lights})
    return shading


def _made(kind: Any, document: Any) -> Any:
    _native.check_settings(document, kind is Light)
    try:
        return kind(**document)
    except TypeError as error:
        raise ArgumentError(f"{WHAT}: {kind.__name__.lower()} is {document!r}: {error}") from None


# A look from a file: ours, or 3D Slicer's, or ParaView's; what is in it decides, not its name.


def load(path: str | PathLike[str], volume: Volume | WaveletVolume | None, name: str | None) -> Look:
    """See `Look.load`."""
    return json_texts.load(path, WHAT, lambda text: _parse(text, volume, name, Path(path)))


def _parse(text: str, volume: Volume | WaveletVolume | None, name: str | None, path: Path) -> Look:
    start = text.lstrip("\ufeff \t\r\n")[:1]
    stem = path.name.partition(".")[0]
    if paraview_state.is_state(text):
        return paraview_files.look(_one(paraview_state.color_maps(text), "Name", name), volume)
    if start == "<":
        root = xml_text.parsed(text, WHAT)
        if any(True for _ in root.iter(paraview_files.TAG)):
            return paraview_files.look(_one(paraview_files.from_xml(root), "Name", name), volume)
        return _of_slicer(slicer_files.from_xml(root), volume, name)
    if start in ("{", "["):
        return _of_json(json_text.decode(text, WHAT), volume, name, stem)
    return _of_slicer([slicer_files.from_vp(text, stem)], volume, name)


def _of_json(document: Any, volume: Volume | WaveletVolume | None, name: str | None, stem: str) -> Look:
    if isinstance(document, dict) and "RGBPoints" in document:
        document = [document]
    if isinstance(document, list):
        return paraview_files.look(_one(paraview_files.from_json(document), "Name", name), volume)
    if "volumeProperties" in document:
        return _of_slicer(slicer_files.from_json(document, stem), volume, name)
    if name is not None:
        raise ArgumentError(f"{WHAT}: the file holds one; leave out the name {name!r}")
    if "transfer_function" in document:
        return build(document, volume)
    if "rgba" in document:
        return Look(transfer_function=TransferFunction2D._of_fields(document))
    return Look(transfer_function=transfer_function.build(document, volume), name=document.get("name") or "")


def _of_slicer(
    properties: list[slicer_files.VolumeProperty], volume: Volume | WaveletVolume | None, name: str | None
) -> Look:
    chosen = _one([{"name": one.name, "property": one} for one in properties], "name", name)["property"]
    look: Look = chosen.look(volume)
    return look


def _one(found: list[dict[str, Any]], field: str, name: str | None) -> dict[str, Any]:
    """The entry of a name, or the only one."""
    names = [str(one.get(field, "")) for one in found]
    if name is None and len(found) == 1:
        return found[0]
    if name is None:
        raise ArgumentError(f"{WHAT}: the file holds {len(found)}; name one of: {', '.join(names)}")
    for one, known in zip(found, names, strict=True):
        if known.lower() == name.lower():
            return one
    raise ArgumentError(f"{WHAT}: the file has no {name!r}; it has {', '.join(names)}")
