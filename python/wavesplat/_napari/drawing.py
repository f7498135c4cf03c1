"""Scenes and pictures of what a viewer of napari shows: its layers, at the place of its sliders, from its camera."""

from __future__ import annotations

import warnings
from dataclasses import replace
from typing import Any, TypeAlias

import numpy as np

from wavesplat._geometry.surface import Surface
from wavesplat._looks.curves.transfer_function import TransferFunction
from wavesplat._looks.labels.labels import Label, Labels
from wavesplat._looks.look import Look
from wavesplat._mesh.meshing import mesh
from wavesplat._model.arguments.operators import AttenuatedMaximum, FirstHit, name_of
from wavesplat._model.arguments.sampling import Composite, Quality
from wavesplat._model.interchange.napari_layer import of_napari
from wavesplat._model.volume.volume import Volume
from wavesplat._napari.cameras import camera_of, canvas_size, is_mirrored, outside
from wavesplat._napari.geometry import is_geometry, shape_of
from wavesplat._picture.picture import Picture
from wavesplat._picture.report import Report
from wavesplat._scene.layer import Layer
from wavesplat._scene.scene import Scene
from wavesplat.errors import ArgumentError, WavesplatWarning

#: napari's ways to show a volume -> operators; the rest are "over".
OPERATORS: dict[str, Composite] = {
    "mip": "maximum",
    "minip": "minimum",
    "average": "mean",
}
#: Nodes of a colour map.
N_NODES = 33
#: Note of pictures that are mirrored.
MIRRORED = "mirrored, left and right, as napari shows its world"

Operator: TypeAlias = Composite | FirstHit | AttenuatedMaximum


def scene_of(viewer: Any, composite: Composite | None = None) -> Scene:
    """The scene of a viewer's visible layers: images in their colours and contrast limits, labels, and geometry.

    Parameters
    ----------
    viewer : napari.Viewer
        Its images and labels of three axes or more, at the place of the sliders; of several levels the finest. Of
        several layers of labels the first one is drawn, on the samples of the first image: over projections, which have
        no depth, and as surfaces beside an isosurface. Points are balls of their
        size, tracks are drawn with their tails and heads, of shapes the outlines.
    composite : str, optional
        Operator that the looks are for, as for `render`; None is the default of `draw`.

    Raises
    ------
    ArgumentError
        If no layer can be drawn.

    Warns
    -----
    WavesplatWarning
        If visible layers are left out: vectors, further labels, and what has two axes or is in RGB.
    """
    wanted = composite or _operator_of(viewer)
    images, labels, shapes, left_out = list[Any](), list[Any](), list[Any](), list[str]()
    for layer in viewer.layers:
        if not layer.visible:
            continue
        if is_geometry(layer):
            shapes.append(layer)
            continue
        kind = type(layer).__name__
        drawable = kind in ("Image", "Labels") and layer.ndim >= 3 and not getattr(layer, "rgb", False)
        (labels if kind == "Labels" else images).append(layer) if drawable else left_out.append(str(layer.name))
    left_out += [str(layer.name) for layer in labels[1:]]
    if not images and not labels:
        raise ArgumentError("no visible layer can be drawn; show an image or labels of three axes, z, y and x")
    if left_out:
        warnings.warn(f"layers that are left out: {', '.join(left_out)}", WavesplatWarning, stacklevel=2)
    geometry = [shape for layer in shapes if (shape := shape_of(viewer, layer)) is not None]
    segmentation = _labels(viewer, labels[0]) if labels else None
    if not images:
        volume = _volume(viewer, labels[0])
        clear = TransferFunction([(0.0, 0.0)], [(0.0, 1.0, 1.0, 1.0)])
        look = Look(transfer_function=clear)
        return Scene(Layer(volume, look), labels=segmentation, background="black", geometry=geometry)
    layers = [_layer(viewer, layer, wanted) for layer in images]
    if segmentation is not None and isinstance(wanted, FirstHit):
        # Beside the surface of an image labels are surfaces, too.
        geometry += [Surface(part) for part in mesh(segmentation, labels=[*segmentation.labels])]
        segmentation = None
    return Scene(layers, labels=segmentation, background="black", geometry=geometry)


