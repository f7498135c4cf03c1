"""netCDF: a variable of a model of climate, weather or ocean, by xarray, with place, unit and times from its metadata.

Packed integers are unpacked (`scale_factor`, `add_offset`) and missing values (`_FillValue`, `missing_value`) are NaN,
by xarray. netCDF-3 is read by SciPy, netCDF-4, which is HDF5, by h5netcdf: both are small beside the package netCDF4,
which brings a second HDF5 library of its own.
Conventions for metadata (CF): https://cfconventions.org, "Coordinate Types" and "Packed Data".
"""

from __future__ import annotations

import warnings
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from wavesplat._model.interchange.hdf5 import check_links, held_hdf5, read_hdf5
from wavesplat._model.interchange.labelled_array import in_order
from wavesplat._model.lazy.array import SlicedArray
from wavesplat._model.volume.facts import Facts, quantity_of
from wavesplat._readers import single_planes
from wavesplat._readers.file_contents import Contents, FileArray, are_small, ranges_of
from wavesplat._readers.hdf5.netcdf_axes import evenly, picked_axes, variable_text
from wavesplat._readers.levels import Levels
from wavesplat._readers.request import Grid, Request, no_such_name, several, unwarned
from wavesplat._storage import size_checks
from wavesplat._storage.file_states import StoredFiles
from wavesplat._storage.reading import reading
from wavesplat._system.libraries import library
from wavesplat.errors import ArgumentError, FileError

if TYPE_CHECKING:
    import h5py


#: The extra that has the libraries.
EXTRA = "netcdf"
#: First bytes of HDF5, and of the form of netCDF-3 with 64-bit sizes, which SciPy does not read.
HDF5, CDF5 = b"\x89HDF", b"CDF\5"
#: Bytes of a float -> the number that the library netCDF leaves where none was written (NC_FILL_FLOAT, _DOUBLE).
UNWRITTEN = {4: np.float32(9.9692099683868690e36), 8: np.float64(9.9692099683868690e36)}
#: Attributes of a file of finite elements (Exodus), which is netCDF too.
EXODUS = {"api_version", "floating_point_word_size"}
#: Attributes of variables on meshes (https://ugrid-conventions.github.io).
MESH = {"mesh", "location"}
#: Attributes by which a coordinate names the variable of the borders of its cells.
BORDERS = ("bounds", "climatology")
#: Variables without three axes that a message names, at most.
MAX_LISTED = 6


@dataclass(frozen=True)
class _Variable:
    """A variable of a file, one volume of it: its axes z, y, x, and facts of time."""

    array: Any
    facts: Facts
    world_from_index: NDArray[np.float64]
    #: Numbers of the axes z, y, x among the axes of the variable in the file, and the index along the others.
    order: tuple[int, int, int]
    picked: tuple[int | None, ...]
    name: str


def levels(request: Request) -> Levels | Grid:
    """A variable in a netCDF file; one on a grid that is not even is read at once, by `resample`."""
    if None not in (request.resample, request.memory):
        raise ArgumentError(
            f"resample= reads all samples; leave out memory=, or write a file with even coordinates: {request.path}"
        )
    with _quietly(), _opened(request.file, request) as datasets:
        variable = _chosen(datasets, request)
        shape, dtype = variable.array.shape, variable.array.dtype
        # Refuse a header that promises more samples than the file can hold.
        stored, ratio = request.file.stat().st_size, size_checks.ANY_RATIO
        size_checks.check_stored(shape, np.dtype("u1"), stored, request.path, ratio=ratio, held=(1,))
        if request.resample is not None:
            size_checks.check_memory(size_checks.n_bytes(shape, dtype), request.path)
            samples = _without_unwritten(np.asarray(variable.array), variable.array.encoding)
            return Grid(samples, variable.world_from_index, variable.facts)
        group, _, name = variable.name.rpartition("/")
        sizes = datasets[group][name].encoding.get("chunksizes")
        sizes = sizes or [1] * (len(variable.picked) - 2) + list(shape[-2:])
        array = SlicedArray(
            None,
            name=request.name,
            chunks=[sizes[axis] for axis in variable.order],
            order=variable.order,
            picked=variable.picked,
            opened=partial(_Stored, request, variable.name),
            dtype=dtype,
            shape=(shape[0], shape[1], shape[2]),
            n_readers=1,
            token=f"netCDF {request.file} {variable.name}",
            files=StoredFiles([request.file]),
        )
        return Levels([array], [variable.world_from_index], variable.facts, quietly=_quietly)


def contents(request: Request) -> Contents:
    """All variables of numbers with three axes or more, unpacked."""
    with reading("netCDF", request.path), _quietly(), _opened(request.file, request) as datasets:
        _check_kind(datasets, request)
        borders, found = _borders(datasets), _volumes(datasets)
        looks = are_small(found.values())
        arrays = []
        for name, array in found.items():
            if name not in borders:
                ranges = ranges_of(_Unpacked(array)) if looks else ()
                arrays.append(FileArray(name, str(array.dtype.newbyteorder("=")), array.shape, ranges=ranges))
        return Contents(tuple(arrays))


