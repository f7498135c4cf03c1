"""Estimated cost of a picture before it is read or drawn: boxes, bytes, tasks, memory, time.

    T = T_plan + max(T_read, T_draw) + T_merge + T_send + T_tasks,
    T_read = bytes · amplification / (workers · rate),   T_draw = texels · sheets · ns / (workers · cores),
    T_merge = 16 bytes · texels · segments / (workers · rate),   T_tasks = tasks · 1 ms,
    T_send = bytes of shapes · workers / rate

Bytes are counted in the plan that the picture would be drawn by, chunk by chunk, with the share that a rehearsal of it
takes (`cost.py`); rates of reading and drawing are measured on this machine unless they are given. Blocks take
unequal times: half of the whole is added for the last ones.
"""

from __future__ import annotations

import math
import os
import time
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from wavesplat import _native
from wavesplat._cluster.machines import MAX_TASKS
from wavesplat._geometry.shape_arrays import LARGE_BYTES, ShapeArrays, as_shapes
from wavesplat._looks.curves.transfer_function import TransferFunction
from wavesplat._looks.look import Look
from wavesplat._looks.shading import Shading
from wavesplat._model.arguments.clips import Crop
from wavesplat._model.arguments.types import takes_its_types
from wavesplat._model.camera.camera import Camera
from wavesplat._model.lazy.array import SlicedArray
from wavesplat._model.lazy.memory_budget import FOR_UNPACKING, UNPACKED_TIMES, check_budget, unpacked_bytes
from wavesplat._model.lazy.parts import box_of_crop, corners_of_crop
from wavesplat._model.lazy.read_ahead import (
    PART_BYTES,
    cells,
    n_in,
)
from wavesplat._model.lazy.survey import Survey
from wavesplat._model.lazy.volume import LazyVolume, Level, lazily
from wavesplat._model.volume.volume import Volume
from wavesplat._public import public
from wavesplat._render.arguments import checked_count, checked_size
from wavesplat._render.framing import natural_view
from wavesplat._render.lazy_layers import FrameSpec, pixel_in_samples
from wavesplat._render.options import DrawOptions
from wavesplat._render.streaming import Reading, Streaming, streamed
from wavesplat._scene.drawing.drawing import draw
from wavesplat._scene.scene import Scene
from wavesplat._scene.slices.cards import size_of_card
from wavesplat._system.memory import byte_size, bytes_of, resident_bytes
from wavesplat._system.values import described
from wavesplat.errors import ArgumentError, CancelledError, LimitError

if TYPE_CHECKING:
    from wavesplat._geometry.slice_plane import SlicePlane
    from wavesplat._model.volume.grid import Grid

# Bytes of the shapes of a picture, before anything is drawn or read.

#: Bytes that a process takes for shapes while it draws, as a multiple of their arrays: these, the compiled module's,
#: and where the shapes lie in the picture. Measured: 2.9 for 5 million triangles.
SHAPE_COPIES = 4


def bytes_of_geometry(geometry: Any, volume: Grid) -> int:
    """Bytes of the arrays of shapes, as they travel to workers; 0 without any. `volume`: the scene's first.

    Raises
    ------
    ArgumentError
        If something is no shape.
    """
    shown = [shape for shape in as_shapes(geometry) if shape._is_seen]

    def empty_cards(plane: SlicePlane) -> tuple[list[_native.CardArrays], dict[str, Any]]:
        width, height = size_of_card(plane, volume)
        card: _native.CardArrays = {
            "corner": (0.0, 0.0, 0.0),
            "along_x": (1.0, 0.0, 0.0),
            "along_y": (0.0, 1.0, 0.0),
            "rgba": np.broadcast_to(np.float32(0), (height, width, 4)),
            "style": (plane.opacity, False, plane.clipped),
        }
        return [card] if width * height else [], {}

    return ShapeArrays.of(shown, empty_cards, volume.bounds, (True, True, True)).n_bytes


# Rehearsal of a streamed picture with thinned samples: the share of its planned reads and texels that it takes.
#
# Rays end where matter is opaque, which no plan knows before it is drawn. The samples that a survey kept are enough to
# find where: they are drawn from the same camera, with the same look and as many blocks, which takes a second.

