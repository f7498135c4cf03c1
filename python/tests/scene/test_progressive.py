"""Progressive pictures: coarse first, the last with the bytes of `render`; and the same in the viewer."""

from __future__ import annotations

import time

import numpy as np
import pytest
from lazy_fakes import Chunked, Slow, shells

import wavesplat as ws

LOOK = ws.TransferFunction([(60, 0.0), (200, 0.2)], [(0, 1.0, 0.8, 0.5)])


def _levels(n=128, kind=Chunked):
    levels = [shells(n)]
    while min(levels[-1].shape) > 8:
        side = levels[-1].shape[0] // 2
        levels.append(levels[-1].reshape(side, 2, side, 2, side, 2).astype(np.float32).mean((1, 3, 5)).astype(np.uint8))
    arrays = [kind(level, (16, 16, 16)) for level in levels]
    return arrays, ws.Volume.lazy(arrays, memory="50 MB", cache=False)


def test_levels_come_coarse_first_and_the_last_is_the_picture():
    _, volume = _levels()
    scene = ws.Scene(volume, LOOK)
    pictures = list(ws.progressive(scene, "isometric", size=(300, 240)))
    levels = [picture.report["lazy"]["levels"][0] for picture in pictures]
    assert levels == [4, 2, 0]
    assert [picture.report["is_final"] for picture in pictures] == [False, False, True]
    final = scene.render("isometric", size=(300, 240))
    assert np.array_equal(pictures[-1].rgba, final.rgba)
    errors = [float(np.abs(picture.rgba - final.rgba).mean()) for picture in pictures]
    assert errors == sorted(errors, reverse=True)
    assert errors[0] < 0.1


def test_the_first_picture_reads_little():
    arrays, volume = _levels(256)
    first = next(iter(ws.progressive(ws.Scene(volume, LOOK), "isometric", size=(500, 400))))
    assert not first.report["is_final"]
    n_read = sum(sum(array.counts.values()) * 16**3 for array in arrays[1:])
    assert not arrays[0].counts
    assert n_read < 0.05 * 256**3 * (8 / 7) * 3


def test_volumes_in_memory_come_quick_first():
    pictures = list(ws.progressive(ws.examples.ct_pelvis(), "front", size=(61, 47)))
    assert [(picture.size, picture.report["is_final"]) for picture in pictures] == [((61, 47), False), ((61, 47), True)]
    assert np.array_equal(pictures[1].rgba, ws.render(ws.examples.ct_pelvis(), camera="front", size=(61, 47)).rgba)


def test_blocks_are_shown_as_they_are_done(monkeypatch):
    monkeypatch.setattr("wavesplat._scene.drawing.progressive.SHOWN_EVERY_S", 0.0)
    volume = ws.Volume.lazy(Chunked(shells(160), (16, 16, 16)), memory="1 MB", cache=False)
    scene = ws.Scene(volume, LOOK)
    pictures = list(ws.progressive(scene, "isometric", size=(400, 300)))
    assert len(pictures) > 3
    covered = [float((picture.rgba[..., 3] > 0).mean()) for picture in pictures]
    assert covered == sorted(covered)
    assert np.array_equal(pictures[-1].rgba, scene.render("isometric", size=(400, 300)).rgba)


def test_leaving_the_loop_gives_up_at_once():
    array = Slow(shells(128), (16, 128, 128))
    array.seconds = 0.0
    volume = ws.Volume.lazy([array, Chunked(shells(32))], memory="50 MB", cache=False)
    volume.survey(0, "linear")
    array.seconds = 0.1
    for picture in ws.progressive(ws.Scene(volume, LOOK), "isometric", size=(300, 240)):
        assert not picture.report["is_final"]
        break
    # The work is cancelled when the generator ends.
    took = []
    while min(took, default=9.0) >= 1.0 and len(took) < 5:  # other processes may hold the cores
        begun = time.monotonic()
        pictures = ws.progressive(ws.Scene(volume, LOOK), "isometric", size=(300, 240))
        next(pictures)
        pictures.close()
        took.append(time.monotonic() - begun)
    assert min(took) < 1.0, took
    with pytest.raises(ws.errors.CancelledError):
        list(ws.progressive(ws.Scene(volume, LOOK), "isometric", size=(300, 240), progress=lambda _: False))


def test_the_viewer_shows_a_copy_while_moving_and_all_at_rest():
    from wavesplat._viewer.session.session import Session
    from wavesplat._viewer.session.state import ViewerState

    _, volume = _levels()
    session = Session(ViewerState.of(ws.Scene(volume, LOOK)))
    frames = []

    def confirm():
        for frame in frames.copy():
            if frame["type"] == "frame":
                client.receive({"type": "shown", "view": "3d", "frame": frame["number"]})
        time.sleep(0.02)

    try:
        client = session.connect(lambda header, _: frames.append(header))
        client.receive({"type": "view", "view": "3d", "size": [400, 300]})
        end = time.monotonic() + 20
        while not any(frame.get("at_rest") for frame in frames):
            assert time.monotonic() < end, frames
            confirm()
        assert not [frame for frame in frames if frame["type"] == "failed"]
        client.receive({"type": "patch", "seq": 1, "moving": True, "operations": [_turned(session)]})
        end = time.monotonic() + 20
        while not any(frame.get("seq") == 1 and frame["type"] == "frame" for frame in frames):
            assert time.monotonic() < end, frames
            confirm()
    finally:
        session.close()


def _turned(session):
    camera = session.state.camera.turned(20, 5)
    return {"op": "replace", "path": "/camera", "value": camera.as_json()}
