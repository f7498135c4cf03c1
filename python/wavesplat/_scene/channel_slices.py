"""Slices of fluorescence channels: each in its colour over its window, all of them added, as light is."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import takewhile
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from wavesplat._looks.channels import light_of
from wavesplat._looks.kinds import unit_of_values
from wavesplat._looks.look import Look
from wavesplat._looks.transfer_function import TransferFunction
from wavesplat._picture.report_facts import shown_layer
from wavesplat._render.slicing import Planes
from wavesplat._scene.layer import Layer
from wavesplat._scene.scene import Scene

__all__ = ["added", "channels_of", "window_of"]

Floats: TypeAlias = NDArray[np.float32]


def channels_of(scene: Scene) -> list[Layer]:
    """The first layers of a scene as far as they are channels; none where there is one, which is shown in grey."""
    channels = list(takewhile(_is_channel, scene.layers))
    return channels if len(channels) > 1 else []


def window_of(layer: Layer) -> tuple[float, float]:
    """The values of a channel that are shown as black and as its full colour."""
    low, high, _ = _light(layer)
    return low, high


def added(
    behind: Floats, planes: Planes, channels: Sequence[Layer], **options: Any
) -> tuple[Floats, list[dict[str, Any]]]:
    """The light of channels added over black, where one of them has values, else `behind`; and the report's entries.

    behind : associated RGBA, shape (height, width, 4).
    options : kernel, slab and threads, as for `wavesplat.slice`.
    """
    light = np.zeros((*behind.shape[:2], 3), np.float32)
    has_values = np.zeros(behind.shape[:2], bool)
    entries = []
    for layer in channels:
        if not layer.is_shown:
            continue
        low, high, color = _light(layer)
        values = planes.values_of(layer.drawn, **options)
        known = np.isfinite(values)
        share = np.where(known, np.clip((values - low) / (high - low), 0.0, 1.0), 0.0)
        light += np.float32(layer.opacity) * share[..., None] * np.array(color, np.float32)
        has_values |= known
        curves = TransferFunction([(low, 1.0)], [(low, 0.0, 0.0, 0.0), (high, *color)])
        name = layer.name or layer.drawn.name
        entries.append(shown_layer(name, "over", curves, unit_of_values(layer.drawn)))
    rgba = np.array(behind)
    rgba[has_values, :3] = np.minimum(light[has_values], 1.0)
    rgba[has_values, 3] = 1.0
    return rgba, entries


def _is_channel(layer: Layer) -> bool:
    look: Any = layer.look
    return isinstance(look, Look) and look.name == "channel"


def _light(layer: Layer) -> tuple[float, float, tuple[float, float, float]]:
    look: Any = layer.look
    return light_of(look)
