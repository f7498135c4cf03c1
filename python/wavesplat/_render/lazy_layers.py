"""Layers of a picture with at least one lazy volume: their levels, the plan of a frame, and its drawing.

Fields that colour layers are sources of samples too: they come after the layers, in the order of these.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from wavesplat import _native
from wavesplat._model.camera.camera import Camera
from wavesplat._model.lazy.array import lazy_array
from wavesplat._model.lazy.lazy_array import LazyArray
from wavesplat._model.lazy.memory_budget import check_budget
from wavesplat._model.lazy.parts import box_of_crop, corners_of_crop
from wavesplat._model.lazy.read_ahead import ReadCounts
from wavesplat._model.lazy.volume import LazyVolume, Level, lazily
from wavesplat._model.volume.stack import Box
from wavesplat._model.volume.volume import Volume
from wavesplat._model.volume.wavelet_volume import WaveletVolume
from wavesplat._render.arguments import chosen_labels
from wavesplat._render.streaming import Corners, Reading, Streaming, streamed
from wavesplat._storage.file_states import FileChangedError
from wavesplat.errors import ArgumentError

if TYPE_CHECKING:
    from wavesplat._geometry.shape_arrays import ShapeArrays
    from wavesplat._looks.curves.transfer_function import TransferFunction
    from wavesplat._looks.curves.transfer_function_2d import TransferFunction2D
    from wavesplat._looks.labels.labels import Labels
    from wavesplat._looks.shading import Shading
    from wavesplat._model.arguments.clips import Crop
    from wavesplat._model.volume.cutting import Boxes
    from wavesplat._render.options import DrawOptions

#: Text of the report where range and bounds were read from a cache folder, without a pass over the samples.
FROM_CACHE = "from the cache"


@dataclass
class LazyLayers:
    """The layers, and after them the fields that colour layers, as lazy volumes, each with the level that is drawn."""

    volumes: list[LazyVolume]
    levels: list[int]
    #: The only box of each level that is read, where a crop hides the rest.
    boxes: list[Box | None]
    options: DrawOptions
    #: Number of changes of each volume's samples that were found before.
    n_changes: list[int]

    @classmethod
    def of(
        cls,
        volumes: Sequence[Volume | WaveletVolume],
        camera: Camera,
        size: tuple[int, int],
        options: DrawOptions,
        crop: Crop | None,
    ) -> LazyLayers | None:
        """Volumes of layers, then of fields, as lazy ones; None where none is lazy, and nothing asks for blocks.

        crop : the box that is drawn, in the world or in samples of the first volume.
        """
        is_asked_for = options.segments is not None or options.client is not None
        if not is_asked_for and not any(isinstance(volume, LazyVolume) for volume in volumes):
            return None
        if options.psnr is not None:
            raise ArgumentError(
                "psnr draws parts of a picture several times, which lazy volumes do not do; "
                "give a quality or a Sampling"
            )
        lazy = [_lazily(volume) for volume in volumes]
        levels = [volume.level_for(lambda level: pixel_in_samples(level, camera, size)) for volume in lazy]
        corners = None if crop is None else corners_of_crop(lazy[0], crop)
        boxes = [box_of_crop(volume, level, corners) for volume, level in zip(lazy, levels, strict=True)]
        return cls(lazy, levels, boxes, options, [volume.n_changes_of_files() for volume in lazy])

    @property
    def _places(self) -> Iterator[tuple[LazyVolume, int, Box | None]]:
        """Each volume with its level and the box of it that is read."""
        return zip(self.volumes, self.levels, self.boxes, strict=True)

    def for_module(
        self,
        functions: Sequence[TransferFunction | TransferFunction2D],
        lights: Sequence[Shading | None],
        colors: Sequence[TransferFunction | None],
    ) -> list[tuple[Any, Any, Any, Any]]:
        """The layers for the compiled module: volume, transfer function, light, and the field that colours it."""
        kernel = self.options.kernel
        cores = [volume.core_of(level, kernel, box) for volume, level, box in self._places]
        of_layers, of_fields = cores[: len(functions)], iter(cores[len(functions) :])
        fields = [None if color is None else (next(of_fields), color._core) for color in colors]
        return [
            (core, function._core, None if light is None else light._core, field)
            for core, function, light, field in zip(of_layers, functions, lights, fields, strict=True)
        ]

    def _check_unchanged(self) -> None:
        """Raise a `FileError` if samples changed since bounds were taken, as another thread or machine found."""
        is_read_elsewhere = self.options.client is not None
        for volume, n_before in zip(self.volumes, self.n_changes, strict=True):
            if volume.n_changes_of_files(now=is_read_elsewhere) != n_before:
                raise FileChangedError(
                    f"{volume.name!r}: samples were written to while they were drawn; draw again once nobody writes "
                    "to them"
                )

    def _where_surveys_are_from(self) -> list[str]:
        """Origin of each source's range and bounds: the cache, or a pass over the samples."""
        kernel = self.options.kernel
        surveys = [volume.survey(level, kernel, box) for volume, level, box in self._places]
        return [FROM_CACHE if survey.is_from_cache else "computed" for survey in surveys]

    @property
    def arrays(self) -> list[LazyArray]:
        """Arrays that the samples of each source are read from."""
        return [volume.arrays(level) for volume, level in zip(self.volumes, self.levels, strict=True)]

    @property
    def least(self) -> list[float] | None:
        """Value in place of each source's samples that cannot be read; None ends the picture."""
        if not all(volume.holes for volume in self.volumes):
            return None
        kernel = self.options.kernel
        return [volume.survey(level, kernel, box).value_range[0] for volume, level, box in self._places]

    @property
    def memory(self) -> int:
        """Bytes for samples and bounds: the least that any of the volumes allows."""
        return min(volume.memory for volume in self.volumes)

    def streamed(self, spec: FrameSpec) -> tuple[_native.Stream, ReadCounts]:
        """The stream of a frame with all blocks, drawn by this process, and counts of what was read."""
        if self.options.before_plan is not None:
            self.options.before_plan(spec)
        if self.options.draw_frame is not None:
            drawn: tuple[_native.Stream, ReadCounts] = self.options.draw_frame(spec)
            return drawn
        stream = spec.stream()
        reading = Reading(spec.arrays, spec.least, self.options.progress, spec.budget)
        return stream, streamed(stream, reading, self.options.after_block)

    def finished(self, stream: _native.Stream, counts: ReadCounts) -> _native.RenderResult:
        """The picture of a stream with all blocks, as `_native.render` gives it."""
        self._check_unchanged()
        result = stream.picture()
        result["report"]["lazy"] = {
            "levels": list(self.levels),
            "surveys": self._where_surveys_are_from(),
            "bytes_read": counts.n_bytes,
            "blocks": stream.n_blocks,
            "seconds": round(counts.seconds, 3),
            "seconds_waited": round(counts.waited, 3),
        }
        if counts.holes:
            result["report"]["holes"] = list(counts.holes)
        return result


