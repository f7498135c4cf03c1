"""Notes on volumes of a scene that a user should know of: without a brain to draw, and far from each other."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from wavesplat._looks.brain import PROCESSING as BRAIN
from wavesplat._model.camera import Camera
from wavesplat._model.grid import Grid

__all__ = ["is_inside", "note_on_brain", "notes_on_places"]

#: Gap between the boxes of two volumes, as a share of the first one's diagonal, from which they lie apart: tiles of an
#: image touch each other.
FAR = 0.05


def note_on_brain(name: str, seen: Grid, why: str | None) -> str:
    """Note on a layer whose look draws the brain. `seen`: the drawn volume. `why`: the reason if no brain was found."""
    if why is not None:
        return (
            f"no brain was found apart from skull and skin in {name!r}, so all of it is drawn: {why}; "
            "strip the skull first (mri_synthstrip, HD-BET), or take another look"
        )
    if BRAIN not in seen.facts.processing:
        return f"{name!r} is no larger than a brain, so it is drawn as it is, as a scan without its skull"
    return "the brain is drawn alone, by a simple extraction (thresholds and shapes), not for measuring"


def notes_on_places(volumes: Sequence[tuple[str, Grid]]) -> list[str]:
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


def is_inside(camera: Camera, volume: Grid) -> bool:
    """Whether the eye is in the box of a volume, as in pictures from inside an airway."""
    low, high = volume.bounds
    return bool((low < camera.position).all() and (camera.position < high).all())
