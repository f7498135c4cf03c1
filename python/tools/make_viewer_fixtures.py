"""Write the fixtures of the viewer's page to `web/schema`: cameras and what is done to them, and a state.

The page turns freely about the up direction of the picture, and upright about +z, as `Camera.turned` does: both are one
where up is +z.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np

import wavesplat as ws
from wavesplat._viewer.session.state import ViewerState

SCHEMA = Path(__file__).resolve().parents[2] / "web" / "schema"
#: An up vector at right angles to the line of sight, as the page's cameras have it after the first turn.
UP = tuple(np.cross(np.cross((27, -76, 40), (0.2, 0.1, 1)), (27, -76, 40)).tolist())
CAMERAS = (
    ws.Camera((0, 100, 0), (0, 0, 0), (0, 0, 1), parallel_scale=50),
    ws.Camera((30, -80, 45), (3, -4, 5), UP, parallel_scale=12.5),
    ws.Camera((30, -80, 45), (3, -4, 5), UP, view_angle=28),
)


def fixtures() -> list[dict[str, Any]]:
    """Cameras, steps from them, and places in their pictures."""
    return [_fixture(camera) for camera in CAMERAS]


def texts() -> dict[str, str]:
    """The texts of the files by their names."""
    state = ViewerState.of(ws.Scene(ws.examples.ripples(16), "grey"), CAMERAS[0]).document
    return {
        "cameras.json": json.dumps(fixtures(), indent=1) + "\n",
        "state.json": json.dumps(state, indent=1) + "\n",
    }


def _fixture(camera: ws.Camera) -> dict[str, Any]:
    # A pixel of a drag is a degree of turn where the view is 180 pixels high.
    upright = (10, -35) if camera.view_up == (0, 0, 1) else ()
    steps = [{"what": "turned", "numbers": [dx, 0], "camera": camera.turned(azimuth=-dx).as_json()} for dx in upright]
    steps += [
        {"what": "turned", "numbers": [0, dy], "camera": camera.turned(elevation=dy).as_json()} for dy in (12, -7)
    ]
    steps += [
        {"what": "upright", "numbers": [dx, dy], "camera": camera.turned(azimuth=-dx, elevation=dy).as_json()}
        for dx, dy in ((25, 14), (-100, -50))
    ]
    steps += [
        {"what": "rolled", "numbers": [angle], "camera": camera.turned(roll=angle).as_json()} for angle in (15, -40)
    ]
    if camera.view_angle is None:
        steps.append({"what": "zoomed", "numbers": [1.5], "camera": camera.zoomed(1.5).as_json()})
    points = [[1, 2, 3], [-7, 5, 11], [3, -4, 5]]
    return {
        "camera": camera.as_json(),
        "steps": steps,
        "points": [{"size": [320, 200], "point": point, "place": _place(camera, point, 320, 200)} for point in points],
    }


def _place(camera: ws.Camera, point: list[float], width: int, height: int) -> list[float]:
    """Position of a point in the picture: pixels from the top left corner."""
    back = np.subtract(camera.position, camera.focal_point)
    back = back / np.linalg.norm(back)
    right = np.cross(camera.view_up, back)
    right /= np.linalg.norm(right)
    up = np.cross(back, right)
    away = np.subtract(point, camera.position)
    if camera.view_angle is None:
        pixel = 2 * camera.parallel_scale / height
    else:
        pixel = 2 * -(away @ back) * np.tan(np.radians(camera.view_angle) / 2) / height
    return [float(width / 2 + away @ right / pixel), float(height / 2 - away @ up / pixel)]


if __name__ == "__main__":
    for name, text in texts().items():
        (SCHEMA / name).write_text(text, encoding="utf-8")
