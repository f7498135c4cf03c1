"""The kind of data in a volume, by what its file says, else by what its values look like.

The compiled module decides (`crates/look`: `kinds.rs`); here it is given the facts of the file, and samples.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, Literal, TypeAlias, cast

import numpy as np
from numpy.typing import NDArray

from wavesplat import _native
from wavesplat._looks.kinds.hounsfield import looks_like_hounsfield, stored_offset
from wavesplat._looks.kinds.looked_at import Pairs, looked_at, numbers_of, subsampled_as_float64, with_neighbours
from wavesplat._model.lazy.survey import UNIT_SAMPLES, step_for
from wavesplat._model.lazy.volume import LazyVolume
from wavesplat._model.volume import units
from wavesplat._model.volume.facts import LENGTH
from wavesplat._model.volume.grid import NO_PLACE, is_placed_by_default
from wavesplat._model.volume.volume import Volume
from wavesplat._model.volume.wavelet_volume import WaveletVolume

Kind: TypeAlias = Literal[
    "CT",
    "MR",
    "PET",
    "dose",
    "ultrasound",
    "fluorescence",
    "EM",
    "FA",
    "probability",
    "map",
    "p-values",
    "signed field",
    "field",
    "mask",
    "labels",
    "scan",
]

#: Kinds of data whose numbers are quantities at places, as simulations write them.
FIELDS: tuple[Kind, ...] = ("field", "signed field", "dose")


@dataclass(frozen=True)
class Found:
    """The kind of data, and why it is thought so."""

    kind: Kind
    reason: str
    #: Whether samples have noise, unlike results of calculations.
    has_noise: bool
    #: Whether nearly all samples are the noise of a background, and a few are far above it, as beads are.
    has_few_bright: bool
    #: Whether the samples were calculated.
    is_calculated: bool
    #: Whether they show a patient, where the axes are a patient's and placed as by default.
    shows_patient: bool

    @property
    def is_guess(self) -> bool:
        """Whether the kind was found by the values alone."""
        return self.reason.endswith("by the values")


@dataclass(frozen=True)
class Evidence(Found):
    """The kind of data, why it is thought so, and the samples that were looked at."""

    values: NDArray[np.float64]
    #: Magnitudes of the differences of neighbours, sample units per voxel, at `values`.
    gradients: NDArray[np.float64]
    #: The value of samples without data, such as -30 dBZ; None if there is no such value.
    fill: float | None
    #: The facts by which it was found.
    facts: _native.KindFacts


def evidence(volume: Volume | WaveletVolume) -> Evidence:
    """The kind of data that a volume holds, with the reason and the samples looked at; looked for once."""
    keeper = _keeper(volume)
    if keeper is not None and keeper._kind is not None:
        return cast(Evidence, keeper._kind)
    samples, neighbours = looked_at(volume)
    # Coarser levels are means of what was noise, and steeper.
    fine = volume._busiest_part() if isinstance(volume, LazyVolume) else None
    facts = _facts(volume, samples)
    found = _native.kind_of_data(
        facts,
        _as_float64(samples, neighbours),
        None if fine is None else _as_float64(*with_neighbours(fine, 1)),
        lambda: subsampled_as_float64(volume),
        lambda: _is_whole(volume),
    )
    known = Evidence(cast(Kind, found[0]), *found[1:], facts)
    if keeper is not None:
        keeper._kind = known
    return known


def _as_float64(samples: NDArray[Any], neighbours: Pairs) -> tuple[NDArray[np.float64], Pairs]:
    pairs = [(before.astype(np.float64), after.astype(np.float64)) for before, after in neighbours]
    return samples.astype(np.float64), pairs


def _facts(volume: Volume | WaveletVolume, samples: NDArray[Any]) -> _native.KindFacts:
    return {
        "name": volume.name,
        "modality": volume.modality,
        "value_unit": volume.value_unit,
        "quantity": volume.facts.quantity,
        "is_lengths": LENGTH in volume.facts.processing,
        "has_channel": volume.facts.channel is not None,
        "is_anatomical": volume.is_anatomical,
        "is_of_wavelets": isinstance(volume, WaveletVolume),
        "is_placed_by_default": is_placed_by_default(volume),
        "has_no_place": NO_PLACE in volume.facts.conventions,
        "metres": units.metres(volume.unit),
        "spacing": volume.spacing,
        "range": volume.value_range,
        "numbers": numbers_of(volume),
        "is_single": samples.dtype == np.float32,
    }


def found_in(volume: Volume | WaveletVolume) -> Found:
    """The kind of data that a volume holds, with the reason; looked for once in the same samples."""
    return evidence(volume)


def _keeper(volume: Volume | WaveletVolume) -> Volume | None:
    """The volume, if findings can be kept with it: one in memory, which forgets them when its samples change."""
    return volume if isinstance(volume, Volume) and not isinstance(volume, LazyVolume) else None


def kind_of(volume: Volume | WaveletVolume) -> Kind:
    """The kind of data that a volume holds."""
    return found_in(volume).kind


def unit_of_values(volume: Volume | WaveletVolume) -> str:
    """Unit of a volume's values: the file's, "HU" of a CT, "" where it is unknown. Quick: for every picture."""
    if volume.value_unit:
        return volume.value_unit
    if volume.modality:
        return "HU" if volume.modality == "CT" else ""
    some = volume._every(step_for(math.prod(volume.shape), UNIT_SAMPLES))
    return "HU" if looks_like_hounsfield(some[np.isfinite(some)].astype(np.float64), volume) else ""


def offset_of(volume: Volume | WaveletVolume) -> float:
    """The offset that seems to be added to the Hounsfield units of a CT, 1000 or 1024; 0 for other volumes."""
    if volume.modality not in (None, "CT"):
        return 0.0
    if volume.modality is None and not volume.is_anatomical:
        return 0.0
    samples, _ = looked_at(volume)
    return stored_offset(samples.astype(np.float64))


def _is_whole(volume: Volume | WaveletVolume) -> bool:
    """Whether floating-point numbers in memory are all whole, also those that samples spread over them missed."""
    if not isinstance(volume, Volume) or isinstance(volume, LazyVolume) or volume.dtype.kind != "f":
        return True
    return all(bool(np.array_equal(plane, np.rint(plane), equal_nan=True)) for plane in volume.samples)
