"""Cameras of the viewer that frame what is seen: the first picture, standard views and "fit" have one margin.

The frame is that of pictures without a camera (`_render/framing.py`): all that looks show of the volumes is in view,
and fills 92 % of the picture's height or width.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import product
from math import isclose
from typing import Any, TypeAlias
from weakref import WeakKeyDictionary

import numpy as np
from numpy.typing import NDArray

from wavesplat._model.camera.camera import Camera
from wavesplat._model.volume.grid import Grid
from wavesplat._movie.seen import what_is_seen
from wavesplat._render.framing import FILLED
from wavesplat._scene.scene import Scene
from wavesplat._viewer.session.previews import preview_of

#: A grid around all volumes, and world positions of what is seen, shape (n, 3); None where all may be seen.
Seen: TypeAlias = tuple[Grid | Scene, NDArray[np.float64] | None]

#: Largest relative difference of two cameras that count as the same one: what JSON and sums leave of 64-bit numbers.
SAME = 1e-9

#: Grid and positions by scene, with the operator: they are found once for all turns of the camera.
_SEEN: WeakKeyDictionary[Scene, tuple[Any, Seen]] = WeakKeyDictionary()


@dataclass(frozen=True, eq=False)
class FirstView:
    """The view of a viewer's first picture, which it goes back to.

    camera : as it was given or chosen. aspect : width over height of the picture that it was chosen for.
    is_framed : whether it frames what is seen, so that it is framed anew for pictures of another aspect.
    """

    camera: Camera
    aspect: float
    is_framed: bool

    @classmethod
    def of(cls, scene: Scene, composite: Any, camera: Camera, aspect: float) -> FirstView:
        """The view by a camera of a picture of that aspect."""
        return cls(camera, aspect, _are_same(camera, framed(scene, composite, camera, aspect)))

    def camera_for(self, scene: Scene, composite: Any, aspect: float) -> Camera:
        """The camera of this view in a picture of another aspect."""
        if not self.is_framed:
            return self.camera
        return self.camera if aspect == self.aspect else framed(scene, composite, self.camera, aspect)


def framed(scene: Scene, composite: Any, camera: Camera, aspect: float) -> Camera:
    """A camera with the direction and the lens of another one that frames what is seen of a scene."""
    around, points = _seen_of(scene, composite)
    # The margin is that of the library's cameras, which widens the angle; the page's angle stays.
    lens = camera if camera.view_angle is None else camera.zoomed(1 / FILLED)
    return lens.fitted(around, aspect=aspect, zoom=FILLED, points=points)


def kept_in_view(scene: Scene, composite: Any, camera: Camera, before: float, after: float) -> Camera:
    """A camera for a picture of the aspect `after` that shows all that a camera shows at the aspect `before`.

    A camera that frames what is seen frames it again. Any other one that shows all of it still does; one that shows a
    part shows its whole picture. At a narrower aspect this may take a larger scale or, in perspective, a larger
    distance.
    """
    if before == after:
        return camera
    if _are_same(camera, framed(scene, composite, camera, before)):
        return framed(scene, composite, camera, after)
    return scaled(camera, _least_factor(scene, composite, camera, before, after))


def _least_factor(scene: Scene, composite: Any, camera: Camera, before: float, after: float) -> float:
    """The least factor of `scaled`, from 1, by which a picture of the aspect `after` shows what is seen as before."""
    around, points = _seen_of(scene, composite)
    if points is None:
        points = np.array(list(product(*around.bounds.T)))
    # Shares of the width from the middle of the picture to its side.
    shares = np.abs((camera.project(points, size=(2, 2))[0] + 0.5) - 1) / (before, 1)
    if not (shares <= 1 + SAME).all():
        return max(1.0, before / after)
    wanted = shares[:, 0] * before / after
    if camera.view_angle is None:
        return max(1.0, float(wanted.max()))
    way = np.subtract(camera.focal_point, camera.position)
    distance = float(np.linalg.norm(way))
    depths = (points - camera.position) @ (way / distance)
    # A point at the depth d shrinks by d / (d + (factor - 1) distance) when the eye moves away.
    return 1 + max(0.0, float((depths * (wanted - 1)).max()) / distance)


def scaled(camera: Camera, factor: float) -> Camera:
    """A camera that shows `factor` times as much height at its focal point; in perspective from further away."""
    if camera.view_angle is None:
        return replace(camera, parallel_scale=(camera.parallel_scale or 0.0) * factor)
    focal, eye = np.array(camera.focal_point), np.array(camera.position)
    x, y, z = (float(number) for number in focal + factor * (eye - focal))
    return replace(camera, position=(x, y, z))


def _seen_of(scene: Scene, composite: Any) -> Seen:
    known = _SEEN.get(scene)
    if known is not None and known[0] == composite:
        return known[1]
    is_hidden = not any(layer.visible and layer.opacity > 0 for layer in scene.layers)
    # All hidden, the box of the scene is framed.
    found: Seen = (scene, None) if is_hidden else what_is_seen(preview_of(scene), composite)
    if not is_hidden:
        _SEEN[scene] = composite, found
    return found


def _are_same(one: Camera, other: Camera) -> bool:
    """Whether two cameras look from the same place at the same point with the same lens."""
    size = max(one.parallel_scale or 0.0, float(np.linalg.norm(np.subtract(one.position, one.focal_point))))
    ends, others = ([*camera.position, *camera.focal_point] for camera in (one, other))
    if not np.allclose(ends, others, rtol=0, atol=SAME * size):
        return False
    lenses = [(camera.parallel_scale or 0.0, camera.view_angle or 0.0) for camera in (one, other)]
    return all(isclose(a, b, rel_tol=SAME) for a, b in zip(*lenses, strict=True))
