"""Scenes as documents: a written scene is read back and draws the same bytes; errors name the field."""

from __future__ import annotations

import json
import shutil
from importlib.resources import files
from pathlib import Path

import jsonschema
import numpy as np
import pytest

import wavesplat as ws
from wavesplat._picture.picture_files import text_in, with_text
from wavesplat._scene.documents import scene_files, scene_json
from wavesplat.errors import ArgumentError, FileError, WavesplatWarning

FIXTURES = Path(__file__).parents[1] / "fixtures" / "scenes"
SCHEMA = files("wavesplat") / "_scene" / "documents" / "scene.schema.json"
SIZE = (24, 20)


@pytest.fixture
def folder(tmp_path):
    """A folder for documents, with a segmentation in it."""
    labels = np.zeros((16, 16, 16), np.uint8)
    labels[4:9, 4:12, 3:8] = 1
    np.save(tmp_path / "labels.npy", labels)
    np.save(tmp_path / "noise.npy", np.random.default_rng(1).integers(0, 255, (16, 16, 16)).astype(np.uint8))
    return tmp_path


def fixtures(*folders):
    return [pytest.param(path, id=path.stem) for name in folders for path in sorted((FIXTURES / name).glob("*.json"))]


def drawn(document):
    return document.scene.render(document.camera, **{"size": SIZE} | document.options)


# Fixtures


@pytest.mark.parametrize("path", fixtures("good", "version_1"))
def test_good_documents_are_drawn_and_written_as_they_were_read(path, folder):
    document = scene_json.parse(path.read_text(), folder)
    picture = drawn(document)
    assert picture.rgba.max() > 0
    text = document.scene.to_json()
    again = ws.Scene.from_json(text, folder)
    assert again.to_json() == text
    np.testing.assert_array_equal(
        again.render(document.camera, **document.options | {"size": picture.size}).rgba, picture.rgba
    )


def test_a_hidden_layer_is_read_as_it_was_written(tmp_path):
    """Its look is needed once it is shown."""
    volume = ws.examples.ripples(8)
    scene = ws.Scene([volume, ws.Layer(volume, "no preset", visible=False)])
    again = ws.Scene.from_json(scene.to_json())
    np.testing.assert_array_equal(again.render(size=SIZE).rgba, scene.render(size=SIZE).rgba)
    with pytest.raises(ArgumentError, match="unknown preset"):
        ws.Scene.from_json(scene.to_json().replace('"visible": false', '"visible": true'))


@pytest.mark.parametrize("path", fixtures("bad"))
def test_bad_documents_are_refused_with_the_name_of_the_field(path, folder):
    case = json.loads(path.read_text())
    with pytest.raises(ArgumentError) as refused:
        scene_json.parse(json.dumps(case["document"]), folder)
    assert case["error"] in str(refused.value)
    assert "\n" not in str(refused.value)


@pytest.mark.parametrize("text", ["", "[]", "3", "{", "[[[", '{"wavesplat": "camera"}', '{"report": {"scene": 3}}'])
def test_what_is_no_document(text):
    with pytest.raises(ArgumentError, match="scene: "):
        ws.Scene.from_json(text)


def test_the_schema_says_the_same_of_good_and_bad_documents(folder):
    check = jsonschema.Draft202012Validator(json.loads(SCHEMA.read_text(encoding="utf-8")))
    for path in (FIXTURES / "good").glob("*.json"):
        document = json.loads(path.read_text())
        assert list(check.iter_errors(document)) == [], path
        report = drawn(scene_json.parse(path.read_text(), folder)).report
        assert list(check.iter_errors(report["scene"])) == [], path
    # Documents that are wrong only by their values, which the schema cannot check.
    known = {"unknown_option", "step_of_wavelets", "wrong_step", "shading", "plane", "background", "no_file"}
    for path in (FIXTURES / "bad").glob("*.json"):
        if path.stem not in known:
            assert list(check.iter_errors(json.loads(path.read_text())["document"])) != [], path


# The same bytes


def scenes(folder):
    noise = ws.open(folder / "noise.npy", spacing=(1, 1, 2))
    ct = ws.examples.ct_pelvis()
    corner = ws.CutOut(ws.Crop.corner(ct, "left anterior superior"))
    table = ws.TransferFunction2D([0, 255], [0, 40], np.linspace(0, 1, 16).reshape(2, 2, 4))
    labels = ws.Labels(ws.open(folder / "labels.npy"), {1: ws.Label("#40a0e0", name="box")})
    return {
        "automatic": (ws.Scene(ct, clip=corner), {}),
        "on white": (ws.Scene(ct, background="white"), {"composite": "mean"}),
        "of a colour": (ws.Scene(ct, background=(0.9, 0.9, 1.0)), {"composite": "x-ray"}),
        "light": (ws.Scene(noise, "grey", shading=ws.Shading(ambient=0.5)), {"kernel": "bspline3"}),
        "unlit": (ws.Scene(noise, table, shading=None), {"quality": ws.Sampling(3)}),
        "surface": (ws.Scene(noise.smoothed(0.8), "grey"), {"composite": ws.FirstHit(120), "quality": "high"}),
        "labels": (ws.Scene(ws.examples.ripples(16), ws.TransferFunction.diverging(300), labels=labels), {}),
        "layers": (ws.Scene([ws.Layer(ct, "ct-bone"), ws.Layer(ct.smoothed(1), "ct-skin", opacity=0.3)]), {}),
        "hidden": (ws.Scene([ws.Layer(ct, visible=False), ws.Layer(ct, "ct-bone")]), {}),
        "channels": (ws.Scene([noise, ws.examples.ripples(16)]), {"composite": "maximum"}),
        "wanted": (ws.Scene(noise, "grey"), {"psnr": 35}),
        "wavelets": (ws.Scene(ws.WaveletVolume.from_volume(noise, keep=0.3).level(1).bands([1, 0.5]), "grey"), {}),
    }


