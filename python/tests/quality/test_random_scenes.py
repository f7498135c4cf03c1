"""Random scenes against the reference: a short run of what `make random-scenes` runs."""

import sys
from pathlib import Path

import numpy as np
import pytest

STUDIES = Path(__file__).parents[3] / "studies" / "scenes"

SEED, N, N_BY_DAY = 41, 40, 7

#: PSNR of the scenes of this seed that have less than `MIN_DB` at quality normal, and the reason.
REASONS: dict[int, tuple[float, str]] = {
    2: (26.5, "lit hard waves of five samples at one texel a pixel; 42 dB at quality high"),
}


@pytest.fixture(scope="module")
def study():
    with pytest.MonkeyPatch.context() as patch:
        patch.syspath_prepend(STUDIES)
        import random_scenes

        yield random_scenes
    for name in ("random_scenes", "generator"):
        del sys.modules[name]


@pytest.fixture(scope="module")
def found(study, is_night):
    """PSNR of each scene at quality normal and at quality high."""
    rows = []
    for number in range(N if is_night else N_BY_DAY):
        drawn = study.generator.scene(SEED, number)
        # The step is twice that of the study, to save time.
        want = drawn.cast(step=0.2)
        rows.append([study.psnr_db(drawn.draw(quality), want) for quality in ("normal", "high")])
    return np.array(rows)


def test_pictures_are_those_of_the_reference(study, found):
    normal, high = found.T
    least = [REASONS.get(number, (study.MIN_DB, ""))[0] for number in range(len(normal))]
    assert [(number, float(db)) for number, db in enumerate(normal) if db < least[number]] == []
    assert (high >= 33).all()
    assert np.quantile(high, 0.1) >= 38


def test_geometry_among_them_is_that_of_the_reference(study, is_night):
    parts = study.generator.Parts(geometry=True)
    found = []
    for number in range(16 if is_night else 3):
        drawn = study.generator.scene(SEED, number, parts)
        found.append(study.psnr_db(drawn.draw("high"), drawn.cast(step=0.2)))
    # Most pixels of so small a picture are edges of shapes.
    assert min(found) >= 32, found
    assert np.median(found) >= 40, found


def test_a_scene_is_the_same_without_one_of_its_parts(study):
    """The other parts of a scene stay the same when a part is left out, so that faults can be found part by part."""
    whole = study.generator.scene(SEED, 3)
    bare = study.generator.without(whole, labels=False, clips=False, light=False)
    assert bare.camera == whole.camera
    first, other = whole.scene.layers[0].volume, bare.scene.layers[0].volume
    np.testing.assert_array_equal(first.samples, other.samples)
    np.testing.assert_array_equal(first.world_from_index, other.world_from_index)
    assert bare.scene.shading is None
