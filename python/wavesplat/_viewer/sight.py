"""The sight of a pixel of the picture in space: its ray, and the depth where opacity reaches one half."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from wavesplat._model.camera import Camera
from wavesplat._model.camera_fit import axes_of
from wavesplat._viewer.previews import preview_of
from wavesplat._viewer.state import ViewerState

Array: TypeAlias = NDArray[np.float64]

#: Side, pixels, of the small picture around a pixel that finds the depth there.
PICKED_PX = 3


@dataclass(frozen=True, eq=False)
class Sight:
    """The ray of a place in the picture.

    camera : sees only a few pixels around the place, as large as those of the picture. origin, direction : of the ray,
    world units, the direction of length 1. pixel_at : sizes of a pixel in world units at depths along the ray.
    """

    camera: Camera
    origin: Array
    direction: Array
    pixel_at: Callable[[Array], Array]

    def point_at(self, depth: float) -> Array:
        """The world point at a depth."""
        point: Array = self.origin + depth * self.direction
        return point


def sight_at(camera: Camera, at: tuple[float, float], size: tuple[int, int]) -> Sight:
    """The ray of a place. at : shares, 0 to 1, from the left and the top. size : of the picture, pixels."""
    width, height = size
    right, up, back = axes_of(camera)
    eye, focal = np.array(camera.position), np.array(camera.focal_point)
    across, upward = (2 * at[0] - 1) * width / height, 1 - 2 * at[1]
    share = PICKED_PX / height
    if camera.view_angle is None:
        scale = camera.parallel_scale or 0.0
        shift = scale * (across * right + upward * up)
        small = Camera(eye + shift, focal + shift, camera.view_up, parallel_scale=scale * share)
        return Sight(small, eye + shift, -back, lambda depths: np.full(np.shape(depths), 2 * scale / height))
    half = np.tan(np.radians(camera.view_angle) / 2)
    direction = -back + half * (across * right + upward * up)
    direction /= np.linalg.norm(direction)
    distance = float(np.linalg.norm(focal - eye))
    angle = float(np.degrees(2 * np.arctan(half * share)))
    small = Camera(eye, eye + distance * direction, camera.view_up, view_angle=max(angle, 1e-3))
    forward = float(-(direction @ back))
    return Sight(small, eye, direction, lambda depths: 2 * half * forward * np.abs(depths) / height)


def depth_of_matter(state: ViewerState, sight: Sight, progress: Any = None) -> float | None:
    """Depth where opacity, of volumes and shapes, reaches one half; None where it does not, and in projections."""
    composite = state.options["composite"]
    name = composite if isinstance(composite, str | None) else composite.name
    if name not in (None, "over", "first-hit"):
        return None
    arguments = {"quality": "normal", "kernel": state.options["kernel"], "composite": composite}
    picture = preview_of(state.scene).render(
        sight.camera, size=(PICKED_PX, PICKED_PX), depth=True, progress=progress, **arguments
    )
    depth = picture.depth
    if depth is None:
        return None
    near = depth[PICKED_PX // 2, PICKED_PX // 2]
    if np.isfinite(near):
        return float(near)
    finite = depth[np.isfinite(depth)]
    return float(np.median(finite)) if finite.size else None
