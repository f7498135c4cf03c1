"""Samples of a scene's layers in one file, as its channels."""

from __future__ import annotations

from collections.abc import Sequence
from os import PathLike
from typing import Any

import numpy as np

from wavesplat._looks.channel_light import light_of
from wavesplat._looks.look import Look
from wavesplat._model import volume_file
from wavesplat._model.facts import Channel
from wavesplat._model.ome_zarr_file import Downsampling
from wavesplat._model.series import Series
from wavesplat._model.stack import VolumesOfTimes, stacked
from wavesplat._model.volume import Volume
from wavesplat._scene.layer import Layer
from wavesplat.errors import ArgumentError

#: Least cosine between the hues of a look and of a file's colour, which it shows lightened, that count as one.
SAME_HUE = 0.98


def save(layers: Sequence[Layer], path: str | PathLike[str], downsampling: Downsampling | None) -> None:
    """See `Scene.save_volumes`."""
    volumes: list[VolumesOfTimes] = []
    for layer in layers:
        volume: Any = layer.volume
        if not isinstance(volume, Series | Volume):
            raise ArgumentError(
                f"layer {layer.name!r} holds wavelet coefficients and no samples; leave it out, or decode it"
            )
        volumes.append(volume if isinstance(volume, Series) else [volume])
    first: Any = layers[0].volume
    times, unit = (first.times, first.time_unit) if isinstance(first, Series) else ((0.0,), None)
    stack = stacked(volumes, [_channel(layer) for layer in layers], times, unit)
    volume_file.save(stack, path, downsampling)


def _channel(layer: Layer) -> Channel:
    """The channel of a layer: name of the layer, colour and window of its look, the rest of its volume."""
    own = layer.drawn.facts.channel or Channel()
    color, window = _shown(layer.look, own)
    return Channel(str(layer.name), color, own.emission_nm, window, layer.visible)


def _shown(look: object, own: Channel) -> tuple[Any, Any]:
    """Colour and window of a channel's look; of another look those of the volume."""
    light = light_of(look) if isinstance(look, Look) else None
    if light is None:
        return own.color, own.window
    is_own = own.color is not None and _are_of_one_hue(light.color, own.color)  # before it was lightened
    return own.color if is_own else light.color, (light.low, light.high)


def _are_of_one_hue(color: Sequence[float], other: Sequence[float]) -> bool:
    hues = [np.subtract(one, min(one)) for one in (color, other)]
    lengths = [float(np.linalg.norm(hue)) for hue in hues]
    if min(lengths) == 0:
        return max(lengths) == 0
    return float(hues[0] @ hues[1]) >= SAME_HUE * lengths[0] * lengths[1]
