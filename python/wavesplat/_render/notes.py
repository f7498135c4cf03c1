"""Notes on pictures: of one colour all over, with steps between distant slices, or with the table of a CT.

Notes are for the eye: a difference of less than a step of 8 bits does not show.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from wavesplat._looks.curves.transfer_function import TransferFunction
from wavesplat._looks.curves.transfer_function_2d import TransferFunction2D
from wavesplat._looks.kinds.histogram import is_hounsfield
from wavesplat._looks.kinds.looked_at import subsampled
from wavesplat._model.lazy.volume import LazyVolume
from wavesplat._model.volume.volume import Volume
from wavesplat._model.volume.wavelet_volume import WaveletVolume

Floats = NDArray[np.float32]

#: Least difference that shows in 8 bits.
STEP = 1 / 255
#: Least distance of slices, as a multiple of the distance of samples in them, at which surfaces have steps that show.
#: (CT at 3 times: faint; a head at 8 times: terraces.)
COARSE = 5.0
#: Beginning of the text in `Facts.processing` of a volume that is smoothed.
SMOOTHED = "smoothed by"
#: Least number of pixels of a picture with notes: smaller ones may well have one colour.
MIN_PIXELS = 64

NOTHING_SHOWS = (
    "every pixel has the same colour: the view misses the volume, is inside of it, or shows it smaller than a pixel; "
    "look at zoom, camera and crop"
)


def notes_on_picture(
    volume: Volume | WaveletVolume,
    curves: TransferFunction | TransferFunction2D,
    *,
    composite: str,
    iso_value: float | None,
    rgba: Floats,
    value: Floats | None,
) -> list[str]:
    """Why a picture of one volume shows nothing: one sentence, or none where something shows."""
    if not _has_one_color(rgba):
        return []
    low, high = volume.value_range
    if value is not None:
        return [_on_values(value, composite, low, high)]
    if composite == "first-hit" and iso_value is not None and not low <= iso_value <= high:
        return [f"there is no surface at iso value {iso_value:g}: the volume's values are {low:g} to {high:g}"]
    if composite == "over" and isinstance(curves, TransferFunction) and _is_transparent(curves, low, high):
        if low == high:
            # No look can be chosen for it by itself.
            is_clear = f"every sample of the volume is {low:g}, where the transfer function is transparent"
            return [f"{is_clear}; give a range around it (clim)"]
        where = f"over the volume's values, {low:g} to {high:g}"
        return [f"the transfer function is transparent {where}, so the picture is empty; try --preset auto"]
    return [NOTHING_SHOWS]


def notes_on_layers(rgba: Floats) -> list[str]:
    """Why a picture of several volumes shows nothing: one sentence, or none where something shows."""
    return [NOTHING_SHOWS] if _has_one_color(rgba) else []


def notes_on_slice(rgba: Floats, value: Floats, window: tuple[float, float] | None) -> list[str]:
    """Why a slice shows nothing, in one sentence or none. `window`: None where a transfer function colours."""
    if not _has_one_color(rgba):
        return []
    seen = value[np.isfinite(value)]
    if seen.size == 0:
        return ["no part of the volume lies in the picture; look at center, zoom and position"]
    least, most = float(seen.min()), float(seen.max())
    if least == most:
        return [f"every value in the picture is {least:g}"]
    where = f"the window, {window[0]:g} to {window[1]:g}" if window else "the range of the transfer function"
    return [f"the values in the picture, {least:g} to {most:g}, lie beyond {where}"]


def note_on_steps(volume: Volume | WaveletVolume) -> str | None:
    """Why surfaces of a patient's scan have steps, and what softens them; None where slices are not far apart."""
    if not volume.is_anatomical or not isinstance(volume, Volume) or isinstance(volume, LazyVolume):
        return None
    within, between = sorted(volume.spacing)[1:]
    if between < COARSE * within or any(SMOOTHED in done for done in volume.facts.processing):
        return None
    return (
        f"the slices of {volume.name!r} are {between / within:.2g} times as far apart as the samples in them, so its "
        "surfaces have steps; --smooth 1 (volume.smoothed(1)) softens them"
    )


def _on_values(value: Floats, composite: str, low: float, high: float) -> str:
    seen = value[np.isfinite(value)]
    if seen.size == 0:
        return "no ray meets the volume; look at zoom, camera and crop"
    least, most = float(seen.min()), float(seen.max())
    if low == high:
        return f"every sample of the volume is {low:g}, so the picture has one colour"
    if composite == "x-ray" and most - least < STEP:
        return f"the x-ray lets {100 * most:.3g} % of the light through everywhere; give another attenuation"
    if least == most:
        return f"the {composite} is {least:g} along every ray"
    return f"the colours do not change over what the rays show, {least:g} to {most:g}; give another transfer function"


