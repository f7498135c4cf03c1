"""Slices that stand in space, and those on the faces of cuts, as pictures on parallelograms."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from wavesplat._geometry.slice_plane import CUTS
from wavesplat._looks.labels import Labels
from wavesplat._looks.transfer_function import TransferFunction
from wavesplat._model.clips import Clipping
from wavesplat._model.grid import Grid
from wavesplat._model.series import Series
from wavesplat._model.vectors import triple
from wavesplat._model.views import PLANES, named_plane
from wavesplat._model.volume import Volume
from wavesplat._model.wavelet_volume import WaveletVolume
from wavesplat._render import windows
from wavesplat._render.slicing import Planes, sides_of, sliced
from wavesplat._scene import label_slices, overlaid_values
from wavesplat._scene.body_outline import air_around, least_of_body
from wavesplat._scene.cut_faces import CutFace, cut_faces
from wavesplat.errors import ArgumentError

if TYPE_CHECKING:
    from wavesplat import _native
    from wavesplat._geometry.slice_plane import SlicePlane
    from wavesplat._picture.picture import Picture

__all__ = ["SliceLayer", "SliceSource", "cards_of", "positions_on_cuts", "size_of_card"]

#: Longest side of the picture on a card, pixels; a picture shows no finer samples.
MAX_SIDE_PX = 2048
#: Pixels of the longer side of a cut's face, at least, but no more than so many for each sample: its edges are stairs
#: of pixels.
MIN_SIDE_OF_CUT_PX, MAX_PX_OF_SAMPLE = 1024, 8
#: Pixels of the longer side of a slice that cameras are fitted to.
COARSE_PX = 96


@dataclass(frozen=True)
class SliceLayer:
    """A further layer, which lies over the first one on cuts; `identity` is that of its samples."""

    volume: Volume | WaveletVolume
    identity: object
    curves: TransferFunction
    opacity: float


@dataclass(frozen=True)
class SliceSource:
    """The volume, clips, labels and further layers that slices in a scene show; `identity` is that of the samples."""

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
    # Boxes in samples are in those of the first layer, also for the slices of another volume.
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
        rgba, _ = overlaid_values.laid_over(rgba, values, layer.curves, layer.opacity)
    rgba = rgba if labels is None else label_slices.laid_over(rgba, found.planes, labels)[0]
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
