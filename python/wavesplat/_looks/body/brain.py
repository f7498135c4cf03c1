"""The brain of a head in MR, separated from skull and skin by thresholds and shapes; simple, and not for measuring.

In T1-weighted scans, and FLAIR, the skull and the fluid around the brain are dark. So, at a resolution of about 2 mm:

1. What is brighter than a tenth of the range is the head; its brightness is evened out, by division by its mean within
   some centimetres, since coils see what is near to them better.
2. What is brighter than half of the middle of the head is tissue. Erosion by a ball cuts the bridges from the brain to
   the rest, and the connected part in the middle is the brain; the smallest ball is taken after which none of it
   reaches the skin, and it is as large as a brain.
3. Dilation gives back what erosion took, and closing bridges the sulci.

What is drawn of the samples inside is decided by the look: gyri show, since the fluid between them is dark. It is like
the first steps of BET (Smith 2002), whose surface model it lacks.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from wavesplat._model.lazy.volume import LazyVolume
from wavesplat._model.volume.volume import Volume
from wavesplat._model.volume.wavelet_volume import WaveletVolume

if TYPE_CHECKING:
    import SimpleITK

#: Text in `Facts.processing` of a volume of which the brain is drawn.
PROCESSING = "all but the brain left out of the picture: a simple extraction, not for measuring"

#: Distance of the places that are looked at, mm.
PLACE_MM = 2.0
#: Share of the range above which the head is, and percentiles of that range.
HEAD_SHARE, RANGE = 0.1, (2.0, 98.0)
#: Deviation of the Gaussian that evens brightness out, mm.
EVEN_MM = 25.0
#: Heights below the vertex: of the part in whose middle the brain is, and of all of the brain; mm.
UPPER_MM, BRAIN_MM = 130.0, 165.0
#: Radius of the ball in the middle that is brain, mm.
MIDDLE_MM = 35.0
#: Least brightness of tissue, shares of the median in the middle, and radii of erosion, mm, in the order of trials.
TISSUE = (0.5, 0.6)
RADII_MM = (2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0)
#: Radius of the closing that bridges sulci, and of the one that closes nose and ears, mm.
SULCI_MM, HEAD_MM = 10.0, 10.0
#: Depth below the skin at which no brain is, mm, and the share of places there that may be taken for it.
SKIN_MM, MAX_IN_SKIN = 5.0, 0.005
#: Volume of a brain, and of the smallest head with its skull, ml.
BRAIN_ML, HEAD_ML = (600.0, 1800.0), 2100.0
#: Distance from the brain's surface up to which samples are drawn, mm.
RIM_MM = 1.5

Mask = NDArray[np.bool_]
Floats = NDArray[np.float32]


def brain_of(volume: Volume | WaveletVolume) -> Volume | str:
    """A copy of a head's scan with its least value outside of the brain, or why there is none.

    A head that is no larger than a brain is taken for one without its skull, and given as it is. What is found is kept
    with the volume.
    """
    if not isinstance(volume, Volume) or isinstance(volume, LazyVolume):
        return "it needs all samples in memory"
    if "brain" not in volume._parts:
        volume._parts["brain"] = _found(volume)
    # Empty: all of it.
    return volume._parts["brain"] or volume


def _found(volume: Volume) -> Volume | str:
    """The brain, or why there is none; empty where it is all of the volume."""
    if not (volume.is_anatomical and volume.unit == "mm"):
        return "the file names no patient's axes in millimetres"
    if volume.modality not in (None, "MR"):
        return f"the file says {volume.modality}, and it is for MR"
    places, spacing = _places(volume)
    if min(places.shape) < 12:
        return f"the scan has few slices, {min(volume.shape)}"
    found = _brain(places, spacing, _heights(volume, places.shape, spacing))
    if found is None or isinstance(found, str):
        return found or ""
    samples = volume.samples.copy()
    samples[_at_samples(_distances(found, spacing), spacing, volume) <= -RIM_MM] = volume.value_range[0]
    return volume._processed(samples, PROCESSING, volume._source)


def _places(volume: Volume) -> tuple[Floats, list[float]]:
    """Means of the samples at places about 2 mm apart, and the distances of these places, as (z, y, x)."""
    distances = list(reversed(volume.spacing))
    steps = [max(1, int(PLACE_MM / d + 0.25)) for d in distances]
    whole = volume.samples[tuple(slice(n // k * k) for n, k in zip(volume.shape, steps, strict=True))]
    sizes = [size for n, k in zip(whole.shape, steps, strict=True) for size in (n // k, k)]
    means = np.nan_to_num(whole.astype(np.float32).reshape(sizes)).mean(axis=(1, 3, 5))
    return means, [d * k for d, k in zip(distances, steps, strict=True)]


def _heights(volume: Volume, shape: tuple[int, ...], spacing: list[float]) -> Floats:
    """Heights of the places along the patient's axis, mm."""
    up = volume.world_from_index[2, :3] / volume.spacing
    z, y, x = (
        (np.arange(n, dtype=np.float32) * d * share)
        for n, d, share in zip(shape, spacing, reversed(up.astype(np.float32)), strict=True)
    )
    heights: Floats = z[:, None, None] + y[:, None] + x
    return heights


