"""A document is data: scenes, PNG files and states name only files in their folder, unless the user allows more."""

from __future__ import annotations

import json
import shutil
import sys

import dicom_files
import numpy as np
import pytest
from odd_server import OddServer

import wavesplat as ws
from wavesplat._picture.picture_files import text_in, with_text
from wavesplat._scene.documents import scene_files
from wavesplat.errors import ArgumentError, FileError, LimitError, WavesplatWarning

SAMPLES = np.random.default_rng(7).integers(0, 250, (6, 7, 8)).astype(np.uint8)
RAW = {"shape": [6, 7, 8], "dtype": "uint8"}
OUT = "lies outside of the document's folder|is a link out of the folder of the document"
ALLOWED = r"external_files=True \(--external-files\)"


@pytest.fixture
def place(tmp_path):
    """A folder of documents with data in it, and data elsewhere."""
    folder = tmp_path / "documents"
    (folder / "data").mkdir(parents=True)
    (tmp_path / "elsewhere").mkdir()
    for where in (folder / "data", tmp_path / "elsewhere"):
        np.save(where / "a.npy", SAMPLES)
        SAMPLES.tofile(where / "a.raw")
    return folder


def document_of(volume, **more):
    return {"wavesplat": "scene", "version": 1, "layers": [{"volume": volume}], **more}


def written(folder, volume, kind="json", **more):
    """A file with a document that names a volume."""
    document = document_of(volume, **more)
    path = folder / f"document.{'png' if kind == 'png' else 'json'}"
    if kind == "png":
        ws.render(ws.examples.ripples(8), size=(8, 8)).save(path, scene=False)
        path.write_bytes(with_text(path.read_bytes(), "wavesplat", json.dumps(document)))
    else:
        path.write_text(json.dumps({"report": {"scene": document}} if kind == "report" else document))
    return path


def all_of(volume):
    return (volume.read() if isinstance(volume, ws.LazyVolume) else volume).samples


def samples_of(scene):
    return scene.layers[0].drawn.samples


# Files that may be named


@pytest.mark.parametrize("kind", ["json", "report", "png"])
@pytest.mark.parametrize(
    "volume",
    [{"path": "data/a.npy"}, {"path": "data/a.raw", **RAW}, {"path": "data/../data/a.npy"}, {"path": "./data/a.npy"}],
)
@pytest.mark.every_pair
def test_files_in_the_folder_are_opened(place, kind, volume):
    np.testing.assert_array_equal(samples_of(ws.Scene.load(written(place, volume, kind))), SAMPLES)


def test_absolute_paths_in_the_folder_are_opened(place):
    path = written(place, {"path": str(place / "data" / "a.npy")})
    np.testing.assert_array_equal(samples_of(ws.Scene.load(path)), SAMPLES)


def elsewhere(place):
    """Volumes that lie elsewhere, or ask for more than they may, with the message of the error."""
    there = place.parent / "elsewhere"
    lies = "lies outside of the document's folder"
    return {
        "absolute": ({"path": str(there / "a.npy")}, lies),
        "raw": ({"path": str(there / "a.raw"), **RAW}, lies),
        "above": ({"path": "../elsewhere/a.npy"}, lies),
        "above, later": ({"path": "data/../../elsewhere/a.npy"}, lies),
        "beside, same start": ({"path": "../documents_2/a.npy"}, lies),
        "missing": ({"path": "../none.npy"}, lies),
        "list": ({"path": ["data/a.npy", "../elsewhere/a.npy"], "series_of_times": True}, lies),
        "pattern": ({"path": "../*/a.npy", "series_of_times": True}, lies),
        "pattern of a folder": ({"path": "data/*/../../../elsewhere/a.npy", "series_of_times": True}, lies),
        "wavelets": ({"path": "../a.wavelets"}, lies),
        "zero byte": ({"path": "data/a\0.npy"}, lies),
        "own allowance": ({"path": "data/a.npy", "external_files": True}, "which only you can allow"),
        "allowance of a text": ({"path": "data/a.npy", "external_files": "no"}, "which only you can allow"),
        "file": ({"path": (there / "a.npy").as_uri()}, "no address of a web server"),
        "bucket": ({"path": "s3://bucket/a.zarr"}, "no address of a web server"),
        "store": ({"path": "gs://bucket/a.zarr"}, "no address of a web server"),
        "chain": ({"path": "reference://::file:///tmp/refs.json"}, "no address of a web server"),
        "chain of http": ({"path": "http://127.0.0.1:9/a::file:///etc"}, "chains of protocols are not opened"),
        "cache": ({"path": "simplecache::http://127.0.0.1:9/a"}, "no address of a web server"),
        "archive": ({"path": "zip://a::file:///tmp/a.zip"}, "no address of a web server"),
        "local": ({"path": "local:///etc"}, "no address of a web server"),
        "ftp": ({"path": "ftp://127.0.0.1:9/a"}, "no address of a web server"),
    }


