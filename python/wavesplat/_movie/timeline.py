"""The shots of a movie: scene and camera of each frame, from key frames, whose looks and clips are blended.

Curves of transfer functions are mixed value by value: at every value where one of the two has a node, the mean of both,
weighted by time. Opacities belong to a thickness; where that differs, it is mixed too, by factors.
"""

from __future__ import annotations

from bisect import bisect_left, bisect_right
from collections.abc import Callable, Sequence
from dataclasses import dataclass, fields, replace
from functools import partial
from itertools import pairwise
from math import exp, log
from typing import TYPE_CHECKING, Any, Generic, NamedTuple, TypeAlias, TypeVar

import numpy as np

from wavesplat._looks.curves import colors
from wavesplat._looks.curves.transfer_function import TransferFunction
from wavesplat._looks.curves.transfer_function_2d import TransferFunction2D
from wavesplat._looks.look import Look
from wavesplat._looks.shading import Light, Shading
from wavesplat._model.arguments.clips import Clip, ClipPlane, Crop, CutOut
from wavesplat._model.camera.camera import Camera
from wavesplat._model.camera.path import MAX_FRAMES, CameraPath
from wavesplat._model.camera.stereo import PLAIN, Eyes
from wavesplat._model.volume.series import Series
from wavesplat._movie.key_frame import KeyFrame
from wavesplat._movie.seen import camera_of
from wavesplat._render.arguments import chosen_look
from wavesplat._scene.drawing.looks_of_layers import look_over_others
from wavesplat._system.values import described
from wavesplat.errors import ArgumentError

if TYPE_CHECKING:
    from wavesplat._model.arguments.operators import Operator
    from wavesplat._model.arguments.sampling import Composite
    from wavesplat._scene.scene import Scene

Nodes: TypeAlias = Sequence[tuple[float, ...]]


def blended_look(a: Look, b: Look, t: float, spacing: Sequence[float]) -> Look:
    """The look a part `t` of the way from one to the other. `spacing`: of the volume, for opacities without a unit."""
    if a == b:
        return a
    if a.composite != b.composite:
        raise ArgumentError(
            f'looks of key frames are for composite="{a.composite}" and "{b.composite}", which do not mix; '
            "give looks for one operator, or make two movies"
        )
    nearer = a if t < 0.5 else b
    return replace(
        nearer,
        transfer_function=_blended_function(a.transfer_function, b.transfer_function, t, spacing),
        shading=_blended_shading(a.shading, b.shading, t),
        background=_blended_background(a.background, b.background, t),
    )


def blended_clips(a: Sequence[Clip], b: Sequence[Clip], t: float) -> tuple[Clip, ...]:
    """The clips a part `t` of the way from some to others of the same kinds."""
    if [_kind(clip) for clip in a] != [_kind(clip) for clip in b]:
        kinds = [", ".join(_kind(clip) for clip in clips) or "nothing" for clips in (a, b)]
        raise ArgumentError(
            f"clip of key frames is {kinds[0]} and {kinds[1]}, which do not mix; give the same kinds in the same order "
            "(a plane or a box outside of the volume clips nothing)"
        )
    return tuple(_blended_clip(one, other, t) for one, other in zip(a, b, strict=True))


def _kind(clip: Clip) -> str:
    if isinstance(clip, CutOut):
        return f"a CutOut ({clip.crop.space})"
    return f"a Crop ({clip.space})" if isinstance(clip, Crop) else "a ClipPlane"


def _blended_clip(a: Clip, b: Clip, t: float) -> Clip:
    if isinstance(a, Crop) and isinstance(b, Crop):
        lower, upper = (np.sort([crop.lower, crop.upper], axis=0) for crop in (a, b))
        ends = [_mixed(lower[k], upper[k], t) for k in (0, 1)]
        return Crop(ends[0], ends[1], a.space)
    if isinstance(a, CutOut) and isinstance(b, CutOut):
        crop = _blended_clip(a.crop, b.crop, t)
        assert isinstance(crop, Crop)
        return CutOut(crop)
    assert isinstance(a, ClipPlane)
    assert isinstance(b, ClipPlane)
    normals = [np.divide(plane.normal, np.linalg.norm(plane.normal)) for plane in (a, b)]
    if normals[0] @ normals[1] < -1 + 1e-9:
        raise ArgumentError("normals of a clip plane of two key frames are opposite; give a key frame between them")
    return ClipPlane(_mixed(a.point, b.point, t), _mixed(normals[0], normals[1], t))


