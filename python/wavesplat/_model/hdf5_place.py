"""Place of an HDF5 dataset's samples: by `element_size_um`, or as a mesh of openPMD; HDF5 itself defines none.

openPMD: the attributes axisLabels, gridSpacing, gridGlobalOffset and gridUnitSI of a mesh, whose components may be
datasets below it. Source: https://github.com/openPMD/openPMD-standard, STANDARD.md, "Mesh Based Records".
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from wavesplat._model import units
from wavesplat._model.facts import Facts

if TYPE_CHECKING:
    import h5py


@dataclass(frozen=True)
class Place:
    """Affine, facts, and the numbers of z, y and x among the last three axes of the array."""

    world_from_index: NDArray[np.float64]
    facts: Facts
    zyx: tuple[int, int, int] = (0, 1, 2)


def place_of(dataset: h5py.Dataset) -> Place:
    """The place by a dataset's attributes, or those of the mesh it is a component of; the identity without any."""
    sizes = dataset.attrs.get("element_size_um")
    if sizes is not None and np.size(sizes) == 3:
        z, y, x = (float(size) for size in np.ravel(sizes))
        return Place(_diagonal((x, y, z)), Facts(unit="um"))
    mesh = next((node for node in (dataset, dataset.parent) if "gridSpacing" in node.attrs), None)
    if mesh is not None and np.size(mesh.attrs["gridSpacing"]) == 3 and np.size(mesh.attrs.get("axisLabels", ())) == 3:
        return _of_mesh(mesh, dataset)
    return Place(np.eye(4), Facts())


def _of_mesh(mesh: Any, component: h5py.Dataset) -> Place:
    labels = [text(label) for label in np.ravel(mesh.attrs["axisLabels"])]
    spacing = np.ravel(mesh.attrs["gridSpacing"]).astype(np.float64)
    offset = numbers(mesh, "gridGlobalOffset", np.zeros(3)) + numbers(component, "position", np.zeros(3)) * spacing
    if text(mesh.attrs.get("dataOrder", "C")).upper() == "F":
        # Their first axis is the fastest: in the array it is the last one.
        labels, spacing, offset = labels[::-1], spacing[::-1], offset[::-1]
    guesses: tuple[str, ...] = ()
    if sorted(labels) != ["x", "y", "z"]:
        guesses = (f"axes {', '.join(labels)} drawn as z, y, x, in their order in the file",)
        labels = ["z", "y", "x"]
    to_xyz = [labels.index(name) for name in "xyz"]
    unit, factor = best_unit(spacing, float(np.ravel(mesh.attrs.get("gridUnitSI", 1.0))[0]))
    matrix = _diagonal(tuple(spacing[to_xyz] * factor))
    matrix[:3, 3] = offset[to_xyz] * factor
    z, y, x = (labels.index(name) for name in "zyx")
    return Place(matrix, Facts(unit=unit, guesses=guesses), (z, y, x))


def best_unit(spacing: NDArray[np.float64], metres: float) -> tuple[str, float]:
    """The largest unit in which the finest spacing is 0.01 or more, and the factor that converts lengths to it."""
    finest = float(np.abs(spacing).min()) * metres
    unit = next((unit for unit in ("m", "mm", "um", "nm") if finest >= 0.01 * units.METRES[unit]), "pm")
    return unit, float(f"{metres / units.METRES[unit]:.12g}")


def _diagonal(xyz: tuple[float, ...]) -> NDArray[np.float64]:
    """The affine of these steps, unchecked: the volume refuses steps that are zero or not finite."""
    return np.diag([*xyz, 1.0])


def numbers(node: Any, name: str, default: NDArray[np.float64]) -> NDArray[np.float64]:
    """The numbers of an attribute, or `default` where it has not as many."""
    value = np.ravel(node.attrs.get(name, default))
    return value.astype(np.float64) if value.size == default.size else default


def text(value: Any) -> str:
    """An attribute as text."""
    return value.decode("utf-8", "replace") if isinstance(value, bytes) else str(value)
