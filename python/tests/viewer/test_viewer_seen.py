"""Pictures of what a page shows: views and slices, alone and together, with measures; and code that draws them."""

import io
import shlex
import subprocess
import sys

import numpy as np
import pytest
import viewer_fakes
from PIL import Image

import wavesplat as ws
from wavesplat._viewer.page_requests import questions
from wavesplat._viewer.page_requests.seen import GAP, name_of, seen
from wavesplat._viewer.page_requests.seen import _text as text_of
from wavesplat._viewer.session.picturing import picture_of
from wavesplat._viewer.session.state import ViewerState
from wavesplat.errors import ArgumentError

SIZE = (240, 180)
SHOWN = ("3d", "z", "y", "x", "all")


def bytes_of(picture):
    return np.asarray(picture)


def with_measures(state):
    x, y, z = state.view["slices"]["crosshair"]
    measures = [
        {"kind": "distance", "points": [[x, y, z], [x + 50, y, z]]},
        {"kind": "angle", "points": [[x + 30, y, z], [x, y, z], [x, y + 30, z]]},
        {"kind": "area", "points": [[x - 40, y, z], [x - 10, y, z], [x - 10, y - 20, z], [x - 40, y - 20, z]]},
    ]
    return state.patched([{"op": "replace", "path": "/view/measures", "value": measures}])


@pytest.fixture(scope="module")
def pelvis():
    return with_measures(ViewerState.of(ws.Scene(ws.examples.ct_pelvis(), "ct-bone")))


def changed(state, **overlays):
    return state.patched(
        [{"op": "replace", "path": f"/view/overlays/{name}", "value": value} for name, value in overlays.items()]
    )


@pytest.mark.parametrize("shown", ["3d", "z", "y", "x"])
def test_without_marks_it_is_the_view_itself(pelvis, shown):
    drawn = seen(pelvis, shown, SIZE, marks=False)
    assert np.array_equal(bytes_of(drawn), bytes_of(picture_of(pelvis, shown, SIZE)))


