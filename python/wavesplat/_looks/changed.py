"""Changes of a look that keep its colours, light and operator: window, gamma, opacity, exposure.

`crates/look` moves the nodes and multiplies the light (`changes.rs`). Of a look with shading exposure is the light's
(`Shading.exposure`).
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from wavesplat import _native
from wavesplat._looks.curves import colormaps
from wavesplat._looks.curves.transfer_function import TransferFunction
from wavesplat._looks.curves.value_scale import End, values_of
from wavesplat._looks.kinds import histogram
from wavesplat._looks.kinds.channels import is_ramp
from wavesplat._system.values import positive
from wavesplat.errors import ArgumentError

if TYPE_CHECKING:
    from wavesplat._looks.look import Look
    from wavesplat._model.volume.volume import Volume
    from wavesplat._model.volume.wavelet_volume import WaveletVolume


#: The values that factors may have, in messages.
NEUTRAL = "a positive number, 1 changes nothing"


def changed(
    look: Look,
    volume: Volume | WaveletVolume | None,
    *,
    window: Iterable[End] | None,
    gamma: float,
    opacity: Any,
    exposure: float,
) -> Look:
    """See `Look.changed`."""
    positive(gamma, "gamma", NEUTRAL)
    positive(exposure, "exposure", NEUTRAL)
    if window is None and gamma == 1 and opacity is None and exposure == 1:
        return look
    if look.shading is not None and exposure != 1:
        light = look.shading.changed(exposure=look.shading.exposure * exposure)
        look, exposure = replace(look, shading=light), 1.0
    if window is None and gamma == 1 and opacity is None and exposure == 1:
        return look
    function, done = _checked(look), []
    if window is not None:
        low, high = values_of(window, volume)
        function = _in_window(function, low, high)
        done.append(f"window {low:g} to {high:g}")
    if gamma != 1:
        function = bent(function, gamma)
        done.append(f"gamma {gamma:g}")
    if opacity is not None:
        function = _with_opacity(function, opacity)
        done.append("opacity as given")
    if exposure != 1:
        is_projection = look.composite in histogram.PROJECTIONS
        function = exposed(function, exposure, is_channel=look.name == "channel", is_projection=is_projection)
        done.append(f"exposure {exposure:g}")
    reason = "; ".join([look.reason, *done] if look.reason else done)
    return replace(look, transfer_function=function, name=_name_of_changed(look), reason=reason)


def _name_of_changed(look: Look) -> str:
    """The name of a look after a change; an automatic one gets the name that slices and backgrounds go by."""
    # Greys of projections are inverted on white; light of channels is added on slices.
    if look.name != "auto" or look.composite in histogram.PROJECTIONS:
        return look.name
    return "channel" if is_ramp(look) else ""


def _checked(look: Look) -> TransferFunction:
    if look.labels is not None or not isinstance(look.transfer_function, TransferFunction):
        kind = "labels" if look.labels is not None else "a transfer function of two dimensions"
        raise ArgumentError(
            f"the look is of {kind}, which has no window, gamma, opacity or exposure of its own; give a colour map "
            "(--cmap, TransferFunction.from_colormap) or another preset"
        )
    return look.transfer_function


def _window_of(function: TransferFunction) -> tuple[float, float]:
    if (window := _native.window_of(function.opacity, function.color)) is None:
        raise ArgumentError(
            f"the look shows what is above {function.color[0][0]:g} and has no window to change; give a colour map "
            "(--cmap, TransferFunction.from_colormap) or another preset"
        )
    return window


def _in_window(function: TransferFunction, low: float, high: float) -> TransferFunction:
    window = _window_of(function)
    nodes = (function.opacity, function.color, function.gradient_opacity)
    (opacity, color), gradients = _native.in_window(*nodes, window, (low, high))
    return TransferFunction(opacity, color, function.opacity_unit, gradients)


def bent(function: TransferFunction, gamma: float) -> TransferFunction:
    """The colours moved: the value at place t gets the colour of place t ** gamma."""
    color = _native.bent(function.color, _window_of(function), gamma)
    return TransferFunction(function.opacity, color, function.opacity_unit, function.gradient_opacity)


def _with_opacity(function: TransferFunction, opacity: Any) -> TransferFunction:
    low, high = _window_of(function)
    nodes = colormaps.opacity_nodes(opacity, (low, high, False, 1.0))
    return TransferFunction(nodes, function.color, function.opacity_unit, function.gradient_opacity)


def exposed(function: TransferFunction, exposure: float, *, is_channel: bool, is_projection: bool) -> TransferFunction:
    """Colours of matter that gives off `exposure` times the light; above 1 it is denser too, but for projections."""
    opacity, color = _native.exposed(function.opacity, function.color, exposure, is_channel, is_projection)
    return TransferFunction(opacity, color, function.opacity_unit, function.gradient_opacity)
