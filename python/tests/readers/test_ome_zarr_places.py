"""Positions of levels of OME-Zarr, and messages on odd metadata."""

from __future__ import annotations

import numpy as np
import pytest
import zarr

import wavesplat as ws


def image(folder, transforms, *, unit="micrometer", shape=(8, 16, 16)):
    """An image of one spot in means of blocks; `transforms` of each level."""
    samples = np.zeros(shape, np.float32)
    samples[5, 9, 4] = 512
    group = zarr.open_group(folder / "a.zarr", mode="w")
    datasets = []
    for level, steps in enumerate(transforms):
        group.create_array(str(level), data=samples, chunks=(4, 4, 4))
        datasets.append({"path": str(level), "coordinateTransformations": steps})
        z, y, x = (n // 2 for n in samples.shape)
        samples = samples.reshape(z, 2, y, 2, x, 2).mean((1, 3, 5))
    units = unit if isinstance(unit, dict) else dict.fromkeys("zyx", unit)
    axes = [{"name": name, "type": "space", "unit": units[name]} for name in "zyx"]
    group.attrs["ome"] = {"version": "0.5", "multiscales": [{"axes": axes, "datasets": datasets}]}
    return folder / "a.zarr"


def scale(*numbers):
    return {"type": "scale", "scale": list(numbers)}


def box(volume):
    """The corners of the outermost samples' cells."""
    ends = np.array([[-0.5] * 3, np.array(volume.shape[::-1]) - 0.5])
    return ends @ volume.world_from_index[:3, :3].T + volume.world_from_index[:3, 3]


def test_levels_with_a_scale_alone_fill_the_same_box(tmp_path):
    path = image(tmp_path, [[scale(2.0 * 2**k, 0.5 * 2**k, 0.25 * 2**k)] for k in range(3)])
    levels = [ws.open(path, level=k) for k in range(3)]
    for level in levels:
        np.testing.assert_allclose(box(level), box(levels[0]))
    told = [any("means of blocks" in guess for guess in level.facts.guesses) for level in levels]
    assert told == [False, True, True]
    lazy = ws.open(path, memory="1 MB")
    assert sum("means of blocks" in guess for guess in lazy.facts.guesses) == 1
    for k, level in enumerate(levels):
        np.testing.assert_allclose(lazy.read(level=k).world_from_index, level.world_from_index)


@pytest.mark.parametrize("kind", ["translation", "affine"])
def test_levels_that_say_where_they_lie_lie_there(tmp_path, kind):
    if kind == "translation":
        coarse = [scale(2, 2, 2), {"type": "translation", "translation": [0.0, 0.0, 0.0]}]
    else:
        coarse = [{"type": "affine", "affine": [[2, 0, 0, 0], [0, 2, 0, 0], [0, 0, 2, 0]]}]
    level = ws.open(image(tmp_path, [[scale(1, 1, 1)], coarse]), level=1)
    np.testing.assert_allclose(level.world_from_index, np.diag([2, 2, 2, 1]))
    assert level.facts.guesses == ()


def test_an_unknown_unit_beside_a_known_one_is_told(tmp_path):
    path = image(tmp_path, [[scale(1, 1, 1)]], unit={"z": "furlong", "y": "micrometer", "x": "micrometer"})
    volume = ws.open(path)
    assert volume.facts.unit == "um"
    assert volume.facts.guesses == ("distances along z in um: their unit in the file, 'furlong', is unknown",)
    path = image(tmp_path, [[scale(1, 1, 1)]], unit="furlong")
    assert (ws.open(path).facts.unit, ws.open(path).facts.guesses) == ("furlong", ())
    path = image(tmp_path, [[scale(1, 1, 1)]], unit={"z": "furlong", "y": "league", "x": "league"})
    assert len(ws.open(path).facts.guesses) == 2


def test_a_negative_scale_mirrors_and_is_told(tmp_path):
    volume = ws.open(image(tmp_path, [[scale(-3, 1, 2)]]))
    np.testing.assert_allclose(volume.world_from_index, np.diag([2, 1, -3, 1]))
    assert volume.facts.guesses == ("axes z mirrored: their scale in the file is negative",)


def test_a_rotation_mirrors_nothing(tmp_path):
    """Turned by 127 degrees about x: numbers on the diagonal are negative, and handedness stays."""
    rows = [[-0.6, -0.8, 0, 1], [0.8, -0.6, 0, 2], [0, 0, 1, 3]]
    volume = ws.open(image(tmp_path, [[{"type": "affine", "affine": rows}]]))
    np.testing.assert_allclose(
        volume.world_from_index, [[1, 0, 0, 3], [0, -0.6, 0.8, 2], [0, -0.8, -0.6, 1], [0, 0, 0, 1]], atol=1e-12
    )
    assert volume.facts.guesses == ()


@pytest.mark.parametrize(
    "step",
    [
        {"type": "scale", "scale": ["1", "2", "3"]},
        scale(1, 2),
        scale(1, True, 2),
        {"type": "scale"},
        {"type": "translation", "translation": "0 0 0"},
        {"type": "affine", "affine": [[1, 0, 0], [0, 1, 0], [0, 0, 1]]},
    ],
)
def test_transformations_are_numbers(tmp_path, step):
    with pytest.raises(ws.errors.FileError, match=f"the {step['type']} of an image is .* numbers; mend it"):
        ws.open(image(tmp_path, [[step]]))