def _has_one_color(rgba: Floats) -> bool:
    flat = rgba.reshape(-1, 4)
    if len(flat) < MIN_PIXELS:
        return False
    # A few pixels suffice for nearly all pictures that show something; the golden ratio spreads them over columns.
    few = flat[np.arange(256) * int(0.618 * len(flat)) % len(flat)]
    return all(bool((np.ptp(pixels, axis=0) < STEP).all()) for pixels in (few, flat))


def _is_transparent(curves: TransferFunction, low: float, high: float) -> bool:
    nodes = [value for value, _ in curves.opacity if low <= value <= high]
    return not curves(np.array([low, high, *nodes]))[:, 3].any()


# Whether a picture of a CT shows a table that `_looks.body.table` leaves, so that a note can name what takes it out.
#
# On a thinned copy, samples denser than air are matter. Opening by a sample (erosion, then more dilation within
# it) keeps thick matter, the body; a table, whose shells are thin, is the rest and shows. In the scans in hand that is
# 2.1 % of the body with a table, and 0.5 and 1.0 % without. It takes milliseconds, and no SciPy, which the finer
# `_looks.body.largest_body` needs: a note is no cut.

NOTE = (
    "the picture seems to show the table beside the body; --remove-table (wavesplat.largest_body) takes it out of the "
    "scan"
)

#: The same of samples that are read, or decoded, as they are drawn: no copy of them can be changed.
NOTE_ON_PARTS = (
    "the picture seems to show the table beside the body; --remove-table (wavesplat.largest_body) takes it out of a "
    "scan that is in memory: {}"
)
READ = NOTE_ON_PARTS.format("open it without memory= (--memory)")
DECODED = NOTE_ON_PARTS.format("draw the scan itself, not its wavelets")

LEFT_OUT = (
    "the table below the body is left out of the picture, and stays in the samples; --keep-table (keep_table=True) "
    "draws it"
)

#: Distance of the samples that are looked at, mm: twice that is thicker than the shells of tables.
STEP_MM = 6.0
#: Value between air and matter, Hounsfield units.
AIR_HU = -400.0
#: Least share of the body of thin matter beside it that shows.
MIN_SHARE = 0.015

Mask = NDArray[np.bool_]


def note_on_table(volume: Volume | WaveletVolume, curves: TransferFunction | TransferFunction2D) -> str | None:
    """Advice on the table that a picture shows; None where it shows none."""
    if not _shows_table(volume, curves):
        return None
    return DECODED if isinstance(volume, WaveletVolume) else READ if isinstance(volume, LazyVolume) else NOTE


def _shows_table(volume: Volume | WaveletVolume, curves: TransferFunction | TransferFunction2D) -> bool:
    """Whether a patient's CT, from which no table was taken yet, is drawn with thin matter beside the body."""
    if isinstance(curves, TransferFunction2D) or not (volume.is_anatomical and volume.unit == "mm"):
        return False
    if any("largest body" in done for done in volume.facts.processing) or not is_hounsfield(volume):
        return False
    samples = subsampled(volume) if isinstance(volume, WaveletVolume | LazyVolume) else volume.samples
    # Steps between the samples that a lazy volume keeps, and between those that are looked at of them.
    thinned_by = [-(-n // n_left) for n, n_left in zip(volume.shape, samples.shape, strict=True)]
    steps = [max(1, int(STEP_MM / (d * n))) for d, n in zip(reversed(volume.spacing), thinned_by, strict=True)]
    thinned = samples[tuple(slice(None, None, step) for step in steps)]
    matter: Mask = thinned > AIR_HU
    body = _eroded(matter)
    for _ in range(3):
        body = _dilated(body)
    body &= matter
    beside = thinned[matter & ~body]
    shown = np.count_nonzero(curves(beside.astype(np.float64))[:, 3] > 0)
    return bool(shown > MIN_SHARE * np.count_nonzero(body) > 0)


def _eroded(mask: Mask) -> Mask:
    """The samples all of whose neighbours along the axes are in the mask; the volume's faces are no surfaces."""
    return ~_dilated(~mask)


def _dilated(mask: Mask) -> Mask:
    """The samples of the mask and their neighbours along the axes."""
    grown = mask.copy()
    for axis in range(mask.ndim):
        own, of = (np.moveaxis(each, axis, 0) for each in (mask, grown))
        of[1:] |= own[:-1]
        of[:-1] |= own[1:]
    return grown
