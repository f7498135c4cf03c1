"""Points, tracks, shapes and surfaces of a viewer of napari, in their places, sizes and colours.

As napari shows them: points and shapes at the time of the slider, tracks with their tails and heads around it.
"""

from __future__ import annotations

from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from wavesplat._geometry.foreign_shapes import NAPARI, napari_outlines, napari_world
from wavesplat._geometry.lines import Lines
from wavesplat._geometry.points import Points
from wavesplat._geometry.surface import Surface

Array: TypeAlias = NDArray[np.float64]

#: Largest distance from the slider, in steps of it, of what napari shows at its place.
NEAR = 0.5


def is_geometry(layer: Any) -> bool:
    """Whether a layer has geometry with the axes z, y and x."""
    kind = type(layer).__name__
    n_least = 4 if kind == "Tracks" else 3  # the first axis of tracks is the time
    n_most = 3 if kind == "Surface" else np.inf
    return kind in NAPARI and n_least <= getattr(layer, "ndim", 0) <= n_most


def shape_of(viewer: Any, layer: Any) -> Points | Lines | Surface | None:
    """The shape of a layer; None where nothing of it is shown at the place of the sliders."""
    made = {"Points": _points, "Tracks": _tracks, "Shapes": _shapes, "Surface": _surface}[type(layer).__name__]
    shape: Points | Lines | Surface | None = made(viewer, layer)
    return shape


def _points(viewer: Any, layer: Any) -> Points | None:
    data = np.asarray(layer.data, np.float64).reshape(-1, layer.ndim)
    is_seen = _is_near(viewer, layer, data) & np.asarray(layer.shown, bool)
    if not is_seen.any():
        return None
    sizes = np.broadcast_to(_one_for_each(layer.size, len(data)), len(data))[is_seen]
    return Points(
        napari_world(layer, data)[is_seen],
        radius=sizes / 2 * _unit_length(layer),
        color=np.asarray(layer.face_color, np.float64)[is_seen],
        lit=str(layer.shading) == "spherical",
        opacity=float(layer.opacity),
        name=str(layer.name),
    )


def _one_for_each(sizes: Any, n: int) -> Array:
    """Diameters of `n` points: older releases of napari have one along each axis, of which those along x count."""
    found = np.asarray(sizes, np.float64)
    return found[:, -1] if found.ndim == 2 and len(found) == n else found


def _tracks(viewer: Any, layer: Any) -> Lines | None:
    data = np.asarray(layer.data, np.float64)  # number, time, perhaps other axes, z, y, x
    numbers, positions = data[:, 0], data[:, 1:]
    since = positions[:, 0] - _place(viewer, layer)[0]
    is_seen = (since >= -float(layer.tail_length)) & (since <= float(layer.head_length))
    order = np.lexsort((positions[:, 0], numbers))
    order = order[is_seen[order]]
    paths = [part for part in np.split(order, np.flatnonzero(np.diff(numbers[order])) + 1) if len(part) > 1]
    if not paths:
        return None
    world = napari_world(layer, positions, n_times=1)
    return Lines(
        [world[path] for path in paths],
        color=np.asarray(layer.track_colors, np.float64)[np.concatenate(paths)],
        width=float(layer.tail_width),
        lit=False,
        opacity=float(layer.opacity),
        name=str(layer.name),
    )


def _shapes(viewer: Any, layer: Any) -> Lines | None:
    first = np.array([np.asarray(corners, np.float64)[0] for corners in layer.data]).reshape(-1, layer.ndim)
    is_seen = np.flatnonzero(_is_near(viewer, layer, first))
    if not is_seen.size:
        return None
    outlines = napari_outlines(layer)
    return Lines(
        [outlines[number] for number in is_seen],
        color=np.asarray(layer.edge_color, np.float64)[is_seen],
        radius=float(np.mean(np.asarray(layer.edge_width, np.float64)[is_seen])) / 2 * _unit_length(layer),
        lit=False,
        opacity=float(layer.opacity),
        name=str(layer.name),
    )


def _surface(_viewer: Any, layer: Any) -> Surface:
    vertices, faces = (np.asarray(part) for part in layer.data[:2])
    return Surface(
        napari_world(layer, vertices.astype(np.float64)),
        faces,
        color=_colors_of_vertices(layer, len(vertices)),
        lit=str(layer.shading) != "none",
        opacity=float(layer.opacity),
        name=str(layer.name),
    )


def _colors_of_vertices(layer: Any, n: int) -> Array:
    """Colours of the vertices, shape (n, 3 or 4): the layer's own, or the colours of its values in its colour map."""
    own = getattr(layer, "vertex_colors", None)
    if own is not None:
        return np.asarray(own, np.float64)
    values = np.broadcast_to(np.asarray(layer.data[2] if len(layer.data) > 2 else 1.0, np.float64), n)
    low, high = (float(end) for end in layer.contrast_limits)
    share = np.clip((values - low) / max(high - low, np.finfo(float).tiny), 0, 1) ** float(layer.gamma)
    return np.asarray(layer.colormap.map(share), np.float64)


def _place(viewer: Any, layer: Any) -> Array:
    """The place of the sliders in the axes of a layer."""
    return np.asarray(layer.world_to_data(list(viewer.dims.point)[-layer.ndim :]), np.float64)


def _is_near(viewer: Any, layer: Any, data: Array) -> NDArray[np.bool_]:
    """Which positions lie at the place of the sliders, along the axes before z, y and x."""
    n_before = layer.ndim - 3
    at = _place(viewer, layer)[:n_before]
    near: NDArray[np.bool_] = np.all(np.abs(data[:, :n_before] - at) <= NEAR, axis=1)
    return near


def _unit_length(layer: Any) -> float:
    """World length of a step of 1 in a layer: the mean of those along z, y and x."""
    steps = napari_world(layer, np.vstack([np.zeros(layer.ndim), np.eye(layer.ndim)[-3:]]))
    return float(np.linalg.norm(steps[1:] - steps[0], axis=1).mean())
