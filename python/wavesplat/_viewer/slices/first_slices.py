"""Window, colours and crosshair that the slices of a viewer begin with, by the kind of data.

CT has the window of soft tissue, 40 and 400 Hounsfield units, where most of what is no air lies in it; PET is dark on
white from 0 to a value that few samples of its body exceed, as it is read in clinics; channels have windows of their
own. All else runs from the value that counts as the volume's smallest to its largest.
"""

from __future__ import annotations

from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from wavesplat._looks.kinds.histogram import finite_samples
from wavesplat._looks.kinds.kinds import Kind, kind_of, offset_of
from wavesplat._looks.kinds.looked_at import subsampled
from wavesplat._render import windows
from wavesplat._scene.drawing.volumes_of_layers import identity_of
from wavesplat._scene.layer import Layer
from wavesplat._scene.scene import Scene
from wavesplat._scene.slices.layers_on_slices import channels_of

#: Level and width.
Window: TypeAlias = tuple[float, float]

#: Window of soft tissue, Hounsfield units; values above the first one are no air; least share of these in the window.
SOFT_TISSUE, NO_AIR, MIN_TISSUE = (40.0, 400.0), -300.0, 0.5
#: PET: a body is brighter than this share of the mean of what is above 0, and white to black reaches to this percentile
#: of it. (A whole body: greys of 60 to 190 in the trunk, brain and bladder black.)
BODY_SHARE, BODY_PERCENTILE = 0.5, 98.0
#: A sample is seen if it lies above this part of the window; a slice shows something if it has at least this share of
#: such samples of the slice with most of them.
SEEN, MIN_SHARE = 0.1, 0.25


def has_channels(scene: Scene) -> bool:
    """Whether slices show channels, each in its colour over a window of its own."""
    return bool(channels_of(scene))


def slice_window(scene: Scene) -> Window:
    """Level and width of the first layer's greys where none is chosen."""
    layer = scene.layers[0]
    volume = layer.looked_at
    key = (id(volume), "window of slices")
    found: Window = scene._cache.get_or_compute(key, identity_of(volume), lambda: _window(scene, layer))
    return found


def slice_colors(scene: Scene) -> str:
    """Name of the colour map of the first layer where none is chosen: grey, of PET inverted."""
    return "gray_r" if _kind(scene, scene.layers[0]) == "PET" else "gray"


def first_crosshair(scene: Scene) -> list[float]:
    """A world point whose slices show something: the middle of the volume, if they do so there."""
    volume = scene.layers[0].drawn
    key = (id(volume), "first crosshair")
    found: list[float] = scene._cache.get_or_compute(key, identity_of(volume), lambda: _crosshair(scene))
    return list(found)


def _crosshair(scene: Scene) -> list[float]:
    volume = scene.layers[0].drawn
    lower, upper = volume.bounds
    middle: list[float] = ((lower + upper) / 2).tolist()
    level, width = slice_window(scene)
    samples = subsampled(volume)
    seen = np.isfinite(samples) & (samples > level - width / 2 + SEEN * width)
    index = [_place(np.count_nonzero(seen, axis=_others(axis))) for axis in (2, 1, 0)]
    if all(place == 0.5 for place in index):
        return middle
    matrix = volume.world_from_index
    at = np.array([place * (n - 1) for place, n in zip(index, reversed(volume.shape), strict=True)])
    point: list[float] = (matrix[:3, :3] @ at + matrix[:3, 3]).tolist()
    return point


def _place(counts: NDArray[np.intp]) -> float:
    """Place of a slice that shows something, 0 to 1 along its axis. counts : of samples that are seen, by slice."""
    most = counts.max()
    if counts[len(counts) // 2] >= MIN_SHARE * most:
        return 0.5
    median = int(np.searchsorted(np.cumsum(counts), counts.sum() / 2))
    best = median if counts[median] >= MIN_SHARE * most else int(counts.argmax())
    return best / max(len(counts) - 1, 1)


def _others(axis: int) -> tuple[int, ...]:
    return tuple(other for other in range(3) if other != axis)


def _kind(scene: Scene, layer: Layer) -> Kind:
    volume: Any = layer.looked_at
    found: Kind = scene._cache.get_or_compute((id(volume), "kind"), identity_of(volume), lambda: kind_of(volume))
    return found


def _window(scene: Scene, layer: Layer) -> Window:
    volume, kind = layer.looked_at, _kind(scene, layer)
    if kind == "CT":
        offset = offset_of(volume)
        values = finite_samples(volume) - offset
        tissue = values[values > NO_AIR]
        level, width = SOFT_TISSUE
        if tissue.size and np.mean(np.abs(tissue - level) <= width / 2) >= MIN_TISSUE:
            return level + offset, width
    elif kind == "PET":
        values = finite_samples(volume)
        positive = values[values > 0]
        if positive.size:
            high = float(np.percentile(positive[positive > BODY_SHARE * positive.mean()], BODY_PERCENTILE))
            return high / 2, high
    low, high = windows.limits(volume, None, None)
    return (low + high) / 2, high - low
