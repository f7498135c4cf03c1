"""Stacks as OME-TIFF and OME-Zarr files, plane after plane or block after block, with their facts.

https://ngff.openmicroscopy.org/0.5. The metadata are ours, since the packages that write them bring a hundred megabytes
of others. Axes are halved level by level: axes with the smallest distances first, so that samples become cubes.
"""

from __future__ import annotations

import warnings
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from itertools import product
from math import prod
from os import PathLike
from pathlib import Path
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from wavesplat._model.volume import units
from wavesplat._model.volume.facts import Channel
from wavesplat._model.volume.stack import Box, Stack
from wavesplat._system.threads import warn

# Facts of volumes as OME files hold them, and those that such a file has no place for.

#: Part of the spacing by which an axis may lean and still count as one of the world's.
TOLERANCE = 1e-6


def steps_of(stack: Stack) -> tuple[float, float, float] | None:
    """Signed steps along x, y and z where these are the world's axes; None for a grid that is turned."""
    matrix = stack.grid.world_from_index[:3, :3]
    x, y, z = (float(step) for step in np.diag(matrix))
    off = np.abs(matrix - np.diag((x, y, z))).max(axis=0)
    return None if (off > TOLERANCE * np.array(stack.grid.spacing)).any() else (x, y, z)


def hex_of(color: tuple[float, float, float]) -> str:
    """A colour as RRGGBB."""
    return "".join(f"{round(255 * share):02X}" for share in color)


def _lost_times(stack: Stack, *, is_zarr: bool) -> list[str]:
    """Names of the lost facts of times: without a unit all but their order, and in Zarr where they begin."""
    if stack.n_times == 1 or stack.times == tuple(range(stack.n_times)):
        return []
    if stack.time_unit is None:
        return ["its times, which have no unit"]
    if is_zarr and stack.time_step is None:
        return ["its times, which are not evenly spaced"]
    return ["when its times begin"] if stack.times[0] != 0 and stack.time_step is not None else []


def warn_of_lost(stack: Stack, path: str | PathLike[str], *, is_zarr: bool) -> None:
    """Warn of facts that the file cannot hold."""
    steps, facts = steps_of(stack), stack.facts
    lost = [] if steps is not None else ["how its axes are turned", *(["its place"] if is_zarr else [])]
    if not is_zarr:
        lost += ["which axes are mirrored"] if steps is not None and min(steps) < 0 else []
        lost += ["its place"] if np.abs(stack.grid.world_from_index[:3, 3]).max() > 0 else []
    lost += ["that its axes are a patient's"] if facts.is_anatomical else []
    lost += [f"the modality ({facts.modality})"] if facts.modality not in (None, "fluorescence") else []
    lost += [f"the unit of its values ({facts.value_unit})"] if facts.value_unit is not None else []
    lost += _lost_times(stack, is_zarr=is_zarr)
    if lost:
        kind = "OME-Zarr" if is_zarr else "OME-TIFF"
        warn(
            f"{kind} has no place for some facts of volume {stack.grid.name!r}: {', '.join(lost)}; .nrrd keeps those "
            f"of single volumes: {path}",
            stacklevel=5,
        )


# Stacks as OME-TIFF files, by tifffile: a plane after the other, so that lazy volumes stay in their files.
#
# https://docs.openmicroscopy.org/ome-model/latest/ome-tiff: the OME XML in the first page has the distances of samples,
# their unit, times and channels with names, colours and wavelengths, but no windows of values.

#: Bytes of planes that are read at once.
MAX_TIFF_BYTES = 1 << 26
#: Samples of more bytes than this need BigTIFF, whose offsets have 64 bits; packed ones of noise can be as large.
BIG_BYTES = 1 << 31
#: OME's name of a distance without a unit.
NO_UNIT = "pixel"


def write_tiff(stack: Stack, path: Path, progress: Callable[[float], object]) -> None:
    """Write a stack as one file."""
    import tifffile

    n_z, n_y, n_x = stack.grid.shape
    shape = (stack.n_times, stack.n_channels, n_z, n_y, n_x)
    n_bytes = int(np.prod(shape, dtype=np.int64)) * stack.dtype.itemsize
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", module="tifffile")
        tifffile.imwrite(
            path,
            _planes(stack, progress),
            shape=shape,
            dtype=stack.dtype,
            ome=True,
            bigtiff=n_bytes > BIG_BYTES,
            photometric="minisblack",
            compression="zlib",
            software="wavesplat",
            metadata=_metadata(stack),
        )


