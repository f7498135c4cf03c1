"""Options of slices, lightboxes and meshes that meet: each says of the whole what it says of a part."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import wavesplat as ws
from wavesplat.errors import ArgumentError

FACTS = ws.Facts(unit="mm", is_anatomical=True)
SHAPE = (24, 20, 22)
SCAN = ws.Volume(np.random.default_rng(2).integers(0, 200, SHAPE).astype(np.uint8), facts=FACTS, name="scan")


def placed(samples: Any, *, z: float = 0.0, spacing: float = 1.0, unit: str | None = "mm", name: str = "") -> ws.Volume:
    """Samples in the world of the scan."""
    matrix = np.diag([spacing] * 3 + [1.0])
    matrix[2, 3] = z
    return ws.Volume(samples, world_from_index=matrix, facts=ws.Facts(unit=unit, is_anatomical=True), name=name)


def test_a_sheet_has_the_notes_of_all_its_slices() -> None:
    coarse = ws.Labels(placed(np.ones((12, 10, 11), np.uint8), spacing=2.0))
    scene = ws.Scene(SCAN, labels=coarse)
    (note,) = ws.slice(scene, "axial", 10).report["notes"]
    assert "resampled" in note
    assert ws.lightbox(scene, "axial", [8, 10], size=(30, 30)).report["notes"] == [note]


@pytest.mark.parametrize("positions", [[5, 20], [20, 5]])
def test_a_sheet_has_the_layers_of_any_of_its_slices(positions: list[float]) -> None:
    beside = placed(np.arange(6 * 440, dtype=np.uint16).reshape(6, *SHAPE[1:]), z=17.0, name="upper")
    sheet = ws.lightbox(ws.Scene([SCAN, beside]), "axial", positions, size=(30, 30))
    assert [one["name"] for one in sheet.report["shown"]] == ["scan", "upper"]
    # A part that only some slices lack is no news.
    assert "notes" not in sheet.report


def test_labels_that_lie_on_no_slice_are_not_named() -> None:
    numbers = np.zeros(SHAPE, np.uint8)
    numbers[2:4], numbers[20:22] = 1, 2
    scene = ws.Scene(
        SCAN, labels=ws.Labels(placed(numbers), {1: ws.Label("red", name="a"), 2: ws.Label("blue", name="b")})
    )
    sheet = ws.lightbox(scene, "axial", [10, 21], size=(30, 30))
    assert [one["name"] for one in sheet.report["labels"]] == ["b"]
    none = ws.slice(scene, "axial", 10)
    assert none.report["labels"] == []
    # Other slices have the legend.
    assert none.annotated(legend=True).size == none.size


def test_contours_lie_where_labels_do() -> None:
    numbers = np.zeros(SHAPE, np.uint8)
    numbers[5:15, 6:14, 6:14] = 1
    with pytest.raises(ArgumentError, match="unit"):
        ws.slice(SCAN, "axial", 10, contours=ws.Labels(placed(numbers, unit="m")))
    with pytest.raises(ArgumentError, match="segmentation is"):
        ws.slice(SCAN, "axial", 10, contours=ws.Labels(numbers[:9]))
    of_array = ws.slice(SCAN, "axial", 10, contours=ws.Labels(numbers))
    of_place = ws.slice(SCAN, "axial", 10, contours=ws.Labels(placed(numbers)))
    np.testing.assert_array_equal(of_array.rgba, of_place.rgba)


def test_a_pattern_of_one_mask_has_the_name_of_its_file(tmp_path: Path) -> None:
    nibabel = pytest.importorskip("nibabel")
    numbers = np.zeros(SHAPE[::-1], np.uint8)
    numbers[6:14, 6:14, 5:15] = 1
    nibabel.save(nibabel.Nifti1Image(numbers, np.eye(4)), tmp_path / "liver.nii.gz")
    labels = ws.Labels.open(f"{tmp_path}/liv*.nii.gz", segments=["liver"])
    assert [look.name for look in labels.labels.values()] == ["liver"]


def test_too_many_positions_are_said_to_be_too_many() -> None:
    typer = pytest.importorskip("typer")
    from wavesplat._cli.options import parsers

    with pytest.raises(typer.BadParameter, match="1001 slices; 400 are the most"):
        parsers.positions("0:1000:1")
