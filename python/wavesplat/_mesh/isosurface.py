"""Surfaces of equal value in index space, as triangles.

scikit-image finds the triangles, by the marching cubes of Lewiner et al. (2003), whose ambiguous cells follow the
trilinear interpolant that the renderer draws. Only the triangles are taken from it: vertices are placed here, in double
precision. Each lies on the edge between a sample inside and one outside, at the share `t` of the way where the linear
interpolant has the wanted value,

    t = (v_inside - iso) / (v_inside - v_outside),

or where the edge leaves the crop box, if that comes first. At the volume's own faces and at holes (NaN) there is no
sample outside; the surface is closed there just behind the last sample. Both ends of an edge are kept `MIN_SHARE`
away, so that vertices stay distinct in files of float32 coordinates, also where samples have exactly the wanted value.

Source: T. Lewiner, H. Lopes, A. W. Vieira, G. Tavares, *Efficient implementation of marching cubes' cases with
topological guarantees*, Journal of Graphics Tools 8 (2003).
"""

from __future__ import annotations

from collections.abc import Iterator
from itertools import product
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from wavesplat._model.arguments.clips import Crop
from wavesplat._model.volume.volume import Volume
from wavesplat._system.libraries import library
from wavesplat.errors import ArgumentError

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]
Faces = NDArray[np.int32]

#: Least distance of a vertex from a sample, as a share of that to the next: ten float32 steps at index 1000.
MIN_SHARE = 1e-3


class Isosurface(NamedTuple):
    """Triangles in index space.

    positions : shape (n, 3), index coordinates (x, y, z).
    gradients : shape (n, 3), the volume's, per index; 0 on cuts.
    on_cut : shape (n,), whether a vertex only closes the surface at the crop box, a hole, or the volume's faces.
    faces : shape (m, 3), counter-clockwise seen from outside where the index axes are right-handed.
    """

    positions: Floats
    gradients: Floats
    on_cut: NDArray[np.bool_]
    faces: Faces


def isosurface(volume: Volume, iso_value: float, *, step: int, crop: Crop | None) -> Isosurface:
    """The closed surface around all samples larger than `iso_value`; see `mesh`."""
    lattice = Lattice.of(volume, step, crop)
    field = _signed_field(volume, iso_value, lattice)
    if not (field > 0).any():
        raise ArgumentError(
            f"volume {volume.name!r}: no sample in the crop box is larger than the iso value {iso_value:g}; "
            "move or widen the box, or take another value or a smaller step"
        )
    found, faces, _, _ = library("skimage.measure", extra="mesh").marching_cubes(field, 0.0)
    start, end, on_edge = _edges(lattice, field, found[:, ::-1])
    surface = Isosurface(np.zeros(found.shape), np.zeros(found.shape), np.zeros(len(found), bool), faces)
    share, cut = _shares(volume, iso_value, lattice.planes, start, end)
    share = np.clip(share, MIN_SHARE, 1 - MIN_SHARE)[:, None]
    surface.positions[on_edge] = start + share * (end - start)
    surface.on_cut[on_edge] = cut
    kept = ~cut
    before, after = _gradient(volume, start[kept]), _gradient(volume, end[kept])
    surface.gradients[on_edge[kept]] = (1 - share[kept]) * before + share[kept] * after
    _fill_middles(surface, np.setdiff1d(np.arange(len(found)), on_edge, assume_unique=True))
    return _parted(surface)


# The samples that take part ------------------------------------------------------------------------------------------


class Lattice(NamedTuple):
    """The samples that take part, and the planes of the crop box.

    axes : for z, y, x, the indices of the samples, with one more on either side, which may lie outside the volume.
    planes : shape (k, 4); the crop box is where `n . index + d >= 0` for each (n_x, n_y, n_z, d).
    """

    axes: tuple[Ints, Ints, Ints]
    planes: Floats

    @classmethod
    def of(cls, volume: Volume, step: int, crop: Crop | None) -> Lattice:
        planes, lower, upper = _crop_planes(volume, crop)
        z, y, x = (_axis(n, step, lower[axis], upper[axis]) for n, axis in zip(volume.shape, (2, 1, 0), strict=True))
        return cls((z, y, x), planes)

    def slices(self, volume: Volume) -> Iterator[tuple[int, NDArray[Any]]]:
        """Positions and samples [y, x] of the slices that lie in the volume, cut to the rows and columns of `core`."""
        z, y, x = self.axes
        rows, columns = y[self.core(1, volume)], x[self.core(2, volume)]
        for position in np.flatnonzero((z >= 0) & (z < volume.shape[0])):
            yield int(position), volume.samples[z[position]][np.ix_(rows, columns)]

    def core(self, axis: int, volume: Volume) -> slice:
        """The part of an axis that lies in the volume."""
        inside = np.flatnonzero((self.axes[axis] >= 0) & (self.axes[axis] < volume.shape[axis]))
        return slice(int(inside[0]), int(inside[-1]) + 1)

    def uncut(self, z: int, y: Ints, x: Ints) -> NDArray[np.bool_]:
        """Whether samples of slice z lie in the crop box, [y, x]."""
        within = np.ones((y.size, x.size), bool)
        for n_x, n_y, n_z, offset in self.planes:
            within &= (n_y * y[:, None] + n_x * x) + (n_z * z + offset) >= 0
        return within


