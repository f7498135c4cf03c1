"""Off-axis stereo: two eyes that look in parallel, each through a window that is shifted towards the other.

An eye at +-e/2 sees the plane at the distance c in the same window as the middle does if its frustum is sheared by
e / (2 c). The renderer draws symmetric frusta, so a picture that is wider by k pixels is drawn, and k of them are cut
off at one side: the frustum of the rest is sheared by k / 2 pixels, exactly. With f = height / (2 tan(angle / 2)), the
pixels to the unit tangent, k is f e / c, rounded, so that the plane without parallax lies at f e / k. See P. Bourke,
"Calculating stereo pairs" (1999).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from math import radians, tan
from typing import Any

import numpy as np

from wavesplat._model import camera_fit
from wavesplat._model.camera import Camera
from wavesplat._model.options import MAX_SIDE_PX
from wavesplat._model.stereo import Side, Stereo
from wavesplat._picture.picture import Picture
from wavesplat._picture.report import Report
from wavesplat.errors import ArgumentError

#: Share of its own colour that each eye has in an anaglyph, the rest is grey: VTK's default, against colours that only
#: one eye sees.
SATURATION = 0.65
#: Brightness of red, green and blue (ITU-R BT.601, as in VTK).
LUMA = np.array([0.299, 0.587, 0.114], np.float32)

Draw = Callable[[Camera, tuple[int, int]], Picture]


def seen_by(side: Side, stereo: Stereo, camera: Camera, size: tuple[int, int], draw: Draw) -> Picture:
    """The picture of an eye. `stereo` has its distances, and the camera is one of perspective."""
    width, height = size
    apart, convergence = stereo.eye_distance or 0.0, stereo.convergence or 0.0
    cut = cut_px(stereo, camera, height)
    if width + cut > MAX_SIDE_PX:
        raise ArgumentError(
            f"eyes that are {apart:g} world units apart and converge at {convergence:g} need a picture of "
            f"{width + cut} pixels in width, and {MAX_SIDE_PX} are the most; give a smaller eye_distance or size"
        )
    right = camera_fit.axes_of(camera)[0]
    shift = (apart / 2 if side == "right" else -apart / 2) * right
    moved: Any = {name: tuple((getattr(camera, name) + shift).tolist()) for name in ("position", "focal_point")}
    wide = draw(replace(camera, **moved), (width + cut, height))
    kept = slice(cut, None) if side == "left" else slice(0, width)
    depth, value = (None if plane is None else plane[:, kept] for plane in (wide.depth, wide.value))
    return Picture(np.ascontiguousarray(wide.rgba[:, kept]), depth, value, Report(wide.report))


def cut_px(stereo: Stereo, camera: Camera, height: int) -> int:
    """Columns that are cut off of each eye's picture."""
    per_tangent = height / (2 * tan(radians(camera.view_angle or 0.0) / 2))
    return round(per_tangent * (stereo.eye_distance or 0.0) / (stereo.convergence or 1.0))


def facts_of_pair(stereo: Stereo, camera: Camera, height: int) -> dict[str, Any]:
    """The report's field `stereo`; `convergence` is the distance that whole pixels give, None is infinity."""
    per_tangent = height / (2 * tan(radians(camera.view_angle or 0.0) / 2))
    cut = cut_px(stereo, camera, height)
    exact = per_tangent * (stereo.eye_distance or 0.0) / cut if cut else None
    return {"layout": stereo.layout, "eye_distance": stereo.eye_distance, "convergence": exact}


def joined(stereo: Stereo, pictures: list[Picture]) -> Picture:
    """The eyes' pictures in one, in the layout."""
    if len(pictures) == 1:
        return pictures[0]
    left, right = pictures
    report = Report(left.report)
    if stereo.layout == "anaglyph":
        return Picture(_anaglyph(left.rgba, right.rgba), report=report)
    axis = 1 if stereo.layout == "side-by-side" else 0

    def both(name: str) -> Any:
        planes = [getattr(one, name) for one in pictures]
        return None if planes[0] is None else np.concatenate(planes, axis)

    return Picture(both("rgba"), both("depth"), both("value"), report)


def _anaglyph(left: Any, right: Any) -> Any:
    """Red of the left eye, green and blue of the right one, each mixed with its grey."""
    of_left, of_right = (
        SATURATION * rgba[..., :3] + (1 - SATURATION) * (rgba[..., :3] @ LUMA)[..., None] for rgba in (left, right)
    )
    alpha = np.maximum(left[..., 3:], right[..., 3:])
    both = np.concatenate([of_left[..., :1], of_right[..., 1:], alpha], axis=-1)
    return both.astype(np.float32)
