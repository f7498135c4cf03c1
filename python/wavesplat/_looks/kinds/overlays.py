"""Looks of volumes that lie over another one, as PET over CT: clear where their values are least, so that it shows.

A look by the name of a colour map gets opacities that rise from the low end of its window, or from the value that
counts as the volume's smallest. The compiled module decides (`crates/look`: `over_others.rs`).
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from typing import TYPE_CHECKING, TypeAlias

from wavesplat import _native
from wavesplat._looks import presets
from wavesplat._looks.curves import colormaps, colors, value_scale
from wavesplat._looks.curves.transfer_function import TransferFunction
from wavesplat._looks.curves.transfer_function_2d import TransferFunction2D
from wavesplat._looks.curves.value_scale import End, values_of
from wavesplat._looks.kinds import channels
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
    if _native.has_two_signs(function._core):
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
    is_diverging = colormaps.is_diverging(colormap)
    if window is None:
        ends = value_scale.ends("fraction", volume)
    else:
        ends = window if is_diverging else values_of(window, volume, "clim")
    places, colors_of_map = colormaps.colors_of(colormap)
    made = _native.map_over(places, colors_of_map, is_diverging, ends, window is not None, _longest_side(volume))
    if made is None:
        low, high = ends
        raise ArgumentError(
            f"the window {low:g},{high:g} of the diverging map {colormap!r} has no positive values; give "
            f"{low:g},{-low:g}, or {abs(high):g},{-low:g} for what is clear and opaque on both sides of 0"
        )
    nodes, unit = made
    return TransferFunction(*nodes, opacity_unit=unit)


def cleared(look: Look, volume: Volume | WaveletVolume, composite: Composite) -> Look:
    """A look for a volume over another one, clear where the values are least; itself where it is so already.

    look : with the operator that it is made for.
    composite : the operator that it is drawn with.
    """
    function = look.transfer_function
    if isinstance(function, TransferFunction2D):
        return look
    made = _native.cleared(
        function._core, look.composite, bool(look.name), composite, volume.value_range, _longest_side(volume)
    )
    if made is None:
        return look
    opacity, unit = made
    return replace(look, transfer_function=TransferFunction(opacity, function.color, unit, function.gradient_opacity))


def _longest_side(volume: Volume | WaveletVolume) -> float:
    lower, upper = volume.bounds
    return float(max(upper - lower))
