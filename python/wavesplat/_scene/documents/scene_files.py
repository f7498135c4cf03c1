"""Scenes in files: documents, reports of pictures, PNG files with the document, and samples as channels."""

from __future__ import annotations

from collections.abc import Sequence
from os import PathLike
from typing import Any

import numpy as np

from wavesplat._looks.kinds.channel_light import light_of
from wavesplat._looks.look import Look
from wavesplat._model.interchange import volume_file
from wavesplat._model.interchange.ome_files import Downsampling
from wavesplat._model.volume.facts import Channel
from wavesplat._model.volume.series import Series
from wavesplat._model.volume.stack import VolumesOfTimes, stacked
from wavesplat._model.volume.volume import Volume
from wavesplat._picture.picture_files import KEYWORD, SIGNATURE, text_in
from wavesplat._scene.documents import scene_json
from wavesplat._scene.documents.scene_json import Document
from wavesplat._scene.layer import Layer
from wavesplat._storage import size_checks
from wavesplat._storage.addresses import check_no_address
from wavesplat._storage.paths import expanded, read_text
from wavesplat._storage.reading import reading
from wavesplat.errors import ArgumentError

# Scenes in files: documents, reports of pictures, and PNG files, whose metadata have the document.


def load(path: str | PathLike[str], *, external_files: bool = False) -> Document:
    """The document in a file; relative paths in it start from the file's folder.

    external_files : whether it may name files elsewhere.
    """
    check_no_address(path, "a scene")
    place = expanded(path)
    size_checks.check_readable(place)
    with reading("a scene", path), place.open("rb") as file:
        is_png = file.read(len(SIGNATURE)) == SIGNATURE
    if is_png:
        with reading("a scene", path):
            text = text_in(place.read_bytes(), KEYWORD)
        if text is None:
            raise ArgumentError(f"this PNG file does not say how it was made; wavesplat wrote none of it: {path}")
    else:
        text = read_text(path, scene_json.WHAT)
    try:
        return scene_json.parse(text, place.absolute().parent, external_files=external_files)
    except ArgumentError as error:
        raise ArgumentError(f"{error}: {path}") from None


# Samples of a scene's layers in one file, as its channels.

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
    """Colour and window of a channel's look; with another look, the volume's own."""
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
