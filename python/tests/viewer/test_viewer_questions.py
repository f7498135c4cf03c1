"""Questions of the viewer's page: values, places, presets, pictures; code that draws the same bytes."""

import io
import json
import shlex
import subprocess
import sys

import numpy as np
import pytest
import viewer_fakes
from cases_of_the_day import nightly
from PIL import Image

import wavesplat as ws
from wavesplat._viewer.page_requests import code, questions, under_pointer
from wavesplat._viewer.session.picturing import picture_of
from wavesplat._viewer.session.state import ViewerState
from wavesplat.errors import ArgumentError

SIZE = (60, 44)
LEFT = ws.Camera.view(viewer_fakes.ball(), "left").as_json()


@pytest.fixture(scope="module")
def state():
    return viewer_fakes.state_of()


@pytest.fixture(scope="module")
def pelvis():
    return ViewerState.of(ws.Scene(ws.examples.ct_pelvis(), "ct-bone"), "front")


def pixels(content):
    return np.asarray(Image.open(io.BytesIO(content)).convert("RGBA"))


def test_a_histogram_counts_samples(state):
    told, _ = questions.answer_of(state, "histogram", {"layer": 0, "bins": 16, "low": 0, "high": 256})
    samples = state.scene.layers[0].volume.samples
    assert told["counts"] == np.histogram(samples, bins=16, range=(0, 256))[0].tolist()


@pytest.mark.filterwarnings("error")
def test_the_sample_at_a_point_is_the_nearest_one_and_none_lies_outside():
    place = np.array([[0.5, 0, 0, 1], [0, -1, 0, 9], [0, 0, 2, 0], [0, 0, 0, 1]])
    assert under_pointer.sample_at(place, (4, 8, 10), [1 + 0.5 * 6 + 0.2, 9 - 5 + 0.3, 2 * 3 - 0.4]) == (3, 5, 6)
    for far in (0.5, 1e29, -1e29, 9.3e18):
        assert under_pointer.sample_at(place, (4, 8, 10), [far, 4, 6]) is None


@pytest.mark.parametrize("angle", [None, 30.0])
def test_a_pick_is_where_the_surface_is_seen(angle):
    volume = viewer_fakes.ball(33)
    look = ws.TransferFunction([(120, 0), (121, 1)], [(120, 1, 1, 1)], opacity_unit=0.05)
    camera = ws.Camera.orbit(volume, 20, 10, view_angle=angle)
    state = ViewerState.of(ws.Scene(volume, look), camera)
    told, _ = questions.answer_of(state, "pick", {"x": 0.5, "y": 0.5, "width": 200, "height": 200})
    away = np.linalg.norm(np.array(told["point"]) - 16)
    towards = np.array(camera.position) - np.array(camera.focal_point)
    towards /= np.linalg.norm(towards)
    # Values are 120 at a distance of 135 / 12 * 33 / 24 spacings from the middle.
    radius = 135 / 12 * 33 / 24
    assert away == pytest.approx(radius, abs=0.4)
    np.testing.assert_allclose(told["point"], 16 + radius * towards, atol=0.5)
    corner, _ = questions.answer_of(state, "pick", {"x": 0.01, "y": 0.01, "width": 200, "height": 200})
    assert corner["point"] is None


