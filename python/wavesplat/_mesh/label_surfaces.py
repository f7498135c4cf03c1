"""A closed, smooth surface of each label, which encloses as much as the label's samples do.

Marching cubes of a label's mask follow its samples as stairs. A windowed sinc (`windowed_sinc`) takes the stairs away:
its pass band is 10^(-4 smoothing) with 20 + 40 smoothing iterations, as in 3D Slicer, and wider for parts so thin that
they would shrink, by their radius 3 V / A in samples: the first modes of a ball of that radius pass.
Then all vertices move along their normals by the same length until the volume equals the volume of the
samples: stairs of balls and edges of plates lose a share of it, single rows of samples half.

With W the mean over a vertex' neighbours and K = 1 - W, whose eigenvalues k lie in 0..2, a polynomial f(K) multiplies
each natural frequency of the mesh by f(k). Taubin, Zhang and Golub choose Chebyshev polynomials,

    f(k) = sum_n w_n c_n T_n(1 - k / 2),   c_0 = theta / pi,   c_n = 2 sin(n theta) / (n pi),

the Fourier series of a step at theta = arccos(1 - k_pb / 2) + sigma, with a Hamming window w_n = 0.54 + 0.46 cos(n pi /
(N + 1)); sigma is the smallest for which f(k_pb) = 1. Products with K are recursive:
T_{n+1} = 2 (1 - K / 2) T_n - T_{n-1}.

Parts of a mesh that do not touch have a pass band each. Source: Optimal surface smoothing as filter design (ECCV 1996);
VTK's vtkWindowedSincPolyDataFilter is the same filter.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wavesplat._geometry.surface import face_vectors, normals_of_faces
from wavesplat._looks.labels.labels import Labels
from wavesplat._mesh.isosurface import isosurface
from wavesplat._mesh.triangle_mesh import Mesh
from wavesplat._model.volume.volume import Volume
from wavesplat._system.libraries import library
from wavesplat._system.values import described
from wavesplat.errors import ArgumentError

# Smoothing of surfaces by a windowed sinc: a low-pass filter on the graph of a mesh, which keeps shapes.

Floats = NDArray[np.float64]

#: f(k_pb), nearly 1, as in VTK.
PASSED = 0.999


def parts_of(n_vertices: int, faces: NDArray[np.int32]) -> tuple[int, NDArray[np.int32]]:
    """The number of parts of a mesh that do not touch, and the part of each vertex."""
    graph = library("scipy.sparse.csgraph", extra="mesh")
    n, part = graph.connected_components(_neighbours(n_vertices, faces), directed=False)
    return int(n), part


def smoothed(
    positions: Floats,
    faces: NDArray[np.int32],
    part: NDArray[np.int32],
    pass_bands: Floats,
    n_iterations: int,
) -> Floats:
    """The positions, shape (n, 3), filtered; `pass_bands` of each part, in 0..2, where 2 lets all pass."""
    weights = np.array([_coefficients(band, n_iterations) for band in pass_bands])[part]  # [vertex, n]
    neighbours = _neighbours(len(positions), faces)
    counts = np.asarray(neighbours.sum(axis=1)).ravel()
    mean_of = library("scipy.sparse", extra="mesh").diags(1.0 / np.maximum(counts, 1)) @ neighbours
    middle = positions.mean(axis=0)  # small numbers lose no digits
    before = positions - middle
    # 1 - K / 2 = (1 + W) / 2.
    here = 0.5 * (before + mean_of @ before)
    result = weights[:, :1] * before + weights[:, 1:2] * here
    for n in range(2, n_iterations + 1):
        before, here = here, here + mean_of @ here - before
        result += weights[:, n : n + 1] * here
    return np.asarray(result + middle)


def _neighbours(n_vertices: int, faces: NDArray[np.int32]) -> Any:
    """The graph of a mesh as a sparse matrix of 1 for each edge."""
    sparse = library("scipy.sparse", extra="mesh")
    ends = np.concatenate([faces[:, pair] for pair in ([0, 1], [1, 2], [2, 0])])
    ends = np.concatenate([ends, ends[:, ::-1]])
    matrix = sparse.coo_matrix((np.ones(len(ends)), (ends[:, 0], ends[:, 1])), shape=(n_vertices, n_vertices)).tocsr()
    matrix.data[:] = 1.0  # edges that two triangles share
    return matrix


def _coefficients(band: float, n: int) -> Floats:
    """The weights w_n c_n of the Chebyshev polynomials, with the smallest sigma that lets the pass band pass."""
    orders = np.arange(1, n + 1)
    window = 0.54 + 0.46 * np.cos(orders * math.pi / (n + 1))
    edge = math.acos(1.0 - band / 2)
    # The window's step is as wide as 2 pi / n to either side; beyond it f swings about 1.
    thetas = edge + np.linspace(0.0, 3 * math.pi / (n + 1), 300)[:, None]
    weights = np.hstack([thetas / math.pi, window * 2.0 * np.sin(orders * thetas) / (orders * math.pi)])
    passed = weights @ np.cos(np.arange(n + 1) * edge)
    return np.asarray(weights[int(np.argmax(passed >= PASSED)) if (passed >= PASSED).any() else int(passed.argmax())])


# A closed, smooth surface of each label, which encloses as much as the label's samples do.

#: Pass band of a part times its squared radius in samples; measured on balls of radius 1.5 to 40: normals are within 17
#: to 1 degrees of the ball's, against 17 to 15 without the filter, which takes less than 1 % of the volume.
BAND_OF_RADIUS = 2.0
#: Pass band from which on the filter changes nothing that can be seen.
MAX_BAND = 1.9
#: Steps of the search for the volume, and the relative error at which it ends.
N_STEPS, VOLUME_ERROR = 20, 1e-4
#: Labels that a message lists, at most.
N_LISTED = 20


def chosen_numbers(labels: Labels, which: Any) -> list[int]:
    """The numbers of the labels that are asked for, in order: "all", or numbers and names.

    Raises
    ------
    ArgumentError
        If there is no such label; the message lists those that there are.
    """
    known = [number for number in labels.numbers if number != 0]
    if isinstance(which, str) and which == "all":
        if not known:
            raise ArgumentError("the segmentation holds no label: every sample is 0")
        return known
    wanted = [which] if isinstance(which, str | int | np.integer) else which
    if not isinstance(wanted, Iterable):
        raise ArgumentError(f'labels is {described(which)}; give "all", or numbers and names in a list')
    numbers = {_number(one, labels, known) for one in wanted}
    if not numbers:
        raise ArgumentError('labels is empty; give "all", or numbers and names')
    return sorted(numbers)


def _number(label: Any, labels: Labels, known: list[int]) -> int:
    names = {number: look.name for number, look in labels.labels.items() if number in known}
    if isinstance(label, str):
        alike = [number for number, name in names.items() if name == label]
        alike = alike or [number for number, name in names.items() if name.casefold() == label.casefold()]
        if len(alike) == 1:
            return alike[0]
        if len(alike) > 1:
            raise ArgumentError(f"{len(alike)} labels are named {label!r}: {', '.join(map(str, alike))}; give a number")
        if label.lstrip("-").isdecimal() and int(label) in known:
            return int(label)
    elif isinstance(label, int | np.integer) and int(label) in known:
        return int(label)
    listed = [str(n) if names.get(n, str(n)) == str(n) else f"{n} {names[n]!r}" for n in known]
    more = ", ..." if len(listed) > N_LISTED else ""
    raise ArgumentError(f"there is no label {described(label)}; there are {', '.join(listed[:N_LISTED])}{more}")


def surface_of(
    labels: Labels, number: int, box: tuple[slice, slice, slice], *, smoothing: float, unit: str | None
) -> Mesh:
    """The closed mesh of a label. `box`: the smallest that holds its samples, [z, y, x]."""
    mask = np.pad(labels._codes[box] == labels.numbers.index(number), 1)
    matrix = np.eye(4) if labels.world_from_index is None else np.array(labels.world_from_index)
    first = np.array([part.start - 1 for part in box[::-1]], np.float64)
    found = isosurface(Volume(mask.view(np.uint8), name="label"), 0.5, step=1, crop=None)
    positions = found.positions
    if smoothing > 0:
        n_parts, part = parts_of(len(positions), found.faces)
        bands = _pass_bands(positions, found.faces, part, n_parts, smoothing)
        if (bands < MAX_BAND).any():
            positions = smoothed(positions, found.faces, part, np.minimum(bands, MAX_BAND), round(20 + 40 * smoothing))
    vertices = (positions + first) @ matrix[:3, :3].T + matrix[:3, 3]
    determinant = float(np.linalg.det(matrix[:3, :3]))
    faces = np.ascontiguousarray(found.faces[:, ::-1] if determinant < 0 else found.faces, np.int32)
    vertices = _with_volume(vertices, faces, float(np.count_nonzero(mask)) * abs(determinant))
    normals = normals_of_faces(vertices, faces)
    lengths = np.linalg.norm(normals, axis=1, keepdims=True)
    look = labels.labels.get(number)
    return Mesh(
        vertices,
        faces,
        normals / np.where(lengths > 0, lengths, 1),
        name=(look.name if look is not None else "") or str(number),
        color=None if look is None else look.color,
        unit=unit,
    )


def boxes_of(labels: Labels) -> dict[int, tuple[slice, slice, slice]]:
    """The smallest boxes that hold the samples of each label, [z, y, x]."""
    codes = labels._codes.astype(np.int32) + 1
    found = library("scipy.ndimage", extra="mesh").find_objects(codes)
    return {number: box for number, box in zip(labels.numbers, found, strict=True) if box is not None}


def _pass_bands(
    positions: Floats, faces: NDArray[np.int32], part: NDArray[np.int32], n_parts: int, smoothing: float
) -> Floats:
    """The pass band of each part of a surface, by its radius in samples."""
    vectors = face_vectors(positions, faces)
    of_face = part[faces[:, 0]]
    areas = np.bincount(of_face, 0.5 * np.linalg.norm(vectors, axis=1), n_parts)
    sums = np.stack([np.bincount(part, positions[:, axis], n_parts) for axis in range(3)], axis=1)
    middle = sums / np.bincount(part, minlength=n_parts)[:, None]
    heights = np.einsum("ij,ij->i", positions[faces[:, 0]] - middle[of_face], vectors)
    volumes = np.abs(np.bincount(of_face, heights, n_parts) / 6)  # of a hollow the surface is turned inside out
    radii = 3 * volumes / np.maximum(areas, 1e-9)
    bands: Floats = np.maximum(10.0 ** (-4 * smoothing), BAND_OF_RADIUS / np.maximum(radii, 1e-3) ** 2)
    return bands


def _with_volume(vertices: Floats, faces: NDArray[np.int32], volume: float) -> Floats:
    """The vertices moved along their normals, all by one length, until they enclose a volume."""
    for _ in range(N_STEPS):
        vectors = face_vectors(vertices, faces)
        middle = vertices.mean(axis=0)
        missing = volume - float(np.einsum("ij,ij->", vertices[faces[:, 0]] - middle, vectors)) / 6
        if abs(missing) <= VOLUME_ERROR * volume:
            break
        normals = normals_of_faces(vertices, faces)
        normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-30)
        vertices = vertices + missing / max(0.5 * float(np.linalg.norm(vectors, axis=1).sum()), 1e-30) * normals
    return vertices