NAMES = [
    "absolute", "raw", "above", "above, later", "beside, same start", "missing", "list", "pattern",
    "pattern of a folder", "wavelets", "zero byte", "own allowance", "allowance of a text", "file", "bucket", "store",
    "chain", "chain of http", "cache", "archive", "local", "ftp",
]  # fmt: skip


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("kind", ["json", "png"])
def test_nothing_else_may_be_named(place, name, kind):
    volume, message = elsewhere(place)[name]
    with pytest.raises(FileError, match=message) as refused:
        ws.Scene.load(written(place, volume, kind))
    assert "layers[0].volume" in str(refused.value) or "chains" in message
    assert "\n" not in str(refused.value)
    assert "external_files=True (--external-files)" in str(refused.value) or "chains" in message
    with pytest.raises(FileError, match=message):
        ws.Scene.from_json(json.dumps(document_of(volume)), place)


def test_documents_do_not_say_where_is_written(place):
    volume = {"path": "data/a.npy", "memory": "50 MB", "cache": str(place / "kept")}
    for allowed in (False, True):
        with pytest.raises(ArgumentError, match="field 'cache'"):
            ws.Scene.load(written(place, volume), external_files=allowed)
    assert not (place / "kept").exists()


def test_names_of_tests_are_all(place):
    assert sorted(elsewhere(place)) == sorted(NAMES)


def test_labels_and_typefaces_are_data_too(place):
    fine = {"path": "data/a.npy"}
    for more, what in (
        ({"labels": {"volume": {"path": "../elsewhere/a.npy"}}}, r"scene: labels\.volume names '\.\./elsewhere"),
        ({"figure": {"title": "x", "font": "../elsewhere/a.ttf"}}, r"scene: figure\.font names '\.\./elsewhere"),
        ({"figure": {"font": "/etc/passwd"}}, r"scene: figure\.font names '/etc/passwd'"),
    ):
        with pytest.raises(FileError, match=what):
            ws.Scene.load(written(place, fine, **more))


@pytest.mark.skipif(sys.platform == "win32", reason="links need rights there")
def test_links_count_where_they_lead(place):
    there = place.parent / "elsewhere"
    (place / "in.npy").symlink_to(place / "data" / "a.npy")
    (place / "out.npy").symlink_to(there / "a.npy")
    (place / "out").symlink_to(there)
    (place / "stack").mkdir()
    (place / "stack" / "1.npy").symlink_to(there / "a.npy")
    np.testing.assert_array_equal(samples_of(ws.Scene.load(written(place, {"path": "in.npy"}))), SAMPLES)
    for volume in (
        {"path": "out.npy"},
        {"path": "out/a.npy"},
        {"path": "out.npy", "shape": [2, 2, 2], "dtype": "u1"},
        {"path": "stack/*.npy", "series_of_times": True},
        {"path": "stack"},
    ):
        with pytest.raises(FileError, match=OUT):
            ws.Scene.load(written(place, volume))
    # A folder that is reached by a link counts as the folder that the link leads to.
    path = written(place, {"path": "data/a.npy"})
    (place.parent / "link").symlink_to(place)
    np.testing.assert_array_equal(samples_of(ws.Scene.load(place.parent / "link" / path.name)), SAMPLES)
    absolute = written(place, {"path": str(place / "data" / "a.npy")})
    np.testing.assert_array_equal(samples_of(ws.Scene.load(place.parent / "link" / absolute.name)), SAMPLES)


