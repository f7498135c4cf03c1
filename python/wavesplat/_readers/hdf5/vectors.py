"""Vectors in HDF5: an array whose last axis has three components, or a record of openPMD with a dataset for each.

Source of records: https://github.com/openPMD/openPMD-standard, STANDARD.md, "Scalar, Vector and Tensor Records".
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from wavesplat._model.volume.facts import quantity_of
from wavesplat._readers.components import AXES, LENGTH_NOTE, length_of
from wavesplat._readers.hdf5 import openpmd
from wavesplat._readers.hdf5.openpmd import constant_of
from wavesplat._readers.request import Grid, Request
from wavesplat.errors import ArgumentError, FileError

if TYPE_CHECKING:
    import h5py


def components_of_record(file: h5py.File, request: Request) -> dict[str, str | float]:
    """Axis -> name of its dataset, or its number if it is the same everywhere, of a mesh of openPMD with x, y and z.

    `dataset` names the mesh; empty where it names no such group.
    """
    import h5py

    name = (request.dataset or "").rstrip("/")
    group = file.get(name) if name and isinstance(file.get(name, getlink=True), h5py.HardLink) else None
    if not isinstance(group, h5py.Group):
        return {}
    check_geometry(group, request)
    found: dict[str, str | float] = {}
    for axis in AXES:
        if isinstance(group.get(axis, getlink=True), h5py.HardLink):
            constant = constant_of(group[axis])
            found[axis] = f"{name}/{axis}" if constant is None else constant
    if len(found) > 1 and not any(isinstance(part, str) for part in found.values()):
        raise FileError(f"{request.dataset!r} is the same everywhere, so nothing can be seen of it: {request.path}")
    return found if len(found) > 1 else {}


def component_of_record(components: dict[str, str | float], request: Request) -> Request:
    """The request of the dataset of a component; a `FileError` for one that is the same everywhere."""
    component = components[request.component or ""]
    if isinstance(component, float):
        raise FileError(
            f"component {request.component} of {request.dataset!r} is {component:g} everywhere, so nothing can be seen "
            f"of it; choose another: {request.path}"
        )
    return replace(request, dataset=component, component=None)


def length_of_record(components: dict[str, str | float], request: Request, read: Callable[[Request], Grid]) -> Grid:
    """The length of the vectors of a record; `read` reads a dataset."""
    if request.component not in (None, "magnitude"):
        raise ArgumentError(
            f"component={request.component!r}, but {request.dataset!r} has {', '.join(components)}: {request.path}"
        )
    names = [part for part in components.values() if isinstance(part, str)]
    constants = [part for part in components.values() if not isinstance(part, str)]
    parts = [read(replace(request, dataset=name, component=None)) for name in names]
    first = parts[0]
    if any(part.samples.shape != first.samples.shape for part in parts):
        raise FileError(f"the components of {request.dataset!r} differ in size; choose one of them: {request.path}")
    guesses = list(first.facts.guesses)
    if request.component is None:
        guesses.append(LENGTH_NOTE.format(request.dataset))
    if any(not np.allclose(part.world_from_index, first.world_from_index) for part in parts):
        guesses.append("the components lie at different places of a cell, and are taken as if all lay where x does")
    quantity = quantity_of(request.dataset)
    return Grid(
        length_of([*(part.samples for part in parts), *(np.full_like(first.samples, one) for one in constants)]),
        first.world_from_index,
        replace(first.facts, quantity=f"{quantity} magnitude" if quantity else None, guesses=tuple(guesses)),
        first.losses,
    )


def check_geometry(node: Any, request: Request) -> None:
    """Refuse a mesh of openPMD whose axes are no axes of space."""
    geometry = openpmd.geometry_of(node)
    if geometry == openpmd.NAME:
        raise FileError(
            "the mesh is in cylindrical modes (thetaMode), so its axes are not x, y and z; sample it on a box of N "
            f"samples along its longest side, by resample=N (--resample N): {request.path}"
        )
    if geometry in ("cylindrical", "spherical"):
        raise FileError(
            f"the mesh is of {geometry} coordinates, so its axes are not x, y and z; sample it on a box, and give that "
            f"to wavesplat.Volume: {request.path}"
        )
