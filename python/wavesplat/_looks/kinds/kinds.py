"""The kind of data in a volume, by what its file says, else by what its values look like.

Facts of the file (modality, unit, whether the axes are a patient's) come first. Where they are missing, the values
decide by tests that are reported beside it: Hounsfield units have air and soft tissue at the fixed points of their
scale; a mask has two values; labels are whole numbers that are the same from sample to sample; a field has both signs,
or fractions, or no noise; PET has no negative values, coarse samples and a few very bright spots. Shares, such as
probabilities, and other calculated maps have files of their own: `measured_maps.py`.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, Literal, TypeAlias

import numpy as np
from numpy.typing import NDArray

from wavesplat._looks.kinds.histogram import otsu, robust_range_of
from wavesplat._looks.kinds.hounsfield import looks_like_hounsfield, stored_offset
from wavesplat._looks.kinds.looked_at import (
    Pairs,
    looked_at,
    numbers_of,
    slopes,
    subsampled,
    with_neighbours,
    without_missing,
)
from wavesplat._looks.kinds.measured_maps import map_kind, share_kind
from wavesplat._model.lazy.survey import UNIT_SAMPLES, step_for
from wavesplat._model.lazy.volume import LazyVolume
from wavesplat._model.volume import units
from wavesplat._model.volume.facts import LENGTH
from wavesplat._model.volume.grid import is_of_no_patient, is_placed_by_default
from wavesplat._model.volume.volume import Volume
from wavesplat._model.volume.wavelet_volume import WaveletVolume

# Roughness of samples: how much neighbours bend beside how much they rise.
#
# For samples a, b, c in a row the bend is |a - 2b + c| and the rise |c - a| / 2. A wave of n samples has 2 pi / n of
# bend to its rise; independent noise 3.5, since their deviations are sqrt(6) and sqrt(1/2) of the noise's. Scans have
# noise, and boundaries about as sharp as their samples; codes that solve equations need some samples for what they
# solve. (Medians and sums of 22 scans: 1.2 to 3.4, but for an engine's sum, 0.97, and smoothed phantoms, 0.9. Fuel, a
# jet of heptane, a protein's density, bytes all: 0.4 to 0.8.)

#: Largest roughness of data without noise.
MAX_SMOOTH = 0.9


def roughness(samples: NDArray[Any], neighbours: list[tuple[NDArray[Any], NDArray[Any]]]) -> float:
    """Ratio of bend to rise, over all samples and in the median of those that rise, whichever is larger.

    samples : any number of samples. neighbours : their two neighbours along each axis; samples take no part along axes
        where one of the three is missing (not finite). Infinity where nothing rises.
    """
    middle = samples.astype(np.float64)
    bend, rise = np.zeros(middle.shape), np.zeros(middle.shape)
    with np.errstate(over="ignore", invalid="ignore"):
        for before, after in neighbours:
            low, high = before.astype(np.float64), after.astype(np.float64)
            is_known = np.isfinite(low) & np.isfinite(middle) & np.isfinite(high)
            bend += np.where(is_known, np.abs(low - 2 * middle + high), 0.0)
            rise += np.where(is_known, 0.5 * np.abs(high - low), 0.0)
        values, counts = np.unique(middle[np.isfinite(middle)], return_counts=True)
        # A background of one value is no matter, smooth or not.
        background = values[counts.argmax()] if values.size else np.nan
        is_matter = np.isfinite(bend) & np.isfinite(rise) & (rise > 0) & (middle != background)
        if not is_matter.any():
            return float("inf")
        is_finite = np.isfinite(bend) & np.isfinite(rise)
        whole = bend[is_finite].sum() / rise[is_finite].sum()
    return float(max(whole, np.median(bend[is_matter] / rise[is_matter])))


def is_smooth(samples: NDArray[Any], neighbours: list[tuple[NDArray[Any], NDArray[Any]]]) -> bool:
    """Whether samples have no noise, as the results of simulations."""
    return roughness(samples, neighbours) < MAX_SMOOTH


# The kind of data in a volume, by what its file says, else by what its values look like.

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
#: DICOM's modalities of the kinds that have a look of their own. Angiography is X-ray: bright vessels, no fixed scale.
MODALITIES: dict[str, Kind] = {
    "MR": "MR",
    "PT": "PET",
    "NM": "PET",
    "RTDOSE": "dose",
    "US": "ultrasound",
    "IVUS": "ultrasound",
    "fluorescence": "fluorescence",
    "EM": "EM",
}
#: PET: least distance of samples, millimetres, and least ratio of the 99.9th to the 90th percentile. (A PET of a body:
#: 3.4 mm, 13 times; MR of heads: 1 mm, 2 to 3 times.)
PET_SPACING_MM, PET_TAIL = 1.8, 8.0
#: Labels: largest number of them, and least share of samples in regions of one value. (Balls of radius 2: 0.86, larger
#: ones and nuclei: over 0.95; scans of 8 bits: up to 0.35; noise: 0.3; scans enlarged 4 times by repetition: 0.76.)
MAX_LABELS, MIN_ALIKE = 2000, 0.8
#: Few labels, such as the parts of a lesion, and the same share of them: a scan has more values than these. At least
#: this share of the borders between the levels of a smooth scan are steps of 1.
FEW_LABELS, MIN_ALIKE_OF_FEW, MAX_GENTLE = 8, 0.5, 0.95
#: Labels of thin parts that lie apart, such as pieces of bone or vessels: largest share of the neighbours that have
#: neither the same value nor the background's, with the least share in regions of few labels. (Pieces of the bones of a
#: CT at 3 mm: 0.61 in regions, no others; vessels with an aneurysm: 0.82, no others; scans: 0.46 others at least.)
MAX_OTHERS = 0.02
#: Units of values that labels may have: files that must name one say that they have none.
UNITS_OF_LABELS = ("", "1")
#: Signs: least ratio of the smaller of the two tails to the larger one. A tail ends at a percentile; of data without
#: noise, of which no sample is an accident, at the extreme.
MIN_TAIL, TAILS = 0.15, (0.5, 99.5)
#: The same of whole numbers, which are scans with an offset more often.
MIN_WHOLE_TAIL = 0.5
#: Least ratio of the extremes of both signs; below, the smaller one is rounding. (Density of the cores of atoms: 3e-7.)
MIN_END = 1e-5
#: Dense tissue: least median, as a share of the range. (EM of a worm: 0.65; fluorescence: 0.1 to 0.2.)
MIN_BRIGHT = 0.45
#: Fluorescence, where only values decide: largest share of samples of one value (a background without noise was not
#: counted from photons), least ratio of the 99.9th percentile to the median of the object, both above the background
#: (cells 2.8 to 11, a mouse brain 3.9; vessels 1.3, an engine 1.8), and distance of samples in a file that has another
#: unit, metres.
MAX_EQUAL, MIN_GLOW, FINE_METRES = 0.25, 2.5, 1e-4
#: Padding: least distance of its value from the next one, as a share of the distance from the median of the others.
MIN_GAP = 0.25
#: A few bright samples over noise: least ratio of the distances of the 10th and 90th percentiles to the median, either
#: way, deviations of the noise above the median that are far, largest share of samples that far, and least number of
#: neighbours that are both so. (Beads: 0.83 to 1, up to 0.015; cells: 0.3 to 0.7; EM 0.4; vessels in PC-MR: 0.2.)
MIN_EVEN, FAR, MAX_FAR, MIN_TOGETHER = 0.78, 8.0, 0.02, 4
FEW_BRIGHT: tuple[Kind, str] = (
    "fluorescence",
    "fluorescence, or other light: nearly all is noise, and a few samples are far above it, by the values",
)
DENSE = "dense matter that fills the volume, as in electron microscopy: mostly bright, by the values"
#: Minimum share of samples with exactly the least value for which that value means "no data", such as -30 dBZ.
MIN_FILL = 0.1
#: Number of bins of the histogram in which the peak of air is searched; it must lie in this lowest share of the bins.
N_AIR_BINS, MAX_AIR_PLACE = 64, 0.1


@dataclass(frozen=True)
class Found:
    """The kind of data, and why it is thought so."""

    kind: Kind
    reason: str
    #: Whether samples have noise, unlike results of calculations.
    has_noise: bool
    #: Whether nearly all samples are the noise of a background, and a few are far above it, as beads are.
    has_few_bright: bool

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

    @property
    def fill(self) -> float | None:
        """The value of samples without data (see `fill_of`); None if there is no such value."""
        return fill_of(self.values)


def fill_of(values: NDArray[np.float64]) -> float | None:
    """The value of samples without data: a negative one, the least, that a large share of samples has exactly.

    None where another phase has the largest value as often.
    """
    if not values.size or not values.min() < 0:
        return None
    least, largest = float(values.min()), float(values.max())
    is_fill = np.mean(values == least) >= MIN_FILL > np.mean(values == largest)
    return least if is_fill else None


def evidence(volume: Volume | WaveletVolume) -> Evidence:
    """The kind of data that a volume holds, with the reason and the samples looked at."""
    samples, neighbours = looked_at(volume)
    # `hypot`, since the squares of samples near the limits of float64 overflow.
    values = samples.astype(np.float64)
    gradients = np.hypot.reduce([np.zeros_like(values), *slopes(samples, neighbours)])
    finite = np.isfinite(values)
    values, gradients = values[finite], gradients[finite]
    if not values.size or values.min() == values.max():
        # All that varies was not looked at, such as the border of a small volume: curves need a range.
        values, gradients = np.append(values, volume.value_range), np.append(gradients, (0.0, 0.0))
    # Coarser levels are means of what was noise, and steeper.
    fine = volume._busiest_part() if isinstance(volume, LazyVolume) else None
    side_by_side = (samples, neighbours) if fine is None else with_neighbours(fine, 1)
    has_noise = not is_smooth(*side_by_side)
    found = _segmentation(volume, values, *side_by_side) or _by_maps(volume, values) or _by_facts(volume, values)
    has_few_bright = has_noise and (found is None or found[0] == "fluorescence") and _has_few_bright(volume, values)
    kind, reason = (
        found
        or (FEW_BRIGHT if has_few_bright else None)
        or _by_microscope(volume, values, has_noise=has_noise)
        or _by_shares(volume, values)
        or _by_values(volume, values, has_noise=has_noise)
    )
    has_few_bright = has_few_bright and kind == "fluorescence"
    if (keeper := _keeper(volume)) is not None:
        keeper._kind = Found(kind, reason, has_noise, has_few_bright)
    return Evidence(kind, reason, has_noise, has_few_bright, values, gradients)


def found_in(volume: Volume | WaveletVolume) -> Found:
    """The kind of data that a volume holds, with the reason; looked for once in the same samples."""
    keeper = _keeper(volume)
    return evidence(volume) if keeper is None or keeper._kind is None else keeper._kind


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
    samples, _ = looked_at(volume)
    return _offset(volume, samples.astype(np.float64))


def _offset(volume: Volume | WaveletVolume, values: NDArray[np.float64]) -> float:
    may_be = volume.modality == "CT" or (volume.modality is None and volume.is_anatomical)
    return stored_offset(values) if may_be else 0.0


def _segmentation(
    volume: Volume | WaveletVolume, values: NDArray[np.float64], samples: NDArray[Any], neighbours: Pairs
) -> tuple[Kind, str] | None:
    n_values = np.unique(values).size
    if n_values <= 2 and not _has_others(volume, values):
        return "mask", f"a mask: it has but {'two values' if n_values == 2 else 'one value, or none'}"
    samples, neighbours = without_missing(samples, neighbours)
    is_whole = bool(np.all(values == np.round(values)))
    if volume.modality == "SEG" and is_whole:
        return "labels", "labels: the file says SEG"
    if volume.modality == "SEG":
        return "probability", "probabilities: the file says SEG, and has values between whole numbers"
    if not is_whole or values.min() < 0 or n_values > MAX_LABELS or _is_measured(volume):
        return None
    alike = _share_alike(samples, neighbours)
    if alike < MIN_ALIKE_OF_FEW:  # nearly all scans, of which nothing else is counted
        return None
    is_few = n_values <= FEW_LABELS and _has_steps(samples, neighbours)
    seem_labels = alike >= MIN_ALIKE or is_few or _share_of_others(samples, neighbours) <= MAX_OTHERS
    if seem_labels and _is_whole(volume):
        return "labels", "labels: whole numbers that are the same from sample to sample, by the values"
    return None


def _is_measured(volume: Volume | WaveletVolume) -> bool:
    """Whether the file gives values a unit, as simulations do: numbers of labels have none.

    Exported as DICOM of a scan, label maps say CT and HU, so the modality decides nothing.
    """
    return volume.modality is None and volume.value_unit not in (None, *UNITS_OF_LABELS)


def _is_whole(volume: Volume | WaveletVolume) -> bool:
    """Whether floating-point numbers in memory are all whole, also those that samples spread over them missed."""
    if not isinstance(volume, Volume) or isinstance(volume, LazyVolume) or volume.dtype.kind != "f":
        return True
    return all(bool(np.array_equal(plane, np.rint(plane), equal_nan=True)) for plane in volume.samples)


def _has_others(volume: Volume | WaveletVolume, values: NDArray[np.float64]) -> bool:
    """Whether a volume has more than two values, although the samples that decide the kind have only two."""
    low, high = volume.value_range
    if any(value != np.round(value) and value not in values for value in (low, high)):
        return True
    more = subsampled(volume)
    return bool(np.any(np.isfinite(more) & (more != low) & (more != high)))


def _has_few_bright(volume: Volume | WaveletVolume, values: NDArray[np.float64]) -> bool:
    """Whether nearly all samples are noise that is as wide below its median as above it, and a few are far above.

    A few that lie alone are hot pixels of a camera, not beads. `values` show the noise; the few need more
    samples.
    """
    if volume.is_anatomical and not (_is_fine(volume) or is_placed_by_default(volume)):
        return False
    low, middle, high = np.percentile(values, (10.0, 50.0, 90.0))
    lower, upper = middle - low, high - middle
    deviation = 1.4826 * float(np.median(np.abs(values - middle)))
    if not (deviation > 0 and MIN_EVEN * lower <= upper <= lower / MIN_EVEN):
        return False
    samples = subsampled(volume)
    above = samples > middle + FAR * deviation
    n_far, n_below = np.count_nonzero(above), np.count_nonzero(samples < middle - FAR * deviation)
    if not n_below < n_far <= MAX_FAR * samples.size:
        return False
    n_together = sum(
        np.count_nonzero(np.logical_and(*(np.delete(above, end, axis) for end in (0, -1)))) for axis in range(3)
    )
    return bool(n_together >= MIN_TOGETHER)


def _by_maps(volume: Volume | WaveletVolume, values: NDArray[np.float64]) -> tuple[Kind, str] | None:
    """Maps that were calculated from a patient's scan; lengths of vectors have names of what the vectors are."""
    return None if LENGTH in volume.facts.processing else map_kind(volume, values)


