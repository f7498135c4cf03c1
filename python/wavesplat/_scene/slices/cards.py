"""Slices that stand in space, and slices on the faces of cuts, as pictures on parallelograms."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from wavesplat._geometry.slice_plane import CUTS
from wavesplat._looks.curves.transfer_function import TransferFunction
from wavesplat._looks.kinds.kinds import kind_of, offset_of
from wavesplat._looks.labels.labels import Labels
from wavesplat._model.arguments.clips import Clipping, ClipPlane, Crop
from wavesplat._model.camera.views import PLANES, named_plane, triple
from wavesplat._model.volume.grid import Grid
from wavesplat._model.volume.series import Series
from wavesplat._model.volume.volume import Volume
from wavesplat._model.volume.wavelet_volume import WaveletVolume
from wavesplat._render import windows
from wavesplat._render.slicing import Planes, sides_of, sliced
from wavesplat._scene.slices import layers_on_slices
from wavesplat._scene.slices import layers_on_slices as overlaid_values
from wavesplat.errors import ArgumentError

if TYPE_CHECKING:
    from wavesplat import _native
    from wavesplat._geometry.slice_plane import SlicePlane
    from wavesplat._picture.picture import Picture

# The outline of a patient on a slice: the air around the body, which what lies behind the slice shows through.
#
# Air is what is darker than the body and reaches the border of the slice, not only through gaps, so that air inside, as
# of the sinuses, and dark spots at the border belong to the body.

#: Value between air and the body in a CT, Hounsfield units.
AIR_HU = -400.0
#: Value between air and the body in other scans, as a share of the way from dark to bright. (Two heads of T1: air has
#: up to 0.04, skin 0.3 and more.)
AIR_SHARE = 0.1
#: Half the width of gaps that air does not pass, as a share of the slice's longer side.
GAP_SHARE = 1 / 150

Mask = NDArray[np.bool_]


def least_of_body(volume: Volume | WaveletVolume) -> float | None:
    """Value above which samples of a patient's scan are of the body; None for other data."""
    if not volume.is_anatomical:
        return None
    if kind_of(volume) == "CT":
        return AIR_HU + offset_of(volume)
    low, high = windows.limits(volume, None, None)
    return low + AIR_SHARE * (high - low)


def air_around(values: NDArray[Any], least: float) -> Mask:
    """Pixels of a slice that are not above a value, and reach its border through pixels like them, not through gaps.

    values : array [row, column]; NaN, as outside of the volume, is air.
    """
    is_air: Mask = ~(values > least)
    n_gap = round(GAP_SHARE * max(values.shape))
    return _grown(_from_border(~_grown(~is_air, n_gap)), n_gap) & is_air


def _from_border(is_air: Mask) -> Mask:
    """The pixels that are connected, over sides, with the border."""
    found = np.zeros_like(is_air)
    for border in (np.s_[0], np.s_[-1], np.s_[:, 0], np.s_[:, -1]):
        found[border] = is_air[border]
    # In turns along rows and columns, a run of air is found as a whole as soon as one of its pixels is.
    n_found, n_unchanged, is_turned = np.count_nonzero(found), 0, False
    while n_unchanged < 2:
        found = _whole_runs(found.T, is_air.T).T if is_turned else _whole_runs(found, is_air)
        is_turned, before, n_found = not is_turned, n_found, np.count_nonzero(found)
        n_unchanged = n_unchanged + 1 if n_found == before else 0
    return found


def _grown(mask: Mask, n: int) -> Mask:
    """The mask and all within a square of `n` pixels to each side."""
    for axis in (0, 1):
        padded = np.pad(
            np.cumsum(mask, axis, dtype=np.int32), [(n + 1, n) if k == axis else (0, 0) for k in (0, 1)], "edge"
        )
        padded = np.moveaxis(padded, axis, 0)
        padded[: n + 1] = 0
        mask = np.moveaxis(padded[2 * n + 1 :] > padded[: -2 * n - 1], 0, axis)
    return mask


def _whole_runs(found: Mask, is_air: Mask) -> Mask:
    """The runs of air along rows that have a pixel which is found."""
    is_first = is_air.copy()
    is_first[:, 1:] &= ~is_air[:, :-1]
    number = np.cumsum(is_first.ravel()).reshape(is_air.shape)
    is_reached = np.zeros(int(number.flat[-1]) + 1, bool)
    is_reached[number[found]] = True
    return is_reached[number] & is_air


