"""Slices through a volume, thin or thick, as grey values or in the colours of a transfer function.

The world of medical data is RAS: x grows to the patient's right, y to the front, z upwards.
`_model/camera/views.py` says how planes of a body, and of other data, are shown.
An oblique plane is shown as the nearest of these three is, whichever way its normal points.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from math import ceil, floor
from typing import Any, TypeAlias, get_args

import numpy as np
from numpy.typing import NDArray

from wavesplat import _native
from wavesplat._looks.curves import colors
from wavesplat._looks.curves.transfer_function import TransferFunction
from wavesplat._looks.curves.transfer_function_2d import TransferFunction2D
from wavesplat._looks.kinds.kinds import unit_of_values
from wavesplat._looks.layer_names import layer_name_of
from wavesplat._model.arguments.sampling import Kernel, Plane, Slab
from wavesplat._model.camera.camera import check_place
from wavesplat._model.camera.views import (
    PLANES,
    check_magnitude,
    named_plane,
    nearest_plane,
    plane_view,
    point_and_normal,
    triple,
)
from wavesplat._model.lazy.volume import LazyVolume
from wavesplat._model.volume import affine
from wavesplat._model.volume.forked import drawing
from wavesplat._model.volume.grid import UPRIGHT, Grid
from wavesplat._model.volume.volume import Volume
from wavesplat._model.volume.wavelet_volume import WaveletVolume
from wavesplat._picture import orientation
from wavesplat._picture.picture import Picture
from wavesplat._picture.report import Report
from wavesplat._picture.report_facts import shown_layer
from wavesplat._readers.single_planes import is_single_plane
from wavesplat._render import windows
from wavesplat._render.arguments import (
    check_picture_memory,
    checked_size,
    chosen_threads,
    chosen_transfer_function,
)
from wavesplat._render.lazy_slices import part_around
from wavesplat._render.notes import notes_on_slice
from wavesplat._system.values import described, number, numbers, positive
from wavesplat.errors import ArgumentError

Array: TypeAlias = NDArray[np.float64]

#: Planes of a slab per sample along its normal, so that no sample lies further than a quarter from a plane.
PLANES_PER_SAMPLE = 2
#: Bytes of a pixel: its value, and colours that are worked on in float64; measured.
PIXEL_BYTES = 140
#: Tolerance of the volume's edge, in samples: affines in files are rounded to float32.
ON_SAMPLE = 1e-6


def sliced(
    volume: Volume | WaveletVolume,
    plane: Plane | tuple[Iterable[float], Iterable[float]] | None,
    position: float | None,
    *,
    size: tuple[int, int] | None,
    zoom: float,
    center: Iterable[float] | None,
    kernel: Kernel,
    thickness: float,
    slab: Slab,
    window: str | tuple[float | str, float | str] | None,
    clim: tuple[float | str, float | str] | None,
    transfer_function: TransferFunction | str | None,
    background: str | Sequence[float] | None,
    threads: int | None,
) -> tuple[Picture, Planes]:
    """The slice of one volume, as `wavesplat.slice` describes it, and where it lies."""
    planes = planes_of(volume, plane, position, size=size, zoom=zoom, center=center, thickness=thickness)
    if slab not in get_args(Slab):
        raise ArgumentError(f"slab is {described(slab)}; use one of: {', '.join(get_args(Slab))}")
    if (window is not None or clim is not None) and transfer_function is not None:
        raise ArgumentError("window or clim and transfer_function both say how values look; give one of them")
    low, high = windows.limits(volume, window, clim) if transfer_function is None else (0.0, 1.0)
    values = planes.values_of(volume, kernel, slab, threads)
    report: dict[str, Any] = {
        "size": [values.shape[1], values.shape[0]],
        **place_of(planes, volume),
        "unit": volume.unit,
        "anatomical": volume.is_anatomical,
        "background": colors.parse(background),
        "n_planes": len(planes.offsets_in(volume)),
        "kernel": kernel,
        "processing": list(volume.facts.processing),
    }
    if transfer_function is None:
        report["window"], report["clim"] = ((low + high) / 2, high - low), (low, high)
        is_inverted = volume.facts.is_inverted
        picture = in_greys(values, (low, high), background, is_inverted=is_inverted)
        black, white = (float(is_inverted),) * 3, (float(not is_inverted),) * 3
        colored = TransferFunction([(low, 1), (high, 1)], [(low, *black), (high, *white)])
    else:
        curves = chosen_transfer_function(transfer_function, volume)
        if isinstance(curves, TransferFunction2D):
            raise ArgumentError("a slice shows values, not gradients; give a TransferFunction, or none for grey")
        colored = curves
        picture = in_colors(values, curves, background)
    report["shown"] = [
        shown_layer(layer_name_of(volume), "over", colored, unit_of_values(volume), volume.facts.quantity)
    ]
    if notes := notes_on_slice(picture, values, report.get("clim")):
        report["notes"] = notes
    return Picture(picture, value=values, report=Report(report)), planes


def planes_of(
    volume: Volume | WaveletVolume,
    plane: Plane | tuple[Iterable[float], Iterable[float]] | None,
    position: float | None,
    *,
    size: tuple[int, int] | None,
    zoom: float,
    center: Iterable[float] | None,
    thickness: float,
) -> Planes:
    """Where the pixels of a slice lie, as `wavesplat.slice` describes it."""
    check_place(volume)
    cut = _cut(volume, plane, position)
    frame = _frame(volume, cut, size, zoom, center)
    check_picture_memory(frame.size, PIXEL_BYTES)
    planes = Planes(cut, frame, float(thickness))
    planes.offsets_in(volume)  # or an error
    return planes


def place_of(planes: Planes, volume: Grid) -> dict[str, Any]:
    """The fields of a report that say where the pixels of a slice lie."""
    cut, frame = planes.cut, planes.frame
    return {
        "position": cut.position,
        "normal": cut.normal.tolist(),
        "origin": frame.origin.tolist(),
        "right": cut.right.tolist(),
        "down": (-cut.up + 0.0).tolist(),
        "pixel": frame.pixel,
        "letters": orientation.edge_letters(cut.right, cut.up) if volume.is_anatomical else None,
    }


def positions_across(
    volume: Grid, plane: Plane | tuple[Iterable[float], Iterable[float]] | None
) -> tuple[float, float]:
    """The least and the largest position of a plane in a volume, as the user counts."""
    if plane is None or isinstance(plane, str):
        return _extent(volume, _cut(volume, plane, None).normal)
    point, normal = _point_and_normal(plane)
    least, most = _extent(volume, normal)
    return least - float(normal @ point), most - float(normal @ point)


def normal_of(volume: Grid, plane: Plane | tuple[Iterable[float], Iterable[float]] | None) -> Array:
    """The unit normal of a plane, in the world."""
    if plane is None or isinstance(plane, str):
        return _cut(volume, plane, None).normal
    return _point_and_normal(plane)[1]


def sides_of(volume: Grid, plane: Plane | tuple[Iterable[float], Iterable[float]] | None) -> tuple[float, float]:
    """Width and height of the volume as a plane shows it, world units."""
    if plane is None or isinstance(plane, str):
        cut = _cut(volume, plane, None)
        right, up = cut.right, cut.up
    else:
        right, up = _shown(volume, _point_and_normal(plane)[1])
    (left, to_right), (low, high) = _extent(volume, right), _extent(volume, up)
    return to_right - left, high - low


@dataclass(frozen=True)
class _Cut:
    """A plane and how it is shown: unit vectors in the world, `right` and `up` of the picture."""

    normal: Array
    right: Array
    up: Array
    offset: float  # of the plane along the normal
    position: float  # as the user counts it


@dataclass(frozen=True)
class _Frame:
    """Places of the pixels: the centre of the first one, and the distance of neighbours, in the world."""

    origin: Array
    pixel: float
    size: tuple[int, int]


@dataclass(frozen=True)
class Planes:
    """The plane of a slice, its pixels in the world, and the thickness of the slab around it."""

    cut: _Cut
    frame: _Frame
    thickness: float

    def offsets_in(self, volume: Grid) -> Array:
        """Offsets of the slab's planes along the normal, from the middle one: as close as a volume's samples."""
        return _offsets(volume, self.cut, self.thickness)

    def step_of(self, volume: Grid) -> float:
        """Distance along the normal from one plane of a volume's samples to the next, world units."""
        return _sample_step(volume, self.cut.normal)

    def _corners(self, offsets: Array) -> Array:
        """World positions of the corners of the slab, a row each."""
        across = self.frame.pixel * self.cut.right * (self.frame.size[0] - 1)
        down = -self.frame.pixel * self.cut.up * (self.frame.size[1] - 1)
        ends = [self.frame.origin + offset * self.cut.normal for offset in (offsets[0], offsets[-1])]
        return np.array([end + a * across + b * down for end in ends for a in (0, 1) for b in (0, 1)])

    def values_of(
        self, volume: Volume | WaveletVolume, kernel: Kernel, slab: Slab, threads: int | None
    ) -> NDArray[np.float32]:
        """The values of any volume on the slice, shape (height, width); NaN outside of it."""
        cut, frame, offsets = self.cut, self.frame, self.offsets_in(volume)
        if not len(offsets):
            return np.full(frame.size[::-1], np.nan, np.float32)
        if isinstance(volume, LazyVolume):
            part = part_around(volume, self._corners(offsets), frame.pixel)
            if part is None:
                return np.full(frame.size[::-1], np.nan, np.float32)
            volume = part
        drawn = volume._decoded(volume.left_out) if isinstance(volume, WaveletVolume) else volume._core
        first, step = offsets[0], offsets[1] - offsets[0] if len(offsets) > 1 else 0.0
        with drawing(volume):
            return _native.plane(
                drawn,
                origin=triple(frame.origin + first * cut.normal),
                across=triple(frame.pixel * cut.right),
                down=triple(-frame.pixel * cut.up),
                width=frame.size[0],
                height=frame.size[1],
                kernel=kernel,
                slab=slab,
                n_planes=len(offsets),
                step=triple(step * cut.normal),
                threads=chosen_threads(threads),
            )


