"""Pictures of what a page shows: one view, or all four, with the measures, bars and letters that are switched on.

    +----+---+
    | 3d | z |     "all": four views of one size, with a line between them
    +----+---+
    | y  | x |
    +----+---+

The page's files, `Viewer.picture` and `wavesplat view --save` all draw by `seen`, so they have the same pixels.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from itertools import pairwise
from math import acos, degrees
from typing import Any, Literal, TypeAlias, get_args

import numpy as np
from numpy.typing import NDArray

from wavesplat._model.camera.views import plane_across
from wavesplat._picture import raster
from wavesplat._picture.annotating import style_of
from wavesplat._picture.marks import Canvas, Color, Mark, Text, disc, stroke
from wavesplat._picture.picture import Picture
from wavesplat._system.values import described
from wavesplat._viewer.session.picturing import picture_of
from wavesplat._viewer.session.state import ViewerState
from wavesplat.errors import ArgumentError

#: One view, by the axis across a slice, or all of them.
Shown: TypeAlias = Literal["3d", "z", "y", "x", "all"]
#: Pixels between two views, and their colour.
GAP, GAP_COLOR = 2, 0.25
#: Colour of measures, as in the page; width of their lines and radius of their points, in sizes of the font.
CYAN: Color = (0x7D / 255, 0xF0 / 255, 1.0)
LINE, POINT = 0.11, 0.22
#: Largest distance of points from a slice, in pixels, at which their measure is drawn on it.
NEAR_PX = 1.5
#: Endings of files whose last suffix says too little.
TWO_SUFFIXES = (".nii.gz", ".ome.zarr", ".ome.tif", ".ome.tiff")


def check_shown(shown: str) -> Shown:
    """The name of what is to be drawn, checked."""
    for known in get_args(Shown):
        if shown == known:
            return known  # type: ignore[no-any-return]
    raise ArgumentError(f"shown is {described(shown)}; use one of: {', '.join(get_args(Shown))}")


def name_of(state: ViewerState, shown: Shown) -> str:
    """Name of a picture's file without its suffix, after the first volume: "scan", "scan_axial", "scan_all"."""
    volume, name = state.scene.layers[0].drawn, state.document["layers"][0]["name"]
    suffix = next((one for one in TWO_SUFFIXES if name.lower().endswith(one)), "." + name.rpartition(".")[2])
    stem = re.sub(r"[^\w.-]+", "_", name[: -len(suffix)] if name.lower().endswith(suffix.lower()) else name)
    view = shown if shown in ("3d", "all") else plane_across(shown, is_anatomical=volume.is_anatomical)
    return "_".join([stem.strip("._-") or "picture", *([] if shown == "3d" else [view])])


