"""Shapes of a scene as arrays, which can be pickled, and as the compiled module takes them."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wavesplat import _native
from wavesplat._geometry import foreign_shapes
from wavesplat._geometry.frame import Frame
from wavesplat._geometry.lines import Lines
from wavesplat._geometry.points import Points
from wavesplat._geometry.shape import Shape
from wavesplat._geometry.slice_plane import SlicePlane
from wavesplat._geometry.surface import Surface
from wavesplat._looks.curves.transfer_function import TransferFunction
from wavesplat._model.volume.grid import Grid
from wavesplat._picture.report_facts import shown_layer
from wavesplat._system.values import described
from wavesplat.errors import ArgumentError

#: Factor of colours and opacity that leaves the opacity alone.
BLACK = np.array([0, 0, 0, 1], np.float32)
#: Bytes of shapes that travel to workers without a note.
LARGE_BYTES = 64 << 20
#: Largest number of positions of a shape that a camera is fitted to.
MAX_FITTED = 20_000
#: How far from the volumes, in diagonals of their box, positions may lie that a camera is fitted to.
REACH = 1.0
#: Room around a frame for its numbers, as a share of its longest side.
ROOM_FOR_NUMBERS = 0.08


@dataclass(eq=False)
class ShapeArrays:
    """Arrays of all shapes of a scene."""

    meshes: list[_native.MeshArrays] = field(default_factory=list)
    paths: list[_native.PathArrays] = field(default_factory=list)
    points: list[_native.PointArrays] = field(default_factory=list)
    cards: list[_native.CardArrays] = field(default_factory=list)
    #: How many cards each slice has, in the order of shapes: one, or one for each face of the cuts.
    n_cards: list[int] = field(default_factory=list)
    #: The report's entries of the colours of values, for colour bars.
    shown: list[dict[str, Any]] = field(default_factory=list)
    _core: _native.Shapes | None = field(default=None, repr=False)
    _black: ShapeArrays | None = field(default=None, repr=False)

    @classmethod
    def of(
        cls,
        shapes: Sequence[Shape],
        cards_of: Callable[[SlicePlane], tuple[list[_native.CardArrays], dict[str, Any]]],
        bounds: NDArray[np.float64],
        far: tuple[bool, bool, bool],
    ) -> ShapeArrays:
        """The arrays of shapes.

        cards_of : makes the pictures of a slice, and the report's entry of its colours. bounds : the box of frames
        without one. far : for x, y, z whether the upper side of a frame lies behind it.
        """
        made = cls()
        for shape, name in zip(shapes, names_of_shapes(shapes), strict=True):
            entry: dict[str, Any] = {}
            if isinstance(shape, Surface):
                made.meshes.append(shape._arrays())
            elif isinstance(shape, Lines):
                made.paths.append(shape._arrays())
            elif isinstance(shape, Points):
                made.points.append(shape._arrays())
            elif isinstance(shape, SlicePlane):
                cards, entry = cards_of(shape)
                made.cards += cards
                made.n_cards.append(len(cards))
            elif isinstance(shape, Frame):
                made.paths += shape._arrays(bounds, far)
            entry = _colors_of(shape) or entry
            if entry:
                is_named = shape.name or all(other["name"] != shape.KIND for other in made.shown)
                named = {"kind": shape.KIND, "name": (shape.name or shape.KIND) if is_named else name}
                made._show(entry | named)
        return made

    def _show(self, entry: dict[str, Any]) -> None:
        """Keep an entry, unless one is there that says the same: slices of one volume in one window have one bar."""
        has_bar = entry.get("quantity") or entry["kind"] == SlicePlane.KIND
        names = ("quantity", "values", "transfer_function")
        if not (has_bar and any(all(one.get(name) == entry.get(name) for name in names) for one in self.shown)):
            self.shown.append(entry)

    @property
    def core(self) -> _native.Shapes:
        """The shapes for the compiled module, made once in each process."""
        if self._core is None:
            self._core = _native.Shapes(meshes=self.meshes, paths=self.paths, points=self.points, cards=self.cards)
        return self._core

    @property
    def n_bytes(self) -> int:
        """Bytes of all arrays."""
        return sum(map(_bytes_of, self._kinds))

    def in_black(self) -> ShapeArrays:
        """The same shapes in black: they hide as much, and give no light."""
        if self._black is None:
            meshes, paths, points, cards = ([_in_black(arrays) for arrays in kind] for kind in self._kinds)
            self._black = ShapeArrays(meshes, paths, points, cards, self.n_cards, self.shown)
        return self._black

    @property
    def _kinds(self) -> tuple[list[Any], ...]:
        return self.meshes, self.paths, self.points, self.cards

    def __getstate__(self) -> dict[str, Any]:
        return {**self.__dict__, "_core": None, "_black": None}


def _colors_of(shape: Any) -> dict[str, Any] | None:
    """The report's entry on the colours of a shape's values; None if the shape has no values."""
    if shape._mapped is None:
        return None
    _, cmap, ends = shape._mapped
    curves = TransferFunction.from_colormap(cmap, clim=ends, opacity=1.0)
    return shown_layer(shape.name or shape.KIND, "over", curves, shape.value_unit or "", shape.quantity)


def _in_black(arrays: Any) -> Any:
    """The arrays of a shape with black colours, which no light makes brighter."""
    opacity, _, is_clipped = arrays["style"]
    dark = {**arrays, "style": (opacity, False, is_clipped)}
    if "rgba" in arrays:
        return dark | {"rgba": arrays["rgba"] * BLACK}
    paint = dict(arrays["paint"])
    if paint["rgb"] is not None:
        paint["rgb"] = (0.0, 0.0, 0.0)
    if paint["rgba"] is not None:
        paint["rgba"] = paint["rgba"] * BLACK
    if paint["mapped"] is not None:
        values, ends, table = paint["mapped"]
        paint["mapped"] = values, ends, table * BLACK
    return dark | {"paint": paint}


def _bytes_of(thing: Any) -> int:
    if isinstance(thing, np.ndarray):
        return thing.nbytes
    if isinstance(thing, dict):
        return sum(map(_bytes_of, thing.values()))
    return sum(map(_bytes_of, thing)) if isinstance(thing, list | tuple) else 0


def is_geometry(thing: object) -> bool:
    """Whether an object stands in space as a shape, and is no volume."""
    return isinstance(thing, Shape) or _is_meshes(thing) or foreign_shapes.is_shape_like(thing)


def _is_meshes(thing: object) -> bool:
    return type(thing).__module__ == "wavesplat" and type(thing).__name__ == "Meshes"


def as_shapes(given: Any) -> tuple[Shape, ...]:
    """Shapes of one or several objects: ours, meshes, and shapes of other libraries."""
    things = list(given) if isinstance(given, list | tuple) else [given]
    return tuple(shape for thing in things for shape in _shapes_of(thing))


def _shapes_of(thing: Any) -> list[Shape]:
    if isinstance(thing, Shape):
        return [thing]
    if _is_meshes(thing):
        return [Surface(mesh) for mesh in thing]
    kind = foreign_shapes.kind_of(thing)
    if kind is None:
        raise ArgumentError(
            f"geometry has {described(thing)}; give wavesplat.Surface, Lines, Points, SlicePlane or Frame, or a mesh "
            "of wavesplat.mesh, trimesh, PyVista, VTK or vedo, streamlines of nibabel, or a layer of napari"
        )
    return [{"surface": Surface, "lines": Lines, "points": Points}[kind](thing)]


def facts_of_shapes(shapes: Sequence[Shape]) -> list[dict[str, Any]]:
    """Kind, name and number of triangles, paths or points of each shape, for reports."""
    return [
        {"kind": shape.KIND, "name": shape.name, "count": _count(shape)}
        | ({} if shape.visible else {"visible": False})
        | ({"guesses": list(shape.guesses)} if shape.guesses else {})
        for shape in shapes
    ]


def names_of_shapes(shapes: Sequence[Shape]) -> list[str]:
    """Names for people: a shape without one is called by its kind and its number in this kind, from 1."""
    numbers = Counter[str]()
    names = []
    for shape in shapes:
        numbers[shape.KIND] += 1
        names.append(shape.name or f"{shape.KIND} {numbers[shape.KIND]}")
    return names


def _count(shape: Shape) -> int:
    if isinstance(shape, Surface):
        return len(shape.faces)
    if isinstance(shape, Lines):
        return len(shape.paths)
    return len(shape.positions) if isinstance(shape, Points) else 1


def positions_in_view(shapes: Sequence[Shape], bounds: NDArray[np.float64], volume: Grid) -> NDArray[np.float64] | None:
    """Positions of shapes that a camera is fitted to: none that lie far from the volumes; None without any.

    bounds : corners of the box around the volumes. volume : of the scene's first layer.
    """
    diagonal = float(np.linalg.norm(bounds[1] - bounds[0]))
    found = [_outermost(shape, bounds, volume) for shape in shapes if shape._is_seen]
    if not found:
        return None
    together = np.concatenate(found)
    is_near = ((together >= bounds[0] - REACH * diagonal) & (together <= bounds[1] + REACH * diagonal)).all(axis=1)
    return together[is_near] if is_near.any() else None


def _outermost(shape: Shape, bounds: NDArray[np.float64], volume: Grid) -> NDArray[np.float64]:
    """Positions of a shape, few enough, those farthest along the axes included."""
    if isinstance(shape, Frame):
        box = shape._around(bounds)
        around = ROOM_FOR_NUMBERS * (box[1] - box[0]).max() if shape.ticks else 0.0
        return _corners(np.array([box[0] - around, box[1] + around]))
    if isinstance(shape, SlicePlane):
        own = volume if shape.volume is None else shape.volume
        return _corners(np.asarray(getattr(own, "bounds", bounds)))
    if not isinstance(shape, Surface | Lines | Points):
        return np.empty((0, 3))
    positions = shape._positions
    radius = getattr(shape, "radius", None)
    chosen = np.arange(0, len(positions), max(1, len(positions) // MAX_FITTED))
    chosen = np.concatenate([chosen, positions.argmin(axis=0), positions.argmax(axis=0)])
    if radius is None:
        return positions[chosen]
    reach = np.broadcast_to(np.reshape(radius, (-1, 1)), (len(positions), 1))[chosen]
    sides = [positions[chosen] + side * reach * axis for side in (-1, 1) for axis in np.eye(3)]
    return np.concatenate(sides)


def _corners(box: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.stack([np.where([(k >> a) & 1 for a in range(3)], box[1], box[0]) for k in range(8)])
