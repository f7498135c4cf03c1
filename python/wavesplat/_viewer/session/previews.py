"""Scenes that are quick to draw while something moves: lazy volumes by coarse copies in memory."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from wavesplat._model.lazy.volume import LazyVolume
from wavesplat._scene.layer import Layer
from wavesplat._scene.scene import Scene

#: The last scene, and its copy.
_LAST: list[tuple[Scene, Scene]] = []


def has_lazy(scene: Scene) -> bool:
    """Whether the scene has lazy volumes, whose samples are read while it is drawn."""
    fields = [layer.color_from for layer in scene.layers if layer.color_from is not None]
    return any(isinstance(one.volume, LazyVolume) for one in (*scene.layers, *fields))


def preview_of(scene: Scene) -> Scene:
    """The scene with copies in the place of lazy volumes; itself where it has none, or labels."""
    if not has_lazy(scene) or scene.labels is not None:
        return scene
    for known, copy in _LAST:
        if known is scene:
            return copy
    layers = [_copied(layer) for layer in scene.layers]
    # Boxes in samples are in those of the volume itself.
    within = scene._clipping.in_world(scene.layers[0].drawn)
    clips = [*within.planes, *within.boxes, *([within.crop] if within.crop else [])]
    copy = scene.with_(layers=layers, clip=clips)
    _LAST[:] = [(scene, copy)]
    return copy


def _copied(layer: Layer) -> Layer:
    """The layer, and the field that colours it, with a copy in memory of what is lazy."""
    volume: Any = layer.volume
    if isinstance(volume, LazyVolume):
        volume = volume.preview()
    field = None if layer.color_from is None else _copied(layer.color_from)
    return replace(layer, volume=volume, color_from=field)
