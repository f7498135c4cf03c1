"""Files that are published hold no names of folders, which may be those of patients, and are still drawn again."""

import contextlib
import gzip
import json
import os
import shutil
import warnings
import zipfile
from pathlib import Path

import dicom_files
import numpy as np
import pytest

import wavesplat as ws
from wavesplat._model.volume.private_names import file_name_of, without_folders
from wavesplat._picture.picture_files import text_in
from wavesplat._scene.documents import scene_files
from wavesplat._viewer.page_requests import export_html
from wavesplat._viewer.session.state import ViewerState
from wavesplat.errors import ArgumentError, FileError

PATIENT = "DOE_JOHN_1950"
SAMPLES = np.random.default_rng(0).integers(0, 200, (8, 9, 10)).astype(np.uint8)


@pytest.fixture
def patient(tmp_path):
    folder = tmp_path / PATIENT
    folder.mkdir()
    np.save(folder / "scan.npy", SAMPLES)
    np.save(folder / "labels.npy", (SAMPLES > 150).astype(np.uint8))
    return folder


def drawn(path, **options):
    document = scene_files.load(path, **options)
    return document.scene.render(document.camera, **document.options)


@pytest.mark.parametrize("name", ["x.png", "x.svg", "x.pdf", "x.jpg", "x.webp", "x.tif", "x.exr"])
def test_pictures_hold_no_folder_fault_23(patient, tmp_path, name):
    scan = ws.open(patient / "scan.npy")
    labels = ws.Labels.open(patient / "labels.npy")
    picture = ws.render([ws.Layer(scan, ws.TransferFunction.diverging(300))], labels=labels, size=(40, 30)).annotated(
        scale_bar=True, unit="mm"
    )
    assert PATIENT in picture.report.to_json(embed_paths=True)  # so that there is something to leave out
    assert PATIENT not in picture.report.to_json() + repr(picture.report) + json.dumps(picture.report)
    (tmp_path / "out").mkdir()
    picture.save(tmp_path / "out" / name)
    content = (tmp_path / "out" / name).read_bytes()
    assert PATIENT.encode() not in content
    assert PATIENT not in (text_in(content, "wavesplat") if name == "x.png" else "")
    if name == "x.png":
        document = json.loads(text_in(content, "wavesplat"))
        assert document["layers"][0]["volume"]["path"] == "scan.npy"
        assert document["labels"]["volume"]["path"] == "labels.npy"
        picture.save(tmp_path / "out" / name, embed_paths=True)
        assert PATIENT in text_in((tmp_path / "out" / name).read_bytes(), "wavesplat")


def test_movies_hold_no_folder_fault_23(patient, tmp_path):
    scan = ws.open(patient / "scan.npy")
    ws.movie(scan, tmp_path / "x.gif", ws.Turn(frames=2), size=(16, 16))
    ws.movie(scan, tmp_path / "frames", ws.Turn(frames=2), size=(16, 16))
    for path in [tmp_path / "x.gif", *(tmp_path / "frames").iterdir()]:
        assert PATIENT.encode() not in path.read_bytes()


def test_the_command_line_writes_no_folder_unless_asked_fault_23(wavesplat, patient, tmp_path):
    out = tmp_path / "out"
    out.mkdir()
    command = ["render", patient / "scan.npy", "-o", out / "x.png", "--report", out / "x.json", "--size", "20x16"]
    assert wavesplat(*command).returncode == 0
    report = json.loads((out / "x.json").read_text())
    assert (report["picture"], report["input"]) == ("x.png", "scan.npy")
    assert PATIENT not in (out / "x.json").read_text()
    assert PATIENT not in text_in((out / "x.png").read_bytes(), "wavesplat")
    refused = wavesplat("render", "--from", out / "x.png", "-o", out / "y.png")
    assert refused.returncode == 1, refused.stderr
    assert f"names 'scan.npy', and there is no such file in the document's folder, {out}, nor in" in refused.stderr
    assert wavesplat(*command, "--embed-paths").returncode == 0
    assert PATIENT in (out / "x.json").read_text()
    done = wavesplat("render", "--from", out / "x.png", "-o", out / "y.png", "--external-files")
    assert done.returncode == 0, done.stderr
    # The copy is public again.
    assert PATIENT not in text_in((out / "y.png").read_bytes(), "wavesplat")


def test_it_is_drawn_again_beside_the_data_or_in_their_folder_fault_23(patient, tmp_path, monkeypatch):
    picture = ws.render(ws.open(patient / "scan.npy"), "grey", size=(20, 16))
    (tmp_path / "out").mkdir()
    picture.save(tmp_path / "out" / "x.png")
    with pytest.raises(FileError, match=r"names 'scan\.npy', and there is no such file in the document's folder"):
        scene_files.load(tmp_path / "out" / "x.png")
    monkeypatch.chdir(patient)
    np.testing.assert_array_equal(drawn(tmp_path / "out" / "x.png").rgba, picture.rgba)
    monkeypatch.chdir(tmp_path)
    shutil.copy(patient / "scan.npy", tmp_path / "out")
    np.testing.assert_array_equal(drawn(tmp_path / "out" / "x.png").rgba, picture.rgba)


