"""The default camera of a picture: on the side that data are usually seen from, as near as they fit.

The camera frames what the transfer function shows, not the box of samples around it.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import partial
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from wavesplat import _native
from wavesplat._looks.curves.transfer_function import TransferFunction
from wavesplat._looks.kinds.kinds import found_in
from wavesplat._model.arguments.clips import Clipping
from wavesplat._model.camera import fit
from wavesplat._model.camera.camera import Camera
from wavesplat._model.camera.views import triple
from wavesplat._model.lazy.survey import HISTOGRAM_SAMPLES, step_for
from wavesplat._model.volume.facts import Facts
from wavesplat._model.volume.grid import UPRIGHT, Grid, is_placed_by_default, stack_of
from wavesplat._model.volume.wavelet_volume import WaveletVolume

if TYPE_CHECKING:
    from wavesplat._looks.look import Look
    from wavesplat._model.arguments.clips import Crop
    from wavesplat._model.volume.volume import Volume

#: A volume and its look.
Part: TypeAlias = "tuple[Volume | WaveletVolume, Look]"

EVERYTHING = Clipping()

#: See `crates/view`: the share of the picture's height, or width, that the object fills.
FILLED = _native.FILLED
#: Largest number of samples that are looked at.
N_SAMPLES_MAX = 500_000


def natural_view(volume: Volume | WaveletVolume) -> tuple[float, float]:
    """Azimuth and elevation, degrees: a patient from the front, thin and coarse stacks face on, else oblique."""
    return stack_of(volume).natural_view(
        volume.is_anatomical, partial(is_upright, volume), partial(is_of_patient, volume)
    )


def is_upright(volume: Volume | WaveletVolume) -> bool:
    """Whether the axes of the world grow to the right and up in pictures, as of maps and of what was calculated.

    Rows of images grow downwards. Values of both signs are of no image, noisy or not.
    """
    if UPRIGHT in volume.facts.conventions:
        return True
    if volume.is_anatomical or volume.modality is not None:
        return False
    return found_in(volume).is_calculated


def is_of_patient(volume: Volume | WaveletVolume) -> bool:
    """Whether a volume shows a patient.

    Headers name a patient's axes for what was calculated too, and for things whose place nobody measured.
    """
    if not volume.is_anatomical or volume.modality is not None or not is_placed_by_default(volume):
        return volume.is_anatomical
    return found_in(volume).shows_patient


def framed(
    parts: Sequence[Part],
    azimuth: float,
    elevation: float,
    *,
    clipping: Clipping = EVERYTHING,
    zoom: float = 1.0,
    view_angle: float | None = None,
    aspect: float = 1.0,
    also: NDArray[np.float64] | None = None,
) -> Camera:
    """A camera on one side, with all that looks show of volumes just in view.

    parts : volumes and looks; a box in samples is in those of the first. also : world positions in view besides.
    """
    around, points = shown_points(parts, clipping, also)
    return Camera.orbit(
        around,
        azimuth,
        elevation,
        zoom=FILLED * zoom,
        view_angle=view_angle,
        aspect=aspect,
        points=points,
        fit="view",
    )


def in_view_again(
    camera: Camera,
    parts: Sequence[Part],
    *,
    clipping: Clipping = EVERYTHING,
    zoom: float = 1.0,
    aspect: float = 1.0,
    also: NDArray[np.float64] | None = None,
) -> Camera:
    """The camera itself where it shows all that looks show of volumes, else from further away or at a smaller scale.

    `zoom`: how much more than that it magnifies, which is kept.
    """
    around, points = shown_points(parts, clipping, also)
    return fit.widened(camera, around if points is None else points, zoom=zoom, aspect=aspect)


def shown_points(
    parts: Sequence[Part], clipping: Clipping = EVERYTHING, also: NDArray[np.float64] | None = None
) -> tuple[Grid, NDArray[np.float64] | None]:
    """A grid around all volumes, and the world positions of their visible samples; None where all may be visible.

    also : world positions that are visible besides, inside of the grid too.
    """
    around, points = _shown_of_volumes(parts, clipping)
    if also is None:
        return around, points
    own = _corners(around, _inside(around, None)) if points is None else points
    corners = _corners(around, _inside(around, None))
    return _around([np.concatenate([corners, also])]), np.concatenate([own, also])


def _shown_of_volumes(parts: Sequence[Part], clipping: Clipping) -> tuple[Grid, NDArray[np.float64] | None]:
    first = parts[0][0]
    within = [clipping if volume is first else clipping.in_world(first) for volume, _ in parts]
    seen = [_seen(*part, region) for part, region in zip(parts, within, strict=True)]
    if len(parts) == 1:
        around: Grid = first
        points = seen[0]
    else:
        around = _around([volume.bounds for volume, _ in parts])
        whole = [_corners(volume, _inside(volume, None)) for volume, _ in parts]
        points = np.concatenate([a if b is None else b for a, b in zip(whole, seen, strict=True)])
    return around, points


def _around(positions: Sequence[NDArray[np.float64]]) -> Grid:
    """A grid of two samples along each axis, in the corners of the box around all positions."""
    together = np.concatenate(positions)
    lower, upper = together.min(axis=0), together.max(axis=0)
    matrix = np.eye(4)
    matrix[:3, :3], matrix[:3, 3] = np.diag(upper - lower), lower
    return Grid("scene", (2, 2, 2), matrix, Facts())


def _seen(volume: Volume | WaveletVolume, look: Look, clipping: Clipping) -> NDArray[np.float64] | None:
    """World positions of visible samples; None where all of the volume may be visible."""
    function, crop = look.transfer_function, clipping.crop
    box = _inside(volume, crop)
    if np.array_equal(*box):
        return None  # The box lies outside of the volume, which the renderer reports.
    is_whole_box = not clipping.planes and not volume.n_nonfinite
    if is_whole_box and (look.labels is not None or not isinstance(function, TransferFunction)):
        return None if crop is None else _corners(volume, box)
    index, values, step = _left(volume, box, clipping)
    chosen = None
    if look.labels is None and isinstance(function, TransferFunction):
        chosen = function._core, look.composite not in ("over", "first-hit")
    within = triple(box[0]), triple(box[1])
    return _in_world(volume, _native.shown_positions(index, values, step, within, chosen, is_whole_box))


def _left(
    volume: Volume | WaveletVolume,
    box: tuple[NDArray[np.float64], NDArray[np.float64]],
    clipping: Clipping,
) -> tuple[NDArray[np.float64], NDArray[np.float64], int]:
    """Some finite samples in the box and on the kept side of the planes: index (x, y, z), value, and their distance."""
    fine = step_for(math.prod(volume.shape), HISTOGRAM_SAMPLES)
    samples = volume._every(fine)
    coarse = step_for(samples.size, N_SAMPLES_MAX)
    inside = zip(samples.shape, reversed(box[0]), reversed(box[1]), strict=True)
    picked = [
        place[(place * fine >= math.ceil(low)) & (place * fine <= high)]
        for place, low, high in ((_from_both_ends(n, coarse), low, high) for n, low, high in inside)
    ]
    values = samples[np.ix_(*picked)].ravel().astype(np.float64)
    zyx = np.unravel_index(np.flatnonzero(np.isfinite(values)), [len(place) for place in picked])
    index = np.stack([picked[axis][zyx[axis]] * fine for axis in (2, 1, 0)], axis=1).astype(np.float64)
    values = values[np.isfinite(values)]
    for plane in clipping.planes:
        is_kept = (_in_world(volume, index) - np.array(plane.point)) @ np.array(plane.normal) >= 0
        index, values = index[is_kept], values[is_kept]
    return index, values, fine * coarse


def _from_both_ends(n: int, step: int) -> NDArray[np.intp]:
    """Every n-th place from both ends to the middle: the same places in a volume that is stored the other way round.

    Every n-th from the first sample on would see one side of an object up to `step - 1` samples earlier than the other.
    """
    half = np.arange(0, (n + 1) // 2, step)
    return np.unique(np.concatenate([half, n - 1 - half]))


def _inside(volume: Grid, crop: Crop | None) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """The index box that is drawn, as (x, y, z)."""
    last = np.array([n - 1.0 for n in reversed(volume.shape)])
    if crop is None:
        return np.zeros(3), last
    with np.errstate(over="ignore", invalid="ignore"):
        lower, upper = (np.asarray(corner, dtype=np.float64) for corner in _index_corners(volume, crop))
    if not (np.isfinite(lower).all() and np.isfinite(upper).all()):
        return np.zeros(3), last  # The renderer refuses such a box.
    return np.clip(lower, 0.0, last), np.clip(upper, 0.0, last)


def _index_corners(volume: Grid, crop: Crop) -> tuple[Any, Any]:
    corners = crop.corners_in("index")
    if corners is not None:
        return corners
    lower, upper = (np.asarray(corner, dtype=np.float64) for corner in crop.corners_in("world") or ((0,) * 3,) * 2)
    ends = np.stack([np.where([(k >> a) & 1 for a in range(3)], upper, lower) for k in range(8)])
    index = np.linalg.inv(volume.world_from_index)
    inside = ends @ index[:3, :3].T + index[:3, 3]
    return inside.min(axis=0), inside.max(axis=0)


def _corners(volume: Grid, box: tuple[NDArray[np.float64], NDArray[np.float64]]) -> NDArray[np.float64]:
    lower, upper = box
    return _in_world(volume, np.stack([np.where([(k >> a) & 1 for a in range(3)], upper, lower) for k in range(8)]))


def _in_world(volume: Grid, index: NDArray[np.float64]) -> NDArray[np.float64]:
    matrix = volume.world_from_index
    return np.asarray(index @ matrix[:3, :3].T + matrix[:3, 3])
