"""Windows of slices: which values are black and which are white, as radiologists and as others say it.

A window has a level, its middle, and a width: black is level - width / 2, white is level + width / 2. DICOM calls that
LINEAR_EXACT (PS3.3, C.11.2.1.3.2); its older LINEAR (C.11.2.1.2) is half a unit lower and one narrower.
Names stand for windows of CT, in Hounsfield units, of `crates/look` (`ct_windows.rs`).
"""

from __future__ import annotations

from collections.abc import Iterable
from difflib import get_close_matches
from math import isfinite
from typing import TYPE_CHECKING

from wavesplat import _native
from wavesplat._looks.curves.value_scale import End, are_percentiles, values_of
from wavesplat._looks.kinds.histogram import robust_range
from wavesplat._looks.presets import added_to_hounsfield, plain
from wavesplat._system.values import numbers
from wavesplat.errors import ArgumentError

if TYPE_CHECKING:
    from wavesplat._model.volume.volume import Volume
    from wavesplat._model.volume.wavelet_volume import WaveletVolume


#: Level and width, Hounsfield units.
CT_WINDOWS: dict[str, tuple[float, float]] = _native.CT_WINDOWS


def limits(
    volume: Volume | WaveletVolume, window: str | Iterable[End] | None, clim: Iterable[End] | None
) -> tuple[float, float]:
    """The values that are black and white, given as numbers or percentiles.

    Without a window they are taken from the file, of a picture, or count as the volume's smallest and largest.
    """
    if window is not None and clim is not None:
        raise ArgumentError("window and clim both say which values are black and white; give one of them")
    if clim is not None:
        return values_of(clim, volume, "clim")
    if are_percentiles(window):
        return values_of(window, volume)  # type: ignore[arg-type]
    if window is not None:
        level, width = _named(window, volume) if isinstance(window, str) else _level_and_width(window)
        return level - width / 2, level + width / 2
    if volume.facts.window is not None:
        return volume.facts.window
    low, high = robust_range(volume)
    # A volume that is the same everywhere is black.
    return (low, high) if low < high else (low, low + 1.0)


def _named(name: str, volume: Volume | WaveletVolume) -> tuple[float, float]:
    found = plain(name)
    if found not in CT_WINDOWS:
        near = get_close_matches(found, CT_WINDOWS, 1, 0.6)
        hint = f"did you mean {near[0]}? " if near else ""
        raise ArgumentError(
            f"unknown window {name!r}; {hint}use one of: {', '.join(CT_WINDOWS)}, or give (level, width)"
        )
    level, width = CT_WINDOWS[found]
    return level + added_to_hounsfield(f"window {found!r}", volume), width


def _level_and_width(window: Iterable[End]) -> tuple[float, float]:
    form = f"(level, width), such as (40, 400), or a name: {', '.join(CT_WINDOWS)}"
    level, width = numbers(window, "window", form, n=2, finite=False)
    if not (isfinite(level) and isfinite(width) and width > 0):
        raise ArgumentError(
            f"window is ({level:g}, {width:g}), level and width; the width must be positive; "
            "the lowest and the highest value are given as clim"
        )
    return level, width