def test_a_link_in_the_working_directory_is_not_followed_elsewhere(patient, tmp_path, monkeypatch):
    ws.render(ws.open(patient / "scan.npy"), "grey", size=(20, 16)).save(tmp_path / "x.png")
    (tmp_path / "here").mkdir()
    (tmp_path / "here" / "scan.npy").symlink_to(patient / "scan.npy")
    monkeypatch.chdir(tmp_path / "here")
    with pytest.raises(FileError, match="outside of the document's folder"):
        scene_files.load(tmp_path / "x.png")


def test_the_name_of_a_folder_of_slices_is_not_written_fault_23(tmp_path):
    folder = dicom_files.save(tmp_path / PATIENT, [dicom_files.slice_at(dicom_files.random(1)[0], n) for n in range(4)])
    scan = ws.open(folder)
    scan_of_times = ws.open_series([folder])
    picture = ws.render([scan, scan_of_times], ["grey", "grey"], size=(20, 16))
    picture.save(tmp_path / "x.png")
    text = text_in((tmp_path / "x.png").read_bytes(), "wavesplat")
    assert PATIENT not in text
    document = json.loads(text)
    assert [layer["volume"]["path"] for layer in document["layers"]] == [None, None]
    with pytest.raises(ArgumentError, match=r"layers\[0\]\.volume came from no file.*or from a folder"):
        scene_files.load(tmp_path / "x.png")


def test_files_of_one_name_are_not_taken_for_each_other(tmp_path):
    for name in ("a", "b"):
        (tmp_path / name).mkdir()
        np.save(tmp_path / name / "scan.npy", SAMPLES)
    document = {"layers": [{"path": str(tmp_path / name / "scan.npy")} for name in ("a", "b", "a")]}
    assert [layer["path"] for layer in without_folders(document)["layers"]] == [None] * 3
    alone = {"layers": [document["layers"][0]] * 2}
    assert [layer["path"] for layer in without_folders(alone)["layers"]] == ["scan.npy"] * 2


@pytest.mark.parametrize(
    ("path", "name"),
    [
        ("/data/DOE/cells.ome.tif", "cells.ome.tif"),
        ("/data/DOE/cells_*.tif", "cells_*.tif"),
        ("/data/*/cells.tif", None),
        ("/data/DOE/DOE.nii.gz", None),  # there is no such file whose content could name it
        ("/data/DOE/IM0001", None),
        ("https://host/DOE/cells.zarr?token=1", "cells.zarr"),
    ],
)
def test_the_name_of_a_file(path, name):
    assert file_name_of(path) == name


def test_scans_of_patients_are_named_by_their_content(tmp_path, monkeypatch):
    (tmp_path / PATIENT).mkdir()
    for name, samples in (("DOE", SAMPLES), ("other", SAMPLES[::-1])):
        ws.Volume(SAMPLES if name == "DOE" else samples, spacing=(1, 1, 2), anatomical=True).save(
            tmp_path / PATIENT / f"{name}.nii.gz"
        )
    picture = ws.render(ws.open(tmp_path / PATIENT / "DOE.nii.gz"), "grey", size=(20, 16))
    picture.save(tmp_path / "x.png")
    text = text_in((tmp_path / "x.png").read_bytes(), "wavesplat")
    assert "DOE" not in text
    assert json.loads(text)["layers"][0]["volume"]["path"].startswith("content:")
    with pytest.raises(FileError, match="names a scan by its content, and there is no such file in the document's"):
        scene_files.load(tmp_path / "x.png")
    # It is found by what it holds, whatever it is called, and drawn again with the same bytes.
    (tmp_path / PATIENT / "DOE.nii.gz").rename(tmp_path / PATIENT / "renamed.nii.gz")
    monkeypatch.chdir(tmp_path / PATIENT)
    again = drawn(tmp_path / "x.png")
    np.testing.assert_array_equal(again.rgba, picture.rgba)
    again.save(tmp_path / "y.png")
    assert (tmp_path / "y.png").read_bytes() == (tmp_path / "x.png").read_bytes()


def test_stores_of_zarr_are_named(tmp_path):
    (tmp_path / "cells.zarr").mkdir()
    assert file_name_of(str(tmp_path / "cells.zarr")) == "cells.zarr"
    assert file_name_of(str(tmp_path)) is None


def test_scenes_saved_on_purpose_keep_relative_paths(patient, tmp_path):
    ws.Scene(ws.open(patient / "scan.npy"), "grey").save(tmp_path / "scene.json")
    path = json.loads((tmp_path / "scene.json").read_text())["layers"][0]["volume"]["path"]
    assert path == os.path.join(PATIENT, "scan.npy") == str(Path(PATIENT) / "scan.npy")  # noqa: PTH118


