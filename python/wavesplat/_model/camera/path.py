"""Cameras between key frames, and the rotations between them.

The direction turns as `rotation` says, smoothly through every key; focal point, distance and scale follow monotone
cubics (Fritsch and Carlson 1980), the last two as logarithms: they never overshoot a key, and rest where two keys
agree.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import atan, degrees, dist, exp, isfinite, log, radians, tan
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from wavesplat._model.camera.camera import Camera
from wavesplat._model.camera.fit import axes_of
from wavesplat._system.values import described
from wavesplat.errors import ArgumentError

# Rotations between key frames, as unit quaternions (w, x, y, z).
#
# A segment is a cubic curve with given angular velocities at both ends, after Kim, Kim and Shin, "A general
# construction scheme for unit quaternion curves with simple high order derivatives" (SIGGRAPH 1995): the cumulative
# form of a cubic Bezier curve, q0 exp(w1 b1) exp(w2 b2) exp(w3 b3). Segments that share a key share its velocity, so
# the turn is smooth.

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


# Cameras between key frames.

#: Frames of a movie, at most: two hours at 60 a second.
MAX_FRAMES = 432_000

Numbers = NDArray[np.float64]


class CameraPath:
    """A camera for every time between the first and the last key; the path is closed if these two are equal."""

    def __init__(self, cameras: Sequence[Camera], times: Sequence[float]) -> None:
        keys = _checked(cameras)
        moments = np.array(times, dtype=np.float64)
        if moments.shape != (len(keys),) or not np.isfinite(moments).all() or not (np.diff(moments) > 0).all():
            raise ArgumentError(f"times of {len(keys)} cameras are {described(times)}; give one for each, in order")
        self._keys, self._times = keys, moments
        self._closed = len(keys) > 1 and keys[0] == keys[-1]
        self._frames = [from_axes(axes_of(camera)) for camera in keys]
        self._turns = [rotation_vector(a, b) for a, b in zip(self._frames, self._frames[1:], strict=False)]
        self._values = np.array([_numbers(camera) for camera in keys])
        if len(keys) > 1:
            rates = np.array(self._turns) / np.diff(moments)[:, None]
            self._velocities = _mean_slopes(rates, np.diff(moments), closed=self._closed)
            self._slopes = monotone_slopes(moments, self._values, closed=self._closed)

    def __call__(self, time: float) -> Camera:
        """The camera at a time, clamped to the first and the last key."""
        times = self._times
        if time <= times[0]:
            return self._keys[0]
        if time >= times[-1]:
            return self._keys[-1]
        k = int(np.searchsorted(times, time, side="right")) - 1
        if time == times[k]:
            return self._keys[k]
        width = float(times[k + 1] - times[k])
        t = (time - float(times[k])) / width
        ends = (self._velocities[k] * width, self._velocities[k + 1] * width)
        _, up, back = to_axes(hermite(self._frames[k], self._turns[k], ends, t))
        x, y, z, log_distance, log_scale = _hermite(self._values, self._slopes * width, k, t).tolist()
        focal_point = np.array([x, y, z])
        scale = exp(log_scale)
        in_perspective = self._keys[0].view_angle is not None
        return Camera(
            focal_point + exp(log_distance) * back,
            focal_point,
            up,
            parallel_scale=None if in_perspective else scale,
            view_angle=degrees(2 * atan(scale)) if in_perspective else None,
        )


def evenly(cameras: Sequence[Camera], n: int, *, closed: bool) -> list[Camera]:
    """`n` cameras through keys at equal distances in time."""
    keys = _checked(cameras)
    if not 1 <= n <= MAX_FRAMES:
        raise ArgumentError(f"n is {n}; give the number of cameras, from 1 to {MAX_FRAMES}")
    if len(keys) == 1:
        return list(keys) * n
    if closed:
        keys = (*keys, keys[0])
    path = CameraPath(keys, range(len(keys)))
    last = len(keys) - 1
    # Multiplied before it is divided, so that the times of keys are exact.
    return [path(last * k / (n if closed else max(n - 1, 1))) for k in range(n)]


def monotone_slopes(times: Numbers, values: Numbers, *, closed: bool = False) -> Numbers:
    """Slopes at the keys, shaped as `values`, with which the cubics between them are smooth and do not overshoot.

    Weighted harmonic means of the slopes beside a key (Fritsch and Butland 1984), 0 where their signs differ.
    """
    widths = np.diff(times)[:, None]
    rates = np.diff(values, axis=0) / widths
    if closed:
        widths, rates = (np.concatenate([part[-1:], part, part[:1]]) for part in (widths, rates))
    before, after = rates[:-1], rates[1:]
    w_before, w_after = widths[:-1] + 2 * widths[1:], 2 * widths[:-1] + widths[1:]
    same = before * after > 0
    with np.errstate(divide="ignore", invalid="ignore"):
        inner = np.where(same, (w_before + w_after) / (w_before / before + w_after / after), 0.0)
    return inner if closed else np.concatenate([rates[:1], inner, rates[-1:]])


def _mean_slopes(rates: Numbers, widths: Numbers, *, closed: bool) -> Numbers:
    """Velocities at the keys: of the parabola through a key and its neighbours (Catmull-Rom, for any times)."""
    if closed:
        rates, widths = (np.concatenate([part[-1:], part, part[:1]]) for part in (rates, widths))
    before, after = widths[:-1, None], widths[1:, None]
    inner = (after * rates[:-1] + before * rates[1:]) / (before + after)
    return inner if closed else np.concatenate([rates[:1], inner, rates[-1:]])


def _hermite(values: Numbers, slopes: Numbers, k: int, t: float) -> Numbers:
    """Cubic between keys k and k + 1; slopes are per segment."""
    rise = values[k + 1] - values[k]
    bend = t * (1 - t)
    return np.asarray(values[k] + rise * t * t * (3 - 2 * t) + bend * ((1 - t) * slopes[k] - t * slopes[k + 1]))


def _numbers(camera: Camera) -> list[float]:
    """Focal point, and the logarithms of distance and scale (half the height, or the tangent of half the angle)."""
    scale = camera.parallel_scale if camera.view_angle is None else tan(radians(camera.view_angle) / 2)
    assert scale is not None
    numbers = [*camera.focal_point, log(dist(camera.position, camera.focal_point)), log(scale)]
    assert all(isfinite(number) for number in numbers)
    return numbers


def _checked(cameras: Sequence[Camera]) -> tuple[Camera, ...]:
    try:
        keys = tuple(cameras)
    except TypeError:
        keys = ()
    if not keys:
        raise ArgumentError(f"cameras is {described(cameras)}; give the key frames, one wavesplat.Camera or more")
    for number, camera in enumerate(keys):
        if not isinstance(camera, Camera):
            raise ArgumentError(f"camera {number} is {described(camera)}; give wavesplat.Camera key frames")
        if (camera.view_angle is None) != (keys[0].view_angle is None):
            kinds = ["orthographic" if one.view_angle is None else "in perspective" for one in (keys[0], camera)]
            raise ArgumentError(
                f"camera 0 is {kinds[0]} and camera {number} {kinds[1]}; give key frames of one kind: a small "
                "view_angle from far away looks nearly orthographic"
            )
    return keys
