"""Facts about a frame that the page is told beside its pixels: `Frame` in `web/src/engine/engine.ts`."""

from __future__ import annotations

from typing import Any

from wavesplat._picture.picture import Picture
from wavesplat._viewer.pace import Settings
from wavesplat._viewer.slice_values import SliceValues
from wavesplat._viewer.slice_view import geometry_of
from wavesplat._viewer.state import ViewerState

__all__ = ["place_of_frame", "settings_of_frame"]


def place_of_frame(state: ViewerState, view: str, picture: Picture | SliceValues) -> dict[str, Any]:
    """Where the pixels lie in the world: the camera, or the geometry of a slice; and how its values become colours."""
    if view != "3d":
        geometry = geometry_of(state, view, picture.report)
        values = {"values": picture.header} if isinstance(picture, SliceValues) else {}
        return {"slice": geometry, "pixel": geometry["pixel"], **values}
    return {"camera": state.document["camera"], "pixel": picture.report["pixel"]}


def settings_of_frame(picture: Picture | SliceValues, settings: Settings) -> dict[str, Any]:
    """The settings that a picture was drawn with, for the page's figures."""
    names = ("sheets_per_slice", "oversampling")
    return {
        "scale": settings.scale,
        "psnr": settings.psnr,
        **{n: picture.report[n] for n in names if n in picture.report},
    }