def _by_facts(volume: Volume | WaveletVolume, values: NDArray[np.float64]) -> tuple[Kind, str] | None:
    modality = volume.modality
    if modality in (None, "CT") and looks_like_hounsfield(values, volume):
        prefix = "the file says CT, and " if modality == "CT" else ""
        return "CT", f"CT in Hounsfield units: {prefix}the values have air and soft tissue"
    if offset := _offset(volume, values):
        prefix = "the file says CT, and " if modality == "CT" else ""
        return (
            "CT",
            f"CT in Hounsfield units with {offset:g} added: {prefix}air, fat and soft tissue, by the values",
        )
    if modality in MODALITIES:
        kind = MODALITIES[modality]
        return kind, f"{'dose map' if kind == 'dose' else kind}: the file says {modality}"
    return None


def _by_microscope(
    volume: Volume | WaveletVolume, values: NDArray[np.float64], *, has_noise: bool
) -> tuple[Kind, str] | None:
    """The kind of an image whose file names channels of a microscope; the unit of length alone is no evidence."""
    if volume.facts.channel is None or (volume.is_anatomical and not _is_fine(volume)):
        return None
    # Fluorescence is dark with a bright tail; stained tissue in an electron microscope fills the picture.
    if not _is_dense(values):
        return "fluorescence", "fluorescence: the file names channels, and mostly dark, by the values"
    return ("EM", DENSE) if has_noise else None


