"""Clips: a box that is kept, planes that keep one side, and boxes that are taken out."""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import dataclass, replace
from itertools import islice
from typing import TYPE_CHECKING, Literal, TypeAlias

import numpy as np
from numpy.typing import NDArray

from wavesplat._model.arguments.types import takes_its_types
from wavesplat._model.camera.views import Vector, point_and_normal, vector
from wavesplat._model.volume.grid import Grid
from wavesplat._public import public
from wavesplat._system.values import described
from wavesplat.errors import ArgumentError

if TYPE_CHECKING:
    from wavesplat._model.volume.volume_like import VolumeLike

# A box that the picture is limited to, or that is taken out of it.

#: Side of a patient -> axis of the RAS world, and sign.
SIDES = {
    "right": (0, 1),
    "left": (0, -1),
    "anterior": (1, 1),
    "posterior": (1, -1),
    "superior": (2, 1),
    "inferior": (2, -1),
}


@public
@dataclass(frozen=True, init=False)
class Crop:
    """A box between two corners: the part of a volume that a picture keeps or, as `CutOut`, that is taken out.

    Parameters
    ----------
    lower, upper : three numbers (x, y, z)
        Opposite corners. They may lie between samples, or outside the volume.
    space : "world" or "index", default "world"
        World units, in the world's axes; or samples, in the volume's own axes, 0 .. n - 1.

    Raises
    ------
    ArgumentError
        If a corner is not three numbers or the space has another name.

    Examples
    --------
    >>> import wavesplat as ws
    >>> ws.Crop((0, 0, 10), (63, 63, 20.5), space="index").upper
    (63.0, 63.0, 20.5)
    """

    lower: Vector
    upper: Vector
    space: Literal["world", "index"]

    def __init__(
        self, lower: Iterable[float], upper: Iterable[float], space: Literal["world", "index"] = "world"
    ) -> None:
        given: object = space
        if not isinstance(given, str) or given not in ("world", "index"):
            raise ArgumentError(f'space of the crop is {described(space)}; it is "world" or "index"')
        object.__setattr__(self, "lower", vector(lower, "lower corner of the crop"))
        object.__setattr__(self, "upper", vector(upper, "upper corner of the crop"))
        object.__setattr__(self, "space", space)

    @classmethod
    @takes_its_types
    def corner(cls, volume: VolumeLike, name: str, *, at: Iterable[float] | None = None) -> Crop:
        """A corner, an edge or a half of a volume, to be taken out or kept: a box in the world.

        Parameters
        ----------
        volume : Volume, WaveletVolume, array, or what else `Volume` takes
            The volume that the corner belongs to.
        name : str
            One to three sides: of a patient right, left, anterior, posterior, superior and inferior, such as
            "right anterior superior" or "left"; of any volume, signs and axes of the world, such as "+x-y+z" or "+y".
        at : three numbers (x, y, z), optional
            Where the corner's innermost point is, in the world; None is the middle of the volume.

        Raises
        ------
        ArgumentError
            If the name is unknown, or names a patient's sides and the volume's world is no patient's.

        Examples
        --------
        >>> import wavesplat as ws
        >>> pelvis = ws.examples.ct_pelvis()
        >>> corner = ws.Crop.corner(pelvis, "left anterior superior")
        >>> picture = ws.render(pelvis, "ct-muscle", clip=ws.CutOut(corner), size=(32, 32))
        """
        from wavesplat._model.volume.volume_like import as_volume

        grid = as_volume(volume)
        signs = _signs(str(name), grid)
        lower, upper = grid.bounds
        middle = (lower + upper) / 2 if at is None else np.array(vector(at, "`at` of the corner"))
        # A sample beyond the volume, so that its own face goes too.
        lower, upper = lower - sum(grid.spacing), upper + sum(grid.spacing)
        lower, upper = np.where(signs > 0, middle, lower), np.where(signs < 0, middle, upper)
        return cls(lower.tolist(), upper.tolist())

    def corners_in(self, space: str) -> tuple[Vector, Vector] | None:
        """The two corners if the crop is given in `space`, else None."""
        return (self.lower, self.upper) if self.space == space else None


def _signs(name: str, volume: Grid) -> NDArray[np.int64]:
    """Sign of each world axis: 1 the upper side, -1 the lower one, 0 both."""
    signs = np.zeros(3, dtype=np.int64)
    words = re.split(r"[\s,-]+", name.strip().lower())
    if all(word in SIDES for word in words):
        if not volume.is_anatomical:
            raise ArgumentError(
                f"{name!r} is a corner of a patient, and nothing says how volume {volume.name!r} lies in one; "
                'name the axes of the world, such as "+x-y+z"'
            )
        sides = [SIDES[word] for word in words]
    elif re.fullmatch(r"([+-][xyz])+", name.strip().lower()):
        sides = [
            ("xyz".index(axis), 1 if sign == "+" else -1) for sign, axis in re.findall(r"(.)(.)", name.strip().lower())
        ]
    else:
        raise ArgumentError(
            f"corner {name!r} is unknown; name one to three sides of a patient ({', '.join(SIDES)}), such as "
            '"right anterior superior", or of the world, such as "+x-y+z"'
        )
    for axis, sign in sides:
        if signs[axis]:
            raise ArgumentError(f"corner {name!r} names two sides along {'xyz'[axis]}; give one of them")
        signs[axis] = sign
    return signs


# Clips of a scene: a box that is kept, planes that keep one side, boxes that are taken out.


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
    """A clip that takes a box out, to look into the volume; colours stay as in the whole volume.

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
    """The clips combined: boxes are intersected within each space, and boxes of a second space become planes."""
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
