"""`ws.view` and `wavesplat view`: the object that users get, and the command's output."""

import json
import os
import signal
import subprocess
import sys
import time

import nibabel
import numpy as np
import pytest
import viewer_fakes
from cases_of_the_day import nightly

import wavesplat as ws
from wavesplat.errors import ArgumentError


@pytest.fixture
def viewer():
    with ws.view(viewer_fakes.ball(), "grey", browser=False) as opened:
        yield opened


def test_what_is_shown_can_be_read_and_set(viewer):
    assert viewer.scene.layers[0].look.name == "grey"
    camera = viewer.camera.turned(azimuth=40)
    viewer.camera = camera
    assert viewer.camera == camera
    assert viewer.state["camera"] == camera.as_json()
    state = viewer.state
    state["background"] = "white"
    viewer.state = state
    assert viewer.scene.background == "white"
    viewer.scene = ws.Scene(viewer_fakes.ball(10), background="black")
    assert viewer.scene.layers[0].volume.shape == (10, 10, 10)
    assert viewer.camera == camera
    expected = viewer.scene.render(camera, size=(40, 30))
    assert np.array_equal(viewer.picture((40, 30)).rgba, expected.rgba)


def test_wrong_things_are_refused(viewer):
    with pytest.raises(ArgumentError, match="camera is 'front'"):
        viewer.camera = "front"
    with pytest.raises(ArgumentError, match="scene is"):
        viewer.scene = viewer_fakes.ball()
    with pytest.raises(ArgumentError, match="field 'layers'"):
        viewer.state = {**viewer.state, "layers": []}
    with pytest.raises(ArgumentError, match="quality"):
        viewer.picture(quality="best")


def test_changes_of_pages_are_told(viewer):
    told = []
    stop = viewer.on_change(lambda one: told.append(one.camera))
    page = viewer_fakes.Page(viewer._session)
    turned = viewer.camera.turned(azimuth=5)
    page.patch({"op": "replace", "path": "/camera", "value": turned.as_json()})
    assert told == [turned]
    viewer.camera = viewer.camera.turned(azimuth=5)
    assert len(told) == 1
    stop()
    page.patch({"op": "replace", "path": "/camera", "value": turned.as_json()})
    assert len(told) == 1


def test_files_of_all_kinds(viewer, tmp_path):
    for name in ("view.png", "view.html", "view.jpg"):
        viewer.save(tmp_path / name, size=(40, 30))
        assert (tmp_path / name).stat().st_size > 300
    np.save(tmp_path / "ball.npy", viewer_fakes.ball().samples)
    with ws.view(ws.open(tmp_path / "ball.npy", spacing=(1, 1, 1)), browser=False) as other:
        other.camera = other.camera.turned(azimuth=30)
        other.save(tmp_path / "view.json", size=(40, 30))
        document = json.loads((tmp_path / "view.json").read_text(encoding="utf-8"))
        assert document["layers"][0]["volume"]["path"] == "ball.npy"
        picture = other.picture((40, 30))
        with ws.view(ws.Scene.load(tmp_path / "view.json"), state=document, browser=False) as again:
            assert np.array_equal(again.picture((40, 30)).rgba, picture.rgba)
    done = subprocess.run(
        [sys.executable, "-m", "wavesplat", "render", "--from", "view.json", "-o", "again.png"],
        cwd=tmp_path,
        check=True,
        capture_output=True,
    )
    assert done.returncode == 0
    import PIL.Image

    assert np.array_equal(np.asarray(PIL.Image.open(tmp_path / "again.png")), np.asarray(picture))


def test_several_viewers_have_their_own_ports():
    with ws.view(viewer_fakes.ball(8), browser=False) as one, ws.view(viewer_fakes.ball(9), browser=False) as other:
        assert one.url.partition("#")[0] != other.url.partition("#")[0]
        assert one.url != one.url
        assert repr(one).startswith("<Viewer: 'ball' at http://127.0.0.1:")


def started(*arguments, cwd=None):
    return subprocess.Popen(
        [sys.executable, "-m", "wavesplat", "view", *arguments, "--no-browser"],
        cwd=cwd,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )


@pytest.mark.skipif(os.name == "nt", reason="signals of Windows are others")
# By day one signal; another test of this file ends the command by Ctrl-C.
@pytest.mark.parametrize("number", [signal.SIGTERM, *nightly(signal.SIGINT, signal.SIGHUP)])
def test_the_command_without_a_file_serves_the_start_page_until_it_is_ended(number):
    process = started()
    try:
        assert "#token=" in process.stdout.readline()
        assert "Ctrl-C ends the viewer" in process.stderr.readline()
        process.send_signal(number)
        _, err = process.communicate(timeout=20)
    finally:
        process.kill()
    assert "the viewer has ended" in err
    assert process.returncode == 0


@pytest.mark.skipif(os.name == "nt", reason="signals of Windows are others")
def test_the_command_prints_a_link_and_ends_by_ctrl_c(tmp_path):
    begun = time.monotonic()
    process = started("--example", "ripples")
    try:
        link = process.stdout.readline()
        assert time.monotonic() - begun < 10
        assert link.startswith("http://127.0.0.1:")
        assert "#token=" in link
        assert "Ctrl-C ends the viewer" in process.stderr.readline()
        process.send_signal(signal.SIGINT)
        out, err = process.communicate(timeout=10)
    finally:
        process.kill()
    assert out == ""
    assert "the viewer has ended" in err
    assert process.returncode == 0


def test_the_command_opens_all_times(tmp_path):
    from wavesplat._cli.options.opened_layers import OpeningOptions, opened_layers
    from wavesplat._cli.options.reader import ReaderOptions

    samples = np.stack([np.roll(viewer_fakes.ball(12).samples, step, 0) for step in range(3)], -1)
    nibabel.save(nibabel.Nifti1Image(samples, np.eye(4)), tmp_path / "times.nii")
    path = str(tmp_path / "times.nii")
    how = {"composite": None, "quiet": True}
    series = opened_layers(path, OpeningOptions(), all_times=True, **how)
    assert len(series) == 3
    one = opened_layers(path, OpeningOptions(reader=ReaderOptions(time=1)), all_times=True, **how)
    assert one.shape == (12, 12, 12)
    with ws.view(ws.Layer(series), browser=False) as viewer:
        page = viewer_fakes.Page(viewer._session)
        page.show()
        _, before = page.at_rest()
        page.patch({"op": "replace", "path": "/layers/0/time", "value": 2})
        assert page.at_rest()[1] != before
        assert viewer.scene.layers[0].time == 2


@pytest.mark.parametrize(
    ("arguments", "code", "text"),
    [
        (["--preset", "ct-bone"], 2, "INPUT: name one for --preset"),
        (["a.nii", "--example", "ripples"], 2, "INPUT and --example: name one"),
        (["missing.nii"], 1, "missing.nii"),
        (["--state", "missing.json"], 1, "missing.json"),
        (["--example", "liver"], 2, "liver"),
        (["broken.npy"], 1, "broken.npy"),
    ],
)
def test_what_cannot_be_opened_is_said(tmp_path, arguments, code, text):
    (tmp_path / "broken.npy").write_bytes(b"no array")
    process = started(*arguments, cwd=tmp_path)
    try:
        _, err = process.communicate(timeout=30)
    finally:
        process.kill()
    assert process.returncode == code, err
    assert text in err
