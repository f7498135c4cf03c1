"""The light of a fluorescence channel on slices, where it rises evenly over the window, as its look has it in space.

The compiled module reads it from the colours of the look (`crates/look`: `channel_light.rs`).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from wavesplat import _native
from wavesplat._looks.curves.transfer_function import TransferFunction
from wavesplat._looks.kinds import histogram
from wavesplat._looks.kinds.channels import is_ramp
from wavesplat._model.volume.facts import Rgb

if TYPE_CHECKING:
    from wavesplat._looks.look import Look


@dataclass(frozen=True)
class ChannelLight:
    """The light of a channel: black up to one value, `color` from another one on, and the curve between."""

    low: float
    high: float
    #: Without the exposure above 1.
    color: Rgb
    #: From black at `low` to the colour at `high`.
    curve: TransferFunction


def light_of(look: Look) -> ChannelLight | None:
    """The light of a channel's look, or of the automatic look of fluorescence; None of other looks."""
    function = look.transfer_function
    if not isinstance(function, TransferFunction):
        return None
    is_projection = look.composite in histogram.PROJECTIONS
    if look.name != "channel" and (look.name != "auto" or is_projection or not is_ramp(look)):
        return None
    low, high, color, curve = _native.channel_light(function.color, is_projection)
    return ChannelLight(low, high, color, TransferFunction([(low, 1.0)], curve))
