"""Layers of an array whose axes have names, as xarray's: one for each place along the axis of channels.

A layer is a volume or, where there is an axis of times, a series whose volumes are made when they are asked for. It
looks like a channel of a file without colours and windows: dyes that are named have their usual colours.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from wavesplat import _native
from wavesplat._looks.kinds.channel_colors import usual_color
from wavesplat._looks.look import Look
from wavesplat._model.interchange.labelled_array import channel_and_time_axes, is_labelled
from wavesplat._model.volume.facts import Channel
from wavesplat._model.volume.series import Series
from wavesplat._model.volume.volume import Volume
from wavesplat._scene.layer import Layer
from wavesplat.errors import ArgumentError


class _Times:
    """The volumes along the axis of times of an array, whose coordinates are the times where they are numbers."""

    def __init__(self, array: Any, axis: Any) -> None:
        self._array, self._axis = array, axis
        self.name = "array" if array.name is None else str(array.name)

    def __len__(self) -> int:
        return int(self._array.sizes[self._axis])

    def __getitem__(self, number: int) -> Volume:
        return Volume(self._array.isel({self._axis: number}))

    def times(self) -> tuple[tuple[float, ...], str | None]:
        """Time of each volume, and their unit; 0, 1, 2, ... without numbers as coordinates."""
        places = self._array.coords.get(self._axis)
        if places is not None and places.dtype.kind in "mM" and not np.isnat(places.values).any():
            seconds = (places.values - places.values[0]) / np.timedelta64(1, "s")
            return tuple(float(time) for time in seconds), "s"
        if places is None or places.dtype.kind not in "iuf" or not np.isfinite(places.values).all():
            return tuple(float(number) for number in range(len(self))), None
        unit = places.attrs.get("units", places.attrs.get("unit"))
        # "days since 2001-01-01" are days.
        return tuple(float(time) for time in places.values), None if unit is None else str(unit).split(" since ")[0]

    def description(self) -> str:
        """The array, in messages."""
        return f"the array {self.name!r}"


def labelled_layers(what: Any, *, has_looks: bool) -> list[Layer]:
    """The layers of an array with an axis of channels or times; none for anything else, which is one volume or none.

    has_looks : looks are given for the layers, so they get none here.
    """
    if not (is_labelled(what) and hasattr(what, "isel") and hasattr(what, "shape")):
        return []
    channels, times = channel_and_time_axes(what)
    if channels is None:
        return [] if times is None else [Layer(_series(what, times))]
    if what.sizes[channels] > len(_native.CHANNEL_COLORS):
        n = len(_native.CHANNEL_COLORS)
        raise ArgumentError(
            f"the array has {what.sizes[channels]} channels along {channels!r}, a scene at most {n}; "
            f"choose some, as with array.isel({channels}=range({n}))"
        )
    places = range(what.sizes[channels])
    ones = [what.isel({channels: number}) for number in places]
    made = [Layer(Volume(one) if times is None else _series(one, times)) for one in ones]
    known = [layer.drawn.facts.channel or Channel() for layer in made]
    colors = _native.distinct_colors([None] * len(made), [usual_color(channel) for channel in known])
    return [
        Layer(
            layer.volume,
            None if has_looks else Look.channel(layer.looked_at, color),
            name=channel.name or f"channel {number}",
        )
        for number, layer, channel, color in zip(places, made, known, colors, strict=True)
    ]


def _series(array: Any, axis: Any) -> Series:
    points = _Times(array, axis)
    return Series(points, name=points.name)
