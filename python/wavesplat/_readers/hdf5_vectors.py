"""Vectors in HDF5: an array whose last axis has three components, or a record of openPMD with a dataset for each.

Source of records: https://github.com/openPMD/openPMD-standard, STANDARD.md, "Scalar, Vector and Tensor Records".
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from wavesplat._model.facts import quantity_of
from wavesplat._readers import theta_modes
from wavesplat._readers.components import AXES, length_of
from wavesplat._readers.request import Grid, Request
from wavesplat.errors import ArgumentError, FileError

if TYPE_CHECKING:
    import h5py

__all__ = ["TOLD", "check_geometry", "components_of_record", "length_of_record"]

#: Openings of a sentence about vectors of which no component is chosen.
TOLD = '{!r} holds vectors, of which the length is drawn; or component="x" (--component x)'


def components_of_record(file: h5py.File, request: Request) -> dict[str, str]:
    """Axis -> name of its dataset, where `dataset` names a group of openPMD with x, y and z; empty elsewhere."""
    import h5py

    name = (request.dataset or "").rstrip("/")
    group = file.get(name) if name and isinstance(file.get(name, getlink=True), h5py.HardLink) else None
    if not isinstance(group, h5py.Group):
        return {}
    check_geometry(group, request)
    found = {axis: f"{name}/{axis}" for axis in AXES if isinstance(group.get(axis, getlink=True), h5py.HardLink)}
    return found if len(found) > 1 else {}


def length_of_record(components: dict[str, str], request: Request, read: Callable[[Request], Grid]) -> Grid:
    """The component of a record that is asked for, or the length of its vectors; `read` reads a dataset."""
    if request.component in components:
        return read(replace(request, dataset=components[request.component], component=None))
    if request.component not in (None, "magnitude"):
        raise ArgumentError(
            f"component={request.component!r}, but {request.dataset!r} has {', '.join(components)}: {request.path}"
        )
    parts = [read(replace(request, dataset=name, component=None)) for name in components.values()]
    first = parts[0]
    if any(part.samples.shape != first.samples.shape for part in parts):
        raise FileError(f"the components of {request.dataset!r} differ in size; choose one of them: {request.path}")
    guesses = list(first.facts.guesses)
    if request.component is None:
        guesses.append(TOLD.format(request.dataset))
    if any(not np.allclose(part.world_from_index, first.world_from_index) for part in parts):
        guesses.append("the components lie at different places of a cell, and are taken as if all lay where x does")
    quantity = quantity_of(request.dataset)
    return Grid(
        length_of([part.samples for part in parts]),
        first.world_from_index,
        replace(first.facts, quantity=f"{quantity} magnitude" if quantity else None, guesses=tuple(guesses)),
        first.losses,
    )


def check_geometry(node: Any, request: Request) -> None:
    """Refuse a mesh of openPMD whose axes are no axes of space."""
    geometry = theta_modes.geometry_of(node)
    if geometry == theta_modes.NAME:
        raise FileError(
            "the mesh is in cylindrical modes (thetaMode), so its axes are not x, y and z; sample it on a box of N "
            f"samples along its longest side, by resample=N (--resample N): {request.path}"
        )
    if geometry in ("cylindrical", "spherical"):
        raise FileError(
            f"the mesh is of {geometry} coordinates, so its axes are not x, y and z; sample it on a box, and give that "
            f"to wavesplat.Volume: {request.path}"
        )
