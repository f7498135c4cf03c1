"""Looks of volumes that lie over another one, as PET over CT: clear where their values are least, so that it shows.

A look by the name of a colour map gets opacities that rise from the low end of its window, or from the value that
counts as the volume's smallest. Diverging maps are clear at their centre and rise to both ends. A look that is made for
a projection says nothing of matter that a ray passes through: its opacities rise in the same way.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import replace
from itertools import pairwise
from typing import TYPE_CHECKING, TypeAlias

import numpy as np
from numpy.typing import NDArray

from wavesplat._looks import presets
from wavesplat._looks.curves import colormaps, colors, value_scale
from wavesplat._looks.curves.transfer_function import TransferFunction
from wavesplat._looks.curves.transfer_function_2d import TransferFunction2D
from wavesplat._looks.curves.value_scale import End, values_of
from wavesplat._looks.kinds import channels, histogram
from wavesplat._looks.kinds.kinds import Kind
from wavesplat._looks.look import Look
from wavesplat._system.values import number
from wavesplat.errors import ArgumentError

if TYPE_CHECKING:
    from wavesplat._model.arguments.sampling import Composite
    from wavesplat._model.volume.volume import Volume
    from wavesplat._model.volume.wavelet_volume import WaveletVolume


Window: TypeAlias = tuple[float, float] | None

#: Kinds of data whose automatic looks are for surfaces, or are greys, which over other greys say nothing; and the
#: colour maps that these get instead, in turn.
MAPPED_KINDS: tuple[Kind, ...] = ("CT", "MR", "PET", "ultrasound", "EM", "FA", "probability", "map", "field", "scan")
OVERLAY_MAPS = ("hot", "winter", "summer", "cool")
#: The map of values of two signs.
TWO_SIGNS = "coolwarm"
#: Opacity by place in the values, 0..1, of a layer without a window. The lowest tenth is background, of which a ray
#: passes through much; tuned on PET over CT, in space and on slices.
PLACES, ALPHAS = (0.0, 0.08, 0.2, 0.45, 1.0), (0.0, 0.0, 0.08, 0.45, 1.0)
#: Thickness of a slab with these opacities, as a share of the longest side of the volume's box.
UNIT_SHARE = 0.02
#: Part of the range of values over which a preset's opacity rises from a clear lowest value.
RISE = 0.15
#: Largest channel of a colour that adds no light to a projection.
DARK = 0.02


def overlay(
    volume: Volume | WaveletVolume, name: str | None, given: Iterable[End] | None, threshold: float | None = None
) -> Look:
    """See `Layer.overlay`."""
    window = None if given is None else values_of(given, volume)
    if threshold is not None:
        if name is None and window is None:
            low, high = volume.value_range
            name = TWO_SIGNS if low < 0 else OVERLAY_MAPS[0]
            window = (low, -low) if high < 0 else None
        return _beyond(overlay(volume, name, window), threshold)
    if name is None:
        name = "gray"
    is_preset = presets.plain(name) in {presets.plain(one) for one in presets.names()}
    if window is None and is_preset:
        return Look.preset(name, volume)
    if name.startswith("#") or (name in colors.NAMES and name not in ("grey", "gray", "black")):
        return channels.channel_look(volume, name, window)
    try:
        function = mapped(volume, name, window)
    except ArgumentError as error:
        has_values = f"the preset {name!r} has values of its own, so leave out the window" if is_preset else error
        raise ArgumentError(f"the look of a layer is a preset, a colour or a colour map: {has_values}") from None
    return Look(transfer_function=function, shading=None, name=name)


def _beyond(look: Look, threshold: float) -> Look:
    """The look, opaque from a threshold on; of two signs from it on both sides of 0."""
    function = look.transfer_function
    if isinstance(function, TransferFunction2D):
        raise ArgumentError("a threshold of values is for colours of values, and this look is of gradients too")
    number(threshold, "threshold", "a finite number, in the volume's values")
    above = [(threshold, 0.0), (threshold, 1.0)]
    if _is_of_two_signs(function):
        if not threshold > 0:
            raise ArgumentError(
                f"threshold is {threshold:g}, and {look.name!r} has colours for two signs: values between -T and T are "
                "hidden, so give a positive T; to show one sign alone, a map such as 'hot'"
            )
        above = [(-threshold, 1.0), (-threshold, 0.0), *above]
    curves = TransferFunction(above, function.color, function.opacity_unit)
    return replace(look, transfer_function=curves, composite="over")


def mapped(volume: Volume | WaveletVolume, colormap: str, window: Window = None) -> TransferFunction:
    """The colours of a map for a volume over another one. `window`: values that are clear and that are opaque."""
    if colormaps.is_diverging(colormap):
        return _diverging(volume, colormap, window)
    if window is not None:
        return TransferFunction.from_colormap(colormap, clim=window, opacity="linear")
    low, high = value_scale.ends("fraction", volume)
    nodes = [(low + place * (high - low), alpha) for place, alpha in zip(PLACES, ALPHAS, strict=True)]
    return TransferFunction.from_colormap(colormap, clim=(low, high), opacity=nodes, opacity_unit=_unit(volume))


def cleared(look: Look, volume: Volume | WaveletVolume, composite: Composite) -> Look:
    """A look for a volume over another one, clear where the values are least; itself where it is so already.

    look : with the operator that it is made for.
    composite : the operator that it is drawn with.
    """
    function = look.transfer_function
    if isinstance(function, TransferFunction2D):
        return look
    if composite in histogram.PROJECTIONS:
        # Light that the lowest value adds, as the white of `pet` does, would cover all other layers.
        low, high = function.color[0][0], function.color[-1][0]
        is_dark = max(function.color[0][1:]) <= DARK or function([low])[0, 3] == 0
        if look.composite not in histogram.PROJECTIONS or is_dark:
            return look
        return replace(look, transfer_function=_times(function, lambda values: (values - low) / (high - low)))
    if look.composite in histogram.PROJECTIONS:
        low, high = function.color[0][0], function.color[-1][0]

        def risen(values: NDArray[np.float64]) -> NDArray[np.float64]:
            rising: NDArray[np.float64] = np.interp((values - low) / (high - low), PLACES, ALPHAS)
            return rising

        marks = [low + place * (high - low) for place in PLACES]
        rising = _times(function, risen, marks, opacity_unit=_unit(volume))
        return replace(look, transfer_function=rising)
    least, most = volume.value_range
    alphas = [alpha for _, alpha in function.opacity]
    shows_low = any(before > after for before, after in pairwise(alphas)) and alphas[-1] < alphas[0]
    # Looks of one's own mean what they say, and those that show low values, such as air, would be lost.
    if not look.name or shows_low or _is_of_two_signs(function) or not least < most or function([least])[0, 3] == 0:
        return look
    rise = RISE * (most - least)
    ramp = [least + place * rise for place in np.linspace(0, 1, 9)]
    smooth = _times(function, lambda values: np.clip((values - least) / rise, 0, 1) ** 2, ramp)
    return replace(look, transfer_function=smooth)


def _is_of_two_signs(function: TransferFunction) -> bool:
    """Whether values below 0 and above it show, and 0 does not: the lowest ones are no background."""
    low, high = ([value for value, alpha in function.opacity if alpha > 0 and value * sign > 0] for sign in (-1, 1))
    return bool(low and high and function([0.0])[0, 3] == 0)


def _times(
    function: TransferFunction,
    factor: Callable[[NDArray[np.float64]], NDArray[np.float64]],
    marks: list[float] | None = None,
    *,
    opacity_unit: float | None = None,
) -> TransferFunction:
    """The transfer function with opacities times a factor of the value. `marks`: values that the product bends at."""
    ends = [node[0] for node in (*function.opacity, *function.color)]
    values = np.unique([*ends, *(marks or [])])
    alphas = np.clip(function(values)[:, 3] * np.clip(factor(values), 0, 1), 0, 1)
    nodes = list(zip(values.tolist(), alphas.tolist(), strict=True))
    unit = function.opacity_unit if function.opacity_unit is not None else opacity_unit
    return TransferFunction(nodes, function.color, unit, function.gradient_opacity)


def _diverging(volume: Volume | WaveletVolume, colormap: str, window: Window) -> TransferFunction:
    """A diverging map, clear about its centre: 0, or the value of the volume that is nearest to it.

    A window of two signs has the ends of the map; of one from a positive value on, less is clear on both sides of 0.
    """
    places, rgb = colormaps.colors_of(colormap)
    centre, dead = 0.0, 0.0
    if window is None:
        low, high = value_scale.ends("fraction", volume)
        centre = min(max(0.0, low), high)
        reach = max(high - centre, centre - low)
        low, high = centre - reach, centre + reach
    elif window[0] < 0 < window[1]:
        low, high = window
    elif window[0] >= 0:
        dead, high = window
        low = -high
    else:
        raise ArgumentError(
            f"the window {window[0]:g},{window[1]:g} of the diverging map {colormap!r} has negative values only; give "
            f"{window[0]:g},{-window[0]:g}, or {max(-window[1], 0.0):g},{-window[0]:g} for what is clear and opaque on "
            "both sides of 0"
        )
    halves = (2 * places - 1).tolist()
    values = [
        centre - dead + half * (centre - dead - low) if half < 0 else centre + dead + half * (high - centre - dead)
        for half in halves
    ]
    color = [(value, *one) for value, one in zip(values, rgb.tolist(), strict=True)]
    if dead > 0:
        return TransferFunction([(low, 1.0), (-dead, 0.0), (dead, 0.0), (high, 1.0)], color)
    rising = list(zip(PLACES, ALPHAS, strict=True))
    below = [(centre - place * (centre - low), alpha) for place, alpha in reversed(rising)]
    above = [(centre + place * (high - centre), alpha) for place, alpha in rising[1:]]
    return TransferFunction([*below, *above], color, _unit(volume))


def _unit(volume: Volume | WaveletVolume) -> float:
    lower, upper = volume.bounds
    return UNIT_SHARE * float(max(upper - lower))
