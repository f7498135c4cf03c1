"""Drawing of a scene from a camera: the call of the compiled module, and the picture of its result.

"over" and isosurfaces are drawn in one go. Projections of several layers are drawn one after the other, from the same
camera, and their colours are added as light.
"""

from __future__ import annotations

import atexit
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from wavesplat import _native
from wavesplat._cluster.blocks import drawn_on_machines
from wavesplat._files.cancelling import cancelled_by_progress
from wavesplat._looks import colors
from wavesplat._looks.automatic import SOLID
from wavesplat._looks.brain import PROCESSING as BRAIN
from wavesplat._looks.labels import Labels
from wavesplat._looks.look import Look
from wavesplat._looks.shading import Shading
from wavesplat._looks.transfer_function import TransferFunction
from wavesplat._model.camera import Camera
from wavesplat._model.clips import Clipping
from wavesplat._model.composites import DepthColoredMaximum, FirstHit, Operator, XRay, checked_operator, name_of
from wavesplat._model.forked import drawing
from wavesplat._model.lazy_changes import comparing_once
from wavesplat._model.lazy_volume import LazyVolume
from wavesplat._model.options import BY_VIEW
from wavesplat._model.sampling import Sampling, checked_quality
from wavesplat._model.stereo import Eyes
from wavesplat._model.volume import Volume
from wavesplat._model.wavelet_volume import WaveletVolume
from wavesplat._picture.picture import Picture
from wavesplat._picture.report import Report
from wavesplat._render import projection
from wavesplat._render.arguments import (
    check_picture_memory,
    checked_count,
    checked_size,
    chosen_camera,
    chosen_labels,
    chosen_threads,
    region,
)
from wavesplat._render.devices import chosen_device
from wavesplat._render.eyes import facts_of_eyes, in_world, n_pictures, notes_on_eyes, put_together
from wavesplat._render.faces import NOTE as FACE_NOTE
from wavesplat._render.faces import is_from_behind, shows_face
from wavesplat._render.lazy_layers import FrameSpec, LazyLayers
from wavesplat._render.notes import note_on_steps, notes_on_layers, notes_on_picture
from wavesplat._render.options import DrawOptions
from wavesplat._render.tables import note_on_table
from wavesplat._scene.compositing import AddedLight, over_background
from wavesplat._scene.drawn_layers import (
    Curves,
    DrawnLayer,
    DrawnLayers,
    colors_of,
    drawn_layers,
    drawn_volumes,
    for_module,
    identity_of,
    notes_on_parts,
    slice_source,
    sources_of,
)
from wavesplat._scene.layer_notes import is_inside, notes_on_places
from wavesplat._scene.measured_errors import MeasuredErrors
from wavesplat._scene.reporting import facts_of
from wavesplat._scene.scene_shapes import also_in_view, facts_of_geometry, notes_on_geometry, shapes_of, with_text
from wavesplat._scene.summary import facts_of_layers, facts_of_picture
from wavesplat.errors import ArgumentError

if TYPE_CHECKING:
    from wavesplat._geometry.shape_arrays import ShapeArrays
    from wavesplat._scene.scene import Scene

__all__ = ["camera_of", "draw", "geometry_in_view"]

# Drivers do not like processes that end while a GPU is being opened.
atexit.register(_native.gpu_settle)

#: Bytes of a pixel (colour, depth, value), and of a texel, of which a pixel has `oversampling` squared; measured.
PIXEL_BYTES, TEXEL_BYTES = 20, 20
#: Oversampling beyond which the check of memory refuses any picture.
MAX_OVERSAMPLING = 1e6
#: Opacity of labels over a projection, as a share of their own: it shows through.
LABEL_SHARE = 0.6
#: Transfer function of a scan of which only labels are drawn.
CLEAR = TransferFunction([(0.0, 0.0)], [(0.0, 1.0, 1.0, 1.0)])
#: Operator that finds no surface.
NOWHERE = FirstHit(1e30)
#: Operators whose colours or brightness say how far behind something is.
BY_DEPTH = ("depth-shaded-maximum", "depth-colored-maximum")
#: Sampling of overview pictures.
COARSE = Sampling(sheets_per_slice=1, quality="draft")


