"""The shape under the pointer: its kind and name, which of its parts, the value there, and a line that says so."""

from __future__ import annotations

from collections.abc import Callable
from itertools import accumulate, pairwise
from math import inf, isfinite
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from wavesplat._geometry.lines import Lines
from wavesplat._geometry.picking import Picked, Ray, picked
from wavesplat._geometry.points import Points
from wavesplat._geometry.shape import Shape
from wavesplat._geometry.shape_arrays import names_of_shapes
from wavesplat._geometry.slice_plane import SlicePlane
from wavesplat._model.clips import Clipping
from wavesplat._model.series import Series
from wavesplat._model.volume import Volume
from wavesplat._scene.drawn_layers import slice_source
from wavesplat._scene.scene_shapes import shapes_of
from wavesplat._viewer.previews import preview_of
from wavesplat._viewer.probing import sample_at, value_at
from wavesplat._viewer.sight import Sight, depth_of_matter
from wavesplat._viewer.state import ViewerState

Array: TypeAlias = NDArray[np.float64]


def shape_seen(state: ViewerState, sight: Sight, progress: Any = None) -> dict[str, Any] | None:
    """The nearest shape on a ray that matter does not hide; None without any. Projections hide nothing.

    Fields: kind, name; part, the number of the point, path or triangle from 0, or null; label, of a point; value, of
    the shape's values or the slice's volume, or null; point, world units; text, all of it for people.
    """
    scene = state.scene
    first = scene.layers[0].drawn
    ray = Ray(sight.origin, sight.direction, -inf if state.camera.view_angle is None else 0.0, sight.pixel_at)
    known: dict[str, Any] = {
        "is_kept": _kept_by(scene._clipping.in_world(first)),
        "cards_of": _cards(state).__getitem__,
        "bounds": first.bounds,
    }
    found = picked(ray, scene.geometry, **known)
    if found is None:
        return None
    near = depth_of_matter(state, sight, progress)
    # On a surface of matter itself, such as one of its meshes, depths differ by less than a sample.
    seen_to = inf if near is None else near + max(first.spacing)
    if found.depth > seen_to:
        found = picked(ray, scene.geometry, farthest=seen_to, **known)
    return None if found is None else _entry_of(scene.geometry, found, sight.point_at(found.depth), first)


def _cards(state: ViewerState) -> dict[SlicePlane, list[Any]]:
    """The pictures of the slices that are shown, which those of the scene have made."""
    scene = preview_of(state.scene)
    planes = [shape for shape in scene.geometry if isinstance(shape, SlicePlane) and shape._is_seen]
    arrays = shapes_of(scene.geometry, slice_source(scene), state.camera, scene._cache.shapes_of) if planes else None
    if arrays is None:
        return {}
    ends = [0, *accumulate(arrays.n_cards)]
    return {plane: arrays.cards[slice(*part)] for plane, part in zip(planes, pairwise(ends), strict=True)}


def _kept_by(clipping: Clipping) -> Callable[[Array], NDArray[np.bool_]]:
    """Whether clips in the world keep points; boxes that are cut out take samples alone, and no shapes."""

    def is_kept(points: Array) -> NDArray[np.bool_]:
        kept = np.ones(len(points), bool)
        if clipping.crop is not None:
            lower, upper = np.sort([clipping.crop.lower, clipping.crop.upper], axis=0)
            kept &= ((points >= lower) & (points <= upper)).all(axis=1)
        for plane in clipping.planes:
            kept &= (points - plane.point) @ np.array(plane.normal) >= 0
        return kept

    return is_kept


def _entry_of(shapes: tuple[Shape, ...], found: Picked, point: Array, first: Any) -> dict[str, Any]:
    shape = shapes[found.number]
    name = names_of_shapes(shapes)[found.number]
    labels = getattr(shape, "labels", None)
    label = "" if labels is None or found.part is None else labels[found.part]
    value = _value_on(shape, point, first) if isinstance(shape, SlicePlane) else found.value
    parts = [name if shape.name is None else f"{shape.KIND} {name}"]
    if isinstance(shape, Points):
        parts.append(label or f"point {found.part}")
    elif isinstance(shape, Lines):
        parts.append(f"path {found.part}")
    parts += [] if value is None else [f"{value:.5g}"]
    return {
        "kind": shape.KIND,
        "name": name,
        "part": found.part,
        "label": label,
        "value": value,
        "point": point.tolist(),
        "text": ", ".join(parts),
    }


def _value_on(plane: SlicePlane, point: Array, first: Any) -> float | None:
    """The value of the sample of a slice's volume that is nearest to a point."""
    volume = first if plane.volume is None else plane.volume
    volume = volume[0] if isinstance(volume, Series) else volume
    place = sample_at(volume.world_from_index, volume.shape, point) if isinstance(volume, Volume) else None
    value = None if place is None else value_at(volume, place)
    return value if value is not None and isfinite(value) else None