# The faces that the clips of a scene cut: where they lie, and which part of each is seen.
#
# A crop and a clip plane keep half-spaces; the face of each is seen inside of the others. A box that is cut out has six
# faces, each seen within the box. No face is seen in a box that is cut out.

Array = NDArray[np.float64]

#: Part of a sample's distance within which a face lies on a wall of the volume, where nothing is cut.
ON_WALL = 1e-3


@dataclass(frozen=True)
class CutFace:
    """A face of a clip, in the world.

    plane : that it lies on; its normal points to what is kept, or into the box that is cut out.
    within : half-spaces in which it is seen. without : boxes in which it is not, six half-spaces each.
    """

    plane: ClipPlane
    within: tuple[ClipPlane, ...]
    without: tuple[tuple[ClipPlane, ...], ...]

    def is_seen(self, points: Array, slack: float) -> NDArray[np.bool_]:
        """Whether it is seen at points of its plane, shape (..., 3); up to `slack` beyond its edges, world units."""
        seen = _inside(points, self.within, slack)
        for box in self.without:
            seen &= ~_inside(points, box, -slack)
        return seen


def cut_faces(clipping: Clipping, volume: Grid) -> list[CutFace]:
    """The faces that clips cut through a volume. `clipping`: boxes in samples use this volume's indices."""
    planes = [_unit(plane) for plane in _half_spaces(clipping, volume)]
    boxes = [tuple(_unit(plane) for plane in _half_spaces(Clipping(crop=box), volume)) for box in clipping.boxes]
    found = [CutFace(plane, _others(planes, k), tuple(boxes)) for k, plane in enumerate(planes)]
    for number, box in enumerate(boxes):
        without = tuple(other for k, other in enumerate(boxes) if k != number)
        found += [
            CutFace(_at_first_missing(plane, volume), (*planes, *_others(box, k)), without)
            for k, plane in enumerate(box)
        ]
    return [face for face in found if _is_inside(face.plane, volume)]


def _half_spaces(clipping: Clipping, volume: Grid) -> tuple[ClipPlane, ...]:
    """The clip planes, and the sides of a box that is kept."""
    if clipping.crop is not None and clipping.crop.space == "world":
        return (*_sides(clipping.crop), *clipping.planes)
    return clipping.in_world(volume).planes


def _sides(box: Crop) -> list[ClipPlane]:
    lower, upper = np.sort([box.lower, box.upper], axis=0)
    return [ClipPlane(end, sign * axis) for axis in np.eye(3) for end, sign in ((lower, 1), (upper, -1))]


def _unit(plane: ClipPlane) -> ClipPlane:
    return ClipPlane(plane.point, np.array(plane.normal) / np.linalg.norm(plane.normal))


def _others(planes: Sequence[ClipPlane], number: int) -> tuple[ClipPlane, ...]:
    return tuple(plane for k, plane in enumerate(planes) if k != number)


def _inside(points: Array, planes: Sequence[ClipPlane], slack: float) -> NDArray[np.bool_]:
    inside = np.ones(points.shape[:-1], bool)
    for plane in planes:
        inside &= (points - plane.point) @ np.array(plane.normal) >= -slack
    return inside


def _at_first_missing(plane: ClipPlane, volume: Grid) -> ClipPlane:
    """The side of a box that is cut out, moved into it to the first samples that are missing.

    Matter fades out from the last sample that is kept to there, and would lie over the face as a veil.
    """
    steps = volume.world_from_index[:3, :3].T @ np.array(plane.normal)
    along = int(np.abs(steps).argmax())
    step = abs(float(steps[along]))
    moved = step
    if np.abs(np.delete(steps, along)).max() <= ON_WALL * step:  # else the first ones are stairs
        offset = (np.array(plane.point) - volume.world_from_index[:3, 3]) @ np.array(plane.normal)
        # Of samples on the side itself, rounding decides.
        moved = float((np.floor(offset / step + ON_WALL) + 1) * step - offset)
    return ClipPlane(np.array(plane.point) + moved * np.array(plane.normal), plane.normal)


def _is_inside(plane: ClipPlane, volume: Grid) -> bool:
    """Whether a plane runs through a volume, and not along one of its walls, or beside it."""
    n_z, n_y, n_x = volume.shape
    corners = np.array([[(k >> axis) & 1 for axis in range(3)] for k in range(8)]) * (n_x - 1, n_y - 1, n_z - 1)
    world = corners @ volume.world_from_index[:3, :3].T + volume.world_from_index[:3, 3]
    away = (world - plane.point) @ np.array(plane.normal)
    slack = ON_WALL * min(volume.spacing)
    return bool(away.min() < -slack and away.max() > slack)


