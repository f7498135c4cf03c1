"""Slices through a volume, and others laid over it at the same places."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from functools import partial
from itertools import cycle
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from wavesplat._looks.curves import colors
from wavesplat._looks.curves.transfer_function import TransferFunction
from wavesplat._looks.curves.transfer_function_2d import TransferFunction2D
from wavesplat._looks.kinds.automatic import labels_alone
from wavesplat._looks.kinds.kinds import kind_of, unit_of_values
from wavesplat._looks.kinds.overlays import MAPPED_KINDS, OVERLAY_MAPS, mapped
from wavesplat._looks.labels.labels import Labels
from wavesplat._looks.labels.regions import Region
from wavesplat._looks.look import Look
from wavesplat._model.arguments.sampling import Kernel, Plane, Slab
from wavesplat._model.arguments.types import takes_its_types
from wavesplat._model.camera.views import named_plane, planes_of
from wavesplat._model.lazy.checks import compare
from wavesplat._model.lazy.volume import LazyVolume
from wavesplat._model.volume.grid import UPRIGHT, Grid
from wavesplat._model.volume.volume import Volume
from wavesplat._picture.picture import Picture
from wavesplat._picture.report import Report
from wavesplat._picture.report_facts import shown_layer
from wavesplat._public import public
from wavesplat._readers.single_planes import is_single_plane
from wavesplat._render import windows
from wavesplat._render.isolines import Isolines
from wavesplat._render.slicing import Planes, sliced
from wavesplat._scene.drawing.looks_of_layers import is_automatic, look_over_others
from wavesplat._scene.drawing.resampling import check_units
from wavesplat._scene.drawing.summary import facts_of_time, names_of, quantity_of
from wavesplat._scene.drawing.volumes_of_layers import identity_of
from wavesplat._scene.layer import Layer
from wavesplat._scene.scene import Scene, as_scene
from wavesplat._scene.slices import layers_on_slices
from wavesplat._scene.slices.compared import comparison
from wavesplat._scene.slices.layers_on_slices import (
    Channels,
    added,
    automatic_fluorescence,
    channels_of,
    clear_below,
    values_laid_over,
)
from wavesplat._scene.slices.lines import lines_over
from wavesplat.errors import ArgumentError

Floats: TypeAlias = NDArray[np.float32]


@public
@takes_its_types
def slice(
    what: Any,
    plane: Plane | tuple[Iterable[float], Iterable[float]] | None = None,
    position: float | None = None,
    *,
    size: tuple[int, int] | None = None,
    zoom: float = 1.0,
    center: Iterable[float] | None = None,
    kernel: Kernel = "linear",
    thickness: float = 0.0,
    slab: Slab = "maximum",
    window: str | tuple[float | str, float | str] | None = None,
    clim: tuple[float | str, float | str] | None = None,
    transfer_function: TransferFunction | str | None = None,
    checkerboard: Any = None,
    tiles: int = 8,
    difference: Any = None,
    contours: Labels | Sequence[Labels | Region] | None = None,
    isolines: Isolines | Sequence[Isolines] | None = None,
    background: str | Sequence[float] | None = "black",
    threads: int | None = None,
) -> Picture:
    """A picture of a plane through the volume, or of a slab around it.

    Parameters
    ----------
    what : Volume, WaveletVolume, array or what else `Volume` takes, Scene, Layer, or several in a list
        What to cut. The first volume decides plane, pixels and values, also where it is not visible. The others lie
        over it at the same places, in their order, as PET over CT does; of a series the volume of its time.
        Channels, which have looks of `Look.channel` or are fluorescence without a look, are added in their colours over
        black instead, with the gamma and exposure of `Look.changed`.
        They have the colours of their looks, or of a map such as "hot" where they have none, as in space.
        `Layer.opacity` is how opaque a layer is where the opacity of its look is greatest; elsewhere it is less in
        proportion. Below the low end of its look, where it is transparent and outside of its volume a layer does not
        show.
        A segmentation alone has the colours of its labels: whole numbers, also as floating-point numbers, that are the
        same from sample to sample. A mask has them where its file names it; else it is white.
        The labels of a scene lie over the slice, faint inside and full along their outlines; over a slab lie the
        labels of its middle plane. Clips and the background of a scene are for pictures in space.
    plane : str or (point, normal), optional
        "axial", "coronal" or "sagittal" of a patient, as radiologists read them: from the feet, the front, and the
        patient's left. "xy", "xz" or "yz" of other data, as arrays are shown: the first axis to the right, the second
        downwards, so that row 0 is on top; of maps and files of simulations upwards. Each stands for the other where
        it fits the data; None is axial or xy. Or any plane, world units, shown as the nearest of these.
    position : float, optional
        Where the plane crosses that axis, world units; None is the middle of the volume. Of (point, normal): how far
        to move from the point along the normal; None is not at all.
    size : (width, height), optional
        Pixels, into which the volume fits; None gives square pixels of the volume's finest spacing, on its samples
        where these lie along the picture.
    zoom : float, default 1
        Magnification about `center`.
    center : three numbers (x, y, z), optional
        World position in the middle of the picture, moved at right angles onto the plane; None is the middle of the
        volume's box.
    kernel : str
        Reconstruction between samples, as for `render`.
    thickness : float, default 0
        Thickness of a slab around the plane, world units. Two planes for every sample across it, and both its faces.
    slab : str
        "maximum", "minimum" or "mean" of the values across the slab.
    window : (level, width) or str, optional
        As radiologists say it: black is level - width / 2, white is level + width / 2. Or a name, for Hounsfield units:
        "abdomen", "angio", "bone", "brain", "liver", "lung", "mediastinum", "soft-tissue", "spine", "stroke",
        "subdural" or "temporal-bone".
    clim : (low, high), optional
        Instead of a window: the values shown as black and as white, or percentiles of the samples ("1%", "99.8%").
        Without both these are the ones that count as the volume's smallest and largest.
    transfer_function : TransferFunction or str, optional
        Instead of a window: the colours, opaque, of all values that are not transparent. Looks of the first layer are
        for pictures in space.
    checkerboard : Volume, or what else `Volume` takes, optional
        A second scan, shown in squares in turn with the first one, to see whether edges meet after a registration.
        It has the first one's window where a value means the same in both (Hounsfield units, SUV, or scans of one kind
        under a given window), else one of its own.
    tiles : int, default 8
        Squares of the checkerboard along the longer side.
    difference : Volume, or what else `Volume` takes, optional
        A second scan, whose values are subtracted: the picture shows first - second, float32, both read between their
        samples, in the map "coolwarm", red where the first one is larger. `clim` or `window` say the values of its
        ends; without them these are as far from 0 as the largest hundredth of the differences in the whole scan.
    contours : Labels, Region, or sequence of them, optional
        Regions as lines: of a structure set (RTSTRUCT), `wavesplat.Region.open(path)`, or the outlines of labels.
        A slice parallel to a region's lines shows the lines of the nearest plane, if it lies within half the distance
        of planes; any other slice the outline of the voxels inside. Labels may lie on a grid of their own.
    isolines : Isolines or sequence of them, optional
        Lines of equal value, such as isodoses: `wavesplat.Isolines(dose, [20, 40, 60])`.
    background : colour, optional
        As for `render`; shows where there are no values.
    threads : int, optional
        Worker threads; None uses all cores.

    Returns
    -------
    Picture
        `value` holds the values, or the differences, float32, shape (height, width), NaN outside the volume.
        `report` says where the pixels lie in the world (`origin`, the centre of the first one, `right`, `down` and
        `pixel`), the letters of the edges (None without anatomy), the window, as `window` (level, width) and `clim`
        (low, high), what was done to the samples (`Facts.processing`), and in `layers` name, opacity, time and
        processing of each layer; in `lines` names and colours of the contours and isolines that show. `notes` say why
        a layer or a line does not. `Picture.annotated` writes on it: letters, a scale bar, the colours of the values,
        a legend.

    Raises
    ------
    ArgumentError
        If an argument cannot work, the plane lies outside the first volume (the message has the range), or lengths of
        layers, or values of a difference, are in different units; or if regions of a patient are drawn on a volume that
        says nothing of one.

    Warns
    -----
    WavesplatWarning
        If a window for Hounsfield units is named and the volume's values do not look like them.

    Examples
    --------
    >>> import wavesplat as ws
    >>> volume = ws.examples.ripples(16)
    >>> ws.slice(volume, "coronal").value.shape
    (16, 16)
    >>> ws.slice(volume, ((0, 0, 0), (1, 0, 1)), thickness=0.2, size=(64, 48)).size
    (64, 48)
    >>> spots = ws.TransferFunction.from_colormap("hot", clim=(100, 255), opacity="linear")
    >>> ws.slice([volume, ws.Layer(volume.smoothed(1), spots, opacity=0.5)]).report["shown"][1]["name"]
    'ripples(16)'
    """
    scene = as_scene(what, None, labels=None, shading="look", clip=(), background=None)
    first = scene.layers[0]
    lines = lines_over(contours, isolines)
    channels = channels_of(scene)
    compared = comparison(checkerboard, tiles, difference, n_channels=len(channels))
    all_volumes = [*(layer.drawn for layer in scene.layers), *(lines.volumes if lines else ())]
    all_volumes += [compared.other] if compared else []
    compare(all_volumes)
    check_units(all_volumes)
    given: Any = {"window": window, "clim": clim, "transfer_function": transfer_function, "background": background}
    if compared is not None and transfer_function is None:
        window, clim = compared.window_of_first(window, clim)
    if all(one is None for one in (window, clim, transfer_function)):
        clim = _limits(scene, channels)
    elif channels:
        raise ArgumentError(
            f"window, clim and transfer_function are for one volume, and the scene has {len(channels)} channels; give "
            "their looks, Look.channel(volume, color, window)"
        )
    picture, planes = sliced(
        first.drawn,
        plane,
        position,
        size=size,
        zoom=zoom,
        center=center,
        kernel=kernel,
        thickness=thickness,
        slab=slab,
        window=window,
        clim=clim,
        transfer_function=transfer_function,
        background=background,
        threads=threads,
    )
    options: dict[str, Any] = {"kernel": kernel, "slab": slab, "threads": threads}
    if compared is not None:
        picture = compared.shown(scene, picture, planes, given, **options)
    report = picture.report
    report["layers"] = [_facts_of(layer) for layer in scene.layers]
    report.update(facts_of_time(scene))
    notes: list[str] = report.pop("notes", [])
    notes += _note_on_plane(plane, first.drawn)
    if channels:
        behind = np.broadcast_to(_associated(background), picture.rgba.shape)
        rgba, report["shown"] = added(behind, planes, channels, **options)
    else:
        rgba = _with_opacity(picture, first, background)
        report["shown"] = _named(report["shown"], first, is_compared=compared is not None) if first.is_shown else []
        notes = notes if first.is_shown else []
    others = scene.layers[len(channels) or 1 :]
    rgba = _with_layers(rgba, planes, scene, others, (report, notes), **options)
    is_plain = compared is None and all(given[name] is None for name in ("window", "clim", "transfer_function"))
    rgba = _with_labels(rgba, planes, scene, (report, notes), is_plain=is_plain)
    if lines is not None:
        over = lines.over(rgba, planes, first.drawn, kernel=kernel, slab=slab, threads=threads)
        rgba, report["lines"] = over.rgba, over.shown
        notes += over.notes
    notes += _notes_on_scene(scene)
    if notes:
        report["notes"] = notes
    return Picture(rgba, value=picture.value, report=report)


def _with_labels(
    rgba: Floats, planes: Planes, scene: Scene, output: tuple[Report, list[str]], *, is_plain: bool
) -> Floats:
    """The slice with the scene's labels over it, or, of a segmentation alone, in the colours of its labels.

    output : the report gets their names, the notes what was lost. is_plain : whether no option says how values look.
    """
    report, notes = output
    if scene.labels is not None:
        labels = scene.labels.for_slices_of(scene.layers[0].drawn)
        rgba, seen = layers_on_slices.labels_laid_over(rgba, planes, labels)
        report["labels"] = names_of(labels, seen)
        notes += labels.notes
        return rgba
    own = _labels_alone(scene) if is_plain else None
    if own is None:
        return rgba
    rgba, seen = layers_on_slices.colored(rgba, planes, own)
    report["labels"], report["shown"] = names_of(own, seen), []
    return rgba


def _labels_alone(scene: Scene) -> Labels | None:
    """The labels of a scene that is one segmentation in memory; None for other scenes."""
    first, volume = scene.layers[0], scene.layers[0].drawn
    if len(scene.layers) > 1 or not (is_automatic(first) and first.is_shown and isinstance(volume, Volume)):
        return None
    is_picture = is_single_plane(volume) and volume.modality not in (None, "SEG")  # such as a screen of few greys
    if isinstance(volume, LazyVolume) or is_picture:
        return None
    key = (id(volume), "labels alone")
    return scene._cache.get_or_compute(key, identity_of(volume), lambda: labels_alone(volume, kind_of(volume)))


def _notes_on_scene(scene: Scene) -> list[str]:
    """Notes on parts of the scene that slices do not show."""
    notes = []
    if any(layer.color_from is not None for layer in scene.layers):
        notes.append("slices show a layer's own values; give the field of color_from as a layer for those")
    if scene.clip:
        notes.append("left out of the slice, since for pictures in space: the scene's clip")
    return notes


def _limits(scene: Scene, channels: Channels) -> tuple[float, float]:
    """The values that the first layer shows as black and white, where none are given."""
    if channels:
        _, light = channels[0]
        return light.low, light.high
    volume = scene.layers[0].looked_at
    key = (id(volume), "limits")
    return scene._cache.get_or_compute(key, identity_of(volume), lambda: windows.limits(volume, None, None))


def _named(shown: list[dict[str, Any]], first: Layer, *, is_compared: bool) -> list[dict[str, Any]]:
    """The report's entries for the colours of the first layer, by the layer's name; two scans have entries of both."""
    return shown if is_compared else [{**one, "name": first.name} for one in shown]


def _note_on_plane(plane: Any, volume: Grid) -> list[str]:
    """A note that the name of a patient's plane is taken for a plane of the array."""
    if volume.is_anatomical or not isinstance(plane, str) or plane not in planes_of(is_anatomical=True):
        return []
    meant = named_plane(plane, is_anatomical=False)
    top = "the world's axes up" if UPRIGHT in volume.facts.conventions else "row 0 on top"
    return [f"{plane} is taken for {meant}, {top}: nothing says that the volume's axes are a patient's"]


