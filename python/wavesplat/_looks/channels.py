"""Looks of fluorescence channels: light of their own in one colour, opaque where it is bright, over a window of values.

Nothing is shaded: dyes give light, and have no surfaces. Opacity and colour rise over the window, so that what is below
it is clear, and several channels can be seen through each other.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from wavesplat._looks import colors
from wavesplat._looks.histogram import finite_samples
from wavesplat._looks.look import Look
from wavesplat._looks.transfer_function import TransferFunction
from wavesplat._model.argument_types import described
from wavesplat.errors import ArgumentError

if TYPE_CHECKING:
    from wavesplat._model.options import Composite
    from wavesplat._model.volume import Volume
    from wavesplat._model.wavelet_volume import WaveletVolume

__all__ = [
    "CHANNEL_COLORS",
    "Rgb",
    "channel_look",
    "checked_window",
    "is_full_range_window",
    "light_of",
    "ramp",
    "window_of_values",
]

Rgb = tuple[float, float, float]

#: Conventional colours of channels whose file has none: green, magenta, cyan, yellow, red, blue, white, orange.
CHANNEL_COLORS: tuple[Rgb, ...] = (
    (0.0, 1.0, 0.0),
    (1.0, 0.0, 1.0),
    (0.0, 1.0, 1.0),
    (1.0, 1.0, 0.0),
    (1.0, 0.0, 0.0),
    (0.0, 0.0, 1.0),
    (1.0, 1.0, 1.0),
    (1.0, 0.65, 0.0),
)
#: Upper ends of windows that span the values of a type, or of a camera: writers put them where they know no window.
WHOLE_RANGES = {float(2**n - 1) for n in (8, 10, 11, 12, 13, 14, 15, 16, 32)}
#: Least luminance (Rec. 709) of a colour at the end of the window; a pure blue has 0.07 and is lost on black.
MIN_LUMINANCE = 0.2
LUMINANCE = (0.2126, 0.7152, 0.0722)


def channel_look(
    volume: Volume | WaveletVolume,
    color: str | Iterable[float] | None,
    window: Iterable[float] | None,
    composite: Composite = "over",
) -> Look:
    """See `Look.channel`."""
    channel = volume.facts.channel
    if color is None:
        rgb = (channel.color if channel is not None else None) or CHANNEL_COLORS[0]
        said = "its colour" if channel is not None and channel.color is not None else "green"
    else:
        rgb, said = _rgb(color), "its colour"
    if window is not None:
        low, high = checked_window(window)
        reason = f"a channel in {said}, from {low:g} to {high:g}"
    elif channel is not None and channel.window is not None and not is_full_range_window(channel.window, volume):
        low, high = channel.window
        reason = f"a channel in {said}, from {low:g} to {high:g}, as the file says"
    else:
        low, high = window_of_values(finite_samples(volume))
        reason = f"a channel in {said}, from {low:g} to {high:g}, by the values"
    if composite in ("over", "first-hit"):
        function = ramp(rgb, low, high, sum(volume.shape) / 3.0)
    else:
        # A projection colours one value per ray: dark where it is low, so that other channels keep their light there.
        function = TransferFunction([(low, 1.0)], [(low, 0.0, 0.0, 0.0), (high, *_lightened(rgb))])
    return Look(
        transfer_function=function,
        shading=None,
        composite=composite,
        background="black",
        name="channel",
        reason=reason,
    )


def is_full_range_window(window: tuple[float, float], volume: Volume | WaveletVolume) -> bool:
    """Whether a file's window spans all possible values, so that nobody chose it."""
    low, high = window
    return low == 0 and high in WHOLE_RANGES and not volume.value_range[1] > high


def window_of_values(values: NDArray[Any]) -> tuple[float, float]:
    """A window from just above the background (median plus deviation) to the value that few samples exceed."""
    background, high = (float(v) for v in np.percentile(values, (50.0, 99.7)))
    spread = 1.4826 * float(np.median(np.abs(values - background)))
    if high < background + 4.0 * spread or high <= background:
        # Spots too small for that percentile, or a dense channel, in which the higher percentile is close to it.
        high = max(high, float(np.percentile(values, 99.97)))
    low = min(background + spread, background + 0.25 * (high - background))
    return low, high if high > low else low + max(1e-6 * abs(low), 1e-6)


def ramp(color: Rgb, low: float, high: float, n_voxels: float) -> TransferFunction:
    """A ramp of light in one colour. `n_voxels`: number of voxels that a ray goes through, about."""
    middle = low + 0.35 * (high - low)
    light = _lightened(color)
    dark = tuple(0.6 * share for share in light)
    bright = tuple(share + 0.35 * (1.0 - share) for share in light)
    opacity = [(low, 0.0), (middle, _per_voxel(0.6, 2.5 * n_voxels)), (high, _per_voxel(0.995, 2.0 * n_voxels))]
    return TransferFunction(opacity, [(low, *dark), (middle, *light), (high, *bright)])


def light_of(look: Look) -> tuple[float, float, Rgb]:
    """The window of a channel's look, and its colour: the one that a projection has at the end of the window."""
    nodes: Any = look.transfer_function.color  # type: ignore[union-attr]
    low, high = nodes[0][0], nodes[-1][0]
    # In space the colour is whiter beyond the middle.
    red, green, blue = nodes[-1 if len(nodes) == 2 else 1][1:4]
    return low, high, (red, green, blue)


def _lightened(color: Rgb) -> Rgb:
    """The colour mixed with just enough white to be seen on black."""
    luminance = sum(share * weight for share, weight in zip(color, LUMINANCE, strict=True))
    white = max(0.0, (MIN_LUMINANCE - luminance) / (1.0 - luminance)) if luminance < 1.0 else 0.0
    red, green, blue = (share + white * (1.0 - share) for share in color)
    return red, green, blue


def _per_voxel(opacity: float, n_voxels: float) -> float:
    """Opacity of a voxel with which a tenth of `n_voxels` together have `opacity`."""
    return 1.0 - math.pow(1.0 - min(opacity, 0.9999), 10.0 / max(n_voxels, 10.0))


def _rgb(color: str | Iterable[float]) -> Rgb:
    parsed = colors.parse(color)
    if parsed is None:
        raise ArgumentError('color is "transparent"; a channel needs a colour, such as "green"')
    return parsed[0], parsed[1], parsed[2]


def checked_window(window: Iterable[float]) -> tuple[float, float]:
    """Two growing numbers, or an `ArgumentError`."""
    try:
        low, high = (float(end) for end in window)
    except (TypeError, ValueError, OverflowError):
        low, high = 0.0, 0.0
    if not (math.isfinite(low) and math.isfinite(high) and low < high):
        raise ArgumentError(f"window is {described(window)}; give two numbers, the smaller one first")
    return low, high
