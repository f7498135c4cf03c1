"""Smoothing of surfaces by a windowed sinc: a low-pass filter on the graph of a mesh, which keeps shapes.

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
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wavesplat._files.libraries import library

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
