"""A box that the picture is limited to."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Literal

from wavesplat._model.argument_types import described
from wavesplat._model.vectors import Vector, vector
from wavesplat._public import public
from wavesplat.errors import ArgumentError

__all__ = ["Crop"]


@public
@dataclass(frozen=True, init=False)
class Crop:
    """The part of the volume between two corners; the rest is empty.

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

    def corners_in(self, space: str) -> tuple[Vector, Vector] | None:
        """The two corners if the crop is given in `space`, else None."""
        return (self.lower, self.upper) if self.space == space else None
