"""Segmentations that are opened alone: their regions are labels that the page can list, and the picture is the same."""

from __future__ import annotations

import numpy as np

import wavesplat as ws
from wavesplat._viewer.session.state import ViewerState, with_labels_apart


def _regions() -> ws.Volume:
    samples = np.zeros((24, 24, 24), np.uint8)
    samples[3:10, 3:20, 3:20] = 1
    samples[13:21, 3:12, 3:20] = 2
    samples[13:21, 14:21, 3:20] = 3
    return ws.Volume(samples)


def test_regions_of_a_segmentation_alone_are_labels_and_the_picture_stays():
    scene = ws.Scene(_regions(), background="black")
    state = ViewerState.of(scene)
    assert sorted(state.document["labels"]["labels"]) == ["1", "2", "3"]
    size = (48, 36)
    shown = np.asarray(state.scene.render(state.camera, size=size, **state.options))
    assert shown.any()
    np.testing.assert_array_equal(shown, np.asarray(scene.render(state.camera, size=size, **state.options)))


def test_scenes_with_labels_of_their_own_several_layers_or_no_labels_stay():
    labelled = ws.Scene(_regions(), labels=ws.Labels(_regions()))
    several = ws.Scene([ws.Layer(_regions()), ws.Layer(_regions())])
    scan = ws.Scene(ws.Volume(np.random.default_rng(0).normal(size=(12, 12, 12)).astype(np.float32)))
    for scene in (labelled, several, scan):
        assert with_labels_apart(scene) is scene