def _cut(volume: Grid, plane: Plane | tuple[Iterable[float], Iterable[float]] | None, position: float | None) -> _Cut:
    if position is not None:
        number(position, "position", "a finite number, world units, or None for the middle")
    if plane is None or isinstance(plane, str):
        name = named_plane("xy" if plane is None else plane, is_anatomical=volume.is_anatomical)
        axis = "xyz".index(PLANES[name].across)
        normal = np.eye(3)[axis]
        if position is None:
            # The default is a plane of samples, not one half way between two.
            position = float(_middle_sample(volume)[axis])
        offset, what = float(position), f"position of the {plane or name} plane is {position:g}"
    else:
        point, normal = _point_and_normal(plane)
        position = 0.0 if position is None else float(position)
        offset = float(normal @ point) + position
        what = f"the oblique plane lies at {offset:g} along its normal from the world's origin"
    least, most = _extent(volume, normal)
    tolerance = ON_SAMPLE * _sample_step(volume, normal)
    if not least - tolerance <= offset <= most + tolerance:
        raise ArgumentError(
            f"{what}, which is outside the volume {volume.name!r}; it reaches from {least:g} to {most:g}"
        )
    return _Cut(normal, *_shown(volume, normal), offset, float(position))


def _point_and_normal(plane: Any) -> tuple[Array, Array]:
    try:
        point, normal = plane
    except (TypeError, ValueError, OverflowError):
        raise ArgumentError(
            f"plane is {described(plane)}; give {', '.join(PLANES)}, or (point, normal), three numbers each"
        ) from None
    point, normal = (np.array(one) for one in point_and_normal(point, normal, "plane"))
    return point, normal / np.linalg.norm(normal)


