"""Notes that a thread collects instead of warning: other threads and their filters are left alone."""

import threading
import warnings
from dataclasses import replace

import numpy as np
import pytest
import viewer_fakes

from wavesplat._looks import presets
from wavesplat._scene.opening import open_scene
from wavesplat._system.threads import collected_notes, warn
from wavesplat._viewer.opening import open_paths
from wavesplat._viewer.page_requests import questions
from wavesplat._viewer.page_requests.code import short_look
from wavesplat.errors import FileWarning


def test_notes_are_warnings_where_nobody_collects_them():
    with pytest.warns(FileWarning, match="a slice is missing") as told:
        warn("a slice is missing", FileWarning, stacklevel=1)
    assert told[0].filename == __file__


def test_notes_are_collected_in_their_order_and_blocks_inside_have_their_own():
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        with collected_notes() as outer:
            warn("first")
            with collected_notes() as inner:
                warn("second", FileWarning)
            warn("third")
    assert [str(one) for one in outer] == ["first", "third"]
    assert [type(one) for one in inner] == [FileWarning]


def in_another_thread(call):
    """Run a call in a thread of its own, and wait for it."""
    errors = []

    def run():
        try:
            call()
        except Exception as error:  # noqa: BLE001 - the caller reports it
            errors.append(error)

    thread = threading.Thread(target=run)
    thread.start()
    thread.join(60)
    assert not thread.is_alive()
    assert errors == []


@pytest.mark.filterwarnings("error::UserWarning")
def test_opening_in_a_thread_leaves_the_filters_of_others_alone(monkeypatch, tmp_path):
    np.save(tmp_path / "a.npy", np.random.default_rng(1).random((8, 8, 8), np.float32))
    seen = []
    opened = open_scene

    def slowly(*arguments, **options):
        # What the reader says is noted, and what another thread says meanwhile is that thread's.
        warn("the reader's note")
        in_another_thread(lambda: seen.append(list(warnings.filters)))
        return opened(*arguments, **options)

    monkeypatch.setattr(open_paths, "open_scene", slowly)
    before = list(warnings.filters)
    in_another_thread(lambda: seen.append(open_paths.found_at(tmp_path / "a.npy").notes[:1]))
    assert seen == [before, ("the reader's note",)]


def test_short_looks_and_presets_leave_the_filters_of_others_alone(monkeypatch):
    state = viewer_fakes.state_of()
    seen = []

    def preset(name, volume):
        warn("this is for Hounsfield units")
        seen.append(list(warnings.filters))
        return made(name, volume)

    made = presets.preset
    monkeypatch.setattr(presets, "preset", preset)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        before = list(warnings.filters)
        layer = {**state.document["layers"][0], "look": {**state.document["layers"][0]["look"], "name": "ct-bone"}}
        short_look(replace(state, document={**state.document, "layers": [layer]}), 0)
        questions.answer_of(state, "preset", {"layer": 0, "name": "ct-bone"})
    assert len(seen) >= 2
    assert all(one == before for one in seen)
