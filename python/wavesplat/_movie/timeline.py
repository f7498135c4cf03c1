"""The shots of a movie, scene and camera of each frame, from key frames.

Every property has a track of its own: the key frames that say it. Between two of them it is mixed, before the first and
after the last it rests.
"""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial
from itertools import pairwise
from typing import TYPE_CHECKING, Any, Generic, NamedTuple, TypeVar

from wavesplat._model.argument_types import described
from wavesplat._model.camera import Camera
from wavesplat._model.camera_path import MAX_FRAMES, CameraPath
from wavesplat._model.series import Series
from wavesplat._model.stereo import PLAIN, Eyes
from wavesplat._movie.blending import blended_clips, blended_look
from wavesplat._movie.key_frame import KeyFrame
from wavesplat._movie.seen import camera_of
from wavesplat._render.arguments import chosen_look
from wavesplat._scene.looks_of_layers import look_over_others
from wavesplat.errors import ArgumentError

if TYPE_CHECKING:
    from wavesplat._looks.look import Look
    from wavesplat._model.composites import Operator
    from wavesplat._model.options import Composite
    from wavesplat._scene.scene import Scene

T = TypeVar("T")


class Shot(NamedTuple):
    """The scene and the camera of a frame."""

    scene: Scene
    camera: Camera


@dataclass(frozen=True)
class _Track(Generic[T]):
    """Values of a property at the times of its key frames."""

    times: Sequence[float]
    values: Sequence[T]

    def at(self, time: float, mix: Callable[[T, T, float], T]) -> T:
        k = bisect_right(self.times, time) - 1
        if k < 0:
            return self.values[0]
        if k + 1 == len(self.values) or time == self.times[k]:
            return self.values[k]
        part = (time - self.times[k]) / (self.times[k + 1] - self.times[k])
        return mix(self.values[k], self.values[k + 1], part)


class Timeline:
    """The shots between key frames, at a rate of frames."""

    def __init__(
        self,
        keys: Sequence[KeyFrame],
        scene: Scene,
        *,
        fps: float,
        composite: Operator | None,
        name: Composite,
        aspect: float,
        eyes: Eyes = PLAIN,
    ) -> None:
        times = [key.time_s for key in keys]
        for number, (before, after) in enumerate(pairwise(times)):
            if not before < after:
                raise ArgumentError(
                    f"key frame {number + 1} is at {after:g} s, after one at {before:g} s; give them in order of time"
                )
        self._scene, self._start, self._fps = scene, times[0], fps
        n_steps = (times[-1] - times[0]) * fps
        if not n_steps < MAX_FRAMES:
            raise ArgumentError(
                f"the key frames make {n_steps:.9g} frames; give at most {MAX_FRAMES}, times are in seconds"
            )
        self._n = round(n_steps) + 1
        self._time = self._time_track(keys)
        self._camera = self._camera_track(
            keys, partial(camera_of, scene, composite=composite, aspect=aspect, eyes=eyes)
        )
        self._looks = [self._look_track(keys, number, name) for number in range(len(scene.layers))]
        given = [(key.time_s, key.clip) for key in keys if key.clip is not None]
        self._clip: _Track[Any] | None = _Track(*zip(*given, strict=True)) if given else None
        # Values that do not mix are refused before anything is drawn.
        for before, after in pairwise(times):
            self._shown((before + after) / 2)

    @property
    def is_still(self) -> bool:
        """Whether only the camera moves."""
        return self._clip is None and self._time is None and self.has_one_look

    @property
    def has_one_look(self) -> bool:
        """Whether no key frame changes a look."""
        return not any(self._looks)

    def __len__(self) -> int:
        return self._n

    def __getitem__(self, number: int) -> Shot:
        time = self._start + number / self._fps
        return Shot(self._shown(time), self._camera(time))

    def _shown(self, time: float) -> Scene:
        """The scene at a time; the same object where nothing changes."""
        changes: dict[str, Any] = {}
        if self._clip is not None:
            changes["clip"] = self._clip.at(time, blended_clips)
        place = None if self._time is None else round(self._time.at(time, lambda a, b, t: (1 - t) * a + t * b))
        layers = []
        for layer, track in zip(self._scene.layers, self._looks, strict=True):
            changed = layer if place is None or not isinstance(layer.volume, Series) else replace(layer, time=place)
            if track is not None:
                look = track.at(time, partial(blended_look, spacing=layer.looked_at.spacing))
                changed = replace(changed, look=look)
            layers.append(changed)
        if any(a is not b for a, b in zip(layers, self._scene.layers, strict=True)):
            changes["layers"] = layers
        return self._scene.with_(**changes) if changes else self._scene

    def _camera_track(self, keys: Sequence[KeyFrame], eye_of: Callable[..., Camera]) -> Callable[[float], Camera]:
        given = [key for key in keys if key.camera is not None]
        if not given:
            times = sorted({key.time for key in keys if key.time is not None})
            still = eye_of(None, times=times)
            return lambda _: still
        cameras = [eye_of(key.camera) for key in given]
        return CameraPath(cameras, [key.time_s for key in given])

    def _look_track(self, keys: Sequence[KeyFrame], number: int, composite: Composite) -> _Track[Look] | None:
        volume = self._scene.layers[number].looked_at
        times, looks = [], []
        for key in keys:
            given = _look_of(key.look, number, len(self._scene.layers))
            if given is not None:
                times.append(key.time_s)
                looks.append((look_over_others if number else chosen_look)(given, volume, composite))
        return _Track(times, looks) if times else None

    def _time_track(self, keys: Sequence[KeyFrame]) -> _Track[float] | None:
        given = [(key.time_s, key.time) for key in keys if key.time is not None]
        if not given:
            return None
        lengths = [len(layer.volume) for layer in self._scene.layers if isinstance(layer.volume, Series)]
        if not lengths:
            raise ArgumentError("time of a key frame chooses a volume of a series, and the scene has none")
        for _, place in given:
            if not 0 <= place < min(lengths):
                raise ArgumentError(f"time of a key frame is {place}; the series has 0 to {min(lengths) - 1}")
        return _Track([time for time, _ in given], [float(place) for _, place in given])


def _look_of(given: Any, number: int, n_layers: int) -> Any:
    if not isinstance(given, list | tuple):
        return given
    if len(given) != n_layers:
        raise ArgumentError(
            f"look of a key frame is {described(given)} of {len(given)}; give one for each of the {n_layers} layers"
        )
    return given[number]