# Slices that stand in space, and slices on the faces of cuts, as pictures on parallelograms.

#: Longest side of the picture on a card, pixels; a picture shows no finer samples.
MAX_SIDE_PX = 2048
#: Pixels of the longer side of a cut's face, at least, and most pixels for each sample: its edges are stairs of pixels.
MIN_SIDE_OF_CUT_PX, MAX_PX_OF_SAMPLE = 1024, 8
#: Pixels of the longer side of a slice that cameras are fitted to.
COARSE_PX = 96


@dataclass(frozen=True)
class SliceLayer:
    """A further layer, which lies over the first one on cuts; `identity` identifies its samples."""

    volume: Volume | WaveletVolume
    identity: object
    curves: TransferFunction
    opacity: float


@dataclass(frozen=True)
class SliceSource:
    """The volume, clips, labels and further layers that slices in a scene show; `identity` identifies the samples."""

    volume: Grid
    identity: object
    clipping: Clipping
    labels: Labels | None
    over: tuple[SliceLayer, ...]
    #: The part of the volume that is drawn, such as the brain, which cuts show; with the identity of its samples.
    part: Grid
    identity_of_part: object

    @property
    def identity_of_cuts(self) -> object:
        """Identity of all that slices on cuts show."""
        over = tuple((layer.identity, layer.curves, layer.opacity) for layer in self.over)
        return self.clipping, self.labels, over, self.identity_of_part


def cards_of(plane: SlicePlane, source: SliceSource) -> tuple[list[_native.CardArrays], dict[str, Any]]:
    """The slice, or the faces of the scene's cuts, as the compiled module takes them, and the colours of its values."""
    volume: Any = source.volume if plane.volume is None else plane.volume
    volume = volume[0] if isinstance(volume, Series) else volume
    if plane.plane != CUTS:
        picture, _ = _picture_of(plane, volume, plane.plane, _size(volume, plane.plane))
        card = _card(picture, picture.rgba, (plane.opacity, False, plane.clipped))
        return [card], picture.report["shown"][0]
    faces, volume = _cut(plane, source)
    labels = source.labels if plane.volume is None else None
    labels = None if labels is None else labels.for_slices_of(source.volume)
    over = source.over if plane.volume is None else ()
    found = [_card_on(plane, face, volume, (over, labels)) for face in faces]
    cards = [one for one in found if one is not None]
    return [card for card, _ in cards], cards[0][1] if cards else {}


def positions_on_cuts(plane: SlicePlane, source: SliceSource) -> NDArray[np.float64]:
    """World positions on the faces of cuts where they are seen, shape (n, 3): what cameras are fitted to."""
    faces, volume = _cut(plane, source)
    found = [_slice_on(plane, face, volume, _coarse_size(volume, face)) for face in faces]
    seen = [of_face.points[of_face.is_seen] for of_face in found if of_face is not None]
    return np.concatenate([np.empty((0, 3)), *seen])


@dataclass(frozen=True)
class SliceOnCut:
    """A slice on the plane of a cut: where its pixels lie, and whether the cut's face is seen there."""

    picture: Picture
    planes: Planes
    points: NDArray[np.float64]
    is_seen: NDArray[np.bool_]


def _cut(plane: SlicePlane, source: SliceSource) -> tuple[list[CutFace], Any]:
    """The faces of a scene's cuts, and the volume that a slice plane shows on them."""
    # Boxes in samples count the samples of the first layer, also for the slices of another volume.
    volume: Any = source.part if plane.volume is None else plane.volume
    return cut_faces(source.clipping, source.volume), volume[0] if isinstance(volume, Series) else volume


def _slice_on(plane: SlicePlane, face: CutFace, volume: Any, size: tuple[int, int] | None) -> SliceOnCut | None:
    """The slice of a volume on the plane of a cut's face; None where that is beside the volume."""
    try:
        picture, planes = _picture_of(plane, volume, (face.plane.point, face.plane.normal), size)
    except ArgumentError:
        return None
    report = picture.report
    right, down = (report["pixel"] * np.array(report[name]) for name in ("right", "down"))
    rows, columns = (np.arange(n) for n in picture.rgba.shape[:2])
    points = np.array(report["origin"]) + columns[None, :, None] * right + rows[:, None, None] * down
    seen = face.is_seen(points, report["pixel"] / 2) & (picture.rgba[..., 3] > 0)
    least = least_of_body(volume)
    if least is not None and picture.value is not None:
        seen &= ~air_around(picture.value, least)
    return SliceOnCut(picture, planes, points, seen)


