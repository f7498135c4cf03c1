"""Scales of the values of curves and windows: samples, percentiles, or places in a volume's own range.

A preset for data without fixed units cannot name samples, so its nodes are places on one of these scales:

- `samples`: the values themselves; `hounsfield`: the same, and they must be Hounsfield units.
- `fraction`: 0 and 1 are the values that count as smallest and largest, the 0.1 and 99.9 percentiles.
- `object`: 0 is the threshold that parts the object from its background, 1 the value that a two-hundredth of the
  object exceeds.
- `signed`: -1 and 1 are as far from 0 as the largest thousandth of the magnitudes.
- `log`: as `fraction`, evenly in the logarithm, over the positive values.
- `maximum`: 0 and 1 are black and white of a maximum projection (`histogram.auto`).
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from math import isfinite
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np

from wavesplat import _native
from wavesplat._system.values import described
from wavesplat.errors import ArgumentError

if TYPE_CHECKING:
    from wavesplat._model.volume.volume import Volume
    from wavesplat._model.volume.wavelet_volume import WaveletVolume

# Ends of windows: sample values, or percentiles of a volume's samples, written "1%".
#
# A percentile is a value that this share of the finite samples does not exceed. Where a volume has millions of samples,
# some millions of them are taken, spread evenly.

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
    from wavesplat._looks.kinds.histogram import finite_samples

    samples = finite_samples(volume)
    if not samples.size:
        raise ArgumentError(f"volume {volume.name!r} has no finite sample, so there is no percentile {end!r}")
    return float(np.percentile(samples, percent))


# Scales of the values of curves in files: samples, or places in a volume's own range of values.

Nodes: TypeAlias = list[tuple[float, ...]]

#: All scales, and those that need no volume.
NAMES = tuple(name for name, _ in _native.SCALES)
ABSOLUTE = tuple(name for name, is_absolute in _native.SCALES if is_absolute)
#: Percentile of the magnitudes that counts as the largest, and percentile of the object that counts as its largest.
LARGEST_MAGNITUDE, LARGEST_OF_OBJECT = 99.9, 99.5
#: Percentiles of the positive values that count as smallest and largest, as in `crates/look` (`histogram.rs`).
ROBUST = (0.1, 99.9)


def _fraction(volume: Volume | WaveletVolume) -> tuple[float, float]:
    from wavesplat._looks.kinds.histogram import robust_range

    return robust_range(volume)


def _object(volume: Volume | WaveletVolume) -> tuple[float, float]:
    from wavesplat._looks.kinds.histogram import finite_samples, otsu, robust_range

    low, high = robust_range(volume)
    if not low < high:
        return low, high
    values = finite_samples(volume)
    threshold = otsu(values, low, high)
    inside = values[values > threshold]
    return threshold, float(np.percentile(inside, LARGEST_OF_OBJECT)) if inside.size else high


def _signed(volume: Volume | WaveletVolume) -> tuple[float, float]:
    from wavesplat._looks.kinds.histogram import finite_samples

    return 0.0, float(np.percentile(np.abs(finite_samples(volume)), LARGEST_MAGNITUDE))


def _maximum(volume: Volume | WaveletVolume) -> tuple[float, float]:
    from wavesplat._looks.kinds.histogram import projected

    greys = projected(volume, "maximum").color
    return greys[0][0], greys[-1][0]


def positive_range(volume: Volume | WaveletVolume) -> tuple[float, float]:
    """Values that count as smallest and largest of those that have a logarithm.

    Raises
    ------
    ArgumentError
        If no sample is positive.
    """
    from wavesplat._looks.kinds.histogram import finite_samples

    values = finite_samples(volume)
    values = values[values > 0]
    if not values.size:
        raise ArgumentError(f"volume {volume.name!r}: no sample is positive, so none has a logarithm")
    low, high = np.percentile(values, ROBUST)
    return float(low), float(high)


ENDS: dict[str, Callable[[Any], tuple[float, float]]] = {
    "fraction": _fraction,
    "object": _object,
    "signed": _signed,
    "maximum": _maximum,
    "log": positive_range,
}


def nodes_on(scale: str, nodes: Iterable[Sequence[float]], volume: Volume | WaveletVolume) -> Nodes:
    """Nodes whose first number is a place on a scale, with the sample value instead."""
    if scale in ABSOLUTE:
        return [tuple(node) for node in nodes]
    return _placed(scale, nodes, volume, widths=False)


def widths_on(scale: str, nodes: Iterable[Sequence[float]], volume: Volume | WaveletVolume) -> Nodes:
    """Nodes whose first number is a difference on a scale, such as a gradient, with the difference of sample values."""
    if scale in ABSOLUTE:
        return [tuple(node) for node in nodes]
    return _placed(scale, nodes, volume, widths=True)


def _placed(scale: str, nodes: Iterable[Sequence[float]], volume: Volume | WaveletVolume, *, widths: bool) -> Nodes:
    placed = _native.scale_nodes(scale, list(nodes), *ends(scale, volume), widths)
    return [tuple(node) for node in placed or ()]


def ends(scale: str, volume: Volume | WaveletVolume) -> tuple[float, float]:
    """The values at places 0 and 1 of a scale."""
    low, high = ENDS[scale](volume)
    # A volume that is the same everywhere has no range; any will do.
    return (low, high) if low < high else (low, low + (abs(low) or 1.0))
