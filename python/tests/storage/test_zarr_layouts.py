"""OME-Zarr files that hold several images: series of bioformats2raw, plates, labels of an image, zip archives."""

from __future__ import annotations

import json
import pickle
import zipfile

import numpy as np
import pytest
from PIL import Image
from zarr_images import LOOK, cells, labelled, opened, plate, series, write_image, zipped

import wavesplat as ws
from wavesplat.errors import FileError

VERSIONS = pytest.mark.parametrize("version", ["0.4", "0.5"])
SAMPLES, NUMBERS = cells()


# Labels


@VERSIONS
def test_labels_have_the_colours_of_the_file(tmp_path, version):
    """Microscopy, section 3: a red label was drawn orange."""
    image = labelled(tmp_path / "a.ome.zarr", version)
    for labels in (
        ws.Labels.open(image / "labels" / "nuclei"),
        ws.Labels.open("nuclei", scan=ws.open(image)),
        ws.Labels.open("nuclei", scan=ws.open(image, memory="100 MB")),
    ):
        assert labels.labels == {1: ws.Label((1, 0, 0), name="nucleus"), 2: ws.Label((0, 0, 1), name="2")}
        np.testing.assert_array_equal(labels.segmentation.samples, NUMBERS)
    hidden = ws.TransferFunction([(0, 0.0), (1000, 0.0)], [(0, 1, 1, 1)])
    picture = ws.render(ws.open(image), hidden, labels=labels, size=(40, 40))
    reds = picture.rgba[picture.rgba[..., 0] > 0.5]
    assert len(reds)
    assert (np.median(reds[:, 1:3], axis=0) < 0.15).all(), "red, no orange"


def test_labels_by_name_are_those_of_the_image_that_is_shown(tmp_path):
    scan = ws.open(series(tmp_path / "b.zarr"))
    np.testing.assert_array_equal(ws.Labels.open("nuclei", scan=scan).segmentation.samples, NUMBERS)
    with pytest.raises(FileError, match="no such file"):
        ws.Labels.open("nuclei", scan=ws.open(tmp_path / "b.zarr", dataset="1"))
    image = labelled(tmp_path / "a.ome.zarr")
    coarse = ws.Labels.open("nuclei", scan=ws.open(image, level=1))
    np.testing.assert_array_equal(coarse.segmentation.samples, NUMBERS[::2, ::2, ::2])
    with pytest.raises(FileError, match="no labels of the image, which has nuclei, plain; check the name: nucleus"):
        ws.Labels.open("nucleus", scan=ws.open(image))


def test_a_file_of_that_name_comes_first(tmp_path, monkeypatch):
    scan = ws.open(labelled(tmp_path / "a.ome.zarr"))
    monkeypatch.chdir(tmp_path)
    write_image(opened(tmp_path / "nuclei"), 7 * NUMBERS)
    assert ws.Labels.open("nuclei", scan=scan).numbers == (0, 7, 14)


def test_labels_in_a_scene_are_opened_again(tmp_path):
    scan = ws.open(labelled(tmp_path / "a.ome.zarr"))
    scene = ws.Scene(ws.Layer(scan), labels=ws.Labels.open("nuclei", scan=scan))
    scene.save(tmp_path / "a.json")
    again = ws.Scene.load(tmp_path / "a.json")
    np.testing.assert_array_equal(again.labels.segmentation.samples, NUMBERS)
    assert again.labels.labels == scene.labels.labels


def test_a_segmentation_alone_is_labels(tmp_path):
    numbers = np.zeros_like(NUMBERS)
    numbers[::2, ::2, ::2] = np.arange(numbers[::2, ::2, ::2].size).reshape(numbers[::2, ::2, ::2].shape) % 50
    write_image(opened(tmp_path / "l.zarr"), numbers, more={"image-label": {}})
    assert ws.Look.auto(ws.open(tmp_path / "l.zarr")).reason == "labels: the file says SEG"


