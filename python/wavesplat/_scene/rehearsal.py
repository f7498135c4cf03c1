"""Rehearsal of a streamed picture with thinned samples: the share of its planned reads and texels that it takes.

Rays end where matter is opaque, which no plan knows before it is drawn. The samples that a survey kept are enough to
find where: they are drawn from the same camera, with the same look and as many blocks, which takes a second.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wavesplat._looks.look import Look
from wavesplat._looks.transfer_function import TransferFunction
from wavesplat._model.camera import Camera
from wavesplat._model.crop import Crop
from wavesplat._model.lazy_array import SlicedArray
from wavesplat._model.lazy_volume import LazyVolume, Level, lazily
from wavesplat._model.survey import Survey
from wavesplat._model.volume import Volume
from wavesplat._render.lazy_layers import FrameSpec
from wavesplat._render.options import DrawOptions
from wavesplat._render.streaming import Reading, streamed
from wavesplat._scene.drawing import draw
from wavesplat._scene.scene import Scene
from wavesplat.errors import CancelledError, LimitError

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
        # Steps are as deep, in the world, as those of the frame within its budget.
        stream = replace(own, memory=max(1, spec.budget // step**3)).stream()
    except LimitError:
        stream = own.stream()
    n_bytes = sum(stream.bytes_to_read())
    n_texels = sum(stream.n_texels(block) for block in range(stream.n_blocks))
    counts = streamed(stream, Reading(own.arrays, own.least))
    report = stream.picture()["report"]
    return Shares(counts.n_bytes / max(n_bytes, 1), report["n_texels"] / max(n_texels, 1))
