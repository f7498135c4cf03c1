"""Notes on pictures that nobody should wonder about: of one colour all over, or with steps between distant slices.

Notes are for the eye: a difference of less than a step of 8 bits does not show.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from wavesplat._looks.transfer_function import TransferFunction
from wavesplat._looks.transfer_function_2d import TransferFunction2D
from wavesplat._model.lazy_volume import LazyVolume
from wavesplat._model.volume import Volume
from wavesplat._model.wavelet_volume import WaveletVolume

Floats = NDArray[np.float32]

#: Least difference that shows in 8 bits.
STEP = 1 / 255
#: Least distance of slices, as a multiple of that of the samples in them, at which surfaces have steps that show.
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
    where = f"the window, {window[0]:g} to {window[1]:g}" if window else "what the transfer function tells apart"
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
