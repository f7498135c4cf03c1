"""Conversion of other libraries' objects to samples with their place, each by the module for its library.

Objects are recognised by the library of their class, or by their attributes, so that only libraries whose objects are
given are imported.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from os import PathLike, fspath
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wavesplat._model.arguments.types import VOLUME
from wavesplat._model.interchange.converted import Converted, loaded
from wavesplat._model.interchange.hdf5 import check_nesting, place_of
from wavesplat._model.interchange.itk_image import of_itk, of_simple_itk
from wavesplat._model.interchange.labelled_array import is_labelled, unlabelled
from wavesplat._model.interchange.napari_layer import of_napari
from wavesplat._model.interchange.nibabel_image import of_nibabel
from wavesplat._model.interchange.tensor import of_array, of_torch
from wavesplat._model.interchange.vtk_image import of_vtk
from wavesplat._model.interchange.yt_grid import of_unyt, of_yt
from wavesplat._model.volume.grid import Grid
from wavesplat._system.values import described
from wavesplat.errors import ArgumentError

#: Library -> advice for its objects that have no samples on a grid, the end of a message.
INSTEAD = {
    "PIL": "a volume is several pictures: stack them, as with numpy.stack(pictures)",
    "h5py": "give one of its datasets, as file['name'], or open the file with wavesplat.open(path, dataset='name')",
    "pydicom": "open the folder of the slices with wavesplat.open(folder)",
    "trimesh": "a mesh has no samples inside; give the volume that it was made from",
    "zarr": "give one of its arrays, as group['0'], or open it with wavesplat.open(path)",
}


def converted(thing: Any, what: str, *, has_place: bool = False) -> Converted:
    """Samples, place and facts of an object; an `ArgumentError` of one sentence for what is no volume.

    what : name of the argument in messages.
    has_place : the caller gives the place, so the object's own does not count.
    """
    libraries = {base.__module__.partition(".")[0] for base in type(thing).__mro__}
    if isinstance(thing, np.ndarray):
        return of_unyt(thing) if "unyt" in libraries else Converted(thing)
    if is_labelled(thing):
        return unlabelled(thing, has_place=has_place)
    take = next((take for name, take in CONVERTERS.items() if name in libraries), None)
    try:
        found = _of_any(thing) if take is None else take(thing)
    except ArgumentError as error:
        raise ArgumentError(f"{what}: {error}") from error
    except (AttributeError, KeyError, OSError, RuntimeError, TypeError, ValueError) as error:
        first_line = (str(error).splitlines() or [type(error).__name__])[0]
        raise ArgumentError(f"{what}: a {type(thing).__name__} could not be read as samples: {first_line}") from error
    if found is None:
        raise ArgumentError(f"{what} {_no_volume(thing, libraries)}")
    return found


def is_rows(thing: object) -> bool:
    """Whether a list or tuple is one volume: rows of numbers in slices, or slices that are arrays of two dimensions.

    Deeper ones, and lists of arrays with three dimensions, are several volumes.
    """
    n_lists = 0
    while isinstance(thing, list | tuple) and len(thing):
        thing, n_lists = thing[0], n_lists + 1
    is_number = isinstance(thing, int | float | complex | np.generic | np.ndarray)
    return n_lists > 0 and is_number and n_lists + np.ndim(thing) == 3  # type: ignore[arg-type]


def _no_volume(thing: object, libraries: set[str]) -> str:
    """Description of an object that is no volume, and advice: the end of a message."""
    if isinstance(thing, str | PathLike):
        return f"is {described(thing)}, the name of a file; open it first: wavesplat.open({fspath(thing)!r})"
    if isinstance(thing, list | tuple) and any(isinstance(part, Grid) for part in thing):
        return f"is a {type(thing).__name__} of {len(thing)}; give one of them"
    if type(thing).__name__ == "Series":
        return "is a Series of several times; give one of them, as series[0]"
    for name, mend in INSTEAD.items():
        if name in libraries:
            return f"is a {type(thing).__name__}; {mend}"
    return f"is {described(thing)}; give {VOLUME}"


def _of_any(thing: Any) -> Converted | None:
    if isinstance(thing, Grid):
        samples = getattr(thing, "samples", None)
        if samples is None:
            raise ArgumentError("wavelet coefficients are no samples; decode them first, with wavelets.to_volume()")
        return Converted(samples, thing.world_from_index, thing.facts, thing.name)
    if isinstance(thing, list | tuple | memoryview):
        return _of_rows(thing)
    array = of_array(thing)
    return None if array is None else Converted(array)


def _of_rows(rows: Any) -> Converted | None:
    """The volume of nested sequences of numbers, or of a list of slices; None for anything else."""
    if isinstance(rows, list | tuple) and any(isinstance(part, Grid) for part in rows):
        return None
    try:
        array: NDArray[Any] = np.asarray(rows)
    except ValueError:
        raise ArgumentError("the samples are rows of different lengths; give an array [z, y, x]") from None
    return Converted(array) if array.ndim > 2 and array.dtype.kind in "biufc" else None


def _of_dask(array: Any) -> Converted | None:
    """Compute an array of Dask, whose names are made up."""
    return Converted(loaded(array, "array")) if hasattr(array, "shape") else None


def _of_zarr(array: Any) -> Converted | None:
    """Read an array of Zarr."""
    from wavesplat._storage.zarr.reading import read_zarr

    if not hasattr(array, "shape"):
        return None
    name = str(array.name or "").rpartition("/")[2] or None
    read = partial(read_zarr, index=[slice(None)] * len(array.shape))
    return Converted(loaded(array, name or "array", read), name=name)


def _of_hdf5(dataset: Any) -> Converted | None:
    """Read a dataset of h5py, with the place that its attributes give."""
    if not hasattr(dataset, "shape"):
        return None
    name = str(dataset.name).rpartition("/")[2]
    check_nesting(dataset, dataset.file.filename)
    place = place_of(dataset)
    samples = loaded(dataset, name)
    return Converted(np.transpose(samples, place.zyx), place.world_from_index, place.facts, name)


#: Library of a class, or of one of its bases -> converter of its objects.
CONVERTERS: dict[str, Callable[[Any], Converted | None]] = {
    "SimpleITK": of_simple_itk,
    "itk": of_itk,
    "nibabel": of_nibabel,
    "vtkmodules": of_vtk,
    "napari": of_napari,
    "torch": of_torch,
    "dask": _of_dask,
    "zarr": _of_zarr,
    "h5py": _of_hdf5,
    "yt": of_yt,
}
