"""Fields of a frame's message: its size, place and settings. `Frame` in `web/src/engine/engine.ts` is the twin."""

from __future__ import annotations

from typing import Any

from wavesplat._picture.picture import Picture
from wavesplat._viewer.pace import Settings
from wavesplat._viewer.slice_view import geometry_of
from wavesplat._viewer.state import ViewerState

__all__ = ["frame_fields"]


def frame_fields(state: ViewerState, view: str, picture: Picture, settings: Settings) -> dict[str, Any]:
    """Size in pixels, camera or place of the slice, world units per pixel, and the settings it was drawn with."""
    return {
        "width": picture.size[0],
        "height": picture.size[1],
        **_place(state, view, picture),
        "settings": _settings(picture, settings),
    }


def _place(state: ViewerState, view: str, picture: Picture) -> dict[str, Any]:
    if view != "3d":
        geometry = geometry_of(state, view, picture)
        return {"slice": geometry, "pixel": geometry["pixel"]}
    return {"camera": state.document["camera"], "pixel": picture.report["pixel"]}


def _settings(picture: Picture, settings: Settings) -> dict[str, Any]:
    names = ("sheets_per_slice", "oversampling")
    return {
        "scale": settings.scale,
        "psnr": settings.psnr,
        **{n: picture.report[n] for n in names if n in picture.report},
    }