@pytest.mark.skipif(sys.platform == "win32", reason="links need rights there")
def test_patterns_lead_nowhere_else(place):
    (place / "a1.npy").symlink_to(place.parent / "elsewhere" / "a.npy")
    path = written(place, {"path": "[a]*.npy", "series_of_times": True})
    with pytest.raises(FileError, match=OUT):
        ws.Scene.load(path)
    np.testing.assert_array_equal(ws.Scene.load(path, external_files=True).layers[0].volume[0].samples, SAMPLES)
    (place / "[a]*.npy").symlink_to("not there")  # has exactly this name, so it is no pattern
    for options in ({}, {"external_files": True}):
        with pytest.raises(FileError, match="no such file or folder"):
            ws.Scene.load(path, **options)


def test_patterns_in_folders_whose_names_look_like_patterns(place):
    folder = place / "scan [1]"
    folder.mkdir()
    for n in range(3):
        np.save(folder / f"t{n}.npy", SAMPLES + n)
    series = ws.Scene.load(written(folder, {"path": "t[12].npy", "series_of_times": True})).layers[0].volume
    assert len(series) == 2
    np.testing.assert_array_equal(series[0].samples, SAMPLES + 1)
    series = ws.Scene.load(written(place, {"path": "scan [1]/t*.npy", "series_of_times": True})).layers[0].volume
    assert len(series) == 3


@pytest.mark.skipif(sys.platform == "win32", reason="links need rights there")
@pytest.mark.parametrize("options", [{}, {"memory": "50 MB"}, {"series_of_times": True}])
@pytest.mark.parametrize("kind", ["DICOM", "TIFF", "Analyze"])
@pytest.mark.every_pair
def test_files_that_belong_to_the_named_one_may_not_be_links_out(place, kind, options):
    if kind == "DICOM" and "memory" in options:
        pytest.skip("not read in parts")
    if kind == "DICOM":
        dicom_files.save(place / "many", [dicom_files.slice_at(SAMPLES[n], n) for n in range(6)])
        linked, named = "002.dcm", ["many/000.dcm", "many"]
    elif kind == "TIFF":
        tifffile = pytest.importorskip("tifffile")
        (place / "many").mkdir()
        for number, one in enumerate(SAMPLES):
            tifffile.imwrite(place / "many" / f"{number}.tif", one)
        linked, named = "2.tif", ["many"]
    else:
        nibabel = pytest.importorskip("nibabel")
        (place / "many").mkdir()
        nibabel.save(nibabel.Nifti1Pair(SAMPLES.T, np.eye(4)), place / "many" / "a.b.img")
        linked, named = "a.b.img", ["many/a.b.hdr"]
    paths = [written(place, {"path": one, **options}) for one in named]
    for path, one in zip(paths, named, strict=True):
        written(place, {"path": one, **options})
        volume = ws.Scene.load(path).layers[0].volume
        np.testing.assert_array_equal(all_of(volume[0] if options.get("series_of_times") else volume), SAMPLES)
    (place / "many" / linked).rename(place.parent / "elsewhere" / linked)
    (place / "many" / linked).symlink_to(place.parent / "elsewhere" / linked)
    for path, one in zip(paths, named, strict=True):
        written(place, {"path": one, **options})
        with pytest.raises(FileError, match=f"'{linked}' is a link out of the folder of the document"):
            ws.Scene.load(path)
        assert ws.Scene.load(path, external_files=True).layers[0].volume is not None


