"""Meshes of labels: closed, smooth, as large as the label's samples, with names and colours, in one file or several."""

import json
import math
import zipfile
from xml.etree import ElementTree as ET

import numpy as np
import pytest

import wavesplat as ws
from wavesplat._mesh.label_surfaces import _coefficients
from wavesplat._mesh.mesh_files import safe_names
from wavesplat.errors import ArgumentError

#: sRGB of labels, and their names.
LOOKS = {
    1: ws.Label("#c04020", name="liver"),
    3: ws.Label("#2060e0", name="left kidney"),
    7: ws.Label("#ffffff", name="a/b"),
}


def ball(radius, shift=0.3):
    n = int(radius) + 2
    z, y, x = np.mgrid[-n : n + 1, -n : n + 1, -n : n + 1]
    return (x - shift) ** 2 + (y + shift) ** 2 + (z - shift / 2) ** 2 <= radius**2


def organs():
    """Three labels that touch: a ball, a plate of two samples on it, and a single sample."""
    samples = np.zeros((24, 30, 40), np.uint8)
    samples[2:17, 2:17, 2:17][ball(5.5)] = 1
    samples[17:19, 3:27, 3:36] = 3
    samples[22, 20, 20] = 7
    return samples


SHAPES = {
    **{f"ball {radius}": ball(radius) for radius in (1, 2.5, 4, 10, 20)},
    "line": np.ones((1, 1, 30), bool),
    "bar": np.ones((2, 2, 30), bool),
    "plate": np.ones((1, 20, 30), bool),
    "thick plate": np.ones((3, 30, 30), bool),
    "tube": np.repeat(ball(6)[8][None], 40, axis=0) & ~np.repeat(np.pad(ball(4), 2)[8][None], 40, axis=0),
    "hollow ball": np.pad(ball(10), 2) & ~np.pad(ball(6), 6),
    "one sample": np.ones((1, 1, 1), bool),
    "corners that touch": np.indices((6, 6, 6)).sum(axis=0) % 2 == 0,
    "noise": np.random.default_rng(0).random((14, 14, 14)) < 0.3,
}


@pytest.mark.parametrize("name", SHAPES)
@pytest.mark.parametrize("smoothing", [0.0, 0.5, 1.0])
def test_meshes_are_closed_and_as_large_as_their_samples(name, smoothing):
    mask = np.pad(SHAPES[name], 2)
    (mesh,) = ws.mesh(mask.astype(np.uint8), labels="all", smoothing=smoothing)
    assert mesh.watertight
    assert np.isfinite(mesh.vertices).all()
    assert mesh.volume == pytest.approx(mask.sum(), rel=2e-3)  # 2 % are asked for
    places = np.argwhere(mask)[:, ::-1]
    # Nothing leaves the label by more than two samples.
    assert mesh.vertices.min(axis=0) == pytest.approx(places.min(axis=0), abs=2)
    assert mesh.vertices.max(axis=0) == pytest.approx(places.max(axis=0), abs=2)


@pytest.mark.parametrize(("radius", "degrees"), [(4, 10), (10, 5), (20, 2.5)])
def test_balls_are_smooth(radius, degrees):
    def error(smoothing):
        (mesh,) = ws.mesh(ball(radius).astype(np.uint8), labels="all", smoothing=smoothing)
        from_middle = mesh.vertices - mesh.vertices.mean(axis=0)
        cosines = np.einsum("ij,ij->i", mesh.normals, from_middle / np.linalg.norm(from_middle, axis=1, keepdims=True))
        return math.degrees(np.sqrt(np.mean(np.arccos(np.clip(cosines, -1, 1)) ** 2)))

    assert error(0.5) < degrees < 10.1 < error(0.0)


def test_the_filter_passes_its_band_and_stops_the_rest():
    for band, n in ((0.01, 40), (0.1, 20), (0.5, 60)):
        weights = _coefficients(band, n)

        def response(k, weights=weights, n=n):
            return float(weights @ np.cos(np.arange(n + 1) * math.acos(1 - k / 2)))

        assert response(0.0) == pytest.approx(1, abs=0.02)
        assert response(band) == pytest.approx(1, abs=0.01)
        assert max(abs(response(k)) for k in np.linspace(1.9, 2.0, 9)) < 0.02


