"""Looks of fluorescence channels: light of their own in one colour, opaque where it is bright, over a window of values.

Nothing is shaded: dyes give light, and have no surfaces. Opacity and colour rise over the window, so that what is below
it is clear, and several channels can be seen through each other. Opacity is that of a voxel (`crates/look`:
`voxels.rs`), so that light belongs to the matter, not to its box.

The window is the file's where somebody chose it and samples lie in it, else percentiles of the samples (`crates/look`:
`channel_windows.rs`).

The red, green and blue of a colour picture have one window, all that their type can hold, and their own colours, so
that what they add up to is the colour that is stored. In space they give light in proportion to their values.
"""

from __future__ import annotations

from collections.abc import Iterable
from functools import partial
from typing import TYPE_CHECKING, TypeAlias

import numpy as np

from wavesplat import _native
from wavesplat._looks.curves import colors
from wavesplat._looks.curves.transfer_function import TransferFunction
from wavesplat._looks.curves.value_scale import End, values_of
from wavesplat._looks.kinds.channel_colors import color_of, named
from wavesplat._looks.kinds.looked_at import subsampled_as_float64
from wavesplat._looks.look import Look
from wavesplat._model.volume.facts import Rgb, is_part_of_color
from wavesplat.errors import ArgumentError

if TYPE_CHECKING:
    from wavesplat._model.arguments.sampling import Composite
    from wavesplat._model.volume.grid import Grid
    from wavesplat._model.volume.volume import Volume
    from wavesplat._model.volume.wavelet_volume import WaveletVolume


#: A channel with its colour and wavelength, all of its file, the file's window, whether samples are the red, green or
#: blue of a colour picture, and the largest whole number of their type.
Named: TypeAlias = tuple[str, Rgb | None, float | None]
ChannelFacts: TypeAlias = tuple[Named | None, list[Named], tuple[float, float] | None, bool, float | None]

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
        function = TransferFunction(*_native.channel_ramp(shown, low, high, opaque_after(volume)))
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
    return _native.is_whole_range(window, volume.value_range[1])


def channel_window(volume: Volume | WaveletVolume) -> tuple[float, float, str]:
    """Values that are clear and that have the full light, and the source of them, in words that follow the window."""
    samples = partial(subsampled_as_float64, volume)
    return _native.channel_window(facts_of_channel(volume), volume.value_range[1], samples)


def facts_of_channel(volume: Volume | WaveletVolume) -> ChannelFacts:
    """The channel of a volume as the compiled module takes it."""
    facts, dtype = volume.facts, getattr(volume, "dtype", None)
    largest = float(np.iinfo(dtype).max) if dtype is not None and dtype.kind in "iu" else None
    own, window = (None, None) if facts.channel is None else (named(facts.channel), facts.channel.window)
    return own, [named(one) for one in facts.channels], window, is_part_of_color(facts), largest


def opaque_after(grid: Grid) -> float:
    """Number of voxels of the largest values that are opaque together: three, or as many as a thinner box has."""
    n_z, n_y, n_x = grid.shape
    return _native.opaque_after((n_x, n_y, n_z), grid.spacing)


def is_ramp(look: Look) -> bool:
    """Whether a look has the colours of a ramp of light, as automatic looks of fluorescence have, and no light."""
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
