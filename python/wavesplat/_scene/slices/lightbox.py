"""Lightboxes: several slices on one sheet, at one scale, with positions, letters and reference lines."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from itertools import product
from math import ceil, floor, sqrt
from typing import Any, Literal, TypeAlias

import numpy as np
from numpy.typing import NDArray

from wavesplat._looks.curves import colors
from wavesplat._looks.labels.labels import Labels
from wavesplat._looks.labels.regions import Region
from wavesplat._model.arguments.sampling import Kernel, Plane, Slab
from wavesplat._model.arguments.types import takes_its_types
from wavesplat._model.camera.views import PLANES, named_plane, planes_of
from wavesplat._model.volume import units
from wavesplat._picture.annotating import common_font_px, with_caption
from wavesplat._picture.marks import WHITE
from wavesplat._picture.picture import Picture
from wavesplat._picture.report import Report
from wavesplat._public import public
from wavesplat._render.arguments import check_picture_memory, checked_size
from wavesplat._render.isolines import Isolines, drawn_over
from wavesplat._render.slicing import PIXEL_BYTES, normal_of, positions_across, sides_of
from wavesplat._scene.scene import as_scene
from wavesplat._scene.slices.slicing import slice
from wavesplat._system.values import numbers, positive
from wavesplat.errors import ArgumentError

# Reference lines: where the planes of other slices cross a slice, in a colour for each direction of planes.

Facts: TypeAlias = Mapping[str, Any]
Line: TypeAlias = NDArray[np.float64]

#: Colours by the world's axis that is most across the planes, as the viewer colours its slices.
COLORS = {"z": (1.0, 0.42, 0.42), "y": (0.42, 0.83, 0.42), "x": (0.42, 0.66, 1.0)}
#: Sine of the angle of two planes, below which they count as parallel.
PARALLEL = 1e-6


def color_of(report: Facts) -> tuple[float, float, float]:
    """The colour of a slice's plane in other slices; `report`: of the slice."""
    return COLORS["xyz"[int(np.abs(report["normal"]).argmax())]]


def scout_of(normal: Iterable[float], planes: tuple[str, str, str]) -> str:
    """Which of the volume's named planes shows slices with this normal as lines: sagittal, or coronal of sagittal ones.

    planes : the names of the three planes of the volume.
    """
    x, y, _ = np.abs(tuple(normal))
    return next(name for name in planes if PLANES[name].across == ("x" if x <= y else "y"))


def with_reference_lines(picture: Picture, others: Iterable[Facts]) -> Picture:
    """The slice with a line where each of the other slices' planes crosses it.

    others : reports of the other slices.
    """
    rgba = picture.rgba
    for other in others:
        line = _crossing(picture.report, picture.size, other)
        if line is not None:
            rgba = drawn_over(rgba, [line], color_of(other))
    return Picture(rgba, value=picture.value, report=picture.report)


def _crossing(report: Facts, size: tuple[int, int], other: Facts) -> Line | None:
    """The ends (x, y) of a line from edge to edge of a picture, in pixels; None where the plane does not cross it."""
    normal, origin = np.array(other["normal"]), np.array(report["origin"])
    # Heights above the other plane rise evenly along the picture's rows and columns.
    per_pixel = report["pixel"] * np.array([normal @ report["right"], normal @ report["down"]])
    height = float(normal @ (origin - np.array(other["origin"])))
    if np.abs(per_pixel).max() <= PARALLEL * report["pixel"]:
        return None
    ends = []
    edges = np.array([(-0.5, n - 0.5) for n in size])
    for along, side in product((0, 1), (0, 1)):
        across = 1 - along
        if per_pixel[along] == 0:
            continue
        point = np.empty(2)
        point[across] = edges[across, side]
        point[along] = -(height + per_pixel[across] * point[across]) / per_pixel[along]
        if edges[along, 0] <= point[along] <= edges[along, 1]:
            ends.append(point)
    if len(ends) < 2:
        return None
    # Through a corner there are three or four ends, of which two are the same.
    apart = [np.linalg.norm(end - ends[0]) for end in ends]
    farthest = int(np.argmax(apart))
    return np.array([ends[0], ends[farthest]]) if apart[farthest] > 0 else None


# Lightboxes: several slices on one sheet, at one scale, each with its position and its letters.

#: The name of a plane, or its point and normal.
AnyPlane: TypeAlias = Any