def _by_shares(volume: Volume | WaveletVolume, values: NDArray[np.float64]) -> tuple[Kind, str] | None:
    """Shares of a patient's scan; lengths of vectors can lie between 0 and 1 too."""
    if not volume.is_anatomical or LENGTH in volume.facts.processing:
        return None
    return share_kind(volume, values)


def _by_values(volume: Volume | WaveletVolume, values: NDArray[np.float64], *, has_noise: bool) -> tuple[Kind, str]:
    numbers = numbers_of(volume)
    is_of_patient = volume.is_anatomical and not _is_fine(volume) and (has_noise or not is_placed_by_default(volume))
    is_of_patient = is_of_patient and not is_of_no_patient(volume, values)
    has_two_signs = _has_two_signs(values, numbers, is_of_patient=is_of_patient, has_noise=has_noise)
    if has_two_signs and not _is_rounding(volume):
        return "signed field", "a field with two signs, by the values"
    if LENGTH in volume.facts.processing:
        return "field", "a field: the lengths of vectors"
    if is_of_patient:
        return _of_patient(volume, values, numbers)
    if numbers == "f":
        return "field", "a field of floating-point numbers"
    if not has_noise:
        return "field", "a field of whole numbers without noise, by the values"
    of_matter = _without_padding(values)
    if _is_dense(of_matter):
        return "EM", DENSE
    if _glows(of_matter):
        return "fluorescence", "fluorescence: noise, and a few samples far brighter than the rest, by the values"
    return "scan", "a scan of no fixed scale"