@dataclass(frozen=True)
class _Frame:
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


def draw(scene: Scene, camera: Camera | str | None, options: DrawOptions) -> Picture:
    """See `wavesplat.render`."""
    options = replace(options, segments=checked_count(options.segments, "segments"))
    with comparing_once(drawn_volumes(scene)), cancelled_by_progress(options.progress):
        return _drawn_scene(scene, camera, options)


def _drawn_scene(scene: Scene, camera: Camera | str | None, options: DrawOptions) -> Picture:
    size, eyes = checked_size(options.size), options.eyes
    sampling = checked_quality("normal" if options.quality is None else options.quality)
    if options.psnr is not None and (sampling.sheets_per_slice is not None or sampling.oversampling is not None):
        raise ArgumentError("psnr chooses sheets_per_slice and oversampling; leave out either psnr or the Sampling")
    asked = checked_operator(options.composite)
    shown = drawn_layers(scene, None if asked is None else name_of(asked))
    layers, composite = shown.layers, shown.composite
    operator = asked or checked_operator(composite) or "over"
    clipping = _clipping_of(scene, shown)
    labels = scene.labels
    if labels is None and shown.has_first:
        labels = layers[0].look.labels
    if labels is not None:
        _check_labels(composite, layers)
    parts = [(layer.seen, layer.look) for layer in layers]
    parts, also = parts or _hidden_parts(scene), geometry_in_view(scene)
    eye = chosen_camera(camera, parts, clipping, eyes.aspect_of(size), eyes=eyes, also=also)
    eyes = eyes.settled(eye)
    look = layers[0].look if layers else None
    behind = colors.parse(look.background if look is not None and scene.background is None else scene.background)
    first = scene.layers[0].drawn
    shapes = shapes_of(scene.geometry, slice_source(scene), eye, scene._cache.shapes_of)
    frame = _Frame(scene, eye, size, sampling, operator, clipping, labels, behind, options, shapes)
    functions = [_function(frame, layer, len(layers)) for layer in layers]
    picture = _seen_by(eyes, frame, layers, functions)
    if eyes.are_plain:
        picture = with_text(picture, scene.geometry, first, eye, behind)
    picture.report.update(facts_of_picture(scene, eye, eyes.size_of(size), behind, labels))
    picture.report.update(facts_of_layers(scene, layers, functions, operator))
    picture.report.update(facts_of_geometry(scene.geometry, shapes))
    picture.report.update(_facts(frame, eyes, layers, functions, picture.report))
    if resampled := shown.resampled:
        picture.report["resampled"] = resampled
    notes = [] if labels is None else list(_placed_labels(labels, shown.first, picture.report).notes)
    notes += [*_notes(frame, layers, functions, picture.report), *notes_on_eyes(eyes, size)]
    if notes:
        picture.report.setdefault("notes", []).extend(notes)
    return picture


def _notes(
    frame: _Frame, layers: Sequence[DrawnLayer], functions: Sequence[Curves], report: Mapping[str, Any]
) -> list[str]:
    """Notes on what may be recognised or was left out, and on who drew."""
    notes = [FACE_NOTE] if _has_face(frame, layers, functions) else []
    notes += [
        *notes_on_parts(frame.scene, layers),
        *_notes_on_steps(frame, layers),
        *_notes_on_tables(frame, layers, functions),
    ]
    notes += notes_on_places([(layer.name, layer.volume) for layer in layers if layer.opacity > 0])
    notes += notes_on_geometry(frame.scene.geometry, frame.shapes, frame.scene._clipping, frame.options)
    told = report["device"]
    if chosen_device(frame.options.device) not in ("auto", "cpu") and told["name"] == "cpu" and told["reason"]:
        notes.append(f"drawn by the CPU: {told['reason']}")
    return notes


