"""Shapes of a scene for its pictures: their arrays, made once, and the positions that cameras are fitted to."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from typing import TYPE_CHECKING, Any, TypeGuard

import numpy as np
from numpy.typing import NDArray

from wavesplat._geometry.frame import Frame, far_sides
from wavesplat._geometry.shape_arrays import LARGE_BYTES, ShapeArrays, facts_of_shapes, positions_in_view
from wavesplat._geometry.slice_plane import CUTS, SlicePlane
from wavesplat._geometry.text_marks import has_text, marks_in_space
from wavesplat._model.arguments.clips import Clipping
from wavesplat._picture.annotating import style_of
from wavesplat._picture.picture import Picture
from wavesplat._scene.slices.cards import SliceSource, cards_of, positions_on_cuts

if TYPE_CHECKING:
    from wavesplat._geometry.shape import Shape
    from wavesplat._looks.curves.colors import Rgba
    from wavesplat._model.camera.camera import Camera
    from wavesplat._model.volume.grid import Grid
    from wavesplat._render.options import DrawOptions

#: Keeps the arrays that a function makes, by a key, and the identity of what they are made from.
Keep = Callable[[Any, object, Callable[[], ShapeArrays]], ShapeArrays]


def shapes_of(geometry: Sequence[Shape], source: SliceSource, camera: Camera, keep: Keep) -> ShapeArrays | None:
    """Shapes as arrays, made once; None without any.

    They depend on the camera only by the sides of frames that its grids lie on.
    """
    shown, bounds = _visible(geometry), source.volume.bounds
    if not shown:
        return None
    of_cuts = source.identity_of_cuts if any(_is_cuts(shape) for shape in shown) else ()
    has_grid = any(isinstance(shape, Frame) and shape.grid for shape in shown)
    far = far_sides(camera, bounds) if has_grid else (True, True, True)
    cut = partial(cards_of, source=source)
    return keep(far, (shown, source.identity, of_cuts), lambda: ShapeArrays.of(shown, cut, bounds, far))


def also_in_view(
    geometry: Sequence[Shape], source: SliceSource, bounds: NDArray[np.float64]
) -> NDArray[np.float64] | None:
    """World positions of shapes that cameras are fitted to besides the volumes; None without any.

    bounds : of all layers.
    """
    shown = _visible(geometry)
    of_cuts = [positions_on_cuts(shape, source) for shape in shown if _is_cuts(shape)]
    others = positions_in_view([shape for shape in shown if not _is_cuts(shape)], bounds, source.volume)
    found = [positions for positions in (*of_cuts, others) if positions is not None and len(positions)]
    return np.concatenate(found) if found else None


def with_text(
    picture: Picture, geometry: Sequence[Shape], first: Grid, camera: Camera, background: Rgba | None
) -> Picture:
    """The picture with numbers of frames and names of points, if there are any.

    first : volume of the scene's first layer. background : of the picture; None is transparent.
    """
    if not has_text(_visible(geometry)):
        return picture
    facts: Any = {"bounds": first.bounds, "unit": first.unit, "is_anatomical": first.is_anatomical}
    style = style_of(picture.rgba, background)
    marks = marks_in_space(_visible(geometry), camera, picture.size, style, **facts)
    return picture._with_marks(marks) if marks else picture


def facts_of_geometry(geometry: Sequence[Shape], shapes: ShapeArrays | None) -> dict[str, Any]:
    """The report's list of shapes, and the colours of their values; empty without any."""
    colors = {"geometry_colors": shapes.shown} if shapes is not None and shapes.shown else {}
    return {"geometry": facts_of_shapes(geometry), **colors} if geometry else {}


def notes_on_geometry(
    geometry: Sequence[Shape], shapes: ShapeArrays | None, clipping: Clipping, options: DrawOptions
) -> list[str]:
    """Notes on cuts where nothing is cut, shapes that are large to send to workers, and text that is not written."""
    notes = []
    if clipping == Clipping() and any(_is_cuts(shape) for shape in _visible(geometry)):
        notes.append(
            "slices stand on the cuts, and nothing is cut: give clip=ClipPlane(...), Crop(...) or CutOut(...) (--clip, "
            "--crop, --cut-out)"
        )
    if shapes is not None and options.client is not None and shapes.n_bytes > LARGE_BYTES:
        size = f"{shapes.n_bytes / (1 << 20):.0f} MiB"
        notes.append(f"the geometry has {size}, and all of it is sent to each worker; thin it out if that takes long")
    if not options.eyes.are_plain and has_text(_visible(geometry)):
        notes.append("numbers of frames and names of points are not written in pictures of two eyes, nor in panoramas")
    return notes


def _is_cuts(shape: Shape) -> TypeGuard[SlicePlane]:
    return isinstance(shape, SlicePlane) and shape.plane == CUTS


def _visible(geometry: Sequence[Shape]) -> tuple[Shape, ...]:
    return tuple(shape for shape in geometry if shape._is_seen)