def test_all_are_the_four_views_side_by_side(pelvis):
    drawn = bytes_of(seen(pelvis, "all", (242, 182), marks=False))
    assert drawn.shape == (182, 242, 4)
    for number, view in enumerate(("3d", "z", "y", "x")):
        top, left = (90 + GAP) * (number // 2), (120 + GAP) * (number % 2)
        part = drawn[top : top + 90, left : left + 120]
        assert np.array_equal(part, bytes_of(picture_of(pelvis, view, (120, 90))))


def test_measures_are_drawn_on_the_slices_that_they_lie_in(pelvis):
    plain = changed(pelvis, scale_bar=False, letters=False, cube=False)

    def n_changed(view):
        drawn, alone = (bytes_of(seen(plain, view, SIZE, marks=marks)) for marks in (True, False))
        return int((drawn != alone).any(axis=-1).sum())

    # Across y the distance alone, across x the angle has a point beside the slice: none.
    assert n_changed("z") > n_changed("y") > 20
    assert n_changed("x") == 0
    assert n_changed("3d") > 20


def test_the_line_of_a_distance_lies_between_its_points():
    state = ViewerState.of(ws.Scene(viewer_fakes.ball(33)))
    middle = state.view["slices"]["crosshair"]
    ends = [[middle[0] - 10, middle[1], middle[2]], [middle[0] + 10, middle[1], middle[2]]]
    operations = [{"op": "replace", "path": "/view/measures", "value": [{"kind": "distance", "points": ends}]}]
    state = changed(state.patched(operations), scale_bar=False, letters=False, cube=False)
    drawn = np.asarray(seen(state, "z", (330, 330), marks=True).rgba)
    # Cyan: much more green than red.
    columns = np.flatnonzero((drawn[160:170, :, 1] - drawn[160:170, :, 0] > 0.3).any(axis=0))
    report = picture_of(state, "z", (330, 330)).report
    length = 20 / report["pixel"]
    assert abs((columns.max() - columns.min()) - length) < 10


@pytest.mark.parametrize(
    ("shown", "marks"),
    [
        *(("x", False), ("all", True)),
        pytest.param("3d", True, marks=pytest.mark.nightly),  # by day it is a part of "all"
        pytest.param("z", True, marks=pytest.mark.nightly),  # by day "x"
    ],
)
def test_the_copied_code_draws_the_same_pixels(pelvis, shown, marks, tmp_path, monkeypatch):
    state = changed(pelvis, color_bar=shown == "all").patched(
        [{"op": "replace", "path": "/view/slices/zoom", "value": 1.5}]
    )
    asked = {"width": 480, "height": 360, "shown": shown, "annotated": marks}
    told, payload = questions.answer_of(state, "picture", asked)
    expected = np.asarray(Image.open(io.BytesIO(payload)).convert("RGBA"))
    name = {"3d": "CT", "z": "CT_axial", "x": "CT_sagittal", "all": "CT_all"}[shown]
    assert told["name"] == f"{name}.png"
    monkeypatch.chdir(tmp_path)
    path = tmp_path / f"{name}.png"

    def drawn():
        pixels = np.asarray(Image.open(path).convert("RGBA"))
        path.unlink()
        return pixels

    text = questions.answer_of(state, "code", {**asked, "as": "python"})[0]["text"]
    exec(compile(text, "picture.py", "exec"), {})  # noqa: S102
    assert np.array_equal(drawn(), expected)
    text = questions.answer_of(state, "code", {**asked, "as": "command"})[0]["text"]
    command = text.replace("wavesplat ", f"{shlex.quote(sys.executable)} -m wavesplat ", 1)
    done = subprocess.run(["sh", "-c", command], cwd=tmp_path, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert done.stdout.strip() == f"{name}.png"
    assert np.array_equal(drawn(), expected)


@pytest.mark.parametrize(
    ("file", "stem"),
    [
        ("scan.nii.gz", "scan"),
        ("brain.ome.zarr", "brain"),
        ("a b'c;$(x).nrrd", "a_b_c_x"),
        ("-o.nrrd", "o"),
        ("..", "picture"),
        ("Körper 1.mha", "Körper_1"),
    ],
)
def test_files_are_named_after_the_volume(file, stem):
    volume = ws.Volume(viewer_fakes.ball(8).samples, name=file)
    state = ViewerState.of(ws.Scene(volume))
    assert name_of(state, "3d") == stem
    assert name_of(state, "z") == f"{stem}_xy"
    assert name_of(state, "all") == f"{stem}_all"


@pytest.mark.parametrize(
    ("arguments", "told"),
    [
        ({"shown": "w"}, "shown is 'w'; use one of: 3d, z, y, x, all"),
        ({"shown": 3}, "shown is 3"),
        ({"quality": "best"}, "quality is 'best'"),
        ({"shown": "all", "width": 3, "height": 3}, "four views need 4 pixels"),
    ],
)
def test_pictures_that_cannot_be_are_refused(pelvis, arguments, told):
    with pytest.raises(ArgumentError, match=told.replace("(", "\\(")):
        questions.answer_of(pelvis, "picture", {"width": 20, "height": 20, **arguments})


def test_measures_are_written_by_their_kind():
    square = np.array([[0.0, 0, 5], [3, 0, 5], [3, 2, 5], [0, 2, 5]])
    assert text_of("distance", square[:2], "mm") == "3 mm"
    assert text_of("angle", square[:3], "mm") == "90.0°"
    assert text_of("area", square, "mm") == "6 mm²"
    # Tilted in space, its area is the same.
    tilt = np.array([[1, 0, 0], [0, 0.6, 0.8], [0, -0.8, 0.6]])
    assert text_of("area", square @ tilt, "µm") == "6 µm²"


@pytest.mark.parametrize("size", [(241, 181), (240, 181)])
def test_all_views_have_the_size_that_was_asked_for(pelvis, size):
    assert seen(pelvis, "all", size, marks=False).size == size
