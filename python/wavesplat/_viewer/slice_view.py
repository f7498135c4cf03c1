"""The slices of a viewer: how its state and a pane become a call of `wavesplat.slice`.

A pane has the name of the world's axis across it: "z" is axial of a body, and xy of other data.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from wavesplat._model.affine import box_corners
from wavesplat._model.grid import Grid
from wavesplat._model.views import plane_across
from wavesplat._picture.picture import Picture
from wavesplat._scene.slicing import slice as cut
from wavesplat._viewer.state import ViewerState

__all__ = ["geometry_of", "range_along", "slice_arguments", "slice_of"]

Array = NDArray[np.float64]


def slice_of(state: ViewerState, pane: str, size: tuple[int, int], *, scale: float = 1.0) -> Picture:
    """The picture of a pane; `scale`: of its width and height, for frames while something moves."""
    width, height = (max(1, round(scale * n)) for n in size)
    return cut(state.scene, size=(width, height), **slice_arguments(state, pane))


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
    if slices["zoom"] != 1:
        arguments["center"] = point.tolist()
    if "window" in slices:
        arguments["window"] = tuple(slices["window"])
    return arguments


def geometry_of(state: ViewerState, pane: str, picture: Picture) -> dict[str, Any]:
    """Places of the pixels, for the page: `SliceGeometry` of `web/src/engine/engine.ts`."""
    report = picture.report
    volume = state.scene.layers[0].drawn
    _, normal = _plane(state.view["slices"], pane, volume)
    window = report.get("window")
    return {
        "origin": report["origin"],
        "right": report["right"],
        "down": report["down"],
        "normal": normal.tolist(),
        "pixel": report["pixel"],
        "position": float(normal @ np.array(state.view["slices"]["crosshair"])),
        "range": list(range_along(volume, normal)),
        "letters": report["letters"],
        "window": None if window is None else [float(value) for value in window],
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
