"""Meshes of openPMD: records of several components, and cylindrical modes, sampled on a box.

Such a mesh holds a field on a half plane (r, z) as a Fourier series in the angle θ about the axis z:

    F(r, θ, z) = F₀(r, z) + Σₘ [Rₘ(r, z) cos mθ ± Iₘ(r, z) sin mθ],    m = 1, 2, ...

stored as F₀, R₁, I₁, R₂, I₂, ... along the first axis; the attribute geometryParameters says the sign of Iₘ
(`imag=+`). Between its points in r and z the coefficients are linear. Towards the axis they are continued by their
symmetry: r below 0 at θ is the place |r| at θ + π.

Source: https://github.com/openPMD/openPMD-standard, STANDARD.md, "Mesh Based Records"; Lifschitz et al. (2009),
Journal of Computational Physics 228, 1803.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from wavesplat._model.interchange.hdf5 import best_unit, numbers, text
from wavesplat._model.volume.facts import Facts, quantity_of, value_unit_of
from wavesplat._readers.components import AXES, length_of
from wavesplat._readers.request import Grid, Request
from wavesplat._storage import size_checks
from wavesplat.errors import ArgumentError, FileError

if TYPE_CHECKING:
    import h5py

# Meshes of openPMD with several components: their names, and components that are one number everywhere.
#
# Source: https://github.com/openPMD/openPMD-standard, STANDARD.md, "Scalar, Vector and Tensor Records" and "Constant
# Record Components".

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


# Meshes of openPMD in cylindrical modes (`thetaMode`), sampled on a box when `resample` asks for one.

#: The name of this geometry in files.
NAME = "thetaMode"

Numbers = NDArray[np.float64]


@dataclass(frozen=True)
class _Modes:
    """Coefficients of a component's Fourier series, [mode, r, z], and where they lie, in a unit of length."""

    coefficients: NDArray[Any]
    #: Places along r, the first on the axis or beyond it, and along z.
    r: Numbers
    z: Numbers
    unit: str
    #: Sign of the coefficients of sines.
    sign: float


def geometry_of(node: Any) -> str:
    """The geometry of the mesh that a dataset or group is, "cartesian" where it says none."""
    return text(node.attrs.get("geometry", b"cartesian"))


def read(file: h5py.File, request: Request, dataset_of: Callable[[Request], h5py.Dataset]) -> Grid:
    """Samples on a box of the component of a mesh that is asked for, or of the length of its vectors.

    dataset_of : finds and checks the dataset that a request names.
    """
    import h5py

    name = (request.dataset or "").rstrip("/")
    group = file.get(name) if name and isinstance(file.get(name, getlink=True), h5py.HardLink) else None
    parts = [part for part in CYLINDRICAL if part in group] if isinstance(group, h5py.Group) else []
    if parts and len(parts) < len(CYLINDRICAL):
        raise FileError(f"{name!r} has {', '.join(parts)} of the components r, t and z: {request.path}")
    if not parts and request.component is not None:
        raise ArgumentError(
            f"component={request.component!r}, but {request.dataset or 'the dataset'} holds one component; name the "
            f"record, such as dataset='data/1/meshes/E': {request.path}"
        )
    scalar = replace(request, component=None)
    constants = {part: constant_of(group[part]) for part in parts} if group is not None else {}
    vary = [part for part in parts if constants[part] is None]
    if parts and not vary:
        raise FileError(f"{name!r} is the same everywhere, so nothing can be seen of it: {request.path}")
    datasets = [dataset_of(replace(scalar, dataset=f"{name}/{part}")) for part in vary] or [dataset_of(scalar)]
    found = [_modes_of(dataset, request) for dataset in datasets]
    for number, part in enumerate(parts):
        if (constant := constants[part]) is not None:
            found.insert(number, replace(found[0], coefficients=np.full_like(found[0].coefficients, constant)))
    box = _Box.around(found[0], request)
    unit = datasets[0].attrs.get("units")
    value_unit = value_unit_of(None if unit is None else text(unit))
    facts = Facts(unit=found[0].unit, guesses=(box.note,), value_unit=value_unit)
    if not parts:
        quantity = quantity_of(datasets[0].name)
        return Grid(box.sampled(found[0]), box.world_from_index, replace(facts, quantity=quantity))
    component = request.component or "magnitude"
    if request.component is None:
        note = f'{name!r} holds vectors, of which the length is drawn; or component="x" (--component x)'
        facts = replace(facts, guesses=(*facts.guesses, note))
    quantity = f"{quantity_of(name)} {component}"
    return Grid(box.vector(found, component), box.world_from_index, replace(facts, quantity=quantity))


