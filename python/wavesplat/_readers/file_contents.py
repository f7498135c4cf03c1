"""All arrays in a file, and the grid that they lie on, without a choice among them: what `wavesplat info` lists.

A reader of files that may hold several arrays has a function `contents(request)`.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from math import prod
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from wavesplat._readers.families import reader_of
from wavesplat._readers.request import Request

Range = tuple[float, float] | None
#: Ranges are found in files whose arrays take at most this many bytes together.
MAX_BYTES = 1 << 30


@dataclass(frozen=True)
class FileArray:
    """An array in a file.

    shape : as the file has it, without the components of vectors; of a grid without rows, the number of places.
    ranges : least and largest finite number of each component; None of one without, and empty where nobody looked.
    """

    name: str
    dtype: str
    shape: tuple[int, ...]
    n_components: int = 1
    place: Literal["points", "cells"] | None = None
    ranges: tuple[Range, ...] = ()


@dataclass(frozen=True)
class GridFacts:
    """A grid, or several as blocks: points, cells, the box around them, and the widths of cells that fill space."""

    described: str
    n_points: int
    n_cells: int
    bounds: tuple[tuple[float, ...], tuple[float, ...]]
    n_blocks: int = 1
    cell_widths: tuple[float, float] | None = None


@dataclass(frozen=True)
class Contents:
    """The arrays of a file, and the grid that they lie on, where the file has one."""

    arrays: tuple[FileArray, ...]
    grid: GridFacts | None = None


def contents_of(request: Request, family: str) -> Contents | None:
    """The contents of a file; None if its reader cannot list them. `family`: the module that reads the file."""
    listed: Any = getattr(reader_of(family), "contents", None)
    found: Contents | None = None if listed is None else listed(request)
    return found


def are_small(arrays: Iterable[Any]) -> bool:
    """Whether the numbers of all arrays, which have a shape and a type, are few enough to find their ranges."""
    n_bytes: int = sum(prod(array.shape) * array.dtype.itemsize for array in arrays)
    return n_bytes <= MAX_BYTES


def ranges_of(numbers: Any, *, has_components: bool = False) -> tuple[Range, ...]:
    """The range of an array [..., component], or of one without components, read in slabs along its first axis."""
    if numbers.dtype.kind not in "biuf":
        return ()
    parts = [numbers[start] for start in slabs(numbers.shape, numbers.dtype.itemsize)] if numbers.ndim else [numbers]
    found = [[_range(part[..., k]) for part in parts] for k in range(numbers.shape[-1])] if has_components else []
    return tuple(_joined(one) for one in found or [[_range(part) for part in parts]])


def joined_ranges(parts: Sequence[tuple[Range, ...]]) -> tuple[Range, ...]:
    """The ranges of an array in several parts; empty if the range of any part is unknown."""
    if not parts or not all(parts):
        return ()
    return tuple(_joined(list(of_component)) for of_component in zip(*parts, strict=True))


def slabs(shape: tuple[int, ...], itemsize: int) -> Iterable[slice]:
    """Slices along the first axis, each of at most 64 MiB, or of one place."""
    step = max(1, (64 << 20) // max(1, prod(shape[1:]) * itemsize))
    return [slice(start, start + step) for start in range(0, shape[0], step)]


def _range(numbers: NDArray[Any]) -> Range:
    numbers = np.asarray(numbers)
    there = numbers[np.isfinite(numbers)] if numbers.dtype.kind == "f" else numbers
    return (float(there.min()), float(there.max())) if there.size else None


def _joined(ranges: list[Range]) -> Range:
    there = [one for one in ranges if one is not None]
    return (min(low for low, _ in there), max(high for _, high in there)) if there else None
