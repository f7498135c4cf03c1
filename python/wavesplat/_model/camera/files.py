"""Cameras as JSON and as objects of VTK and PyVista.

    {"version": 1, "position": [0, 500, 0], "focal_point": [0, 0, 0], "view_up": [0, 0, 1], "parallel_scale": 120}

In perspective `"view_angle": 30` instead of `parallel_scale`.
"""

from __future__ import annotations

from typing import Any

from wavesplat import _native
from wavesplat._model.camera.camera import Camera
from wavesplat._storage import json_texts
from wavesplat._system.values import described
from wavesplat.errors import ArgumentError

WHAT = "camera"
TRIPLE = ("position", "focal_point", "view_up")


def fields_of(camera: Camera) -> dict[str, Any]:
    """Fields of a camera's JSON object."""
    lens = "parallel_scale" if camera.view_angle is None else "view_angle"
    numbers: dict[str, Any] = {name: list(getattr(camera, name)) for name in TRIPLE}
    return {"version": json_texts.VERSION, **numbers, lens: getattr(camera, lens)}


def write(camera: Camera) -> str:
    """JSON text of a camera; numbers read back exactly."""
    return json_texts.write(fields_of(camera))


def parse(text: str) -> Camera:
    """The camera in a JSON text."""
    return build(json_texts.parse(text, WHAT, "position, focal_point and view_up"))


def build(document: dict[str, Any]) -> Camera:
    """The camera that an object describes."""
    _native.check_values(document, WHAT)
    *triple, scale, angle = _native.camera_fields(document)
    try:
        return Camera(*triple, parallel_scale=scale, view_angle=angle)
    except ArgumentError as error:
        raise ArgumentError(f"{WHAT}: {error}") from None


# Cameras of VTK and PyVista, read by the names of their methods, so that neither is imported.

FORMS = "a pyvista.Plotter, its camera or camera_position, or a vtkCamera"


def camera_of(source: Any, view_angle: float | None, parallel_scale: float | None) -> Camera:
    """The camera of a plotter, of a VTK camera, or of a triple (position, focal point, up)."""
    if view_angle is not None and parallel_scale is not None:
        raise ArgumentError("view_angle is perspective and parallel_scale orthographic; give one of them")
    eye = getattr(source, "camera", source)
    if hasattr(eye, "GetParallelProjection"):
        triple = (eye.GetPosition(), eye.GetFocalPoint(), eye.GetViewUp())
        if view_angle is None and parallel_scale is None:
            if eye.GetParallelProjection():
                parallel_scale = float(eye.GetParallelScale())
            elif eye.GetUseHorizontalViewAngle():
                raise ArgumentError(
                    "the angle of view of this camera is horizontal; pass view_angle=, the vertical one"
                )
            else:
                view_angle = float(eye.GetViewAngle())
    else:
        if isinstance(eye, str):
            raise ArgumentError(f"camera_position is {described(eye)}; give {FORMS}, after the plotter has set it")
        try:
            position, focal_point, view_up = (tuple(part) for part in eye)
        except (TypeError, ValueError, OverflowError):
            raise ArgumentError(f"source is {described(source)}; give {FORMS}") from None
        triple = (position, focal_point, view_up)
        if view_angle is None and parallel_scale is None:
            view_angle = _native.VIEW_ANGLE
    return Camera(*triple, view_angle=view_angle, parallel_scale=parallel_scale)
