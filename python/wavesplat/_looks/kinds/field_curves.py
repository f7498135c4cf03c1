"""Curves of fields: values, opacities, which end of the values is shown; and the opacity of a voxel.

What few samples have is seen, and most of the box is clear: a field fills its box, and the box would be a wall. Where
samples are missing, the rest is an object, whose shape is seen: more of it is seen, and none of it is clear.
Values stand in a logarithm where a few are far larger than the others. Of a field whose values reach much further down
than up the low ones are seen; of one with two signs, both ends are.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from wavesplat import _native

if TYPE_CHECKING:
    from wavesplat._model.volume.grid import Grid

# Opacity of a voxel in looks that are chosen for a volume; `crates/look` decides (`voxels.rs`).

#: Opacity of one voxel, of which some together have an opacity.
opacity_of_voxel = _native.opacity_of_voxel


def opaque_after(grid: Grid) -> float:
    """Number of voxels of the largest values that are opaque together: three, or as many as a thinner box has."""
    n_z, n_y, n_x = grid.shape
    return _native.opaque_after((n_x, n_y, n_z), grid.spacing)


def rising(places: NDArray[np.float64], n_voxels: float) -> NDArray[np.float64]:
    """Opacity of a voxel at places in a window, 0..1: extinction rises with the square of the place.

    n_voxels : voxels at place 1 that are opaque together.
    """
    return np.array(_native.rising(places.tolist(), n_voxels))


# Curves of fields: values, opacities, and which end of the values is shown.

Array = NDArray[np.float64]

#: Voxels of a field that are opaque together, as a multiple of those of a channel: a field fills its box. With
#: two signs fewer voxels have the values of an end.
FIELD_DEPTH, SIGNED_DEPTH = 3.0, 1.5
#: Share of the samples that is seen of a field, and of one with two signs of each sign.
SEEN, SEEN_SIGNED = 0.3, 0.2
#: Heavy tails: least ratio of the 99.9th percentile to the median; of magnitudes with a sign, of the 99.5th to the
#: 95th. (Normal noise: 1.4; its exponential: 3; the exponential of twice its size: 6; Cauchy's distribution: 10.)
HEAVY, HEAVY_SIGNED = 8.0, 5.0
#: Decades of a logarithmic scale, at most; share of values below 0, at most, which solvers leave of densities; and the
#: largest byte, since bytes were scaled by somebody who saw them.
MAX_DECADES, MAX_NEGATIVE, MAX_BYTE = 6.0, 0.02, 255
#: Nodes of colours, and of those with two signs, which are even on both sides of 0.
N_NODES, N_SIGNED = 17, 33
#: Low values stand out: least ratio of the lower part of the range to the upper one. A background in the middle: the
#: largest share of the range that half of the samples have.
MIN_LOW, MAX_INNER = 3.0, 0.1
#: A phase of one value at the range's end: the least ratio of its values to the end, either way, and its least part
#: of the samples beyond half of the end. (Drops with soft borders: 0.64 to 0.7; tails of exponentials of normal noise,
#: and a Gaussian blob: 0.24 to 0.28.)
PLATEAU, MIN_PHASE = 0.8, 0.5
#: Place up to which a field is clear at most: what begins beyond it is a phase, and is seen from half way to it.
MAX_CLEAR = 0.9
#: A background of about one value: the largest distance of values that are the same, as a share of the range, and the
#: largest share of the other samples.
SAME_VALUE, MAX_MATTER = 0.01, 0.1
#: Least place of what is seen beyond 0, and beyond a background in the middle, as a share of the way to the end.
MIN_SIGNED = 0.12


@dataclass(frozen=True)
class Curves:
    """Growing values with the opacity of a voxel at each, and their places in a colour map, 0..1.

    shows_low : whether the low values are those that are seen, so that the map's bright end is theirs.
    """

    values: Array
    opacity: Array
    places: Array
    shows_low: bool = False


@dataclass(frozen=True)
class Part:
    """The part of a volume's box that has samples.

    share : of the box. veil : least opacity of a voxel of it.
    """

    share: float = 1.0
    veil: float = 0.0

    def seen(self, share: float) -> float:
        """The share of the samples that is seen where a share of the box is."""
        return min(1.0, share / self.share)


WHOLE = Part()


def of_field(samples: Array, n_voxels: float, part: Part = WHOLE) -> Curves:
    """Curves of a field of one sign: the end that fewer samples have is opaque.

    samples : finite samples, any number. n_voxels : voxels of light that are opaque together. part : of the box.
    """
    middle = float(np.median(samples))
    places = np.linspace(0.0, 1.0, N_NODES)
    values = _values_at(places, samples, middle)
    below, above = middle - values[0], values[-1] - middle
    inner = float(np.ptp(np.percentile(samples, (25.0, 75.0))))
    shows_low = bool(below > MIN_LOW * above)
    # A background in the middle, such as a pressure's: both what is below it and what is above it is seen.
    shows_both = inner < MAX_INNER * (below + above) and MIN_LOW * min(below, above) > max(below, above)
    share = 100.0 * part.seen(SEEN) / (2 if shows_both else 1)
    opacity = np.zeros(N_NODES)
    for is_shown, risen, few in ((shows_low, 1.0 - places, share), (not shows_low, places, 100.0 - share)):
        if is_shown or shows_both:
            clear, background = (float(np.interp(v, values, risen)) for v in (np.percentile(samples, few), middle))
            if clear > MAX_CLEAR:
                clear = 0.5
            if shows_both:
                clear = max(clear, background + MIN_SIGNED * (1.0 - background))
            opacity += rising(_beyond(risen, clear), FIELD_DEPTH * n_voxels)
    return Curves(values, np.maximum(opacity, part.veil), places, shows_low)


def of_signed_field(samples: Array, n_voxels: float, part: Part = WHOLE) -> Curves:
    """Curves of a field with two signs, as long below 0 as above it; of each sign some is seen.

    samples : finite samples, any number. n_voxels : voxels of light that are opaque together. part : of the box.
    """
    sizes = np.abs(samples)
    limit, upper = (float(v) for v in np.percentile(sizes, (99.5, 95.0)))
    limit = limit or float(sizes.max())
    places = np.linspace(-1.0, 1.0, N_SIGNED)
    if limit > HEAVY_SIGNED * upper:
        # Linear up to the median: symmetric logarithms.
        linear = max(float(np.median(sizes[sizes > 0])), limit * 10**-MAX_DECADES)
        values = linear * np.sign(places) * np.expm1(np.abs(places) * np.log1p(limit / linear))
    else:
        values = limit * places
    opacity = np.zeros(N_SIGNED)
    for sign in (-1, 1):
        side = sign * places > 0
        ends = np.percentile(sign * samples, (100.0 * (1.0 - part.seen(SEEN_SIGNED)), 99.95))
        few, most = np.interp(ends, sign * values[side][::sign], sign * places[side][::sign]).tolist()
        # Each sign is seen to its own end, so that the weaker one is not lost beside the stronger one.
        if most > MIN_SIGNED:
            clear = min(max(MIN_SIGNED, few), 0.8 * most)
            opacity += rising(_beyond(sign * places, clear, most), SIGNED_DEPTH * n_voxels)
    return Curves(values, np.where(places == 0, 0.0, np.maximum(opacity, part.veil)), (places + 1.0) / 2.0)


def _values_at(places: Array, samples: Array, middle: float) -> Array:
    """Values at places of a window, 0..1: even ones, or even in the logarithm where a few are far larger than most."""
    high = float(np.percentile(samples, 99.9))
    least = _least_of_logarithm(samples)
    # Below a median of 0 nothing is few, and a phase of one value, such as drops in a gas, is no tail.
    if least is not None and high > HEAVY * middle and middle > 0:
        plateau = np.mean((samples > PLATEAU * high) & (samples < high / PLATEAU))
        if plateau < MIN_PHASE * np.mean(samples > 0.5 * high):
            return np.asarray(least * (high / least) ** places)
    low, upper = (float(v) for v in np.percentile(_matter(samples, middle), (1.0, 99.0)))
    low, upper = min(low, middle), max(upper, middle)
    low, upper = (low, upper) if low < upper else (float(samples.min()), float(samples.max()))
    return low + (upper - low) * places


def _matter(samples: Array, middle: float) -> Array:
    """Samples without a background of about one value, where nearly all samples are background; else all of them."""
    low, high = np.percentile(samples, (0.1, 99.9))
    others = samples[np.abs(samples - middle) > SAME_VALUE * (high - low)]
    return others if 0 < others.size < MAX_MATTER * samples.size else samples


def _beyond(places: Array, clear: float, end: float = 1.0) -> Array:
    """Shares of the way from the place up to which all is clear to that of the end, 0..1."""
    return np.asarray(np.clip((places - clear) / max(end - clear, 1e-3), 0.0, 1.0))


def _least_of_logarithm(samples: Array) -> float | None:
    """The value at which a logarithmic scale of mostly positive samples begins; None where they have none."""
    positive = samples[samples > 0]
    is_of_bytes = samples.max() <= MAX_BYTE and np.array_equal(samples, np.round(samples))
    if 2 * positive.size < samples.size or np.mean(samples < 0) > MAX_NEGATIVE or is_of_bytes:
        return None
    top = float(np.percentile(samples, 99.9))
    return max(float(np.percentile(positive, 5.0)), top * 10**-MAX_DECADES)