def _of_patient(volume: Volume | WaveletVolume, values: NDArray[np.float64], numbers: str) -> tuple[Kind, str]:
    air = _air_of_normalised(values) if numbers == "f" else None
    if numbers == "u" or (values.min() < 0 and air is None):
        return "scan", "a scan of no fixed scale"
    if min(volume.spacing) >= PET_SPACING_MM and _tail(values - (air or 0.0)) >= PET_TAIL:
        return "PET", "PET: coarse samples and a few very bright spots, by the values"
    if air is not None:
        return "MR", "MR, or another scan of a patient, normalised: its air has a negative value, by the values"
    return "MR", "MR, or another scan of a patient without a fixed scale, by the values"


def _air_of_normalised(values: NDArray[np.float64]) -> float | None:
    """The negative value of air in a scan whose mean was subtracted, or that was scaled: commonest, and nearly least.

    None where the commonest value is not that: differences and statistics of two signs are commonest at 0.
    """
    low, high = robust_range_of(values)
    counts, edges = np.histogram(values, bins=N_AIR_BINS, range=(low, high)) if low < high else ([0], [0.0, 0.0])
    place = int(np.argmax(counts))
    air = 0.5 * float(edges[place] + edges[place + 1])
    return air if air < 0 and place < MAX_AIR_PLACE * N_AIR_BINS else None