def _shown(volume: Grid, normal: Array) -> tuple[Array, Array]:
    """Right and up of the picture: the directions of the nearest named plane, turned with the plane."""
    near = nearest_plane(normal.tolist(), is_anatomical=volume.is_anatomical)
    view = plane_view(near, is_upright=UPRIGHT in volume.facts.conventions)
    _, up, to_near_eye = (np.array(axis) for axis in view.axes)
    to_eye = normal if normal @ to_near_eye > 0 else -normal
    up = up - (up @ to_eye) * to_eye
    up /= np.linalg.norm(up)
    # Adding 0.0 turns -0.0 into 0.0, which prints better.
    return np.cross(up, to_eye) + 0.0, up + 0.0


def _middle_sample(volume: Grid) -> Array:
    is_flat = is_single_plane(volume)  # two equal planes, and it lies between them
    index = np.array([0.5 if is_flat and n == 2 else n // 2 for n in reversed(volume.shape)], dtype=np.float64)
    matrix = volume.world_from_index
    middle: Array = matrix[:3, :3] @ index + matrix[:3, 3]
    return middle


def _extent(volume: Grid, direction: Array) -> tuple[float, float]:
    """Range of the samples' positions along a direction."""
    along = affine.box_corners(volume.world_from_index, volume.shape) @ direction
    return float(along.min()), float(along.max())


def _sample_step(volume: Grid, direction: Array) -> float:
    """Distance along a direction over which the first index changes by 1, world units."""
    return float(1 / np.abs(np.linalg.solve(volume.world_from_index[:3, :3], direction)).max())


def _frame(
    volume: Grid, cut: _Cut, size: tuple[int, int] | None, zoom: float, center: Iterable[float] | None
) -> _Frame:
    positive(zoom, "zoom", "a positive finite number, 1 shows the whole volume")
    check_magnitude(zoom, "zoom")
    ends = np.array([_extent(volume, cut.right), _extent(volume, cut.up)])
    lengths = ends[:, 1] - ends[:, 0]
    if size is None:
        pixel = min(volume.spacing)
        width, height = (floor(length / pixel + ON_SAMPLE) + 1 for length in lengths)
    else:
        width, height = checked_size(size)
        # The outermost pixels lie on the outermost samples.
        pixel = float((lengths / (np.maximum((width, height), 2) - 1)).max())
    pixel /= zoom
    middle = ends.mean(axis=1)
    if center is not None:
        point = np.array(numbers(center, "center of the slice", "finite numbers (x, y, z), world units", n=3))
        middle = np.array([cut.right @ point, cut.up @ point])
    left, top = middle[0] - (width - 1) / 2 * pixel, middle[1] + (height - 1) / 2 * pixel
    return _Frame(left * cut.right + top * cut.up + cut.offset * cut.normal, pixel, (width, height))


def _offsets(volume: Grid, cut: _Cut, thickness: float) -> Array:
    """Offsets of the slab's planes from the middle one; planes outside the volume are left out."""
    number(thickness, "thickness", "0 for a plane, or a positive number, world units", least=0)
    if thickness == 0:
        return np.zeros(1)
    # Beyond the volume there is nothing; thinner than a millionth of a sample it is a plane.
    sample_step = _sample_step(volume, cut.normal)
    least, most = _extent(volume, cut.normal)
    farthest = max(most - least, abs(least - cut.offset), abs(most - cut.offset))
    thickness = min(thickness, 2 * farthest + sample_step)
    if thickness < ON_SAMPLE * sample_step:
        return np.zeros(1)
    n_steps = max(1, ceil(PLANES_PER_SAMPLE / 2 * thickness / sample_step - ON_SAMPLE))
    step = thickness / (2 * n_steps)
    least, most = (np.array((least, most)) - cut.offset) / step
    return np.arange(max(-n_steps, ceil(least - ON_SAMPLE)), min(n_steps, floor(most + ON_SAMPLE)) + 1) * step


def in_greys(
    values: NDArray[np.float32],
    limits: tuple[float, float],
    background: str | Sequence[float] | None,
    *,
    is_inverted: bool = False,
) -> NDArray[np.float32]:
    """Values as greys, over the background where there are none.

    limits : the values that are black and white. is_inverted : white and black.
    """
    low, high = limits
    grey = np.clip((values.astype(np.float64) - low) / (high - low), 0, 1)[..., None]
    grey = 1 - grey if is_inverted else grey
    return _on_background(grey, np.isfinite(values), background)


def in_colors(
    values: NDArray[np.float32], curves: TransferFunction, background: str | Sequence[float] | None
) -> NDArray[np.float32]:
    """Values in the opaque colours of a transfer function, over the background where it or they are not seen."""
    rgba = curves(values.ravel()).reshape(*values.shape, 4)
    return _on_background(rgba[..., :3], np.isfinite(values) & (rgba[..., 3] > 0), background)


def planes_through(volume: Grid, n: int, size: tuple[int, int]) -> list[Planes]:
    """Planes of few pixels, spread evenly over the volume across its z axis, to take a sample of its values."""
    least, most = positions_across(volume, None)
    cuts = [_cut(volume, None, least + (number + 0.5) * (most - least) / n) for number in range(n)]
    return [Planes(cut, _frame(volume, cut, size, 1.0, None), 0.0) for cut in cuts]


def planes_at(origin: Array, right: Array, up: Array, pixel: float, size: tuple[int, ...]) -> Planes:
    """A plane of pixels anywhere in the world. origin : of the first pixel's centre. right, up : unit vectors."""
    normal = np.cross(right, up)
    offset = float(normal @ origin)
    return Planes(_Cut(normal, right, up, offset, offset), _Frame(origin, pixel, (size[0], size[1])), 0.0)


def _on_background(
    rgb: NDArray[np.float64], shown: NDArray[np.bool_], background: str | Sequence[float] | None
) -> NDArray[np.float32]:
    red, green, blue, alpha = colors.parse(background) or (0.0, 0.0, 0.0, 0.0)
    picture = np.empty((*shown.shape, 4), np.float32)
    picture[..., :3] = rgb  # greys have one channel for all three
    picture[..., 3] = 1
    picture[~shown] = red * alpha, green * alpha, blue * alpha, alpha
    return picture
