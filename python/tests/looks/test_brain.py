"""The preset `mr-brain`: the brain of a head, by a simple extraction (improvement 10 of the clinic)."""

from __future__ import annotations

import json
from typing import Any

import numpy as np
import pytest

import wavesplat as ws
from wavesplat._looks.body.brain import PROCESSING, brain_of
from wavesplat.errors import ArgumentError


def head(*, skull: float = 12.0, gap: int = 12, **facts: Any) -> tuple[ws.Volume, Any]:
    """A head of 2.5 mm samples: brain with grooves, skull of `skull` mm and values `gap`, skin; and the brain."""
    z, y, x = np.meshgrid(*(2.5 * (np.arange(n) - n / 2) for n in (84, 92, 76)), indexing="ij")
    radius = np.sqrt((x / 65) ** 2 + (y / 82) ** 2 + ((z - 15) / 62) ** 2)
    groove = (np.abs(np.sin(np.arctan2(y, x) * 12)) < 0.12) & (radius > 0.93)
    brain = (radius < 1) & ~groove
    outer = np.sqrt((x / (65 + skull + 8)) ** 2 + (y / (82 + skull + 8)) ** 2 + ((z - 15) / (62 + skull + 8)) ** 2) < 1
    inner = np.sqrt((x / (65 + skull)) ** 2 + (y / (82 + skull)) ** 2 + ((z - 15) / (62 + skull)) ** 2) < 1
    skin = outer & ~inner
    neck = (x**2 + (y + 10) ** 2 < 55**2) & (z < -50)
    samples = np.where(brain, 100, np.where(skin | (neck & ~inner), 120, np.where(inner, gap, 2)))
    # A nerve, and vessels: thin bridges from the brain to the skin.
    samples[(np.abs(x) < 2) & (np.abs(z - 15) < 2) & outer] = 100
    samples = samples + np.random.default_rng(1).normal(0, 3, samples.shape)
    known = {"modality": "MR", "is_anatomical": True, "unit": "mm", **facts}
    volume = ws.Volume(
        np.clip(samples, 0, 255).astype(np.uint8),
        world_from_index=np.diag([2.5, 2.5, 2.5, 1]),
        facts=ws.Facts(**known),
        name="head",
    )
    return volume, brain


def test_the_brain_is_drawn_without_skull_and_skin() -> None:
    volume, brain = head()
    found = brain_of(volume)
    assert isinstance(found, ws.Volume)
    kept = found.samples > 60
    assert (kept & brain).sum() > 0.85 * brain.sum()
    assert (kept & ~brain).sum() < 0.02 * brain.sum()
    picture = ws.render(volume, "mr-brain", "left", size=(48, 48))
    assert picture.report["processing"] == [PROCESSING]
    (note,) = [note for note in picture.report["notes"] if "brain" in note]
    assert "not for measuring" in note
    assert volume.facts.processing == ()


def test_a_head_without_its_skull_is_drawn_as_it_is() -> None:
    volume, brain = head()
    stripped = ws.Volume(
        np.where(brain, volume.samples, 0).astype(np.uint8),
        world_from_index=volume.world_from_index,
        facts=volume.facts,
    )
    assert brain_of(stripped) is stripped
    notes = ws.render(stripped, "mr-brain", size=(24, 24)).report["notes"]
    assert any("as a scan without its skull" in note for note in notes)


@pytest.mark.parametrize(
    ("volume", "why"),
    [
        pytest.param(head(gap=110)[0], "apart from the skin", id="no gap"),
        pytest.param(head(modality="CT")[0], "the file says CT", id="CT"),
        pytest.param(head(is_anatomical=False)[0], "no patient's axes", id="no patient"),
        pytest.param(
            ws.Volume(head()[0].samples[:6].copy(), spacing=(2.5, 2.5, 2.5), facts=head()[0].facts),
            "few slices",
            id="few slices",
        ),
    ],
)
def test_where_no_brain_is_found_all_is_drawn_and_a_note_says_why(volume: ws.Volume, why: str) -> None:
    found = brain_of(volume)
    assert isinstance(found, str)
    assert why in found
    picture = ws.render(volume, "mr-brain", size=(24, 24))
    (note,) = [note for note in picture.report["notes"] if "no brain" in note]
    assert why in note
    assert "mri_synthstrip" in note


def test_a_document_draws_it_again(tmp_path: Any) -> None:
    import nibabel

    volume, _ = head()
    nibabel.save(nibabel.Nifti1Image(volume.samples.T, volume.world_from_index), tmp_path / "a.nii.gz")
    picture = ws.render(ws.open(tmp_path / "a.nii.gz"), "mr-brain", "left", size=(24, 24))
    document = picture.report["scene"]
    assert document["layers"][0]["look"]["part"] == "brain"
    again = ws.Scene.from_json(json.dumps(document), tmp_path).render("left", size=(24, 24))
    np.testing.assert_array_equal(again.rgba, picture.rgba)


def test_looks_know_their_part() -> None:
    look = ws.Look.preset("mr-brain", head()[0])
    assert look.part == "brain"
    assert ws.Look.from_json(look.to_json()).part == "brain"
    with pytest.raises(ArgumentError, match="part of the look is \"liver\"|part of the look is 'liver'"):
        ws.Look(transfer_function=look.transfer_function, part="liver")  # type: ignore[arg-type]