#: Pixels along the longer side of a rehearsal, at most.
MAX_PIXELS = 512


@dataclass(frozen=True)
class Shares:
    """Shares of planned bytes, and of planned texels, that a picture takes; 1 where nothing is left out."""

    read: float = 1.0
    drawn: float = 1.0


def frame_of(
    volume: Volume, look: Look | None, camera: Camera | None, options: DrawOptions, crop: Crop | None = None
) -> FrameSpec:
    """The frame that `render` streams for a lazy volume; nothing is read but what its look needs."""
    found: list[FrameSpec] = []

    def keep(spec: FrameSpec) -> None:
        found.append(spec)
        raise CancelledError("only planned")

    try:
        draw(Scene(volume, look, clip=crop or ()), camera, replace(options, before_plan=keep))
    except CancelledError:
        if not found:
            raise
    return found[0]


def rehearsed(
    spec: FrameSpec, n_blocks: int, level: Level, survey: Survey, corners: NDArray[np.float64] | None
) -> Shares:
    """Shares of a frame of one layer, in as many blocks; 1 where the survey is of a crop alone.

    corners : the corners of the crop in the world, shape (8, 3).
    """
    if not survey.is_whole:
        return Shares()
    # The closest samples: chunks of few samples would be put together to deeper steps than the picture's.
    (step, *_), samples = survey.finest(is_cube=True)
    samples = samples.astype(level.array.dtype)
    if min(samples.shape) < 2:
        return Shares()
    matrix = level.world_from_index.copy()
    matrix[:3, :3] *= step
    chunks = [max(1, round(n / step)) for n in level.array.chunks]
    array = SlicedArray(samples, name="rehearsal", chunks=chunks)
    thinned: LazyVolume = lazily([array], [matrix], "rehearsal", spec.layers.volumes[0].facts, memory=None, keep=False)
    function: Any = spec.functions[0]
    if isinstance(function, TransferFunction) and function.opacity_unit is None:
        # The unit is a length of the samples, which lie further apart here.
        finest = spec.layers.volumes[0].world_from_index
        unit = float(abs(np.linalg.det(finest[:3, :3])) ** (1 / 3))
        function = TransferFunction(function.opacity, function.color, unit, function.gradient_opacity)
    width, height = spec.arguments["width"], spec.arguments["height"]
    scale = min(1.0, MAX_PIXELS / max(width, height))
    size = max(1, round(scale * width)), max(1, round(scale * height))
    look = Look(transfer_function=function, shading=spec.lights[0], composite=spec.arguments["composite"])
    crop = None if corners is None else Crop(corners.min(axis=0), corners.max(axis=0))
    own = frame_of(thinned, look, spec.camera, DrawOptions(size=size, device="cpu"), crop)
    own = replace(own, n_blocks=n_blocks)
    try:
        # Steps are as deep, in the world, as the steps of the frame within its budget.
        stream = replace(own, memory=max(1, spec.budget // step**3)).stream()
    except LimitError:
        stream = own.stream()
    n_bytes = sum(stream.bytes_to_read())
    n_texels = sum(stream.n_texels(block) for block in range(stream.n_blocks))
    counts = streamed(stream, Reading(own.arrays, own.least))
    report = stream.picture()["report"]
    return Shares(counts.n_bytes / max(n_bytes, 1), report["n_texels"] / max(n_texels, 1))


# Estimated cost of a picture of a lazy volume before it is read: boxes, bytes, tasks, memory, time.

#: Blocks of a picture for each worker.
BLOCKS_PER_WORKER = 4
#: Seconds that a scheduler takes for a task, bytes of a texel of a partial picture, and bytes a second between workers.
TASK_S, PARTIAL_BYTES, MERGE_RATE = 1e-3, 16, 200e6
#: Bytes of a ray with its place in the picture, of a process whose memory cannot be measured, and of its threads while
#: it draws; the last two measured (Linux, CPython 3.11, two threads).
RAY_BYTES, PROCESS_BYTES, THREAD_BYTES = 40, 60_000_000, 60_000_000
#: Cells along a side of the bricks that bounds are kept of, and samples that are kept for looks, at most.
BRICK_SIDES, MAX_LOOK_SAMPLES = (4, 8, 16, 32, 64), 3_000_000
#: Factor of the time for blocks that are done last.
STRAGGLERS = 1.5
#: Number of boxes that are read to measure the rate of reading, and bytes of each.
N_PROBES, PROBE_BYTES = 4, 8 << 20


@public
@dataclass(frozen=True)
class Cost:
    """Estimated cost of a picture; numbers are for all of it, or for one worker where they say so.

    Attributes
    ----------
    shape : (z, y, x)
        Samples of the level that is drawn; `level` is its number, 0 the finest.
    chunks : int
        Chunks of its file.
    blocks, steps, tasks, boxes : int
        Blocks of the picture, steps that all of them take, tasks of a cluster, boxes that are read.
    bytes_stored, bytes_read : int
        Bytes of the level in memory, and of all reads: neighbouring blocks share chunks. Where the samples were looked
        through before (`is_known`), what shows nothing in their automatic look is not read, nor what lies behind opaque
        matter, whose share is found by drawing a thinned copy. Else all counts, and the pass that looks through the
        samples before the first picture reads them once more.
    memory : int
        Bytes that a worker's process takes at most, Python and its libraries included.
    bytes_surveyed : int
        Bytes of the pass that looks through the samples before the first picture; 0 where that was done before. Of a
        crop of a pyramid it reads the crop's chunks alone.
    partial_bytes : int
        Bytes of partial pictures that are merged; 0 without segments.
    geometry_bytes : int
        Bytes of surfaces, lines and points, all of which every worker has.
    seconds : dict
        `plan`, `read`, `draw`, `merge`, `send` (of geometry to workers), `tasks` and `whole`. Drawing geometry is
        not counted.
    rates : dict
        `read` (bytes a second of a worker), `draw` (nanoseconds of a texel on one core): measured here, or given.
    """

    shape: tuple[int, int, int]
    level: int
    chunks: int
    blocks: int
    steps: int
    tasks: int
    boxes: int
    bytes_stored: int
    bytes_read: int
    bytes_surveyed: int
    is_known: bool
    memory: int
    partial_bytes: int
    geometry_bytes: int
    seconds: dict[str, float]
    rates: dict[str, float]
    workers: int
    cores: int

    def lines(self) -> list[str]:
        """The cost as lines of text."""
        z, y, x = self.shape
        seconds = ", ".join(f"{name} {value:.3g}" for name, value in self.seconds.items() if name != "whole")
        known = (
            "what shows nothing left out"
            if self.is_known
            else f"nothing is known of the samples, so all that the picture can show, after a first pass over "
            f"{byte_size(self.bytes_surveyed)}"
        )
        tasks = f"{self.tasks} tasks for {self.workers} workers of {self.cores} cores"
        share = f"{self.bytes_read / max(self.bytes_stored, 1):.2f} of the level ({known})"
        rates = f"reading {byte_size(self.rates['read'])}/s a worker, drawing {self.rates['draw']:.2g} ns a texel"
        geometry = []
        if self.geometry_bytes:
            travels = ", all of it sent to each worker" if self.workers > 1 else ""
            thin = "; thin it out if that takes long" if travels and self.geometry_bytes > LARGE_BYTES else ""
            geometry = [f"geometry {byte_size(self.geometry_bytes)}{travels}{thin}"]
        return [
            f"level {self.level}: z {z}, y {y}, x {x}, {byte_size(self.bytes_stored)} in {self.chunks} chunks",
            f"{self.blocks} blocks, {self.steps} steps, {self.boxes} boxes; {tasks}",
            f"read {byte_size(self.bytes_read)}, {share}",
            f"memory {byte_size(self.memory)} of each worker"
            + (f", partial pictures {byte_size(self.partial_bytes)}" if self.partial_bytes else ""),
            *geometry,
            f"about {self.seconds['whole']:.3g} s: {seconds} ({rates})",
        ]

    def as_json(self) -> dict[str, Any]:
        """The numbers as JSON has them."""
        return dict(self.__dict__)


@public
@takes_its_types
def plan(
    volume: Volume,
    *,
    size: tuple[int, int] = (512, 512),
    camera: Camera | None = None,
    workers: int = 1,
    cores: int | None = None,
    memory: float | str | None = None,
    segments: int | None = None,
    read_rate: float | str | None = None,
    draw_ns: float | None = None,
    geometry: Any = None,
    crop: Crop | None = None,
) -> Cost:
    """Estimate the cost of a picture of a lazy volume, on this machine or on many, before it is drawn.

    Parameters
    ----------
    volume : LazyVolume
        From `open(path, memory=...)` or `Volume.lazy`. What earlier pictures kept of it leaves out chunks that show
        nothing; without that all chunks count.
    size : (width, height), default (512, 512)
        Pixels.
    camera : Camera, optional
        None is a three-quarter view of all of it, or of the crop.
    workers, cores : int
        Machines, and cores of each; None is the cores of this machine.
    memory : str or number, optional
        Memory of a worker for samples and bounds; None is the volume's.
    segments : int, optional
        Slices of a segment, as for `render`.
    read_rate : str or number, optional
        Bytes a second that a worker reads, unpacked, such as "250 MB"; None measures it on some boxes of the volume.
    draw_ns : float, optional
        Nanoseconds of a texel on one core; None measures it on a small volume.
    geometry : shape or list of them, optional
        Surfaces, lines, points, slices and frames in the picture, as for `render`: their memory, and their way to the
        workers. Slices are not made for it.
    crop : Crop, optional
        The box that is drawn.

    Returns
    -------
    Cost
        Numbers; `lines()` says them for people.

    Raises
    ------
    ArgumentError
        If the volume is not lazy, or there would be too many tasks.
    LimitError
        If the memory does not hold the smallest step; the message says what does.

    Examples
    --------
    >>> import numpy as np, wavesplat as ws
    >>> lazy = ws.Volume.lazy(np.zeros((64, 64, 64), np.uint8), memory="100 MB")
    >>> ws.plan(lazy, workers=4, read_rate="250 MB", draw_ns=4).bytes_stored
    262144
    """
    begun = time.perf_counter()
    if not isinstance(volume, LazyVolume):
        raise ArgumentError(f"volume is {described(volume)}, which is in memory; plan is for wavesplat.LazyVolume")
    if not (checked_count(workers, "workers") and checked_count(cores, "cores") != 0):
        raise ArgumentError(f"workers is {workers} and cores {cores}; give 1 or more of each")
    checked_count(segments, "segments")
    if draw_ns is not None and not (math.isfinite(draw_ns) and draw_ns > 0):
        raise ArgumentError(f"draw_ns is {draw_ns}; give a positive number of nanoseconds")
    if not isinstance(camera, Camera | None):
        raise ArgumentError(f"camera is {described(camera)}; give a wavesplat.Camera or None")
    checked_size(size)
    n_geometry = 0 if geometry is None else bytes_of_geometry(geometry, volume)
    corners, aspect = _shown_corners(volume, crop), size[0] / max(size[1], 1)
    eye = camera or Camera.orbit(volume, *natural_view(volume), aspect=aspect, points=corners)
    width, height = checked_size(size)
    number = volume.level_for(lambda level: pixel_in_samples(level, eye, (width, height)))
    level = volume._levels[number]
    budget = volume.memory if memory is None else bytes_of(memory)
    check_budget([level.array], budget)
    n_blocks = 1 if workers == 1 else BLOCKS_PER_WORKER * workers
    base = resident_bytes() or PROCESS_BYTES
    box = box_of_crop(volume, number, corners)
    survey = volume.known_survey(number, "linear", box) if volume.is_looked_through else None
    options = DrawOptions(size=(width, height), segments=segments, device="cpu")
    if survey is None:
        streaming = Streaming(budget, n_blocks, segments)
        stream, shares = _stream(_core_of(volume, level), eye, options, streaming, corners), Shares()
    else:
        spec = replace(frame_of(volume, None, camera, options, crop), n_blocks=n_blocks, memory=budget)
        stream = spec.stream()
        shares = rehearsed(spec, stream.n_blocks, level, survey, corners)
    costs = [round(shares.read * n) for n in stream.bytes_to_read()]
    n_segments = sum(len(stream.segments(block)) for block in range(stream.n_blocks))
    steps = sum(stream.n_steps(block) for block in range(stream.n_blocks))
    tasks = stream.n_blocks if segments is None else n_segments + stream.n_blocks
    if tasks > MAX_TASKS:
        raise ArgumentError(f"this would take {tasks} tasks, and {MAX_TASKS} are the most; give longer segments")
    itemsize = level.array.dtype.itemsize
    texels = [stream.n_texels(block) for block in range(stream.n_blocks)]
    n_cores = cores or os.cpu_count() or 1
    rates = {
        "read": _read_rate(volume, number) if read_rate is None else float(bytes_of(read_rate, "read_rate")),
        "draw": _draw_ns() if draw_ns is None else float(draw_ns),
    }
    partial = 0 if segments is None else PARTIAL_BYTES * sum(stream.n_rays(block) for block in _segment_blocks(stream))
    planned = time.perf_counter() - begun
    seconds = {
        "plan": planned,
        "read": sum(costs) / (workers * rates["read"]),
        "draw": shares.drawn * sum(texels) * rates["draw"] * 1e-9 / (workers * n_cores),
        "merge": partial / (workers * MERGE_RATE),
        "send": 0.0 if workers == 1 else n_geometry * workers / MERGE_RATE,
        "tasks": 0.0 if workers == 1 else tasks * TASK_S,
    }
    longest = max(seconds["read"], seconds["draw"]) * (STRAGGLERS if workers > 1 else 1.0)
    seconds["whole"] = seconds["plan"] + longest + seconds["merge"] + seconds["send"] + seconds["tasks"]
    n_chunks = math.prod(-(-n // c) for n, c in zip(level.array.shape, level.array.chunks, strict=True))
    held = max(stream.peak_sample_bytes(block) for block in range(stream.n_blocks))
    rays = RAY_BYTES * sum(stream.n_rays(block) for block in range(stream.n_blocks)) // workers
    return Cost(
        shape=level.array.shape,
        level=number,
        chunks=n_chunks,
        blocks=stream.n_blocks,
        steps=steps,
        tasks=tasks if workers > 1 or segments is not None else 1,
        boxes=stream.n_boxes(),
        bytes_stored=math.prod(level.array.shape) * itemsize,
        bytes_read=sum(costs),
        bytes_surveyed=0 if survey else itemsize * n_in(box or ((0, 0, 0), level.array.shape)),
        is_known=survey is not None,
        memory=base + held + rays + SHAPE_COPIES * n_geometry + _memory_beside(level, budget),
        partial_bytes=partial,
        geometry_bytes=n_geometry,
        seconds=seconds,
        rates=rates,
        workers=workers,
        cores=n_cores,
    )


def _segment_blocks(stream: _native.Stream) -> list[int]:
    return [block for block in range(stream.n_blocks) for _ in stream.segments(block)]


#: Transfer function with which all values from 0 to 1 are faintly visible.
ALL_SEEN = TransferFunction([(0.0, 0.01), (1.0, 0.01)], [(0.0, 1.0, 1.0, 1.0)])


def _core_of(volume: LazyVolume, level: Level) -> _native.LazyVolume:
    """The level for the plan, as if all of it were visible."""
    shape, side = level.array.shape, 64
    n = [-(-(n - 1) // side) for n in shape]
    bounds = np.broadcast_to(np.array([0, 1], np.float32), (*n, 2)).copy()
    return _native.LazyVolume(
        volume.name,
        shape,
        level.world_from_index,
        kernel="linear",
        is_narrow=True,
        survey=_native.Survey.from_parts(shape, "linear", side, (0.0, 1.0, 0), bounds, []),
        prepared=None,
        light=0,
        chunk=level.array.chunks,
        sample_bytes=level.array.dtype.itemsize,
        level=None,
    )


def _memory_beside(level: Level, budget: int) -> int:
    """Bytes beside samples and rays: samples for light and looks, bounds, what is being unpacked, threads."""
    array, shape = level.array, level.array.shape
    steps = _native.light_step(shape, level.world_from_index)
    light = 4 * math.prod(-(-n // step) for n, step in zip(shape, steps, strict=True))
    bounds = next((n for n in map(partial(_bounds_bytes, shape), BRICK_SIDES) if n <= budget // 4), 0)
    looks = min(math.prod(shape), MAX_LOOK_SAMPLES) * array.dtype.itemsize
    parts = min(int(budget * FOR_UNPACKING), UNPACKED_TIMES * PART_BYTES * array.n_readers)
    return light + looks + bounds + max(unpacked_bytes(array), parts) + THREAD_BYTES


def _bounds_bytes(shape: Sequence[int], side: int) -> int:
    """Bytes of the bounds of bricks. `side`: cells along a side of a brick."""
    return 8 * math.prod(-(-(n - 1) // side) for n in shape)


def _shown_corners(volume: LazyVolume, crop: Crop | None) -> NDArray[np.float64] | None:
    """The corners of a crop in the world, shape (8, 3), within the bounds of the volume."""
    if crop is None:
        return None
    if not isinstance(crop, Crop):
        raise ArgumentError(f"crop is {described(crop)}; give a wavesplat.Crop or None")
    return np.clip(corners_of_crop(volume, crop), *volume.bounds)


def _stream(
    core: _native.LazyVolume,
    camera: Camera,
    options: DrawOptions,
    streaming: Streaming,
    corners: NDArray[np.float64] | None,
) -> _native.Stream:
    """The stream of a volume whose samples were not surveyed. `corners`: of the box that is drawn."""
    drawn, size = [(core, ALL_SEEN._core, None, None)], options.size
    sheets, texels = _native.quality_settings("normal", drawn, ("over", []), camera._core, size[1])
    frame: Any = {
        "labels": None,
        "width": size[0],
        "height": size[1],
        "kernel": "linear",
        "composite": "over",
        "numbers": [],
        "sheets_per_slice": sheets,
        "oversampling": texels,
        "psnr": None,
        "like": None,
        "crop_index": None,
        "crop_world": None if corners is None else (tuple(corners.min(axis=0)), tuple(corners.max(axis=0))),
        "clip_planes": [],
        "background": None,
        "threads": None,
        "device": "cpu",
        "depth": False,
        "depth_colors": None,
        "shapes": None,
        "pre_integration": True,
        "early_ray_termination": True,
    }
    return streaming.planned(drawn, camera._core, frame)


def _read_rate(volume: LazyVolume, number: int) -> float:
    """Bytes a second that this machine reads and unpacks, by some boxes in the middle and around it."""
    array = volume.arrays(number)
    whole = ((0, 0, 0), array.shape)
    boxes = cells(whole, array.chunks, max(1, PROBE_BYTES // array.dtype.itemsize))
    chosen = [boxes[len(boxes) * (2 * k + 1) // (2 * N_PROBES)] for k in range(N_PROBES)]
    begun, n_bytes = time.perf_counter(), 0
    for box in dict.fromkeys(chosen):
        n_bytes += array.read(*box).nbytes
    one = n_bytes / max(time.perf_counter() - begun, 1e-6)
    return one * min(array.n_readers, os.cpu_count() or 1)


def _draw_ns() -> float:
    """Nanoseconds of a texel on one core: a soft picture of a small volume."""
    n = 96
    z, y, x = np.ogrid[-1:1:96j, -1:1:96j, -1:1:96j]
    samples = (127 * (1 + np.sin(9 * x + 5 * z) * np.cos(7 * y))).astype(np.uint8)
    volume = Volume(samples, name="probe")
    look = TransferFunction([(0, 0.0), (255, 0.05)], [(0, 1.0, 1.0, 1.0)])
    from wavesplat._scene.drawing.drawing import draw
    from wavesplat._scene.scene import Scene

    scene = Scene(volume, look, shading=Shading())
    camera = Camera.orbit(volume, 30, 20)
    options = DrawOptions(size=(2 * n, 2 * n), threads=1, device="cpu")
    draw(scene, camera, options)
    begun = time.perf_counter()
    picture = draw(scene, camera, options)
    return 1e9 * (time.perf_counter() - begun) / max(int(picture.report["n_texels"]), 1)
