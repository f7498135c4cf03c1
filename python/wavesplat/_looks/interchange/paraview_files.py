"""Colour maps of ParaView: `.json` files, as it exports them, the older `.xml`, and the maps in states.

What is taken over, and how:

- Values: where the points reach from 0 to 1 and a volume is given, they are fractions of its robust range, as ParaView
  stretches a map over the data; any other points are sample values.
- Colours: interpolated in the map's colour space, by short lines in RGB; CIEDE2000 is taken as Lab.
- Opacity: the map's points, over the range of its colours if they reach from 0 to 1; without any a ramp from 0 to 1,
  ParaView's own. ParaView's opacity unit is a property of the representation, which states have; else it is one voxel.
- Logarithms (`UseLogScale`): colours are even in the logarithm between points, opacities are not, as in VTK.
- Not taken over: colours of NaN and of what is out of range, and maps of categories.

Sources: ParaView's Remoting/Views/ColorMaps.json and `vtkSMTransferFunctionProxy`, version 5 and 6.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np

from wavesplat._looks.curves import colormaps, value_scale
from wavesplat._looks.curves import colors as color_spaces
from wavesplat._looks.curves.transfer_function import TransferFunction
from wavesplat._looks.interchange import vtk_curves
from wavesplat._looks.look import Look
from wavesplat._model.interchange.paraview_state import NamedPoints
from wavesplat.errors import ArgumentError

if TYPE_CHECKING:
    from xml.etree.ElementTree import Element

    from wavesplat._model.volume.volume import Volume
    from wavesplat._model.volume.wavelet_volume import WaveletVolume

# Colour points of the maps that ParaView starts with, which its Python states name and do not write out.
#
# Source: ParaView's Remoting/Views/ColorMaps.json, version 6.

#: Place, 0..1, red, green and blue of the maps that ParaView starts with: up to version 5, and from 6 on.
OWN = {
    "Cool to Warm": [
        (0.0, 0.231373, 0.298039, 0.752941),
        (0.5, 0.865003, 0.865003, 0.865003),
        (1.0, 0.705882, 0.0156863, 0.14902),
    ],
    "Fast": [
        (0.0, 0.0564, 0.0564, 0.47),
        (0.171592, 0.243, 0.46035, 0.81),
        (0.298491, 0.356814, 0.745025, 0.954368),
        (0.432129, 0.6882, 0.93, 0.91791),
        (0.5, 0.899496, 0.944646, 0.768657),
        (0.588226, 0.957108, 0.833819, 0.508916),
        (0.706141, 0.927521, 0.621439, 0.315357),
        (0.847640, 0.8, 0.352, 0.16),
        (1.0, 0.59, 0.0767, 0.119475),
    ],
}


# Colour maps of ParaView: `.json` files, as it exports them, the older `.xml`, and the maps in states
# (`paraview_state`).

WHAT = "colour map of ParaView"
TAG = "ColorMap"
#: Number of lines between two points of a map, where they are not lines already.
N_LINES = 16
#: End of the names of maps that are matplotlib's.
OF_MATPLOTLIB = " (matplotlib)"
#: Range of points that are fractions.
UNIT = (0.0, 1.0)


def from_json(document: list[Any]) -> list[dict[str, Any]]:
    """The maps of a JSON file."""
    found = [one for one in document if isinstance(one, dict) and "RGBPoints" in one]
    if not found:
        raise ArgumentError(f'{WHAT}: none has "RGBPoints"; maps of categories are not read')
    return found


def from_xml(root: Element) -> list[dict[str, Any]]:
    """The maps of an XML file, in the form that a JSON file has."""
    found = []
    for element in root.iter(TAG):
        points = [[_number(point, name) for name in ("x", "r", "g", "b", "o")] for point in element.iter("Point")]
        if not points:
            raise ArgumentError(f"{WHAT}: {element.get('name', '')!r} has no <Point>")
        document: dict[str, Any] = {
            "Name": element.get("name", ""),
            "ColorSpace": element.get("space", "RGB"),
            "RGBPoints": [number for *node, _ in points for number in node],
        }
        opacities = [(x, alpha) for x, *_, alpha in points if not np.isnan(alpha)]
        # Most files have 1 everywhere, which means that they set no opacity.
        if any(alpha != 1 for _, alpha in opacities):
            document["Points"] = [number for x, alpha in opacities for number in (x, alpha, 0.5, 0.0)]
        found.append(document)
    if not found:
        raise ArgumentError(f"{WHAT}: the file has no <{TAG}>")
    return found


def _number(point: Element, name: str) -> float:
    """A number of a point; not a number where it has none."""
    try:
        return float(point.get(name, "nan"))
    except ValueError:
        raise ArgumentError(f"{WHAT}: {name!r} of a <Point> is {point.get(name)!r}; it must be a number") from None


def look(document: dict[str, Any], volume: Volume | WaveletVolume | None) -> Look:
    """The look of one map; see the head of this file."""
    name = str(document.get("Name", ""))
    space = document.get("ColorSpace", "RGB")
    space = str(space)
    space = "HSVWrap" if space == "HSV" and document.get("HSVWrap") else space
    if space not in color_spaces.SPACES:
        raise ArgumentError(f"{WHAT}: {name!r} is in the space {space!r}; read are {', '.join(color_spaces.SPACES)}")
    if document.get("IndexedLookup"):
        raise ArgumentError(f"{WHAT}: {name!r} is a map of categories, which is not read")
    points = document["RGBPoints"]
    nodes = _table(_points_of(points) if isinstance(points, NamedPoints) else points, 4, "RGBPoints")
    if not all(0 <= channel <= 1 for node in nodes for channel in node[1:]):
        raise ArgumentError(f'{WHAT}: {name!r} has a colour in "RGBPoints" that is not of three numbers 0..1')
    nodes.sort(key=lambda node: node[0])
    points = document.get("Points")
    alphas = vtk_curves.line_nodes(_table(points, 4, "Points")) if points else [(0.0, 0.0), (1.0, 1.0)]
    is_log, is_absolute = bool(document.get("UseLogScale")), bool(document.get("Absolute"))
    low, high = nodes[0][0], nodes[-1][0]
    if (alphas[0][0], alphas[-1][0]) == UNIT and not (is_absolute and points):
        alphas = [(low + place * (high - low), alpha) for place, alpha in alphas]
    if (low, high) == UNIT and volume is not None and not is_absolute:
        scale = "log" if is_log else "fraction"
        start, end = value_scale.ends(scale, volume)
        alphas = [(start + place * (end - start), alpha) for place, alpha in alphas]
        nodes = [(start * (end / start) ** x if is_log else start + x * (end - start), *rgb) for x, *rgb in nodes]
    if is_log and nodes[0][0] <= 0:
        raise ArgumentError(
            f"{WHAT}: {name!r} is logarithmic and begins at {nodes[0][0]:g}, which has no logarithm; rescale it in "
            "ParaView, or pass the volume"
        )
    function = TransferFunction(alphas, _color(nodes, space, is_log=is_log), document.get("OpacityUnit"))
    reason = f"ParaView's colour map {name}." if name else "A colour map of ParaView."
    return Look(transfer_function=function, name=name, reason=reason)


def _points_of(named: NamedPoints) -> list[float]:
    """Value, red, green and blue of each point, one after the other, of a map that a state names."""
    if named.preset in OWN:
        nodes = OWN[named.preset]
    elif named.preset.endswith(OF_MATPLOTLIB):
        places, rgb = colormaps.colors_of(named.preset.removesuffix(OF_MATPLOTLIB))
        nodes = [(place, *one) for place, one in zip(places.tolist(), rgb.tolist(), strict=True)]
    else:
        raise ArgumentError(
            f"{WHAT}: the state names the colours {named.preset!r} and does not write them out; save it as .pvsm in "
            "ParaView, which does, or export the colour map as .json"
        )
    return [number for place, *rgb in nodes for number in (named.low + place * (named.high - named.low), *rgb)]


def _color(nodes: list[tuple[float, ...]], space: str, *, is_log: bool) -> list[tuple[float, ...]]:
    n_lines = N_LINES if space != "RGB" or is_log else 1
    parts = np.linspace(0, 1, n_lines + 1)
    found = nodes[:1]
    for (x, *first), (next_x, *second) in pairwise(nodes):
        if x == next_x or space == "Step":
            found.append((x, *second))
        else:
            red, green, blue = first
            colors = color_spaces.between(space, (red, green, blue), (second[0], second[1], second[2]), parts[1:-1])
            inner = x * (next_x / x) ** parts[1:-1] if is_log else x + parts[1:-1] * (next_x - x)
            found += [(float(value), *rgb) for value, rgb in zip(inner, colors, strict=True)]
        if x < next_x:
            found.append((next_x, *second))
    return found


def _table(numbers: Any, n_each: int, what: str) -> list[tuple[float, ...]]:
    try:
        flat: Sequence[float] = [float(number) for number in numbers]
    except (TypeError, ValueError, OverflowError):
        flat = []
    if not flat or len(flat) % n_each or not np.isfinite(flat).all():
        raise ArgumentError(f'{WHAT}: "{what}" must be finite numbers, {n_each} for every point')
    return [tuple(flat[start : start + n_each]) for start in range(0, len(flat), n_each)]
