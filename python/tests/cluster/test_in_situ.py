"""A field that is drawn while a code writes to it: fifty steps of `changed()`, with the memory of one."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from cases_of_the_day import nightly

import wavesplat as ws

SIDE, STEPS, WARM_UP = 96, 50, 10
STATM = Path("/proc/self/statm")
#: Bytes of a page of `STATM`.
PAGE = 4096


def _grow(field: np.ndarray, step: int) -> None:
    """A step: waves whose largest value grows by a tenth, and which move."""
    k = np.arange(SIDE, dtype=np.float32)
    field[:] = 1.1**step * np.sin(k / 9 + step / 5) * np.cos(k / 7)[:, None] * np.cos(k / 8)[:, None, None]


@pytest.mark.skipif(not STATM.exists(), reason="needs Linux's count of a process's memory")
# By day with a look; `test_memory_budget.py` has looks that are chosen.
@pytest.mark.parametrize("has_look", [True, *nightly(False)])
def test_steps_take_no_memory(has_look: bool) -> None:
    field = np.zeros((SIDE,) * 3, np.float32)
    volume = ws.Volume(field, name="waves")
    look = ws.TransferFunction.from_colormap("inferno", clim=(0, 0.3), opacity=[0, 0.4]) if has_look else None
    scene = ws.Scene(volume, look, background="black")
    held = []
    for step in range(STEPS):
        _grow(field, step)
        volume.changed()
        scene.render("isometric", size=(64, 64), threads=1)
        held.append(int(STATM.read_text().split()[1]) * PAGE)
    # A copy of the samples that is kept at each step would take 40 times their bytes.
    assert max(held[WARM_UP:]) - held[WARM_UP] < 10 * field.nbytes


def test_steps_have_the_picture_of_a_new_volume() -> None:
    field = np.zeros((SIDE,) * 3, np.float32)
    volume = ws.Volume(field, name="waves")
    scene = ws.Scene(volume, background="black")
    for step in (0, 3, 40):
        _grow(field, step)
        volume.changed()
        new = ws.Scene(ws.Volume(field.copy(), name="waves"), background="black")
        expected = new.render("isometric", size=(64, 64), device="cpu")
        for threads in (1, 4):
            picture = scene.render("isometric", size=(64, 64), device="cpu", threads=threads)
            assert np.array_equal(picture.rgba, expected.rgba)
            assert picture.report["look"] == expected.report["look"]
