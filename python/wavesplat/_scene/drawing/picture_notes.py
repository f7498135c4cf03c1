"""Notes on pictures of a scene: a face or a table that shows, what was left out or hides the rest, who drew it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from wavesplat._looks.body.brain import PROCESSING as BRAIN
from wavesplat._looks.body.brain import brain_of
from wavesplat._looks.body.table import PROCESSING as TABLE_LEFT_OUT
from wavesplat._looks.curves.transfer_function import TransferFunction
from wavesplat._looks.kinds.automatic import is_block
from wavesplat._looks.kinds.kinds import kind_of
from wavesplat._model.arguments.clips import Clipping
from wavesplat._model.arguments.operators import FirstHit
from wavesplat._model.camera.camera import Camera
from wavesplat._model.volume.grid import Grid, is_thin
from wavesplat._render.devices import chosen_device
from wavesplat._render.faces import NOTE as FACE_NOTE
from wavesplat._render.faces import is_from_behind, shows_face
from wavesplat._render.notes import LEFT_OUT, note_on_steps, note_on_table
from wavesplat._render.opened import can_be_cut_open, note_on_block
from wavesplat._scene.drawing.drawn_frame import DrawnFrame
from wavesplat._scene.drawing.drawn_layers import Curves, DrawnLayer
from wavesplat._scene.drawing.scene_shapes import notes_on_geometry

if TYPE_CHECKING:
    from wavesplat._scene.scene import Scene

#: Gap between the boxes of two volumes, as a share of the first one's diagonal, from which they lie apart: tiles of an
#: image touch each other.
FAR = 0.05
DENSE = (
    "dense matter fills the volume up to its faces, and hides what is inside: --composite maximum shows the brightest "
    "of it, --cut-out +x-y+z opens it, and --slice-plane shows slices in space"
)


def notes_on_drawing(
    frame: DrawnFrame, layers: Sequence[DrawnLayer], functions: Sequence[Curves], report: Mapping[str, Any]
) -> list[str]:
    """Notes on what may be recognised or was left out, and on who drew."""
    notes = [FACE_NOTE] if _has_face(frame, layers, functions) else []
    notes += [
        *_notes_on_parts(frame.scene, layers),
        *_notes_on_steps(frame, layers),
        *_notes_on_tables(frame, layers, functions),
    ]
    notes += _notes_on_places([(layer.name, layer.volume) for layer in layers if layer.opacity > 0])
    notes += notes_on_geometry(frame.scene.geometry, frame.shapes, frame.scene._clipping, frame.options)
    device = report["device"]
    if chosen_device(frame.options.device) not in ("auto", "cpu") and device["name"] == "cpu" and device["reason"]:
        notes.append(f"drawn by the CPU: {device['reason']}")
    return notes


def _notes_on_parts(scene: Scene, layers: Sequence[DrawnLayer]) -> list[str]:
    """Notes on layers that are drawn in part, or whose look asks for a part."""
    asked = [layer for layer in layers if layer.look.part == "brain"]
    notes = [_note_on_brain(layer.name, layer.seen, _why_no_brain(layer)) for layer in asked]
    is_left_out = any(TABLE_LEFT_OUT in layer.seen.facts.processing for layer in layers)
    cut = {can_be_cut_open(layer.volume) for layer in layers if layer.look.part == "cut open"}
    is_dense = any(_is_dense(scene, layer) for layer in layers)
    return [
        *notes,
        *([LEFT_OUT] if is_left_out else []),
        *(note_on_block(is_cut=is_cut) for is_cut in sorted(cut)),
        *([DENSE] if is_dense else []),
    ]


def _is_dense(scene: Scene, layer: DrawnLayer) -> bool:
    """Whether an automatic look of microscopy shows only the outer faces of a volume, so that its inside is hidden."""
    volume, look = layer.volume, layer.look
    if not (layer.is_automatic and look.composite == "over" and layer.opacity > 0) or is_thin(volume):
        return False

    def found() -> bool:
        function = look.transfer_function
        if not isinstance(function, TransferFunction) or kind_of(volume) not in ("EM", "fluorescence"):
            return False
        return is_block(volume, function)

    return scene._cache.get_or_compute((id(volume), "dense", look.transfer_function), layer.identity, found)


def _why_no_brain(layer: DrawnLayer) -> str | None:
    """Why no brain was found for a look that draws the brain alone; None if one was found or none is drawn."""
    found = brain_of(layer.volume) if layer.look.part == "brain" else None
    return found if isinstance(found, str) else None


def _notes_on_steps(frame: DrawnFrame, layers: Sequence[DrawnLayer]) -> list[str]:
    """Notes on layers in the light whose slices are far apart; none on drafts."""
    if frame.composite not in ("over", "first-hit") or frame.sampling.quality == "draft":
        return []
    lit = [layer for layer in layers if layer.opacity > 0 and layer.look.shading is not None]
    return [note for layer in lit if (note := note_on_steps(layer.volume)) is not None]


def _has_face(frame: DrawnFrame, layers: Sequence[DrawnLayer], functions: Sequence[Curves]) -> bool:
    """Whether a face may be recognised (`faces`); not asked of drafts, which are drawn while something is dragged."""
    if (
        frame.composite not in ("over", "first-hit")
        or frame.sampling.quality == "draft"
        or is_from_behind(frame.camera)
    ):
        return False
    iso_value = frame.operator.iso_value if isinstance(frame.operator, FirstHit) else None

    def found(layer: DrawnLayer, function: Curves) -> bool:
        if BRAIN in layer.seen.facts.processing:
            return False
        curves, clipping = layer.faded(function), replace(frame.clipping, boxes=layer.boxes)
        key: Any = id(layer.volume), "face"
        return frame.scene._cache.get_or_compute(
            key,
            (layer.identity, curves, clipping, iso_value),
            lambda: shows_face(layer.volume, curves, clipping, iso_value=iso_value),
        )

    return any(found(layer, function) for layer, function in zip(layers, functions, strict=True) if layer.opacity > 0)


def _notes_on_tables(frame: DrawnFrame, layers: Sequence[DrawnLayer], functions: Sequence[Curves]) -> list[str]:
    """Notes on CTs that show their tables; none on drafts, projections, scans that are cut, and from inside of them."""
    if frame.composite != "over" or frame.sampling.quality == "draft" or frame.clipping != Clipping():
        return []

    def found(layer: DrawnLayer, function: Curves) -> str | None:
        volume, curves = layer.seen, layer.faded(function)
        key: Any = id(volume), "table"
        return frame.scene._cache.get_or_compute(key, (layer.identity, curves), lambda: note_on_table(volume, curves))

    pairs = [pair for pair in zip(layers, functions, strict=True) if pair[0].opacity > 0 and not pair[0].boxes]
    shown = [pair for pair in pairs if not _is_inside(frame.camera, pair[0].volume)]
    return list(dict.fromkeys(note for layer, curves in shown if (note := found(layer, curves)) is not None))


def _note_on_brain(name: str, seen: Grid, why: str | None) -> str:
    """Note on a layer whose look draws the brain. `seen`: the drawn volume. `why`: the reason if no brain was found."""
    if why is not None:
        return (
            f"no brain was found apart from skull and skin in {name!r}, so all of it is drawn: {why}; "
            "strip the skull first (mri_synthstrip, HD-BET), or take another look"
        )
    if BRAIN not in seen.facts.processing:
        return f"{name!r} is no larger than a brain, so it is drawn as it is, as a scan without its skull"
    return "the brain is drawn alone, by a simple extraction (thresholds and shapes), not for measuring"


def _notes_on_places(volumes: Sequence[tuple[str, Grid]]) -> list[str]:
    """Notes on volumes, with their names, that lie apart from the first one, such as scans of two patients."""
    return [note for one in volumes[1:] if (note := _note_on_place(*one, *volumes[0])) is not None]


def _note_on_place(name: str, volume: Grid, first_name: str, first: Grid) -> str | None:
    (low, high), (first_low, first_high) = volume.bounds, first.bounds
    gap = float(np.linalg.norm(np.maximum(0, np.maximum(low - first_high, first_low - high))))
    if not gap > FAR * float(np.linalg.norm(first_high - first_low)):
        return None
    unit = f" {volume.unit}" if volume.unit else ""
    where = ", ".join(f"{axis} {a:g} to {b:g}" for axis, a, b in zip("xyz", low, high, strict=True))
    return (
        f"the layer {name!r} lies {gap:.3g}{unit} away from {first_name!r}, at {where}; are they of one subject, "
        "in one space?"
    )


def _is_inside(camera: Camera, volume: Grid) -> bool:
    """Whether the eye is in the box of a volume, as in pictures from inside an airway."""
    low, high = volume.bounds
    return bool((low < camera.position).all() and (camera.position < high).all())