@pytest.mark.skipif(sys.platform == "win32", reason="links need rights there")
@pytest.mark.parametrize("options", [{}, {"memory": "50 MB"}])
def test_chunks_may_not_be_links_out(place, options):
    import zarr

    zarr.create_array(place / "a.zarr", data=SAMPLES, chunks=(6, 7, 8), compressors=None)
    volume = {"path": "a.zarr", **options}
    path = written(place, volume)
    np.testing.assert_array_equal(all_of(ws.Scene.load(path).layers[0].volume), SAMPLES)
    chunk = place / "a.zarr" / "c" / "0" / "0" / "0"
    chunk.rename(place.parent / "elsewhere" / "chunk")
    chunk.symlink_to(place.parent / "elsewhere" / "chunk")
    with pytest.raises(FileError, match="is a link out of the folder of the document"):
        all_of(ws.Scene.load(path).layers[0].volume)
    np.testing.assert_array_equal(all_of(ws.Scene.load(path, external_files=True).layers[0].volume), SAMPLES)
    # The user may open what links lead to.
    np.testing.assert_array_equal(ws.open(place / "a.zarr").samples, SAMPLES)


def test_later_times_of_a_series_reach_no_further(place):
    import zarr

    data = np.stack([SAMPLES, SAMPLES + 1])
    zarr.create_array(place / "t.zarr", data=data, chunks=(1, 6, 7, 8), compressors=None)
    chunk = place / "t.zarr" / "c" / "1" / "0" / "0" / "0"
    chunk.rename(place.parent / "elsewhere" / "chunk")
    chunk.symlink_to(place.parent / "elsewhere" / "chunk")
    series = ws.Scene.load(written(place, {"path": "t.zarr", "series_of_times": True})).layers[0].volume
    np.testing.assert_array_equal(series[0].samples, SAMPLES)
    with pytest.raises(FileError, match="is a link out of the folder of the document"):
        series[1]


def test_files_named_by_files_need_the_user_and_the_document(place, monkeypatch):
    h5py = pytest.importorskip("h5py")
    with h5py.File(place / "x.h5", "w") as file:
        file.create_dataset("x", shape=(6, 7, 8), dtype="u1", external=[("../elsewhere/a.raw", 0, 336)])
    for volume, options in (
        ({"path": "x.h5"}, {}),
        ({"path": "x.h5", "external_files": True}, {}),
        ({"path": "x.h5"}, {"external_files": True}),
    ):
        with pytest.raises(FileError, match="external_files"):
            ws.Scene.load(written(place, volume), **options)
    monkeypatch.chdir(place)
    scene = ws.Scene.load(written(place, {"path": "x.h5", "external_files": True}), external_files=True)
    assert scene.layers[0].drawn.shape == (6, 7, 8)


# Servers

#: Hosts that systems take for 127.0.0.1.
NUMBERS = ("127.1", "127.0.1", "2130706433", "0177.0.0.1", "127.0.0.1.", "0x7f.1", "0x7f000001")


def test_documents_do_not_ask_private_servers(place):
    import zarr

    pytest.importorskip("aiohttp")
    zarr.create_array(place / "a.zarr", data=SAMPLES, compressors=None)
    with OddServer(place) as server:
        port = server.address.rpartition(":")[2]
        for host in ("127.0.0.1", "localhost", "[::ffff:127.0.0.1]", *NUMBERS):
            for options in ({}, {"memory": "50 MB"}, {"series_of_times": True}):
                path = written(place, {"path": f"http://{host}:{port}/a.zarr", **options})
                with pytest.raises(FileError, match=f"is this machine or lies in a private network.*{ALLOWED}"):
                    ws.Scene.load(path)
        assert server.asked == []
        path = written(place, {"path": f"{server.address}/a.zarr"})
        np.testing.assert_array_equal(samples_of(ws.Scene.load(path, external_files=True)), SAMPLES)


def test_public_servers_are_asked_where_names_lead_to_public_hosts(place, monkeypatch):
    import zarr

    pytest.importorskip("aiohttp")
    from wavesplat._storage import web

    zarr.create_array(place / "a.zarr", data=SAMPLES, compressors=None)
    monkeypatch.setattr(web, "is_public", lambda host: host in ("127.0.0.1", "::1"))
    with OddServer(place) as server:
        path = written(place, {"path": f"{server.address}/a.zarr"})
        np.testing.assert_array_equal(samples_of(ws.Scene.load(path)), SAMPLES)


# Permissions by the user, and round trips


