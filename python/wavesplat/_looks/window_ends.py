"""Ends of windows: sample values, or percentiles of a volume's samples, written "1%".

A percentile is a value that this share of the finite samples does not exceed. Where a volume has millions of samples,
some millions of them are taken, spread evenly.
"""

from __future__ import annotations

from collections.abc import Iterable
from math import isfinite
from typing import TYPE_CHECKING, TypeAlias

import numpy as np

from wavesplat._model.argument_types import described
from wavesplat.errors import ArgumentError

if TYPE_CHECKING:
    from wavesplat._model.volume import Volume
    from wavesplat._model.wavelet_volume import WaveletVolume

#: A sample value, or a percentile such as "99.8%".
End: TypeAlias = float | str


def are_percentiles(ends: object) -> bool:
    """Whether an end of a window is a text, such as "1%"."""
    return isinstance(ends, tuple | list) and any(isinstance(end, str) for end in ends)


def values_of(ends: Iterable[End], volume: Volume | WaveletVolume | None, what: str = "window") -> tuple[float, float]:
    """The two growing values that the ends of a window stand for.

    volume : whose samples percentiles are of. what : name of the argument, for messages.

    Raises
    ------
    ArgumentError
        If these are not two growing numbers or percentiles of samples that are there.
    """
    try:
        low, high = (_value(end, volume) for end in ends)
    except ArgumentError:
        raise  # which is a ValueError too
    except (TypeError, ValueError, OverflowError):
        raise ArgumentError(
            f'{what} is {described(ends)}; give (low, high), two numbers or percentiles such as "1%"'
        ) from None
    if isfinite(low) and isfinite(high) and low < high:
        return low, high
    if are_percentiles(ends):
        found = f"the values {low:g} and {high:g}"
        raise ArgumentError(f"{what} is {described(ends)}, {found}, which do not grow; give percentiles farther apart")
    hint = f"; did you mean ({high:g}, {low:g})?" if high < low else ""
    raise ArgumentError(f"{what} is ({low:g}, {high:g}); low must be less than high{hint}")


def _value(end: End, volume: Volume | WaveletVolume | None) -> float:
    if not isinstance(end, str):
        return float(end)
    if not end.strip().endswith("%"):
        raise ValueError
    percent = float(end.strip().removesuffix("%"))
    if not 0 <= percent <= 100:
        raise ArgumentError(f"{end!r} is no percentile; give 0% to 100%")
    if volume is None:
        raise ArgumentError(f"{end!r} is a percentile of a volume's samples; pass the volume too")
    from wavesplat._looks.histogram import finite_samples

    samples = finite_samples(volume)
    if not samples.size:
        raise ArgumentError(f"volume {volume.name!r} has no finite sample, so there is no percentile {end!r}")
    return float(np.percentile(samples, percent))
