"""Links and commands are short: looks by the name of a preset or a colour map, options where they say the same."""

import json
import shlex
import subprocess
import sys
import zlib
from dataclasses import replace

import numpy as np
import pytest
import tifffile
import viewer_fakes
from cases_of_the_day import nightly
from PIL import Image

import wavesplat as ws
from wavesplat._scene.documents import scene_json
from wavesplat._viewer.page_requests import code, questions
from wavesplat._viewer.page_requests.code import short_document, short_look
from wavesplat._viewer.session.picturing import picture_of
from wavesplat._viewer.session.state import ViewerState
from wavesplat.errors import ArgumentError

SIZE = (96, 72)


def turned(state):
    camera = state.camera.turned(azimuth=33.3, elevation=7)
    return state.patched([{"op": "replace", "path": "/camera", "value": camera.as_json()}])


def link_of(state):
    return questions.answer_of(state, "code", {"as": "link", "width": 1, "height": 1})[0]["text"]


@pytest.fixture
def scans(tmp_path, monkeypatch):
    """A CT with a PET over it, as files in the working folder."""
    monkeypatch.chdir(tmp_path)
    scan = ws.examples.ct_pelvis()
    scan.save(tmp_path / "ct.nrrd")
    places = np.indices(scan.shape) - np.array(scan.shape).reshape(3, 1, 1, 1) / 2
    uptake = 10 * np.exp(-(places**2).sum(axis=0) / 150)
    pet = ws.Volume(uptake.astype("float32"), world_from_index=scan.world_from_index, anatomical=True)
    pet.save(tmp_path / "pet.nrrd")
    return tmp_path


def with_pet(look="ct-bone", window=(2, 8)):
    pet = ws.Layer.overlay(ws.open("pet.nrrd"), "hot", window)
    return turned(ViewerState.of(ws.Scene([ws.Layer(ws.open("ct.nrrd"), look), pet])))


