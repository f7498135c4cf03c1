"""Things under the pointer: the ray and its depth, the shape, and the values there."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
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
from wavesplat._looks.curves.transfer_function import TransferFunction
from wavesplat._looks.kinds.kinds import unit_of_values
from wavesplat._model.arguments.clips import Clipping
from wavesplat._model.camera.camera import Camera
from wavesplat._model.camera.fit import axes_of
from wavesplat._model.lazy.volume import LazyVolume
from wavesplat._model.volume.series import Series
from wavesplat._model.volume.volume import Volume
from wavesplat._render.arguments import chosen_look
from wavesplat._scene.drawing.drawn_layers import slice_source
from wavesplat._scene.drawing.scene_shapes import shapes_of
from wavesplat._scene.drawing.summary import quantity_of
from wavesplat._scene.layer import Layer
from wavesplat._scene.scene import Scene
from wavesplat._viewer.session.previews import preview_of
from wavesplat._viewer.session.state import ViewerState

# Samples of volumes at world points.


def value_at(volume: Volume, place: tuple[int, int, int]) -> float:
    """The value of the sample with an index [z, y, x]."""
    if isinstance(volume, LazyVolume):
        z, y, x = place
        return float(volume.arrays(0).read(place, (z + 1, y + 1, x + 1))[0, 0, 0])
    return float(volume.samples[place])


def sample_at(world_from_index: Any, shape: tuple[int, ...], point: Any) -> tuple[int, int, int] | None:
    """The index [z, y, x] of the sample nearest to a point; None outside."""
    matrix = np.linalg.inv(world_from_index)
    index = np.rint(matrix[:3, :3] @ point + matrix[:3, 3])[::-1]
    if not all(0 <= at < n for at, n in zip(index, shape, strict=True)):
        return None  # also what is beyond whole numbers
    z, y, x = (int(at) for at in index)
    return z, y, x


# The fields that colour the layers of a viewer, and the values of all layers and the label at a point.


def color_fields_of(scene: Scene) -> list[dict[str, Any] | None]:
    """Facts of the field that colours each layer: name, unit of values, nodes of its colours; None without one."""
    # Looks that are chosen by the values are taken from the first picture, which is of copies of what is lazy.
    return [
        None if layer.color_from is None else _facts_of(layer.color_from, seen.color_from)
        for layer, seen in zip(scene.layers, preview_of(scene).layers, strict=True)
    ]


def _facts_of(field: Layer, seen: Layer) -> dict[str, Any]:
    function = chosen_look(seen.look, seen.looked_at, "over").transfer_function
    nodes = function.color if isinstance(function, TransferFunction) else ()
    return {
        "name": _name_of(field),
        "value_unit": unit_of_values(field.drawn) or "",
        "color": [list(node) for node in nodes],
    }


def values_at(scene: Scene, point: NDArray[np.float64]) -> list[dict[str, Any]]:
    """Values of the visible layers at a world point, each before its field's that colours it.

    Returns dictionaries of name ("" of a layer alone), value of the nearest sample (None outside, and where it is
    missing) and unit.
    """
    values = []
    for layer in scene.layers:
        if layer.is_shown and layer.color_from is not None:
            fields = (layer, layer.color_from)
            values += [_value_of(field, _name_of(field), point) for field in fields]
        elif layer.is_shown:
            values.append(_value_of(layer, layer.name or "" if len(scene.layers) > 1 else "", point))
    return values


def label_at(scene: Scene, point: NDArray[np.float64]) -> str | None:
    """Name, else number, of the label that is shown at a world point; None without any."""
    labels = scene.labels
    if labels is None:
        return None
    matrix = labels.world_from_index
    place = sample_at(scene.layers[0].drawn.world_from_index if matrix is None else matrix, labels.shape, point)
    if place is None:
        return None
    code = int(labels._codes[place])
    number = labels.numbers[code] if code < len(labels.numbers) else None
    look = None if number is None else labels.labels.get(number)
    return None if look is None or max(look.opacity, look.tint) == 0 else look.name or str(number)


def _value_of(layer: Layer, name: str, point: NDArray[np.float64]) -> dict[str, Any]:
    volume = layer.drawn
    place = sample_at(volume.world_from_index, volume.shape, point) if isinstance(volume, Volume) else None
    value = None if place is None or not isinstance(volume, Volume) else value_at(volume, place)
    is_known = value is not None and isfinite(value)
    return {"name": name, "value": value if is_known else None, "unit": unit_of_values(volume) or ""}


def _name_of(layer: Layer) -> str:
    """The layer's own name, else the name of its values, which distinguishes datasets of one file."""
    return quantity_of(layer) or layer.name or ""


