"""Cameras between key frames.

The direction turns as `rotation` says, smoothly through every key; focal point, distance and scale follow monotone
cubics (Fritsch and Carlson 1980), the last two as logarithms: they never overshoot a key, and rest where two keys
agree.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import atan, degrees, dist, exp, isfinite, log, radians, tan

import numpy as np
from numpy.typing import NDArray

from wavesplat._model import rotation
from wavesplat._model.argument_types import described
from wavesplat._model.camera import Camera
from wavesplat._model.camera_fit import axes_of
from wavesplat.errors import ArgumentError

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
        self._frames = [rotation.from_axes(axes_of(camera)) for camera in keys]
        self._turns = [rotation.rotation_vector(a, b) for a, b in zip(self._frames, self._frames[1:], strict=False)]
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
        _, up, back = rotation.to_axes(rotation.hermite(self._frames[k], self._turns[k], ends, t))
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