class _Unpacked:
    """Numbers of a variable that are read where they are sliced."""

    def __init__(self, array: Any) -> None:
        self.dtype, self.shape, self.ndim, self._variable = array.dtype, array.shape, array.ndim, array.variable

    def __getitem__(self, index: Any) -> NDArray[Any]:
        return _without_unwritten(np.asarray(self._variable[index]), self._variable.encoding)


class _Stored:
    """A variable of a file that stays open, unpacked where it is sliced."""

    def __init__(self, request: Request, name: str) -> None:
        self._opened = _opened(request.file, request, stays=True)
        datasets = self._opened.__enter__()
        group, _, inner = name.rpartition("/")
        self._array = datasets[group][inner].variable

    def __getitem__(self, index: Any) -> NDArray[Any]:
        return _without_unwritten(np.asarray(self._array[index]), self._array.encoding)

    def __del__(self) -> None:
        with suppress(Exception):  # at the end of the process parts of the library may be gone
            self._opened.__exit__(None, None, None)


@contextmanager
def _quietly() -> Iterator[None]:
    """Keep xarray and h5netcdf from warning about attributes that are not used here."""
    with unwarned("xarray"):
        warnings.simplefilter("ignore", UnicodeWarning)
        yield


def _without_unwritten(samples: NDArray[Any], encoding: dict[str, Any]) -> NDArray[Any]:
    """The samples with NaN where a float was never written and the file names no other mark of missing values."""
    unwritten = UNWRITTEN.get(samples.dtype.itemsize) if samples.dtype.kind == "f" else None
    if unwritten is None or "_FillValue" in encoding or "missing_value" in encoding:
        return samples
    is_missing = samples == unwritten
    return np.where(is_missing, np.nan, samples).astype(samples.dtype) if is_missing.any() else samples


def is_netcdf(path: Path) -> bool:
    """Whether an HDF5 file is netCDF-4: by its mark, or by axes that are dimensions with scales."""
    import h5py

    def is_marked(group: h5py.Group) -> bool:
        own = [group[name] for name in group if isinstance(group.get(name, getlink=True), h5py.HardLink)]
        return any("_Netcdf4Dimid" in node.attrs or node.attrs.get("CLASS") == b"DIMENSION_SCALE" for node in own)

    try:
        with read_hdf5(path) as file:
            return "_NCProperties" in file.attrs or is_marked(file)
    except (OSError, KeyError, RuntimeError, ValueError):
        return False  # what is wrong is said by the reader of HDF5


@contextmanager
def _opened(path: Path, request: Request, *, stays: bool = False) -> Iterator[dict[str, Any]]:
    """The groups of a file, each as a Dataset with the coordinates of the groups around it; the root is "".

    stays : whether the file is held open for samples that are read later.
    """
    xarray = library("xarray", extra=EXTRA)
    with path.open("rb") as file:
        start = file.read(4)
    #: Times stay numbers: their unit is shown beside them, and calendars of models need a further package.
    how: dict[str, Any] = {"decode_times": False, "decode_timedelta": False, "cache": False}
    if start == CDF5:
        raise FileError(f"the file is netCDF-3 with 64-bit sizes (CDF5); convert it: nccopy -k nc4 a.nc b.nc: {path}")
    if start != HDF5:
        library("scipy", extra=EXTRA)
        with xarray.open_dataset(path, engine="scipy", **how) as dataset:
            yield {"": dataset}
        return
    h5netcdf = library("h5netcdf", extra=EXTRA)
    check_links(path, external_files=request.external_files)
    with (held_hdf5 if stays else read_hdf5)(path) as file, h5netcdf.File(file, "r", phony_dims="access") as root:
        store = xarray.backends.H5NetCDFStore
        stored = {name: root[name] if name else root for name in _groups(root, "")}
        groups = {
            name: xarray.open_dataset(store(group), drop_variables=_records(group), **how)
            for name, group in stored.items()
        }
        yield {name: _with_coordinates_of(group, _around(name, groups)) for name, group in groups.items()}


def _groups(group: Any, name: str) -> Iterator[str]:
    yield name
    for inner in group.groups:
        yield from _groups(group.groups[inner], f"{name}/{inner}".lstrip("/"))


def _records(group: Any) -> list[str]:
    """Names of a group's variables that are no numbers or texts, such as records of several, on which xarray fails."""
    return [name for name, one in group.variables.items() if getattr(one.dtype, "kind", "V") not in "biufSUO"]


def _around(name: str, groups: dict[str, Any]) -> list[Any]:
    """The groups around a group, the root first."""
    return [groups[name[:at]] for at in range(len(name)) if at == 0 or name[at] == "/"]


def _with_coordinates_of(dataset: Any, around: list[Any]) -> Any:
    """The Dataset with coordinates that the groups around it have for its axes, the nearest first."""
    for outer in reversed(around):
        inherited = {
            name: outer.coords[name]
            for name in dataset.sizes
            if name in outer.coords and name not in dataset.coords and outer.sizes[name] == dataset.sizes[name]
        }
        dataset = dataset.assign_coords(inherited)
    return dataset