def _crop_planes(volume: Volume, crop: Crop | None) -> tuple[Floats, Floats, Floats]:
    """The crop box as planes in index space, and its bounds there."""
    if crop is None:
        return np.empty((0, 4)), np.zeros(3), np.array(volume.shape[::-1]) - 1.0
    corners = np.sort([crop.lower, crop.upper], axis=0)
    space_from_index = volume.world_from_index if crop.space == "world" else np.eye(4)
    # Distances from the lower faces, then from the upper ones.
    lower, upper = space_from_index[:3].copy(), -space_from_index[:3]
    lower[:, 3] -= corners[0]
    upper[:, 3] += corners[1]
    box = np.array([[corners[side][axis] for axis, side in enumerate(sides)] for sides in product((0, 1), repeat=3)])
    in_index = np.column_stack([box, np.ones(8)]) @ np.linalg.inv(space_from_index).T
    return np.vstack([lower, upper]), in_index[:, :3].min(axis=0), in_index[:, :3].max(axis=0)


def _axis(n: int, step: int, lower: float, upper: float) -> Ints:
    """Every n-th index and the last, one outside on either side, from the last below `lower` to the first above."""
    last = (n - 1) // step * step
    tail = [n - 1] if last < n - 1 else []
    indices = np.array([-1, *range(0, n, step), *tail, n], np.intp)
    slack = 1e-6  # bounds of a box in the world are rounded
    first = int(np.clip(np.searchsorted(indices, lower - slack) - 1, 0, indices.size - 3))
    end = int(np.clip(np.searchsorted(indices, upper + slack, side="right") + 1, first + 3, indices.size))
    return indices[first:end]


def _signed_field(volume: Volume, iso_value: float, lattice: Lattice) -> NDArray[np.float32]:
    """The field for marching cubes: above 0 inside, below 0 outside, never near 0 and nowhere equal by chance.

    Only the triangles depend on it, so it may be bent: magnitudes are kept within a ratio of 1000, for the edge of a
    vertex to show in float32 coordinates, and are noisy by a thousandth, since the library's tests of ambiguous faces
    can leave cracks where products of samples are exactly equal, as in masks of 0 and 1.
    """
    noise = np.random.default_rng(0)
    low, high = volume.value_range
    largest = max(high - iso_value, iso_value - low)
    coarse = volume._every(max(1, round((volume.samples.size / 1e5) ** (1 / 3)))).astype(np.float64)
    typical = float(np.abs(coarse[np.isfinite(coarse)] - iso_value).mean()) if np.isfinite(coarse).any() else largest
    z, y, x = lattice.axes
    rows, columns = lattice.core(1, volume), lattice.core(2, volume)
    field = np.full((z.size, y.size, x.size), -1, np.float32)
    for position, samples in lattice.slices(volume):
        values = samples.astype(np.float64) - iso_value
        known = np.isfinite(values) & lattice.uncut(z[position], y[rows], x[columns])
        size = np.where(known, np.clip(np.abs(values) / (typical or largest), 0.01, 10), 1)
        size *= noise.uniform(0.999, 1.001, size.shape)
        field[position, rows, columns] = np.where(known & (values > 0), size, -size)
    return field


# Vertices ------------------------------------------------------------------------------------------------------------


def _edges(lattice: Lattice, field: NDArray[np.float32], found: NDArray[np.float32]) -> tuple[Ints, Ints, Ints]:
    """The samples (x, y, z), inside and outside, between which vertices lie, and the numbers of those vertices.

    `found` are the library's vertices, places (x, y, z) in the lattice. Vertices on no edge lie within ambiguous cells.
    """
    low = np.floor(found).astype(np.intp)
    steps = found > low
    on_edge = np.flatnonzero(steps.sum(axis=1) == 1)
    start, end = low[on_edge], low[on_edge] + steps[on_edge]
    swapped = field[start[:, 2], start[:, 1], start[:, 0]] < 0
    start[swapped], end[swapped] = end[swapped], start[swapped]
    axes = lattice.axes[::-1]
    start, end = (np.stack([axes[a][places[:, a]] for a in range(3)], axis=1) for places in (start, end))
    return start, end, on_edge