@pytest.mark.parametrize(
    "look",
    [
        {"colors": 5, "properties": {}},
        {"colors": [5, {"label-value": "1"}, {"label-value": 1, "rgba": [300, 0, 0]}, {"label-value": True}]},
        {"colors": [{"label-value": 1, "rgba": "red"}], "properties": [{"label-value": 1, "class": 5}]},
    ],
)
def test_odd_metadata_of_labels_are_left_out(tmp_path, look):
    write_image(opened(tmp_path / "a.zarr"), SAMPLES, labels={"odd": (NUMBERS, look)})
    labels = ws.Labels.open(tmp_path / "a.zarr" / "labels" / "odd")
    assert labels.labels == ws.Labels(NUMBERS).labels


@VERSIONS
def test_info_lists_labels(tmp_path, wavesplat, version):
    image = labelled(tmp_path / "a.ome.zarr", version)
    assert json.loads(wavesplat("info", image, "--json").stdout)["label_images"] == ["nuclei", "plain"]
    told = wavesplat("info", image / "labels" / "nuclei").stdout
    assert "nucleus, #ff0000" in told
    done = wavesplat("render", image, "--labels", "nuclei", "-o", tmp_path / "a.png", "--size", "40", "--json")
    assert done.returncode == 0, done.stderr


# Series


@VERSIONS
@pytest.mark.parametrize("is_listed", [True, False])
def test_the_first_image_of_a_series_is_opened_and_the_others_are_named(tmp_path, version, is_listed):
    path = series(tmp_path / "b.zarr", version, is_listed=is_listed)
    for volume in (ws.open(path), ws.open(path, memory="100 MB")):
        assert volume.guesses[0] == "0 of 2 images in the file, 0, 1; choose one with dataset= (--dataset)"
        np.testing.assert_array_equal(np.asarray(volume), SAMPLES)
    np.testing.assert_array_equal(ws.open(path, dataset="1").samples, SAMPLES + 1000)
    assert ws.open(path, dataset="1").spacing == (0.5, 0.5, 1.0)


def test_info_lists_the_images_of_a_series(tmp_path, wavesplat):
    path = series(tmp_path / "b.zarr")
    facts = json.loads(wavesplat("info", path, "--json").stdout)
    assert facts["images"] == [{"path": "0", "name": "left"}, {"path": "1", "name": "right"}]
    assert facts["label_images"] == ["nuclei"]
    assert "0 'left', 1 'right'" in wavesplat("info", path).stdout
    (path / "OME" / "METADATA.ome.xml").write_text('<!DOCTYPE a [<!ENTITY b "c">]><OME><Image Name="&b;"/></OME>')
    assert json.loads(wavesplat("info", path, "--json").stdout)["images"][0]["name"] == ""


# Plates


@VERSIONS
def test_a_plate_names_its_wells_and_how_to_choose(tmp_path, version):
    path = plate(tmp_path / "p.zarr", version, n_fields=2)
    with pytest.raises(FileError, match=r"a plate of 4 wells, A1, A2, B1, B2, with 8 images.*dataset='A/1/0'"):
        ws.open(path)
    with pytest.raises(FileError, match=r"the well B2 with 2 images; choose one with dataset='0'"):
        ws.open(path / "B" / "2")
    np.testing.assert_array_equal(ws.open(path, dataset="B/2/1").samples, SAMPLES + 301)
    np.testing.assert_array_equal(ws.open(path / "B" / "2", dataset="1").samples, SAMPLES + 301)


def test_a_well_of_one_field_is_its_image(tmp_path):
    path = plate(tmp_path / "p.zarr")
    np.testing.assert_array_equal(ws.open(path / "A" / "2").samples, SAMPLES + 100)
    np.testing.assert_array_equal(ws.open(path, dataset="A/2").samples, SAMPLES + 100)


