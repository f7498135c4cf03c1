"""The light of a fluorescence channel on slices, where it rises evenly over the window, as its look has it in space.

In space a channel's colours are a ramp (`crates/look`: `channel_ramp.rs`): dark, full, whiter beyond. Gamma moves the
nodes of that ramp, exposure multiplies their colours (`_looks/changed.py`). Both are read from the nodes, so that a
look that was changed, saved or edited has one set of colours. Up to the full colour c a ramp of exposure E has at place
t, 0..1, the colour

    c E (d + (1 - d) t / f),    d = DARKEST, f = FULL_COLOR,

so that the first node gives E, and any node that is not clipped at 1 gives the t whose colour is at its value.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import log
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from wavesplat import _native
from wavesplat._looks.changed import bent, exposed
from wavesplat._looks.curves.transfer_function import TransferFunction
from wavesplat._looks.kinds import histogram
from wavesplat._looks.kinds.channels import ROUNDING, is_ramp
from wavesplat._model.volume.facts import Rgb

if TYPE_CHECKING:
    from wavesplat._looks.look import Look

#: Share of a colour at the low end of a ramp, and the place of the full colour.
DARKEST, FULL_COLOR = _native.DARKEST, _native.FULL_COLOR
#: Digits of places that count: white has its full colour at many nodes, and the first one is meant.
N_DIGITS = 9
#: Least cosine of the first colour and the brightest one, into which white is mixed.
SAME_HUE = 0.9


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
    nodes = np.array(function.color)
    low, high = float(nodes[0, 0]), float(nodes[-1, 0])
    if is_projection or not _is_ramp(nodes):
        color = _rgb(nodes[nodes[:, 1:].max(axis=1).argmax(), 1:])
        whole = function.color if is_projection else [(low, 0.0, 0.0, 0.0), (high, *color)]
        return ChannelLight(low, high, color, _opaque(whole))
    exposure = max(1.0, nodes[0, 1:].max() / DARKEST)
    color = _rgb(nodes[0, 1:] / DARKEST / exposure)
    curve = _opaque([(low, 0.0, 0.0, 0.0), (high, *color)])
    if (gamma := _gamma_of(nodes)) != 1:
        curve = bent(curve, gamma)
    if exposure > 1 + ROUNDING:
        curve = exposed(curve, exposure, is_channel=True, is_projection=True)
    return ChannelLight(low, high, color, curve)


def _rgb(color: NDArray[np.float64]) -> Rgb:
    red, green, blue = (float(share) for share in np.clip(color, 0.0, 1.0))
    return red, green, blue


def _opaque(color: Sequence[tuple[float, float, float, float]]) -> TransferFunction:
    return TransferFunction([(color[0][0], 1.0)], color)


def _is_ramp(nodes: NDArray[np.float64]) -> bool:
    """Whether colours rise from a dark one in one hue, as those of a ramp do after any change."""
    dark, most = nodes[0, 1:], nodes[nodes[:, 1:].max(axis=1).argmax(), 1:]
    lengths = float(np.linalg.norm(dark) * np.linalg.norm(most))
    return bool(nodes[0, 0] < nodes[-1, 0] and lengths > 0 and float(dark @ most) >= SAME_HUE * lengths)


def _gamma_of(nodes: NDArray[np.float64]) -> float:
    """The gamma of a ramp: by the last node up to the full colour that is not clipped."""
    first, brightest = nodes[0, 1:].max(), nodes[1:, 1:].max(axis=1)
    is_whole = (brightest < 1 - ROUNDING) | (first <= DARKEST + ROUNDING)
    # Beyond the full colour white is mixed in.
    wanted = np.round(FULL_COLOR * (brightest / first - 1) * DARKEST / (1 - DARKEST), N_DIGITS)
    wanted = np.where(is_whole & (wanted <= FULL_COLOR + ROUNDING), wanted, 0.0)
    place = (nodes[1:, 0] - nodes[0, 0]) / (nodes[-1, 0] - nodes[0, 0])
    last = int(wanted.argmax())
    if not (0 < wanted[last] < 1 and 0 < place[last] < 1):
        return 1.0
    gamma = log(wanted[last]) / log(place[last])
    return 1.0 if abs(gamma - 1) < ROUNDING else gamma
