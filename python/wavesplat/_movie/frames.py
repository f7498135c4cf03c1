"""Whole frames over the workers of a Dask cluster: each is drawn by one of them."""

from __future__ import annotations

import hashlib
import itertools
import pickle
from collections import deque
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from wavesplat._cluster.machines import Machines, machines_of
from wavesplat._cluster.waiting import (
    N_RETRIES,
    check_times_lost,
    held,
    lost_scheduler_named,
    release,
    result_of,
    wait_for_scheduler,
)
from wavesplat._model.arguments.types import takes_options
from wavesplat._model.camera.camera import Camera
from wavesplat._model.camera.stereo import checked_eyes
from wavesplat._model.lazy.volume import LazyVolume
from wavesplat._movie.seen import camera_of, with_settled_looks
from wavesplat._picture.picture import Picture
from wavesplat._public import public
from wavesplat._render.arguments import checked_size
from wavesplat._render.options import DrawOptions, FrameOptions
from wavesplat._scene.scene import Scene, as_scene
from wavesplat._system.libraries import library
from wavesplat._system.values import described
from wavesplat.errors import ArgumentError, CancelledError

if TYPE_CHECKING:
    from typing import Unpack

#: Frames submitted for each one that is drawn at once: pictures are large, and are yielded in their order.
AHEAD = 3


@public
@takes_options(FrameOptions, DrawOptions)
def render_frames(
    what: Any,
    cameras: Sequence[Camera | str],
    *,
    client: Any = None,
    depth: bool = False,
    background: str | Sequence[float] | None = None,
    **options: Unpack[FrameOptions],
) -> Iterator[Picture]:
    """Pictures of a scene from several cameras, one after the other, drawn here or each by a worker of a cluster.

    Parameters
    ----------
    what : Scene, Volume, or what else `render` takes
        Workers open the files of lazy volumes themselves; what is in memory is sent to each of them once.
    cameras : sequence of Camera or str
        One for each picture.
    client : dask.distributed.Client or "threads", optional
        Where to draw; None is this process, one frame after the other.
    depth, background
        As for `wavesplat.render`. What is chosen by the data, looks and greys, is chosen once here.
    **options : FrameOptions
        As for `wavesplat.render`; with a client its workers' threads, no `psnr`, and `device` "auto" is the CPU.

    Yields
    ------
    Picture
        In the order of the cameras; with the bytes of `Scene.render`.

    Raises
    ------
    ArgumentError
        If an argument cannot work, or workers cannot draw.
    CancelledError
        If `progress` returned False.

    Examples
    --------
    >>> import wavesplat as ws
    >>> scene = ws.Scene(ws.examples.ct_pelvis(), "ct-bone")
    >>> [picture.size for picture in ws.render_frames(scene, ["front", "left"], size=(32, 24), client="threads")]
    [(32, 24), (32, 24)]
    """
    progress = options.pop("progress", None)
    size, composite = options.setdefault("size", (512, 512)), options.get("composite")
    check_client(client, options.get("psnr"))
    scene = as_scene(what, None, labels=None, shading="look", clip=(), background=background)
    width, height = checked_size(size)
    if isinstance(cameras, Camera | str) or not (given := list(cameras)):
        raise ArgumentError(f"cameras is {described(cameras)}; give a list with a camera, or a view, for each picture")
    eyes = checked_eyes(options.get("stereo"), options.get("panorama", False))
    aspect = eyes.aspect_of((width, height))
    chosen = [camera_of(scene, camera, composite, aspect, eyes=eyes) for camera in given]
    scene, _ = with_settled_looks(scene, composite, chosen[0], (width, height))
    shots = [(scene, camera) for camera in chosen]
    return _reporting(drawn_by_client(shots, {**options, "depth": depth}, client), len(chosen), progress)


def check_client(client: Any, psnr: float | None) -> None:
    """Raise an `ArgumentError` where frames are for a client, and each needs what the one before measured."""
    if client is not None and psnr is not None:
        raise ArgumentError(
            "with psnr each frame needs what the one before measured, so a client cannot draw them; leave out one"
        )