# The sight of a pixel of the picture in space: its ray, and the depth where opacity reaches one half.

Array: TypeAlias = NDArray[np.float64]

#: Side, pixels, of the small picture around a pixel that finds the depth there.
PICKED_PX = 3


@dataclass(frozen=True, eq=False)
class Sight:
    """The ray of a place in the picture.

    camera : sees only a few pixels around the place, as large as the pixels of the picture. origin, direction : of the
    ray, world units, the direction of length 1. pixel_at : sizes of a pixel in world units at depths along the ray.
    """

    camera: Camera
    origin: Array
    direction: Array
    pixel_at: Callable[[Array], Array]

    def point_at(self, depth: float) -> Array:
        """The world point at a depth."""
        point: Array = self.origin + depth * self.direction
        return point


def sight_at(camera: Camera, at: tuple[float, float], size: tuple[int, int]) -> Sight:
    """The ray of a place. at : shares, 0 to 1, from the left and the top. size : of the picture, pixels."""
    width, height = size
    right, up, back = axes_of(camera)
    eye, focal = np.array(camera.position), np.array(camera.focal_point)
    across, upward = (2 * at[0] - 1) * width / height, 1 - 2 * at[1]
    share = PICKED_PX / height
    if camera.view_angle is None:
        scale = camera.parallel_scale or 0.0
        shift = scale * (across * right + upward * up)
        small = Camera(eye + shift, focal + shift, camera.view_up, parallel_scale=scale * share)
        return Sight(small, eye + shift, -back, lambda depths: np.full(np.shape(depths), 2 * scale / height))
    half = np.tan(np.radians(camera.view_angle) / 2)
    direction = -back + half * (across * right + upward * up)
    direction /= np.linalg.norm(direction)
    distance = float(np.linalg.norm(focal - eye))
    angle = float(np.degrees(2 * np.arctan(half * share)))
    small = Camera(eye, eye + distance * direction, camera.view_up, view_angle=max(angle, 1e-3))
    forward = float(-(direction @ back))
    return Sight(small, eye, direction, lambda depths: 2 * half * forward * np.abs(depths) / height)


def depth_of_matter(state: ViewerState, sight: Sight, progress: Any = None) -> float | None:
    """Depth where opacity, of volumes and shapes, reaches one half; None where it does not, and in projections."""
    composite = state.options["composite"]
    name = composite if isinstance(composite, str | None) else composite.name
    if name not in (None, "over", "first-hit"):
        return None
    arguments = {"quality": "normal", "kernel": state.options["kernel"], "composite": composite}
    picture = preview_of(state.scene).render(
        sight.camera, size=(PICKED_PX, PICKED_PX), depth=True, progress=progress, **arguments
    )
    depth = picture.depth
    if depth is None:
        return None
    near = depth[PICKED_PX // 2, PICKED_PX // 2]
    if np.isfinite(near):
        return float(near)
    finite = depth[np.isfinite(depth)]
    return float(np.median(finite)) if finite.size else None


# The shape under the pointer: its kind and name, which of its parts, the value there, and a line that says so.


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
    """The pictures of the slices that are shown; drawing the scene has made them."""
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