@dataclass
class FrameSpec:
    """Specification of a frame of lazy layers, from which any process can plan it: it can be pickled."""

    layers: LazyLayers
    #: Transfer functions with the layers' opacities, and lights.
    functions: list[TransferFunction | TransferFunction2D]
    lights: list[Shading | None]
    #: Transfer functions of the fields that colour layers, per layer.
    colors: list[TransferFunction | None]
    camera: Camera
    #: Labels of the first layer, and boxes that are cut out of them.
    labels: Labels | None
    boxes: Boxes
    #: The arguments of the compiled module, without labels and shapes.
    arguments: dict[str, Any]
    #: Shapes in space with the layers; None without any.
    shapes: ShapeArrays | None = None
    n_blocks: int = 1
    memory: int | None = None
    #: Surveys of the samples, for processes that have not looked through them: pickled, by source.
    surveys: list[bytes] | None = None

    def with_surveys(self) -> FrameSpec:
        """The specification with surveys of the samples."""
        kernel = self.layers.options.kernel
        packed = [volume.packed_surveys(level, kernel, box) for volume, level, box in self.layers._places]
        return replace(self, surveys=packed)

    @property
    def arrays(self) -> list[LazyArray]:
        """Arrays that the samples of each source are read from."""
        return self.layers.arrays

    @property
    def least(self) -> list[float] | None:
        """Value in place of each source's samples that cannot be read, as `LazyLayers.least`."""
        return self.layers.least

    @property
    def segments(self) -> int | None:
        """Slices of a segment of the rays."""
        return self.layers.options.segments

    @property
    def budget(self) -> int:
        """Bytes for samples and bounds."""
        return self.memory or self.layers.memory

    def stream(self, part: Corners | None = None) -> _native.Stream:
        """The stream of the frame, which is the same in every process; `part`: the index-space box that is drawn."""
        for volume, packed in zip(self.layers.volumes, self.surveys or [], strict=False):
            volume.take_surveys(packed)
        drawn = self.layers.for_module(self.functions, self.lights, self.colors)
        first, level = self.layers.volumes[0], self.layers.levels[0]
        labels = chosen_labels(self.labels, first, self.boxes, level=first.grid_of(level) if level else None)
        shapes = None if self.shapes is None else self.shapes.core
        arguments: Any = {**self.arguments, "labels": labels, "shapes": shapes}
        check_budget(self.arrays, self.budget)
        streaming = Streaming(self.budget, self.n_blocks, self.segments, part)
        return streaming.planned(drawn, self.camera._core, arguments)

    def __getstate__(self) -> dict[str, Any]:
        # Callbacks and connections stay in this process.
        nothing: Any = dict.fromkeys(("progress", "client", "before_plan", "after_block", "draw_frame"))
        plain = replace(self.layers.options, **nothing)
        return {**self.__dict__, "layers": replace(self.layers, options=plain)}


def pixel_in_samples(level: Level, camera: Camera, size: tuple[int, int]) -> float:
    """Distance of pixels where they are closest, in the smallest distance of a level's samples."""
    step = min(level.spacing)
    height = max(size[1], 1)
    if camera.parallel_scale is not None:
        return 2 * camera.parallel_scale / height / step
    corners = _corners(level)
    position, focal = np.array(camera.position), np.array(camera.focal_point)
    towards = (focal - position) / np.linalg.norm(focal - position)
    nearest = float(((corners - position) @ towards).min())
    if nearest <= 0:
        return 0.0  # inside: the finest
    half = np.tan(np.radians(camera.view_angle or 0.0) / 2)
    return float(2 * nearest * half / height / step)


def _corners(level: Level) -> Any:
    last = np.array(level.array.shape[::-1], np.float64) - 1
    index = np.array([[(k >> a) & 1 for a in range(3)] for k in range(8)]) * last
    return index @ level.world_from_index[:3, :3].T + level.world_from_index[:3, 3]


def _lazily(volume: Volume | WaveletVolume) -> LazyVolume:
    if isinstance(volume, LazyVolume):
        return volume
    if isinstance(volume, WaveletVolume):
        raise ArgumentError(
            f"volume {volume.name!r} has wavelet coefficients, and another layer is lazy; draw its to_volume(), "
            "or the other without memory="
        )
    # Kept with the volume, so that it is looked through once.
    made = volume._lazily
    if made is None:
        array = lazy_array(volume.samples).levels[0]
        made = volume._lazily = lazily(
            [array], [volume.world_from_index], volume.name, volume.facts, memory=None, keep=False
        )
    return made
