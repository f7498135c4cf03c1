"""Converted objects of other libraries: samples, their place, and facts."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wavesplat._model.volume.facts import Facts
from wavesplat._system.memory import check_room
from wavesplat.errors import ArgumentError

NO_FACTS = Facts()


@dataclass(frozen=True)
class Converted:
    """Samples [z, y, x]; None for a place or a name that the object does not have."""

    samples: Any
    world_from_index: NDArray[np.float64] | None = None
    facts: Facts = NO_FACTS
    name: str | None = None
    #: Signs of the axes x, y, z where the caller gives their distances: -1 of one that falls, or grows downwards.
    directions: tuple[float, float, float] = (1.0, 1.0, 1.0)


def whole(array: Any) -> NDArray[Any]:
    """All samples of an array that is sliced."""
    return np.asarray(array[...])


def loaded(array: Any, name: str, read: Callable[[Any], NDArray[Any]] = whole) -> NDArray[Any]:
    """The samples of an array that is not in memory yet; refused before it is read where it is no volume."""
    check_shape(tuple(array.shape), name)
    check_room(int(np.prod(array.shape, dtype=np.float64)) * np.dtype(array.dtype).itemsize, "the samples", "crop them")
    return read(array)


def check_shape(shape: Sequence[int], name: str) -> None:
    """Raise an `ArgumentError` if an array of this shape is no volume."""
    shape = tuple(shape)
    if len(shape) == 2:
        raise ArgumentError(
            f"volume {name!r}: the array is 2-D, shape {shape}; a volume is [z, y, x]: "
            "stack at least two slices with np.stack(slices)"
        )
    if len(shape) == 4:
        raise ArgumentError(
            f"volume {name!r}: the array is 4-D, shape {shape}; a volume is [z, y, x]: pick one time point or channel, "
            f"as array[n] with n = 0..{shape[0] - 1} or array[..., n] with n = 0..{shape[3] - 1}"
        )
    if len(shape) != 3:
        raise ArgumentError(f"volume {name!r}: the array is {len(shape)}-D, shape {shape}; a volume is 3-D, [z, y, x]")
    if 0 in shape:
        raise ArgumentError(f"volume {name!r}: shape {shape} (z, y, x) holds no samples; every axis needs at least 1")
