"""Whether a picture of a CT shows a table that `_looks.tables` leaves, so that a note can name what takes it out.

On a thinned copy, what is denser than air is matter. Opening by a sample (erosion, then more dilation within it) keeps
what is thick, the body; a table, whose shells are thin, is what is left and shows. In the scans in hand that is
2.1 % of the body with a table, and 0.5 and 1.0 % without. It takes milliseconds, and no SciPy, which the finer
`_looks.largest_body` needs: a note is no cut.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from wavesplat._looks.histogram import is_hounsfield, subsampled
from wavesplat._looks.transfer_function import TransferFunction
from wavesplat._looks.transfer_function_2d import TransferFunction2D
from wavesplat._model.lazy_volume import LazyVolume
from wavesplat._model.volume import Volume
from wavesplat._model.wavelet_volume import WaveletVolume

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
