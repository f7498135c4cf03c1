"""The usual colour of a microscope's channel: from the file, else by its emission wavelength or its dye.

`crates/look` decides: `channel_colors.rs`.
"""

from __future__ import annotations

from collections.abc import Sequence

from wavesplat import _native
from wavesplat._model.volume.facts import Channel, Rgb


def color_of(channel: Channel | None, channels: Sequence[Channel]) -> Rgb | None:
    """The colour of a channel among all of its file: the file's, else the usual one of its light; None without either.

    White beside other colours was chosen by somebody, and so was the white of a single channel.
    """
    if channel is None:
        return None
    return _native.channel_color(named(channel), [named(one) for one in channels])


def usual_color(channel: Channel) -> Rgb | None:
    """The colour of a channel's light, by its wavelength, else by the name of its dye, or of a colour; else None."""
    return _native.channel_color((channel.name, None, channel.emission_nm), [])


def named(channel: Channel) -> tuple[str, Rgb | None, float | None]:
    """The name of a channel, its colour and its wavelength, as the compiled module takes them."""
    return channel.name, channel.color, channel.emission_nm