def test_labels_of_the_image_of_a_well(tmp_path):
    path = plate(tmp_path / "p.zarr")
    write_image(opened(path / "A" / "2" / "0"), SAMPLES, labels={"nuclei": (NUMBERS, LOOK)})
    for scan in (ws.open(path / "A" / "2"), ws.open(path, dataset="A/2"), ws.open(path, dataset="A/2/0")):
        assert ws.Labels.open("nuclei", scan=scan).labels[1].color == (1, 0, 0)


def test_info_lists_wells_and_fields(tmp_path, wavesplat):
    done = wavesplat("info", plate(tmp_path / "p.zarr", n_fields=2), "--json")
    facts = json.loads(done.stdout)
    assert facts["wells"][1] == {"name": "A2", "path": "A/2", "fields": ["0", "1"]}
    assert [well["name"] for well in facts["wells"]] == ["A1", "A2", "B1", "B2"]
    assert facts["choices"][0]["names"][:3] == ["A/1/0", "A/1/1", "A/2/0"]
    assert "well A2      A/2, 2 fields: 0, 1" in wavesplat("info", tmp_path / "p.zarr").stdout


def test_outputs_are_named_by_wells_fault_6(tmp_path, wavesplat):
    plate(tmp_path / "p.zarr", n_fields=2)
    render = ("render", "p.zarr/*/*/0", "--size", "16", "-o")
    done = wavesplat(*render, "{folder}_{stem}.png", cwd=tmp_path)
    assert "write {well} or {path} in its name" in done.stderr
    assert wavesplat(*render, "{well}.png", cwd=tmp_path).returncode == 0
    assert wavesplat(*render, "{path}.png", cwd=tmp_path).returncode == 0
    made = {file.name for file in tmp_path.glob("*.png")}
    assert made == {"A1.png", "A2.png", "B1.png", "B2.png", "A_1_0.png", "A_2_0.png", "B_1_0.png", "B_2_0.png"}
    done = wavesplat("render", "p.zarr/B/2/1", "--size", "16", "-o", "{well}_{field}.png", cwd=tmp_path)
    assert (tmp_path / "B2_1.png").exists(), done.stderr
    done = wavesplat("render", "p.zarr/B/2/*[0-1]", "--size", "16", "-o", "{well}.png", cwd=tmp_path)
    assert "write {field} or {path} in its name" in done.stderr
    labelled(tmp_path / "a.zarr")
    done = wavesplat("render", "a.zarr", "--size", "16", "-o", "{well}.png", cwd=tmp_path)
    assert "name the images of a plate" in done.stderr
    assert done.returncode != 0


def test_the_wells_of_a_plate_on_a_sheet(tmp_path, wavesplat):
    plate(tmp_path / "p.zarr")
    (tmp_path / "p.zarr" / "A" / "2").rename(tmp_path / "away")
    options = ("-o", "{well}.png", "--size", "80x64", "--sheet", "sheet.png", "--json")
    done = wavesplat("render", "p.zarr/*/*/0", *options, cwd=tmp_path)
    facts = json.loads(done.stdout)["results"][-1]
    assert (facts["sheet"], facts["names"]) == ("sheet.png", ["A1", "B1", "B2"])
    sheet = np.asarray(Image.open(tmp_path / "sheet.png").convert("RGB")).astype(int)
    assert sheet.shape[1] == 2 * 80 + 3 * 2
    first, second = sheet[2:66, 2:82], sheet[2:66, 84:164]
    np.testing.assert_array_equal(first, np.asarray(Image.open(tmp_path / "A1.png").convert("RGB")))
    assert np.ptp(second) == 0, "the place of A2, which is not there"
    done = wavesplat("render", "p.zarr/*/*/0", "-o", "{well}.png", "--sheet", "B1.png", cwd=tmp_path)
    assert "the same file" in done.stderr


