"""Slices that stand in space, as pictures on parallelograms."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from wavesplat._looks.transfer_function import TransferFunction
from wavesplat._model.grid import Grid
from wavesplat._model.series import Series
from wavesplat._model.views import PLANES, named_plane
from wavesplat._render import windows
from wavesplat._render.slicing import sides_of, sliced
from wavesplat.errors import ArgumentError

if TYPE_CHECKING:
    from wavesplat import _native
    from wavesplat._geometry.slice_plane import SlicePlane
    from wavesplat._picture.picture import Picture

__all__ = ["card_of"]

#: Longest side of the picture on a card, pixels; a picture shows no finer samples.
MAX_SIDE_PX = 2048


def card_of(plane: SlicePlane, of_scene: Grid) -> _native.CardArrays:
    """The slice as the compiled module takes it. `of_scene`: the volume of the scene's first layer."""
    volume: Any = of_scene if plane.volume is None else plane.volume
    picture = _picture_of(plane, volume[0] if isinstance(volume, Series) else volume)
    told = picture.report
    right, down = (told["pixel"] * np.array(told[name]) for name in ("right", "down"))
    width, height = picture.size
    return {
        # The report has the middle of the first pixel.
        "corner": _triple(np.array(told["origin"]) - (right + down) / 2),
        "along_x": _triple(width * right),
        "along_y": _triple(height * down),
        "rgba": np.ascontiguousarray(picture.rgba),  # opaque or clear: straight and associated are the same
        "style": (plane.opacity, False, plane.clipped),
    }


def _picture_of(plane: SlicePlane, volume: Any) -> Picture:
    values: dict[str, Any] = {"window": plane.window, "clim": plane.clim, "transfer_function": None}
    if plane.cmap is not None:
        ends = windows.limits(volume, plane.window, plane.clim)
        curves = TransferFunction.from_colormap(plane.cmap, clim=ends, opacity=1.0)
        values = {"window": None, "clim": None, "transfer_function": curves}
    picture, _ = sliced(
        volume,
        plane.plane,
        plane.position if plane.index is None else _position_of(volume, plane.plane, plane.index),
        size=_size(volume, plane.plane),
        zoom=1.0,
        center=None,
        kernel="linear",
        thickness=0.0,
        slab="maximum",
        background=None,
        threads=None,
        **values,
    )
    return picture


def _position_of(volume: Grid, plane: str, number: int) -> float:
    """World position of a slice of samples, along the axis that a named plane crosses."""
    axis = "xyz".index(PLANES[named_plane(plane, is_anatomical=volume.is_anatomical)].across)
    matrix = volume.world_from_index
    along = int(np.abs(matrix[axis, :3]).argmax())
    n = volume.shape[2 - along]
    if not -n <= number < n:
        raise ArgumentError(f"index of the slice plane is {number}, and there are {n} slices; give 0 to {n - 1}")
    place = np.array([(size - 1) / 2 for size in reversed(volume.shape)])
    place[along] = number % n
    return float(matrix[axis, :3] @ place + matrix[axis, 3])


def _size(volume: Grid, plane: Any) -> tuple[int, int] | None:
    """Pixels of a slice; None is one for each of the finest samples, where these are no more than a picture shows."""
    width, height = sides_of(volume, plane)
    step = max(width, height) / (MAX_SIDE_PX - 1)
    return None if step <= min(volume.spacing) else (int(width / step) + 1, int(height / step) + 1)


def _triple(numbers: Any) -> tuple[float, float, float]:
    x, y, z = (float(number) for number in numbers)
    return x, y, z