#: Slices of a sheet where no number is given, and at most.
N_SLICES, MAX_SLICES = 12, 400
#: Longest side of a slice that is not given a size, of several positions and of three planes, and the gap, pixels.
SIDE_PX, SIDE_OF_THREE_PX, GAP_PX = 256, 512, 2
#: Tolerance of the volume's edge, in samples.
ON_SAMPLE = 1e-6


@public
@takes_its_types
def lightbox(
    what: Any,
    plane: Plane | Literal["all", "ortho"] | tuple[Iterable[float], Iterable[float]] | None = None,
    positions: int | Iterable[float] | None = None,
    *,
    columns: int | None = None,
    letters: bool = True,
    reference_lines: bool | None = None,
    scale_bar: bool | float | str = False,
    size: tuple[int, int] | None = None,
    zoom: float = 1.0,
    center: Iterable[float] | None = None,
    kernel: Kernel = "linear",
    thickness: float = 0.0,
    slab: Slab = "maximum",
    window: str | tuple[float | str, float | str] | None = None,
    clim: tuple[float | str, float | str] | None = None,
    transfer_function: Any = None,
    checkerboard: Any = None,
    tiles: int = 8,
    difference: Any = None,
    contours: Labels | Sequence[Labels | Region] | None = None,
    isolines: Isolines | Sequence[Isolines] | None = None,
    background: str | Sequence[float] | None = "black",
    threads: int | None = None,
) -> Picture:
    """Several slices of a volume on one sheet, at one scale, each with its position and its letters.

    Parameters
    ----------
    what : as for `slice`
        What to cut.
    plane : str or (point, normal), optional
        As for `slice`; or one slice of each of the three planes, through `center`: "all" puts them in a row, and
        "ortho" aligns them, so that neighbours share rows or columns. The corner of "ortho" has xy, with yz (z to the
        right) beside and xz below it; of a patient coronal, with sagittal beside and axial below it.
    positions : int or sequence of numbers, optional
        How many slices, spread evenly over the volume; or where each is, as `position` of `slice`. None is 12. Not for
        "all" and "ortho".
    columns : int, optional
        Slices in a row; None makes the sheet about square, and puts the planes of "all" in one row. Not for "ortho".
    letters : bool, default True
        Write the position in each slice, and R, L, A, P, S, I at its edges where the world is a patient's.
    reference_lines : bool, optional
        Draw where the other planes cross each of the three, as thin lines, and write positions in the planes' colours:
        red for those across z (axial), green across y (coronal), blue across x (sagittal). Of one plane: add a scout, a
        slice at right angles that shows all positions as lines, in its whole and at its own scale. None draws them on
        three planes only.
    scale_bar : bool, float or str
        A scale bar in the first slice of the last row, as for `Picture.annotated`.
    size : (width, height), optional
        Pixels of each slice; of three planes those that the largest fits into. None: 256 along the longest side, and
        512 of three planes.
    zoom, center, kernel, thickness, slab, window, clim, transfer_function, background, threads
        As for `slice`.
    checkerboard, tiles, difference, contours, isolines
        As for `slice`.

    Returns
    -------
    Picture
        The sheet, without `value`. `report` is the report of the slices; `panels` has plane, position, and the place on
        the sheet (left, top, width and height, pixels) of each; the last one is the scout, if there is one.

    Raises
    ------
    ArgumentError
        If an argument cannot work, or a position lies outside the volume.

    Examples
    --------
    >>> import wavesplat as ws
    >>> sheet = ws.lightbox(ws.examples.ct_pelvis(), positions=6, window="abdomen")
    >>> len(sheet.report["panels"])
    6
    >>> three = ws.lightbox(ws.examples.ct_pelvis(), "all", size=(200, 200))
    >>> [panel["plane"] for panel in three.report["panels"]]
    ['axial', 'coronal', 'sagittal']
    """
    scene = as_scene(what, None, labels=None, shading="look", clip=(), background=None)
    volume = scene.layers[0].drawn
    chosen: AnyPlane = named_plane("xy", is_anatomical=volume.is_anatomical) if plane is None else plane
    name_of_plane = chosen if isinstance(chosen, str) else ""
    is_three, is_aligned = name_of_plane in ("all", "ortho"), name_of_plane == "ortho"
    cuts = _cuts(volume, chosen, positions, center)
    has_lines = is_three if reference_lines is None else bool(reference_lines)
    scout = _scout(volume, chosen) if has_lines and not is_three else None
    n_cells = len(cuts) + (scout is not None)
    count = _columns(columns, n_cells, name_of_plane)
    positive(zoom, "zoom", "a positive finite number, 1 shows the whole volume")
    # Beside xy, yz has the same rows: y downwards.
    is_turned = [is_aligned and one == "yz" for one, _ in cuts]
    sides = [sides_of(volume, one) for one, _ in cuts]
    sides = [side[::-1] if turned else side for side, turned in zip(sides, is_turned, strict=True)]
    sizes, pixel = _sizes(sides, size, is_three)
    cells = sizes if is_three else [(max(w for w, _ in sizes), max(h for _, h in sizes))] * n_cells
    places, whole = _places(cells, count)
    check_picture_memory(whole, PIXEL_BYTES)
    options: Any = {
        "kernel": kernel,
        "slab": slab,
        "window": window,
        "clim": clim,
        "transfer_function": transfer_function,
        "checkerboard": checkerboard,
        "tiles": tiles,
        "difference": difference,
        "contours": contours,
        "isolines": isolines,
        "background": background,
        "threads": threads,
    }
    pictures = []
    for (one, position), shown, (width, height), turned in zip(cuts, sides, sizes, is_turned, strict=True):
        # The scale of `slice` follows the size; the zoom makes it the scale of the sheet.
        own = max(side / (max(n, 2) - 1) for side, n in zip(shown, (width, height), strict=True))
        size_of_slice = (height, width) if turned else (width, height)
        place: Any = {"size": size_of_slice, "zoom": zoom * own / pixel, "center": center, "thickness": thickness}
        picture = slice(scene, one, position, **place, **options)
        pictures.append(_transposed(picture) if turned else picture)
    if scout is not None:
        pictures.append(slice(scene, scout, size=cells[-1], **options))
    if has_lines:
        pictures = _with_lines(pictures, scout is not None)
    font_px = common_font_px([picture.size for picture in pictures])
    if scale_bar is not False:
        with_bar = (len(cuts) - 1) // count * count
        pictures[with_bar] = pictures[with_bar].annotated(scale_bar=scale_bar, font_size=font_px)
    notes_of_each = [picture.report.pop("notes", []) for picture in pictures][: len(cuts)]
    shown_planes = [*(one for one, _ in cuts), *([] if scout is None else [scout])]
    sheet = _blank(whole, background)
    panels = list[dict[str, Any]]()
    report: dict[str, Any] = {}
    for picture, one, (left, top) in zip(pictures, shown_planes, places, strict=True):
        report = _joined(report, picture.report)
        height, width = picture.rgba.shape[:2]
        ink = color_of(picture.report) if has_lines else WHITE
        sheet[top : top + height, left : left + width] = (
            _lettered(picture, one, ink, font_px) if letters else picture.rgba
        )
        placed = {"left": left, "top": top, "width": width, "height": height}
        panels.append(
            {"plane": one if isinstance(one, str) else "oblique", "position": picture.report["position"], **placed}
        )
    # Fields of a single slice: a sheet has no place in the world.
    for name in ("position", "origin", "normal", "right", "down", "letters"):
        report.pop(name, None)
    report["size"], report["panels"] = [sheet.shape[1], sheet.shape[0]], panels
    # A note is kept where all slices have it.
    if notes := [note for note in notes_of_each[0] if all(note in other for other in notes_of_each)]:
        report["notes"] = notes
    return Picture(sheet, report=Report(report))


