"""Layers of napari: the last three axes are z, y and x.

Scale, rotation, shear, translation, affine and units are taken into account.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from wavesplat._model.interchange.converted import Converted, loaded
from wavesplat._model.volume import units
from wavesplat._model.volume.facts import Facts
from wavesplat.errors import ArgumentError


def of_napari(layer: Any, at: Sequence[int] = ()) -> Converted:
    """Convert an image or labels layer; of several levels, the finest.

    at : index along the axes before the last three, such as the time; else these must have a length of 1.
    """
    kind, name = type(layer).__name__, str(layer.name)
    if kind not in ("Image", "Labels") and not hasattr(getattr(layer, "data", None), "shape"):
        raise ArgumentError(f"a layer of {kind} has no samples on a grid; give an image or labels layer")
    if getattr(layer, "rgb", False):
        raise ArgumentError(
            f"layer {name!r} has 3 channels of colour; give one of them, as wavesplat.Volume(layer.data[..., 0])"
        )
    data = layer.data[0] if getattr(layer, "multiscale", False) else layer.data
    extra = len(data.shape) - 3
    if extra > 0 and not at and set(data.shape[:extra]) != {1}:
        raise ArgumentError(
            f"layer {name!r} has shape {tuple(data.shape)}; give one volume of it, as "
            f"wavesplat.Volume(layer.data[{', '.join(['0'] * extra)}], spacing=(x, y, z))"
        )
    samples = loaded(data[tuple(at) or (0,) * extra] if extra > 0 else data, name)
    n = len(data.shape)
    # napari keeps its transforms apart, and composes them itself; the axes that are left out stay at 0.
    ends = np.array([layer.data_to_world(point) for point in np.vstack([np.zeros(n), np.eye(n)])], np.float64)
    xyz = [n - 1, n - 2, n - 3]
    matrix = np.eye(4)
    matrix[:3, 3] = ends[0, xyz]
    matrix[:3, :3] = (ends[1:] - ends[0])[np.ix_(xyz, xyz)].T
    named = [units.canonical(unit) for unit in (getattr(layer, "units", None) or ())]
    xyz_units = (named[-1], named[-2], named[-3]) if len(named) == n else (None, None, None)
    unit, factors = units.in_one_unit(xyz_units)
    matrix[:3] *= np.array(factors)[:, None]
    return Converted(samples, matrix, Facts(unit=unit, guesses=tuple(units.guesses_of(xyz_units))), name)
