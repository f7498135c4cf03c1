"""Pictures that are put together of several: pairs for two eyes, and panoramas of 360 degrees.

`crates/view` decides where their cameras stand, and which pixels of which picture show a pixel of the panorama
(`eyes.rs`, `panorama.rs`). Where the renderer's sheets lie depends on the view, and pictures differ where they overlap
by as much as they differ from the converged one. Light that goes with the camera goes with the camera that looks ahead.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wavesplat import _native
from wavesplat._looks.shading import FILL_LIGHT, KEY_LIGHT, Light, Shading
from wavesplat._model.arguments.sampling import MAX_SIDE_PX
from wavesplat._model.camera import fit
from wavesplat._model.camera.camera import Camera
from wavesplat._model.camera.fit import Placed
from wavesplat._model.camera.stereo import Eyes, Side, Stereo
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
    eyes, fields = _distances(stereo), fit.fields_of(camera)
    cut, _ = _native.eyes_cut(eyes, fields, height)
    if width + cut > MAX_SIDE_PX:
        raise ArgumentError(
            f"eyes that are {eyes[0]:g} world units apart and converge at {eyes[1]:g} need a picture of "
            f"{width + cut} pixels in width, and {MAX_SIDE_PX} are the most; give a smaller eye_distance or size"
        )
    wide = draw(fit.camera_at(Placed(*_native.eye_of(eyes, fields, side == "right"))), (width + cut, height))
    kept = slice(cut, None) if side == "left" else slice(0, width)
    depth, value = (None if plane is None else plane[:, kept] for plane in (wide.depth, wide.value))
    return Picture(np.ascontiguousarray(wide.rgba[:, kept]), depth, value, Report(wide.report))


def facts_of_pair(stereo: Stereo, camera: Camera, height: int) -> dict[str, Any]:
    """The report's field `stereo`; `convergence` is the distance that whole pixels give, None is infinity."""
    _, exact = _native.eyes_cut(_distances(stereo), fit.fields_of(camera), height)
    return {"layout": stereo.layout, "eye_distance": stereo.eye_distance, "convergence": exact}


def _distances(stereo: Stereo) -> tuple[float, float]:
    return stereo.eye_distance or 0.0, stereo.convergence or 1.0


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


# Panoramas of 360 degrees: perspective pictures in all directions, resampled to longitude and latitude.

Array = NDArray[Any]


def all_around(
    camera: Camera,
    size: tuple[int, int],
    faces: Sequence[_native.Face],
    draw: Draw,
    *,
    side: Side | None = None,
    eye_distance: float = 0.0,
) -> Picture:
    """An equirectangular picture, as wide as 360 degrees. `draw` is called with the camera of each face, in order."""
    place = _Mixed(size)
    eye = None if side is None else (side == "right", eye_distance)
    report: Any = {}
    for face in faces:
        fields, face_size = face.camera(fit.fields_of(camera), size, eye)
        picture = draw(fit.camera_at(Placed(*fields)), face_size)
        place.add(picture, *face.places(size))
        report = report or picture.report
    return place.picture(Report(report))


class _Mixed:
    """The panorama as it is put together: sums of colours by weight, and numbers of the picture that weighs most."""

    def __init__(self, size: tuple[int, int]) -> None:
        self._width, n = size[0], size[0] * size[1]
        self._rgba = np.zeros((n, 4), np.float64)
        self._sum = np.zeros(n)
        self._most = np.zeros(n)
        self._planes: dict[str, Array] = {}

    def add(self, picture: Picture, used: Array, weight: Array, places: Array) -> None:
        """Add what a picture shows of the pixels `used`, at these places in it."""
        columns, rows = places.T
        self._rgba[used] += weight[:, None] * _between(picture.rgba, columns, rows)
        self._sum[used] += weight
        is_most = weight > self._most[used]
        self._most[used] = np.maximum(self._most[used], weight)
        for name in ("depth", "value"):
            plane = getattr(picture, name)
            if plane is None:
                continue
            kept = self._planes.setdefault(name, np.full(self._sum.shape, np.nan, np.float32))
            # Numbers are taken as they are: no number lies between a surface and what is behind it.
            nearest = plane[
                np.clip(np.rint(rows), 0, plane.shape[0] - 1).astype(int),
                np.clip(np.rint(columns), 0, plane.shape[1] - 1).astype(int),
            ]
            kept[used] = np.where(is_most, nearest, kept[used])

    def picture(self, report: Report) -> Picture:
        """The panorama."""
        rgba = (self._rgba / self._sum[:, None]).astype(np.float32).reshape(-1, self._width, 4)
        depth, value = (
            None if plane is None else plane.reshape(-1, self._width)
            for plane in map(self._planes.get, ("depth", "value"))
        )
        return Picture(rgba, depth, value, report)


