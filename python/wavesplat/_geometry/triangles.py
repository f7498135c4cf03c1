"""Areas and normals of triangles that share vertices."""

from __future__ import annotations

from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from wavesplat import _native

Floats: TypeAlias = NDArray[np.float64]


def face_vectors(vertices: Floats, faces: NDArray[Any]) -> Floats:
    """Outward vectors of twice the faces' areas."""
    a, b, c = (vertices[faces[:, corner]] for corner in range(3))
    vectors: Floats = np.cross(b - a, c - a)
    return vectors


def normals_of_faces(vertices: Floats, faces: NDArray[Any]) -> Floats:
    """Sum of the vectors of the faces around each vertex: their mean by area."""
    return _native.normals_of_faces(np.ascontiguousarray(vertices, np.float64), np.ascontiguousarray(faces, np.uint32))


def smooth_normals(vertices: Floats, faces: NDArray[Any]) -> NDArray[np.float32]:
    """Unit normals of the vertices, the mean of the faces around each by area; (0, 0, 1) where these have none."""
    # Relative to their size, so that areas of tiny or huge triangles neither vanish nor overflow.
    largest = float(np.ptp(vertices, axis=0).max()) or 1.0
    normals = normals_of_faces((vertices - vertices.mean(axis=0)) / largest, faces)
    lengths = np.linalg.norm(normals, axis=1)
    normals[lengths == 0] = 0, 0, 1
    lengths[lengths == 0] = 1
    unit: NDArray[np.float32] = (normals / lengths[:, None]).astype(np.float32)
    return unit
