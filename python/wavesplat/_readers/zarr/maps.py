"""Arrays of Zarr with names of their axes, as xarray writes them: coordinates are arrays of these names beside them.

Zarr 2 has the names among the attributes (`_ARRAY_DIMENSIONS`), Zarr 3 in the metadata of the array.
https://docs.xarray.dev/en/stable/internals/zarr-encoding-spec.html
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wavesplat._model.interchange.labelled_array import in_order
from wavesplat._model.volume.facts import Facts
from wavesplat._model.volume.map_axes import is_of_world
from wavesplat._readers.hdf5.netcdf_axes import picked_axes
from wavesplat._readers.request import Request
from wavesplat.errors import ArgumentError, FileError

#: Longest coordinate that is read.
MAX_COORDINATES = 1 << 20
PACKED = "values are packed (scale_factor, add_offset), and drawn as they are stored: xarray.open_zarr unpacks them"


@dataclass(frozen=True)
class NamedVolume:
    """One volume of an array: its axes z, y, x, the index along each of the others, its place, and facts."""

    order: tuple[int, int, int]
    picked: list[int | None]
    world_from_index: NDArray[np.float64]
    facts: Facts


@dataclass(frozen=True)
class _Coordinate:
    """Numbers along an axis, as xarray has them."""

    numbers: NDArray[Any]
    attrs: Mapping[str, Any]
    ndim: int = 1

    @property
    def dtype(self) -> np.dtype[Any]:
        return self.numbers.dtype

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> NDArray[Any]:
        return np.array(self.numbers, dtype)


@dataclass(frozen=True)
class _Axes:
    """Names, sizes and coordinates of the axes of an array, as xarray has them, without samples."""

    dims: tuple[str, ...]
    shape: tuple[int, ...]
    coords: Mapping[str, _Coordinate]
    attrs: Mapping[str, Any]
    name: str

    @property
    def sizes(self) -> dict[str, int]:
        return dict(zip(self.dims, self.shape, strict=True))

    @property
    def ndim(self) -> int:
        return len(self.dims)

    def isel(self, picked: Mapping[str, Any]) -> _Axes:
        return self.transpose(*(name for name in self.dims if name not in picked))

    def transpose(self, *dims: str) -> _Axes:
        return replace(self, dims=dims, shape=tuple(self.sizes[name] for name in dims))


def named_volume(array: Any, group: Any, read: Callable[[Any], NDArray[Any]], request: Request) -> NamedVolume | None:
    """The volume of an array with named axes; None if the axes have no names or only the names of an image.

    group : of the arrays beside it, or None. read : reads all of a small array.
    """
    names = array.attrs.get("_ARRAY_DIMENSIONS") or getattr(array.metadata, "dimension_names", None)
    if not names or len(names) != array.ndim or not all(isinstance(name, str) for name in names):
        return None
    if len(set(names)) < len(names) or array.ndim < 3:
        return None
    coordinates = {}
    for name, size in zip(names, array.shape, strict=True):
        own: Any = None if group is None or "/" in name else group.get(name)
        if getattr(own, "shape", None) == (size,) and size <= MAX_COORDINATES and own.dtype.kind in "iuf":
            coordinates[name] = _Coordinate(read(own), dict(own.attrs))
    title = (request.dataset or request.name).rpartition("/")[2]
    axes = _Axes(tuple(names), tuple(array.shape), coordinates, dict(array.attrs), title)
    if not coordinates and not is_of_world(axes, list(names)):
        return None
    if request.component is not None:
        raise ArgumentError(f"component= has no meaning for an array of the axes {', '.join(names)}; leave it out")
    picked, spatial, times = picked_axes(title, axes, request)
    volume = axes.isel(picked).transpose(*spatial)
    of_file = {} if group is None else dict(group.attrs)
    try:
        found = in_order(volume, has_place=request.spacing is not None, of_file=of_file)
    except ArgumentError as error:
        raise FileError(f"{error}: {request.safe_path}") from None
    is_packed = {"scale_factor", "add_offset"} & set(array.attrs)
    facts = replace(found.facts, guesses=(*found.facts.guesses, *([PACKED] if is_packed else [])), **times)
    matrix = np.diag([*found.directions, 1.0]) if found.world_from_index is None else found.world_from_index
    z, y, x = (names.index(axis) for axis in spatial)
    return NamedVolume((z, y, x), [picked.get(name) for name in names], matrix, facts)
