"""Facts of an OME-Zarr image, by its metadata: units of axes, channels, times, levels."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wavesplat._model import units
from wavesplat._model.facts import Channel, Facts
from wavesplat._readers.request import window_of

#: OME-Zarr's names of the units of time -> ours.
TIME_UNITS = {"second": "s", "millisecond": "ms", "microsecond": "us", "nanosecond": "ns", "minute": "min", "hour": "h"}


@dataclass(frozen=True)
class Axes:
    """Names of an array's axes, in order, and their units as the file has them."""

    names: tuple[str, ...]
    units: tuple[str | None, ...]

    @classmethod
    def of(cls, multiscales: dict[str, Any]) -> Axes:
        """The axes of an image; before OME-Zarr 0.3 they are not named."""
        axes = multiscales.get("axes")
        if axes is None and multiscales.get("coordinateSystems"):
            axes = multiscales["coordinateSystems"][0]["axes"]
        if axes is None:
            return cls(("t", "c", "z", "y", "x"), (None,) * 5)
        named = [{"name": axis} if isinstance(axis, str) else axis for axis in axes]
        return cls(
            tuple(str(axis["name"]) for axis in named),
            tuple(None if axis.get("unit") is None else str(axis["unit"]) for axis in named),
        )

    def unit_of(self, name: str) -> str | None:
        """The unit of an axis."""
        return self.units[self.names.index(name)] if name in self.names else None

    def in_one_unit(self) -> tuple[str | None, NDArray[np.float64]]:
        """One unit for x, y and z, and the factors that bring the world's axes to it."""
        x, y, z = (units.canonical(self.unit_of(name)) for name in "xyz")
        unit, factors = units.in_one_unit((x, y, z))
        return unit, np.array(factors)

    def guesses(self) -> list[str]:
        """Guesses for axes without a unit, or with one that is unknown, beside those that have one."""
        unit, _ = self.in_one_unit()
        x, y, z = (units.canonical(self.unit_of(name)) for name in "xyz")
        bare = [name for name, own in zip("xyz", (x, y, z), strict=True) if own is None and name in self.names]
        none = f"distances along {', '.join(bare)} in {unit}: the file names no unit for them"
        return [*([none] if unit and bare else []), *units.guesses_of((x, y, z))]


def channels_of(attributes: dict[str, Any]) -> tuple[Channel, ...]:
    """The channels that `omero` describes."""
    omero = attributes.get("omero")
    described = omero.get("channels") if isinstance(omero, dict) else None
    if not isinstance(described, list):
        return ()
    return tuple(_channel(channel) for channel in described if isinstance(channel, dict))


def _channel(channel: dict[str, Any]) -> Channel:
    color = str(channel.get("color") or "").removeprefix("#")
    wavelength = channel.get("emission_wavelength", channel.get("emissionWavelength"))
    is_length = isinstance(wavelength, int | float) and np.isfinite(wavelength) and wavelength > 0
    window = channel.get("window")
    return Channel(
        str(channel.get("label") or ""),
        _hex(color),
        float(wavelength or 0) if is_length else None,
        window_of(window.get("start"), window.get("end")) if isinstance(window, dict) else None,
        channel.get("active") is not False,
    )


def _hex(text: str) -> tuple[float, float, float] | None:
    """The colour RRGGBB, which some follow by an alpha; None for anything else."""
    try:
        red, green, blue = (int(text[i : i + 2], 16) / 255 for i in (0, 2, 4))
    except ValueError:
        return None
    return red, green, blue


def facts_of(
    axes: Axes,
    channels: Sequence[Channel],
    *,
    channel: int,
    shape: Sequence[int],
    levels: Sequence[Sequence[int]],
    matrix: NDArray[np.float64],
) -> Facts:
    """The facts of one level. `levels`: shapes of all, in order of the axes; `matrix`: world from index, all axes."""
    unit, _ = axes.in_one_unit()
    n_times, time_step = 1, None
    if "t" in axes.names:
        place = axes.names.index("t")
        n_times = int(shape[place])
        time_step = float(matrix[place, place])
    has_units_of_time = units.canonical(axes.unit_of("t")) is not None
    zyx = [axes.names.index(name) if name in axes.names else None for name in "zyx"]
    emits = any(one.emission_nm is not None for one in channels)
    return Facts(
        unit=unit,
        modality="fluorescence" if emits else None,
        channel=channels[channel] if channel < len(channels) else None,
        channels=tuple(channels),
        n_times=n_times,
        # A scale of 1 without a unit is what writers put where they know nothing.
        time_step=time_step if n_times > 1 and has_units_of_time else None,
        time_unit=TIME_UNITS.get(str(axes.unit_of("t")), axes.unit_of("t")) if n_times > 1 else None,
        levels=tuple(_shape(level, zyx) for level in levels) if len(levels) > 1 else (),
        guesses=tuple(axes.guesses()),
    )


def _shape(level: Sequence[int], zyx: Sequence[int | None]) -> tuple[int, int, int]:
    """Samples along z, y, x of a level; 1 along an axis that it does not have."""
    z, y, x = (1 if axis is None else int(level[axis]) for axis in zyx)
    return z, y, x