def test_a_pick_beside_the_middle_lies_on_its_ray(pelvis):
    depth = pelvis.scene.render(pelvis.camera, size=(160, 120), depth=True).depth
    rows, columns = np.nonzero(np.isfinite(depth))
    row, column = rows[len(rows) // 2], columns[len(rows) // 2]
    arguments = {"x": (column + 0.5) / 160, "y": (row + 0.5) / 120, "width": 160, "height": 120}
    told, _ = questions.answer_of(pelvis, "pick", arguments)
    camera = pelvis.camera
    # Seen from the front, x grows to the left of the picture.
    pixel = 2 * camera.parallel_scale / 120
    x, y, z = told["point"]
    assert x == pytest.approx(camera.focal_point[0] - (column + 0.5 - 80) * pixel, abs=pixel)
    assert z == pytest.approx(camera.focal_point[2] + (60 - row - 0.5) * pixel, abs=pixel)
    assert camera.position[1] - y == pytest.approx(depth[row, column], abs=6)


def test_presets_are_looks_of_this_volume(pelvis):
    told, _ = questions.answer_of(pelvis, "preset", {"layer": 0, "name": "ct-soft-tissue"})
    changed = pelvis.patched([{"op": "replace", "path": "/layers/0/look", "value": told["look"]}])
    drawn = picture_of(changed, "3d", SIZE)
    direct = ws.render(ws.examples.ct_pelvis(), "ct-soft-tissue", pelvis.camera, size=SIZE, background="black")
    assert np.array_equal(drawn.rgba, direct.rgba)
    _, content = questions.answer_of(pelvis, "preset_picture", {"layer": 0, "name": "ct-soft-tissue", "size": 48})
    assert pixels(content).shape == (48, 48, 4)
    assert pixels(content)[..., :3].max() > 100
    with pytest.raises(ArgumentError, match="no-such-look"):
        questions.answer_of(pelvis, "preset", {"layer": 0, "name": "no-such-look"})


def test_pictures_are_drawn_anew(pelvis):
    arguments = {"width": 60, "height": 44, "quality": "high", "transparent": False, "annotated": False}
    _, content = questions.answer_of(pelvis, "picture", arguments)
    direct = pelvis.scene.render(pelvis.camera, size=SIZE, quality="high")
    assert np.array_equal(pixels(content), np.asarray(direct))
    _, clear = questions.answer_of(pelvis, "picture", {**arguments, "transparent": True})
    assert pixels(clear)[..., 3].min() == 0
    _, written = questions.answer_of(pelvis, "picture", {**arguments, "width": 300, "height": 220, "annotated": True})
    assert not np.array_equal(pixels(written)[..., :3], pixels(content)[:1, :1, :3])


@pytest.mark.parametrize(
    ("question", "arguments"),
    [
        ("dance", {}),
        ("region", {"points": [[1, 2]] * 3}),
        ("region", {"points": [[1, 2, "x"]] * 3}),
        ("region", {"points": [[1, 2, float("nan")]] * 3}),
        ("histogram", {"layer": 1, "bins": 16, "low": 0, "high": 1}),
        ("histogram", {"layer": 0, "bins": 10**6, "low": 0, "high": 1}),
        ("histogram", {"layer": 0, "bins": 16, "low": 1, "high": 1}),
        ("pick", {"x": 2, "y": 0, "width": 10, "height": 10}),
        ("pick", {"x": 0.5, "y": 0, "width": 0, "height": 10}),
        ("picture", {"width": 10**5, "height": 10, "quality": "high"}),
        ("picture", {"width": 10, "height": 10, "quality": "best"}),
        ("picture", {"width": 10, "height": 10, "quality": "high", "transparent": 1}),
        ("preset_picture", {"layer": 0, "name": "auto", "size": 4000}),
        ("code", {"as": "perl", "width": 10, "height": 10}),
        ("open_state", {"text": "{"}),
        ("open_state", {"text": "{}"}),
        ("open_state", {"text": 3}),
        ("framed", {"width": 10, "height": 10}),
        ("framed", {"width": 0, "height": 10, "camera": LEFT}),
        ("first_view", {"width": 10}),
        ("kept_in_view", {"width": 10, "height": 10, "aspect": 1}),
        ("kept_in_view", {"width": 10, "height": 10, "aspect": 0, "camera": LEFT}),
        ("region", []),
    ],
    ids=str,
)
def test_questions_that_cannot_be_answered_are_refused(state, question, arguments):
    with pytest.raises(ArgumentError):
        questions.answer_of(state, question, arguments)


# Code


def variants(pelvis):
    """States that together need all that code can express."""
    change = lambda *operations: pelvis.patched(  # noqa: E731
        [{"op": "replace", "path": path, "value": value} for path, value in operations]
    )
    middle = np.mean(pelvis.scene.bounds, axis=0).tolist()
    low, high = pelvis.scene.bounds.tolist()
    shading = {"ambient": 0.3, "diffuse": 0.8, "lights": [{"direction": [1, 1, 1]}]}
    return {
        "as it is": pelvis,
        "turned": change(("/camera", pelvis.camera.turned(azimuth=40, elevation=20).as_json())),
        "perspective": change(("/camera", ws.Camera.orbit(pelvis.scene, 30, view_angle=35).as_json())),
        "cut": change(
            (
                "/clip",
                [
                    {"keep": {"lower": low, "upper": middle}},
                    {"plane": {"point": middle, "normal": [0, 1, 1]}},
                    {"cut_out": {"lower": low, "upper": [low[0] + 60, high[1], high[2]]}},
                ],
            )
        ),
        "look": change(("/layers/0/look/transfer_function/opacity", [[100, 0], [300, 0.5]]), ("/shading", shading)),
        "operator": change(("/render", {"quality": "draft", "kernel": "bspline2", "composite": "maximum"})),
        "surface": change(
            ("/render", {"quality": "normal", "kernel": "linear", "composite": {"first-hit": {"iso_value": 250}}})
        ),
        "sampling": change(
            (
                "/render",
                {"quality": {"sheets_per_slice": 1.5, "oversampling": 1.2}, "kernel": "linear", "composite": "over"},
            )
        ),
        "faded": change(("/layers/0/opacity", 0.6), ("/background", "#203040"), ("/layers/0/name", "hips")),
    }


@pytest.mark.parametrize(
    "name",
    [
        *("cut", "look", "sampling", "faded"),
        # By day `test_viewer_short.py` has operators and kernels; a camera is told in each case.
        *nightly("as it is", "turned", "perspective", "operator", "surface"),
    ],
)
def test_python_and_command_draw_the_picture_at_rest(pelvis, name, tmp_path, monkeypatch):
    state = variants(pelvis)[name]
    expected = np.asarray(picture_of(state, "3d", SIZE))
    monkeypatch.chdir(tmp_path)
    drawn = tmp_path / ("hips.png" if name == "faded" else "CT.png")
    exec(compile(code.python_of(state, SIZE), "picture.py", "exec"), {})  # noqa: S102
    assert np.array_equal(pixels(drawn.read_bytes()), expected)
    drawn.unlink()
    command = code.command_of(state, SIZE).replace("wavesplat ", f"{shlex.quote(sys.executable)} -m wavesplat ", 1)
    done = subprocess.run(["sh", "-c", command], cwd=tmp_path, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert np.array_equal(pixels(drawn.read_bytes()), expected)


def test_code_opens_files_with_their_options(tmp_path, monkeypatch):
    np.save(tmp_path / "it's.npy", viewer_fakes.ball(16).samples)
    volume = ws.open(tmp_path / "it's.npy", spacing=(1, 1, 2)).smoothed(0.5)
    number = int(viewer_fakes.ball(16).samples.max())
    labels = ws.Labels(
        ws.open(tmp_path / "it's.npy", spacing=(1, 1, 2)), {number: ws.Label("red", 0.5, name="shell")}, smooth=False
    )
    scene = ws.Scene([volume, ws.Layer(volume, "grey", opacity=0.3, visible=False, name="again")], labels=labels)
    state = ViewerState.of(scene)
    monkeypatch.chdir(tmp_path)
    text = code.python_of(state, SIZE)
    assert "import wavesplat as ws" in text
    exec(compile(text, "picture.py", "exec"), {})  # noqa: S102
    expected = np.asarray(picture_of(state, "3d", SIZE))
    assert np.array_equal(pixels((tmp_path / "it_s.png").read_bytes()), expected)


def test_a_page_holds_the_picture_and_no_script(pelvis):
    told, _ = questions.answer_of(pelvis, "code", {"as": "html", "width": 60, "height": 44})
    text = told["text"]
    assert "<script" not in text
    assert "data:image/png;base64," in text
    assert "default-src 'none'" in text
    hostile = pelvis.patched([{"op": "replace", "path": "/layers/0/name", "value": '<img src=x onerror="1">'}])
    told, _ = questions.answer_of(hostile, "code", {"as": "html", "width": 60, "height": 44})
    assert "<img src=x" not in told["text"]


def test_state_files_open_again(pelvis):
    turned = pelvis.patched(
        [viewer_fakes.turned(pelvis.camera, 25), {"op": "replace", "path": "/view/overlays/cube", "value": False}]
    )
    told, _ = questions.answer_of(turned, "code", {"as": "state", "width": 60, "height": 44})
    back = questions.state_from_text(pelvis, told["text"])
    assert back.camera == turned.camera
    assert back.view["overlays"]["cube"] is False
    assert back.document == turned.document
    # A state as a person may write it by hand: a preset by name, and defaults left out.
    short = json.dumps(
        {"wavesplat": "scene", "version": 1, "layers": [{"volume": {"path": "x.nii"}, "look": "ct-muscle"}]}
    )
    assert questions.state_from_text(pelvis, short).scene.layers[0].look.name == "ct-muscle"
    two = json.dumps({"wavesplat": "scene", "version": 1, "layers": [{}, {}]})
    with pytest.raises(ArgumentError, match="2 layers, and 1 volumes are open"):
        questions.state_from_text(pelvis, two)
