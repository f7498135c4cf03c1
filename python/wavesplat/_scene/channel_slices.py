"""Slices of fluorescence channels: each in its colour over its window, all of them added, as light is."""

from __future__ import annotations

from itertools import takewhile
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from wavesplat._looks.channel_light import ChannelLight, light_of
from wavesplat._looks.kinds import kind_of, unit_of_values
from wavesplat._looks.look import Look
from wavesplat._model.facts import is_part_of_color
from wavesplat._picture.report_facts import shown_layer
from wavesplat._render.slicing import Planes
from wavesplat._scene.layer import Layer
from wavesplat._scene.looks_of_layers import is_automatic, looks_beside_each_other
from wavesplat._scene.scene import Scene
from wavesplat._scene.volumes_of_layers import identity_of

Floats: TypeAlias = NDArray[np.float32]
#: Layers that are channels, and their light.
Channels: TypeAlias = "list[tuple[Layer, ChannelLight]]"


def channels_of(scene: Scene) -> Channels:
    """The first layers of a scene as far as they are channels; none where there is one, which is shown in grey.

    A channel has a look of `Look.channel`, or is fluorescence without a look, in the colour that it has in space.
    """
    if len(scene.layers) == 1:
        return []
    found = takewhile(lambda one: one[1] is not None, ((layer, _light(scene, layer)) for layer in scene.layers))
    channels = [(layer, light) for layer, light in found if light is not None]
    return channels if len(channels) > 1 else []


def automatic_fluorescence(scene: Scene, layer: Layer) -> Look | None:
    """The look that a channel without a look has in space, beside the others; None of other layers.

    Channels are fluorescence, and the red, green and blue of colour pictures.
    """
    if not is_automatic(layer):
        return None
    volume = layer.looked_at
    if is_part_of_color(volume.facts):
        key = (id(volume), "part of a colour")
        return scene._cache.get_or_compute(key, identity_of(volume), lambda: Look.channel(volume))
    kind = scene._cache.get_or_compute((id(volume), "kind"), identity_of(volume), lambda: kind_of(volume))
    if kind != "fluorescence":
        return None
    shown = [one for one in scene.layers if one.is_shown or one is layer]
    return looks_beside_each_other(scene, shown, "over")[next(n for n, one in enumerate(shown) if one is layer)]


def added(behind: Floats, planes: Planes, channels: Channels, **options: Any) -> tuple[Floats, list[dict[str, Any]]]:
    """The light of channels added over black, where one of them has values, else `behind`; and the report's entries.

    behind : associated RGBA, shape (height, width, 4).
    options : kernel, slab and threads, as for `wavesplat.slice`.
    """
    light = np.zeros((*behind.shape[:2], 3), np.float32)
    has_values = np.zeros(behind.shape[:2], bool)
    entries = []
    for layer, own in channels:
        if not layer.is_shown:
            continue
        values = planes.values_of(layer.drawn, **options)
        known = np.isfinite(values)
        light[known] += np.float32(layer.opacity) * own.curve(values[known])[:, :3].astype(np.float32)
        has_values |= known
        name = layer.name or layer.drawn.name
        entries.append(shown_layer(name, "over", own.curve, unit_of_values(layer.drawn)))
    rgba = np.array(behind)
    rgba[has_values, :3] = np.minimum(light[has_values], 1.0)
    rgba[has_values, 3] = 1.0
    return rgba, entries


def _light(scene: Scene, layer: Layer) -> ChannelLight | None:
    """The light of a layer that is a channel."""
    look = layer.look if isinstance(layer.look, Look) else automatic_fluorescence(scene, layer)
    return None if look is None else light_of(look)
