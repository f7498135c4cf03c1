"""Bytes of the shapes of a picture, before anything is drawn or read."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from wavesplat._geometry.shape_arrays import ShapeArrays, as_shapes
from wavesplat._scene.slice_cards import size_of_card

if TYPE_CHECKING:
    from wavesplat import _native
    from wavesplat._geometry.slice_plane import SlicePlane
    from wavesplat._model.grid import Grid

#: Bytes that a process takes for shapes while it draws, as a multiple of their arrays: these, the compiled module's,
#: and where the shapes lie in the picture. Measured: 2.9 for 5 million triangles.
SHAPE_COPIES = 4


def bytes_of_geometry(geometry: Any, volume: Grid) -> int:
    """Bytes of the arrays of shapes, as they travel to workers; 0 without any. `volume`: the scene's first.

    Raises
    ------
    ArgumentError
        If something is no shape.
    """
    shown = [shape for shape in as_shapes(geometry) if shape._is_seen]

    def empty_cards(plane: SlicePlane) -> tuple[list[_native.CardArrays], dict[str, Any]]:
        width, height = size_of_card(plane, volume)
        card: _native.CardArrays = {
            "corner": (0.0, 0.0, 0.0),
            "along_x": (1.0, 0.0, 0.0),
            "along_y": (0.0, 1.0, 0.0),
            "rgba": np.broadcast_to(np.float32(0), (height, width, 4)),
            "style": (plane.opacity, False, plane.clipped),
        }
        return [card] if width * height else [], {}

    return ShapeArrays.of(shown, empty_cards, volume.bounds, (True, True, True)).n_bytes
