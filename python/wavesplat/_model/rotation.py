"""Rotations between key frames, as unit quaternions (w, x, y, z).

A segment is a cubic curve with given angular velocities at both ends, after Kim, Kim and Shin, "A general construction
scheme for unit quaternion curves with simple high order derivatives" (SIGGRAPH 1995): the cumulative form of a cubic
Bezier curve, q0 exp(w1 b1) exp(w2 b2) exp(w3 b3). Segments that share a key share its velocity, so the turn is smooth.
"""

from __future__ import annotations

from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

Quaternion: TypeAlias = NDArray[np.float64]

#: Cosine of half the angle between keys, below which two keys count as opposite: rounding would choose the way round.
OPPOSITE = 1e-9


def from_axes(axes: NDArray[np.float64]) -> Quaternion:
    """Quaternion of the rotation that takes x, y, z to the rows of a right-handed orthonormal frame."""
    matrix = axes.T
    (xx, xy, xz), (yx, yy, yz), (zx, zy, zz) = matrix.tolist()
    # Four times each product with the largest component, which is never small.
    candidates = np.array(
        [
            [1 + xx + yy + zz, zy - yz, xz - zx, yx - xy],
            [zy - yz, 1 + xx - yy - zz, yx + xy, xz + zx],
            [xz - zx, yx + xy, 1 - xx + yy - zz, zy + yz],
            [yx - xy, xz + zx, zy + yz, 1 - xx - yy + zz],
        ]
    )
    best: Quaternion = candidates[int(np.argmax(np.diag(candidates)))]
    return np.asarray(best / np.linalg.norm(best))


def to_axes(quaternion: Quaternion) -> NDArray[np.float64]:
    """The frame of a quaternion, its axes as rows."""
    w, x, y, z = (quaternion / np.linalg.norm(quaternion)).tolist()
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y)],
            [2 * (x * y - w * z), 1 - 2 * (x * x + z * z), 2 * (y * z + w * x)],
            [2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)],
        ]
    )


def product(first: Quaternion, second: Quaternion) -> Quaternion:
    """Hamilton's product: turns by `second`, then by `first`."""
    a, b = first[0], second[0]
    u, v = first[1:], second[1:]
    return np.array([a * b - u @ v, *(a * v + b * u + np.cross(u, v))])


def conjugate(quaternion: Quaternion) -> Quaternion:
    """The inverse rotation."""
    return np.asarray(quaternion * np.array([1.0, -1.0, -1.0, -1.0]))


def exponential(vector: NDArray[np.float64]) -> Quaternion:
    """The rotation about a vector by its length, in radians."""
    half = float(np.linalg.norm(vector)) / 2
    # sin(half) / (2 half), without a division by 0.
    return np.array([np.cos(half), *(np.sinc(half / np.pi) / 2 * vector)])


def rotation_vector(start: Quaternion, end: Quaternion) -> NDArray[np.float64]:
    """Axis times angle, radians, of the shorter rotation from `start` to `end`, in the frame of either.

    Between opposite ones both ways are equally long: the one about an axis that points up in the world is taken
    (towards +z; of level axes towards +y, or +x), as an azimuth grows.
    """
    step = product(conjugate(start), end)
    axis, length = step[1:], float(np.linalg.norm(step[1:]))
    if length == 0:
        return np.zeros(3)
    backward = step[0] < 0
    if abs(step[0]) < OPPOSITE:
        x, y, z = product(product(start, np.array([0.0, *axis])), conjugate(start))[1:].tolist()
        leading = next((part for part in (z, y, x) if abs(part) > OPPOSITE * length), length)
        backward = leading < 0
    w = -step[0] if backward else step[0]
    angle = 2 * float(np.arctan2(length, w))
    return np.asarray((-angle if backward else angle) / length * axis)


def hermite(
    start: Quaternion, turn: NDArray[np.float64], ends: tuple[NDArray[np.float64], ...], t: float
) -> Quaternion:
    """Curve from `start` (t = 0) to `start` turned by `turn` (t = 1), with angular velocities `ends` per unit of t.

    All vectors are in radians in the moving frame, as `rotation_vector` gives them.
    """
    first, last = ends[0] / 3, ends[1] / 3
    between = product(product(conjugate(exponential(first)), exponential(turn)), conjugate(exponential(last)))
    middle = rotation_vector(np.array([1.0, 0.0, 0.0, 0.0]), between)
    # Cumulative Bernstein polynomials of degree 3; their sum is 3 t.
    late = t**3
    mid = late + 3 * t**2 * (1 - t)
    early = mid + 3 * t * (1 - t) ** 2
    turned = product(start, exponential(early * first))
    return product(product(turned, exponential(mid * middle)), exponential(late * last))
