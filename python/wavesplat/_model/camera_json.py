"""Cameras as JSON: one object, with a version, whose errors name the field.

    {"version": 1, "position": [0, 500, 0], "focal_point": [0, 0, 0], "view_up": [0, 0, 1], "parallel_scale": 120}

In perspective `"view_angle": 30` instead of `parallel_scale`.
"""

from __future__ import annotations

from typing import Any

from wavesplat._files import json_object, json_text
from wavesplat._files.values import is_point
from wavesplat._model.argument_types import described
from wavesplat._model.camera import Camera
from wavesplat.errors import ArgumentError

__all__ = ["build", "fields_of", "parse", "write"]

WHAT = "camera"
TRIPLE = ("position", "focal_point", "view_up")
LENSES = ("parallel_scale", "view_angle")


def fields_of(camera: Camera) -> dict[str, Any]:
    """Fields of a camera's JSON object."""
    lens = "parallel_scale" if camera.view_angle is None else "view_angle"
    numbers: dict[str, Any] = {name: list(getattr(camera, name)) for name in TRIPLE}
    return {"version": json_object.VERSION, **numbers, lens: getattr(camera, lens)}


def write(camera: Camera) -> str:
    """JSON text of a camera; numbers read back exactly."""
    return json_object.write(fields_of(camera))


def parse(text: str) -> Camera:
    """The camera in a JSON text."""
    return build(json_object.parse(text, WHAT, "position, focal_point and view_up"))


def build(document: dict[str, Any]) -> Camera:
    """The camera that an object describes."""
    json_text.check_values(document, WHAT)
    known = {"version", *TRIPLE, *LENSES}
    json_object.check_fields(document, WHAT, needed=("version", *TRIPLE), known=known, hint="Camera.as_json")
    for name in TRIPLE:
        given = document[name]
        if not is_point(given):
            raise ArgumentError(f"{WHAT}: field {name!r} is {described(given)}; it must be three numbers, [x, y, z]")
    scale, angle = (json_object.optional_number(document, WHAT, name) for name in LENSES)
    if (scale is None) == (angle is None):
        raise ArgumentError(f"{WHAT}: give one of the fields 'parallel_scale' and 'view_angle'")
    try:
        return Camera(*(document[name] for name in TRIPLE), parallel_scale=scale, view_angle=angle)
    except ArgumentError as error:
        raise ArgumentError(f"{WHAT}: {error}") from None
