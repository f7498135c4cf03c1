"""Movies of films, that is of series of 2-D pictures such as ultrasound: one frame for each picture."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from wavesplat._looks.curves.transfer_function import TransferFunction
from wavesplat._looks.look import Look
from wavesplat._model.camera.camera import Camera
from wavesplat._model.volume.series import Series
from wavesplat._movie.key_frame import KeyFrame
from wavesplat._movie.timeline import Shot
from wavesplat._picture.picture import Picture
from wavesplat._readers.single_planes import is_single_plane
from wavesplat._scene.scene import Scene
from wavesplat._scene.slices.slicing import slice
from wavesplat.errors import ArgumentError

#: Least and largest rate of a film that is taken from its times, frames a second.
MIN_RATE, MAX_RATE = 1.0, 50.0
#: Seconds by the unit of times.
SECONDS = {"s": 1.0, "ms": 1e-3}


def film_of(scene: Scene) -> Series | None:
    """The film that a scene shows; None if it shows volumes."""
    first = scene.layers[0]
    return first.volume if isinstance(first.volume, Series) and is_single_plane(first.drawn) else None


def rate_of(film: Series) -> float | None:
    """Frames a second by the film's times; None where they are unknown."""
    length = (film.times[-1] - film.times[0]) * SECONDS.get(film.time_unit or "", 0.0)
    return min(max((len(film) - 1) / length, MIN_RATE), MAX_RATE) if length > 0 else None


def shots_of(scene: Scene, film: Series, along: Any) -> Sequence[Shot]:
    """A shot for each frame of a film, or for those whose times key frames name."""
    numbers: list[Any] = [*range(len(film))]
    if along is not None:
        steps = list(along) if isinstance(along, list | tuple) else []
        numbers = [step.time if isinstance(step, KeyFrame) and step.camera is None else None for step in steps]
        if not numbers or None in numbers:
            raise ArgumentError(
                f"{film.name!r} is a film, which is shown as it is, without a camera; leave out along (--turn, views), "
                "or give a KeyFrame with a time for each of its frames"
            )
    camera = Camera((0, 0, 1), (0, 0, 0), (0, 1, 0), parallel_scale=1)  # not used: a film is shown without a camera
    return [Shot(scene.at_time(number), camera) for number in numbers]


def film_frame(scene: Scene, size: tuple[int, int] | None = None, threads: int | None = None) -> Picture:
    """A frame of a film: in the colours of the look that its only layer was given, else as `slice` shows it."""
    look: Any = scene.layers[0].look if len(scene.layers) == 1 else None
    colors = look.transfer_function if isinstance(look, Look) else look
    return slice(
        scene,
        size=size,
        transfer_function=colors if isinstance(colors, TransferFunction) else None,
        background="black" if scene.background is None else scene.background,
        threads=threads,
    )