@pytest.mark.parametrize(
    ("look", "window"),
    [
        ("auto", (2.5, 8)),
        # By day each state of the tests below has the preset.
        pytest.param("ct-bone", (2, 8), marks=pytest.mark.nightly),
        pytest.param("ct-bone", None, marks=pytest.mark.nightly),
    ],
)
def test_ct_and_pet_have_a_short_command_that_draws_the_same_pixels(scans, look, window):
    state = with_pet(look, window)
    command = code.command_of(state, SIZE)
    assert len(command.replace(f"{scans}/", "")) < 400
    assert command.startswith("wavesplat render ")
    text = command.replace("wavesplat ", f"{shlex.quote(sys.executable)} -m wavesplat ", 1)
    done = subprocess.run(["sh", "-c", text], cwd=scans, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    drawn = np.asarray(Image.open(scans / "CT.png").convert("RGBA"))
    assert np.array_equal(drawn, np.asarray(picture_of(state, "3d", SIZE)))


def test_ct_and_pet_have_a_short_link_that_gives_the_state_again(scans):
    state = with_pet()
    text = link_of(state)
    assert len(zlib.compress(text.encode())) * 4 / 3 < 4000
    assert str(scans) not in text
    back = questions.state_from_text(state, json.dumps(json.loads(text)["state"]))
    assert back.document == state.document


@pytest.mark.parametrize(("background", "threshold"), [("black", None), ("white", 3.0)])
def test_looks_of_the_command_line_are_short_in_links_and_commands(scans, background, threshold):
    scan, over = ws.open("ct.nrrd"), ws.Layer.overlay(ws.open("pet.nrrd"), "hot", (2, 8), threshold=threshold)
    # As `wavesplat view` makes it: the background of the scene is given.
    state = ViewerState.of(ws.Scene([ws.Layer(scan, "auto"), over], background=background))
    assert {layer["look"]["background"] for layer in state.document["layers"]} == {background}
    text = link_of(state)
    assert len(zlib.compress(text.encode())) * 4 / 3 < 4000
    back = questions.state_from_text(state, json.dumps(json.loads(text)["state"]))
    assert back.document == state.document
    command, movie = (code.command_of(state, SIZE), code.movie_command_of(state, SIZE))
    assert max(len(one.replace(f"{scans}/", "")) for one in (command, movie)) < 500
    text = command.replace("wavesplat ", f"{shlex.quote(sys.executable)} -m wavesplat ", 1)
    assert subprocess.run(["sh", "-c", text], cwd=scans, capture_output=True, check=False).returncode == 0
    drawn = np.asarray(Image.open(scans / "CT.png").convert("RGBA"))
    assert np.array_equal(drawn, np.asarray(picture_of(state, "3d", SIZE)))


def test_channels_have_a_short_command_that_draws_the_same_pixels(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    z, y, x = np.mgrid[:12, :12, :12]
    blobs = np.stack([1000 * np.exp(-((x - c) ** 2 + (y - 6) ** 2 + (z - 6) ** 2) / 9) for c in (4, 8)])
    names = {"axes": "CZYX", "Channel": {"Name": ["DAPI", "GFP"]}}
    tifffile.imwrite("cells.ome.tif", blobs.astype("uint16"), ome=True, metadata=names)
    for channels, said in (
        (None, "--channel 0 --channel 1 "),
        ([1, (0, None, (100, 700))], "--channel 1 --channel 0:100,700 "),
    ):
        state = ViewerState.of(ws.open_scene("cells.ome.tif", channels=channels).with_(background="black"))
        command = code.command_of(turned(state), SIZE)
        assert f"cells.ome.tif {said}--size 96x72 " in command
        text = command.replace("wavesplat ", f"{shlex.quote(sys.executable)} -m wavesplat ", 1)
        assert subprocess.run(["sh", "-c", text], capture_output=True, check=False).returncode == 0
        drawn = np.asarray(Image.open(command.split()[-1]).convert("RGBA"))
        assert np.array_equal(drawn, np.asarray(picture_of(turned(state), "3d", SIZE)))
    named = state.patched([{"op": "replace", "path": "/layers/1/name", "value": "nuclei"}])
    assert " --from - " in code.command_of(named, SIZE)


def test_a_threshold_is_short_in_commands_and_a_gamma_in_links(scans):
    def changed(state, **wanted):
        told = questions.answer_of(state, "layer_change", {"layer": 1, **wanted})[0]
        return state.patched(told["operations"])

    state = changed(with_pet(), threshold=2)
    assert "pet.nrrd:hot:2,8:threshold=2 " in code.command_of(state, SIZE)
    for one in (state, changed(state, gamma=0.5)):
        text = link_of(one)
        assert len(zlib.compress(text.encode())) * 4 / 3 < 4000
        back = questions.state_from_text(one, json.dumps(json.loads(text)["state"]))
        assert back.document == one.document


def test_the_command_of_a_movie_turns_what_is_seen(scans):
    told, _ = questions.answer_of(with_pet(), "code", {"as": "movie", "width": 65, "height": 48})
    text = told["text"].replace("wavesplat ", f"{shlex.quote(sys.executable)} -m wavesplat ", 1)
    text = text.replace("CT.mp4", "'%02d.png' --turn 2")
    done = subprocess.run(["sh", "-c", text], cwd=scans, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    first, second = (np.asarray(Image.open(scans / f"{n:02}.png").convert("RGB")) for n in (0, 1))
    assert first.shape == (48, 64, 3)
    assert first.any()
    assert not np.array_equal(first, second)
    named = with_pet().patched([{"op": "replace", "path": "/layers/1/name", "value": "uptake"}])
    with pytest.raises(ArgumentError, match="copy as Python"):
        questions.answer_of(named, "code", {"as": "movie", "width": 65, "height": 48})


@pytest.mark.parametrize(
    "operation",
    [
        {"op": "replace", "path": "/layers/0/look/shading/ambient", "value": 0.4},
        {"op": "add", "path": "/clip/-", "value": {"plane": {"point": [0, 150, 250], "normal": [0, 1, 0]}}},
        {"op": "replace", "path": "/layers/1/name", "value": "uptake"},
        # By day another number of a layer, of a curve, and a field of the whole scene.
        *nightly(
            {"op": "replace", "path": "/layers/0/opacity", "value": 0.5},
            {"op": "replace", "path": "/layers/1/look/transfer_function/opacity/0/1", "value": 0.1},
            {"op": "replace", "path": "/background", "value": [0.1, 0.2, 0.3]},
        ),
    ],
    ids=lambda operation: operation["path"],
)
def test_what_options_do_not_say_goes_into_a_document(scans, operation):
    state = with_pet().patched([operation])
    command = code.command_of(state, SIZE)
    assert " --from - " in command
    document = scene_json.parse(command[command.index("{") : command.rindex("END")], scans)
    drawn = document.scene.render(document.camera, **document.options)
    assert np.array_equal(np.asarray(drawn), np.asarray(picture_of(state, "3d", SIZE)))
    back = questions.state_from_text(with_pet(), json.dumps(json.loads(link_of(state))["state"]))
    assert back.document == state.document


@pytest.mark.parametrize(
    ("path", "value", "option"),
    [
        ("/background", "#203040", "--background '#203040'"),
        pytest.param("/render/quality", "draft", "--quality draft", marks=pytest.mark.nightly),
        pytest.param("/render/kernel", "bspline2", "--kernel bspline2", marks=pytest.mark.nightly),
        ("/render/composite", "maximum", "--composite maximum"),
    ],
)
def test_settings_that_differ_are_options(scans, path, value, option):
    state = with_pet().patched([{"op": "replace", "path": path, "value": value}])
    command = code.command_of(state, SIZE)
    assert option in command
    text = command.replace("wavesplat ", f"{shlex.quote(sys.executable)} -m wavesplat ", 1)
    assert subprocess.run(["sh", "-c", text], cwd=scans, capture_output=True, check=False).returncode == 0
    drawn = np.asarray(Image.open(scans / "CT.png").convert("RGBA"))
    assert np.array_equal(drawn, np.asarray(picture_of(state, "3d", SIZE)))


@pytest.mark.parametrize("name", ["it's", "a:b", *nightly("a b")])
def test_names_of_files_that_options_could_mistake_are_quoted_or_left_to_the_document(scans, name):
    (scans / "pet.nrrd").rename(scans / f"{name}.nrrd")
    pet = ws.Layer.overlay(ws.open(scans / f"{name}.nrrd"), "hot", (2, 8))
    state = ViewerState.of(ws.Scene([ws.Layer(ws.open("ct.nrrd"), "ct-bone"), pet]))
    command = code.command_of(state, SIZE)
    assert ("--from" in command) == (":" in name)
    text = command.replace("wavesplat ", f"{shlex.quote(sys.executable)} -m wavesplat ", 1)
    done = subprocess.run(["sh", "-c", text], cwd=scans, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    drawn = np.asarray(Image.open(scans / "CT.png").convert("RGBA"))
    assert np.array_equal(drawn, np.asarray(picture_of(state, "3d", SIZE)))


def test_short_forms_name_maps_and_presets():
    volume = viewer_fakes.ball()
    scene = ws.Scene([ws.Layer(volume, "grey"), ws.Layer.overlay(volume, "viridis", (20, 200))])
    state = ViewerState.of(scene)
    assert short_look(state, 1) == {"map": "viridis", "window": [20.0, 200.0]}
    assert short_document(state, state.document)["layers"][1] == {
        "volume": {"path": None, "name": "ball", "id": 1},
        "look": {"map": "viridis", "window": [20.0, 200.0]},
    }


@pytest.mark.parametrize(
    ("look", "told"),
    [
        ({"map": 3}, "field 'map' is 3"),
        ({"map": "no-such-map"}, "no-such-map"),
        ({"map": "hot", "window": 3}, "field 'window' is 3"),
        ({"map": "hot", "window": [8, 2]}, "8"),
        ({"map": "hot", "clim": [2, 8]}, "clim"),
    ],
)
def test_maps_that_are_none_are_refused(look, told):
    state = ViewerState.of(ws.Scene(viewer_fakes.ball()))
    document = short_document(state, state.document)
    document["layers"][0]["look"] = look
    with pytest.raises(ArgumentError, match=told):
        questions.state_from_text(state, json.dumps(document))


def test_the_automatic_look_of_the_command_is_a_short_command_too(scans):
    scan = ws.open("ct.nrrd")
    # As `wavesplat view` makes it: what stands open is filled in.
    look = replace(ws.Look.auto(scan), background="black")
    state = ViewerState.of(ws.Scene(scan, look, background="black"))
    command = code.command_of(state, SIZE)
    assert "--preset auto " in command
    assert len(command.replace(f"{scans}/", "")) < 300


def test_a_link_has_the_layout_of_the_window_that_asks():
    state = ViewerState.of(ws.Scene(ws.examples.ripples(8), "grey"))
    window = {"layout": {"name": "single", "main": "z"}, "interface": {**state.view["interface"], "panels": ["share"]}}
    told, _ = questions.answer_of(state, "code", {"as": "link", "width": 1, "height": 1, "window": window})
    view = json.loads(told["text"])["state"]["view"]
    assert {name: view[name] for name in window} == window
    for wrong in ("z", {"slices": {}}, {"layout": {"name": "five"}}):
        with pytest.raises(ArgumentError):
            questions.answer_of(state, "code", {"as": "link", "width": 1, "height": 1, "window": wrong})