def _with_opacity(picture: Picture, layer: Layer, background: str | Sequence[float] | None) -> Floats:
    """The slice of a layer over the background, as far as the layer is visible."""
    opacity = np.float32(layer.opacity if layer.is_shown else 0.0)
    if opacity == 1:
        return picture.rgba
    return opacity * picture.rgba + (1 - opacity) * _associated(background)


def _with_layers(
    rgba: Floats,
    planes: Planes,
    scene: Scene,
    layers: Sequence[Layer],
    output: tuple[Report, list[str]],
    **options: Any,
) -> Floats:
    """The slice with further layers over it; `output` gets their colours, and notes on layers that do not show."""
    report, notes = output
    automatic = iter(cycle(OVERLAY_MAPS))
    for layer in layers:
        if layer.is_shown:
            curves = curves_over(scene, layer, automatic)
            values = planes.values_of(layer.drawn, **options)
            rgba, is_seen = values_laid_over(rgba, values, curves, layer.opacity)
            report["shown"] += _shown(layer, values, curves)
            if not is_seen:
                notes.append(_why_not_seen(layer, values, curves))
    return rgba


def _shown(layer: Layer, values: Floats, curves: TransferFunction) -> list[dict[str, Any]]:
    """The report's entry for colour bars; a layer that lies beside the picture has none."""
    lies_here = np.isfinite(values).any()
    if not lies_here:
        return []
    return [shown_layer(_name_of(layer), "over", curves, unit_of_values(layer.drawn), quantity_of(layer))]


