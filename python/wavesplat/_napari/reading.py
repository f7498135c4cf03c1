"""Layers of napari from files: samples, where they lie, units, colours and windows; segmentations as labels.

A layer is a tuple, as napari takes it from plugins: (data, arguments of `add_image` or `add_labels`, kind of layer).
World coordinates are ours in reverse order: z, y, x.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from os import PathLike
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wavesplat._looks.kinds.channel_colors import color_of
from wavesplat._looks.kinds.channels import is_full_range_window
from wavesplat._looks.kinds.histogram import finite_samples
from wavesplat._looks.kinds.kinds import kind_of
from wavesplat._model.lazy.volume import LazyVolume
from wavesplat._model.volume import units
from wavesplat._model.volume.series import Series
from wavesplat._model.volume.volume import Volume
from wavesplat._readers.request import SeveralError
from wavesplat._readers.time_points import open_series
from wavesplat._system.libraries import library
from wavesplat.errors import ArgumentError

LayerData = tuple[Any, dict[str, Any], str]

#: Percentiles of the samples that are shown where the file has no window.
WINDOW = (1.0, 99.8)
#: Time units that napari's library of units knows.
TIME_UNITS = {"s", "ms", "us", "ns", "min", "h"}
#: Napari's name of a distance without a unit.
NO_UNIT = "pixel"


def get_reader(path: str | Sequence[str]) -> Callable[[Any], list[LayerData]] | None:
    """The function that reads a path, for napari; None for several paths, which napari then gives one by one."""
    return layers_of if isinstance(path, str | PathLike) else None


def layers_of(path: str | PathLike[str], **options: Any) -> list[LayerData]:
    """Layers of a file: one for each channel, at all times.

    Parameters
    ----------
    path : path or URL
        As for `wavesplat.open`.
    **options : FileOptions
        As for `wavesplat.open`.

    Returns
    -------
    list of (data, arguments, "image" or "labels")
        What `viewer.add_layer(napari.layers.Layer.create(*one))` takes. Samples are [z, y, x], or [t, z, y, x]; of
        lazy volumes an array of Dask, or one for each level. Arguments are name, place, units, colour and contrast
        limits, which are the file's or percentiles of the samples.
    """
    return [_layer(open_series(path, channel=number, **options), number) for number in _channels_of(path, options)]


def _channels_of(path: Any, options: dict[str, Any]) -> list[int | None]:
    try:
        _ = open_series(path, **options)[0]
    except SeveralError as several:
        if several.option != "channel":
            raise
        return list(range(len(several.names)))
    return [None]


def _layer(series: Series, number: int | None) -> LayerData:
    """The layer of a channel; `number`: None of a file that has no more than one."""
    first = series[0]
    is_lazy = isinstance(first, LazyVolume)
    # Of several times, floating-point numbers of a later one may be no whole numbers.
    of_numbers = first.dtype.kind in "iu" or len(series) == 1
    kind = kind_of(first) if number is None and not is_lazy and of_numbers else None
    is_segmentation = kind == "labels" or (kind == "mask" and first.dtype.kind in "iu")
    channel = first.facts.channel
    name = (channel.name if channel is not None else "") or ("" if number is None else f"channel {number}")
    options: dict[str, Any] = {"name": f"{first.name} {name}".strip(), **_place(series, first)}
    if is_segmentation and first.dtype.kind == "f":
        return first.samples.astype(np.int64), options, "labels"
    if is_segmentation:
        # Numbers of a later time may be larger than numbers of the first.
        return _samples(series, np.result_type(first.dtype, np.int32)), options, "labels"
    options["contrast_limits"] = _window(first)
    if channel is not None:
        color = color_of(channel, first.facts.channels)
        options["colormap"] = "gray" if color is None else _hex(color)
        options["visible"] = channel.is_active
    if number is not None:
        options["blending"] = "additive"
    if isinstance(first, LazyVolume) and len(series) == 1:
        levels = _levels(first)
        return (levels, {**options, "multiscale": True}, "image") if len(levels) > 1 else (levels[0], options, "image")
    return _samples(series, first.dtype), options, "image"


def _place(series: Series, first: Volume) -> dict[str, Any]:
    """Scale and translation, or affine, and units, along (t,) z, y, x."""
    matrix = first.world_from_index
    steps = np.diag(matrix)[:3]
    is_turned = np.abs(matrix[:3, :3] - np.diag(steps)).max() > 1e-9 * min(first.spacing) or steps.min() <= 0
    before = [] if len(series) == 1 else [_time_step(series)]
    options: dict[str, Any] = {}
    if is_turned:
        n = 3 + len(before)
        zyx = [n - 1, n - 2, n - 3]
        full = np.eye(n + 1)
        full[np.ix_(zyx, zyx)] = matrix[:3, :3]
        full[zyx, -1] = matrix[:3, 3]
        if before:
            full[0, 0] = before[0]
        options["affine"] = full
    else:
        options["scale"] = [*before, *steps[::-1].tolist()]
        options["translate"] = [*([0.0] * len(before)), *matrix[2::-1, 3].tolist()]
    unit = first.unit if units.metres(first.unit) is not None else None
    if unit is not None:
        of_time = series.time_unit if series.time_unit in TIME_UNITS else NO_UNIT
        options["units"] = [*([of_time] * len(before)), *[unit] * 3]
    options["axis_labels"] = [*(["t"] * len(before)), "z", "y", "x"]
    return options


def _time_step(series: Series) -> float:
    step = series.times[1] - series.times[0]
    return step if step > 0 else 1.0


def _window(volume: Volume) -> tuple[float, float]:
    channel = volume.facts.channel
    if channel is not None and channel.window is not None and not is_full_range_window(channel.window, volume):
        return channel.window
    low, high = (float(end) for end in np.percentile(finite_samples(volume), WINDOW))
    return (low, high) if high > low else (low, low + 1.0)


def _samples(series: Series, dtype: np.dtype[Any]) -> Any:
    """Samples of all times: of one an array in memory, of several one of Dask, which reads them when they are shown."""
    first = series[0]
    if len(series) == 1:
        return first.samples
    dask = library("dask.array", extra="dask")
    delayed = library("dask", extra="dask").delayed
    parts = [
        dask.from_delayed(delayed(_samples_at)(series, time, dtype), shape=first.shape, dtype=dtype)
        for time in range(len(series))
    ]
    return dask.stack(parts)


def _samples_at(series: Series, time: int, dtype: np.dtype[Any]) -> NDArray[Any]:
    samples = np.asarray(series[time])
    # Whole numbers of 64 bits are held in the narrowest type of each time; a cast would change larger ones in silence.
    if not np.can_cast(samples.dtype, dtype):
        raise ArgumentError(
            f"time {time} has samples of {samples.dtype}, and the layer samples of {dtype}; store all times in one "
            "type of 32 bits or fewer, or as floats"
        )
    return samples.astype(dtype, copy=False)


def _levels(volume: LazyVolume) -> list[Any]:
    """An array of Dask for each level of a lazy volume."""
    dask = library("dask.array", extra="dask")
    arrays = []
    for number in range(len(volume.levels)):
        array = volume._levels[number].array
        arrays.append(dask.from_array(_Slices(volume.at_level(number)), chunks=array.chunks, asarray=False, name=False))
    return arrays


class _Slices:
    """Samples of a level of a lazy volume, by slices."""

    ndim = 3

    def __init__(self, volume: LazyVolume) -> None:
        self._volume = volume
        self.shape, self.dtype = volume.levels[volume.level or 0], volume.dtype

    def __getitem__(self, index: tuple[slice | int, ...]) -> NDArray[Any]:
        """Samples at numbers and slices of positive steps, one for each axis, as Dask asks for them."""
        parts = [part if isinstance(part, slice) else slice(part, part + 1) for part in index]
        z, y, x = (range(n)[part] for part, n in zip(parts, self.shape, strict=True))
        if not (z and y and x):
            return np.empty((len(z), len(y), len(x)), self.dtype)
        box = self._volume._stored_box(((z[0], y[0], x[0]), (z[-1] + 1, y[-1] + 1, x[-1] + 1)))
        samples = box[:: z.step, :: y.step, :: x.step]
        return samples[tuple(slice(None) if isinstance(part, slice) else 0 for part in index)]


def _hex(color: tuple[float, float, float]) -> str:
    return "#" + "".join(f"{round(255 * share):02x}" for share in color)
