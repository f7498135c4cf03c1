"""Pictures that are put together of several: pairs for two eyes, and panoramas of 360 degrees.

The middle of an equirectangular picture is what the camera looks at, columns are longitudes, rows latitudes, its upper
edge is the camera's up. One eye takes the six sides of a cube. For two eyes each direction has eyes of its own, beside
each other on a circle (omnidirectional stereo: Peleg, Ben-Ezra and Pritch, "Omnistereo", 2001): 36 turns of three
pictures. Within one of these the eye stands still, so that a ray d degrees from its middle passes the axis at cos(d) of
half the eyes' distance, 0.4 % less at its edge, and the same from both sides of a seam on the horizon. Where one looks
up or down, rays of both sides are at most 2 sin(5 deg) = 0.17 of that distance apart.

Pictures overlap, and pixels in an overlap are mixed of those that show them, by weights that fall evenly to nothing at
their edges. Where the renderer's sheets lie depends on the view, and pictures differ there by as much as they differ
from the converged one. Light that goes with the camera goes with the camera that looks ahead.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from math import atan, ceil, cos, degrees, dist, pi, radians, sin, tan
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from wavesplat._looks.shading import FILL_LIGHT, KEY_LIGHT, Light, Shading
from wavesplat._model.arguments.sampling import MAX_SIDE_PX
from wavesplat._model.camera import fit
from wavesplat._model.camera.camera import Camera
from wavesplat._model.camera.stereo import Eyes, Side, Stereo
from wavesplat._picture.picture import Picture
from wavesplat._picture.report import Report
from wavesplat.errors import ArgumentError

# Off-axis stereo: two eyes that look in parallel, each through a window that is shifted towards the other.
#
# An eye at +-e/2 sees the plane at the distance c in the same window as the middle does if its frustum is sheared by e
# / (2 c). The renderer draws symmetric frusta, so a picture that is wider by k pixels is drawn, and k of them are cut
# off at one side: the frustum of the rest is sheared by k / 2 pixels, exactly. With f = height / (2 tan(angle / 2)),
# the pixels to the unit tangent, k is f e / c, rounded, so that the plane without parallax lies at f e / k. See P.
# Bourke, "Calculating stereo pairs" (1999).

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
    right = fit.axes_of(camera)[0]
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


# Panoramas of 360 degrees: perspective pictures in all directions, resampled to longitude and latitude.

Array = NDArray[Any]

#: Pixels of the pictures for each pixel of the panorama, along the horizon: resampling blurs less.
OVERSAMPLED = 1.25
#: Overlap of the sides of a cube, beyond 45 degrees, as a share of the tangent; of turns in degrees.
OVERLAP, OVERLAP_DEG = 0.05, 1.5
#: Turns of the eyes about the axis, for two eyes.
N_TURNS = 36
#: Latitude at which the pictures of a turn meet, degrees.
MEETING_DEG = 45.0


class Directions(NamedTuple):
    """Where pixels of the panorama look: longitude and latitude, radians, and tangents in a face, right and up."""

    longitude: Array
    latitude: Array
    right: Array
    up: Array


class Face(NamedTuple):
    """A perspective picture: its axes (right, up, back) in axes of the camera, and its halves as tangents.

    turn : direction of its eyes, radians about the camera's up; None of a cube's side, whose eye is the camera's.
    weight : of pixels; 0 where the picture is not used.
    """

    axes: Array
    half_width: float
    half_height: float
    turn: float | None
    weight: Callable[[Directions], Array]


def all_around(
    camera: Camera,
    size: tuple[int, int],
    faces: Sequence[Face],
    draw: Draw,
    *,
    side: Side | None = None,
    eye_distance: float = 0.0,
) -> Picture:
    """An equirectangular picture, as wide as 360 degrees. `draw` is called with the camera of each face, in order."""
    width, height = size
    longitude = (np.arange(width) + 0.5) / width * 2 * pi - pi
    latitude = pi / 2 - (np.arange(height) + 0.5) / height * pi
    longitude, latitude = np.meshgrid(longitude, latitude)
    # In the camera's axes: right, up, back.
    seen = np.stack(
        [np.cos(latitude) * np.sin(longitude), np.sin(latitude), -np.cos(latitude) * np.cos(longitude)], axis=-1
    )
    per_tangent = OVERSAMPLED * max(width / (2 * pi), height / pi)
    place = _Mixed(size)
    # Levels of lazy volumes are chosen by pixels in the focal plane.
    far = dist(camera.position, camera.focal_point)
    report: Any = {}
    for face in faces:
        face_size, eye = _lens(face, per_tangent), _eye(camera, face, side, eye_distance)
        right, up, back = np.moveaxis(seen @ face.axes.T, -1, 0)
        ahead = np.maximum(-back, 1e-9)
        ways = Directions(longitude, latitude, right / ahead, up / ahead)
        weight = np.where(back < -1e-6, face.weight(ways), 0)
        used = np.nonzero(weight > 0)
        tall = 2 * degrees(atan(face_size[1] / 2 / per_tangent))
        position, axes = eye
        picture = draw(Camera(position, position - far * axes[2], axes[1], view_angle=tall), face_size)
        columns = face_size[0] / 2 - 0.5 + per_tangent * ways.right[used]
        rows = face_size[1] / 2 - 0.5 - per_tangent * ways.up[used]
        place.add(picture, used, weight[used], columns, rows)
        report = report or picture.report
    return place.picture(Report(report))


class _Mixed:
    """The panorama as it is put together: sums of colours by weight, and numbers of the picture that weighs most."""

    def __init__(self, size: tuple[int, int]) -> None:
        width, height = size
        self._rgba = np.zeros((height, width, 4), np.float64)
        self._sum = np.zeros((height, width))
        self._most = np.zeros((height, width))
        self._planes: dict[str, Array] = {}

    def add(self, picture: Picture, used: Any, weight: Array, columns: Array, rows: Array) -> None:
        """Add what a picture shows of the pixels `used`, at these places in it."""
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
        rgba = (self._rgba / self._sum[..., None]).astype(np.float32)
        return Picture(rgba, self._planes.get("depth"), self._planes.get("value"), report)


def _between(rgba: Array, columns: Array, rows: Array) -> Array:
    """Colours between pixels, linearly."""
    height, width = rgba.shape[:2]
    columns, rows = np.clip(columns, 0, width - 1), np.clip(rows, 0, height - 1)
    left, top = np.minimum(columns.astype(int), width - 2), np.minimum(rows.astype(int), height - 2)
    s, t = (columns - left)[:, None], (rows - top)[:, None]
    upper = (1 - s) * rgba[top, left] + s * rgba[top, left + 1]
    lower = (1 - s) * rgba[top + 1, left] + s * rgba[top + 1, left + 1]
    return np.asarray((1 - t) * upper + t * lower)


def _lens(face: Face, per_tangent: float) -> tuple[int, int]:
    return ceil(2 * face.half_width * per_tangent) + 2, ceil(2 * face.half_height * per_tangent) + 2


def _eye(camera: Camera, face: Face, side: Side | None, eye_distance: float) -> tuple[Array, Array]:
    """Position and axes of the face's eye, in the world."""
    axes = fit.axes_of(camera)
    position = np.array(camera.position)
    if side is not None and face.turn is not None:
        beside = np.array([cos(face.turn), 0.0, sin(face.turn)]) @ axes
        position = position + (eye_distance / 2 if side == "right" else -eye_distance / 2) * beside
    return position, face.axes @ axes


