"""Stacks as OME-TIFF files, by tifffile: a plane after the other, so that lazy volumes stay in their files.

https://docs.openmicroscopy.org/ome-model/latest/ome-tiff: the OME XML in the first page has the distances of samples,
their unit, times and channels with names, colours and wavelengths, but no windows of values.
"""

from __future__ import annotations

import warnings
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wavesplat._model import units
from wavesplat._model.facts import Channel
from wavesplat._model.stack import Stack

#: Bytes of planes that are read at once.
MAX_BYTES = 1 << 26
#: Samples of more bytes than this need BigTIFF, whose offsets have 64 bits; packed ones of noise can be as large.
BIG_BYTES = 1 << 31
#: OME's name of a distance without a unit.
NO_UNIT = "pixel"


def write(stack: Stack, path: Path, progress: Callable[[float], object]) -> None:
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
    n_at_once = max(1, MAX_BYTES // (n_y * n_x * stack.dtype.itemsize))
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
        metadata["Channel"] = [_channel(channel, is_fluorescence=is_fluorescence) for channel in channels]
    return metadata


def _times(stack: Stack) -> dict[str, Any]:
    if stack.time_step is not None:
        return {"TimeIncrement": stack.time_step, "TimeIncrementUnit": stack.time_unit}
    n_of_time = stack.n_channels * stack.grid.shape[0]
    times = np.repeat(stack.times, n_of_time).tolist()
    return {"Plane": {"DeltaT": times, "DeltaTUnit": [stack.time_unit] * len(times)}}


def _channel(channel: Channel, *, is_fluorescence: bool) -> dict[str, Any]:
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