def _shares(
    volume: Volume, iso_value: float, planes: Floats, start: Ints, end: Ints
) -> tuple[Floats, NDArray[np.bool_]]:
    """Places of the surface along the edges, 0..1, and whether a cut comes before it."""
    value, beyond = (_samples_at(volume, places) - iso_value for places in (start, end))
    surface = np.full(value.shape, np.inf)
    np.divide(value, value - beyond, out=surface, where=beyond <= 0)
    # At a hole or a face of the volume the inside ends at once.
    cut = np.where(np.isnan(beyond), 0, np.inf)
    for plane in planes:
        here, there = (places @ plane[:3] + plane[3] for places in (start, end))
        leaves = there < 0
        cut[leaves] = np.minimum(cut[leaves], here[leaves] / (here[leaves] - there[leaves]))
    return np.minimum(surface, cut), cut <= surface


def _samples_at(volume: Volume, places: Ints) -> Floats:
    """Samples at indices (x, y, z); NaN for those that are not finite or lie outside the volume."""
    limits = np.array(volume.shape[::-1]) - 1
    x, y, z = np.clip(places, 0, limits).T
    values: Floats = volume.samples[z, y, x].astype(np.float64)
    values[~np.isfinite(values) | (places < 0).any(axis=1) | (places > limits).any(axis=1)] = np.nan
    return values


def _gradient(volume: Volume, places: Ints) -> Floats:
    """Central differences at samples, per index; one-sided at holes and at the volume's faces."""
    here = _samples_at(volume, places)
    gradient = np.empty(places.shape)
    for axis, step in enumerate(np.eye(3, dtype=np.intp)):
        after, before = _samples_at(volume, places + step), _samples_at(volume, places - step)
        known = np.isfinite(after).astype(np.float64) + np.isfinite(before)
        difference = np.where(np.isnan(after), here, after) - np.where(np.isnan(before), here, before)
        gradient[:, axis] = difference / np.maximum(known, 1)
    return gradient


def _fill_middles(surface: Isosurface, middles: Ints) -> None:
    """Place vertices inside ambiguous cells at the mean of those that they are joined with."""
    if middles.size == 0:
        return
    number = np.full(len(surface.positions), -1)
    number[middles] = np.arange(middles.size)
    touching = surface.faces[(number[surface.faces] >= 0).any(axis=1)]
    joined = np.concatenate([touching[:, pair] for pair in ([0, 1], [1, 0], [1, 2], [2, 1], [2, 0], [0, 2])])
    joined = joined[(number[joined[:, 0]] >= 0) & (number[joined[:, 1]] < 0)]
    rows, others = number[joined[:, 0]], joined[:, 1]
    counts = np.bincount(rows, minlength=middles.size)
    for values in (surface.positions, surface.gradients):
        for axis in range(3):
            values[middles, axis] = np.bincount(rows, values[others, axis], middles.size) / counts
    surface.on_cut[middles] = np.bincount(rows, surface.on_cut[others], middles.size) > 0


def _parted(surface: Isosurface) -> Isosurface:
    """Part sheets that touch along an edge, which would then join four triangles, by a vertex in its middle.

    The library makes such an edge in a few cells of pure noise: 3 in 60 volumes of 40 x 40 x 40 random samples.
    """
    while True:
        pairs = _touching(surface)
        if not pairs:  # none, or not closed in another way, which `Mesh.watertight` reports
            return surface
        n_vertices = len(surface.positions)
        faces, added = surface.faces.copy(), []
        for middle, pair in enumerate(pairs, n_vertices):
            for face, corner in pair:
                rest = faces[face].copy()
                rest[corner] = middle
                added.append(rest)
                faces[face, (corner + 1) % 3] = middle
        ends = np.array([[surface.faces[face, corner] for face, corner in pair] for pair in pairs])
        surface = Isosurface(
            np.vstack([surface.positions, surface.positions[ends].mean(axis=1)]),
            np.vstack([surface.gradients, surface.gradients[ends].mean(axis=1)]),
            np.append(surface.on_cut, surface.on_cut[ends].any(axis=1)),
            np.vstack([faces, added]),
        )


def _touching(surface: Isosurface) -> list[list[tuple[int, int]]]:
    """Pairs of triangles that share an edge with another such pair, as (face, corner where the edge starts).

    No triangle is named twice: further pairs of a triangle are found in the next round.
    """
    faces = surface.faces
    edges = (faces.astype(np.int64) * len(surface.positions) + np.roll(faces, -1, axis=1)).ravel()
    order = np.argsort(edges, kind="stable")
    repeated = order[1:][edges[order[1:]] == edges[order[:-1]]]
    places = {(int(faces[e // 3, e % 3]), int(faces[e // 3, (e + 1) % 3])): divmod(int(e), 3) for e in repeated}
    pairs, named = [], set[int]()
    for (start, end), place in places.items():
        other = places.get((end, start))
        if start < end and other is not None and not named & {place[0], other[0]}:
            named |= {place[0], other[0]}
            pairs.append([place, other])
    return pairs