NAMES = [
    "automatic", "on white", "of a colour", "light", "unlit", "surface", "labels", "layers", "hidden", "channels",
    "wanted", "wavelets",
]  # fmt: skip


@pytest.mark.parametrize("name", NAMES)
def test_pictures_tell_how_to_draw_them_again(name, folder):
    scene, options = scenes(folder)[name]
    picture = scene.render(size=SIZE, **options)
    again = drawn(scene_json.parse(json.dumps(picture.report), folder))
    np.testing.assert_array_equal(again.rgba, picture.rgba)
    assert again.report["scene"] == picture.report["scene"]
    picture.save(folder / "a.png")
    drawn(scene_files.load(folder / "a.png")).save(folder / "b.png")
    assert (folder / "b.png").read_bytes() == (folder / "a.png").read_bytes()
    # A document keeps the scene as it was asked for.
    scene.save(folder / "scene.json")
    loaded = ws.Scene.load(folder / "scene.json")
    np.testing.assert_array_equal(loaded.render(size=SIZE, **options).rgba, picture.rgba)


def test_a_series_is_opened_again_at_its_time(folder):
    np.save(folder / "times.npy", np.random.default_rng(2).random((4, 8, 8, 8), np.float32))
    series = ws.open_series(folder / "times.npy")
    for shown, time in ((series, 2), (series[::2], 1)):
        scene = ws.Scene(ws.Layer(shown, "grey", time=time))
        again = ws.Scene.from_json(scene.to_json(), folder)
        assert (again.layers[0].time, len(again.layers[0].volume)) == (time, len(shown))
        np.testing.assert_array_equal(again.layers[0].drawn.samples, series[2].samples)
    processed = ws.Series([volume.smoothed(1) for volume in series])
    again = ws.Scene.from_json(ws.Scene(ws.Layer(processed, "grey", time=3)).to_json(), folder)
    np.testing.assert_array_equal(again.layers[0].drawn.samples, processed[3].samples)


# Files


def test_paths_move_with_the_folder(folder):
    scene = ws.Scene(ws.open(folder / "noise.npy"), "grey")
    want = scene.render(size=SIZE).rgba
    (folder / "there").mkdir()
    scene.save(folder / "scene.json")
    with pytest.warns(WavesplatWarning, match="does not lie in the folder of the scene"):
        scene.save(folder / "there" / "scene.json")
    assert json.loads((folder / "scene.json").read_text())["layers"][0]["volume"]["path"] == "noise.npy"
    assert json.loads((folder / "there" / "scene.json").read_text())["layers"][0]["volume"]["path"] == "../noise.npy"
    moved = folder.parent / f"{folder.name}_moved"
    shutil.copytree(folder, moved)
    (folder / "noise.npy").unlink()
    for name in ("scene.json", "there/scene.json"):
        loaded = ws.Scene.load(moved / name, external_files=name.startswith("there"))
        np.testing.assert_array_equal(loaded.render(size=SIZE).rgba, want)
    with pytest.raises(FileError, match="no such file"):
        ws.Scene.load(folder / "scene.json")
    (folder / "a" / "b").mkdir(parents=True)
    with pytest.warns(WavesplatWarning, match="does not lie in the folder of the scene"):
        scene.save(folder / "a" / "b" / "scene.json")
    path = json.loads((folder / "a" / "b" / "scene.json").read_text())["layers"][0]["volume"]["path"]
    assert Path(path).is_absolute()


def test_what_comes_from_no_file_is_said(folder):
    volume = ws.Volume(np.random.default_rng(3).random((8, 8, 8)), name="made")
    with pytest.raises(ArgumentError, match="the volume of layer 0, 'made', comes from no file"):
        ws.Scene(volume, "grey").to_json()
    with pytest.raises(ArgumentError, match="the labels come from no file"):
        ws.Scene(ws.examples.ripples(8), "grey", labels=ws.Labels(np.ones((8, 8, 8), np.uint8))).to_json()
    report = ws.render(volume, "grey", size=(8, 8)).report
    with pytest.raises(ArgumentError, match=r"layers\[0\].volume came from no file"):
        ws.Scene.from_json(json.dumps(report))
    shared = np.random.default_rng(3).random((8, 8, 8))
    np.save(folder / "a.npy", shared)
    opened = ws.open(folder / "a.npy")
    opened.changed()
    with pytest.raises(ArgumentError, match="comes from no file"):
        ws.Scene(opened, "grey").to_json()


