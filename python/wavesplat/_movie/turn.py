"""The turn: an eye that goes round, at one scale and one distance."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from math import isfinite
from operator import index
from typing import TYPE_CHECKING

from wavesplat import _native
from wavesplat._model.camera import fit
from wavesplat._model.camera.camera import Camera
from wavesplat._model.camera.path import MAX_FRAMES
from wavesplat._model.camera.stereo import PLAIN, Eyes
from wavesplat._model.camera.views import Vector, vector
from wavesplat._movie.key_frame import KeyFrame
from wavesplat._movie.seen import direction_of, what_is_seen
from wavesplat._public import public
from wavesplat._render import framing
from wavesplat._system.values import described, number, whole
from wavesplat.errors import ArgumentError

if TYPE_CHECKING:
    from wavesplat._model.arguments.operators import Operator
    from wavesplat._scene.scene import Scene


@public
@dataclass(frozen=True)
class Turn:
    """A turn of the eye about what is shown, at one scale: nothing comes nearer or leaves the picture.

    Parameters
    ----------
    frames : int, default 120
        Pictures of the turn. Of a whole turn the last is the one before the first, so that the movie repeats.
    degrees : float, default 360
        Angle of the turn; less than 0 turns the other way round. The patient's left comes first.
    azimuth, elevation : float, default 0
        Turn and lift the eye from the first view before it starts, degrees, as `Camera.turned` does.
    axis : three numbers (x, y, z), default (0, 0, 1)
        Direction to turn about, in the world.
    start : Camera or str, optional
        The first view, or its name; None is the one that a picture of the scene has. A camera keeps its scale and turns
        about its focal point; else all that is seen fits into the picture the whole turn long.
    zoom : float, default 1
        Magnification beyond that.
    view_angle : float, optional
        Perspective with this vertical angle, degrees; None is orthographic, or the camera's own.
    times : sequence of int, optional
        Numbers of volumes of a series, which are shown one after the other while the eye turns, each in an equal share
        of the frames; None keeps the time of the scene.

    Raises
    ------
    ArgumentError
        If a number is out of range.

    Examples
    --------
    >>> import wavesplat as ws
    >>> ws.Turn(frames=90, elevation=15).frames
    90
    >>> ws.Turn(frames=6, times=range(3)).time_of_frames
    [0, 0, 1, 1, 2, 2]
    """

    frames: int = 120
    degrees: float = 360.0
    azimuth: float = 0.0
    elevation: float = 0.0
    axis: Vector = (0.0, 0.0, 1.0)
    start: Camera | str | None = None
    zoom: float = 1.0
    view_angle: float | None = None
    times: Sequence[int] | None = None

    def __post_init__(self) -> None:
        form = f"a whole number from 1 to {MAX_FRAMES}"
        object.__setattr__(self, "frames", whole(self.frames, "frames of the turn", form, least=1, most=MAX_FRAMES))
        for name in ("degrees", "azimuth", "elevation", "zoom"):
            object.__setattr__(self, name, number(getattr(self, name), f"{name} of the turn", "a number"))
        if self.view_angle is not None:
            object.__setattr__(self, "view_angle", number(self.view_angle, "view_angle of the turn", "a number"))
        fit.check_lens(self.zoom, self.view_angle, 1.0)
        axis: Iterable[float] = self.axis
        object.__setattr__(self, "axis", vector(axis, "axis of the turn"))
        length = sum(part * part for part in self.axis)
        if not (isfinite(length) and length > 0):
            raise ArgumentError(f"axis of the turn is {self.axis}; give a direction, such as (0, 0, 1)")
        if not (self.start is None or isinstance(self.start, Camera | str)):
            raise ArgumentError(f"start of the turn is {described(self.start)}; give a Camera or the name of a view")
        if isinstance(self.start, Camera) and self.view_angle is not None:
            raise ArgumentError("start of the turn is a camera, which has a view angle already; leave out view_angle")
        if self.times is not None:
            object.__setattr__(self, "times", _numbers(self.times))

    @property
    def angles(self) -> list[float]:
        """Angle of each frame, degrees."""
        return _native.turn_angles(self._fields)

    @property
    def time_of_frames(self) -> list[int] | None:
        """Number of the volume that each frame shows; None for the scene's."""
        if self.times is None:
            return None
        return [self.times[k * len(self.times) // self.frames] for k in range(self.frames)]

    @property
    def _fields(self) -> tuple[Vector, float, int]:
        return self.axis, self.degrees, self.frames


def key_frames(turn: Turn, cameras: Sequence[Camera], fps: float) -> list[KeyFrame]:
    """A key frame for each frame of a turn through times."""
    times = turn.time_of_frames or []
    return [
        KeyFrame(k / fps, camera=camera, time=time) for k, (camera, time) in enumerate(zip(cameras, times, strict=True))
    ]


def cameras_of(turn: Turn, scene: Scene, composite: Operator | None, aspect: float, eyes: Eyes = PLAIN) -> list[Camera]:
    """The cameras of a turn about what is seen of a scene; of panoramas they turn in the middle of it."""
    if not eyes.are_plain and turn.view_angle is None and not isinstance(turn.start, Camera):
        turn = replace(turn, view_angle=_native.VIEW_ANGLE)
    cameras = _cameras(turn, scene, composite, aspect)
    if eyes.panorama and not isinstance(turn.start, Camera):
        return [fit.within(camera, is_level=turn.elevation == 0) for camera in cameras]
    return [eyes.camera(camera) for camera in cameras]


def turned_in_place(turn: Turn, camera: Camera) -> list[Camera]:
    """Cameras that turn where a camera is."""
    return fit.cameras_at(_native.turn_in_place(turn._fields, fit.fields_of(camera)))


def _cameras(turn: Turn, scene: Scene, composite: Operator | None, aspect: float) -> list[Camera]:
    if isinstance(turn.start, Camera):
        first = turn.start.turned(turn.azimuth, turn.elevation).zoomed(turn.zoom)
        return fit.cameras_at(_native.turn_around(turn._fields, fit.fields_of(first)))
    azimuth, elevation = direction_of(scene, turn.start, composite)
    around, points = what_is_seen(scene, composite, turn.times)
    return fit.cameras_in_view(
        turn._fields,
        azimuth + turn.azimuth,
        elevation + turn.elevation,
        around,
        zoom=framing.FILLED * turn.zoom,
        view_angle=turn.view_angle,
        aspect=aspect,
        points=points,
    )


def _numbers(times: object) -> tuple[int, ...]:
    try:
        numbers = tuple(index(time) for time in times)  # type: ignore[attr-defined]
    except TypeError:
        numbers = ()
    if not numbers:
        raise ArgumentError(
            f"times of the turn is {described(times)}; give numbers of volumes of a series, such as range(5)"
        )
    return numbers
