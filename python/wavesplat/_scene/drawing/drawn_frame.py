"""A frame of a scene: what its layers share, and the call of the compiled module that draws them."""

from __future__ import annotations

import atexit
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from wavesplat import _native
from wavesplat._looks.curves import colors
from wavesplat._looks.labels.labels import Labels
from wavesplat._looks.shading import Shading
from wavesplat._model.arguments.clips import Clipping
from wavesplat._model.arguments.operators import DepthColoredMaximum, FirstHit, Operator, XRay, name_of
from wavesplat._model.arguments.sampling import Sampling
from wavesplat._model.camera.camera import Camera
from wavesplat._model.volume.forked import drawing
from wavesplat._render import projection
from wavesplat._render.arguments import (
    check_picture_memory,
    chosen_labels,
    chosen_threads,
    region,
)
from wavesplat._render.devices import chosen_device
from wavesplat._render.eyes import in_world
from wavesplat._render.lazy_layers import FrameSpec, LazyLayers
from wavesplat._render.options import DrawOptions
from wavesplat._scene.drawing.drawn_layers import Curves, DrawnLayer, colors_of, for_module, sources_of
from wavesplat._scene.drawing.volumes_of_layers import identity_of

if TYPE_CHECKING:
    from wavesplat._geometry.shape_arrays import ShapeArrays
    from wavesplat._scene.scene import Scene

# Errors measured for a wanted PSNR, kept for the next pictures that show the same.


@dataclass(frozen=True)
class MeasuredErrors:
    """The measurements of a picture, and of the last picture of its kind."""

    is_wanted: bool
    #: The scene's `Cache`.
    cache: Any
    #: Properties that pictures with the same measurements share, and all that this one shows.
    kind: Any
    shown: Any

    def recalled(self) -> dict[str, Any] | None:
        """The last picture's measurements; None where there are none, or it showed something else."""
        if not self.is_wanted or self.kind not in self.cache.measured:
            return None
        shown, found = self.cache.measured[self.kind]
        measured: dict[str, Any] | None = found if shown == self.shown else None
        return measured

    def remember(self, report: dict[str, Any]) -> None:
        """Keep the measurements in a picture's report."""
        if self.is_wanted and report.get("measured") is not None:
            self.cache.remember(self.kind, self.shown, report["measured"])


# A frame of a scene: what its layers share, and the call of the compiled module that draws them.

# Drivers do not like processes that end while a GPU is being opened.
atexit.register(_native.gpu_settle)

#: Bytes of a pixel (colour, depth, value), and of a texel, of which a pixel has `oversampling` squared; measured.
PIXEL_BYTES, TEXEL_BYTES = 20, 20
#: Oversampling beyond which the check of memory refuses any picture.
MAX_OVERSAMPLING = 1e6


@dataclass(frozen=True)
class DrawnFrame:
    """Arguments of a picture that all its layers share."""

    scene: Scene
    camera: Camera
    size: tuple[int, int]
    sampling: Sampling
    operator: Operator
    clipping: Clipping
    labels: Labels | None
    background: colors.Rgba | None
    options: DrawOptions
    #: Shapes in space with the layers; None without any.
    shapes: ShapeArrays | None
    #: Whose light it has, in a panorama.
    light: Camera | None = None

    @property
    def composite(self) -> str:
        return name_of(self.operator)


