"""Drawing of a scene from a camera: one frame, or several put together, as the picture with its report.

"over" and isosurfaces are drawn in one go. Projections of several layers are drawn one after the other, from the same
camera, and their colours are added as light.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from wavesplat._looks.curves import colors
from wavesplat._looks.curves.transfer_function import TransferFunction
from wavesplat._looks.kinds.automatic import SOLID
from wavesplat._looks.labels.labels import Labels
from wavesplat._looks.look import Look
from wavesplat._model.arguments.clips import Clipping
from wavesplat._model.arguments.operators import FirstHit, checked_operator, name_of
from wavesplat._model.arguments.sampling import BY_VIEW, Sampling, checked_quality
from wavesplat._model.camera.camera import Camera
from wavesplat._model.camera.stereo import Eyes
from wavesplat._model.lazy.checks import comparing_once
from wavesplat._model.lazy.volume import LazyVolume
from wavesplat._model.volume.volume import Volume
from wavesplat._model.volume.wavelet_volume import WaveletVolume
from wavesplat._picture.picture import Picture
from wavesplat._picture.report import Report
from wavesplat._render import projection
from wavesplat._render.arguments import (
    check_picture_memory,
    checked_count,
    checked_size,
    chosen_camera,
)
from wavesplat._render.eyes import facts_of_eyes, n_pictures, notes_on_eyes, put_together
from wavesplat._render.notes import notes_on_layers, notes_on_picture
from wavesplat._render.options import DrawOptions
from wavesplat._scene.drawing.compositing import AddedLight, over_background
from wavesplat._scene.drawing.drawn_frame import PIXEL_BYTES, DrawnFrame, is_faded_by_itself, rendered, with_opacity
from wavesplat._scene.drawing.drawn_layers import Curves, DrawnLayer, DrawnLayers, drawn_layers, slice_source
from wavesplat._scene.drawing.picture_notes import notes_on_drawing
from wavesplat._scene.drawing.reporting import facts_of
from wavesplat._scene.drawing.scene_shapes import also_in_view, facts_of_geometry, shapes_of, with_text
from wavesplat._scene.drawing.summary import facts_of_layers, facts_of_picture
from wavesplat._scene.drawing.volumes_of_layers import drawn_volumes
from wavesplat._system.threads import cancelled_by_progress
from wavesplat.errors import ArgumentError

if TYPE_CHECKING:
    from wavesplat._scene.scene import Scene

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
    frame = DrawnFrame(scene, eye, size, sampling, operator, clipping, labels, behind, options, shapes)
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
    notes += [*notes_on_drawing(frame, layers, functions, picture.report), *notes_on_eyes(eyes, size)]
    if notes:
        picture.report.setdefault("notes", []).extend(notes)
    return picture


def _seen_by(eyes: Eyes, frame: DrawnFrame, layers: Sequence[DrawnLayer], functions: Sequence[Curves]) -> Picture:
    """The picture of the eyes: one, or several from other places and in other directions, put together."""
    is_projected = frame.labels is not None and frame.composite != "over"
    drawn = _under_labels if is_projected else _drawn
    if eyes.are_plain:
        return drawn(frame, layers, functions)
    if eyes.panorama and frame.composite in BY_DEPTH:
        raise ArgumentError(
            f"{frame.composite} shows depths along one line of sight, and a panorama has all: take maximum, or leave "
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
    # A box in samples counts the samples of the first layer, which the compiled module knows only where it draws it
    # alone.
    is_alone = shown.has_first and len(shown.layers) == 1
    return scene._clipping if is_alone else scene._clipping.in_world(shown.first)


def _drawn(frame: DrawnFrame, layers: Sequence[DrawnLayer], functions: Sequence[Curves]) -> Picture:
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
    frame: DrawnFrame, eyes: Eyes, layers: Sequence[DrawnLayer], functions: Sequence[Curves], report: dict[str, Any]
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
    """The labels on the samples that were drawn: of a lazy scan, the samples of a level."""
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


def _under_labels(frame: DrawnFrame, layers: Sequence[DrawnLayer], functions: Sequence[Curves]) -> Picture:
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
    result, _ = rendered(above, [clear], [CLEAR])
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


def _shapes_alone(frame: DrawnFrame, layer: DrawnLayer) -> NDArray[np.float32] | None:
    """The shapes' own picture, without matter: colours and opacity; None without any."""
    if frame.shapes is None:
        return None
    own = replace(frame.options, psnr=None, depth=False, progress=None, before_plan=None, after_block=None)
    clear = replace(layer, look=replace(layer.look, transfer_function=CLEAR), color=None, boxes=())
    operator = NOWHERE if isinstance(frame.operator, FirstHit) else frame.operator
    alone = replace(frame, operator=operator, labels=None, background=None, options=own)
    result, _ = rendered(alone, [clear], [CLEAR])
    return result["rgba"]


def _empty(frame: DrawnFrame) -> Picture:
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


def _in_one(frame: DrawnFrame, layers: Sequence[DrawnLayer], functions: Sequence[Curves]) -> Picture:
    """A picture of all layers in one call."""
    opacity = 1.0 if is_faded_by_itself(frame) else layers[0].opacity
    result, report = rendered(frame if opacity == 1 else replace(frame, background=None), layers, functions)
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


def _added(frame: DrawnFrame, layers: Sequence[DrawnLayer], functions: Sequence[Curves]) -> Picture:
    """Projections of several layers, their colours added as light."""
    alone = _shapes_alone(frame, layers[0])
    added, reports = AddedLight(frame.size, alone), []
    clear = replace(frame, background=None, shapes=None if frame.shapes is None else frame.shapes.in_black())
    for number, (layer, function) in enumerate(zip(layers, functions, strict=True)):
        options = replace(frame.options, depth=False, progress=_part_of(frame.options.progress, number, len(layers)))
        result, report = rendered(replace(clear, options=options), [layer], [function])
        own = with_opacity(frame, layer, function)
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


def _function(frame: DrawnFrame, layer: DrawnLayer, n_layers: int) -> Curves:
    """The transfer function that a layer is drawn with."""
    composite, function = frame.composite, layer.look.transfer_function
    if layer.is_automatic and composite in BY_VIEW and n_layers == 1:

        def overview(curves: TransferFunction, at: Camera, of: tuple[int, int]) -> Picture:
            options = DrawOptions(kernel="linear", threads=frame.options.threads, device="cpu")
            small = replace(frame, camera=at, size=of, sampling=COARSE, background=None, options=options, shapes=None)
            result, _ = rendered(small, [layer], [curves])
            return Picture(result["rgba"], value=result["value"])

        function = projection.exposed_by(overview, layer.volume, composite, frame.camera, frame.size) or function
    if layer.look.name == "auto" and layer.look.background is None and n_layers == 1:
        function = projection.on(frame.background, composite, function)
    return function
