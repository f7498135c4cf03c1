"""Meshes of openPMD with several components: their names, and components that are one number everywhere.

Source: https://github.com/openPMD/openPMD-standard, STANDARD.md, "Scalar, Vector and Tensor Records" and "Constant
Record Components".
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from wavesplat._readers.components import AXES
from wavesplat._readers.request import Request

if TYPE_CHECKING:
    import h5py

#: Components of a vector about the axis: away from it, around it, along it.
CYLINDRICAL = ("r", "t", "z")


def records_of(file: h5py.File) -> dict[str, tuple[str, ...]]:
    """Name of each mesh of openPMD with several components -> their names, where one at least has samples."""
    import h5py

    found: dict[str, tuple[str, ...]] = {}

    def visit(name: str, node: Any) -> None:
        if not isinstance(node, h5py.Group) or "gridSpacing" not in node.attrs:
            return
        own = [part for part in node if isinstance(node.get(part, getlink=True), h5py.HardLink)]
        parts = [part for part in own if isinstance(node[part], h5py.Dataset) and node[part].ndim >= 3]
        if parts and len(own) > 1 and set(own) <= {*AXES, *CYLINDRICAL}:
            found[name] = tuple(own)

    file.visititems(visit)
    return found


def with_record(file: h5py.File, request: Request) -> Request:
    """The request with the name of the mesh that it means: by its last part, or the only one of the file."""
    name = request.dataset
    if name is not None and (name.strip("/") in file or "/" in name.strip("/")):
        return request
    if name is None and "data" not in file:
        return request  # no openPMD: a large file is not searched twice
    records = records_of(file)
    if name is None:
        others = [one for one in names_of_volumes(file) if one.rpartition("/")[0] not in records]
        meant = list(records) if not others else []
    else:
        meant = [one for one in records if one.rpartition("/")[2] == name]
    return replace(request, dataset=meant[0]) if len(meant) == 1 else request


def names_of_volumes(file: h5py.File) -> list[str]:
    """Names of the datasets of numbers with three or more axes."""
    import h5py

    found: list[str] = []

    def visit(name: str, node: Any) -> None:
        if isinstance(node, h5py.Dataset) and node.ndim >= 3 and node.dtype.kind in "biuf":
            found.append(name)

    file.visititems(visit)
    return found


def constant_of(node: Any) -> float | None:
    """The number that a constant component of openPMD is everywhere, which has no dataset; None of others."""
    value = None if hasattr(node, "dtype") else node.attrs.get("value")
    return None if value is None or np.size(value) != 1 else float(np.ravel(value)[0])