def bundle_of(viewer):
    """The output of a viewer that a notebook keeps."""
    return viewer._repr_mimebundle_()


#: How objects say or show themselves. `Scene.to_json` is asked for, to open the files again, and names them.
SAYING = {"__repr__": repr, "to_json": lambda one: one.to_json(), "_repr_mimebundle_": bundle_of}
WITH_PATHS = {("Scene", "to_json")}


def objects_in(patient, tmp_path):
    """Objects of all public types that know a file, read from a folder named after a patient."""
    slices = dicom_files.save(patient / PATIENT, [dicom_files.slice_at(dicom_files.random(1)[0], n) for n in range(4)])
    scan, labels = ws.open(patient / "scan.npy"), ws.Labels.open(patient / "labels.npy")
    mesh = ws.mesh(scan, 100)
    mesh.save(patient / "part.stl")
    wavelets = ws.WaveletVolume.from_volume(scan)
    wavelets.save(patient / "scan.wavelets")
    layer = ws.Layer(ws.open(slices), "grey")
    scene = ws.Scene([layer, scan], labels=None, geometry=[ws.open_geometry(patient / "part.stl")])
    picture = scene.render(size=(120, 90))
    return [
        *(scan, labels, mesh, wavelets, ws.WaveletVolume.load(patient / "scan.wavelets"), layer, scene, picture),
        *(layer.volume, picture.report, ws.open_series([patient / "scan.npy", slices]), ws.open_series(slices)),
        *(ws.open(patient / "scan.npy", memory="1 MB"), ws.Isolines(layer.volume, [9]), scene.geometry[0]),
        *(ws.Look.auto(scan), ws.Look.auto(scan).transfer_function, ws.Materials.preset("ct"), scan.facts),
        *(ws.TransferFunction2D([0, 1], [0, 1], np.zeros((2, 2, 4))), ws.Frame(), ws.SlicePlane(layer.volume)),
        *(layer.volume.facts, ws.slice(scene).report, picture.annotated(scale_bar=True, unit="mm").report),
        *(ws.render(ws.Scene(scan, labels=labels), size=(9, 9)).report),
    ]


def test_no_object_says_the_name_of_a_folder(patient, tmp_path):
    objects = objects_in(patient, tmp_path)
    with ws.view(objects[6], browser=False) as viewer:
        objects.append(viewer)
        for one in objects:
            for name, say in SAYING.items():
                if hasattr(one, name) and (type(one).__name__, name) not in WITH_PATHS:
                    assert PATIENT not in str(say(one)), (type(one).__name__, name)
    known = {type(one).__name__ for one in objects}
    sayers = [kind for kind in vars(ws).values() if isinstance(kind, type) and kind.__name__ in ws.__all__]
    unknown = {kind.__name__ for kind in sayers if any(hasattr(kind, name) for name in [*SAYING][1:])} - known
    assert not unknown, "give one of each to objects_in"


def test_no_saved_file_holds_the_name_of_a_folder(patient, tmp_path):
    """Volumes, coefficients, meshes, looks and pages; pictures and movies have tests of their own."""
    out = tmp_path / "out"
    out.mkdir()
    slices = dicom_files.save(patient / PATIENT, [dicom_files.slice_at(dicom_files.random(1)[0], n) for n in range(4)])
    for number, path in enumerate((patient / "scan.npy", slices)):
        scan = ws.open(path)
        for suffix in (".nii.gz", ".nrrd", ".mha", ".ome.tif", ".ome.zarr", ".vti", ".npy"):
            with contextlib.suppress(FileError), warnings.catch_warnings():  # not all are written, nor all facts
                warnings.simplefilter("ignore")
                scan.save(out / f"{number}{suffix}")
        ws.WaveletVolume.from_volume(scan).save(out / f"{number}.wavelets")
        ws.Look.auto(scan).save(out / f"{number}.json")
        for suffix in (".stl", ".ply", ".obj", ".glb", ".3mf"):
            with contextlib.suppress(FileError):
                ws.mesh(scan, 100).save(out / f"{number}{suffix}")
        state = ViewerState.of(ws.Scene(scan))
        (out / f"{number}.html").write_text(export_html.page_of(state, state.scene.render(size=(20, 16))))
    files = [path for path in out.rglob("*") if path.is_file()]
    assert {path.suffix for path in files} >= {".gz", ".nrrd", ".tif", ".wavelets", ".stl", ".ply", ".html", ".json"}
    for path in files:
        content = gzip.decompress(path.read_bytes()) if path.suffix == ".gz" else path.read_bytes()
        parts = [content]
        if zipfile.is_zipfile(path):
            with zipfile.ZipFile(path) as archive:
                parts += [archive.read(name) for name in archive.namelist()]
        assert not any(PATIENT.encode() in part or "\0".join(PATIENT).encode() in part for part in parts), path.name
