"""Blending of looks and clips between two key frames.

Curves of transfer functions are mixed value by value: at every value where one of the two has a node, the mean of both,
weighted by time. Opacities belong to a thickness; where that differs, it is mixed too, by factors.
"""

from __future__ import annotations

from bisect import bisect_left, bisect_right
from collections.abc import Sequence
from dataclasses import fields, replace
from math import exp, log
from typing import TypeAlias

import numpy as np

from wavesplat._looks import colors
from wavesplat._looks.look import Look
from wavesplat._looks.shading import Light, Shading
from wavesplat._looks.transfer_function import TransferFunction
from wavesplat._looks.transfer_function_2d import TransferFunction2D
from wavesplat._model.clips import Clip, ClipPlane, CutOut
from wavesplat._model.crop import Crop
from wavesplat.errors import ArgumentError

Nodes: TypeAlias = Sequence[tuple[float, ...]]


def blended_look(a: Look, b: Look, t: float, spacing: Sequence[float]) -> Look:
    """The look a part `t` of the way from one to the other. `spacing`: of the volume, for opacities without a unit."""
    if a == b:
        return a
    if a.composite != b.composite:
        raise ArgumentError(
            f'looks of key frames are for composite="{a.composite}" and "{b.composite}", which do not mix; '
            "give looks for one operator, or make two movies"
        )
    nearer = a if t < 0.5 else b
    return replace(
        nearer,
        transfer_function=_blended_function(a.transfer_function, b.transfer_function, t, spacing),
        shading=_blended_shading(a.shading, b.shading, t),
        background=_blended_background(a.background, b.background, t),
    )


def blended_clips(a: Sequence[Clip], b: Sequence[Clip], t: float) -> tuple[Clip, ...]:
    """The clips a part `t` of the way from some to others of the same kinds."""
    if [_kind(clip) for clip in a] != [_kind(clip) for clip in b]:
        kinds = [", ".join(_kind(clip) for clip in clips) or "nothing" for clips in (a, b)]
        raise ArgumentError(
            f"clip of key frames is {kinds[0]} and {kinds[1]}, which do not mix; give the same kinds in the same order "
            "(a plane or a box outside of the volume clips nothing)"
        )
    return tuple(_blended_clip(one, other, t) for one, other in zip(a, b, strict=True))


def _kind(clip: Clip) -> str:
    if isinstance(clip, CutOut):
        return f"a CutOut ({clip.crop.space})"
    return f"a Crop ({clip.space})" if isinstance(clip, Crop) else "a ClipPlane"


def _blended_clip(a: Clip, b: Clip, t: float) -> Clip:
    if isinstance(a, Crop) and isinstance(b, Crop):
        lower, upper = (np.sort([crop.lower, crop.upper], axis=0) for crop in (a, b))
        ends = [_mixed(lower[k], upper[k], t) for k in (0, 1)]
        return Crop(ends[0], ends[1], a.space)
    if isinstance(a, CutOut) and isinstance(b, CutOut):
        crop = _blended_clip(a.crop, b.crop, t)
        assert isinstance(crop, Crop)
        return CutOut(crop)
    assert isinstance(a, ClipPlane)
    assert isinstance(b, ClipPlane)
    normals = [np.divide(plane.normal, np.linalg.norm(plane.normal)) for plane in (a, b)]
    if normals[0] @ normals[1] < -1 + 1e-9:
        raise ArgumentError("normals of a clip plane of two key frames are opposite; give a key frame between them")
    return ClipPlane(_mixed(a.point, b.point, t), _mixed(normals[0], normals[1], t))


def _mixed(a: object, b: object, t: float) -> list[float]:
    first, second = np.array(a, dtype=np.float64), np.array(b, dtype=np.float64)
    mixed: list[float] = ((1 - t) * first + t * second).tolist()
    return mixed