def _cuts(
    volume: Any, plane: Any, positions: Any, center: Iterable[float] | None
) -> list[tuple[AnyPlane, float | None]]:
    """Plane and position of each slice."""
    if isinstance(plane, str) and plane in ("all", "ortho"):
        if positions is not None:
            raise ArgumentError(f'positions are for one plane; leave them out, or give another plane than "{plane}"')
        names = planes_of(is_anatomical=volume.is_anatomical)
        if plane == "ortho":
            names = ("coronal", "sagittal", "axial") if volume.is_anatomical else ("xy", "yz", "xz")
        if center is None:
            return [(name, None) for name in names]
        x, y, z = center
        return [(name, {"x": x, "y": y, "z": z}[PLANES[name].across]) for name in names]
    if positions is None:
        positions = N_SLICES
    if isinstance(positions, int | np.integer) and not isinstance(positions, bool):
        if not 1 <= positions <= MAX_SLICES:
            raise ArgumentError(f"positions is {positions}; give 1 to {MAX_SLICES} slices, or where each is")
        least, most = positions_across(volume, plane)
        # The middles of equal parts: the outermost slices are inside.
        return [(plane, least + (n + 0.5) * (most - least) / positions) for n in range(positions)]
    listed = numbers(positions, "positions", "a number of slices, or numbers")
    if not 1 <= len(listed) <= MAX_SLICES:
        raise ArgumentError(f"positions has {len(listed)} numbers; give 1 to {MAX_SLICES}")
    return [(plane, position) for position in listed]


