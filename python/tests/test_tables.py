"""A note where a CT shows the table that the patient lies on (improvement 9 of the trial in the clinic)."""

from __future__ import annotations

from typing import Any

import numpy as np

import wavesplat as ws


def lying(*, table: bool, modality: str = "CT") -> ws.Volume:
    """An elliptic body of water with bones in air, 4 mm samples, and a thin table below it."""
    _, y, x = np.meshgrid(*(4.0 * (np.arange(n) - n / 2) for n in (24, 80, 90)), indexing="ij")
    body = (x / 130) ** 2 + ((y - 20) / 85) ** 2 < 1
    bones = ((np.abs(x) - 60) / 20) ** 2 + ((y - 10) / 20) ** 2 < 1
    samples = np.where(bones, 700, np.where(body, 40, -1000)).astype(np.int16)
    if table:
        board = (np.abs(x) < 150) & (np.abs(y + 90 - (x / 100) ** 2 * 8) < 4.5)
        samples[board] = 150
    facts = ws.Facts(modality=modality, is_anatomical=True, unit="mm")
    return ws.Volume(samples, world_from_index=np.diag([4.0, 4, 4, 1]), facts=facts)


def notes(volume: ws.Volume, look: str | None = None, **options: Any) -> list[str]:
    """Notes on a table of a picture of the volume."""
    picture = ws.render(volume, look, size=(24, 24), **options)
    return [note for note in picture.report.get("notes", []) if "table" in note]


def test_a_table_that_shows_has_a_note() -> None:
    (note,) = notes(lying(table=True))
    assert "--remove-table" in note
    assert notes(lying(table=False)) == []


def test_no_note_where_no_table_shows() -> None:
    scan = lying(table=True)
    assert notes(ws.largest_body(scan)) == []
    assert notes(scan, composite="maximum") == []
    assert notes(scan, quality="draft") == []
    assert notes(scan, clip=ws.Crop((-150, -60, -50), (150, 120, 50))) == []
    high = ws.TransferFunction([(300, 0.0), (500, 0.8)], [(300, 1, 1, 1)])
    assert [n for n in ws.render(scan, high, size=(24, 24)).report.get("notes", []) if "table" in n] == []
