"""OME-TIFF: levels of detail in SubIFDs, and the places of the stage."""

from __future__ import annotations

import numpy as np
import pytest
import tifffile

import wavesplat as ws
from wavesplat.errors import ArgumentError

RNG = np.random.default_rng(3)
#: Channels of six slices, and means of blocks of 2 x 2 in each slice; the third level has an odd number of columns.
FINEST = RNG.integers(0, 4000, (2, 6, 64, 72)).astype(np.uint16)
LEVELS = [FINEST, FINEST[..., ::2, ::2], FINEST[..., ::4, ::4][..., :17]]
STAGE = {"PositionX": 34.8, "PositionY": -0.25, "PositionZ": 3.0}


def save(path, levels=LEVELS, units=("µm", "mm", "µm"), tile=(32, 32), **more):
    """Write a pyramid as raw2ometiff and QuPath do: smaller pages in SubIFDs of the finest ones."""
    n = int(np.prod(levels[0].shape[:-2]))
    plane = {name: [at] * n for name, at in STAGE.items()}
    plane |= {f"Position{axis}Unit": [unit] * n for axis, unit in zip("XYZ", units, strict=True) if unit}
    size = {f"PhysicalSize{axis}": step for axis, step in zip("XYZ", (0.2, 0.2, 0.5), strict=True)}
    metadata = {"axes": "CZYX"[-levels[0].ndim :], "Plane": plane, **size, **more}
    with tifffile.TiffWriter(path, ome=True) as file:
        file.write(levels[0], subifds=len(levels) - 1, tile=tile, compression="zlib", metadata=metadata)
        for level in levels[1:]:
            file.write(level, subfiletype=1, tile=tile, compression="zlib")
    return path


@pytest.mark.parametrize("memory", [None, "20 MB"])
@pytest.mark.parametrize("tile", [None, (32, 32)])
def test_levels_have_their_samples_and_the_box_of_the_finest(tmp_path, memory, tile):
    path = save(tmp_path / "a.ome.tif", tile=tile)
    for number, level in enumerate(LEVELS):
        volume = ws.open(path, channel=1, level=number, memory=memory)
        np.testing.assert_array_equal(np.asarray(volume), level[1])
        assert volume.facts.levels == ((6, 64, 72), (6, 32, 36), (6, 16, 17))
        # The outermost edges of the samples, half a step beyond their centres.
        half = np.array(volume.spacing) / 2
        np.testing.assert_allclose(volume.bounds[0] - half, (34.7, -250.1, 2.75), rtol=1e-9)
        np.testing.assert_allclose(volume.bounds[1] + half, (34.7 + 14.4, -250.1 + 12.8, 5.75), rtol=1e-9)
    with pytest.raises(ArgumentError, match=r"level=3, but there are 3 levels, 0\.\.2"):
        ws.open(path, channel=1, level=3, memory=memory)


def test_a_lazy_pyramid_is_drawn_from_the_level_that_the_picture_needs(tmp_path):
    path = save(tmp_path / "a.ome.tif", [level[0] for level in LEVELS])
    lazy = ws.open(path, memory="20 MB")
    assert lazy.levels == lazy.facts.levels
    np.testing.assert_array_equal(lazy.read(level=2).samples, LEVELS[2][0])
    report = ws.render(lazy, "grey", "xy", size=(20, 16)).report
    assert report["lazy"]["levels"][0] > 0


def test_info_lists_the_levels_and_opens_one(tmp_path, wavesplat):
    path = save(tmp_path / "a.ome.tif")
    answer = wavesplat("info", path)
    assert "levels       72 x 64 x 6, 36 x 32 x 6, 17 x 16 x 6" in answer.stdout
    assert "samples      17 x 16 x 6" in wavesplat("info", path, "--level", "2").stdout


def test_tiles_of_a_scan_lie_beside_each_other(tmp_path):
    """All stacks began at (0, 0, 0), so that tiles lay on one another."""
    whole = RNG.integers(0, 4000, (4, 20, 24)).astype(np.uint16)
    for number, x in enumerate((0, 12)):
        metadata = {"axes": "ZYX", "PhysicalSizeX": 0.5, "PhysicalSizeY": 0.5, "PhysicalSizeZ": 1.0}
        metadata["Plane"] = {"PositionX": [1000 + x * 500.0] * 4, "PositionXUnit": ["nm"] * 4}
        tifffile.imwrite(tmp_path / f"{number}.ome.tif", whole[..., x : x + 12], metadata=metadata, ome=True)
    left, right = (ws.open(tmp_path / f"{number}.ome.tif") for number in (0, 1))
    np.testing.assert_allclose(left.bounds[0], (1, 0, 0))
    np.testing.assert_allclose(right.bounds[0] - left.bounds[0], (6, 0, 0))
    assert left.guesses == ()
    assert any("the stage" in one for one in left.facts.conventions)


def test_a_stage_of_unknown_unit_places_nothing(tmp_path):
    """The standard's default is a reference frame, whose unit has no size."""
    path = save(tmp_path / "a.ome.tif", units=(None, "reference frame", "pixel"))
    volume = ws.open(path, channel=0)
    np.testing.assert_allclose(volume.bounds[0], (0, 0, 0))
    assert volume.facts.conventions == ()


def test_a_segmentation_without_a_place_lies_on_its_stack(tmp_path):
    """Programs that segment write distances, and forget the stage."""
    stack = ws.open(save(tmp_path / "a.ome.tif"), channel=0)
    cells = np.zeros(stack.shape, np.uint8)
    cells[2:4, 10:40, 10:50] = 1
    ws.Volume(cells, spacing=stack.spacing, unit="um").save(tmp_path / "cells.ome.tif")
    labels = ws.Labels.open(tmp_path / "cells.ome.tif").on_samples_of(stack)
    np.testing.assert_array_equal(np.asarray(labels.segmentation), cells)
    assert any("says nothing of its place" in note for note in labels.notes)