@pytest.mark.parametrize("name", ["absolute", "raw", "above", "list", "file"])
def test_the_user_may_allow_it(place, name):
    volume, _ = elsewhere(place)[name]
    path = written(place, volume)
    np.testing.assert_array_equal(samples_of(ws.Scene.load(path, external_files=True)), SAMPLES)
    scene = ws.Scene.from_json(json.dumps(document_of(volume)), place, external_files=True)
    np.testing.assert_array_equal(samples_of(scene), SAMPLES)
    with pytest.raises(FileError, match="not opened"):
        ws.Scene.load(written(place, {"path": "zip://a::file:///tmp/a.zip"}), external_files=True)


def test_saving_says_how_it_is_opened_again(place, monkeypatch):
    there = place.parent / "elsewhere"
    scene = ws.Scene(ws.open(there / "a.npy"), "grey")
    scene.save(there / "beside.json")
    np.testing.assert_array_equal(samples_of(ws.Scene.load(there / "beside.json")), SAMPLES)
    with pytest.warns(WavesplatWarning, match=f"does not lie in the folder of the scene.*{ALLOWED}"):
        scene.save(place / "away.json")
    with pytest.raises(FileError, match=f"lies outside of the document's folder.*{ALLOWED}"):
        ws.Scene.load(place / "away.json")
    np.testing.assert_array_equal(samples_of(ws.Scene.load(place / "away.json", external_files=True)), SAMPLES)
    # Documents as text need no permission for files in the working folder.
    monkeypatch.chdir(there)
    np.testing.assert_array_equal(samples_of(ws.Scene.from_json(scene.to_json())), SAMPLES)


def test_the_command_line_draws_again_what_lies_elsewhere(wavesplat, place):
    there = place.parent / "elsewhere" / "a.npy"
    a, b = place / "a.png", place / "b.png"
    assert wavesplat("render", there, "-o", a, "--size", "24x20", "--embed-paths").returncode == 0
    refused = wavesplat("render", "--from", a, "-o", b)
    assert refused.returncode != 0
    assert "--external-files" in refused.stderr
    assert not b.exists()
    done = wavesplat("render", "--from", a, "-o", b, "--external-files", "--embed-paths")
    assert done.returncode == 0, done.stderr
    assert b.read_bytes() == a.read_bytes()
    # Moved beside its data, the document needs no permission.
    shutil.copy(there, place / "a.npy")
    moved = ws.render(ws.open(place / "a.npy"), size=(24, 20))
    moved.save(place / "c.png")
    assert wavesplat("render", "--from", place / "c.png", "-o", b).returncode == 0


def test_the_viewer_opens_states_so(place):
    from wavesplat._cli.commands import view
    from wavesplat._cli.options.opened_layers import OpeningOptions
    from wavesplat._cli.options.reader import ReaderOptions
    from wavesplat._cli.options.scene import SceneOptions
    from wavesplat._cli.options.view import ViewOptions

    volume, _ = elsewhere(place)["absolute"]
    path = written(place, volume)
    own = view.OpenedOptions(state=path)
    trusting = SceneOptions(OpeningOptions(reader=ReaderOptions(external_files=True)))
    with pytest.raises(FileError, match="lies outside of the document's folder"):
        view._opened(None, own, SceneOptions(), ViewOptions(), quiet=True)
    opened = view._opened(None, own, trusting, ViewOptions(), quiet=True)
    np.testing.assert_array_equal(samples_of(opened.scene), SAMPLES)


def test_typefaces_are_named_from_the_folder(place, monkeypatch):
    from importlib.resources import files

    fonts = [
        entry for entry in (files("wavesplat") / "data" / "liberation_sans").iterdir() if entry.name.endswith("ttf")
    ]
    shutil.copy(str(fonts[0]), place / "own.ttf")
    monkeypatch.chdir(place)
    picture = ws.render(ws.open("data/a.npy"), size=(120, 100)).annotated(title="A", font="own.ttf")
    picture.save("a.png", embed_paths=True)
    monkeypatch.chdir(place.parent)
    document = scene_files.load(place / "a.png")
    assert document.figure["font"] == str(place / "own.ttf")
    assert json.loads(text_in((place / "a.png").read_bytes(), "wavesplat"))["figure"]["font"] == "own.ttf"


# Values that are refused when a document is read