def _seen_by(eyes: Eyes, frame: _Frame, layers: Sequence[DrawnLayer], functions: Sequence[Curves]) -> Picture:
    """The picture of the eyes: one, or several from other places and in other directions, put together."""
    is_projected = frame.labels is not None and frame.composite != "over"
    drawn = _under_labels if is_projected else _drawn
    if eyes.are_plain:
        return drawn(frame, layers, functions)
    if eyes.panorama and frame.composite in BY_DEPTH:
        raise ArgumentError(
            f"{frame.composite} tells depths along one line of sight, and a panorama has all: take maximum, or leave "
            "out panorama"
        )
    check_picture_memory(frame.size, PIXEL_BYTES)
    n, done = n_pictures(eyes), 0
    sampling, options = frame.sampling, replace(frame.options, after_block=None)

    def draw(camera: Camera, size: tuple[int, int]) -> Picture:
        nonlocal done, sampling, options
        own = replace(options, progress=_part_of(frame.options.progress, done, n))
        light = frame.camera if eyes.panorama else None
        of_one = replace(frame, camera=camera, size=size, sampling=sampling, options=own, light=light)
        picture = drawn(of_one, layers, functions)
        done += 1
        if options.psnr is not None and len(layers) == 1:  # the same for all, as what the first needs
            sampling = Sampling(picture.report["sheets_per_slice"], picture.report["oversampling"])
            options = replace(options, psnr=None)
        return picture

    return put_together(eyes, frame.camera, frame.size, draw)


def _notes_on_steps(frame: _Frame, layers: Sequence[DrawnLayer]) -> list[str]:
    """Notes on layers in the light whose slices are far apart; none on drafts."""
    if frame.composite not in ("over", "first-hit") or frame.sampling.quality == "draft":
        return []
    lit = [layer for layer in layers if layer.opacity > 0 and layer.look.shading is not None]
    return [note for layer in lit if (note := note_on_steps(layer.volume)) is not None]


def _has_face(frame: _Frame, layers: Sequence[DrawnLayer], functions: Sequence[Curves]) -> bool:
    """Whether a face may be recognised (`faces`); not asked of drafts, which are drawn while something is dragged."""
    if (
        frame.composite not in ("over", "first-hit")
        or frame.sampling.quality == "draft"
        or is_from_behind(frame.camera)
    ):
        return False
    iso_value = frame.operator.iso_value if isinstance(frame.operator, FirstHit) else None

    def found(layer: DrawnLayer, function: Curves) -> bool:
        if BRAIN in layer.seen.facts.processing:
            return False
        curves, clipping = layer.faded(function), replace(frame.clipping, boxes=layer.boxes)
        key: Any = id(layer.volume), "face"
        return frame.scene._cache.get_or_compute(
            key,
            (layer.identity, curves, clipping, iso_value),
            lambda: shows_face(layer.volume, curves, clipping, iso_value=iso_value),
        )

    return any(found(layer, function) for layer, function in zip(layers, functions, strict=True) if layer.opacity > 0)


def _notes_on_tables(frame: _Frame, layers: Sequence[DrawnLayer], functions: Sequence[Curves]) -> list[str]:
    """Notes on CTs that show their tables; none on drafts, projections, scans that are cut, and from inside of them."""
    if frame.composite != "over" or frame.sampling.quality == "draft" or frame.clipping != Clipping():
        return []

    def found(layer: DrawnLayer, function: Curves) -> str | None:
        volume, curves = layer.seen, layer.faded(function)
        key: Any = id(volume), "table"
        return frame.scene._cache.get_or_compute(key, (layer.identity, curves), lambda: note_on_table(volume, curves))

    pairs = [pair for pair in zip(layers, functions, strict=True) if pair[0].opacity > 0 and not pair[0].boxes]
    shown = [pair for pair in pairs if not is_inside(frame.camera, pair[0].volume)]
    return list(dict.fromkeys(note for layer, curves in shown if (note := found(layer, curves)) is not None))


def camera_of(scene: Scene, camera: Camera | str | None, options: DrawOptions) -> Camera:
    """The camera that `draw` takes."""
    size, eyes = checked_size(options.size), options.eyes
    asked = checked_operator(options.composite)
    with comparing_once(drawn_volumes(scene)):
        shown = drawn_layers(scene, None if asked is None else name_of(asked))
        clipping = _clipping_of(scene, shown)
        parts = [(layer.seen, layer.look) for layer in shown.layers]
        parts, also = parts or _hidden_parts(scene), geometry_in_view(scene)
        return chosen_camera(camera, parts, clipping, eyes.aspect_of(size), eyes=eyes, also=also)


