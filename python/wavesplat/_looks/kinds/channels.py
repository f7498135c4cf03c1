"""Looks of fluorescence channels: light of their own in one colour, opaque where it is bright, over a window of values.

Nothing is shaded: dyes give light, and have no surfaces. Opacity and colour rise over the window, so that what is below
it is clear, and several channels can be seen through each other. Opacity is that of a voxel (`crates/look`:
`voxels.rs`), so that light belongs to the matter, not to its box.

The window is the file's where somebody chose it and samples lie in it, else percentiles of the samples.

The red, green and blue of a colour picture have one window, all that their type can hold, and their own colours, so
that what they add up to is the colour that is stored. In space they give light in proportion to their values.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from wavesplat import _native
from wavesplat._looks.curves import colors
from wavesplat._looks.curves.transfer_function import TransferFunction
from wavesplat._looks.curves.value_scale import End, values_of
from wavesplat._looks.kinds.channel_colors import color_of
from wavesplat._looks.kinds.histogram import without_padding
from wavesplat._looks.kinds.looked_at import subsampled
from wavesplat._looks.look import Look
from wavesplat._model.volume.facts import Rgb, is_part_of_color
from wavesplat.errors import ArgumentError

if TYPE_CHECKING:
    from wavesplat._model.arguments.sampling import Composite
    from wavesplat._model.volume.grid import Grid
    from wavesplat._model.volume.volume import Volume
    from wavesplat._model.volume.wavelet_volume import WaveletVolume


#: Upper ends of windows that span the values of a type, or of a camera: writers put them where they know no window.
WHOLE_RANGES = {float(2**n - 1) for n in (8, 10, 11, 12, 13, 14, 15, 16, 32)}
#: Largest ratio of the distances of the 90th and 10th percentiles to the median where nearly all is noise (noise: 1;
#: spots in it: 1.4; nuclei 1.75 to 2.2; cells 3.2), and deviations above the median up to which noise is clear.
MOSTLY_NOISE, NOISE = 1.6, 4.0
#: Part of a file's window that is nearly clear, least share of the samples beyond it, and largest share beyond the end.
DARK_PART, MIN_SHARE, MAX_SHARE = 0.3, 3e-4, 0.3
#: Largest difference of colours that are equal but for rounding.
ROUNDING = 1e-6


def channel_look(
    volume: Volume | WaveletVolume,
    color: str | Iterable[float] | None,
    window: Iterable[End] | None,
    composite: Composite = "over",
) -> Look:
    """See `Look.channel`."""
    if color is None:
        own = color_of(volume.facts.channel, volume.facts.channels)
        rgb, color_name = own or _native.CHANNEL_COLORS[0], "green" if own is None else "its colour"
    else:
        rgb, color_name = _rgb(color), "its colour"
    if window is not None:
        low, high = values_of(window, volume)
        window_note = ""
    else:
        low, high, window_note = channel_window(volume)
    reason = f"a channel in {color_name}, from {low:g} to {high:g}{window_note}"
    channel = volume.facts.channel
    is_part = is_part_of_color(volume.facts) and channel is not None and rgb == channel.color
    shown = rgb if is_part else _native.lightened(rgb)
    if composite not in ("over", "first-hit"):
        # A projection colours one value per ray: dark where it is low, so that other channels keep their light there.
        function = TransferFunction([(low, 1.0)], [(low, 0.0, 0.0, 0.0), (high, *shown)])
    elif is_part:
        function = TransferFunction(*_native.ramp_of_part(rgb, low, high, opaque_after(volume)))
    else:
        function = ramp(shown, low, high, opaque_after(volume))
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


def channel_window(volume: Volume | WaveletVolume) -> tuple[float, float, str]:
    """Values that are clear and that have the full light, and the source of them, in words that follow the window."""
    if is_part_of_color(volume.facts):
        return 0.0, _highest(volume), ", all that its colours can hold"
    values = without_padding(subsampled(volume))
    low, high = window_of_values(values)
    channel = volume.facts.channel
    if channel is None or channel.window is None or is_full_range_window(channel.window, volume):
        return low, high, ", by the values"
    first, last = channel.window
    if problem := _problem_of(channel.window, values):
        return low, high, f", by the values, since of the file's window, {first:g} to {last:g}, {problem}"
    return first, last, ", as the file says"


def _highest(volume: Volume | WaveletVolume) -> float:
    """The value of a full red, green or blue: the file's, else the largest of the type, or of fractions 1."""
    window = volume.facts.channel.window if volume.facts.channel else None
    if window is not None:
        return window[1]
    dtype = getattr(volume, "dtype", None)
    if dtype is not None and dtype.kind in "iu":
        return float(np.iinfo(dtype).max)
    highest = volume.value_range[1]
    return next((end for end in (1.0, 255.0, 65535.0) if highest <= end * (1 + ROUNDING)), highest)