def _card_on(
    plane: SlicePlane, face: CutFace, volume: Any, shown: tuple[Sequence[SliceLayer], Labels | None]
) -> tuple[_native.CardArrays, dict[str, Any]] | None:
    """The slice of a volume on the face of a cut, clear where the face is not seen, and the colours of its values.

    None where the face is beside the volume.

    shown : further layers and labels over it.
    """
    found = _slice_on(plane, face, volume, _size_on_cut(volume, (face.plane.point, face.plane.normal)))
    if found is None:
        return None
    rgba, (over, labels) = found.picture.rgba, shown
    for layer in over:
        values = found.planes.values_of(layer.volume, "linear", "maximum", None)
        rgba, _ = overlaid_values.values_laid_over(rgba, values, layer.curves, layer.opacity)
    rgba = rgba if labels is None else layers_on_slices.labels_laid_over(rgba, found.planes, labels)[0]
    drawn = np.where(found.is_seen[..., None], rgba, np.float32(0))
    return _card(found.picture, drawn, (plane.opacity, False, False)), found.picture.report["shown"][0]


def _coarse_size(volume: Grid, face: CutFace) -> tuple[int, int]:
    """Pixels of a slice that is only used to find where a face is seen."""
    width, height = sides_of(volume, (face.plane.point, face.plane.normal))
    step = max(width, height) / (COARSE_PX - 1)
    return int(width / step) + 1, int(height / step) + 1


def _size_on_cut(volume: Grid, plane: Any) -> tuple[int, int] | None:
    """Pixels of a slice on a cut."""
    width, height = sides_of(volume, plane)
    n = max(width, height) / min(volume.spacing)
    if n >= MIN_SIDE_OF_CUT_PX or not n > 0:
        return _size(volume, plane)
    step = max(width, height) / (min(MIN_SIDE_OF_CUT_PX, MAX_PX_OF_SAMPLE * n) - 1)
    return int(width / step) + 1, int(height / step) + 1


def _card(picture: Picture, rgba: Any, style: tuple[float, bool, bool]) -> _native.CardArrays:
    """A picture where it lies in the world. `style`: opacity, whether it is lit, whether clips cut it."""
    report = picture.report
    right, down = (report["pixel"] * np.array(report[name]) for name in ("right", "down"))
    width, height = picture.size
    return {
        # The report has the middle of the first pixel.
        "corner": triple(np.array(report["origin"]) - (right + down) / 2),
        "along_x": triple(width * right),
        "along_y": triple(height * down),
        "rgba": np.ascontiguousarray(rgba),  # opaque or clear: straight and associated are the same
        "style": style,
    }


def size_of_card(plane: SlicePlane, of_scene: Grid) -> tuple[int, int]:
    """Columns and rows of the picture on a card, before it is made; none on cuts, which are known only in a scene."""
    if plane.plane == CUTS:
        return 0, 0
    volume: Any = of_scene if plane.volume is None else plane.volume
    first = volume[0] if isinstance(volume, Series) else volume
    width, height = sides_of(first, plane.plane)
    finest = min(first.spacing)
    return _size(first, plane.plane) or (int(width / finest) + 1, int(height / finest) + 1)


def _picture_of(plane: SlicePlane, volume: Any, where: Any, size: tuple[int, int] | None) -> tuple[Picture, Planes]:
    """The slice on a plane, and where it lies."""
    values: dict[str, Any] = {"window": plane.window, "clim": plane.clim, "transfer_function": None}
    if plane.cmap is not None:
        ends = windows.limits(volume, plane.window, plane.clim)
        curves = TransferFunction.from_colormap(plane.cmap, clim=ends, opacity=1.0)
        values = {"window": None, "clim": None, "transfer_function": curves}
    return sliced(
        volume,
        where,
        plane.position if plane.index is None else _position_of(volume, plane.plane, plane.index),
        size=size,
        zoom=1.0,
        center=None,
        kernel="linear",
        thickness=0.0,
        slab="maximum",
        background=None,
        threads=None,
        **values,
    )


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
