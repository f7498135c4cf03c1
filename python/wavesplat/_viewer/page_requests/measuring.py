"""Statistics of what is measured: values in a region drawn on a slice, and of every label of a segmentation."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wavesplat._looks.labels.structure_labels import even_odd
from wavesplat._model.lazy.volume import LazyVolume
from wavesplat._model.volume.volume import Volume
from wavesplat._render.slicing import planes_at
from wavesplat._viewer.session.state import ViewerState
from wavesplat.errors import ArgumentError

# Statistics of the values of each label of a segmentation, of slab after slab of the scan.
#
# Counts, means and squares about the mean of two parts are merged by the formula of Chan, Golub and LeVeque (1983),
# which loses no digits where means are large; so a slab's values are read once, and only they take memory as 64-bit
# numbers.

#: Samples of a slab, about: 8 MB as 64-bit numbers, which caches of processors hold in part.
SLAB_SAMPLES = 1 << 18

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class LabelValues:
    """Statistics by code, arrays of shape (n,): voxels, finite values among them, and their mean, sd, min and max."""

    n_voxels: NDArray[np.int64]
    n_finite: NDArray[np.int64]
    mean: Floats
    sd: Floats
    min: Floats
    max: Floats


def values_of_labels(
    codes: NDArray[np.integer], samples: NDArray[np.generic], wanted: NDArray[np.bool_]
) -> LabelValues:
    """Statistics of samples by their codes.

    codes : shape (z, y, x), 0..n - 1. samples : the same shape, any real type. wanted : shape (n,), the codes that
        count; statistics of others are 0. What is outside of all labels is mostly not wanted.
    """
    n = len(wanted)
    n_voxels, n_finite = np.zeros(n, np.int64), np.zeros(n, np.int64)
    mean, squares, least, most = np.zeros(n), np.zeros(n), np.full(n, np.inf), np.full(n, -np.inf)
    depth = max(1, SLAB_SAMPLES // max(1, codes[0].size))
    for first in range(0, len(codes), depth):
        slab = codes[first : first + depth].reshape(-1)
        counts = np.bincount(slab, minlength=n) * wanted
        n_voxels += counts
        if not counts.any():
            continue
        inside = wanted[slab]
        labels, values = slab[inside], samples[first : first + depth].reshape(-1)[inside].astype(np.float64)
        if not (finite := np.isfinite(values)).all():
            labels, values = labels[finite], values[finite]
            counts = np.bincount(labels, minlength=n)
        known = np.maximum(counts, 1)
        own = np.bincount(labels, values, n) / known
        values_about = values - own[labels]
        step, both = own - mean, np.maximum(n_finite + counts, 1)
        squares += np.bincount(labels, values_about**2, n) + np.where(counts, step**2 * n_finite * counts / both, 0)
        mean += np.where(counts, step * counts / both, 0)
        n_finite += counts
        np.minimum.at(least, labels, values)
        np.maximum.at(most, labels, values)
    return LabelValues(n_voxels, n_finite, mean, np.sqrt(squares / np.maximum(n_finite, 1)), least, most)


# Statistics of what is measured: values in a region drawn on a slice, and of every label of a segmentation.

#: Pixels along the longer side of a region, at which values between samples are read.
REGION_PX = 256


def region_statistics(state: ViewerState, points: NDArray[np.float64]) -> list[dict[str, float] | None]:
    """Mean, standard deviation, least and largest value of each layer in a plane region; None without values there.

    points : shape (n, 3), n >= 3. Corners in the world, in the order of the line around the region, which is closed.
        Values are taken from a plane through their middle, also where slices show slabs.

    Raises
    ------
    ArgumentError
        If the points lie on a line.
    """
    middle = points.mean(axis=0)
    away = points - middle
    normal = np.cross(away, np.roll(away, -1, axis=0)).sum(axis=0)
    size = np.linalg.norm(normal)
    if not size > 1e-12 * (away**2).sum():
        raise ArgumentError("region: its points lie on a line; give corners of an area")
    right = away[np.argmax((away**2).sum(axis=1))]
    right = right - (right @ normal) * normal / size**2
    right /= np.linalg.norm(right)
    up = np.cross(normal / size, right)
    columns, rows = away @ right, away @ -up
    width, height = np.ptp(columns), np.ptp(rows)
    pixel = float(max(width, height)) / REGION_PX
    shape = tuple(max(1, int(np.ceil(side / pixel))) for side in (width, height))
    origin = middle + (columns.min() + pixel / 2) * right - (rows.min() + pixel / 2) * up
    planes = planes_at(origin, right, up, pixel, shape)
    corners = np.stack([columns - columns.min(), rows - rows.min()], axis=1) / pixel - 0.5
    inside = even_odd([corners], shape[1], shape[0])
    found: list[dict[str, float] | None] = []
    for layer in state.scene.layers:
        values = planes.values_of(layer.drawn, state.options["kernel"], "mean", None)[inside].astype(np.float64)
        values = values[np.isfinite(values)]
        found.append(
            {
                "mean": float(values.mean()),
                "sd": float(values.std()),
                "min": float(values.min()),
                "max": float(values.max()),
            }
            if values.size
            else None
        )
    return found


def label_statistics(state: ViewerState) -> list[dict[str, Any]]:
    """Number, name, voxels, volume (cubed world units) and mean, sd, min and max of the first layer, of each label.

    Labels without voxels are left out; values are None where all of a label's are not finite.

    Raises
    ------
    ArgumentError
        If there are no labels, or the volume is not in memory as a whole.
    """
    labels, volume = state.scene.labels, state.scene.layers[0].drawn
    if labels is None:
        raise ArgumentError("there are no labels; open some with --labels")
    if isinstance(volume, LazyVolume) or not isinstance(volume, Volume):
        raise ArgumentError(
            f"statistics of labels read all samples, and {volume.name!r} is read in parts; open a smaller copy of it"
        )
    on_scan = labels.on_samples_of(volume)
    looks = [on_scan.labels.get(number) for number in on_scan.numbers]
    # Samples outside of all labels have the number 0, and mostly no look.
    wanted = np.array([number != 0 or look is not None for number, look in zip(on_scan.numbers, looks, strict=True)])
    found = values_of_labels(on_scan._codes, np.asarray(volume.samples), wanted)
    voxel = abs(float(np.linalg.det(volume.world_from_index[:3, :3])))
    listed = []
    for code, (number, look) in enumerate(zip(on_scan.numbers, looks, strict=True)):
        if found.n_voxels[code] == 0:
            continue
        facts = {"mean": found.mean[code], "sd": found.sd[code], "min": found.min[code], "max": found.max[code]}
        listed.append(
            {
                "number": int(number),
                "name": (look.name if look else "") or str(number),
                "n_voxels": int(found.n_voxels[code]),
                "volume": float(found.n_voxels[code]) * voxel,
                **{name: float(value) if found.n_finite[code] else None for name, value in facts.items()},
            }
        )
    return listed
