"""Fields of a frame's message that come from its picture; `Frame` in `web/src/engine/engine.ts` is the twin."""

from __future__ import annotations

from typing import Any

from wavesplat._picture.picture import Picture
from wavesplat._viewer.pace import Settings
from wavesplat._viewer.slice_values import SliceValues
from wavesplat._viewer.slice_view import geometry_of
from wavesplat._viewer.state import ViewerState


def frame_fields(
    state: ViewerState, view: str, picture: Picture | SliceValues, settings: Settings, *, at_rest: bool
) -> dict[str, Any]:
    """Size in pixels, place in the world, settings, expected PSNR while moving, notes of pictures at rest."""
    return {
        "width": picture.size[0],
        "height": picture.size[1],
        **_place(state, view, picture),
        "settings": _settings(picture, settings),
        "expected_psnr_db": None if at_rest else picture.report.get("expected_psnr_db"),
        "notes": list(picture.report.get("notes", [])) if at_rest else [],
    }


def _place(state: ViewerState, view: str, picture: Picture | SliceValues) -> dict[str, Any]:
    """Where the pixels lie in the world: the camera, or the geometry of a slice; and how its values become colours."""
    if view != "3d":
        geometry = geometry_of(state, view, picture.report)
        values = {"values": picture.header} if isinstance(picture, SliceValues) else {}
        return {"slice": geometry, "pixel": geometry["pixel"], **values}
    return {"camera": state.document["camera"], "pixel": picture.report["pixel"]}


def _settings(picture: Picture | SliceValues, settings: Settings) -> dict[str, Any]:
    """The settings that a picture was drawn with, for the page's figures."""
    names = ("sheets_per_slice", "oversampling")
    return {
        "scale": settings.scale,
        "psnr": settings.psnr,
        **{n: picture.report[n] for n in names if n in picture.report},
    }
