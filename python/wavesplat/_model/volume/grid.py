"""Grids in the world, the base of volumes of samples and of coefficients: place, directions of slices, names."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from wavesplat import _native
from wavesplat._model.volume import affine
from wavesplat._model.volume.facts import Facts
from wavesplat._storage.paths import NAMELESS, FileName


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


# Whether a grid's place is one that nobody measured: axis-aligned, with the origin at its first sample or its middle.
#
# Programs that know nothing of a place write such headers, and formats of medicine then say "left-posterior-superior"
# by default: an image that ITK made has that space, distances of 1 and the origin at its first sample. Nothing in such
# a header speaks of a patient, so the values decide: Hounsfield units and whole numbers, as scanners write them, are of
# one; fractions, noisy or not, were calculated.

#: A convention of a file, kept among its facts: it names a patient's axes, and nothing else of a place.
NO_PLACE = "axes of a patient: they are named, but samples are 1 apart, from the origin on, as by default"

#: Convention of a file whose axes are the axes of a map, or of a survey.
UPRIGHT = "x and y grow to the right and up in pictures, as on maps"


def is_placed_by_default(grid: Grid) -> bool:
    """Whether a grid has axes along the world's, and the world's origin at its first sample or its middle."""
    return stack_of(grid).is_placed_by_default


def is_without_place(world_from_index: NDArray[np.float64]) -> bool:
    """Whether an affine in RAS or LPS is a format's default: steps of 1 from the origin."""
    return bool(np.array_equal(np.abs(world_from_index), np.eye(4)))


# Volumes of a few slices, such as two frames of a CT, and thin stacks: both are seen from their front.


def stack_of(grid: Grid) -> _native.Stack:
    """The numbers of a volume by which `crates/view` decides whether it is a stack of slices, and how it is seen."""
    (nz, ny, nx), (x, y, z) = grid.shape, np.ptp(grid.bounds, axis=0).tolist()
    return _native.Stack((nx, ny, nz), grid.world_from_index, grid.spacing, (x, y, z))


def axis_of_distant_slices(grid: Grid) -> int | None:
    """The world's axis (0 is x) along which samples are far apart, so that other planes are blurred; else None."""
    return stack_of(grid).axis_of_distant_slices


def is_thin(grid: Grid) -> bool:
    """Whether a volume is a thin stack."""
    return stack_of(grid).is_thin


def axis_of_few_slices(grid: Grid) -> int | None:
    """The world's axis (0 is x) along which a volume has a few slices; None where it has more, or is small."""
    return stack_of(grid).axis_of_few_slices


# Names of scans by channel, quantity or modality, not by files or folders, which may be named after a patient.

#: Modalities of samples that are no patients, whose files are named after what they show.
MICROSCOPY = ("fluorescence", "EM")
#: Words for modalities whose codes few people say.
WORDS = {"PT": "PET", "RTDOSE": "dose", "SEG": "labels", "US": "ultrasound", "IVUS": "ultrasound"}


def name_of_facts(facts: Facts) -> str | None:
    """The channel, else the quantity, else the modality; None if the file names none of them."""
    channel = facts.channel.name if facts.channel is not None else ""
    modality = None if facts.modality is None else WORDS.get(facts.modality, facts.modality)
    return channel or facts.quantity or modality


def is_scan(facts: Facts) -> bool:
    """Whether a file says that it holds a scan of a patient."""
    return facts.is_anatomical or facts.modality not in (None, *MICROSCOPY)


def is_of_patient(grid: Grid) -> bool:
    """Whether the name of a volume was taken from a file or folder, and may be a patient's, by what the file says."""
    return isinstance(grid.name, FileName) and (grid.name.is_private or is_scan(grid.facts))


def name_in_files(grid: Grid) -> str:
    """The name that files say a volume has."""
    return name_of_facts(grid.facts) or NAMELESS if is_of_patient(grid) else grid.name
