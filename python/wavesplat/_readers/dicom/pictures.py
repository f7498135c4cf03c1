"""DICOM frames as pictures: windows, films, and distances of pixels in ultrasound, X-ray and captured screens.

Such frames often lie nowhere in a body. A film is frames taken one after the other (PS3.3, C.7.6.5, the Cine module);
its times come from FrameTimeVector, FrameTime or a rate, from the phases of nuclear medicine, or from the frames.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import accumulate
from typing import Any

import numpy as np

from wavesplat._readers.dicom.values import as_numbers, integer, items, numbers, raw_value, text, whole_numbers

#: Modalities whose frames without a place, one after the other, are a film, also where no rate is given: ultrasound,
#: X-ray films, endoscopy and photography.
OF_FILMS = {"US", "IVUS", "XA", "RF", "ES", "XC", "GM", "DF", "DS", "CF"}
#: Modalities whose images lie beside each other in a body, so that files of one series may be a volume.
OF_SLICES = {"", "CT", "MR", "PT", "NM", "OPT", "OT"}
#: SOP classes of captured screens.
CAPTURES = "1.2.840.10008.5.1.4.1.1.7"
#: Physical units of ultrasound regions: centimetres; and the format of regions that are pictures of tissue.
CENTIMETRES, TISSUE = 3, 1
#: Largest relative difference of distances of pixels that are the same.
SAME = 0.01
#: Share of the output of a table (VOI LUT) at the ends of the window that stands for it.
ENDS_OF_TABLE = 0.01


@dataclass(frozen=True)
class FactsOfPictures:
    """Facts that a file says about its frames as pictures.

    times : of the frames of a film, seconds from the first one; empty where they are unknown.
    window : values, after slope and intercept, that are black and white. is_inverted : whether the lowest is white.
    aspect : height and width of a pixel, of which only the ratio counts.
    spacing_source : where the distances of pixels are from, where that is not PixelSpacing; else empty.
    is_picture : whether a file alone is a picture, and no slice of a volume.
    """

    is_film: bool = False
    times: tuple[float, ...] = ()
    window: tuple[float, float] | None = None
    is_inverted: bool = False
    aspect: tuple[float, float] = (1.0, 1.0)
    spacing_source: str = ""
    is_picture: bool = False


NO_PICTURES = FactsOfPictures()


def facts_of_pictures(dataset: Any, modality: str, n_frames: int) -> FactsOfPictures:
    """The facts of a file."""
    times = _times(dataset, modality, n_frames) if n_frames > 1 else ()
    image_type = text(dataset, 0x00080008).upper().split("\\")
    is_dynamic = modality == "NM" and bool({"DYNAMIC", "GATED"} & set(image_type))
    aspect = as_numbers(raw_value(dataset, 0x00280034), "decimal")
    return FactsOfPictures(
        is_film=n_frames > 1 and (bool(times) or is_dynamic or modality in OF_FILMS),
        times=times,
        window=_window(dataset),
        is_inverted=text(dataset, 0x00280004).upper() == "MONOCHROME1" or text(dataset, 0x20500020) == "INVERSE",
        aspect=(aspect[0], aspect[1]) if len(aspect) == 2 and min(aspect) > 0 else (1.0, 1.0),
        spacing_source="" if _has_spacing(dataset) else sizes_of_pixels(dataset)[1],
        is_picture=modality not in OF_SLICES or text(dataset, 0x00080016).startswith(CAPTURES),
    )


def _has_spacing(dataset: Any) -> bool:
    groups = [group for tag in (0x52009229, 0x52009230) for group in items(dataset, tag)[:1]]
    return 0x00280030 in dataset or any(0x00289110 in group for group in groups)


def sizes_of_pixels(dataset: Any) -> tuple[tuple[float, float], str]:
    """Distances of rows and columns in mm without a PixelSpacing, NaN if unknown, and a sentence on their source."""
    regions = [found for item in items(dataset, 0x00186011) if (found := _size_in_region(item)) is not None]
    if regions and all(np.allclose(one, regions[0], rtol=SAME, atol=0) for one in regions):
        return regions[0], "distances of pixels as in the regions of tissue (SequenceOfUltrasoundRegions)"
    ways = {
        0x00181164: "distances of pixels at the detector (ImagerPixelSpacing): things before it are smaller",
        0x00182010: "distances of pixels as they were scanned (NominalScannedPixelSpacing)",
    }
    for tag, size_note in ways.items():
        rows, columns = (float(step) for step in numbers(dataset, tag, 2))
        if min(rows, columns) > 0:
            return (rows, columns), size_note
    return (float("nan"), float("nan")), ""


def _size_in_region(item: Any) -> tuple[float, float] | None:
    """Distances of rows and of columns in an ultrasound region, mm; None for curves and other units."""
    if (integer(item, 0x00186012), integer(item, 0x00186024), integer(item, 0x00186026)) != (
        TISSUE,
        CENTIMETRES,
        CENTIMETRES,
    ):
        return None
    steps = [as_numbers(raw_value(item, tag), "f8") for tag in (0x0018602E, 0x0018602C)]
    if not all(len(step) == 1 and np.isfinite(step[0]) and step[0] != 0 for step in steps):
        return None
    return 10 * abs(steps[0][0]), 10 * abs(steps[1][0])


def _times(dataset: Any, modality: str, n_frames: int) -> tuple[float, ...]:
    """Times of frames in seconds from the first one; empty where the file has none."""
    vector = as_numbers(raw_value(dataset, 0x00181065), "decimal")
    if n_frames - 1 <= len(vector) <= n_frames and all(step >= 0 for step in vector[1:]) and any(vector):
        steps = vector[len(vector) - n_frames + 1 :]  # the first increment lies before the first frame
        return _seconds([0.0, *accumulate(steps)])
    if modality == "NM":  # whose frames may be of several detectors
        phases = _phases(dataset, n_frames)
        return _seconds(phases) if len(phases) == n_frames else ()
    step = _positive(dataset, 0x00181063) or _positive(dataset, 0x00181242)
    rate = _positive(dataset, 0x00180040) or _positive(dataset, 0x00082144)
    step = step or (1000 / rate if rate else 0.0)
    return _seconds([step * number for number in range(n_frames)]) if step else ()


def _phases(dataset: Any, n_frames: int) -> list[float]:
    """Times of the frames of dynamic nuclear medicine, ms, of one detector and one window of energies.

    None where phases say no times, or have more frames than there are.
    """
    found: list[float] = []
    now = 0.0
    for item in items(dataset, 0x00540032):
        now += _positive(item, 0x00540036)
        step = _positive(item, 0x00181242)
        n = next(iter(whole_numbers(item, 0x00540033, "u2")), 0)
        if not step or len(found) + n > n_frames:
            return []
        found += [now + step * number for number in range(n)]
        now += step * n
    return found


def _positive(dataset: Any, tag: int) -> float:
    """The first number of an element, 0 where it has none or it is not positive."""
    found = as_numbers(raw_value(dataset, tag), "decimal")
    return found[0] if found and np.isfinite(found[0]) and found[0] > 0 else 0.0


def _seconds(milliseconds: Sequence[float]) -> tuple[float, ...]:
    return tuple(round(time / 1000, 6) for time in milliseconds)


def _window(dataset: Any) -> tuple[float, float] | None:
    """The window of the file, or the one that is nearest to its table; None where it has neither."""
    if 0x00283000 in dataset:
        return None  # the window is for values after the modality LUT, which is not applied
    groups = [group for tag in (0x52009229, 0x52009230) for group in items(dataset, tag)[:1]]
    holders = [dataset, *(item for group in groups for item in items(group, 0x00289132)[:1])]
    return next((found for holder in holders if (found := _linear(holder) or _of_table(holder, dataset))), None)


def _linear(holder: Any) -> tuple[float, float] | None:
    centers, widths = (as_numbers(raw_value(holder, tag), "decimal") for tag in (0x00281050, 0x00281051))
    if not (centers and widths and np.isfinite((centers[0], widths[0])).all()):
        return None
    center, width = centers[0], widths[0]
    if text(holder, 0x00281056).upper() in ("", "LINEAR"):  # PS3.3, C.11.2.1.2: half a unit lower, one narrower
        center, width = center - 0.5, width - 1
    return (center - width / 2, center + width / 2) if width > 0 else None


def _of_table(holder: Any, dataset: Any) -> tuple[float, float] | None:
    for item in items(holder, 0x00283010)[:1]:
        descriptor = whole_numbers(item, 0x00283002, "u2")
        table = np.array(as_numbers(raw_value(item, 0x00283006), "u2"))
        if len(descriptor) == 3 and len(table) > 1 and np.ptp(table) > 0:
            is_negative = integer(dataset, 0x00280103) == 1 and descriptor[1] >= 1 << 15
            first = descriptor[1] - (1 << 16 if is_negative else 0)
            share = (table - table.min()) / np.ptp(table)
            low, high = int((share > ENDS_OF_TABLE).argmax()), int((share >= 1 - ENDS_OF_TABLE).argmax())
            return (float(first + low), float(first + high)) if low < high else None
    return None
