"""Opening files in the page: what is read, how it is shown beside what is open, and undo over it."""

import gc
import io
import threading
import time

import numpy as np
import pytest
import viewer_fakes
from opening_pages import Asker, nifti_of, scan_samples, started_page

import wavesplat as ws
from wavesplat._cli.commands.view import OpenedOptions, _opened
from wavesplat._cli.options.scene import SceneOptions
from wavesplat._cli.options.view import ViewOptions
from wavesplat._viewer.notebook import _Pages
from wavesplat._viewer.opening import start_page
from wavesplat._viewer.opening.opening import Opener
from wavesplat._viewer.session.session import Session
from wavesplat._viewer.session.state import ViewerState

started = pytest.fixture(started_page)


@pytest.fixture
def opened(tmp_path):
    """A page of a session that shows a scan."""
    scan = nifti_of(scan_samples())
    (tmp_path / "scan.nii.gz").write_bytes(scan)
    session = Session(ViewerState.of(ws.Scene(ws.open(tmp_path / "scan.nii.gz"))))
    opener = Opener(lambda: session.state)
    yield Asker(opener), viewer_fakes.Page(session)
    opener.close()
    session.close()


def label_samples(n=20):
    z, _, x = np.mgrid[:n, :n, :n]
    return np.where(x < n // 2, 1, np.where(z < n // 3, 2, 0)).astype(np.uint8)


CORNERS = b"vertex 0 0 0\nvertex 9 0 0\nvertex 0 9 0\n"
TRIANGLE = b"solid s\nfacet normal 0 0 1\nouter loop\n" + CORNERS + b"endloop\nendfacet\nendsolid s\n"


def test_a_file_begins_the_session_as_the_command_opens_it(started, tmp_path):
    page, begun = started
    data = nifti_of(scan_samples())
    told = page.open({"scan.nii.gz": data})
    assert told["shown"]
    assert told["found"] == [{"kind": "volume", "name": "scan.nii.gz"}]
    (tmp_path / "scan.nii.gz").write_bytes(data)
    by_command = state_of_the_command(tmp_path / "scan.nii.gz")
    found, expected = (one.document["layers"][0]["look"] for one in (begun[0], by_command))
    # The background of a look that was chosen is the scene's already.
    assert {**found, "background": None} == {**expected, "background": None}
    fields = set(by_command.document) - {"layers"}
    assert {name: begun[0].document[name] for name in fields} == {name: by_command.document[name] for name in fields}


def state_of_the_command(path):
    """The state that `wavesplat view PATH` begins with."""
    own = OpenedOptions(quality="normal", kernel="linear")
    return _opened(str(path), own, SceneOptions(), ViewOptions(), quiet=True)


def test_examples_are_opened_and_have_pictures(started):
    page, begun = started
    offered = page.answer("offered")[0]
    assert [one["name"] for one in offered["examples"]] == ["ct_pelvis", "mri_head", "ripples"]
    assert offered["max_bytes"] == 4 << 30
    _, picture = page.answer("example_picture", name="ripples")
    assert picture.startswith(b"\xff\xd8")
    assert page.answer("open", example="ripples")[0]["shown"]
    assert begun[0].scene.layers[0].volume.name == "ripples(32)"
    assert "liver" in page.refusal("open", example="liver")
    assert "liver" in page.refusal("example_picture", name="liver")


def test_a_file_does_not_wait_for_pictures_of_examples(started, monkeypatch):
    page, begun = started
    drawn, is_drawing, may_go = [], threading.Event(), threading.Event()

    def slow_picture(name):
        is_drawing.set()
        assert may_go.wait(30)
        drawn.append((name, len(begun)))
        return b"picture"

    monkeypatch.setattr(start_page, "example_picture", slow_picture)
    for number, name in enumerate(("ct_pelvis", "mri_head", "ripples")):
        ask = {"type": "ask", "id": number, "question": "example_picture", "arguments": {"name": name}}
        page.opener.receive("other", lambda *_: None, ask, b"")
    assert is_drawing.wait(30)

    def go_when_the_file_waits():
        while page.opener._waiting.qsize() < 3:  # two pictures and the file
            time.sleep(0.01)
        may_go.set()

    threading.Thread(target=go_when_the_file_waits, daemon=True).start()
    assert page.open({"scan.nii.gz": nifti_of(scan_samples())})["shown"]
    # The one that was being drawn already is finished first.
    assert drawn[0] == ("ct_pelvis", 0)
    assert all(n_begun == 1 for _, n_begun in drawn[1:])


def test_a_second_volume_replaces_the_first_and_undo_brings_it_back(opened):
    page, viewer = opened
    before = viewer.session.state.document
    told = page.open({"other.nii.gz": nifti_of(scan_samples(16, 3))})
    assert not told["shown"]
    operations = page.answer("show", opened=told["opened"], how="replace", aspect=0.5)[0]["operations"]
    viewer.patch(*operations)
    state = viewer.session.state
    # The camera frames the new volume in the page's view, and key 0 goes back to that.
    assert state.camera == state.first_view.camera_for(state.scene, state.options["composite"], 0.5)
    assert state.camera != state.first_view.camera
    assert [layer.volume.name for layer in state.scene.layers] == ["other.nii.gz"]
    assert state.scene.layers[0].volume.shape == (16, 16, 16)
    viewer.patch({"op": "replace", "path": "", "value": before})
    assert viewer.session.state.scene.layers[0].volume.name == "scan.nii.gz"
    assert viewer.session.state.camera.as_json() == before["camera"]
    assert viewer.session.state.first_view.camera.as_json() == before["camera"]
    again = page.open({"other.nii.gz": nifti_of(scan_samples(16, 3))})
    assert "aspect is -1" in page.refusal("show", opened=again["opened"], how="replace", aspect=-1)


def test_an_overlay_is_a_further_layer_as_the_option_layer_makes_it(opened, tmp_path):
    page, viewer = opened
    pet = np.random.default_rng(2).gamma(0.4, 2, (10, 10, 10)).astype(np.float32)
    data = nifti_of(pet, 4.0)
    told = page.open({"pet.nii.gz": data})
    first = viewer.session.state.document["layers"][0]
    viewer.patch(*page.answer("show", opened=told["opened"], how="overlay")[0]["operations"])
    state = viewer.session.state
    assert [layer.volume.name for layer in state.scene.layers] == ["scan.nii.gz", "pet.nii.gz"]
    assert state.document["layers"][0] == first
    (tmp_path / "pet.nii.gz").write_bytes(data)
    by_option = ViewerState.of(
        ws.Scene([*state.scene.layers[:1], ws.Layer.overlay(ws.open(tmp_path / "pet.nii.gz"))]), state.camera
    )
    curves = [one.document["layers"][1]["look"]["transfer_function"] for one in (state, by_option)]
    assert curves[0] == curves[1]
    assert np.array_equal(state.scene.layers[1].drawn.samples, pet)
    viewer.patch({"op": "remove", "path": "/layers/0"})
    assert [layer.volume.name for layer in viewer.session.state.scene.layers] == ["pet.nii.gz"]
    viewer.patch({"op": "replace", "path": "", "value": state.document})
    again = viewer.session.state.scene
    assert [layer.volume for layer in again.layers] == [layer.volume for layer in state.scene.layers]


def test_a_segmentation_is_found_and_shown_as_labels_or_over(opened):
    page, viewer = opened
    told = page.open({"organs.nii.gz": nifti_of(label_samples())})
    assert told["found"] == [{"kind": "labels", "name": "organs.nii.gz"}]
    viewer.patch(*page.answer("show", opened=told["opened"], how="labels")[0]["operations"])
    assert sorted(viewer.session.state.scene.labels.labels) == [1, 2]
    assert viewer.session.state.file_document()["labels"]["volume"]["path"] == "organs.nii.gz"
    viewer.patch({"op": "replace", "path": "/labels", "value": None})
    assert viewer.session.state.scene.labels is None
    again = page.open({"organs.nii.gz": nifti_of(label_samples())})
    viewer.patch(*page.answer("show", opened=again["opened"], how="overlay")[0]["operations"])
    assert len(viewer.session.state.scene.layers) == 2


def test_a_segmentation_may_be_one_of_several_in_a_file(opened):
    page, viewer = opened
    data = io.BytesIO()
    np.savez(data, raw=scan_samples(), organs=label_samples())
    asked = page.open({"cells.npz": data.getvalue()})
    assert asked["several"]["names"] == ["raw", "organs"]
    told = page.answer("open", upload=1, choice={"option": "dataset", "value": "organs"})[0]
    viewer.patch(*page.answer("show", opened=told["opened"], how="labels")[0]["operations"])
    assert sorted(viewer.session.state.scene.labels.labels) == [1, 2]
    source = viewer.session.state.file_document()["labels"]["volume"]
    assert (source["path"], source["dataset"]) == ("cells.npz", "organs")


def test_surfaces_and_points_are_added_and_removed(opened):
    page, viewer = opened
    told = page.open({"liver.stl": TRIANGLE, "cells.csv": b"x,y,z\n1,2,3\n4,5,6\n"})
    assert {one["kind"] for one in told["found"]} == {"shape"}
    operations = page.answer("show", opened=told["opened"], how="overlay")[0]["operations"]
    viewer.patch(*operations)
    shown = viewer.session.state.document["geometry"]
    assert [(one["kind"], one["name"], one["count"]) for one in shown] == [
        ("points", "cells.csv", 2),
        ("surface", "liver.stl", 1),
    ]
    viewer.patch({"op": "remove", "path": "/geometry/0"})
    assert [shape.name for shape in viewer.session.state.scene.geometry] == ["liver.stl"]
    document = viewer.session.state.file_document()
    assert document["geometry"][0]["surface"]["file"]["path"] == "liver.stl"


def test_pairs_and_several_volumes_are_opened_together(started):
    page, begun = started
    header = (
        b"NRRD0004\ntype: short\ndimension: 3\nsizes: 20 20 20\nspacings: 2 2 2\nendian: little\nencoding: raw\n"
        b"data file: scan.raw\n"
    )
    told = page.open(
        {
            "in/scan.nhdr": header,
            "in/scan.raw": scan_samples().astype("<i2").tobytes(),
            "in/mask.nii.gz": nifti_of(label_samples()),
            "in/about.txt": b"made by hand",
            "in/.DS_Store": b"x",
        }
    )
    assert [one["name"] for one in told["found"]] == ["mask.nii.gz", "scan.nhdr"]
    assert np.array_equal(begun[0].scene.layers[0].drawn.samples, scan_samples())
    assert begun[0].scene.labels is not None
    assert begun[0].file_document()["layers"][0]["volume"]["path"] == "in/scan.nhdr"


def test_a_header_reaches_no_file_outside_of_its_upload(started, tmp_path):
    page, begun = started
    secret = tmp_path / "secret.raw"
    secret.write_bytes(bytes(8 * 2000))
    header = b"NRRD0004\ntype: uchar\ndimension: 3\nsizes: 20 20 20\nencoding: raw\ndata file: %s\n"
    for named in (bytes(secret), b"../../secret.raw"):
        assert page.refusal("open", upload=page.send({"scan.nhdr": header % named}))
    assert begun == []


@pytest.mark.parametrize(
    ("files", "said"),
    [
        ({"scan.nii.gz": b"no gzip"}, "scan.nii.gz"),
        ({"letter.doc": b"Dear all"}, "letter.doc"),
        ({".hidden": b"x"}, "nothing was sent"),
        ({"empty.nii": b""}, "empty.nii"),
        ({"liver.stl": TRIANGLE}, "no volume"),
    ],
    ids=lambda value: next(iter(value)) if isinstance(value, dict) else "",
)
def test_what_cannot_be_opened_is_said_without_the_folder_of_the_server(started, files, said):
    page, begun = started
    if "liver.stl" in files:
        said = "none is open"
    message = page.refusal("open", upload=page.send(files))
    assert said in message
    assert "wavesplat-open" not in message
    assert begun == []


def test_several_series_are_a_question(started):
    page, begun = started
    told = page.open({"two.npz": several_npz()})
    assert told["several"]["option"] == "dataset"
    assert told["several"]["names"] == ["a", "b"]
    again = page.answer("open", upload=1, choice={"option": "dataset", "value": "b"})[0]
    assert again["shown"]
    assert begun[0].scene.layers[0].drawn.shape == (9, 9, 9)


def test_a_choice_is_a_series_or_a_dataset(started):
    page, _ = started
    upload = page.send({"two.npz": several_npz()})
    assert "choice" in page.refusal("open", upload=upload, choice={"option": "path", "value": "/etc/passwd"})


def test_files_that_are_in_memory_are_removed_once_they_are_shown(opened):
    page, viewer = opened
    told = page.open({"other.nii.gz": nifti_of(scan_samples(16, 3)), "organs.nii.gz": nifti_of(label_samples(16))})
    folder = page.opener._uploads.get(1).folder
    assert folder.exists()  # the segmentation is read when it is known of which scan it is
    before = viewer.session.state.document
    viewer.patch(*page.answer("show", opened=told["opened"], how="replace")[0]["operations"])
    assert not folder.exists()
    shown = viewer.session.state
    viewer.patch({"op": "replace", "path": "", "value": before})
    viewer.patch({"op": "replace", "path": "", "value": shown.document})
    assert viewer.session.state.scene.layers[0].volume.shape == (16, 16, 16)
    assert sorted(viewer.session.state.scene.labels.labels) == [1, 2]


def test_files_of_a_series_stay_as_long_as_undo_can_show_it(opened):
    page, viewer = opened
    beating = np.random.default_rng(4).integers(0, 255, (3, 8, 8, 8), np.uint8)
    content = io.BytesIO()
    np.save(content, beating)
    told = page.open({"beating.npy": content.getvalue()})
    folder = page.opener._uploads.get(1).folder
    before = viewer.session.state.document
    viewer.patch(*page.answer("show", opened=told["opened"], how="replace")[0]["operations"])
    series = viewer.session.state.document
    viewer.patch({"op": "replace", "path": "", "value": before})
    del told
    gc.collect()
    time.sleep(0.05)
    assert folder.exists()
    viewer.patch({"op": "replace", "path": "", "value": series})
    viewer.patch({"op": "replace", "path": "/layers/0/time", "value": 2})
    assert np.array_equal(viewer.session.state.scene.layers[0].drawn.samples, beating[2])
    # Another scene of Python, whose catalogue knows the series no more.
    viewer.session.change(viewer.session.state.with_scene(ws.Scene(viewer_fakes.ball(8))))
    until = time.monotonic() + 20
    while folder.exists() and time.monotonic() < until:
        gc.collect()
        time.sleep(0.01)
    assert not folder.exists()


def test_a_question_of_another_page_removes_nothing(started):
    page, _ = started
    upload = page.send({"scan.nii.gz": nifti_of(scan_samples())})
    folder, other = page.opener._uploads.get(upload).folder, Asker(page.opener, "other")
    assert "another page's" in other.refusal("open", upload=upload)
    assert "another page's" in other.refusal("discard", upload=upload)
    assert (folder / "scan.nii.gz").exists()
    page.answer("discard", upload=upload)
    assert not folder.exists()


def test_what_was_read_is_discarded_by_its_page_alone(opened):
    page, _ = opened
    told = page.open({"scan.nii.gz": nifti_of(scan_samples())})
    folder = page.opener._uploads.get(1).folder
    Asker(page.opener, "other").answer("discard", opened=told["opened"])
    assert folder.exists()
    page.answer("discard", opened=told["opened"])
    assert not folder.exists()
    assert "open it again" in page.refusal("show", opened=told["opened"], how="overlay")


def test_what_a_page_opened_and_did_not_show_goes_with_it(opened):
    page, _ = opened
    told = page.open({"other.nii.gz": nifti_of(scan_samples(16, 3))})
    folder = page.opener._uploads.get(1).folder
    page.opener.leave("page")
    assert not folder.exists()
    assert "open it again" in page.refusal("show", opened=told["opened"], how="overlay")


def several_npz():
    content = io.BytesIO()
    np.savez(content, a=np.zeros((8, 8, 8), np.float32), b=np.random.default_rng(1).random((9, 9, 9), np.float32))
    return content.getvalue()


def test_a_notebook_sends_files_by_its_own_channel(opened):
    class Widget:
        def __init__(self):
            self.sent = []

        def on_msg(self, call):
            self.receive = call

        def send(self, header, buffers):
            self.sent.append((header, buffers))

    page, viewer = opened
    widget = Widget()
    _Pages(viewer.session, widget, page.opener)
    widget.receive(widget, {"type": "hello", "protocol": 1, "page": "p"}, [])
    ask = {"type": "ask", "page": "p", "question": "upload_begin", "arguments": {"files": 1, "bytes": 3}, "id": 1}
    widget.receive(widget, ask, [])
    upload = widget.sent[-1][0]["upload"]
    piece = {"upload": upload, "path": "a.bin", "offset": 0}
    widget.receive(widget, {**ask, "question": "upload", "arguments": piece, "id": 2}, [memoryview(b"abc")])
    assert widget.sent[-1][0] == {"type": "answer", "id": 2, "received": 3, "page": "p"}