def _columns(columns: int | None, n: int, plane: str) -> int:
    if columns is None:
        return n if plane == "all" else ceil(sqrt(n))
    if plane == "ortho":
        raise ArgumentError('"ortho" has two columns; leave columns out, or give plane="all"')
    if not 1 <= columns <= MAX_SLICES:
        raise ArgumentError(f"columns is {columns}; give 1 or more slices in a row")
    return min(columns, n)


def _sizes(
    sides: Sequence[tuple[float, float]], size: tuple[int, int] | None, is_three: bool
) -> tuple[list[tuple[int, int]], float]:
    """Pixels of each slice, and the distance of pixels that all of them have, world units."""
    longest = SIDE_OF_THREE_PX if is_three else SIDE_PX
    width, height = (longest, longest) if size is None else checked_size(size)
    if min(width, height) < 1:
        raise ArgumentError(f"size is {width} x {height} pixels; width and height must be at least 1")
    pixel = max(max(w / (max(width, 2) - 1), h / (max(height, 2) - 1)) for w, h in sides)
    if size is not None and not is_three:
        return [(width, height)] * len(sides), pixel
    return [(floor(w / pixel + ON_SAMPLE) + 1, floor(h / pixel + ON_SAMPLE) + 1) for w, h in sides], pixel


def _places(cells: Sequence[tuple[int, int]], columns: int) -> tuple[list[tuple[int, int]], tuple[int, int]]:
    """Left and top of each slice, in rows, and width and height of the sheet."""
    places, top, width = [], 0, 0
    for start in range(0, len(cells), columns):
        row, left = cells[start : start + columns], 0
        for cell_width, _ in row:
            places.append((left, top))
            left += cell_width + GAP_PX
        width, top = max(width, left - GAP_PX), top + max(height for _, height in row) + GAP_PX
    return places, (width, top - GAP_PX)


def _scout(volume: Any, plane: AnyPlane) -> Any:
    """The name of the plane that shows slices as lines."""
    return scout_of(normal_of(volume, plane), planes_of(is_anatomical=volume.is_anatomical))


def _blank(size: tuple[int, int], background: str | Sequence[float] | None) -> NDArray[np.float32]:
    """A sheet of this width and height without slices."""
    behind = colors.parse(background) or (0.0, 0.0, 0.0, 0.0)
    sheet = np.empty((size[1], size[0], 4), np.float32)
    sheet[:] = [*(share * behind[3] for share in behind[:3]), behind[3]]
    return sheet


def _with_lines(pictures: Sequence[Picture], has_scout: bool) -> list[Picture]:
    """Three planes with the lines of the other two in each; or slices as they are, and the last one with all lines."""
    reports = [picture.report for picture in pictures]
    if has_scout:
        return [*pictures[:-1], with_reference_lines(pictures[-1], reports[:-1])]
    return [
        with_reference_lines(picture, [*reports[:number], *reports[number + 1 :]])
        for number, picture in enumerate(pictures)
    ]


def _transposed(picture: Picture) -> Picture:
    """The picture with its columns as rows."""
    report = picture.report | {"right": picture.report["down"], "down": picture.report["right"]}
    value = picture.value
    return Picture(
        np.ascontiguousarray(picture.rgba.swapaxes(0, 1)),
        value=None if value is None else np.ascontiguousarray(value.T),
        report=Report(report),
    )


def _joined(report: dict[str, Any], other: Any) -> dict[str, Any]:
    """The report of the slices before, with the layers, labels, lines and the scale bar of another one."""
    if not report:
        return dict(other)
    joined = report | ({"scale_bar": other["scale_bar"]} if "scale_bar" in other else {})
    for name in ("shown", "labels", "lines"):
        known = report.get(name, [])
        if more := [one for one in other.get(name, []) if one not in known]:
            joined[name] = [*known, *more]
    return joined


def _lettered(
    picture: Picture, plane: AnyPlane, ink: tuple[float, float, float], font_px: float
) -> NDArray[np.float32]:
    """The slice with its position, and the letters of its edges where there are any; `ink`: the position's colour."""
    has_letters = picture.report.get("letters")
    lettered = picture.annotated(orientation="letters", font_size=font_px) if has_letters else picture
    axis = f"{PLANES[plane].across} " if isinstance(plane, str) else ""
    unit = f" {units.written(picture.unit)}" if picture.unit else ""
    return with_caption(lettered.rgba, f"{axis}{picture.report['position']:.4g}{unit}", ink, font_px)
