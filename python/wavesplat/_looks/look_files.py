"""A look from a file: ours, or 3D Slicer's, or ParaView's; what is in it decides, not its name."""

from __future__ import annotations

from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any

from wavesplat._files import json_object, json_text, xml_text
from wavesplat._looks import look_json, paraview_files, slicer_files, transfer_function_json
from wavesplat._looks.look import Look
from wavesplat._looks.transfer_function_2d import TransferFunction2D
from wavesplat._model import paraview_state
from wavesplat.errors import ArgumentError

if TYPE_CHECKING:
    from wavesplat._model.volume import Volume
    from wavesplat._model.wavelet_volume import WaveletVolume

WHAT = "look"


def load(path: str | PathLike[str], volume: Volume | WaveletVolume | None, name: str | None) -> Look:
    """See `Look.load`."""
    return json_object.load(path, WHAT, lambda text: _parse(text, volume, name, Path(path)))


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
        return look_json.build(document, volume)
    if "rgba" in document:
        return Look(transfer_function=TransferFunction2D._of_fields(document))
    return Look(transfer_function=transfer_function_json.build(document, volume), name=document.get("name") or "")


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
