"""Statistics of regions and labels that the viewer measures."""

import numpy as np
import pytest
import viewer_fakes

import wavesplat as ws
from wavesplat._viewer.page_requests import questions
from wavesplat._viewer.session.state import ViewerState
from wavesplat.errors import ArgumentError


def ramp_state(**more):
    """A scan whose values are x of the world, mm; voxels of 2 x 1 x 1 mm."""
    samples = np.broadcast_to(np.arange(20, dtype=np.float32) * 2, (10, 16, 20))
    volume = ws.Volume(samples, spacing=(2, 1, 1))
    return ViewerState.of(ws.Scene(volume, "grey", **more), "xy")


def region(state, points):
    return questions.answer_of(state, "region", {"points": points})[0]["layers"][0]


def test_the_mean_of_a_region_is_that_of_its_middle_on_a_ramp():
    told = region(ramp_state(), [[4, 3, 5], [16, 3, 5], [16, 9, 5], [4, 9, 5]])
    assert told["mean"] == pytest.approx(10, abs=0.05)
    # Of values spread evenly over 12.
    assert told["sd"] == pytest.approx(12 / np.sqrt(12), rel=0.01)
    assert told["min"] == pytest.approx(4, abs=0.05)
    assert told["max"] == pytest.approx(16, abs=0.05)


def test_a_region_may_be_tilted_and_of_any_outline():
    triangle = [[4, 3, 2], [16, 3, 2], [10, 9, 8]]
    assert region(ramp_state(), triangle)["mean"] == pytest.approx(10, abs=0.05)
    # The order round the region makes no difference.
    assert region(ramp_state(), triangle[::-1])["mean"] == pytest.approx(10, abs=0.05)


def test_a_region_beside_the_volume_has_no_values():
    assert region(ramp_state(), [[400, 0, 0], [410, 0, 0], [400, 10, 0]]) is None


@pytest.mark.parametrize("points", [[[0, 0, 0], [1, 1, 1], [2, 2, 2]], [[0, 0, 0], [1, 1, 1]], 5, [[0, 0]] * 3])
def test_what_is_no_region_is_refused(points):
    with pytest.raises(ArgumentError, match="line|points|point"):
        questions.answer_of(ramp_state(), "region", {"points": points})


def test_labels_have_volumes_and_values():
    marks = np.zeros((10, 16, 20), np.uint8)
    marks[2:4, 3:6, 5:9] = 1
    marks[8, 8, 8] = 7
    state = ramp_state(labels=ws.Labels(marks, {1: ws.Label("red", name="liver"), 7: ws.Label("blue", name="cyst")}))
    told, _ = questions.answer_of(state, "label_statistics", {})
    liver, cyst = told["labels"]
    assert (liver["name"], liver["number"], liver["n_voxels"]) == ("liver", 1, 24)
    assert liver["volume"] == pytest.approx(48)
    assert (liver["mean"], liver["min"], liver["max"]) == pytest.approx((13, 10, 16))
    assert liver["sd"] == pytest.approx(np.std([10, 12, 14, 16]))
    assert (cyst["name"], cyst["n_voxels"], cyst["mean"], cyst["sd"]) == ("cyst", 1, 16, 0)


def test_without_labels_there_is_nothing_to_measure():
    with pytest.raises(ArgumentError, match="--labels"):
        questions.answer_of(viewer_fakes.state_of(), "label_statistics", {})
