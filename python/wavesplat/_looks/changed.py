"""Changes of a look that keep its colours, light and operator: window, gamma, opacity, exposure.

Place t of a value is (value - low) / (high - low) in the look's window, which spans the nodes of its curves. A window
moves the nodes to the same places in another one; gamma gives a value of place t the colour that the look has at
t ** gamma. Opacities stay, so that gamma shows nothing that was clear before.

Exposure is a factor of light. Of a look with shading it is the light's (`Shading.exposure`). Without shading matter
gives off light, and colours get the factor; what is beyond 1 makes them whiter, so that their hue stays. Above 1
extinction gets it too, since a full colour has no room left; of a channel, which is seen among others, only as far as
the colour has none, so that the mixture of channels stays. A projection has no extinction.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

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


#: Parts of a segment between two nodes where curves become bent.
N_PARTS = 8
#: Share of white in a channel's colour where exposure takes it beyond 1: with all of it hues of mixtures turned by 9
#: degrees, with half by 5.
CHANNEL_WHITE = 0.5
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
    values = [node[0] for nodes in (function.opacity, function.color) for node in nodes]
    low, high = min(values), max(values)
    if not low < high:
        raise ArgumentError(
            f"the look shows what is above {low:g} and has no window to change; give a colour map (--cmap, "
            "TransferFunction.from_colormap) or another preset"
        )
    return low, high


def _in_window(function: TransferFunction, low: float, high: float) -> TransferFunction:
    first, last = _window_of(function)
    scale = (high - low) / (last - first)
    opacity, color = (
        [(low + scale * (value - first), *rest) for value, *rest in nodes]
        for nodes in (function.opacity, function.color)
    )
    gradients = [(magnitude * scale, factor) for magnitude, factor in function.gradient_opacity]
    return TransferFunction(opacity, color, function.opacity_unit, gradients)


def bent(function: TransferFunction, gamma: float) -> TransferFunction:
    """The colours moved: the value at place t gets the colour of place t ** gamma."""
    low, high = _window_of(function)
    color = _divided(function.color, N_PARTS)
    color[:, 0] = low + (high - low) * np.clip((color[:, 0] - low) / (high - low), 0, 1) ** (1 / gamma)
    return TransferFunction(function.opacity, color.tolist(), function.opacity_unit, function.gradient_opacity)


def _with_opacity(function: TransferFunction, opacity: Any) -> TransferFunction:
    low, high = _window_of(function)
    nodes = colormaps.opacity_nodes(opacity, (low, high, False, 1.0))
    return TransferFunction(nodes, function.color, function.opacity_unit, function.gradient_opacity)


def exposed(function: TransferFunction, exposure: float, *, is_channel: bool, is_projection: bool) -> TransferFunction:
    """Colours of matter that gives off `exposure` times the light; above 1 it is denser too, but for projections."""
    color, opacity = _divided(function.color, N_PARTS), np.array(function.opacity)
    if exposure > 1 and not is_projection:
        opacity = _divided(function.opacity, N_PARTS)
        at_nodes = np.stack([np.interp(opacity[:, 0], color[:, 0], part) for part in color[:, 1:].T], axis=1)
        denser = np.maximum(exposure * at_nodes.max(axis=1), 1.0) if is_channel else exposure
        with np.errstate(divide="ignore"):
            opacity[:, 1] = -np.expm1(denser * np.log1p(-opacity[:, 1]))
    color[:, 1:] = _brighter(color[:, 1:], exposure, CHANNEL_WHITE if is_channel else 1.0)
    return TransferFunction(opacity.tolist(), color.tolist(), function.opacity_unit, function.gradient_opacity)


def _brighter(colors: NDArray[np.float64], exposure: float, white: float) -> NDArray[np.float64]:
    """Colours, shape (n, 3), times the exposure; the share `white` of what is beyond 1 is white, in the same hue."""
    bright = colors * exposure
    most = np.maximum(bright.max(axis=1, keepdims=True), 1.0)
    mixed = white * (1.0 - 1.0 / most)
    return np.asarray(np.clip((1.0 - mixed) * bright / most + mixed, 0.0, 1.0))


def _divided(nodes: Iterable[tuple[float, ...]], n_parts: int) -> NDArray[np.float64]:
    """Nodes, with others between them so that each segment has `n_parts`; steps stay steps."""
    table = np.array(list(nodes), dtype=np.float64)
    parts = np.arange(n_parts)[None, :, None] / n_parts
    between = table[:-1, None] + parts * (table[1:] - table[:-1])[:, None]
    is_step = table[1:, 0] == table[:-1, 0]
    kept = [segment[:1] if step else segment for segment, step in zip(between, is_step, strict=True)]
    return np.concatenate([*kept, table[-1:]])