@pytest.mark.parametrize("matrix", [np.diag([-2.0, 1, 1, 1]), np.diag([0.7, 0.8, 5, 1]), "oblique"])
def test_they_lie_in_the_world_with_any_affine(matrix):
    if isinstance(matrix, str):
        turn, _ = np.linalg.qr(np.random.default_rng(1).normal(size=(3, 3)))
        matrix = np.eye(4)
        matrix[:3, :3] = turn * [1.0, 2.0, 0.5]
    matrix = matrix.copy()
    matrix[:3, 3] = 10, -20, 30
    mask = ball(8).astype(np.uint8)
    (mesh,) = ws.mesh(ws.Volume(mask, world_from_index=matrix, unit="mm"), labels=[1])
    assert mesh.watertight
    assert mesh.volume == pytest.approx(mask.sum() * abs(np.linalg.det(matrix)), rel=2e-3)
    middle = matrix[:3, :3] @ np.argwhere(mask)[:, ::-1].mean(axis=0) + matrix[:3, 3]
    np.testing.assert_allclose(mesh.vertices.mean(axis=0), middle, atol=0.3)
    outwards = mesh.vertices - middle
    assert np.mean(np.einsum("ij,ij->i", mesh.normals, outwards) > 0) == 1
    assert mesh.unit == "mm"


def test_labels_are_chosen_by_number_and_name():
    labels = ws.Labels(organs(), LOOKS)
    every = ws.mesh(labels, labels="all")
    assert (every.numbers, every.names) == ((1, 3, 7), ("liver", "left kidney", "a/b"))
    assert [mesh.color for mesh in every] == [LOOKS[n].color for n in (1, 3, 7)]
    chosen = ws.mesh(labels, labels=["Left Kidney", 1])
    assert chosen.numbers == (1, 3)
    assert chosen["liver"] is chosen[1]
    assert ws.mesh(organs(), labels=7).names == ("7",)
    with pytest.raises(ArgumentError, match=r"there is no label 2; there are 1 'liver', 3 'left kidney', 7 'a/b'"):
        ws.mesh(labels, labels=[2])
    with pytest.raises(ArgumentError, match="there is no mesh of the label 5"):
        _ = every[5]
    for options, message in (
        ({"labels": []}, "labels is empty"),
        ({"labels": "all", "iso_value": 1}, "both say what the surface is"),
        ({"labels": "all", "step": 2}, "step: only for the surface of a value"),
        ({"labels": "all", "smoothing": 2}, r"smoothing is 2; give a number 0\.\.1"),
        ({}, "say which of them"),
    ):
        with pytest.raises(ArgumentError, match=message):
            ws.mesh(labels, **options)
    with pytest.raises(ArgumentError, match="holds no label"):
        ws.mesh(np.zeros((4, 4, 4), np.uint8), labels="all")


def test_each_label_has_a_file(tmp_path):
    import trimesh

    meshes = ws.mesh(ws.Labels(organs(), LOOKS), labels="all")
    for suffix in ("stl", "ply", "obj", "glb", "3mf"):
        paths = meshes.save(tmp_path / f"x_{{name}}.{suffix}")
        assert [path.name for path in paths] == [f"x_{name}.{suffix}" for name in ("liver", "left_kidney", "a_b")]
        if suffix not in ("glb", "3mf"):
            for path, mesh in zip(paths, meshes, strict=True):
                read = trimesh.load(path, force="mesh")
                assert read.is_watertight
                assert read.volume == pytest.approx(mesh.volume, rel=1e-4)
    assert [path.name for path in meshes.save(tmp_path / "{number}.stl")] == ["1.stl", "3.stl", "7.stl"]
    with pytest.raises(ArgumentError, match=r"\.stl holds one mesh, and there are 3 labels; write \{name\}"):
        meshes.save(tmp_path / "a.stl")


@pytest.mark.parametrize(
    ("names", "safe"),
    [
        (["liver", "left kidney"], ["liver", "left_kidney"]),
        (["../../etc/passwd", "a\\b:c*?"], ["etc_passwd", "a_b_c"]),
        (["Rib", "rib"], ["Rib_1", "rib_2"]),
        (["", "..."], ["label_1", "label_2"]),
        (["CON", "nul.x"], ["_CON", "_nul.x"]),
        (["Leber/größer", "肝臓"], ["Leber_größer", "肝臓"]),
        (["x" * 300, "b"], ["x" * 50, "b"]),
    ],
)
def test_names_are_safe_for_file_systems(names, safe):
    assert safe_names(names, [1, 2]) == safe


@pytest.mark.parametrize("suffix", ["glb", "gltf"])
def test_gltf_has_parts_with_names_and_colours(tmp_path, suffix):
    import trimesh

    meshes = ws.mesh(ws.Labels(organs(), LOOKS), labels="all")
    assert meshes.save(tmp_path / f"a.{suffix}") == [tmp_path / f"a.{suffix}"]
    scene = trimesh.load(tmp_path / f"a.{suffix}")
    assert set(scene.graph.nodes_geometry) == set(meshes.names)
    for mesh in meshes:
        _, geometry = scene.graph[mesh.name]
        read = scene.geometry[geometry]
        assert read.volume == pytest.approx(mesh.volume, rel=1e-4)
        factor = np.asarray(read.visual.material.baseColorFactor, float)[:3]
        linear = [((c + 0.055) / 1.055) ** 2.4 if c > 0.04045 else c / 12.92 for c in mesh.color]
        np.testing.assert_allclose(factor / (255 if factor.max() > 1 else 1), linear, atol=1 / 255)


