"""Sources of the samples of a picture: its layers, and after them the fields that colour layers, in the order of these.

The compiled module counts them so for lazy volumes, of which it asks boxes of samples.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from wavesplat._looks.shading import Shading
from wavesplat._looks.transfer_function import TransferFunction
from wavesplat._model.composites import Operator
from wavesplat._model.volume import Volume
from wavesplat._model.wavelet_volume import WaveletVolume
from wavesplat._scene.drawn_layers import Curves, DrawnLayer

if TYPE_CHECKING:
    from wavesplat._render.lazy_layers import LazyLayers

__all__ = ["colors_of", "for_module", "sources_of"]


def sources_of(layers: Sequence[DrawnLayer]) -> list[Volume | WaveletVolume]:
    """The volumes as drawn."""
    return [layer.seen for layer in layers] + [layer.color.seen for layer in layers if layer.color is not None]


def colors_of(
    layers: Sequence[DrawnLayer], functions: Sequence[Curves], operator: Operator
) -> list[TransferFunction | None]:
    """The transfer function of the field that colours each layer; None without one."""
    pairs = zip(layers, functions, strict=True)
    return [None if layer.color is None else layer.color.function_at(function, operator) for layer, function in pairs]


def for_module(
    layers: Sequence[DrawnLayer],
    functions: Sequence[Curves],
    lights: Sequence[Shading | None],
    colors: Sequence[TransferFunction | None],
    lazy: LazyLayers | None,
) -> list[tuple[Any, Any, Any, Any]]:
    """The layers for the compiled module: volume, transfer function, light, and the field that colours it."""
    if lazy is not None:
        return lazy.for_module(functions, lights, colors)
    fields = [
        None if layer.color is None or color is None else (layer.color.seen._core, color._core)
        for layer, color in zip(layers, colors, strict=True)
    ]
    return [
        (layer.core, function._core, None if light is None else light._core, field)
        for layer, function, light, field in zip(layers, functions, lights, fields, strict=True)
    ]