def test_a_png_file_need_not_say_how_it_was_made(folder):
    picture = ws.render(ws.examples.ripples(8), size=(9, 9))
    picture.save(folder / "a.png", scene=False)
    with pytest.raises(ArgumentError, match="does not say how it was made"):
        ws.Scene.load(folder / "a.png")
    from PIL import Image

    picture.save(folder / "b.png", dpi=300)
    with Image.open(folder / "b.png") as image:
        assert json.loads(image.text["wavesplat"])["wavesplat"] == "scene"
        image.save(folder / "c.png")
    content = (folder / "b.png").read_bytes()
    for damaged in (content[: len(content) // 2], content[:60] + b"\0\0\0" + content[63:]):
        (folder / "d.png").write_bytes(damaged)
        with pytest.raises((ArgumentError, FileError)):
            ws.Scene.load(folder / "d.png")
    plain = (folder / "a.png").read_bytes()
    assert text_in(with_text(plain, "Comment", "öäü"), "Comment") == "öäü"
    assert text_in(plain, "Comment") is None


# The command line


def test_the_command_line_draws_again(wavesplat, folder):
    options = "--preset grey --azimuth 20 --size 30x24 --smooth 0.7 --cut-out -x+z --composite over --unit mm"
    a, b, report = folder / "a.png", folder / "b.png", folder / "report.json"
    done = wavesplat("render", folder / "noise.npy", "-o", a, "--report", report, *options.split())
    assert done.returncode == 0, done.stderr
    for source in (report, a):
        done = wavesplat("render", "--from", source, "-o", b, "--report", folder / "again.json")
        assert (done.returncode, done.stdout) == (0, f"{b}\n"), done.stderr
        assert b.read_bytes() == a.read_bytes()
        told, wanted = (json.loads(path.read_text())["report"] for path in (folder / "again.json", report))
        assert told["scene"] == wanted["scene"]
    scene = ws.Scene.load(a)
    document = scene_files.load(report)
    scene.render(document.camera, **document.options).save(b)
    assert b.read_bytes() == a.read_bytes()


def test_a_figure_is_drawn_again_with_what_is_on_it(wavesplat, folder):
    a, b, report = (folder / name for name in ("a.png", "b.png", "a.json"))
    figure = ["--scale-bar", "--axes", "--colorbar", "--title", "Noise", "--unit", "um", "--ink", "0.2,0.4,0.9"]
    options = ["--size", "220x180", "--report", report, *figure]
    done = wavesplat("render", folder / "noise.npy", "-o", a, *options)
    assert done.returncode == 0, done.stderr
    for source in (report, a):
        done = wavesplat("render", "--from", source, "-o", b)
        assert done.returncode == 0, done.stderr
        assert b.read_bytes() == a.read_bytes()
    document = json.loads(report.read_text())["report"]["scene"]
    assert document["figure"]["title"] == "Noise"
    with pytest.raises(ArgumentError, match="figure: unknown field 'caption'"):
        ws.Scene.from_json(json.dumps(document | {"figure": {"caption": "Noise"}}), folder)
    # Another figure can be made from the same picture.
    done = wavesplat("render", "--from", a, "-o", b, "--title", "Other")
    assert done.returncode == 0
    assert b.read_bytes() != a.read_bytes()


def test_the_command_line_need_not_tell(wavesplat, folder):
    done = wavesplat("render", folder / "noise.npy", "-o", folder / "a.png", "--size", "9x9", "--no-embed-scene")
    assert done.returncode == 0
    assert text_in((folder / "a.png").read_bytes(), "wavesplat") is None


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (["--azimuth", "3"], "--azimuth: --from has all that is drawn"),
        (["INPUT"], "INPUT: --from has all that is drawn"),
    ],
)
def test_beside_a_document_nothing_is_chosen(wavesplat, folder, options, message):
    ws.Scene(ws.examples.ripples(8), "grey").save(folder / "scene.json")
    done = wavesplat("render", "--from", folder / "scene.json", "-o", folder / "a.png", *options)
    assert done.returncode == 2
    assert message in done.stderr


@pytest.mark.parametrize("look", ["/etc/hostname", "no such preset", ""])
def test_looks_that_are_no_presets_are_refused_when_a_document_is_read(look):
    document = {
        "wavesplat": "scene", "version": 1, "layers": [{"volume": {"example": "ripples", "n": 8}, "look": look}]
    }  # fmt: skip
    with pytest.raises(ws.errors.ArgumentError, match=r"layers?.*field 'look'.*unknown preset"):
        ws.Scene.from_json(json.dumps(document))
