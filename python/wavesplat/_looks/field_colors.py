"""Colours of a field by a named map: even over its values, or over their logarithm where a few are far larger."""

from __future__ import annotations

from typing import Any

import numpy as np

from wavesplat._looks import colormaps
from wavesplat._looks.automatic import automatic
from wavesplat._looks.kinds import kind_of
from wavesplat._looks.overlays import mapped
from wavesplat._looks.transfer_function import TransferFunction
from wavesplat._model.volume import Volume

__all__ = ["field_colors"]

#: Map of fields without a named one.
FIELD_MAP = "inferno"


def field_colors(volume: Volume, colormap: str | None, window: Any = None) -> TransferFunction:
    """The colours of a map over a window, by default over the values that the automatic look of the field shows.

    Maps that diverge, too, have their ends at those of the window; without one, of values with two signs their middle
    is at 0.

    Raises
    ------
    ArgumentError
        If there is no such map, or the window cannot work.
    """
    name = colormap or FIELD_MAP
    if window is not None:
        return TransferFunction.from_colormap(name, clim=window)
    kind = kind_of(volume)
    if kind != "field":
        is_even = colormaps.is_diverging(name) and kind != "signed field"
        return TransferFunction.from_colormap(name, volume) if is_even else mapped(volume, name)
    function = automatic(volume, "over").transfer_function
    assert isinstance(function, TransferFunction)
    values = [value for value, *_ in function.color]
    places, colors = colormaps.colors_of(name)
    rgb = [np.interp(np.linspace(0, 1, len(values)), places, colors[:, c]).tolist() for c in range(3)]
    return TransferFunction(function.opacity, list(zip(values, *rgb, strict=True)), function.opacity_unit)
