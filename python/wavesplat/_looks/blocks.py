"""Blocks: volumes whose matter goes up to their faces, such as crops and small fields of view.

Only the six outermost slices of an opaque block can be seen. Matter that goes up to a face is opaque there, so a block
is recognised by the share of its faces that is not clear. (`studies/looks`; mean of the six faces. Whole bodies, heads
and things: 0 to 0.16; crops to 0.3 and 0.5 of the sides of heads, brains and pelves: 0.52 to 0.91; a knee of 10 slices:
0.47.)
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wavesplat._looks.looked_at import subsampled
from wavesplat._model.volume import Volume
from wavesplat._model.wavelet_volume import WaveletVolume

#: Minimum mean share of the faces that is not clear, and the opacity above which a voxel is not clear.
MIN_FACES, MIN_OPACITY = 0.4, 0.02
#: Samples of a face that are looked at, about.
FACE_SAMPLES = 4096


def is_block(volume: Volume | WaveletVolume, function: Callable[[NDArray[np.float64]], NDArray[np.float64]]) -> bool:
    """Whether a volume looks like a block under a transfer function, which maps values to RGBA."""
    samples = subsampled(volume)
    faces = [_some_of(samples.take(end, axis)) for axis in range(3) for end in (0, -1)]
    seen = [np.isfinite(face) & (function(np.nan_to_num(face))[:, 3] > MIN_OPACITY) for face in faces]
    return bool(np.mean([face.mean() for face in seen]) >= MIN_FACES)


def _some_of(face: NDArray[Any]) -> NDArray[np.float64]:
    """Some thousand samples of a face: the standard error of a share is then below 0.01."""
    step = max(1, int((face.size / FACE_SAMPLES) ** 0.5))
    return face[::step, ::step].ravel().astype(np.float64)
