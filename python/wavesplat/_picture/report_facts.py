"""Facts that figures need from a picture's report: the view, the layers and their colours, the background.

Where a fact is missing, the error says which, and how to give it.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from math import dist, radians, tan
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wavesplat._looks.curves import colors, transfer_function
from wavesplat._looks.curves.transfer_function import TransferFunction
from wavesplat._model.camera.camera import Camera
from wavesplat._model.volume.facts import Facts, Rgb
from wavesplat.errors import ArgumentError

Array = NDArray[np.float64]

#: Least difference of the largest and the smallest channel of a colour with a hue.
COLORED = 0.3


@dataclass(frozen=True)
class View:
    """Unit vectors of the picture in the world, to the right and up; whether lengths hold in one plane only."""

    right: Array
    up: Array
    is_perspective: bool

    @property
    def back(self) -> Array:
        """Unit vector towards the eye."""
        toward: Array = np.cross(self.right, self.up)
        return toward


@dataclass(frozen=True)
class ShownLayer:
    """A layer that is drawn: its name, operator and colours, and the unit of its values, such as "HU".

    quantity : what the values are, such as "temperature", where a file names it and the layer has no name of its own.
    function : None where colours depend on more than the value.
    """

    name: str
    composite: str
    function: TransferFunction | None
    values: str = ""
    quantity: str = ""


def view_of(report: Mapping[str, Any]) -> View:
    """The picture's directions right and up, in the world."""
    if "right" in report and "down" in report:
        return View(np.array(report["right"], float), -np.array(report["down"], float), is_perspective=False)
    camera = report.get("camera")
    if not isinstance(camera, Mapping):
        raise ArgumentError(
            "this picture does not say from where it was taken; pictures of wavesplat.render and wavesplat.slice do, "
            'and others may: Picture(rgba, report={"camera": camera.as_json()})'
        )
    back = np.array(camera["position"], float) - np.array(camera["focal_point"], float)
    back /= np.linalg.norm(back)
    right = np.cross(np.array(camera["view_up"], float), back)
    right /= np.linalg.norm(right)
    return View(right, np.cross(back, right), is_perspective=camera.get("view_angle") is not None)


def layers_of(report: Mapping[str, Any]) -> list[ShownLayer]:
    """The layers that are visible, in their order."""
    shown = [_layer(layer, f"layer {number}") for number, layer in enumerate(report.get("shown") or [])]
    if not shown:
        raise ArgumentError(
            "this picture does not say which colours its values have; pictures of render and slice do, but not those "
            "of one laid over another"
        )
    return shown


def shapes_of(report: Mapping[str, Any]) -> list[ShownLayer]:
    """Surfaces, lines, points and slices in space that show values in colours."""
    return [_layer(shape, shape.get("kind") or "geometry") for shape in report.get("geometry_colors") or []]


def _layer(entry: Mapping[str, Any], name: str) -> ShownLayer:
    """An entry of the report; `name` is for one without."""
    return ShownLayer(
        entry.get("name") or name,
        entry.get("composite") or "over",
        None if entry.get("transfer_function") is None else _curves(entry["transfer_function"]),
        entry.get("values") or "",
        entry.get("quantity") or "",
    )


def swatches_of(report: Mapping[str, Any]) -> list[tuple[str, Rgb]]:
    """Names and colours for a legend: of labels, of lines over a slice, then of the layers where there are several."""
    named = [*(report.get("labels") or []), *(report.get("lines") or [])]
    found = [(str(one["name"]), _rgb(one["color"])) for one in named]
    layers = layers_of(report) if report.get("shown") else []
    if len(layers) > 1:
        found += [
            (layer.quantity or layer.name, _brightest(layer.function)) for layer in layers if layer.function is not None
        ]
    return found


def plain_name(name: str) -> str:
    """A file's name without the suffixes of its format."""
    return re.sub(r"(?<=.)(\.(nii|ome))?\.[A-Za-z][A-Za-z0-9]{1,5}$", "", name)


def background_of(report: Mapping[str, Any], rgba: NDArray[np.float32]) -> tuple[float, float, float, float] | None:
    """The colour behind the drawing: the report's, else the median of the picture's edge; None where transparent."""
    if "background" in report:
        return colors.parse(report["background"])
    edge = np.concatenate([rgba[0], rgba[-1], rgba[:, 0], rgba[:, -1]])
    if np.median(edge[:, 3]) < 0.5:
        return None
    red, green, blue = np.clip(np.median(edge[:, :3], axis=0), 0, 1).tolist()
    return red, green, blue, 1.0


def shown_layer(name: str, composite: str, function: Any, values: str, quantity: str | None = None) -> dict[str, Any]:
    """The report's entry for a layer, for colour bars and legends; `layers_of` reads it.

    values : their unit. quantity : what the values are, where that is known.
    """
    curves = transfer_function.fields_of(function) if isinstance(function, TransferFunction) else None
    named = {"quantity": quantity} if quantity else {}
    return {"name": name, **named, "values": values, "composite": composite, "transfer_function": curves}


def facts_of_view(camera: Camera, size: tuple[int, int], facts: Facts) -> dict[str, Any]:
    """The report's fields for the camera and the pixels of a picture; `facts`: of what is shown."""
    if camera.view_angle is None:
        half = camera.parallel_scale or 0.0
    else:
        half = dist(camera.position, camera.focal_point) * tan(radians(camera.view_angle) / 2)
    return {
        "size": list(size),
        "pixel": 2 * half / size[1],
        "unit": facts.unit,
        "anatomical": facts.is_anatomical,
        "camera": camera.as_json(),
    }


def _curves(fields: Mapping[str, Any]) -> TransferFunction:
    return TransferFunction(fields["opacity"], fields["color"])


def _rgb(color: Any) -> Rgb:
    red, green, blue, _ = colors.parse(color) or (0.0, 0.0, 0.0, 0.0)
    return red, green, blue


def _brightest(function: TransferFunction) -> Rgb:
    """The colour that stands for a layer: its most saturated one, else its last one."""
    nodes = [(red, green, blue) for _, red, green, blue in function.color]
    most = max(nodes, key=lambda rgb: max(rgb) - min(rgb))
    return most if max(most) - min(most) > COLORED else nodes[-1]
