"""Stacks: volumes on one grid, one for each time and channel, as the files of microscopes hold them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from wavesplat._model.volume.facts import Channel, Facts
from wavesplat._model.volume.grid import Grid, name_in_files
from wavesplat.errors import ArgumentError

#: Lower and upper index (z, y, x) of a box of samples, the upper one not in it.
Box = tuple[tuple[int, int, int], tuple[int, int, int]]
#: Largest difference of two affines of one grid, in spacings: they are rounded in files.
TOLERANCE = 1e-3
#: Largest difference of two steps of time that count as equal, as a fraction.
TOLERANCE_OF_TIMES = 1e-3


class WiderType(Exception):  # noqa: N818 - caught by `volume_file.save`, which begins again
    """A time was read whose samples do not fit into the type of a stack; `dtype` holds them and all before."""

    def __init__(self, dtype: np.dtype[Any]) -> None:
        super().__init__(dtype)
        self.dtype = dtype


class Stored(Protocol):
    """A volume whose samples are read box by box."""

    @property
    def dtype(self) -> np.dtype[Any]:
        """Type of the samples."""

    def _stored_grid(self) -> Grid:
        """Grid of the samples."""

    def _stored_box(self, box: Box) -> NDArray[Any]:
        """Samples of a box, [z, y, x]."""


class VolumesOfTimes(Protocol):
    """The volumes of a channel, one for each time."""

    def __len__(self) -> int:
        """Number of times."""

    def __getitem__(self, number: int, /) -> Stored:
        """The volume of a time."""


@dataclass(frozen=True)
class Stack:
    """Volumes on one grid.

    volumes : a list of times for each channel.
    channels : a description of each channel; empty where there is one, of which nothing is known.
    """

    volumes: Sequence[VolumesOfTimes]
    grid: Grid
    dtype: np.dtype[Any]
    channels: tuple[Channel, ...]
    times: tuple[float, ...]
    time_unit: str | None

    @property
    def name(self) -> str:
        """The name of the image to write into files; a name from a patient's file is left out."""
        return name_in_files(self.grid)

    @property
    def n_channels(self) -> int:
        """Number of channels."""
        return len(self.volumes)

    @property
    def n_times(self) -> int:
        """Number of times."""
        return len(self.times)

    @property
    def facts(self) -> Facts:
        """Facts of the first volume."""
        return self.grid.facts

    @property
    def time_step(self) -> float | None:
        """Time between neighbouring volumes, in `time_unit`; None where there is one time, or steps or unit vary."""
        steps = [later - earlier for earlier, later in pairwise(self.times)]
        if not steps or self.time_unit is None or min(steps) <= 0:
            return None
        mean = sum(steps) / len(steps)
        return mean if all(abs(step - mean) <= TOLERANCE_OF_TIMES * mean for step in steps) else None

    def read(self, time: int, channel: int, box: Box) -> NDArray[Any]:
        """Samples of a box, [z, y, x], in the type of the stack; `WiderType` where they do not fit into it."""
        volume = self.volumes[channel][time]
        check_alike(volume._stored_grid(), self.grid)
        if not np.can_cast(volume.dtype, self.dtype):
            # Whole numbers of 64 bits are held in the narrowest type that holds one time.
            if _are_whole_numbers(volume.dtype, self.dtype):
                raise WiderType(np.result_type(volume.dtype, self.dtype))
            raise ArgumentError(
                f"volume {volume._stored_grid().name!r} at time {time} has samples of {volume.dtype}, the first one "
                f"{self.dtype}; give volumes of one type"
            )
        return volume._stored_box(box).astype(self.dtype, copy=False)


def stacked(
    volumes: Sequence[VolumesOfTimes],
    channels: Sequence[Channel] | None = None,
    times: Sequence[float] = (0.0,),
    time_unit: str | None = None,
) -> Stack:
    """The stack of volumes that lie on one grid.

    channels : description of each; None takes those that the volumes have.

    Raises
    ------
    ArgumentError
        If the volumes differ in shape, place or number of times.
    """
    firsts = [of_times[0] for of_times in volumes]
    grids = [first._stored_grid() for first in firsts]
    for of_times, grid in zip(volumes, grids, strict=True):
        check_alike(grid, grids[0])
        if len(of_times) != len(times):
            raise ArgumentError(
                f"channel {grid.name!r} has {len(of_times)} time points, the first one {len(times)}; save "
                "channels with one number of times together"
            )
    dtype = np.result_type(*(first.dtype for first in firsts))
    if channels is None:
        channels = [grid.facts.channel or Channel() for grid in grids]
    has_names = len(channels) > 1 or channels[0] != Channel()
    return Stack(volumes, grids[0], dtype, tuple(channels) if has_names else (), tuple(map(float, times)), time_unit)


def _are_whole_numbers(*dtypes: np.dtype[Any]) -> bool:
    """Whether types may all hold whole numbers of 64 bits: integers, and float64 for those beyond 32 bits."""
    return all(dtype.kind in "iu" or dtype == np.float64 for dtype in dtypes)


def check_alike(grid: Grid, first: Grid) -> None:
    """Raise an `ArgumentError` if two grids differ."""
    off = np.abs(grid.world_from_index - first.world_from_index).max()
    if grid.shape != first.shape or off > TOLERANCE * min(first.spacing):
        raise ArgumentError(
            f"volume {grid.name!r}, shape {grid.shape} (z, y, x), lies on another grid than {first.name!r}, shape "
            f"{first.shape}; one file holds volumes of one shape and place: save them one by one"
        )