def _clipping_of(scene: Scene, shown: DrawnLayers) -> Clipping:
    # A box in samples is in those of the first layer, which the compiled module knows only where it draws it alone.
    is_alone = shown.has_first and len(shown.layers) == 1
    return scene._clipping if is_alone else scene._clipping.in_world(shown.first)


def _drawn(frame: _Frame, layers: Sequence[DrawnLayer], functions: Sequence[Curves]) -> Picture:
    if not layers:
        return _empty(frame)
    if frame.composite == "over" or len(layers) == 1:
        return _in_one(frame, layers, functions)
    if isinstance(frame.operator, FirstHit):
        raise ArgumentError(
            f"FirstHit shows the surface of one layer, and {len(layers)} are visible; hide the others, "
            'or give looks for composite="over"'
        )
    return _added(frame, layers, functions)


def _facts(
    frame: _Frame, eyes: Eyes, layers: Sequence[DrawnLayer], functions: Sequence[Curves], report: dict[str, Any]
) -> dict[str, Any]:
    """Further fields of the report; for a wanted PSNR the sampling that it took, to draw the same again."""
    sampling, psnr = frame.sampling, frame.options.psnr
    if psnr is not None and len(layers) == 1:
        sampling, psnr = Sampling(report["sheets_per_slice"], report["oversampling"]), None
    of_eyes = facts_of_eyes(eyes, frame.camera, frame.size)
    return of_eyes | facts_of(
        frame.scene,
        layers,
        functions,
        camera=frame.camera,
        size=frame.size,
        sampling=sampling,
        psnr=psnr,
        kernel=frame.options.kernel,
        operator=frame.operator,
        eyes=eyes,
    )


def _placed_labels(labels: Labels, scan: Volume | WaveletVolume, report: Mapping[str, Any]) -> Labels:
    """The labels on the samples that were drawn: of a lazy scan, those of a level."""
    if not isinstance(scan, LazyVolume) or labels.world_from_index is None:
        return labels.on_samples_of(scan)
    of_first = report if "lazy" in report else report["layers"][0]
    return labels.on_samples_of(scan.grid_of(of_first["lazy"]["levels"][0]))


def _check_labels(composite: str, layers: Sequence[DrawnLayer]) -> None:
    """Raise an `ArgumentError` where labels cannot be drawn."""
    if composite == "first-hit":
        raise ArgumentError(
            'labels are not drawn with surfaces of one value; say composite="over" (--composite over), or leave out one'
        )
    for layer in filter(_is_coarse, layers):
        raise ArgumentError(
            f"labels lie on samples, and some wavelets of {layer.name!r} are left out; draw all of them, or no labels"
        )


def _under_labels(frame: _Frame, layers: Sequence[DrawnLayer], functions: Sequence[Curves]) -> Picture:
    """A projection, with its labels drawn as matter of their own and laid over it.

    A projection has no depth, so nothing of it can lie before a label.
    """
    progress = frame.options.progress
    options = replace(frame.options, progress=_part_of(progress, 0, 2))
    picture = _drawn(replace(frame, labels=None, options=options), layers, functions)
    shading = SOLID if layers[0].look.shading is None else layers[0].look.shading
    clear = replace(layers[0], look=Look(transfer_function=CLEAR, shading=shading))
    options = replace(frame.options, psnr=None, depth=False, progress=_part_of(progress, 1, 2))
    above = replace(frame, operator="over", background=None, options=options, shapes=None)
    result, _ = _rendered(above, [clear], [CLEAR])
    over = np.float32(LABEL_SHARE) * result["rgba"]
    report = picture.report
    report.setdefault("notes", []).append("labels laid over the projection, which has no depth")
    return Picture(over + (1 - over[..., 3:]) * picture.rgba, picture.depth, picture.value, Report(report))


