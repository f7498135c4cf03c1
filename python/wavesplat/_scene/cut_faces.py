"""The faces that the clips of a scene cut: where they lie, and which part of each is seen.

A crop and a clip plane keep half-spaces; the face of each is seen inside of the others. A box that is cut out has six
faces, each seen within the box. No face is seen in a box that is cut out.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from wavesplat._model.clips import Clipping, ClipPlane
from wavesplat._model.crop import Crop
from wavesplat._model.grid import Grid

Array = NDArray[np.float64]

#: Part of a sample's distance within which a face lies on a wall of the volume, where nothing is cut.
ON_WALL = 1e-3


@dataclass(frozen=True)
class CutFace:
    """A face of a clip, in the world.

    plane : that it lies on; its normal points to what is kept, or into the box that is cut out.
    within : half-spaces in which it is seen. without : boxes in which it is not, six half-spaces each.
    """

    plane: ClipPlane
    within: tuple[ClipPlane, ...]
    without: tuple[tuple[ClipPlane, ...], ...]

    def is_seen(self, points: Array, slack: float) -> NDArray[np.bool_]:
        """Whether it is seen at points of its plane, shape (..., 3); up to `slack` beyond its edges, world units."""
        seen = _inside(points, self.within, slack)
        for box in self.without:
            seen &= ~_inside(points, box, -slack)
        return seen


def cut_faces(clipping: Clipping, volume: Grid) -> list[CutFace]:
    """The faces that clips cut through a volume. `clipping`: boxes in samples use this volume's indices."""
    planes = [_unit(plane) for plane in _half_spaces(clipping, volume)]
    boxes = [tuple(_unit(plane) for plane in _half_spaces(Clipping(crop=box), volume)) for box in clipping.boxes]
    found = [CutFace(plane, _others(planes, k), tuple(boxes)) for k, plane in enumerate(planes)]
    for number, box in enumerate(boxes):
        without = tuple(other for k, other in enumerate(boxes) if k != number)
        found += [
            CutFace(_at_first_missing(plane, volume), (*planes, *_others(box, k)), without)
            for k, plane in enumerate(box)
        ]
    return [face for face in found if _is_inside(face.plane, volume)]


def _half_spaces(clipping: Clipping, volume: Grid) -> tuple[ClipPlane, ...]:
    """The clip planes, and the sides of a box that is kept."""
    if clipping.crop is not None and clipping.crop.space == "world":
        return (*_sides(clipping.crop), *clipping.planes)
    return clipping.in_world(volume).planes


def _sides(box: Crop) -> list[ClipPlane]:
    lower, upper = np.sort([box.lower, box.upper], axis=0)
    return [ClipPlane(end, sign * axis) for axis in np.eye(3) for end, sign in ((lower, 1), (upper, -1))]


def _unit(plane: ClipPlane) -> ClipPlane:
    return ClipPlane(plane.point, np.array(plane.normal) / np.linalg.norm(plane.normal))


def _others(planes: Sequence[ClipPlane], number: int) -> tuple[ClipPlane, ...]:
    return tuple(plane for k, plane in enumerate(planes) if k != number)


def _inside(points: Array, planes: Sequence[ClipPlane], slack: float) -> NDArray[np.bool_]:
    inside = np.ones(points.shape[:-1], bool)
    for plane in planes:
        inside &= (points - plane.point) @ np.array(plane.normal) >= -slack
    return inside


def _at_first_missing(plane: ClipPlane, volume: Grid) -> ClipPlane:
    """The side of a box that is cut out, moved into it to the first samples that are missing.

    Matter fades out from the last sample that is kept to there, and would lie over the face as a veil.
    """
    steps = volume.world_from_index[:3, :3].T @ np.array(plane.normal)
    along = int(np.abs(steps).argmax())
    step = abs(float(steps[along]))
    moved = step
    if np.abs(np.delete(steps, along)).max() <= ON_WALL * step:  # else the first ones are stairs
        offset = (np.array(plane.point) - volume.world_from_index[:3, 3]) @ np.array(plane.normal)
        # Of samples on the side itself, rounding decides.
        moved = float((np.floor(offset / step + ON_WALL) + 1) * step - offset)
    return ClipPlane(np.array(plane.point) + moved * np.array(plane.normal), plane.normal)


def _is_inside(plane: ClipPlane, volume: Grid) -> bool:
    """Whether a plane runs through a volume, and not along one of its walls, or beside it."""
    n_z, n_y, n_x = volume.shape
    corners = np.array([[(k >> axis) & 1 for axis in range(3)] for k in range(8)]) * (n_x - 1, n_y - 1, n_z - 1)
    world = corners @ volume.world_from_index[:3, :3].T + volume.world_from_index[:3, 3]
    away = (world - plane.point) @ np.array(plane.normal)
    slack = ON_WALL * min(volume.spacing)
    return bool(away.min() < -slack and away.max() > slack)