def _facts_of(layer: Layer) -> dict[str, Any]:
    """Fields of the report about a layer, beside its colours."""
    return {
        "name": _name_of(layer),
        "opacity": layer.opacity if layer.visible else 0.0,
        "time": layer.time,
        "processing": list(layer.drawn.facts.processing),
    }


def _name_of(layer: Layer) -> str:
    return layer.name or layer.drawn.name


def _associated(background: str | Sequence[float] | None) -> Floats:
    red, green, blue, alpha = colors.parse(background) or (0.0, 0.0, 0.0, 0.0)
    return np.array([red * alpha, green * alpha, blue * alpha, alpha], np.float32)


def curves_over(scene: Scene, layer: Layer, automatic: Iterator[str]) -> TransferFunction:
    """The colours of a layer that lies over another one; `automatic`: colour maps for layers without a look."""
    volume = layer.looked_at
    name = layer.look if isinstance(layer.look, str) else None
    has_look = not is_automatic(layer)
    if not has_look and (look := automatic_fluorescence(scene, layer)) is not None:
        return _of_values(layer, look)
    find = partial(_found_curves, layer, next(automatic) if not has_look and kind_of(volume) in MAPPED_KINDS else None)
    if has_look and name is None:
        return find()
    key = (id(volume), "over a slice", name, find.args[1])
    return scene._cache.get_or_compute(key, identity_of(volume), find)