def _is_coarse(layer: DrawnLayer) -> bool:
    return isinstance(layer.seen, WaveletVolume) and layer.seen.left_out != 0


def geometry_in_view(scene: Scene) -> NDArray[np.float64] | None:
    """World positions of the scene's shapes that a camera is fitted to besides the volumes."""
    return also_in_view(scene.geometry, slice_source(scene), scene.bounds)


def _hidden_layer(scene: Scene) -> DrawnLayer:
    """The first layer, whether it is visible or not."""
    return drawn_layers(scene.with_(layers=replace(scene.layers[0], visible=True, opacity=1)), None).layers[0]


def _hidden_parts(scene: Scene) -> list[Any]:
    layer = _hidden_layer(scene)
    return [(layer.seen, layer.look)]


def _shapes_alone(frame: _Frame, layer: DrawnLayer) -> NDArray[np.float32] | None:
    """The shapes' own picture, without matter: colours and opacity; None without any."""
    if frame.shapes is None:
        return None
    own = replace(frame.options, psnr=None, depth=False, progress=None, before_plan=None, after_block=None)
    clear = replace(layer, look=replace(layer.look, transfer_function=CLEAR), color=None, boxes=())
    operator = NOWHERE if isinstance(frame.operator, FirstHit) else frame.operator
    alone = replace(frame, operator=operator, labels=None, background=None, options=own)
    result, _ = _rendered(alone, [clear], [CLEAR])
    return result["rgba"]


def _empty(frame: _Frame) -> Picture:
    """A picture of the background alone."""
    width, height = frame.size
    if min(frame.size) < 1:
        raise ArgumentError(f"size is {width} x {height} pixels; width and height must be at least 1")
    check_picture_memory(frame.size, PIXEL_BYTES)
    alone = None if frame.shapes is None else _shapes_alone(frame, _hidden_layer(frame.scene))
    rgba = np.zeros((height, width, 4), np.float32) if alone is None else alone
    rgba = over_background(rgba, frame.background)
    device = {"name": "cpu", "reason": "nothing is drawn"}
    report = {"n_texels": 0, "device": device, "layers": [], "notes": ["no layer of the scene is visible"]}
    return Picture(rgba, report=Report(report))


def _in_one(frame: _Frame, layers: Sequence[DrawnLayer], functions: Sequence[Curves]) -> Picture:
    """A picture of all layers in one call."""
    opacity = 1.0 if _is_faded_by_itself(frame) else layers[0].opacity
    result, report = _rendered(frame if opacity == 1 else replace(frame, background=None), layers, functions)
    if opacity != 1:
        alone = _shapes_alone(frame, layers[0])
        faded = np.float32(opacity) * (result["rgba"] if alone is None else result["rgba"] - alone)
        result["rgba"] = over_background(faded if alone is None else alone + faded, frame.background)
    report["look"] = _layer_summary(layers[0])
    report["processing"] = list(layers[0].seen.facts.processing)
    rgba, value = result["rgba"], result["value"]
    if len(layers) == 1:
        iso_value = frame.operator.iso_value if isinstance(frame.operator, FirstHit) else None
        notes = notes_on_picture(
            layers[0].volume, functions[0], composite=frame.composite, iso_value=iso_value, rgba=rgba, value=value
        )
    else:
        report["layers"] = [_layer_summary(layer) for layer in layers]
        notes = notes_on_layers(rgba)
    if notes:
        report["notes"] = notes
    return Picture(rgba, result["depth"], value, Report(report))


