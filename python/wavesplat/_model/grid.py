"""Where samples lie in the world: what volumes of samples and of coefficients have in common."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from wavesplat._model import affine
from wavesplat._model.facts import Facts

__all__ = ["Grid"]


class Grid:
    """A name, a shape, an affine, and what the file says beside them."""

    __slots__ = ("_facts", "_name", "_shape", "_world_from_index")

    def __init__(
        self, name: str, shape: tuple[int, int, int], world_from_index: NDArray[np.float64], facts: Facts
    ) -> None:
        self._name = name
        self._shape = shape
        self._world_from_index = world_from_index
        self._facts = facts

    @property
    def name(self) -> str:
        """What messages call the volume."""
        return self._name

    @property
    def shape(self) -> tuple[int, int, int]:
        """Number of samples along (z, y, x)."""
        return self._shape

    @property
    def world_from_index(self) -> NDArray[np.float64]:
        """Affine from the index (x, y, z) of a sample to the world, shape (4, 4), read-only."""
        return self._world_from_index

    @property
    def spacing(self) -> tuple[float, float, float]:
        """Distances between neighbouring samples along x, y, z, in world units."""
        x, y, z = (float(step) for step in affine.spacing_of(self._world_from_index))
        return x, y, z

    @property
    def bounds(self) -> NDArray[np.float64]:
        """Corners (lower, upper) of the world box around all sample centres, shape (2, 3), as (x, y, z)."""
        return affine.world_bounds(self._world_from_index, self._shape)

    @property
    def orientation(self) -> str:
        """Where the index axes x, y, z point in the RAS world, to the nearest axis: "RAS", "LPS", ...

        Of a patient only where `is_anatomical`; else of a world whose x, y and z are called so.
        """
        return affine.axis_codes(self._world_from_index)

    @property
    def facts(self) -> Facts:
        """What the file says beside samples and place, and what was guessed."""
        return self._facts

    @property
    def unit(self) -> str | None:
        """The world's unit of length: "mm", "um", "nm", "m", ..., or None if unknown."""
        return self._facts.unit

    @property
    def is_anatomical(self) -> bool:
        """Whether the world's axes are a patient's."""
        return self._facts.is_anatomical

    @property
    def modality(self) -> str | None:
        """How the samples were measured: "CT", "MR", "PT", "fluorescence", ..., or None if the file does not say."""
        return self._facts.modality

    @property
    def guesses(self) -> tuple[str, ...]:
        """What was assumed where the file says nothing, and why; a sentence each."""
        return self._facts.guesses
