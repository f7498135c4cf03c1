"""Fields of a picture's report beside the renderer's numbers: what is shown, from where, and how it was drawn.

The scene in it is a document (`scene_json`) that draws the same picture: looks, camera and sampling as they were found,
not as they were asked for.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from wavesplat import _native
from wavesplat._looks import look_files
from wavesplat._looks.layer_names import is_of_patient
from wavesplat._looks.look import Look
from wavesplat._model.arguments.operators import Operator, name_of
from wavesplat._model.arguments.sampling import Sampling
from wavesplat._model.camera.camera import Camera
from wavesplat._model.camera.stereo import Eyes
from wavesplat._model.volume.grid import is_scan
from wavesplat._model.volume.private_names import published
from wavesplat._model.volume.sources import with_paths
from wavesplat._scene.documents import scene_json
from wavesplat._scene.drawing.drawn_layers import Curves, DrawnLayer

if TYPE_CHECKING:
    from wavesplat._scene.layer import Layer
    from wavesplat._scene.scene import Scene

#: Largest number of transfer functions whose fields are kept: one per layer, and one per view of projections.
MAX_KEPT = 32


def facts_of(
    scene: Scene,
    layers: Sequence[DrawnLayer],
    functions: Sequence[Curves],
    *,
    camera: Camera,
    size: tuple[int, int],
    sampling: Sampling,
    psnr: float | None,
    kernel: str,
    operator: Operator,
    eyes: Eyes,
) -> dict[str, Any]:
    """Fields of the report: version, scene, quality, kernel and operator."""
    quality, composite = scene_json.fields_of_sampling(sampling), scene_json.fields_of_operator(operator)
    looks = {id(layer.layer): _resolved(scene, layer, curves) for layer, curves in zip(layers, functions, strict=True)}
    colors = [layer.color for layer in layers if layer.color is not None]
    looks |= {id(color.layer): look_files.fields_of(color.look, _curves(scene, color.function)) for color in colors}

    def look_of(layer: Layer) -> Any:
        return looks[id(layer)] if id(layer) in looks else scene_json.given_look(layer)

    document = scene_json.document_of(scene, strict=False, look_of=look_of)
    document["camera"] = camera.as_json()
    # The light is written in the looks, with all else that was found.
    document["shading"] = "look"
    if document["background"] is None and layers:
        document["background"] = layers[0].look.background
    document["render"] = {"size": list(size), "quality": quality, "kernel": kernel, "composite": composite}
    if eyes.stereo is not None:
        document["render"]["stereo"] = scene_json.settings(eyes.stereo)
    if eyes.panorama:
        document["render"]["panorama"] = True
    if psnr is not None:
        document["render"]["psnr"] = psnr
    return {
        "version": _native.__version__,
        "scene": published(document, _private_paths(scene)),
        "quality": quality,
        "kernel": kernel,
        "composite": name_of(operator),
    }


def _private_paths(scene: Scene) -> set[str]:
    """Paths of files that hold scans of patients, and labels on them, by what the files say."""
    layers = [*scene.layers, *(layer.color_from for layer in scene.layers if layer.color_from is not None)]
    found: set[str] = set()

    def note(path: str) -> str:
        found.add(path)
        return path

    for layer in layers:
        if is_of_patient(layer.drawn) or is_scan(layer.drawn.facts):
            with_paths(layer.volume._source or layer.drawn._source, note)
    if scene.labels is not None and found:
        with_paths(scene.labels._source, note)
    return found


def _resolved(scene: Scene, layer: DrawnLayer, curves: Curves) -> Any:
    """Fields of a look with the transfer function that was drawn; None where it has labels, which no look can hold."""
    look = layer.look
    if look.labels is not None:
        return None
    return look_files.fields_of(_on(scene, replace(look, transfer_function=curves)), _curves(scene, curves))


def _curves(scene: Scene, curves: Curves) -> dict[str, Any]:
    """Fields of a transfer function; fields of two dimensions are large, and kept."""
    kept = scene._cache.documents
    found = kept.get(id(curves))
    if found is None or found[0] is not curves:
        if len(kept) >= MAX_KEPT:
            kept.clear()
        found = kept[id(curves)] = curves, look_files.fields_of_curves(curves)
    fields: dict[str, Any] = found[1]
    return fields


def _on(scene: Scene, look: Look) -> Look:
    """The look in the scene's light, and with its background where it has none, for which greys were chosen."""
    if scene.shading != "look":
        look = replace(look, shading=scene.shading)
    if look.background is not None or scene.background is None:
        return look
    if isinstance(scene.background, str):
        return replace(look, background=scene.background)
    red, green, blue = (round(255 * share) for share in scene.background[:3])
    return replace(look, background=f"#{red:02x}{green:02x}{blue:02x}")