def _has_two_signs(values: NDArray[np.float64], numbers: str, *, is_of_patient: bool, has_noise: bool) -> bool:
    """Whether values go to both sides of 0, neither by the noise of a background nor by an offset."""
    if numbers not in "fi" or (numbers == "i" and is_of_patient) or fill_of(values) is not None:
        return False
    if is_of_patient and _air_of_normalised(values) is not None:
        return False
    low, high = np.percentile(values, TAILS) if has_noise else (values.min(), values.max())
    least = MIN_TAIL if numbers == "f" else MIN_WHOLE_TAIL
    return bool(low < 0 < high and min(-low, high) >= least * max(-low, high))


def _is_rounding(volume: Volume | WaveletVolume) -> bool:
    """Whether one sign is so small beside the other that it is rounding; peaks of single samples count too."""
    ends = -volume.value_range[0], volume.value_range[1]
    return min(ends) < MIN_END * max(ends)


def _is_dense(values: NDArray[np.float64]) -> bool:
    low, middle, high = np.percentile(values, (1.0, 50.0, 99.0))
    return bool(middle > low + MIN_BRIGHT * (high - low))


def _is_fine(volume: Volume | WaveletVolume) -> bool:
    """Whether samples are as close together as a microscope's, whatever unit the file has."""
    metres = units.metres(volume.unit)
    return metres is not None and min(volume.spacing) * metres < FINE_METRES