def draw(
    viewer: Any,
    *,
    size: tuple[int, int] | None = None,
    quality: Quality = "normal",
    composite: Composite | None = None,
) -> Picture:
    """Draw what a viewer of napari shows: its visible layers, from its camera.

    Parameters
    ----------
    viewer : napari.Viewer
        See `scene_of` and `camera_of`.
    size : two numbers (width, height), optional
        Pixels; None is the size of the viewer's canvas.
    quality : str, default "normal"
        As for `render`.
    composite : str, optional
        Operator, as for `render`; None is the rendering of the first visible image: "maximum" for mip, an
        `AttenuatedMaximum` for attenuated_mip, "minimum" for minip, "mean" for average, an isosurface for iso, "over"
        for others.

    Returns
    -------
    Picture
        Mirrored, left and right, where napari shows its world so; a note says it, and the report has no camera then.

    Raises
    ------
    ArgumentError
        If no layer can be drawn, or the viewer shows other axes than the last three.
    """
    scene = scene_of(viewer, composite)
    camera = outside(camera_of(viewer), scene.bounds)
    operator: Operator = composite or _operator_of(viewer)
    picture = scene.render(camera, size=size or canvas_size(viewer), quality=quality, composite=operator)
    return _mirrored(picture) if is_mirrored(viewer) else picture


def _mirrored(picture: Picture) -> Picture:
    report = {name: value for name, value in picture.report.items() if name not in ("camera", "scene")}
    report["notes"] = [*report.get("notes", []), MIRRORED]
    depth, value = (None if one is None else one[:, ::-1].copy() for one in (picture.depth, picture.value))
    return Picture(np.ascontiguousarray(picture.rgba[:, ::-1]), depth=depth, value=value, report=Report(report))


def _operator_of(viewer: Any) -> Any:
    """The operator of the first visible image."""
    for layer in viewer.layers:
        if layer.visible and type(layer).__name__ == "Image" and layer.ndim >= 3:
            rendering = str(layer.rendering)
            if rendering == "iso":
                return FirstHit(float(layer.iso_threshold))
            if rendering == "attenuated_mip":
                return AttenuatedMaximum(float(layer.attenuation))
            return OPERATORS.get(rendering, "over")
    return "over"


def _volume(viewer: Any, layer: Any) -> Volume:
    """The volume of a layer at the place of the sliders."""
    n_before = layer.ndim - 3
    at: list[int] = []
    if n_before > 0:
        place = np.asarray(layer.world_to_data(list(viewer.dims.point)[-layer.ndim :]), float)
        shape = (layer.data[0] if layer.multiscale else layer.data).shape
        at = [int(np.clip(round(float(place[axis])), 0, shape[axis] - 1)) for axis in range(n_before)]
    found = of_napari(layer, at)
    return Volume(found.samples, world_from_index=found.world_from_index, name=str(layer.name), facts=found.facts)


def _layer(viewer: Any, layer: Any, operator: Any) -> Layer:
    volume = _volume(viewer, layer)
    low, high = (float(end) for end in layer.contrast_limits)
    look = Look.channel(volume, "white", (low, high), name_of(operator))
    function: Any = look.transfer_function
    colors = _colors(layer.colormap)
    gamma = float(layer.gamma)
    nodes = []
    for place in np.linspace(0, 1, N_NODES):
        at = float(place) ** gamma * (len(colors) - 1)
        below = min(int(at), len(colors) - 2)
        red, green, blue = (colors[below] + (at - below) * (colors[below + 1] - colors[below])).tolist()
        nodes.append((low + float(place) * (high - low), red, green, blue))
    if look.composite in ("over", "first-hit"):
        # Matter in the map's dark colours would be black smoke: what is seen of it is its hue.
        nodes = [(value, *_bright(rgb)) for value, *rgb in nodes]
    look = replace(look, transfer_function=replace(function, color=nodes), background=None)
    return Layer(volume, look, opacity=float(layer.opacity), name=str(layer.name))


def _colors(colormap: Any) -> np.ndarray[Any, np.dtype[np.float64]]:
    """Colours of a map at even steps, shape (n, 3)."""
    if hasattr(colormap, "map"):
        return np.asarray(colormap.map(np.linspace(0, 1, 256)), float)[:, :3]
    return np.asarray(colormap.colors, float)[:, :3]


def _bright(rgb: list[float]) -> tuple[float, float, float]:
    """A colour of the same hue whose largest channel is 1, or white for black."""
    most = max(rgb)
    red, green, blue = (channel / most for channel in rgb) if most > 0 else (1.0, 1.0, 1.0)
    return red, green, blue


def _labels(viewer: Any, layer: Any) -> Labels:
    """Labels in the layer's colours."""
    volume = _volume(viewer, layer)
    numbers = [int(number) for number in np.unique(volume.samples) if number != 0]
    looks = {}
    for number in numbers:
        color = layer.get_color(number)
        if color is not None and float(color[3]) > 0:
            looks[number] = Label([float(share) for share in color[:3]])
    return Labels(volume, looks)