def seen(
    state: ViewerState,
    shown: Shown,
    size: tuple[int, int],
    *,
    marks: bool,
    progress: Callable[[float], object] | None = None,
) -> Picture:
    """The picture of one view, or of all.

    size : width and height, pixels; a legend or a colour bar stands beside it, and makes it wider.
    marks : draw what the state's overlays say, and the measures.

    Raises
    ------
    ArgumentError
        If the picture is too small for what is drawn on it.
    CancelledError
        If `progress` returned False.
    """
    if shown != "all":
        picture = picture_of(state, shown, size, progress=progress)
        return _beside(state, _marked(state, shown, picture)) if marks else picture
    # The second column and row have the odd pixel, so that the whole has the size that was asked for.
    (width, other_width), (height, other_height) = (((side - GAP) // 2, (side - GAP + 1) // 2) for side in size)
    if min(width, height) < 1:
        raise ArgumentError(f"size is {size[0]} x {size[1]}; four views need {GAP + 2} pixels along each side, or more")
    views = ("3d", "z", "y", "x")
    sizes = [(w, h) for h in (height, other_height) for w in (width, other_width)]
    pictures = [picture_of(state, view, one, progress=progress) for view, one in zip(views, sizes, strict=True)]
    report = pictures[0].report
    if marks:
        pictures = [_marked(state, view, picture) for view, picture in zip(views, pictures, strict=True)]
    rgba = np.full((size[1], size[0], 4), GAP_COLOR, np.float32)
    rgba[..., 3] = 1
    for number, picture in enumerate(pictures):
        top, left = (height + GAP) * (number // 2), (width + GAP) * (number % 2)
        rgba[top : top + picture.size[1], left : left + picture.size[0]] = picture.rgba
    facts = {name: value for name, value in report.items() if name != "scene"}
    whole = Picture(rgba, report=facts)  # type: ignore[arg-type]
    return _beside(state, whole) if marks else whole


def _marked(state: ViewerState, view: str, picture: Picture) -> Picture:
    """The picture of a view with its measures, scale bar, and letters or cube."""
    overlays, report = state.view["overlays"], picture.report
    measures = _measures(state, view, picture)
    if measures:
        canvas = Canvas(*picture.size, picture.rgba, marks=tuple(measures))
        picture = Picture(raster.drawn(canvas), report=report)
    is_anatomical = state.scene.layers[0].drawn.is_anatomical
    has_letters = overlays["letters"] and is_anatomical
    orientation: Any = "letters" if has_letters else None
    if view == "3d" and overlays["cube"] and not has_letters:
        orientation = "cube"
    bar = bool(overlays["scale_bar"] and (view != "3d" or state.camera.view_angle is None))
    if not bar and orientation is None:
        return picture
    return picture.annotated(scale_bar=bar, orientation=orientation)


def _beside(state: ViewerState, picture: Picture) -> Picture:
    """The picture with the colour bar and the legend beside it."""
    overlays, report = state.view["overlays"], picture.report
    legend = bool(overlays["legend"] and (report.get("labels") or len(state.scene.layers) > 1))
    if not legend and not overlays["color_bar"]:
        return picture
    return picture.annotated(colorbar=overlays["color_bar"], legend=legend)


def _measures(state: ViewerState, view: str, picture: Picture) -> list[Mark]:
    """The marks of the measures that lie in a view."""
    style = style_of(picture.rgba, (0.0, 0.0, 0.0, 1.0))
    unit = state.scene.layers[0].drawn.unit or "units"
    marks: list[Mark] = []
    for measure in state.view["measures"]:
        points = np.array(measure["points"], float)
        places = _places(state, view, picture, points)
        if places is None:
            continue
        found = [(float(x), float(y)) for x, y in places]
        size = style.size
        is_region = measure["kind"] == "area"
        for start, end in pairwise([*found, found[0]] if is_region else found):
            marks.append(stroke(start, end, LINE * size, CYAN, style.halo))
        marks += [disc(place, POINT * size, CYAN, style.halo) for place in found]
        x, y = found[1 if measure["kind"] == "angle" else 0]
        text = _text(measure["kind"], points, unit)
        marks.append(Text(x + 0.6 * size, y - 0.5 * size, text, size, CYAN, "start", style.halo))
    return marks


def _places(state: ViewerState, view: str, picture: Picture, points: NDArray[np.float64]) -> NDArray[np.float64] | None:
    """Places of world points in a picture, from its upper left corner; None where they do not lie in it."""
    if view == "3d":
        pixels, _ = state.camera.project(points, size=picture.size)
        return None if np.isnan(pixels).any() else pixels + 0.5
    report = picture.report
    right, down, pixel = np.array(report["right"]), np.array(report["down"]), float(report["pixel"])
    offset = points - np.array(report["origin"])
    away = np.abs(offset @ np.cross(right, down))
    if (away > max(state.view["slices"]["thickness"] / 2, NEAR_PX * pixel)).any():
        return None
    return np.stack([offset @ right, offset @ down], axis=1) / pixel + 0.5


def _text(kind: str, points: NDArray[np.float64], unit: str) -> str:
    """The length of a distance, the area of a region, or the angle at the second point, as the page writes it."""
    if kind == "distance":
        return f"{_short(float(np.linalg.norm(points[1] - points[0])))} {unit}"
    if kind == "area":
        corners = points - points[0]
        area = 0.5 * float(np.linalg.norm(np.cross(corners, np.roll(corners, -1, axis=0)).sum(axis=0)))
        return f"{_short(area)} {unit}²"
    one, other = points[0] - points[1], points[2] - points[1]
    cosine = float(one @ other / (np.linalg.norm(one) * np.linalg.norm(other)))
    return f"{degrees(acos(min(max(cosine, -1.0), 1.0))):.1f}°"


def _short(number: float) -> str:
    """A number with four digits."""
    return f"{float(f'{number:.4g}'):g}"