def faces_of_cube() -> list[Face]:
    """The six sides of a cube around the eye."""
    edge = 1 + OVERLAP

    def weight(ways: Directions) -> Array:
        def falling(tangent: Array) -> Array:
            # Half at the cube's edge, on both sides of it: there a tangent is one over that in the next side.
            outside = np.log(np.maximum(np.abs(tangent), 1e-9)) / np.log(edge)
            return np.asarray(np.clip((1 - outside) / 2, 0, 1))

        return np.asarray(falling(ways.right) * falling(ways.up))

    turns = [(0.0, 0.0), (90.0, 0.0), (180.0, 0.0), (-90.0, 0.0), (0.0, 90.0), (0.0, -90.0)]
    return [Face(_axes(*turn), edge, edge, None, weight) for turn in turns]


def faces_of_turns(n: int = N_TURNS) -> list[Face]:
    """Pictures of `n` turns about the camera's up: ahead, above and below."""
    return [face for k in range(n) for face in _turn(360.0 * k / n, 180.0 / n)]


def _turn(turn: float, half: float) -> Iterator[Face]:
    """The three pictures in a direction, `half` degrees to both sides, and somewhat more."""
    wide = radians(half + OVERLAP_DEG)
    middle = radians(turn)
    meeting, overlap = radians(MEETING_DEG), radians(OVERLAP_DEG)

    def beside(longitude: Array) -> Array:
        away = np.abs((longitude - middle + pi) % (2 * pi) - pi)
        return np.asarray(np.clip((radians(half) + overlap - away) / (2 * overlap), 0, 1))

    def above(latitude: Array) -> Array:
        return np.asarray(np.clip((latitude - meeting + overlap) / (2 * overlap), 0, 1))

    def ahead(ways: Directions) -> Array:
        return np.asarray(beside(ways.longitude) * (1 - above(np.abs(ways.latitude))))

    tall = tan(meeting + overlap) / cos(wide)
    yield Face(_axes(turn, 0.0), tan(wide), tall, middle, ahead)
    # Of the polar pictures the corner that is farthest to the side, and the corner that is farthest down.
    pitch = (90.0 + MEETING_DEG) / 2
    for sign in (1, -1):

        def polar(ways: Directions, sign: int = sign) -> Array:
            return np.asarray(beside(ways.longitude) * above(sign * ways.latitude))

        axes = _axes(0.0, pitch)
        low, angles = meeting - overlap, np.linspace(-wide, wide, 65)
        ends = np.stack([cos(low) * np.sin(angles), np.full(65, sin(low)), -cos(low) * np.cos(angles)], axis=-1)
        right, up, back = (ends @ axes.T).T
        half_width = float(np.abs(right / -back).max())
        half_height = max(float(np.abs(up / -back).max()), tan(radians(90.0 - pitch) + overlap))
        yield Face(_axes(turn, sign * pitch), half_width, half_height, middle, polar)


def _axes(turn: float, pitch: float) -> Array:
    """Rows: right, up and back of an eye that turns to the right and lifts its view, degrees, in the camera's axes."""
    sin_t, cos_t = fit.sin_cos_deg(turn)
    sin_p, cos_p = fit.sin_cos_deg(pitch)
    right = (cos_t, 0.0, sin_t)
    back = (-sin_t * cos_p, -sin_p, cos_t * cos_p)
    return np.array([right, np.cross(back, right), back])


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


def _faces(eyes: Eyes) -> list[Face]:
    return faces_of_cube() if eyes.stereo is None else faces_of_turns()


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