def _problem_of(window: tuple[float, float], values: NDArray[np.float64]) -> str | None:
    """Why a file's window cannot show samples; None where it can."""
    low, high = window
    if np.mean(values > low + DARK_PART * (high - low)) < MIN_SHARE:
        return f"only the lowest {100 * DARK_PART:g} % is used"
    if np.mean(values >= high) > MAX_SHARE:
        return f"more than {100 * MAX_SHARE:g} % of the samples are beyond the end"
    return None


def window_of_values(values: NDArray[Any]) -> tuple[float, float]:
    """A window from just above the background (median plus deviation) to the value that few samples exceed."""
    background, *highest = (float(v) for v in np.percentile(values, (50.0, 99.7, 99.9, 99.97)))
    spread = 1.4826 * float(np.median(np.abs(values - background)))
    # Spots may be too small for the first percentile, and in a dense channel it may be close to the background.
    far = (
        one for one, n in zip(highest, (4, 6, 0), strict=True) if one > background and one >= background + n * spread
    )
    high = next(far, highest[-1])
    low = min(background + spread, background + 0.25 * (high - background))
    return low, high if high > low else low + max(1e-6 * abs(low), 1e-6)


def clear_of_values(values: NDArray[Any]) -> float:
    """The value up to which a channel is clear in space: the low end of its window, and noise that is nearly all of it.

    Noise that reaches over the end is a haze, which a few bright things stand in.
    """
    low, high = window_of_values(values)
    lower, middle, upper = (float(v) for v in np.percentile(values, (10.0, 50.0, 90.0)))
    if upper - middle > MOSTLY_NOISE * (middle - lower):
        return low
    deviation = 1.4826 * float(np.median(np.abs(values - middle)))
    return max(low, min(middle + NOISE * deviation, 0.5 * (middle + high)))


def opaque_after(grid: Grid) -> float:
    """Number of voxels of the largest values that are opaque together: three, or as many as a thinner box has."""
    n_z, n_y, n_x = grid.shape
    return _native.opaque_after((n_x, n_y, n_z), grid.spacing)


def ramp(
    color: Rgb, low: float, high: float, n_voxels: float, *, clear: float | None = None, white: float | None = None
) -> TransferFunction:
    """A ramp of light in one colour: brightness rises with the value, opacity with its square.

    n_voxels : voxels of the highest values that are opaque together. clear : value up to which nothing shows; `low` if
    None. white : share of white in the colour of the highest values; None is the usual one.
    """
    return TransferFunction(*_native.channel_ramp(color, low, high, n_voxels, clear, white))


def is_ramp(look: Look) -> bool:
    """Whether a look has the colours of a `ramp`, as automatic looks of fluorescence have, and no light."""
    function = look.transfer_function
    if look.shading is not None or look.labels is not None or not isinstance(function, TransferFunction):
        return False
    nodes = np.array(function.color)
    if len(nodes) != 3 or not nodes[0, 0] < nodes[-1, 0] or not nodes[1, 1:].max() > 0:
        return False
    return bool(np.allclose(nodes[0, 1:], _native.DARKEST * nodes[1, 1:], rtol=0, atol=ROUNDING))


def _rgb(color: str | Iterable[float]) -> Rgb:
    parsed = colors.parse(color)
    if parsed is None:
        raise ArgumentError('color is "transparent"; a channel needs a colour, such as "green"')
    return parsed[0], parsed[1], parsed[2]