def _blended_function(
    a: TransferFunction | TransferFunction2D,
    b: TransferFunction | TransferFunction2D,
    t: float,
    spacing: Sequence[float],
) -> TransferFunction | TransferFunction2D:
    if a == b:
        return a
    unit = _blended_unit(a.opacity_unit, b.opacity_unit, t, spacing)
    if isinstance(a, TransferFunction) and isinstance(b, TransferFunction):
        gradients = a.gradient_opacity, b.gradient_opacity
        whole = ((0.0, 1.0),)
        return TransferFunction(
            _blended_nodes(a.opacity, b.opacity, t),
            _blended_nodes(a.color, b.color, t),
            unit,
            _blended_nodes(gradients[0] or whole, gradients[1] or whole, t) if any(gradients) else (),
        )
    if isinstance(a, TransferFunction2D) and isinstance(b, TransferFunction2D):
        if a.rows == b.rows and a.values == b.values and a.magnitudes == b.magnitudes:
            return TransferFunction2D(a.values, a.magnitudes, (1 - t) * a.rgba + t * b.rgba, unit, rows=a.rows)
        raise ArgumentError(
            "transfer functions of two dimensions mix on one grid; give both the same values, magnitudes and rows"
        )
    raise ArgumentError(
        "a transfer function of one dimension does not mix with one of two; give key frames of one kind"
    )


def _blended_unit(a: float | None, b: float | None, t: float, spacing: Sequence[float]) -> float | None:
    if a == b:
        return a
    usual = float(np.prod(spacing)) ** (1 / 3)
    return exp((1 - t) * log(a or usual) + t * log(b or usual))


def _blended_nodes(a: Nodes, b: Nodes, t: float) -> list[tuple[float, ...]]:
    """Nodes of the mean of two curves, steps included."""
    nodes: list[tuple[float, ...]] = []
    for value in sorted({node[0] for node in (*a, *b)}):
        sides = [
            tuple((1 - t) * x + t * y for x, y in zip(_limit(a, value, side), _limit(b, value, side), strict=True))
            for side in (0, 1)
        ]
        nodes += [(value, *channels) for channels in dict.fromkeys(sides)]
    return nodes


def _limit(nodes: Nodes, value: float, side: int) -> tuple[float, ...]:
    """Limit of a curve at a value from below (side 0) or from above (1)."""
    values = [node[0] for node in nodes]
    below, above = bisect_left(values, value), bisect_right(values, value)
    if above > below:
        return nodes[below if side == 0 else above - 1][1:]
    if below == 0:
        return nodes[0][1:]
    if below == len(nodes):
        return nodes[-1][1:]
    (v0, *left), (v1, *right) = nodes[below - 1], nodes[below]
    part = (value - v0) / (v1 - v0)
    return tuple((1 - part) * x + part * y for x, y in zip(left, right, strict=True))


def _blended_shading(a: Shading | None, b: Shading | None, t: float) -> Shading | None:
    """The shading between two: numbers are mixed, other settings are those of the nearer key frame."""
    if a is None or b is None or a == b:
        return a if t < 0.5 else b
    nearer = a if t < 0.5 else b
    settings = {field.name: getattr(nearer, field.name) for field in fields(Shading) if field.name != "_core"}
    for name in settings:
        x, y = getattr(a, name), getattr(b, name)
        if isinstance(x, float) and isinstance(y, float) and name != "gradient_smoothing":
            settings[name] = (1 - t) * x + t * y
    if len(a.lights) == len(b.lights) and all(x.frame == y.frame for x, y in zip(a.lights, b.lights, strict=True)):
        settings["lights"] = [
            Light(_mixed(x.direction, y.direction, t), _mixed(x.color, y.color, t), x.frame)
            for x, y in zip(a.lights, b.lights, strict=True)
        ]
    return Shading(**settings)


def _blended_background(a: str | None, b: str | None, t: float) -> str | None:
    ends = [colors.parse(text) for text in (a, b)]
    if a == b or ends[0] is None or ends[1] is None:
        return a if t < 0.5 else b
    return ",".join(f"{channel:.6f}" for channel in _mixed(ends[0], ends[1], t))
