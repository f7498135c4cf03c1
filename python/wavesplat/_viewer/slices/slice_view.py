"""The slices of a viewer: how its state and a pane become a call of `wavesplat.slice`.

A pane has the name of the world's axis across it: "z" is axial of a body, and xy of other data.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wavesplat._looks.curves.transfer_function import TransferFunction
from wavesplat._model.camera.views import plane_across
from wavesplat._model.volume.affine import box_corners
from wavesplat._model.volume.grid import Grid
from wavesplat._picture.picture import Picture
from wavesplat._render.slicing import sides_of
from wavesplat._scene.slices.slicing import slice as cut
from wavesplat._viewer.session.state import ViewerState
from wavesplat._viewer.slices.first_slices import has_channels, slice_colors, slice_window

Array = NDArray[np.float64]


def slice_of(state: ViewerState, pane: str, size: tuple[int, int], *, scale: float = 1.0) -> Picture:
    """The picture of a pane; `scale`: of its width and height, for frames while something moves."""
    arguments = slice_arguments(state, pane)
    if scale == 1:
        return cut(state.scene, size=size, **arguments)
    small = (max(1, round(scale * size[0])), max(1, round(scale * size[1])))
    # As much of the world as at full size: fitted anew, the outermost pixels would be on the outermost samples again.
    sides = sides_of(state.scene.layers[0].drawn, arguments["plane"])
    arguments["zoom"] *= _fitting_pixel(sides, small) * small[0] / (_fitting_pixel(sides, size) * size[0])
    return cut(state.scene, size=small, **arguments)


def _fitting_pixel(sides: tuple[float, float], size: tuple[int, int]) -> float:
    """The pixel, world units, with which a volume of these sides fits into a picture."""
    return max(side / (max(n, 2) - 1) for side, n in zip(sides, size, strict=True))


def slice_arguments(state: ViewerState, pane: str) -> dict[str, Any]:
    """Arguments of `wavesplat.slice`, but for the scene and the size."""
    slices = state.view["slices"]
    volume = state.scene.layers[0].drawn
    point, normal = _plane(slices, pane, volume)
    arguments: dict[str, Any] = {
        "thickness": slices["thickness"],
        "slab": slices["slab"],
        "kernel": state.options["kernel"],
        "zoom": slices["zoom"],
        "background": "black",
    }
    if slices.get("normals", {}).get(pane) is None:
        arguments |= {
            "plane": plane_across(pane, is_anatomical=volume.is_anatomical),
            "position": float(normal @ point),
        }
    else:
        arguments["plane"] = (point.tolist(), normal.tolist())
    if "center" in slices:
        arguments["center"] = list(slices["center"])
    if has_channels(state.scene):
        return arguments
    level, width = window_of(state)
    name = colors_of(state)
    if name == "gray":
        return {**arguments, "window": (level, width)}
    ends = (level - width / 2, level + width / 2)
    colors = TransferFunction.from_colormap(name, clim=ends, opacity=1)
    return {**arguments, "transfer_function": colors, "background": background_of(name)}


def background_of(colors: str) -> str:
    """Colour beside the volume: the colour of its lowest values, so that inverted greys have no black frame."""
    return "white" if colors == "gray_r" else "black"


def window_of(state: ViewerState) -> tuple[float, float]:
    """Level and width of the first layer's values on slices: as in the state, else by the kind of data."""
    level, width = state.view["slices"].get("window") or slice_window(state.scene)
    return level, width


def colors_of(state: ViewerState) -> str:
    """Name of the colour map of the first layer on slices."""
    name: str = state.view["slices"].get("colors") or slice_colors(state.scene)
    return name


def geometry_of(state: ViewerState, pane: str, report: Mapping[str, Any]) -> dict[str, Any]:
    """Places of the pixels by a slice's report, for the page: `SliceGeometry` of `web/src/engine/engine.ts`."""
    volume = state.scene.layers[0].drawn
    _, normal = _plane(state.view["slices"], pane, volume)
    has_window = not has_channels(state.scene)
    return {
        "origin": report["origin"],
        "right": report["right"],
        "down": report["down"],
        "normal": normal.tolist(),
        "pixel": report["pixel"],
        "zoom": float(state.view["slices"]["zoom"]),
        "position": float(normal @ np.array(state.view["slices"]["crosshair"])),
        "range": list(range_along(volume, normal)),
        "letters": report["letters"],
        "window": list(slice_window(state.scene)) if has_window else None,
        "colors": colors_of(state) if has_window else None,
    }


def range_along(volume: Grid, normal: Array) -> tuple[float, float]:
    """Range of the samples' positions along a direction, from the world's origin."""
    along = box_corners(volume.world_from_index, volume.shape) @ normal
    return float(along.min()), float(along.max())


def _plane(slices: dict[str, Any], pane: str, volume: Grid) -> tuple[Array, Array]:
    """A point and the normal; the point is the crosshair, moved into the volume along the normal if need be."""
    given = slices.get("normals", {}).get(pane)
    if given is None:
        normal = np.eye(3)["xyz".index(pane)]
    else:
        normal = np.array(given, float)
        normal /= np.linalg.norm(normal)
    point = np.array(slices["crosshair"], float)
    low, high = range_along(volume, normal)
    along = float(normal @ point)
    return point + (min(max(along, low), high) - along) * normal, normal
