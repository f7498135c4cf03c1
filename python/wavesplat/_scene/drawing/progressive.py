"""Pictures that get better: coarse levels first, then the one that is wanted, as its blocks are done."""

from __future__ import annotations

import queue
import threading
import time
from collections.abc import Iterator
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from wavesplat._model.arguments.sampling import Sampling
from wavesplat._model.arguments.types import takes_options
from wavesplat._model.camera.camera import Camera
from wavesplat._model.lazy.volume import LazyVolume
from wavesplat._picture.picture import Picture
from wavesplat._picture.report import Report
from wavesplat._public import public
from wavesplat._render.lazy_layers import pixel_in_samples
from wavesplat._render.options import DrawOptions, FrameOptions
from wavesplat._scene.drawing.drawing import camera_of, draw
from wavesplat._scene.drawing.summary import facts_of_picture
from wavesplat._scene.drawing.volumes_of_layers import drawn_volumes
from wavesplat._scene.scene import Scene, as_scene

if TYPE_CHECKING:
    from typing import Unpack

    from wavesplat._scene.layer import Layer

#: Seconds between two pictures of one level that is not done yet.
SHOWN_EVERY_S = 0.5
#: Step in levels from one coarser picture to the next: those between take time and show little.
LEVELS_BETWEEN = 2
#: Sampling of the first picture where there are no levels, and share of its sides: few sheets, fewer pixels.
QUICK, QUICK_SHARE = Sampling(sheets_per_slice=1, quality="draft"), 0.5


@public
@takes_options(FrameOptions, DrawOptions)
def progressive(
    what: Any,
    camera: Camera | str | None = None,
    *,
    depth: bool = False,
    background: Any = None,
    **options: Unpack[FrameOptions],
) -> Iterator[Picture]:
    """Pictures of one view, each better than the one before.

    The last one is the picture of `Scene.render`, to the byte where the same device draws.
    Of a lazy volume with levels of detail the coarsest comes first, within a small part of the bytes; the wanted level
    then fills in block by block. Of any other volume a quick picture comes first.

    Parameters
    ----------
    what : Scene, Volume, or what else `render` takes
        The scene or volume to draw.
    camera, depth, background
        As for `wavesplat.render`.
    **options : FrameOptions
        As for `wavesplat.render`. `progress` is of the last picture, and called from a thread of its own; `psnr` is
        for the last picture.

    Yields
    ------
    Picture
        All of one size. `report["is_final"]` marks the last one. To stop early, leave the loop: what is being read and
        drawn is given up within a tenth of a second.

    Raises
    ------
    ArgumentError
        If an argument cannot work.
    CancelledError
        If `progress` returned False.

    Examples
    --------
    >>> import wavesplat as ws
    >>> scene = ws.Scene(ws.examples.ct_pelvis(), "ct-bone")
    >>> [picture.report["is_final"] for picture in ws.progressive(scene, "front", size=(32, 24))]
    [False, True]
    """
    scene = as_scene(what, None, labels=None, shading="look", clip=(), background=background)
    return _refined(scene, camera, DrawOptions(depth=depth, **options))


def _refined(scene: Scene, camera: Camera | str | None, options: DrawOptions) -> Iterator[Picture]:
    coarse: Picture | None = None
    # One camera for all, or levels would be framed each on its own.
    eye = camera_of(scene, camera, options)
    for picture in _first(scene, eye, options):
        coarse = picture
        yield _marked(picture)
    yield from _in_blocks(scene, eye, options, coarse)


def _first(scene: Scene, camera: Camera, options: DrawOptions) -> Iterator[Picture]:
    """Pictures from coarser levels, or a quick one."""
    quiet = replace(options, progress=None)
    coarser = coarser_scenes(scene, options.size, camera)
    if not coarser:
        if any(isinstance(volume, LazyVolume) for volume in drawn_volumes(scene)):
            return
        # Two eyes share even numbers of pixels.
        unit = 1 if options.eyes.are_plain else 2
        width, height = (unit * max(1, round(QUICK_SHARE * n / unit)) for n in options.size)
        quick = draw(scene, camera, replace(quiet, size=(width, height), quality=QUICK, psnr=None))
        yield _enlarged(quick, options.size)
        return
    for one in coarser:
        yield draw(one, camera, quiet)