def rendered(
    frame: DrawnFrame, layers: Sequence[DrawnLayer], functions: Sequence[Curves]
) -> tuple[_native.RenderResult, dict[str, Any]]:
    """Result of the compiled module for layers, and its report."""
    options, (width, height), operator = frame.options, frame.size, frame.operator
    lazy = LazyLayers.of(sources_of(layers), frame.camera, frame.size, options, frame.scene._clipping.crop)
    faded = [with_opacity(frame, layer, function) for layer, function in zip(layers, functions, strict=True)]
    lights = [_light(frame.scene, layer, frame.light) for layer in layers]
    colors = colors_of(layers, faded, operator)
    drawn = for_module(layers, faded, lights, colors, lazy)
    absorbs = projection.absorption(operator, layers[0].volume) if isinstance(operator, XRay) else None
    numbers = projection.numbers(operator, functions[0], layers[0].volume, absorbs)
    in_order = [operator.iso_value] if isinstance(operator, FirstHit) else projection.in_order(numbers)
    compiled = projection.compiled_name(operator), in_order
    errors = _measured_errors(frame, layers, functions)
    with drawing(*(layer.volume for layer in layers), *(layer.color.volume for layer in layers if layer.color)):
        sheets_per_slice, oversampling = _sampling(frame, drawn, compiled)
        texels = 1 if options.psnr is not None else min(abs(oversampling), MAX_OVERSAMPLING) ** 2
        check_picture_memory(frame.size, PIXEL_BYTES + TEXEL_BYTES * texels)
        arguments: dict[str, Any] = {
            "width": width,
            "height": height,
            "kernel": options.kernel,
            "composite": compiled[0],
            "numbers": compiled[1],
            "sheets_per_slice": sheets_per_slice,
            "oversampling": oversampling,
            "psnr": None if options.psnr is None else float(options.psnr),
            "like": errors.recalled(),
            **region(frame.clipping),
            "background": frame.background,
            "threads": chosen_threads(options.threads),
            "device": chosen_device(options.device),
            "depth": bool(options.depth),
            "depth_colors": projection.depth_colors(operator),
            "pre_integration": bool(options.pre_integration),
            "early_ray_termination": bool(options.early_ray_termination),
        }
        labels, boxes = frame.labels, layers[0].boxes
        if lazy is None:
            shapes = None if frame.shapes is None else frame.shapes.core
            of_frame: Any = {**arguments, "labels": chosen_labels(labels, layers[0].volume, boxes), "shapes": shapes}
            result = _native.render(drawn, frame.camera._core, of_frame, options.progress)
        else:
            spec = FrameSpec(lazy, faded, lights, colors, frame.camera, labels, boxes, arguments, frame.shapes)
            if options.client is None:
                drawn_stream = lazy.streamed(spec)
            else:
                from wavesplat._cluster.blocks import drawn_on_machines

                drawn_stream = drawn_on_machines(spec, options.client, options.progress)
            result = lazy.finished(*drawn_stream)
    errors.remember(result["report"])
    report = result["report"] | numbers
    if isinstance(operator, DepthColoredMaximum):
        places = list(result["report"]["depth_colors"])
        report["depth_colors"] = {"cmap": operator.cmap, "axis": operator.axis, "range": places}
        if not options.depth:
            result["depth"] = None
    return result, report


def is_faded_by_itself(frame: DrawnFrame) -> bool:
    """Whether a layer's opacity is in its transfer function; else the light of its projection is scaled.

    Shapes behind a projection are seen through what is left of it, so they need its own opacity.
    """
    return frame.composite == "over" or (frame.shapes is not None and frame.composite != "first-hit")


def with_opacity(frame: DrawnFrame, layer: DrawnLayer, function: Curves) -> Curves:
    """The transfer function with the layer's opacity, where it is in there."""
    return layer.faded(function) if is_faded_by_itself(frame) else function


def _light(scene: Scene, layer: DrawnLayer, of: Camera | None) -> Shading | None:
    """Light of a layer; with a camera `of`, fixed in the world where that camera has it."""
    own = scene.shading is None or isinstance(scene.shading, Shading)
    light: Any = scene.shading if own else layer.look.shading
    return light if of is None else in_world(light, of)


def _sampling(
    frame: DrawnFrame, drawn: Sequence[tuple[Any, Any, Any, Any]], operator: tuple[str, Sequence[float]]
) -> tuple[float, float]:
    """Sheets per slice and texels per pixel: as given, else by the quality for the layer that needs most."""
    wanted, height = frame.sampling, frame.size[1]
    sheets, texels = _native.quality_settings(wanted.quality, drawn, operator, frame.camera._core, height)
    return (
        sheets if wanted.sheets_per_slice is None else wanted.sheets_per_slice,
        texels if wanted.oversampling is None else wanted.oversampling,
    )


def _measured_errors(frame: DrawnFrame, layers: Sequence[DrawnLayer], functions: Sequence[Curves]) -> MeasuredErrors:
    """Errors measured for a wanted PSNR, kept by the kind of picture."""
    shading = frame.scene.shading
    kind: Any = (
        frame.operator,
        frame.options.kernel,
        tuple((id(layer.volume), layer.layer.opacity) for layer in layers),
        id(frame.labels),
    )
    shown: Any = (
        [layer.identity for layer in layers],
        [(identity_of(c.volume), c.function) if (c := layer.color) else None for layer in layers],
        functions,
        [layer.look.shading if shading == "look" else shading for layer in layers],
        frame.labels,
        frame.shapes,
    )
    return MeasuredErrors(frame.options.psnr is not None, frame.scene._cache, kind, shown)