def _chosen(datasets: dict[str, Any], request: Request) -> _Variable:
    """The volume of the variable that `dataset` names, or of the only one with three axes or more."""
    _check_kind(datasets, request)
    found = _volumes(datasets)
    if request.dataset is None:
        borders = _borders(datasets)
        found = {name: array for name, array in found.items() if name not in borders}
    if not found:
        raise _none_found(datasets, request)
    described = [variable_text(name, array) for name, array in found.items()]
    listed = "; ".join(described)
    if request.dataset is not None:
        name = request.dataset.strip("/")
        if name not in found:
            raise no_such_name("variable", request.dataset, list(found), request)
    elif len(found) == 1:
        name = next(iter(found))
    else:
        message = (
            f"the file holds {len(found)} variables with three or more axes; choose one with dataset= (--dataset): "
            f"{listed}: {request.path}"
        )
        raise several(message, "dataset", list(found), described)
    return _volume_of(name, found[name], datasets[""].attrs, request)


def _check_kind(datasets: dict[str, Any], request: Request) -> None:
    """Raise a `FileError` for a mesh of finite elements (Exodus), which is netCDF too."""
    if set(datasets[""].attrs) >= EXODUS:
        raise FileError(
            "the file holds a mesh of finite elements (Exodus); save pyvista.read(path).combine() as .vtu, and open "
            f"that with resample=N (--resample N): {request.path}"
        )


def _volumes(datasets: dict[str, Any]) -> dict[str, Any]:
    """The variables of numbers with three axes or more, by their names."""
    return {
        f"{group}/{name}".lstrip("/"): array
        for group, dataset in datasets.items()
        for name, array in dataset.data_vars.items()
        if array.ndim >= 3 and array.dtype.kind in "biuf"
    }


def _borders(datasets: dict[str, Any]) -> set[str]:
    """Names of variables that are the borders of the cells of coordinates, not fields."""
    return {
        f"{group}/{attributes[key]}".lstrip("/")
        for group, dataset in datasets.items()
        for array in dataset.variables.values()
        for attributes in (array.attrs, array.encoding)
        for key in BORDERS
        if key in attributes
    }


def _none_found(datasets: dict[str, Any], request: Request) -> FileError:
    """The error for a file without a variable of three axes, with those that it has instead."""
    flat = [
        variable_text(f"{group}/{name}".lstrip("/"), array)
        for group, dataset in datasets.items()
        for name, array in dataset.data_vars.items()
        if array.ndim > 0
    ]
    more = f"; and {len(flat) - MAX_LISTED} more" if len(flat) > MAX_LISTED else ""
    held = "; ".join(flat[:MAX_LISTED]) or "others"
    return FileError(
        f"the file holds no variable with three axes of numbers, so no volume, but {held}{more}; such variables "
        f"are drawn by xarray.open_dataset(path)[name].plot(): {request.path}"
    )


def _volume_of(name: str, array: Any, attributes: dict[str, Any], request: Request) -> _Variable:
    """One volume of a variable: one of its times, and one place along a further axis.

    attributes : of the file.
    """
    if len(set(array.dims)) < array.ndim:
        raise FileError(
            f"{variable_text(name, array)} has an axis twice, so it is a table and no volume; choose another with "
            f"dataset= (--dataset): {request.path}"
        )
    if set(array.attrs) >= MESH:
        raise FileError(
            f"{variable_text(name, array)} has values of a mesh ({array.attrs['mesh']}, {array.attrs['location']}s), "
            f"whose axis {str(array.dims[-1])!r} has no neighbours in space; put the values of one time "
            f"on a grid x, y of the plane, as with scipy.interpolate.griddata((lon, lat), values.T, (x, y))"
            f".transpose(2, 0, 1), and give that to wavesplat.Volume: {request.path}"
        )
    # Levels may have the name of their axis and differ from place to place: they are no coordinates of it.
    several = [axis for axis in array.dims if axis in array.coords and array.coords[axis].ndim != 1]
    array = array.drop_vars(several)
    picked, spatial, times = picked_axes(name, array, request)
    volume = array.isel(picked).transpose(*spatial)
    single_planes.check_thickness(volume.shape, request)
    volume, made = evenly(volume if request.resample is None else _with_gaps(volume), request)
    found = in_order(volume, has_place=request.spacing is not None, of_file=attributes)
    facts = replace(found.facts, quantity=quantity_of(name), guesses=(*found.facts.guesses, *made), **times)
    order = [list(array.dims).index(axis) for axis in found.samples.dims]
    index = tuple(picked.get(axis) for axis in array.dims)
    directions = np.diag([*found.directions, 1.0])
    matrix = directions if found.world_from_index is None else found.world_from_index
    return _Variable(found.samples, facts, matrix, (order[0], order[1], order[2]), index, name)


def _with_gaps(array: Any) -> Any:
    """The array with NaN where a float was never written, before neighbours are mixed.

    Coordinates that belong to several axes are dropped: xarray copies them, and coordinates of an open file cannot be
    copied.
    """
    array = array.reset_coords(drop=True)
    return array.copy(deep=False, data=_without_unwritten(np.asarray(array), array.encoding))
