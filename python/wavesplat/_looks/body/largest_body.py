"""The largest body of a scan, without the table that it lies on, the headrest, cables and blankets.

1. What is denser than a threshold is matter: half-way from air to soft tissue, or Otsu's threshold.
2. Opening (erosion, then as much dilation, by a ball) removes what is thin, such as the shells of a table that touches
   the back; the largest connected part is the body, and others nearly as large belong to it (legs). Where opening
   leaves little of the body, its walls are as thin as a table's (a phantom), and nothing is cut off.
3. What opening took from the body comes back where it is small, such as ears and fingers: a table is large.
4. A little air around it is kept, so that the skin is, and the slices are filled: lungs and bowel gas stay as they are.

All of it at a resolution of about 3 mm; only the last step touches the samples.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wavesplat._looks.body.table import empty_at, nearest_places
from wavesplat._looks.kinds.histogram import finite_samples, is_hounsfield, otsu, robust_range
from wavesplat._model.arguments.types import takes_its_types
from wavesplat._model.volume import units
from wavesplat._model.volume.sources import then
from wavesplat._model.volume.volume import Volume
from wavesplat._model.volume.volume_like import VolumeLike, as_volume
from wavesplat._public import public
from wavesplat._system.libraries import library
from wavesplat._system.values import number
from wavesplat.errors import ArgumentError

#: Hounsfield units: fat is at -100, foam of mattresses below -850.
TISSUE_HU = -400.0
#: Radius of the opening, millimetres: twice that is thicker than the shells of tables.
OPENING_MM = 4.0
#: Radius of the opening in samples, where lengths have no known unit.
OPENING_SAMPLES = 2.0
#: Distance of the samples that are looked at, millimetres, and largest number of them.
COARSE_MM = 3.0
N_SAMPLES_MAX = 4_000_000
#: Shares of the largest part from which another belongs to the body, and below which a part that was cut off is no
#: table.
MIN_PART, LARGEST_BIT = 0.2, 0.002
#: Least share of a body and what it encloses that opening leaves; where less is left, it cut off walls of the body.
#: Hounsfield units show fat as well, so there walls are thick, and it may have been a large table.
MIN_LEFT, MIN_LEFT_HU = 0.7, 0.5


@public
@takes_its_types
def largest_body(volume: VolumeLike, threshold: float | None = None, *, opening: float | None = None) -> Volume:
    """The volume with all but its largest body emptied: a patient without table and headrest.

    Parameters
    ----------
    volume : Volume, array, or what else `Volume` takes
        A CT scan, or another in which air is darker than the body.
    threshold : float, optional
        Values above it are matter. None is -400 for values that look like Hounsfield units, else Otsu's threshold.
    opening : float, optional
        Radius, world units: what is thinner than twice that and large is cut off the body, such as a table that touches
        it; 0 cuts nothing off. None is 4 mm, or 2 samples where the unit of lengths is not known.

    Returns
    -------
    Volume
        Type, shape, place and name are the same. Samples outside of the body have the volume's smallest value; samples
        inside, air in lungs and bowels included, are as they were. `facts.processing` records it.

    Raises
    ------
    ArgumentError
        If the volume has no samples (wavelets), nothing is above the threshold, or a number cannot be.
    LibraryError
        If SciPy is not installed (`pip install "wavesplat[body]"`).

    Examples
    --------
    >>> import wavesplat as ws
    >>> pelvis = ws.largest_body(ws.examples.ct_pelvis())
    >>> pelvis.facts.processing
    ('all but the largest body emptied: above -400, opened by 4 mm',)
    """
    volume = as_volume(volume)
    if not isinstance(volume, Volume):
        raise ArgumentError(
            f"the volume is a {type(volume).__name__}; give a wavesplat.Volume, such as its to_volume()"
        )
    by_hounsfield = is_hounsfield(volume)
    least = _threshold(volume, by_hounsfield) if threshold is None else float(threshold)
    millimetre = _millimetre(volume, by_hounsfield)
    if opening is not None:
        opening = number(opening, "opening", "a radius of 0 or more", least=0)
    radius = _radius(volume, millimetre) if opening is None else opening
    steps = _steps(volume, millimetre)
    coarse = volume.samples[tuple(slice(None, None, step) for step in steps)]
    matter = coarse > least
    if not matter.any():
        low, high = volume.value_range
        raise ArgumentError(f"nothing in volume {volume.name!r} is above {least:g}; its values are {low:g} to {high:g}")
    distances = tuple(d * step for d, step in zip(reversed(volume.spacing), steps, strict=True))
    across = int(np.abs(volume.world_from_index[2, :3]).argmax())
    least_left = MIN_LEFT_HU if by_hounsfield else MIN_LEFT
    kept = _Morphology(distances, axis=2 - across).body(matter, radius, least_left)
    samples = _emptied(volume, kept, steps)
    done = f"all but the largest body emptied: above {least:g}, opened by {radius:g} {volume.unit or 'world units'}"
    options = {"threshold": threshold, "opening": opening}
    given = {name: float(value) for name, value in options.items() if value is not None}
    source = then(volume._source, "largest_body", **given)
    return volume._processed(samples, done, source)


def _threshold(volume: Volume, by_hounsfield: bool) -> float:
    return TISSUE_HU if by_hounsfield else otsu(finite_samples(volume), *robust_range(volume))


def _millimetre(volume: Volume, by_hounsfield: bool) -> float:
    """A millimetre in world units; NaN if the unit is unknown. CT without a unit is in millimetres."""
    size = units.metres(volume.unit)
    if size is None:
        return 1.0 if by_hounsfield else math.nan
    return units.MILLIMETRE / size


def _radius(volume: Volume, millimetre: float) -> float:
    return OPENING_SAMPLES * max(volume.spacing) if math.isnan(millimetre) else OPENING_MM * millimetre


def _steps(volume: Volume, millimetre: float) -> tuple[int, int, int]:
    """Steps between the samples that are looked at, along (z, y, x)."""
    n = (volume.samples.size / N_SAMPLES_MAX) ** (1 / 3)
    apart = 0.0 if math.isnan(millimetre) else COARSE_MM * millimetre
    z, y, x = (max(1, math.floor(apart / spacing), math.ceil(n)) for spacing in reversed(volume.spacing))
    return z, y, x


def _emptied(volume: Volume, kept: NDArray[np.bool_], steps: tuple[int, int, int]) -> NDArray[Any]:
    samples = volume.samples.copy()
    places = [nearest_places(*sizes) for sizes in zip(volume.shape, steps, kept.shape, strict=True)]
    empty_at(samples, ~kept, places, samples.dtype.type(volume.value_range[0]))
    return samples


class _Morphology:
    """Morphology of shapes [z, y, x] whose samples are `distances` apart; slices lie across `axis`."""

    def __init__(self, distances: tuple[float, ...], axis: int) -> None:
        self.ndimage = library("scipy.ndimage", extra="body")
        self.distances = distances
        self.axis = axis

    def body(self, matter: NDArray[np.bool_], radius: float, least_left: float) -> NDArray[np.bool_]:
        """The largest body, with a rim of air."""
        body = self.largest(self.opened(matter, radius))
        whole = self.touched(matter, body)
        if self.filled(body).sum() < least_left * self.filled(whole if body.any() else matter).sum():
            body = whole = self.largest(matter)
        bits = whole & ~self.rimmed(body)
        labels, n = self.ndimage.label(bits, np.ones((3, 3, 3)))
        if n:
            sizes = np.bincount(labels.ravel())
            is_small = sizes < LARGEST_BIT * body.sum()
            is_small[0] = False
            body = body | is_small[labels]
        return self.filled(self.rimmed(body))

    def touched(self, shape: NDArray[np.bool_], body: NDArray[np.bool_]) -> NDArray[np.bool_]:
        """The connected parts that meet the body."""
        labels, n = self.ndimage.label(shape)
        touches = np.zeros(n + 1, dtype=bool)
        touches[labels[body]] = True
        touches[0] = False
        return np.asarray(touches[labels])

    def largest(self, shape: NDArray[np.bool_]) -> NDArray[np.bool_]:
        """The largest connected part, and those nearly as large."""
        labels, n = self.ndimage.label(shape)
        if n < 2:
            return shape.copy()
        sizes = np.bincount(labels.ravel())
        sizes[0] = 0
        belongs = sizes >= MIN_PART * sizes.max()
        return np.asarray(belongs[labels])

    def opened(self, shape: NDArray[np.bool_], radius: float) -> NDArray[np.bool_]:
        """The shape without the parts that a ball does not fit into; the volume's faces are no surfaces of a body."""
        if radius == 0 or shape.all():
            return shape
        core = self.ndimage.distance_transform_edt(shape, sampling=self.distances) > radius
        return self.grown(core, radius) & shape

    def grown(self, shape: NDArray[np.bool_], distance: float) -> NDArray[np.bool_]:
        """The shape with all samples within a distance of it."""
        if not shape.any():
            return shape
        return np.asarray(self.ndimage.distance_transform_edt(~shape, sampling=self.distances) <= distance)

    def rimmed(self, shape: NDArray[np.bool_]) -> NDArray[np.bool_]:
        """The shape with the samples around it."""
        return np.asarray(self.ndimage.binary_dilation(shape, self.ndimage.generate_binary_structure(3, 2)))

    def filled(self, shape: NDArray[np.bool_]) -> NDArray[np.bool_]:
        """The shape with holes of its slices filled, also those between two of its parts and the edge of the volume."""
        out = shape.copy()
        for plane in np.moveaxis(out, self.axis, 0):
            if not plane.any():
                continue
            framed = np.pad(plane, 1)
            for edge, seen in ((0, 1), (-1, -2)):
                for across in (framed, framed.T):
                    places = np.flatnonzero(across[seen])
                    if places.size:
                        across[edge, places[0] : places[-1] + 1] = True
            plane[...] = self.ndimage.binary_fill_holes(framed)[1:-1, 1:-1]
        return out