def _between(rgba: Array, columns: Array, rows: Array) -> Array:
    """Colours between pixels, linearly."""
    height, width = rgba.shape[:2]
    columns, rows = np.clip(columns, 0, width - 1), np.clip(rows, 0, height - 1)
    left, top = np.minimum(columns.astype(int), width - 2), np.minimum(rows.astype(int), height - 2)
    s, t = (columns - left)[:, None], (rows - top)[:, None]
    upper = (1 - s) * rgba[top, left] + s * rgba[top, left + 1]
    lower = (1 - s) * rgba[top + 1, left] + s * rgba[top + 1, left + 1]
    return np.asarray((1 - t) * upper + t * lower)


# Pictures that are composed of several: two eyes, and panoramas.


def n_pictures(eyes: Eyes) -> int:
    """Number of perspective pictures that make the one of these eyes."""
    sides = 1 if eyes.stereo is None else len(eyes.stereo.sides)
    return sides * (len(_faces(eyes)) if eyes.panorama else 1)


def put_together(eyes: Eyes, camera: Camera, size: tuple[int, int], draw: Draw) -> Picture:
    """The picture of the eyes, of those that `draw` makes from a camera in a size. `eyes` has its distances."""
    own = eyes.size_of(size)
    if eyes.stereo is None:
        return all_around(camera, own, _faces(eyes), draw) if eyes.panorama else draw(camera, own)
    stereo = eyes.stereo
    if eyes.panorama:
        around: Any = {"draw": draw, "eye_distance": stereo.eye_distance or 0.0}
        seen = [all_around(camera, own, _faces(eyes), side=side, **around) for side in stereo.sides]
    else:
        seen = [seen_by(side, stereo, camera, own, draw) for side in stereo.sides]
    return joined(stereo, seen)


def _faces(eyes: Eyes) -> list[_native.Face]:
    return _native.Face.of_cube() if eyes.stereo is None else _native.Face.of_turns()


def facts_of_eyes(eyes: Eyes, camera: Camera, size: tuple[int, int]) -> dict[str, Any]:
    """The report's fields of the eyes, and the fields of a picture of one eye that differ."""
    facts: dict[str, Any] = {} if eyes.are_plain else {"size": list(size)}
    if eyes.panorama:
        # Pixels are angles there.
        facts |= {"panorama": True, "pixel": None}
    if eyes.stereo is not None and eyes.panorama:
        named = {"layout": eyes.stereo.layout, "eye_distance": eyes.stereo.eye_distance}
        facts["stereo"] = {**named, "convergence": None}
    elif eyes.stereo is not None:
        facts["stereo"] = facts_of_pair(eyes.stereo, camera, eyes.size_of(size)[1])
    return facts


def notes_on_eyes(eyes: Eyes, size: tuple[int, int]) -> list[str]:
    """A note on panoramas that are not twice as wide as high."""
    width, height = eyes.size_of(size)
    if not eyes.panorama or width == 2 * height:
        return []
    return [f"the panorama of an eye has {width} x {height} pixels, which are not square; give twice as many in width"]


def in_world(shading: Shading | None, camera: Camera) -> Shading | None:
    """The light of a camera, where it stays in the world: the lights of pictures in other directions.

    Matter that the eye is within begins at the eye. As a cut it would be lit evenly for some slices, which lie in other
    directions in other pictures.
    """
    if shading is None:
        return None
    axes = fit.axes_of(camera)
    lights = [
        light if light.frame == "world" else Light(tuple((light.direction @ axes).tolist()), light.color, "world")
        for light in shading.lights or (KEY_LIGHT, FILL_LIGHT)
    ]
    return replace(shading, lights=tuple(lights), even_cuts=0.0)