def _modes_of(dataset: h5py.Dataset, request: Request) -> _Modes:
    mesh = dataset if "gridSpacing" in dataset.attrs else dataset.parent
    if dataset.ndim != 3 or dataset.shape[0] % 2 != 1 or min(dataset.shape[1:]) < 2:
        raise FileError(
            f"the mesh is in cylindrical modes, whose arrays have shape (2 m + 1, r, z), and {dataset.name!r} has "
            f"{dataset.shape}; export it again: {request.path}"
        )
    labels = [text(label) for label in np.ravel(mesh.attrs.get("axisLabels", ()))]
    spacing = numbers(mesh, "gridSpacing", np.ones(2))
    offset = numbers(mesh, "gridGlobalOffset", np.zeros(2)) + numbers(dataset, "position", np.zeros(2)) * spacing
    if text(mesh.attrs.get("dataOrder", "C")).upper() == "F":
        labels, spacing, offset = labels[::-1], spacing[::-1], offset[::-1]
    if sorted(labels) != ["r", "z"] or not (spacing > 0).all() or not np.isfinite(offset).all():
        raise FileError(
            f"the mesh is in cylindrical modes, and its axes are {labels}, {spacing.tolist()} apart from "
            f"{offset.tolist()} on; they must be r and z, with distances above 0: {request.path}"
        )
    size_checks.check_memory(3 * size_checks.n_bytes(dataset.shape, np.dtype("f4")), request.path)
    coefficients = dataset[()]
    if labels == ["z", "r"]:
        coefficients, spacing, offset = coefficients.transpose(0, 2, 1), spacing[::-1], offset[::-1]
    unit, factor = best_unit(spacing, float(np.ravel(mesh.attrs.get("gridUnitSI", 1.0))[0]))
    r, z = (
        factor * (first + step * np.arange(n))
        for first, step, n in zip(offset, spacing, coefficients.shape[1:], strict=True)
    )
    parameters = text(mesh.attrs.get("geometryParameters", "")).replace(" ", "")
    sign = -1.0 if "imag=-" in parameters else 1.0
    if r[0] < 0:
        raise FileError(f"the mesh is in cylindrical modes, and its r begins at {r[0]:g}, below 0: {request.path}")
    is_of_plane = dataset.name.rpartition("/")[2] in ("r", "t") and dataset is not mesh
    return _Modes(*_beyond_axis(coefficients, r, is_of_plane=is_of_plane), z, unit, sign)


def _beyond_axis(coefficients: NDArray[Any], r: Numbers, *, is_of_plane: bool) -> tuple[NDArray[Any], Numbers]:
    """Coefficients and places with one more place across the axis, where the first does not lie on it.

    is_of_plane : of the components r and t, whose directions are opposite at θ + π.
    """
    if r[0] == 0:
        return coefficients, r
    modes = (np.arange(len(coefficients)) + 1) // 2
    signs = (-1.0) ** (modes + is_of_plane)
    first = (signs[:, None] * coefficients[:, 0]).astype(coefficients.dtype)
    return np.concatenate([first[:, None], coefficients], axis=1), np.concatenate([[-r[0]], r])


@dataclass(frozen=True)
class _Box:
    """The box that is sampled: places along x, and along y, and along z, evenly spaced."""

    across: Numbers
    along: Numbers
    note: str

    @classmethod
    def around(cls, modes: _Modes, request: Request) -> _Box:
        """The box around the mesh, with as many samples along its longest side as `resample` says."""
        n = request.resample or 2
        radius, length = float(modes.r[-1]), float(modes.z[-1] - modes.z[0])
        step = max(2 * radius, length) / (n - 1)
        n_across, n_along = (max(2, round(side / step) + 1) for side in (2 * radius, length))
        size_checks.check_memory(4 * size_checks.n_bytes((n_along, n_across, n_across), np.dtype("f4")), request.path)
        own = float(modes.r[-1] - modes.r[-2]), float(modes.z[1] - modes.z[0])
        note = (
            f"sampled at {n_across} x {n_across} x {n_along} places, {2 * radius / (n_across - 1):.4g} across and "
            f"{length / (n_along - 1):.4g} along the axis apart, from points {own[0]:.4g} and {own[1]:.4g} apart in "
            f"{(len(modes.coefficients) + 1) // 2} modes; nothing is known beyond the radius {radius:.4g}"
        )
        return cls(np.linspace(-radius, radius, n_across), np.linspace(modes.z[0], modes.z[-1], n_along), note)

    @property
    def world_from_index(self) -> Numbers:
        """The affine from the index (x, y, z) of a sample."""
        steps = [self.across[1] - self.across[0]] * 2 + [self.along[1] - self.along[0]]
        matrix = np.diag([*steps, 1.0])
        matrix[:3, 3] = self.across[0], self.across[0], self.along[0]
        return matrix

    def sampled(self, modes: _Modes) -> NDArray[np.float32]:
        """The field at every place, NaN beyond the mesh's radius."""
        x, y = np.meshgrid(self.across, self.across)
        r, theta = np.hypot(x, y), np.arctan2(y, x)
        inside = r <= modes.r[-1] * (1 + 1e-12)
        below, share = _between(np.minimum(r[inside], modes.r[-1]), modes.r)
        waves = [np.ones(len(below))]
        for m in range(1, (len(modes.coefficients) + 1) // 2):
            waves += [np.cos(m * theta[inside]), modes.sign * np.sin(m * theta[inside])]
        samples = np.full((len(self.along), *r.shape), np.nan, np.float32)
        for layer, z, part in zip(samples, *_between(self.along, modes.z), strict=True):
            here = (1 - part) * modes.coefficients[:, :, z] + part * modes.coefficients[:, :, z + 1]
            values = (1 - share) * here[:, below] + share * here[:, below + 1]
            layer[inside] = np.einsum("mn,mn->n", waves, values)
        return samples

    def vector(self, modes: list[_Modes], component: str) -> NDArray[np.float32]:
        """A component x, y or z of a vector with components r, t and z, or its length."""
        radial, around, along = modes
        if component == "z":
            return self.sampled(along)
        away, turned = self.sampled(radial), self.sampled(around)
        if component == "magnitude":
            length: NDArray[np.float32] = length_of([away, turned, self.sampled(along)])
            return length
        x, y = np.meshgrid(self.across, self.across)
        theta = np.arctan2(y, x)
        cos, sin = np.cos(theta).astype(np.float32), np.sin(theta).astype(np.float32)
        return cos * away - sin * turned if component == "x" else sin * away + cos * turned


def _between(places: Numbers, nodes: Numbers) -> tuple[NDArray[np.intp], Numbers]:
    """For every place the node at or before it, and its share of the way to the next one."""
    below = np.clip(np.searchsorted(nodes, places, side="right") - 1, 0, len(nodes) - 2)
    return below, (places - nodes[below]) / (nodes[below + 1] - nodes[below])
