"""Cameras of VTK and PyVista, read by the names of their methods, so that neither is imported."""

from __future__ import annotations

from typing import Any

from wavesplat._model.argument_types import described
from wavesplat._model.camera import Camera
from wavesplat.errors import ArgumentError

#: VTK's default angle of view, degrees.
VIEW_ANGLE = 30.0
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
            view_angle = VIEW_ANGLE
    return Camera(*triple, view_angle=view_angle, parallel_scale=parallel_scale)