def _reporting(pictures: Iterator[Picture], n: int, progress: Callable[[float], object] | None) -> Iterator[Picture]:
    for k, picture in enumerate(pictures):
        yield picture
        if progress is not None and progress((k + 1) / n) is False:
            raise CancelledError("rendering was cancelled by the progress callback")


def drawn_by_client(shots: Sequence[tuple[Scene, Any]], options: dict[str, Any], client: Any) -> Iterator[Picture]:
    """Pictures of scenes from cameras, in their order, drawn by the workers of a client, or here if it is None."""
    if client is None:
        for scene, camera in shots:
            yield scene.render(camera, **options)
        return
    machines = machines_of(client)
    # Some workers may have GPUs and others not: the CPU draws, so that frames do not differ.
    device = options.get("device", "auto")
    own = {**options, "device": "cpu" if device == "auto" else device, "threads": machines.threads}
    if isinstance(client, str):
        yield from _by_threads(shots, own, machines)
        return
    yield from _by_client(shots, own, machines, client)


def _by_threads(shots: Sequence[tuple[Scene, Any]], options: dict[str, Any], machines: Machines) -> Iterator[Picture]:
    dask: Any = library("dask", extra="dask")
    for k in range(0, len(shots), machines.n_at_once):
        part = shots[k : k + machines.n_at_once]
        tasks = [dask.delayed(scene.render, pure=False)(camera, **options) for scene, camera in part]
        yield from dask.compute(*tasks, scheduler="threads")


def _by_client(
    shots: Sequence[tuple[Scene, Any]], options: dict[str, Any], machines: Machines, client: Any
) -> Iterator[Picture]:
    with lost_scheduler_named(client):
        n_done = 0
        distributed: Any = library("distributed", extra="dask")
        for attempt in itertools.count():
            wait_for_scheduler(client)
            try:
                for picture in _by_attempt(shots[n_done:], options, machines, client):
                    n_done += 1
                    yield picture
                return
            except distributed.CancelledError as error:
                check_times_lost(attempt, error)


def _by_attempt(
    shots: Sequence[tuple[Scene, Any]], options: dict[str, Any], machines: Machines, client: Any
) -> Iterator[Picture]:
    dask: Any = library("dask", extra="dask")
    scenes: dict[int, tuple[str, Any]] = {}
    waiting: deque[Any] = deque()
    places = iter(shots)

    def sent(scene: Scene) -> tuple[str, Any]:
        if id(scene) not in scenes:
            packed = pickle.dumps(_within(scene, machines))
            token = hashlib.sha256(packed).hexdigest()[:16]
            scenes[id(scene)] = token, held(client, packed, token)
        return scenes[id(scene)]

    def begin() -> bool:
        shot = next(places, None)
        if shot is None:
            return False
        token, packed = sent(shot[0])
        task = dask.delayed(_drawn, pure=False)(packed, token, shot[1], options)
        waiting.append(client.compute(task, retries=N_RETRIES))
        return True

    try:
        while len(waiting) < AHEAD * machines.n_at_once and begin():
            pass
        while waiting:
            picture: Picture = result_of(client, waiting.popleft())
            begin()
            yield picture
    finally:
        release(client, list(waiting))


def _within(scene: Scene, machines: Machines) -> Scene:
    """The scene with lazy volumes that keep within a worker's memory, and what is known of their samples."""
    layers = []
    for layer in scene.layers:
        volume = layer.volume
        if isinstance(volume, LazyVolume) and volume.memory > machines.memory:
            volume = volume.with_memory(machines.memory)
        layers.append(replace(layer, volume=volume))
    return scene.with_(layers=layers)


_SCENES: dict[str, Scene] = {}


def _drawn(packed: bytes, token: str, camera: Any, options: dict[str, Any]) -> Picture:
    """Task: draw a frame. The scene is kept for the next tasks of the process."""
    scene = _SCENES.get(token)
    if scene is None:
        _SCENES.clear()
        scene = _SCENES[token] = pickle.loads(packed)  # noqa: S301 - our own, by the way that Dask sends tasks
    return scene.render(camera, **options)
