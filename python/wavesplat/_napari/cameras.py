"""Cameras of napari: the same view both ways.

napari says the eye's direction and the one that points up as vectors (z, y, x) of its world, `zoom` in pixels of the
canvas for each world unit, and `perspective` as the vertical angle of view, 0 for none. It may show its world mirrored,
by `orientation`, as it does by default: z towards the eye, y down, x to the right. No camera does that, so the picture
is mirrored after it is drawn.
"""

from __future__ import annotations

from dataclasses import replace
from math import dist, radians, tan
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wavesplat._model.camera import fit
from wavesplat._model.camera.camera import Camera
from wavesplat.errors import ArgumentError

#: Orientation of axes (z, y, x) that a camera can show: z away from the eye, y down, x to the right.
UNMIRRORED = ("away", "down", "right")
#: Distance of the eye of an orthographic camera, in heights of the view; only what is before it is drawn.
FAR = 10.0
#: Size of the canvas of a viewer without a window: height and width.
NO_WINDOW = (600, 800)


def canvas_size(viewer: Any) -> tuple[int, int]:
    """Width and height of a viewer's canvas, pixels."""
    size = getattr(getattr(viewer, "canvas", None), "size", None) or getattr(viewer, "_canvas_size", None) or NO_WINDOW
    return int(size[1]), int(size[0])


def is_mirrored(viewer: Any) -> bool:
    """Whether a viewer shows its world mirrored, as napari does by default."""
    orientation = getattr(_camera(viewer), "orientation", UNMIRRORED)
    return sum(str(own) != other for own, other in zip(orientation, UNMIRRORED, strict=True)) % 2 == 1


def camera_of(viewer: Any) -> Camera:
    """The camera of a viewer of napari: the same place, direction and scale.

    Where `is_mirrored`, as napari shows its world by default, pictures of it are to be mirrored, left and right.

    Parameters
    ----------
    viewer : napari.Viewer
        Showing its last three axes in their order; a viewer in two dimensions looks along the first of them.

    Raises
    ------
    ArgumentError
        If it shows other axes.
    """
    _check_axes(viewer)
    camera, (_, height) = _camera(viewer), canvas_size(viewer)
    half_height = height / float(camera.zoom) / 2
    center = _xyz((*[0.0] * (3 - len(camera.center)), *camera.center))
    if viewer.dims.ndisplay == 2:
        # The slices that are shown: the slider gives the world's z.
        center[2] = float(viewer.dims.point[-3])
        forward, up = _flat_axes(camera)
        angle = 0.0
    else:
        forward, up = _xyz(camera.view_direction), _xyz(camera.up_direction)
        angle = float(camera.perspective)
    if angle <= 0:
        return Camera(center - 2 * FAR * half_height * forward, center, up, parallel_scale=half_height)
    distance = half_height / tan(radians(angle) / 2)
    return Camera(center - distance * forward, center, up, view_angle=angle)


def set_camera(viewer: Any, camera: Camera) -> None:
    """Show a viewer of napari from a camera: in three dimensions, the same place, direction, scale and angle of view.

    Where napari mirrors its world (`is_mirrored`), what it shows is the camera's picture, mirrored.

    Parameters
    ----------
    viewer : napari.Viewer
        Showing its last three axes in their order.
    camera : Camera
        Of `wavesplat`, of a picture (`picture.camera`), or read by `Camera.load`.

    Raises
    ------
    ArgumentError
        If the viewer shows other axes.
    """
    viewer.dims.ndisplay = 3
    _check_axes(viewer)
    _, up, back = fit.axes_of(camera)
    half_height = camera.parallel_scale
    if camera.view_angle is not None:
        half_height = dist(camera.position, camera.focal_point) * tan(radians(camera.view_angle) / 2)
    own = _camera(viewer)
    own.perspective = camera.view_angle or 0.0
    own.center = camera.focal_point[::-1]
    own.zoom = canvas_size(viewer)[1] / (2 * (half_height or 1.0))
    own.set_view_direction(tuple((-back[::-1]).tolist()), tuple(up[::-1].tolist()))


def outside(camera: Camera, bounds: NDArray[np.float64]) -> Camera:
    """An orthographic camera whose eye lies before a box of the world, so that depths are positive; others as they are.

    bounds : corners (lower, upper) of the box.
    """
    if camera.view_angle is not None:
        return camera
    back = fit.axes_of(camera)[2]
    middle = np.mean(bounds, axis=0)
    radius = float(np.linalg.norm(bounds[1] - bounds[0]))
    along = float((middle - camera.focal_point) @ back)
    return replace(camera, position=tuple(camera.focal_point + (along + radius) * back))


def _camera(viewer: Any) -> Any:
    """The viewer's own camera, which belongs to the scene of the viewer from 0.9 on."""
    scene = getattr(viewer, "scene", None)
    return viewer.camera if scene is None else scene.camera


def _flat_axes(camera: Any) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Directions forward and up of a view in two dimensions.

    Along z, so that `is_mirrored` means the same as in three dimensions.
    """
    depth, vertical, _ = (str(own) for own in getattr(camera, "orientation", UNMIRRORED))
    forward = np.array([0.0, 0.0, 1.0 if depth == "away" else -1.0])
    return forward, np.array([0.0, -1.0 if vertical == "down" else 1.0, 0.0])


def _xyz(zyx: Any) -> NDArray[np.float64]:
    return np.array([float(number) for number in zyx][::-1])


def _check_axes(viewer: Any) -> None:
    n, shown = int(viewer.dims.ndim), tuple(int(axis) for axis in viewer.dims.displayed)
    if n < 3 or shown != tuple(range(n - len(shown), n)):
        raise ArgumentError(
            f"the viewer shows axes {shown} of {n}; a camera needs the last ones of three or more, in their order: "
            "roll them back (viewer.dims.order)"
        )
