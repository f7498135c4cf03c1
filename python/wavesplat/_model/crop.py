"""A box that the picture is limited to, or that is taken out of it."""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

import numpy as np
from numpy.typing import NDArray

from wavesplat._model.argument_types import described, takes_its_types
from wavesplat._model.grid import Grid
from wavesplat._model.vectors import Vector, vector
from wavesplat._public import public
from wavesplat.errors import ArgumentError

if TYPE_CHECKING:
    from wavesplat._model.volume_like import VolumeLike

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
        from wavesplat._model.volume_like import as_volume

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
