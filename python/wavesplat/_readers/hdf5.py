"""HDF5, by h5py: a dataset with three or more axes. Its place comes from attributes (`hdf5_place`), if there are."""

from __future__ import annotations

from dataclasses import replace
from math import prod
from typing import TYPE_CHECKING, Any

import numpy as np

from wavesplat._files import payload
from wavesplat._files.reading import reading
from wavesplat._readers.hdf5_place import place_of
from wavesplat._readers.request import Grid, Request, index_unnamed_axes, n_times_of, several
from wavesplat.errors import ArgumentError

if TYPE_CHECKING:
    import h5py

__all__ = ["read"]


def read(request: Request) -> Grid:
    """The samples of a dataset in an HDF5 file."""
    import h5py

    with reading("HDF5", request.path), h5py.File(request.file, "r") as file:
        dataset = _dataset(file, request)
        index = index_unnamed_axes(dataset.shape, request)
        n_samples = prod(sorted(dataset.shape)[-3:]) if len(index) > 1 else prod(dataset.shape)
        payload.check_memory(n_samples * dataset.dtype.itemsize, request.path)
        place = place_of(dataset)
        samples = np.transpose(dataset[index], place.zyx) if place.zyx != (0, 1, 2) else dataset[index]
        facts = replace(place.facts, n_times=n_times_of(dataset.shape, request))
        return Grid(samples, place.world_from_index, facts)


def _dataset(file: h5py.File, request: Request) -> h5py.Dataset:
    import h5py

    found: dict[str, h5py.Dataset] = {}

    def visit(name: str, node: Any) -> None:
        if isinstance(node, h5py.Dataset) and node.ndim >= 3 and node.dtype.kind in "biuf":
            found[name] = node

    file.visititems(visit)
    listed = ", ".join(f"{name} {dataset.shape}" for name, dataset in found.items()) or "none"
    if request.dataset is not None:
        node = file.get(request.dataset)
        if not isinstance(node, h5py.Dataset):
            raise ArgumentError(f"no dataset {request.dataset!r}; the file holds: {listed}: {request.path}")
        return node
    if len(found) != 1:
        message = (
            f"the file holds {len(found)} datasets with three or more axes; choose one with dataset= (--dataset): "
            f"{listed}: {request.path}"
        )
        raise several(message, "dataset", list(found), [f"{name} {node.shape}" for name, node in found.items()])
    return next(iter(found.values()))