@pytest.mark.parametrize(
    ("more", "message"),
    [
        ({"version": True}, "field 'version' is True"),
        ({"version": 1.0}, r"field 'version' is 1\.0"),
        ({"render": {"size": [-1, 0]}}, r"render: field 'size' is \[-1, 0\]; .*, 1 to 16384 pixels"),
        ({"render": {"size": [True, 5]}}, "field 'size' is a list"),
        ({"render": {"size": [10**9, 5]}}, "it must be .width, height., 1 to 16384 pixels each"),
        (
            {"clip": [{"plane": {"point": [0, 0, 0], "normal": [0, 0, 1]}}] * 5000},
            "field 'clip' is a list; it must be a list of at most 256",
        ),
    ],
)
def test_values_that_would_fail_later(place, more, message):
    with pytest.raises(ArgumentError, match=message):
        ws.Scene.load(written(place, {"path": "data/a.npy"}, **more))


def test_versions_of_looks_are_whole_numbers():
    text = json.loads(ws.Look.preset("ct-bone").to_json())
    for version in (True, 1.0):
        with pytest.raises(ArgumentError, match="version"):
            ws.Look.from_json(json.dumps(text | {"version": version}))


def test_marks_of_the_byte_order_are_left_out(place):
    path = written(place, {"path": "data/a.npy"})
    path.write_bytes(b"\xef\xbb\xbf" + path.read_bytes())
    np.testing.assert_array_equal(samples_of(ws.Scene.load(path)), SAMPLES)
    look = place / "look.json"
    look.write_text("\ufeff" + ws.Look.preset("ct-bone").to_json(), encoding="utf-8")
    assert ws.Look.load(look).name == "ct-bone"


def test_scans_of_the_package_are_named_from_anywhere(place):
    volume = ws.Scene.load(written(place, {"example": "ct_pelvis"})).layers[0].volume
    np.testing.assert_array_equal(volume.samples, ws.examples.ct_pelvis().samples)


def test_examples_that_are_too_large(place):
    with pytest.raises(LimitError, match="the samples of a test signal, 100000 along each axis, need"):
        ws.Scene.load(written(place, {"example": "ripples", "n": 100_000}))


@pytest.mark.skipif(sys.platform == "win32", reason="links need rights there")
@pytest.mark.parametrize("options", [{}, {"memory": "50 MB"}])
def test_files_that_files_name_may_not_be_links_out(place, options):
    header = "NRRD0004\ntype: uint8\ndimension: 3\nsizes: 8 7 6\nencoding: raw\ndata file: samples.raw\n"
    (place / "a.nhdr").write_text(header)
    (place / "samples.raw").write_bytes(SAMPLES.tobytes())
    path = written(place, {"path": "a.nhdr", **options})
    np.testing.assert_array_equal(all_of(ws.Scene.load(path).layers[0].volume), SAMPLES)
    (place / "samples.raw").unlink()
    (place / "samples.raw").symlink_to(place.parent / "elsewhere" / "a.raw")
    with pytest.raises(FileError, match="a link to another folder"):
        ws.Scene.load(path)
    np.testing.assert_array_equal(all_of(ws.Scene.load(path, external_files=True).layers[0].volume), SAMPLES)
    # The user's own links are followed, as before.
    np.testing.assert_array_equal(all_of(ws.open(place / "a.nhdr", **options)), SAMPLES)


@pytest.mark.skipif(sys.platform == "win32", reason="links need rights there")
def test_other_parts_of_a_file_may_not_be_links_out(place):
    import nibabel

    nibabel.Nifti1Pair(SAMPLES, np.eye(4)).to_filename(place / "a.img")
    path = written(place, {"path": "a.hdr"})
    wanted = samples_of(ws.Scene.load(path))
    (place / "a.img").rename(place.parent / "elsewhere" / "a.img")
    (place / "a.img").symlink_to(place.parent / "elsewhere" / "a.img")
    with pytest.raises(FileError, match="'a.img' is a link out of the folder of the document"):
        ws.Scene.load(path)
    np.testing.assert_array_equal(samples_of(ws.Scene.load(path, external_files=True)), wanted)