def _planes(stack: Stack, progress: Callable[[float], object]) -> Iterator[NDArray[Any]]:
    n_z, n_y, n_x = stack.grid.shape
    n_at_once = max(1, MAX_TIFF_BYTES // (n_y * n_x * stack.dtype.itemsize))
    n_volumes = stack.n_times * stack.n_channels
    for number in range(n_volumes):
        time, channel = divmod(number, stack.n_channels)
        for z in range(0, n_z, n_at_once):
            upper = min(z + n_at_once, n_z)
            yield from stack.read(time, channel, ((z, 0, 0), (upper, n_y, n_x)))
            progress((number + upper / n_z) / n_volumes)


def _metadata(stack: Stack) -> dict[str, Any]:
    """The values of the OME XML, by the names that tifffile takes."""
    own = stack.grid.unit
    unit = NO_UNIT if own is None or units.metres(own) is None else units.written(own)
    metadata: dict[str, Any] = {"axes": "TCZYX", "Name": stack.name}
    for axis, step in zip("XYZ", stack.grid.spacing, strict=True):
        metadata |= {f"PhysicalSize{axis}": step, f"PhysicalSize{axis}Unit": unit}
    if stack.n_times > 1 and stack.time_unit is not None:
        metadata |= _times(stack)
    is_fluorescence = stack.facts.modality == "fluorescence"
    channels = stack.channels or ((Channel(),) if is_fluorescence else ())
    if channels:
        metadata["Channel"] = [_tiff_channel(channel, is_fluorescence=is_fluorescence) for channel in channels]
    return metadata


def _times(stack: Stack) -> dict[str, Any]:
    if stack.time_step is not None:
        return {"TimeIncrement": stack.time_step, "TimeIncrementUnit": stack.time_unit}
    n_of_time = stack.n_channels * stack.grid.shape[0]
    times = np.repeat(stack.times, n_of_time).tolist()
    return {"Plane": {"DeltaT": times, "DeltaTUnit": [stack.time_unit] * len(times)}}


def _tiff_channel(channel: Channel, *, is_fluorescence: bool) -> dict[str, Any]:
    # XML has no way to write most signs that cannot be printed.
    name = "".join(letter for letter in channel.name if letter.isprintable())
    metadata: dict[str, Any] = {"Name": name} if name else {}
    if channel.color is not None:
        red, green, blue = (round(255 * share) for share in channel.color)
        number = red << 24 | green << 16 | blue << 8 | 255
        # A signed number of 32 bits.
        metadata["Color"] = number - (1 << 32) if number >= 1 << 31 else number
    if channel.emission_nm is not None:
        metadata |= {"EmissionWavelength": channel.emission_nm, "EmissionWavelengthUnit": "nm"}
    if is_fluorescence:
        metadata["ContrastMethod"] = "Fluorescence"
    return metadata


# Stacks as OME-Zarr 0.5 (Zarr 3) with a pyramid, by zarr: block after block, so that lazy volumes stay in their files.

#: How samples of coarser levels are made of finer ones: their mean, or the first one, for labels.
Downsampling = Literal["mean", "nearest"]

#: Samples of a chunk along each axis, at most: 4 MB of 16 bits. A level of one chunk is the last.
CHUNK = 128
#: Samples along an axis from which it is halved.
MIN_HALVED = 4
#: Bytes of samples that are read at once, unless one chunk is made of more; means take about five times as much.
MAX_ZARR_BYTES = 1 << 25
#: Percentiles of the coarsest level that make the window of a channel that has none.
WINDOW = (1.0, 99.8)
#: Our names of units -> names in OME-Zarr.
UNITS = {
    "km": "kilometer",
    "m": "meter",
    "dm": "decimeter",
    "cm": "centimeter",
    "mm": "millimeter",
    "um": "micrometer",
    "nm": "nanometer",
    "angstrom": "angstrom",
    "pm": "picometer",
}
TIME_UNITS = {"s": "second", "ms": "millisecond", "us": "microsecond", "ns": "nanosecond", "min": "minute", "h": "hour"}

Triple = tuple[int, int, int]


def write_zarr(stack: Stack, folder: Path, downsampling: Downsampling, progress: Callable[[float], object]) -> None:
    """Write a stack as a folder."""
    import zarr

    factors = _factors(stack.grid.shape, stack.grid.spacing)
    n_extra = (stack.n_times,) * (stack.n_times > 1) + (stack.n_channels,) * bool(stack.channels)
    group: Any = zarr.create_group(folder, zarr_format=3)
    levels: list[Any] = []
    for number, factor in enumerate(factors):
        shape = _shape_at(stack.grid.shape, factor)
        levels.append(
            group.create_array(
                str(number),
                shape=(*n_extra, *shape),
                dtype=stack.dtype,
                chunks=(*[1] * len(n_extra), *(min(n, CHUNK) for n in shape)),
                dimension_names=_axes(stack),
            )
        )
    pyramid = _Pyramid(levels, factors, downsampling)
    n_volumes = stack.n_times * stack.n_channels
    for number in range(n_volumes):
        done = number / n_volumes

        def report(part: float, done: float = done) -> None:
            progress(done + part / n_volumes)

        _write_pyramid(stack, divmod(number, stack.n_channels), pyramid, report)
    group.attrs["ome"] = {
        "version": "0.5",
        "multiscales": [_multiscales(stack, factors, downsampling)],
        **_omero(stack, levels[-1]),
    }


@dataclass(frozen=True)
class _Pyramid:
    """Arrays of the levels, the finest first, and how many of its samples are in one of each."""

    levels: list[Any]
    factors: list[Triple]
    downsampling: Downsampling

    def ratio(self, level: int) -> Triple:
        """Samples of the next finer level in one of a level, along (z, y, x)."""
        finer = self.factors[max(level - 1, 0)]
        z, y, x = (own // n for own, n in zip(self.factors[level], finer, strict=True))
        return z, y, x


def _write_pyramid(
    stack: Stack, which: tuple[int, int], pyramid: _Pyramid, progress: Callable[[float], object]
) -> None:
    """Write all levels of one volume. `which`: its time and channel."""
    place = _index(stack, *which)
    for level, array in enumerate(pyramid.levels):
        ratio = pyramid.ratio(level)
        for lower, upper in _boxes(array.shape[-3:], MAX_ZARR_BYTES // (stack.dtype.itemsize * prod(ratio))):
            inside = tuple(slice(a, b) for a, b in zip(lower, upper, strict=True))
            if level == 0:
                array[(*place, *inside)] = stack.read(*which, (lower, upper))
                progress(upper[0] / array.shape[-3])
            else:
                wider = tuple(slice(n * part.start, n * part.stop) for n, part in zip(ratio, inside, strict=True))
                fine = np.asarray(pyramid.levels[level - 1][(*place, *wider)])
                array[(*place, *inside)] = reduced(fine, ratio, pyramid.downsampling)


def reduced(samples: NDArray[Any], ratio: Triple, downsampling: Downsampling) -> NDArray[Any]:
    """Means of blocks of `ratio` samples along (z, y, x), or the first sample of each.

    Blocks at the upper faces may be cut; of floats those that are not finite are left out of the means.
    """
    if downsampling == "nearest":
        return samples[:: ratio[0], :: ratio[1], :: ratio[2]]
    is_float = samples.dtype.kind == "f"
    if not is_float:
        narrow = samples.dtype.itemsize <= 2
        sums = _summed(samples, ratio, np.dtype(np.int32 if narrow else np.int64))
        counts = _summed(np.ones(samples.shape, np.bool_), ratio, np.dtype(np.uint8))
        rounded: NDArray[Any] = np.rint(sums / counts.astype(np.float32 if narrow else np.float64))
        return rounded.astype(samples.dtype)
    finite = np.isfinite(samples)
    sums = _summed(np.where(finite, samples, 0), ratio, np.dtype(np.float64))
    with np.errstate(invalid="ignore"):
        means: NDArray[Any] = sums / _summed(finite, ratio, np.dtype(np.uint8))  # 0 / 0: a block that is missing
    return means.astype(samples.dtype)


def _summed(samples: NDArray[Any], ratio: Triple, dtype: np.dtype[Any]) -> NDArray[Any]:
    """Sums of blocks of one or two samples along each axis."""
    for axis, n in enumerate(ratio):
        if n == 2:
            first, second = (samples[(slice(None),) * axis + (slice(start, None, 2),)] for start in (0, 1))
            samples = first.astype(dtype)
            samples[(slice(None),) * axis + (slice(second.shape[axis]),)] += second
    return samples.astype(dtype, copy=False)


def _factors(shape: Triple, spacing: tuple[float, float, float]) -> list[Triple]:
    """Samples of the finest level in one of each level, along (z, y, x)."""
    found: list[Triple] = [(1, 1, 1)]
    while max(_shape_at(shape, found[-1])) > CHUNK:
        last = found[-1]
        sizes = _shape_at(shape, last)
        steps = [factor * step for factor, step in zip(last, reversed(spacing), strict=True)]
        can = [n >= MIN_HALVED for n in sizes]
        finest = min(step for step, own in zip(steps, can, strict=True) if own)
        z, y, x = (
            2 * factor if own and step < 2 * finest else factor
            for factor, step, own in zip(last, steps, can, strict=True)
        )
        found.append((z, y, x))
    return found


def _shape_at(shape: Triple, factor: Triple) -> Triple:
    z, y, x = (-(-n // f) for n, f in zip(shape, factor, strict=True))
    return z, y, x


def _boxes(shape: Triple, n_samples: int) -> Iterator[Box]:
    """Boxes of whole chunks that fill a level, of at most `n_samples` where a chunk allows it."""
    size = [min(n, CHUNK) for n in shape]
    for axis in (2, 1, 0):
        others = prod(size) // size[axis]
        size[axis] = min(shape[axis], max(1, n_samples // (others * CHUNK)) * CHUNK)
    for lower in product(*(range(0, n, step) for n, step in zip(shape, size, strict=True))):
        z, y, x = (min(a + step, n) for a, step, n in zip(lower, size, shape, strict=True))
        yield (lower[0], lower[1], lower[2]), (z, y, x)


def _axes(stack: Stack) -> list[str]:
    return ["t"] * (stack.n_times > 1) + ["c"] * bool(stack.channels) + ["z", "y", "x"]


def _index(stack: Stack, time: int, channel: int) -> tuple[int, ...]:
    """Index of a volume along the axes before z."""
    return (time,) * (stack.n_times > 1) + (channel,) * bool(stack.channels)


def _multiscales(stack: Stack, factors: list[Triple], downsampling: Downsampling) -> dict[str, Any]:
    steps = steps_of(stack)
    # A turned grid keeps its distances.
    zyx = np.array((steps or stack.grid.spacing)[::-1])
    first = np.zeros(3) if steps is None else stack.grid.world_from_index[2::-1, 3]
    before = [(stack.time_step or 1.0, stack.times[0])] * (stack.n_times > 1) + [(1.0, 0.0)] * bool(stack.channels)
    datasets = []
    for number, factor in enumerate(factors):
        # A mean lies in the middle of its block.
        shift = (np.array(factor) - 1) / 2 if downsampling == "mean" else np.zeros(3)
        scale = [*(step for step, _ in before), *(zyx * factor).tolist()]
        moved = [*(start for _, start in before), *(first + zyx * shift).tolist()]
        placed = [{"type": "scale", "scale": scale}, {"type": "translation", "translation": moved}]
        datasets.append({"path": str(number), "coordinateTransformations": placed})
    return {
        "name": stack.name,
        "axes": [_axis(name, stack) for name in _axes(stack)],
        "datasets": datasets,
        "type": downsampling,
    }


def _axis(name: str, stack: Stack) -> dict[str, str]:
    if name == "c":
        return {"name": name, "type": "channel"}
    kind, unit = ("time", stack.time_unit) if name == "t" else ("space", stack.grid.unit)
    if name == "t" and stack.time_step is None:
        unit = None
    written = {} if unit is None else {"unit": (TIME_UNITS if name == "t" else UNITS).get(unit, unit)}
    return {"name": name, "type": kind, **written}


def _omero(stack: Stack, coarsest: Any) -> dict[str, Any]:
    """Names, colours and windows of the channels. Each needs a window; one that has none gets percentiles."""
    if not stack.channels:
        return {}
    channels = []
    for number, channel in enumerate(stack.channels):
        values = np.asarray(coarsest[_index(stack, 0, number)], np.float64)
        values = values[np.isfinite(values)]
        low, high = (float(end) for end in np.percentile(values, WINDOW)) if values.size else (0.0, 0.0)
        start, end = channel.window or (low, high if high > low else low + 1.0)
        lowest, highest = (float(values.min()), float(values.max())) if values.size else (start, end)
        window = {"min": min(lowest, start), "max": max(highest, end), "start": start, "end": end}
        channels.append(_zarr_channel(channel, number, window))
    return {"omero": {"channels": channels}}


def _zarr_channel(channel: Channel, number: int, window: dict[str, float]) -> dict[str, Any]:
    entries: dict[str, Any] = {
        "label": channel.name or f"channel {number}",
        "color": hex_of(channel.color or (1.0, 1.0, 1.0)),
        "window": window,
        "active": channel.is_active,
    }
    if channel.emission_nm is not None:
        entries["emission_wavelength"] = channel.emission_nm
    return entries
