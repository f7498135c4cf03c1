"""Scenes that are quick to draw while something moves: lazy volumes by coarse copies in memory."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from wavesplat._model.lazy_volume import LazyVolume
from wavesplat._scene.scene import Scene

__all__ = ["has_lazy", "preview_of"]

#: The last scene, and its copy.
_LAST: list[tuple[Scene, Scene]] = []


def has_lazy(scene: Scene) -> bool:
    """Whether the scene has lazy volumes, whose samples are read while it is drawn."""
    return any(isinstance(layer.volume, LazyVolume) for layer in scene.layers)


def preview_of(scene: Scene) -> Scene:
    """The scene with copies in the place of lazy volumes; itself where it has none, or labels."""
    if not has_lazy(scene) or scene.labels is not None:
        return scene
    for known, copy in _LAST:
        if known is scene:
            return copy
    layers = []
    for layer in scene.layers:
        volume: Any = layer.volume
        if isinstance(volume, LazyVolume):
            volume = volume.preview()
        layers.append(replace(layer, volume=volume))
    # Boxes in samples are in those of the volume itself.
    within = scene._clipping.in_world(scene.layers[0].drawn)
    clips = [*within.planes, *within.boxes, *([within.crop] if within.crop else [])]
    copy = scene.with_(layers=layers, clip=clips)
    _LAST[:] = [(scene, copy)]
    return copy