def _brain(places: Floats, spacing: list[float], heights: Floats) -> Mask | str | None:
    """The brain without its sulci, or why none is found; None where there is no skull around it."""
    low, high = np.percentile(places, RANGE)
    head = places > low + HEAD_SHARE * (high - low)
    whole = _largest(head, head)
    if whole is None:
        return "the values are nearly all alike"
    head = whole
    below = np.percentile(heights[head], 99.9) - heights
    ml = float(np.prod(spacing)) / 1000
    upper = head & (below < UPPER_MM)
    if np.count_nonzero(head & (below < BRAIN_MM)) * ml < HEAD_ML:
        return None
    middle = [float((at * d).mean()) for at, d in zip(np.nonzero(upper), spacing, strict=True)]
    z, y, x = (
        (np.arange(n, dtype=np.float32) * d - c) ** 2 for n, d, c in zip(places.shape, spacing, middle, strict=True)
    )
    near = head & (z[:, None, None] + y[:, None] + x < MIDDLE_MM**2)
    if not near.any():
        return "the middle of the head is dark"
    even = _evened(np.maximum(places - low, 0.0), head, spacing)
    skin = _depths(head, spacing) < SKIN_MM
    for share in TISSUE:
        tissue = (even > share * np.median(even[near])) & (below < BRAIN_MM)
        inside = _distances(tissue, spacing)
        for radius in RADII_MM:
            core = _largest(inside > radius, near)
            if core is None:
                break
            # Surfaces run through places, of which erosion and closing take up to one more than their radii.
            back = radius + PLACE_MM
            brain = _distances(_distances(core, spacing) >= -(SULCI_MM + back), spacing) >= SULCI_MM
            n = np.count_nonzero(brain)
            if BRAIN_ML[0] <= n * ml <= BRAIN_ML[1] and np.count_nonzero(brain & skin) <= MAX_IN_SKIN * n:
                return brain
    return "no part of the size of a brain is apart from the skin; it is for T1-weighted scans, and FLAIR"


def _evened(values: Floats, head: Mask, spacing: list[float]) -> Floats:
    """The values as shares of the mean of the head around them; 0 outside of it."""
    weights = head.astype(np.float32)
    mean = _blurred(values * weights, spacing) / np.maximum(_blurred(weights, spacing), 0.05)
    return np.where(head, values / np.maximum(mean, 1e-6 * float(values.max()) + 1e-30), 0).astype(np.float32)


def _depths(head: Mask, spacing: list[float]) -> Floats:
    """Depths below the surface of the head, its nose, ears and mouth closed, mm."""
    n = [int(HEAD_MM / d) + 2 for d in spacing]
    around = _distances(np.pad(head, [(k, k) for k in n]), spacing) >= -HEAD_MM
    closed = _distances(around, spacing) > HEAD_MM
    closed = closed[tuple(slice(k, -k) for k in n)] | head
    return _distances(_filled(closed), spacing)


def _image(array: NDArray[Any], spacing: list[float]) -> SimpleITK.Image:
    import SimpleITK as sitk  # noqa: N813 - its own short name

    image = sitk.GetImageFromArray(array)
    image.SetSpacing([float(d) for d in reversed(spacing)])
    return image


def _distances(mask: Mask, spacing: list[float]) -> Floats:
    """Distances to the mask's surface, mm: above 0 inside of it."""
    import SimpleITK as sitk  # noqa: N813 - its own short name

    image = _image(mask.astype(np.uint8), spacing)
    found = sitk.SignedMaurerDistanceMap(image, insideIsPositive=True, squaredDistance=False, useImageSpacing=True)
    distances: Floats = sitk.GetArrayFromImage(found)
    return distances


def _blurred(values: Floats, spacing: list[float]) -> Floats:
    import SimpleITK as sitk  # noqa: N813 - its own short name

    blurred: Floats = sitk.GetArrayFromImage(sitk.SmoothingRecursiveGaussian(_image(values, spacing), EVEN_MM))
    return blurred


def _largest(mask: Mask, near: Mask) -> Mask | None:
    """The connected part with most places in `near`; None where none is there."""
    import SimpleITK as sitk  # noqa: N813 - its own short name

    parts = sitk.GetArrayFromImage(sitk.ConnectedComponent(sitk.GetImageFromArray(mask.astype(np.uint8)), False))
    sizes = np.bincount(parts[near], minlength=1)
    sizes[0] = 0
    return np.asarray(parts == sizes.argmax()) if sizes.any() else None


def _filled(mask: Mask) -> Mask:
    """The mask with what it encloses."""
    import SimpleITK as sitk  # noqa: N813 - its own short name

    return np.asarray(sitk.GetArrayFromImage(sitk.BinaryFillhole(sitk.GetImageFromArray(mask.astype(np.uint8)))) > 0)


def _at_samples(distances: Floats, spacing: list[float], volume: Volume) -> Floats:
    """Distances at places, interpolated at the samples of the volume."""
    import SimpleITK as sitk  # noqa: N813 - its own short name

    own = list(reversed(volume.spacing))
    image = _image(distances, spacing)
    # A place lies in the middle of its samples.
    image.SetOrigin([0.5 * (d - step) for d, step in zip(reversed(spacing), reversed(own), strict=True)])
    reference = sitk.Image([int(n) for n in reversed(volume.shape)], sitk.sitkUInt8)
    reference.SetSpacing([float(d) for d in reversed(own)])
    far = float(distances.min())
    found: Floats = sitk.GetArrayFromImage(sitk.Resample(image, reference, sitk.Transform(), sitk.sitkLinear, far))
    return found
