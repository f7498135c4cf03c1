"""Grids in the world: the base of volumes of samples and of coefficients."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from wavesplat._model import affine
from wavesplat._model.facts import Facts


class Grid:
    """A grid with a name, a shape, an affine, and facts."""

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
        """Name of the volume in messages."""
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
        """Directions of the index axes x, y, z in the RAS world, to the nearest axis: "RAS", "LPS", ...

        The letters are a patient's sides only where `is_anatomical`; else they stand for the world's x, y and z.
        """
        return affine.axis_codes(self._world_from_index)

    @property
    def facts(self) -> Facts:
        """Facts that the file states beside samples and place, and guesses."""
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
        """Modality of the measurement: "CT", "MR", "PT", "fluorescence", ..., or None if the file does not say."""
        return self._facts.modality

    @property
    def value_unit(self) -> str | None:
        """Unit of the samples' values: "HU", "Bq/ml", "SUV", "Gy", ..., or None if the file does not say."""
        return self._facts.value_unit

    @property
    def guesses(self) -> tuple[str, ...]:
        """Assumptions where the file says nothing, and why; a sentence each."""
        return self._facts.guesses
