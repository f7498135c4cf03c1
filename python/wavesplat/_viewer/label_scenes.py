"""Segmentations that are opened alone: their regions are labels of the scene, which the page lists, hides and colours.

The automatic look of such a volume has the labels in itself, and documents of scenes hold no looks with labels.
"""

from __future__ import annotations

from dataclasses import replace

from wavesplat._looks.kinds import kind_of
from wavesplat._looks.look import Look
from wavesplat._model.series import Series
from wavesplat._scene.scene import Scene


def with_labels_apart(scene: Scene) -> Scene:
    """The scene with the labels of its only layer's look as its own; the scene itself where there are none."""
    if len(scene.layers) != 1 or scene.labels is not None:
        return scene
    (layer,) = scene.layers
    if isinstance(layer.volume, Series) or not layer.visible:
        return scene
    look = layer.look
    if look in (None, "auto") and kind_of(layer.looked_at) == "labels":
        look = Look.auto(layer.drawn)
    if not isinstance(look, Look) or look.labels is None:
        return scene
    return scene.with_(layers=[replace(layer, look=replace(look, labels=None))], labels=look.labels)