@pytest.mark.parametrize("wells", [5, [5, {}], [{"path": "../../etc"}], [{"path": "A/9"}], []])
def test_odd_plates_have_no_image(tmp_path, wells):
    group = opened(tmp_path / "p.zarr")
    group.attrs["ome"] = {"version": "0.5", "plate": {"wells": wells}}
    with pytest.raises(FileError, match="without an OME-Zarr image|leads out of the Zarr folder"):
        ws.open(tmp_path / "p.zarr")


# Archives


@pytest.mark.parametrize("name", ["a.ozx", "a.ome.zarr.zip", "a.zip"])
@pytest.mark.parametrize("top", ["", "a.ome.zarr/"])
@pytest.mark.parametrize("packing", [zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED])
def test_archives_are_read_in_place(tmp_path, name, top, packing):
    archive = zipped(labelled(tmp_path / "a.ome.zarr"), tmp_path / name, top=top, packing=packing)
    volume, lazy = ws.open(archive), ws.open(archive, memory="100 MB")
    np.testing.assert_array_equal(volume.samples, SAMPLES)
    assert volume.facts == ws.open(tmp_path / "a.ome.zarr").facts
    assert lazy.levels == ((20, 24, 24), (10, 12, 12))
    sent = pickle.loads(pickle.dumps(lazy))  # noqa: S301 - made here
    np.testing.assert_array_equal(sent.read(level=1).samples, SAMPLES[::2, ::2, ::2])
    assert ws.Labels.open("nuclei", scan=volume).labels[1].color == (1, 0, 0)


def test_info_of_an_archive(tmp_path, wavesplat):
    archive = zipped(labelled(tmp_path / "a.ome.zarr"), tmp_path / "a.ozx")
    facts = json.loads(wavesplat("info", archive, "--json").stdout)
    assert (facts["shape_zyx"], facts["label_images"]) == ([20, 24, 24], ["nuclei", "plain"])
    assert "nucleus, #ff0000" in wavesplat("info", archive, "--dataset", "labels/nuclei").stdout


def test_shards_in_an_archive_are_read_by_ranges(tmp_path):
    group = opened(tmp_path / "s.zarr")
    samples = np.random.default_rng(1).integers(0, 255, (32, 32, 32), np.uint8)
    group.create_array("0", data=samples, chunks=(8, 8, 8), shards=(32, 32, 32))
    archive = zipped(tmp_path / "s.zarr", tmp_path / "s.ozx")
    lazy = ws.open(archive, dataset="0", memory="10 MB")
    np.testing.assert_array_equal(lazy.arrays(0).read((8, 0, 0), (16, 8, 8)), samples[8:16, :8, :8])


def test_archives_that_are_no_images_say_so(tmp_path):
    folder = tmp_path / "f"
    folder.mkdir()
    (folder / "a.txt").write_text("no image")
    with pytest.raises(FileError, match="the archive holds no Zarr array or group at its top"):
        ws.open(zipped(folder, tmp_path / "a.ozx"))
    (tmp_path / "b.ozx").write_bytes(b"nothing")
    with pytest.raises(FileError, match="the archive is truncated or damaged"):
        ws.open(tmp_path / "b.ozx")
    archive = zipped(labelled(tmp_path / "a.ome.zarr"), tmp_path / "c.ozx")
    archive.write_bytes(archive.read_bytes()[:-40])
    with pytest.raises(FileError, match="truncated or damaged"):
        ws.open(archive)


def test_an_entry_is_no_longer_than_a_chunk_can_be(tmp_path):
    image = tmp_path / "a.ome.zarr"
    write_image(opened(image), SAMPLES)
    chunk = next(file for file in (image / "0").rglob("*") if file.is_file() and file.name != "zarr.json")
    chunk.write_bytes(bytes(10_000_000))
    archive = zipped(image, tmp_path / "a.ozx", packing=zipfile.ZIP_DEFLATED)
    with pytest.raises(FileError, match="there can be at most"):
        ws.open(archive)
