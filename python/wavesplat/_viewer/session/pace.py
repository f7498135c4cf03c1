"""Pace of frames: how well they are drawn while something moves, their progress at rest, and what is sent of them.

Settings stand in a row, from the best to the cheapest: as at rest, then a wanted PSNR from 45 to 30 dB, then fewer
pixels. Frames that take longer than the budget move to cheaper ones at once; five that take less than 80 % of it move
back, where what was measured there fits; the gap keeps frames from alternating between two settings. What is learnt is
kept for each look; a new one begins with the cheapest settings that have all pixels, since frames that take too long
are seen at once.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Hashable
from dataclasses import dataclass, field
from typing import Any

from wavesplat._picture.picture import Picture
from wavesplat._viewer.session.state import ViewerState
from wavesplat._viewer.slices.slice_values import SliceValues
from wavesplat._viewer.slices.slice_view import geometry_of

# Progress of a picture at rest, for the ring that the page shows in the corner of its view.

#: Seconds without a word, since most pictures are done by then; and seconds between two messages.
SILENT_S, EVERY_S = 0.3, 0.1


class Refining:
    """Messages with the share of a picture that is done, which never falls; none of pictures that are quick.

    send : sends a message to the page.
    view : name of the view.
    is_long : whether the picture is known to take long, so that the first message goes at once.
    """

    def __init__(self, send: Callable[[dict[str, Any]], object], view: str, *, is_long: bool) -> None:
        self._send, self._view = send, view
        self._next_s = time.monotonic() + SILENT_S
        self._part: float | None = None
        if is_long:
            self._report(0.0)

    def advance(self, part: float) -> None:
        """Report the share that is done, 0 to 1, if it is time to."""
        if time.monotonic() >= self._next_s and part > (self._part or 0.0):
            self._report(min(part, 1.0))

    def end(self) -> None:
        """Report that nothing is drawn any more, after other messages."""
        if self._part is not None:
            self._part = None
            self._report(None)

    def _report(self, part: float | None) -> None:
        self._part, self._next_s = part, time.monotonic() + EVERY_S
        self._send({"type": "progress", "id": None, "view": self._view, "part": part, "text": ""})


# Choice of how well frames are drawn while something moves, so that they come in time.


@dataclass(frozen=True)
class Settings:
    """Settings of a frame; `psnr` None is as at rest, `scale` a share of the view's width and height."""

    psnr: float | None
    scale: float = 1.0


#: Milliseconds to draw a frame: for 30 frames a second, less what the line and the page take; and for 15.
BUDGETS_MS = {"smooth": 28.0, "balanced": 60.0}
RUNGS = {
    "smooth": (
        Settings(None),
        Settings(45.0),
        Settings(42.0),
        Settings(39.0),
        Settings(36.0),
        Settings(33.0),
        Settings(30.0),
        Settings(30.0, 0.75),
        Settings(30.0, 0.5),
        # For machines that are weak or busy: a quarter of the width and height, so that a drag can still be followed.
        Settings(30.0, 0.25),
    ),
    "balanced": (Settings(None), Settings(45.0), Settings(42.0), Settings(39.0), Settings(36.0)),
    "exact": (Settings(None),),
}
#: Settings of slices, which have no wanted PSNR.
SLICE_RUNGS = (Settings(None), Settings(None, 0.75), Settings(None, 0.5), Settings(None, 0.25))
#: Number of frames below this share of the budget after which better settings are tried.
QUICK_FRAMES, QUICK_SHARE = 5, 0.8
#: Largest number of looks that are remembered; and factor by which a measured time shrinks with each frame of other
#: settings, so that these settings are tried again.
MAX_LOOKS, FORGOTTEN = 64, 0.97


def rungs_of(moving: str, *, is_slice: bool) -> tuple[Settings, ...]:
    """The settings that may be used, from the best; `moving` is the field of the state."""
    return (SLICE_RUNGS if moving != "exact" else SLICE_RUNGS[:1]) if is_slice else RUNGS[moving]


@dataclass
class _Learnt:
    place: int
    n_quick: int = 0
    #: Milliseconds per pixel of the view, by settings.
    ms_per_px: dict[Settings, float] = field(default_factory=dict)


class Pace:
    """Measured times of frames, by look, and the settings that they allow."""

    def __init__(self) -> None:
        self._looks: dict[Hashable, _Learnt] = {}
        self._last: _Learnt | None = None

    def chosen(self, look: Hashable, rungs: tuple[Settings, ...]) -> Settings:
        """The settings of the next frame of a look."""
        return rungs[min(self._learnt(look, rungs).place, len(rungs) - 1)]

    def record(
        self, look: Hashable, rungs: tuple[Settings, ...], settings: Settings, *, ms: float, n_px: int, budget_ms: float
    ) -> None:
        """Record the time of a frame with these settings; `n_px`: pixels of the whole view."""
        learnt = self._learnt(look, rungs)
        if settings not in rungs:
            return
        place = rungs.index(settings)
        before = learnt.ms_per_px.get(settings)
        learnt.ms_per_px[settings] = ms / n_px if before is None else 0.5 * (before + ms / n_px)
        for other in rungs:
            if other != settings and other in learnt.ms_per_px:
                learnt.ms_per_px[other] *= FORGOTTEN
        if ms > budget_ms and (learnt.ms_per_px[settings] * n_px > budget_ms or ms > 2 * budget_ms):
            learnt.n_quick = 0
            learnt.place = min(place + 1, len(rungs) - 1)
        elif ms < QUICK_SHARE * budget_ms:
            learnt.n_quick += 1
            if learnt.n_quick >= QUICK_FRAMES and place > 0:
                learnt.n_quick = 0
                known = learnt.ms_per_px.get(rungs[place - 1])
                if known is None or known * n_px <= budget_ms:
                    learnt.place = place - 1
        else:
            learnt.n_quick = 0

    def expected_ms(self, look: Hashable, settings: Settings, n_px: int) -> float | None:
        """Expected time of a frame; None if it is unknown."""
        learnt = self._looks.get(look)
        per_px = None if learnt is None else learnt.ms_per_px.get(settings)
        return None if per_px is None else per_px * n_px

    def _learnt(self, look: Hashable, rungs: tuple[Settings, ...]) -> _Learnt:
        learnt = self._looks.get(look)
        if learnt is None:
            if len(self._looks) >= MAX_LOOKS:
                self._looks.pop(next(iter(self._looks)))
            whole = [n for n, one in enumerate(rungs) if one.scale == 1 and one.psnr is not None]
            learnt = self._looks[look] = _Learnt(whole[-1] if whole else 0)
        return learnt


# Fields of a frame's message that come from its picture; `Frame` in `web/src/engine/engine.ts` is the twin.


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