def test_3mf_has_parts_with_names_colours_and_a_unit(tmp_path):
    segmentation = ws.Volume(organs(), spacing=(2, 2, 2), unit="um")
    looks = {1: ws.Label("#c04020", name='a <b> & "c"'), 3: LOOKS[3], 7: LOOKS[7]}
    meshes = ws.mesh(ws.Labels(segmentation, looks), labels="all")
    meshes.save(tmp_path / "a.3mf")
    ns = {"m": "http://schemas.microsoft.com/3dmanufacturing/core/2015/02"}
    with zipfile.ZipFile(tmp_path / "a.3mf") as archive:
        assert {"[Content_Types].xml", "_rels/.rels", "3D/3dmodel.model"} == set(archive.namelist())
        model = ET.fromstring(archive.read("3D/3dmodel.model"))  # noqa: S314 - our own file
    assert model.get("unit") == "millimeter"  # a segmentation in Labels has no unit
    bases = model.findall(".//m:base", ns)
    assert [base.get("displaycolor") for base in bases] == ["#C04020FF", "#2060E0FF", "#FFFFFFFF"]
    objects = model.findall(".//m:object", ns)
    assert [one.get("name") for one in objects] == list(meshes.names)
    assert [one.get("objectid") for one in model.findall(".//m:item", ns)] == [one.get("id") for one in objects]
    for number, (one, mesh) in enumerate(zip(objects, meshes, strict=True)):
        assert (one.get("pid"), one.get("pindex")) == ("1", str(number))
        places = [[float(v.get(axis)) for axis in "xyz"] for v in one.findall(".//m:vertex", ns)]
        faces = [[int(t.get(corner)) for corner in ("v1", "v2", "v3")] for t in one.findall(".//m:triangle", ns)]
        np.testing.assert_allclose(places, mesh.vertices, rtol=1e-6, atol=1e-5)
        np.testing.assert_array_equal(faces, mesh.faces)
    ws.mesh(segmentation, labels="all").save(tmp_path / "b.3mf")
    with zipfile.ZipFile(tmp_path / "b.3mf") as archive:
        assert b'unit="micron"' in archive.read("3D/3dmodel.model")


def test_the_command_line_writes_labels(wavesplat, tmp_path):
    import nibabel

    nibabel.save(nibabel.Nifti1Image(organs().T, np.diag([2.0, 2, 2, 1])), tmp_path / "seg.nii.gz")
    table = tmp_path / "names.tsv"
    table.write_text("index\tname\tcolor\n1\tliver\t#c04020\n3\tleft kidney\t#2060e0\n7\tspot\t#ffffff\n")
    named = ["mesh", tmp_path / "seg.nii.gz", "--label-table", table]
    done = wavesplat(*named, "--labels", "all", "-o", tmp_path / "{name}.stl")
    assert done.returncode == 0, done.stderr
    assert done.stdout.split("\n")[:-1] == [str(tmp_path / f"{name}.stl") for name in ("liver", "left_kidney", "spot")]
    done = wavesplat(*named, "--labels", "left kidney,7", "-o", tmp_path / "{stem}.glb", "--json")
    assert done.returncode == 0, done.stderr
    told = json.loads(done.stdout)["meshes"]
    assert [(one["label"], one["name"], one["watertight"]) for one in told] == [
        (3, "left kidney", True),
        (7, "spot", True),
    ]
    assert told[0]["volume"] == pytest.approx(8 * np.sum(organs() == 3), rel=2e-3)
    assert (tmp_path / "seg.glb").exists()
    for options, message in (
        (["--labels", "all", "-o", tmp_path / "a.stl"], ".stl holds one mesh"),
        (["--labels", "9", "-o", tmp_path / "a.stl"], "there is no segment 9"),
        (["--labels", "all", "--iso-value", "1", "-o", tmp_path / "a.stl"], "either --iso-value"),
        (["-o", tmp_path / "a.stl"], "either --iso-value"),
        (["--labels", "all", "--smooth", "1", "-o", tmp_path / "{name}.stl"], "takes the segmentation as it is"),
    ):
        done = wavesplat(*named, *options)
        assert (done.returncode, message in done.stderr) == (2, True), done.stderr