def _mixed(a: object, b: object, t: float) -> list[float]:
    first, second = np.array(a, dtype=np.float64), np.array(b, dtype=np.float64)
    mixed: list[float] = ((1 - t) * first + t * second).tolist()
    return mixed


def _blended_function(
    a: TransferFunction | TransferFunction2D,
    b: TransferFunction | TransferFunction2D,
    t: float,
    spacing: Sequence[float],
) -> TransferFunction | TransferFunction2D:
    if a == b:
        return a
    unit = _blended_unit(a.opacity_unit, b.opacity_unit, t, spacing)
    if isinstance(a, TransferFunction) and isinstance(b, TransferFunction):
        gradients = a.gradient_opacity, b.gradient_opacity
        whole = ((0.0, 1.0),)
        return TransferFunction(
            _blended_nodes(a.opacity, b.opacity, t),
            _blended_nodes(a.color, b.color, t),
            unit,
            _blended_nodes(gradients[0] or whole, gradients[1] or whole, t) if any(gradients) else (),
        )
    if isinstance(a, TransferFunction2D) and isinstance(b, TransferFunction2D):
        if a.rows == b.rows and a.values == b.values and a.magnitudes == b.magnitudes:
            return TransferFunction2D(a.values, a.magnitudes, (1 - t) * a.rgba + t * b.rgba, unit, rows=a.rows)
        raise ArgumentError(
            "transfer functions of two dimensions mix on one grid; give both the same values, magnitudes and rows"
        )
    raise ArgumentError(
        "a transfer function of one dimension does not mix with one of two; give key frames of one kind"
    )


def _blended_unit(a: float | None, b: float | None, t: float, spacing: Sequence[float]) -> float | None:
    if a == b:
        return a
    usual = float(np.prod(spacing)) ** (1 / 3)
    return exp((1 - t) * log(a or usual) + t * log(b or usual))


def _blended_nodes(a: Nodes, b: Nodes, t: float) -> list[tuple[float, ...]]:
    """Nodes of the mean of two curves, steps included."""
    nodes: list[tuple[float, ...]] = []
    for value in sorted({node[0] for node in (*a, *b)}):
        sides = [
            tuple((1 - t) * x + t * y for x, y in zip(_limit(a, value, side), _limit(b, value, side), strict=True))
            for side in (0, 1)
        ]
        nodes += [(value, *channels) for channels in dict.fromkeys(sides)]
    return nodes


def _limit(nodes: Nodes, value: float, side: int) -> tuple[float, ...]:
    """Limit of a curve at a value from below (side 0) or from above (1)."""
    values = [node[0] for node in nodes]
    below, above = bisect_left(values, value), bisect_right(values, value)
    if above > below:
        return nodes[below if side == 0 else above - 1][1:]
    if below == 0:
        return nodes[0][1:]
    if below == len(nodes):
        return nodes[-1][1:]
    (v0, *left), (v1, *right) = nodes[below - 1], nodes[below]
    part = (value - v0) / (v1 - v0)
    return tuple((1 - part) * x + part * y for x, y in zip(left, right, strict=True))


def _blended_shading(a: Shading | None, b: Shading | None, t: float) -> Shading | None:
    """The shading between two: numbers are mixed, other settings are taken from the nearer key frame."""
    if a is None or b is None or a == b:
        return a if t < 0.5 else b
    nearer = a if t < 0.5 else b
    settings = {field.name: getattr(nearer, field.name) for field in fields(Shading) if field.name != "_core"}
    for name in settings:
        x, y = getattr(a, name), getattr(b, name)
        if isinstance(x, float) and isinstance(y, float) and name != "gradient_smoothing":
            settings[name] = (1 - t) * x + t * y
    if len(a.lights) == len(b.lights) and all(x.frame == y.frame for x, y in zip(a.lights, b.lights, strict=True)):
        settings["lights"] = [
            Light(_mixed(x.direction, y.direction, t), _mixed(x.color, y.color, t), x.frame)
            for x, y in zip(a.lights, b.lights, strict=True)
        ]
    return Shading(**settings)


def _blended_background(a: str | None, b: str | None, t: float) -> str | None:
    ends = [colors.parse(text) for text in (a, b)]
    if a == b or ends[0] is None or ends[1] is None:
        return a if t < 0.5 else b
    return ",".join(f"{channel:.6f}" for channel in _mixed(ends[0], ends[1], t))


# The shots of a movie, scene and camera of each frame, from key frames.
#
# Every property has a track of its own: the key frames that say it. Between two of them it is mixed, before the first
# and after the last it rests.

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