def _found_curves(layer: Layer, colormap: str | None) -> TransferFunction:
    volume = layer.looked_at
    if colormap is not None:
        return mapped(volume, colormap)
    return _of_values(layer, look_over_others(layer.look, volume, "over"))


def _of_values(layer: Layer, look: Look) -> TransferFunction:
    """The curves of a layer's look; curves of values and gradients are refused."""
    curves = look.transfer_function
    if isinstance(curves, TransferFunction2D):
        raise ArgumentError(
            f"a slice shows values, not gradients; give the layer {_name_of(layer)!r} a TransferFunction, as "
            "from_colormap makes"
        )
    return curves


def _why_not_seen(layer: Layer, values: Floats, curves: TransferFunction) -> str:
    what = f"the layer {_name_of(layer)!r} does not show"
    inside = values[np.isfinite(values)]
    if not inside.size:
        (x, y, z), (to_x, to_y, to_z) = layer.drawn.bounds.tolist()
        where = f"x {x:g} to {to_x:g}, y {y:g} to {to_y:g}, z {z:g} to {to_z:g}"
        return f"{what}: no part of it lies in the picture; it lies at {where}"
    shown = _shown_values(curves)
    its = "" if shown is None else f", which shows values {shown}"
    return f"{what}: its values there, {inside.min():g} to {inside.max():g}, are clear in its look{its}"


def _shown_values(curves: TransferFunction) -> str | None:
    """Which values show, if all from one value on or all outside two, as with a threshold; None for other looks."""
    nodes = curves.opacity
    first = next((n for n, (_, alpha) in enumerate(nodes) if alpha > 0), None)
    if first is not None and np.isfinite(lowest := clear_below(curves)):
        return f"from {nodes[first - 1][0] if first else lowest:g} on"
    hidden = [value for value, alpha in nodes if alpha == 0]
    if hidden and nodes[0][1] > 0 and nodes[-1][1] > 0:
        return f"up to {min(hidden):g}, and from {max(hidden):g} on"
    return None