def _added(frame: _Frame, layers: Sequence[DrawnLayer], functions: Sequence[Curves]) -> Picture:
    """Projections of several layers, their colours added as light."""
    alone = _shapes_alone(frame, layers[0])
    added, reports = AddedLight(frame.size, alone), []
    clear = replace(frame, background=None, shapes=None if frame.shapes is None else frame.shapes.in_black())
    for number, (layer, function) in enumerate(zip(layers, functions, strict=True)):
        options = replace(frame.options, depth=False, progress=_part_of(frame.options.progress, number, len(layers)))
        result, report = _rendered(replace(clear, options=options), [layer], [function])
        own = _with_opacity(frame, layer, function)
        share = np.float32(layer.opacity if own is function else 1)
        added.add(share * result["rgba"], result["value"], own)
        reports.append(report | _layer_summary(layer))
    rgba = over_background(added.rgba(), frame.background)
    report = {"n_texels": sum(report["n_texels"] for report in reports), "look": _layer_summary(layers[0])}
    report |= {name: reports[0][name] for name in ("sheets_per_slice", "oversampling", "n_threads", "simd", "device")}
    report |= {"processing": list(layers[0].seen.facts.processing), "layers": reports}
    if notes := notes_on_layers(rgba):
        report["notes"] = notes
    return Picture(rgba, report=Report(report))


def _part_of(progress: Callable[[float], object] | None, number: int, n: int) -> Callable[[float], object] | None:
    return None if progress is None else lambda done: progress((number + done) / n)


def _layer_summary(layer: DrawnLayer) -> dict[str, Any]:
    return {"name": layer.look.name, "reason": layer.look.reason}


def _function(frame: _Frame, layer: DrawnLayer, n_layers: int) -> Curves:
    """The transfer function that a layer is drawn with."""
    composite, function = frame.composite, layer.look.transfer_function
    if layer.is_automatic and composite in BY_VIEW and n_layers == 1:

        def overview(curves: TransferFunction, at: Camera, of: tuple[int, int]) -> Picture:
            options = DrawOptions(kernel="linear", threads=frame.options.threads, device="cpu")
            small = replace(frame, camera=at, size=of, sampling=COARSE, background=None, options=options, shapes=None)
            result, _ = _rendered(small, [layer], [curves])
            return Picture(result["rgba"], value=result["value"])

        function = projection.exposed_by(overview, layer.volume, composite, frame.camera, frame.size) or function
    if layer.look.name == "auto" and layer.look.background is None and n_layers == 1:
        function = projection.on(frame.background, composite, function)
    return function


def _is_faded_by_itself(frame: _Frame) -> bool:
    """Whether a layer's opacity is in its transfer function; else the light of its projection is scaled.

    Shapes behind a projection are seen through what is left of it, so they need its own opacity.
    """
    return frame.composite == "over" or (frame.shapes is not None and frame.composite != "first-hit")


def _with_opacity(frame: _Frame, layer: DrawnLayer, function: Curves) -> Curves:
    """The transfer function with the layer's opacity, where it is in there."""
    return layer.faded(function) if _is_faded_by_itself(frame) else function


def _light(scene: Scene, layer: DrawnLayer, of: Camera | None) -> Shading | None:
    """Light of a layer; that of the camera `of` in pictures from elsewhere."""
    own = scene.shading is None or isinstance(scene.shading, Shading)
    light: Any = scene.shading if own else layer.look.shading
    return light if of is None else in_world(light, of)


def _rendered(
    frame: _Frame, layers: Sequence[DrawnLayer], functions: Sequence[Curves]
) -> tuple[_native.RenderResult, dict[str, Any]]:
    """Result of the compiled module for layers, and its report."""
    options, (width, height), operator = frame.options, frame.size, frame.operator
    lazy = LazyLayers.of(sources_of(layers), frame.camera, frame.size, options, frame.scene._clipping.crop)
    faded = [_with_opacity(frame, layer, function) for layer, function in zip(layers, functions, strict=True)]
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


def _sampling(
    frame: _Frame, drawn: Sequence[tuple[Any, Any, Any, Any]], operator: tuple[str, Sequence[float]]
) -> tuple[float, float]:
    """Sheets per slice and texels per pixel: as given, else by the quality for the layer that needs most."""
    wanted, height = frame.sampling, frame.size[1]
    sheets, texels = _native.quality_settings(wanted.quality, drawn, operator, frame.camera._core, height)
    return (
        sheets if wanted.sheets_per_slice is None else wanted.sheets_per_slice,
        texels if wanted.oversampling is None else wanted.oversampling,
    )


def _measured_errors(frame: _Frame, layers: Sequence[DrawnLayer], functions: Sequence[Curves]) -> MeasuredErrors:
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
