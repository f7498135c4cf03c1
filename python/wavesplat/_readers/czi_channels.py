"""Colours and wavelengths of channels in the metadata of Zeiss' CZI, an XML tree.

`DisplaySetting` has what the microscopist saw: `<Channel Id="Channel:0" Name="DAPI"><Color>#FF00A1FF</Color>`, alpha
first. `Image` has what was measured: `<EmissionWavelength>465</EmissionWavelength>`, nanometres, and a colour too.
"""

from __future__ import annotations

import re
from typing import Any, NamedTuple

from wavesplat._model.facts import Rgb


class CziChannel(NamedTuple):
    """The colour of a channel, and the wavelength of its light, nanometres, by the texts of the file."""

    color: Rgb | None = None
    emission_nm: str | None = None


def czi_channels(metadata: Any, count: int) -> list[CziChannel]:
    """Colour and wavelength of each channel in CZI metadata; None for both if the channels cannot be matched."""
    if not hasattr(metadata, "iterfind"):
        return [CziChannel()] * count
    measured = list(metadata.iterfind(".//Information/Image/Dimensions/Channels/Channel"))
    displayed = list(metadata.iterfind(".//DisplaySetting/Channels/Channel"))
    if len(measured) != count:
        return [CziChannel()] * count
    return [_channel(one, _same(one, number, displayed, count)) for number, one in enumerate(measured)]


def _same(channel: Any, number: int, displayed: list[Any], count: int) -> Any:
    """The channel of `DisplaySetting` that has the same identity or name, else the same place; None without one."""
    for key in ("Id", "Name"):
        found = [one for one in displayed if one.get(key) is not None and one.get(key) == channel.get(key)]
        if len(found) == 1:
            return found[0]
    return displayed[number] if len(displayed) == count else None


def _channel(measured: Any, displayed: Any) -> CziChannel:
    shown = None if displayed is None else _color(displayed.findtext("Color"))
    wavelength = measured.findtext("EmissionWavelength")
    if wavelength is None and displayed is not None:
        wavelength = displayed.findtext("DyeMaxEmission")
    return CziChannel(shown or _color(measured.findtext("Color")), wavelength)


def _color(text: str | None) -> Rgb | None:
    """A colour #AARRGGBB or #RRGGBB; None for anything else."""
    match = re.fullmatch(r"#(?:[0-9a-fA-F]{2})?([0-9a-fA-F]{6})", (text or "").strip())
    if match is None:
        return None
    red, green, blue = (int(match[1][i : i + 2], 16) / 255 for i in (0, 2, 4))
    return red, green, blue
