"""Properties that every random scene has, whatever its picture: one picture wherever samples lie, and sums of samples.

Each property gives a sentence on what is wrong, or None.
"""

# ruff: noqa: INP001 - beside a script, not in a package
from __future__ import annotations

import importlib
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import generator
import numpy as np
from numpy.typing import NDArray

import wavesplat as ws

#: Chunks of the arrays that are read in parts, and the budget they are read with.
CHUNK, MEMORY = 4, "8 MB"
#: Largest error of a sum or mean of float32 rays, as a share of the largest value.
ROUNDING = 1e-5


class Parts:
    """An array that gives its samples in parts, as one of another library would."""

    def __init__(self, samples: NDArray[Any]) -> None:
        self.samples, self.shape, self.dtype = samples, samples.shape, samples.dtype
        self.chunks = tuple(min(CHUNK, n) for n in samples.shape)

    def __getitem__(self, part: Any) -> NDArray[Any]:
        found: NDArray[Any] = self.samples[part]
        return found


def reading(drawn: generator.Scene) -> str | None:
    """The picture of samples in memory is, to the byte, the one of samples that are read in parts, or by Dask."""
    dask: Any = importlib.import_module("dask.array")

    if any(isinstance(clip, ws.CutOut) for clip in drawn.scene.clip):
        return None  # refused where samples are read in parts, with the reason
    want = drawn.draw()
    ways: dict[str, Callable[[NDArray[Any]], Any]] = {
        "in parts": Parts,
        "by Dask": lambda samples: dask.from_array(samples, chunks=CHUNK),
    }
    for name, array_of in ways.items():
        layers = []
        for layer, samples in zip(drawn.scene.layers, drawn.samples, strict=True):
            place = layer.volume.world_from_index
            lazy = ws.Volume.lazy(array_of(samples), world_from_index=place, memory=MEMORY, cache=False)
            if ws.Look.auto(lazy).to_json() != ws.Look.auto(ws.Volume(samples, world_from_index=place)).to_json():
                return f"the look of {samples.dtype} {name} is another one"
            layers.append(ws.Layer(lazy, layer.look, opacity=layer.opacity))
        got = replace(drawn, scene=drawn.scene.with_(layers=layers)).draw()
        if not np.array_equal(got, want):
            return f"the picture of samples {name} differs by {np.abs(got - want).max():.2g}"
    return None


def sums(drawn: generator.Scene) -> str | None:
    """Sums and means along an axis are those of the samples at every quality but draft, one sample a pixel."""
    samples = drawn.samples[0].astype(np.float64)
    if not np.isfinite(samples).all():
        return None
    axis = drawn.number % 3
    volume = ws.Volume(drawn.samples[0], spacing=(1.0, 1.0, 1.0))
    middle = np.array(volume.bounds).mean(axis=0)
    towards, up = np.eye(3)[2 - axis], np.eye(3)[(3 - axis) % 3]
    across = next(k for k in range(3) if k not in (2 - axis, (3 - axis) % 3))
    height, width = volume.shape[2 - (3 - axis) % 3], volume.shape[2 - across]
    camera = ws.Camera(middle + 1000 * towards, middle, up, parallel_scale=height / 2)
    along = np.moveaxis(samples, axis, 0)
    total = (along[1:] + along[:-1]).sum(axis=0) / 2
    wanted: dict[Any, NDArray[np.float64]] = {"sum": total, "mean": total / (len(along) - 1)}
    qualities: tuple[Any, ...] = ("normal", "fine", "high")
    for composite, want in wanted.items():
        for quality in qualities:
            picture = ws.render(
                volume, None, camera, size=(width, height), composite=composite, quality=quality, device="cpu"
            )
            value = np.asarray(picture.value, np.float64)
            # Any of the eight orientations of a picture; the tests of projections hold the places.
            error = np.abs(np.sort(value, axis=None) - np.sort(want, axis=None)).max()
            if not error <= ROUNDING * max(np.abs(want).max(), 1e-30):
                return f"{composite} at quality {quality} is {error:.2g} off, of {np.abs(want).max():.2g}"
    return None
