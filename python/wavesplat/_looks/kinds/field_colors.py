"""Colours of a field by a named map, over the values that its automatic look shows, on the same scale.

Values are even, or logarithms where a few are far larger; of two signs the map's middle is at 0.
"""

from __future__ import annotations

from typing import Any

from wavesplat._looks.curves import colormaps
from wavesplat._looks.curves.transfer_function import TransferFunction
from wavesplat._looks.kinds.automatic import COLORED, automatic, function_in_colors
from wavesplat._looks.kinds.kinds import kind_of
from wavesplat._looks.kinds.overlays import mapped
from wavesplat._model.volume.volume import Volume

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
    if kind_of(volume) not in COLORED:
        is_even = colormaps.is_diverging(name)
        return TransferFunction.from_colormap(name, volume) if is_even else mapped(volume, name)
    function = automatic(volume, "over").transfer_function
    assert isinstance(function, TransferFunction)
    return function_in_colors(function, name)