def _without_padding(values: NDArray[np.float64]) -> NDArray[np.float64]:
    """The values without a frame around the image: many of exactly the least value, far from all others."""
    least = values.min()
    others = values[values > least]
    if not others.size or values.size - others.size < MIN_FILL * values.size:
        return values
    return others if others.min() - least >= MIN_GAP * (np.median(others) - least) else values


def _glows(values: NDArray[np.float64]) -> bool:
    """Whether values are those of light that few structures give off: a noisy background and a long bright tail."""
    _, counts = np.unique(values, return_counts=True)
    low, high = robust_range_of(values)
    if not low < high or counts.max() > MAX_EQUAL * values.size:
        return False
    inside = values[values > otsu(values, low, high)]
    background = float(np.median(values))
    return bool(inside.size and high - background > MIN_GLOW * max(float(np.median(inside)) - background, 1e-12))


def _tail(values: NDArray[np.float64]) -> float:
    """How far the brightest values reach; a ratio, from which exposure and gain cancel."""
    upper, top = np.percentile(values, (90.0, 99.9))
    return float(top / upper) if upper > 0 else math.inf


def _has_steps(samples: NDArray[Any], neighbours: Pairs) -> bool:
    """Whether neighbours with other values often differ by more than 1, or too few are known to decide."""
    if np.unique(samples).size < 4:
        return True
    if not neighbours:
        return True
    own = samples.astype(np.float64)
    steps = np.concatenate([np.abs(side.astype(np.float64) - own) for pair in neighbours for side in pair])
    steps = steps[steps > 0]
    return bool(steps.size == 0 or np.mean(steps <= 1) < MAX_GENTLE)


def _share_of_others(samples: NDArray[Any], neighbours: Pairs) -> float:
    """Share of the neighbours with neither the sample's value nor the commonest one; samples of that are left out."""
    found, counts = np.unique(samples, return_counts=True)
    commonest = found[counts.argmax()]
    is_inside = samples != commonest
    if not neighbours or not is_inside.any():
        return 1.0
    own = samples[is_inside]
    sides = [side[is_inside] for pair in neighbours for side in pair]
    return float(np.mean([np.mean((side != own) & (side != commonest)) for side in sides]))


def _share_alike(samples: NDArray[Any], neighbours: Pairs) -> float:
    """Share of the samples, the commonest value left out, that lie in regions of one value; mean over the axes.

    A sample counts where both neighbours along an axis equal it: it is inside. Small cells are mostly border, so one
    with an equal neighbour on one side counts too, by half where the other one has the commonest value, as around
    cells, and by half where it is further than 1 away: pictures with few grey levels have steps of 1 between them.
    """
    if not neighbours or not samples.size:
        return 0.0
    found, counts = np.unique(samples, return_counts=True)
    commonest = found[counts.argmax()]
    is_inside = samples != commonest
    if not is_inside.any():
        return 0.0
    own = samples[is_inside]

    def weight(equal: NDArray[np.bool_], other: NDArray[Any]) -> NDArray[np.float64]:
        """Weight of samples with a neighbour that is equal, and another one."""
        is_far = np.maximum(other, own) - np.minimum(other, own) > 1  # types without a sign do not wrap so
        border = 0.5 * (other == commonest) + 0.5 * is_far
        weights: NDArray[np.float64] = np.where(equal, np.where(other == own, 1.0, border), 0.0)
        return weights

    shares = []
    for pair in neighbours:
        before, after = (side[is_inside] for side in pair)
        shares.append(np.mean(np.maximum(weight(before == own, after), weight(after == own, before))))
    return float(np.mean(shares))