def coarser_scenes(scene: Scene, size: tuple[int, int], camera: Camera) -> list[Scene]:
    """The scene with coarser levels of its lazy volumes than a picture needs, the coarsest first."""
    fields = [layer.color_from for layer in scene.layers if layer.color_from is not None]
    lazy = [one.volume for one in (*scene.layers, *fields) if isinstance(one.volume, LazyVolume)]
    n_levels = max((len(volume.levels) for volume in lazy if volume.level is None), default=1)
    if n_levels < 2:
        return []
    needed = max(volume.level_for(lambda level: pixel_in_samples(level, camera, size)) for volume in lazy)
    numbers = range(n_levels - 1, needed, -LEVELS_BETWEEN)
    return [scene.with_(layers=[_coarser(layer, left_out) for layer in scene.layers]) for left_out in numbers]


def _coarser(layer: Layer, left_out: int) -> Layer:
    """The layer, and the field that colours it, without the `left_out` finest levels of lazy volumes."""
    volume, field = layer.volume, layer.color_from
    if isinstance(volume, LazyVolume) and volume.level is None:
        volume = volume.at_level(min(left_out, len(volume.levels) - 1))
    return replace(layer, volume=volume, color_from=None if field is None else _coarser(field, left_out))


def _marked(picture: Picture, *, is_final: bool = False) -> Picture:
    picture.report["is_final"] = is_final
    return picture


def _enlarged(picture: Picture, size: tuple[int, int]) -> Picture:
    """The picture enlarged by repeating its pixels."""
    width, height = size
    rows = np.arange(height) * picture.rgba.shape[0] // height
    columns = np.arange(width) * picture.rgba.shape[1] // width
    index = np.ix_(rows, columns)
    depth, value = (None if plane is None else plane[index] for plane in (picture.depth, picture.value))
    return Picture(picture.rgba[index], depth, value, Report(picture.report))


def _in_blocks(scene: Scene, camera: Camera, options: DrawOptions, coarse: Picture | None) -> Iterator[Picture]:
    """The wanted picture, shown now and then as its blocks are done, over the coarser one."""
    made: queue.Queue[Any] = queue.Queue()
    facts = facts_of_picture(scene, camera, options.eyes.size_of(options.size), None, scene.labels)
    stopped = threading.Event()
    shown = [time.monotonic()]

    def goes_on(done: float) -> bool:
        if stopped.is_set():
            return False
        return options.progress is None or options.progress(done) is not False

    def after_block(stream: Any, block: int) -> None:
        if block + 1 < stream.n_blocks and time.monotonic() - shown[0] >= SHOWN_EVERY_S:
            shown[0] = time.monotonic()
            made.put(("partial", stream.picture()["rgba"]))

    def work() -> None:
        try:
            own = replace(options, progress=goes_on, after_block=after_block)
            made.put(("final", draw(scene, camera, own)))
        except BaseException as error:  # noqa: BLE001 - carried to the thread that waits, which raises it
            made.put(("error", error))

    worker = threading.Thread(target=work, name="wavesplat-progressive", daemon=True)
    worker.start()
    try:
        while True:
            kind, result = made.get()
            if kind == "final":
                yield _marked(result, is_final=True)
                return
            if kind == "error":
                raise result
            yield _marked(_over(result, coarse, facts))
    finally:
        stopped.set()
        worker.join()


def _over(rgba: Any, coarse: Picture | None, facts: dict[str, Any]) -> Picture:
    """The pixels that are drawn, and the coarser picture where none are yet."""
    if coarse is None:
        return Picture(rgba, report=Report(facts))
    return Picture(np.where(rgba[..., 3:] > 0, rgba, coarse.rgba), report=Report(coarse.report))
