"""Cameras between key frames: checks of the arguments; `crates/view` decides where the cameras stand."""

from __future__ import annotations

from collections.abc import Sequence

from wavesplat import _native
from wavesplat._model.camera.camera import Camera
from wavesplat._model.camera.fit import Placed, camera_at, cameras_at, fields_of
from wavesplat._system.values import described
from wavesplat.errors import ArgumentError

#: Frames of a movie, at most: two hours at 60 a second.
MAX_FRAMES = 432_000


class CameraPath:
    """A camera for every time between the first and the last key; the path is closed if these two are equal."""

    def __init__(self, cameras: Sequence[Camera], times: Sequence[float]) -> None:
        self._path = _native.CameraPath(_checked(cameras), times)

    def __call__(self, time: float) -> Camera:
        """The camera at a time, clamped to the first and the last key."""
        return camera_at(Placed(*self._path.at(time)))


def evenly(cameras: Sequence[Camera], n: int, *, closed: bool) -> list[Camera]:
    """`n` cameras through keys at equal distances in time."""
    keys = _checked(cameras)
    if not 1 <= n <= MAX_FRAMES:
        raise ArgumentError(f"n is {n}; give the number of cameras, from 1 to {MAX_FRAMES}")
    return cameras_at(_native.cameras_evenly(keys, n, bool(closed)))


def _checked(cameras: Sequence[Camera]) -> list[Placed]:
    try:
        keys = tuple(cameras)
    except TypeError:
        keys = ()
    if not keys:
        raise ArgumentError(f"cameras is {described(cameras)}; give the key frames, one wavesplat.Camera or more")
    for number, camera in enumerate(keys):
        if not isinstance(camera, Camera):
            raise ArgumentError(f"camera {number} is {described(camera)}; give wavesplat.Camera key frames")
    return [fields_of(camera) for camera in keys]
