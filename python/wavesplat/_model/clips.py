"""Clips of a scene: a box that is kept, planes that keep one side, boxes that are taken out."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace
from itertools import islice
from typing import TypeAlias

import numpy as np

from wavesplat._model.argument_types import described
from wavesplat._model.crop import Crop
from wavesplat._model.grid import Grid
from wavesplat._model.vectors import Vector, point_and_normal
from wavesplat._public import public
from wavesplat.errors import ArgumentError

__all__ = ["Clip", "ClipPlane", "Clipping", "CutOut", "clip_tuple", "combined_clips"]


@public
@dataclass(frozen=True, init=False)
class ClipPlane:
    """A clip that keeps the side of a plane that its normal points to.

    Parameters
    ----------
    point, normal : three numbers (x, y, z)
        A point on the plane and its normal, of any length; world units.

    Raises
    ------
    ArgumentError
        If one of them is not three finite numbers, or the normal is zero.

    Examples
    --------
    >>> import wavesplat as ws
    >>> volume = ws.examples.ripples(8)
    >>> upper_half = ws.ClipPlane((0, 0, 3.5), (0, 0, 1))
    >>> ws.render(volume, clip=upper_half, size=(8, 8)).size
    (8, 8)
    """

    point: Vector
    normal: Vector

    def __init__(self, point: Iterable[float], normal: Iterable[float]) -> None:
        for name, value in zip(("point", "normal"), point_and_normal(point, normal, "clip plane"), strict=True):
            object.__setattr__(self, name, value)


@public
@dataclass(frozen=True)
class CutOut:
    """A clip that takes a box out, to look into the volume; colours stay those of the whole volume.

    Parameters
    ----------
    crop : Crop
        The box, such as `Crop.corner(volume, "left anterior superior")`. Samples whose centres are inside of it are
        missing, and matter fades out over the cell before the first of them; on axes that are oblique to the box its
        faces are stairs of samples. Labels are taken out with them.

    Raises
    ------
    ArgumentError
        If `crop` is not a `Crop`, or a corner is not finite.

    Notes
    -----
    The first picture with other boxes makes a copy of the samples, 4 bytes each (8 where they are 32-bit integers or
    float64), and what the renderer prepares of it takes 5 more; volume and labels keep both until other boxes are
    given. A WaveletVolume has no samples to take out: draw its `to_volume()`.

    Examples
    --------
    >>> import wavesplat as ws
    >>> pelvis = ws.examples.ct_pelvis()
    >>> corner = ws.Crop.corner(pelvis, "left anterior superior")
    >>> picture = ws.render(pelvis, "ct-muscle", clip=ws.CutOut(corner), size=(32, 32))
    """

    crop: Crop

    def __post_init__(self) -> None:
        if not isinstance(self.crop, Crop):
            raise ArgumentError(
                f"CutOut takes out a {type(self.crop).__name__}; give a wavesplat.Crop(lower, upper, space=...)"
            )
        if not np.isfinite([self.crop.lower, self.crop.upper]).all():
            raise ArgumentError(f"CutOut has corners {self.crop.lower} and {self.crop.upper}; give finite numbers")


#: A part of the argument `clip`.
Clip: TypeAlias = Crop | ClipPlane | CutOut


@dataclass(frozen=True)
class Clipping:
    """All clips of a scene: one box that is kept, in one space, planes, and boxes to take out."""

    crop: Crop | None = None
    planes: tuple[ClipPlane, ...] = ()
    boxes: tuple[Crop, ...] = ()

    def in_world(self, grid: Grid) -> Clipping:
        """The clips in the world, for grids other than `grid`: a box in its samples becomes six planes."""
        if self.crop is None or self.crop.space == "world":
            return self
        lower, upper = np.sort([self.crop.lower, self.crop.upper], axis=0)
        matrix, origin = grid.world_from_index[:3, :3], grid.world_from_index[:3, 3]
        # Rows of the inverse are normals of the planes of constant index.
        normals = np.linalg.inv(matrix)
        ends = [matrix @ corner + origin for corner in (lower, upper)]
        planes = [ClipPlane(ends[k], (1 - 2 * k) * normal) for normal in normals for k in (0, 1)]
        return replace(self, crop=None, planes=(*self.planes, *planes))


def clip_tuple(given: object) -> tuple[Clip, ...]:
    """The clips of an argument, a single one without a list too; an `ArgumentError` for anything else."""
    if isinstance(given, Crop | ClipPlane | CutOut):
        return (given,)
    if given is None or isinstance(given, str | bytes) or not isinstance(given, Iterable):
        raise ArgumentError(f"clip is {described(given)}; {MEND}")
    clips = tuple(islice(given, MAX_CLIPS + 1))
    if len(clips) > MAX_CLIPS:
        raise ArgumentError(f"clip has more than {MAX_CLIPS} parts; leave out those that cut nothing")
    for number, clip in enumerate(clips):
        if not isinstance(clip, Crop | ClipPlane | CutOut):
            raise ArgumentError(f"clip {number} is {described(clip)}; {MEND}")
    return clips


#: Planes and boxes of a scene, at most: each is looked at for every sheet.
MAX_CLIPS = 256
MEND = (
    "give wavesplat.Crop(lower, upper) to keep a box, ClipPlane(point, normal) to keep a side of a plane, "
    "CutOut(Crop(...)) to take a box out, or several of them in a list"
)


def combined_clips(given: object) -> Clipping:
    """The clips combined: boxes are intersected within each space, and those of a second space become planes."""
    clips = clip_tuple(given)
    crops = [clip for clip in clips if isinstance(clip, Crop)]
    planes = [clip for clip in clips if isinstance(clip, ClipPlane)]
    kept = [_common(boxes) for space in ("index", "world") if (boxes := [c for c in crops if c.space == space])]
    if len(kept) == 2:
        planes += _planes_of(kept[1])
    taken = tuple(clip.crop for clip in clips if isinstance(clip, CutOut))
    return Clipping(kept[0] if kept else None, tuple(planes), taken)


def _common(boxes: list[Crop]) -> Crop:
    """Intersection of boxes of one space."""
    if len(boxes) == 1:
        return boxes[0]
    corners = np.sort([[box.lower, box.upper] for box in boxes], axis=1)
    lower, upper = corners[:, 0].max(axis=0), corners[:, 1].min(axis=0)
    if not (lower <= upper).all():
        raise ArgumentError(f"the {len(boxes)} boxes of clip have nothing in common; take boxes out with CutOut")
    return Crop(lower.tolist(), upper.tolist(), boxes[0].space)


def _planes_of(box: Crop) -> list[ClipPlane]:
    lower, upper = np.sort([box.lower, box.upper], axis=0)
    return [ClipPlane(end, sign * axis) for axis in np.eye(3) for end, sign in ((lower, 1), (upper, -1))]
