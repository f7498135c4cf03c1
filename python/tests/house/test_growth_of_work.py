"""Work on texts grows as the texts do: a small file, or a name, cannot keep a parser busy for minutes.

Each text is doubled and redoubled, and the first that takes more than `MAX_S` of the processor fails: what grows with
the square of the length takes seconds here, the others milliseconds, so that a loaded machine changes no verdict.
A text that takes longer is used once more: the garbage of earlier tests may have been collected meanwhile.
"""

from __future__ import annotations

import json
import time
import warnings
from contextlib import suppress
from functools import partial

import nibabel
import numpy as np
import pytest
import test_fuzzed_documents as documents
import test_fuzzed_files as files
import test_molecules_and_traces as molecules
import tifffile

import wavesplat as ws
from wavesplat._looks.curves import colors
from wavesplat._looks.labels.label_names import in_file, in_table
from wavesplat._model.interchange import paraview_state
from wavesplat._model.volume import facts, units
from wavesplat._picture import scale_bar
from wavesplat._readers import time_points
from wavesplat._readers.nrrd import image_headers, nrrd_for_itk
from wavesplat._readers.vtk import grids
from wavesplat._storage import json_texts, paths
from wavesplat._system import memory
from wavesplat.errors import WavesplatError, WavesplatWarning

#: Lengths of the repeated parts, and the seconds of the processor that none may take.
LENGTHS, MAX_S = [500 << k for k in range(6)], 0.5
#: Parts that are repeated, in texts of any kind: what parsers skip, look for, or find no end of.
PARTS = [" ", "\n", '"', '\\"', "(", "<Label ", "<!--", "1", "a", "1 ", "1\n", "a: 1\n", "x=", "[", "&lt;"]


def check_growth(use, text_of):
    """Check that `use(text_of(n))` takes no longer than texts of that length should, whatever it raises."""
    for length in LENGTHS:
        text = text_of(length)
        taken = seconds_of(use, text)
        if taken >= MAX_S:
            taken = min(taken, seconds_of(use, text))
        assert taken < MAX_S, f"{taken:.2f} s for a part of {length} letters"


def seconds_of(use, text):
    """Seconds of the processor that the use of a text takes."""
    begin = time.thread_time()
    with suppress(WavesplatError, ValueError), warnings.catch_warnings():
        warnings.simplefilter("ignore")
        use(text)
    return time.thread_time() - begin


def through_a_file(path, use):
    """The use of a text as the content of a file."""

    def used(text):
        path.write_bytes(text.encode("utf-8", "surrogateescape"))
        return use(path)

    return used


# Texts that took quadratic or cubic work


def test_labels_of_itk_snap(tmp_path):
    check_growth(through_a_file(tmp_path / "a.txt", in_table), lambda n: f'1 {" " * n}"{" " * n}\n')


def test_names_of_columns(tmp_path):
    use = through_a_file(tmp_path / "a.csv", ws.open_geometry)
    check_growth(use, lambda n: f"x,y,z,a{' ' * n}b\n1,2,3,4\n")
    check_growth(use, lambda n: f"x,y,z,{'(' * n}\n1,2,3,4\n")


def labelled(path, text):
    """A NIfTI file with an extension of a text."""
    image = nibabel.Nifti1Image(np.zeros((2, 2, 2), np.uint8), np.eye(4))
    image.header.extensions.append(nibabel.nifti1.Nifti1Extension(0, text.encode()))
    nibabel.save(image, path)
    return in_file(path)


@pytest.mark.parametrize("part", ["<Label>", '<Label Key="1">', "<![CDATA[", "a", "&#"])
def test_labels_in_nifti(tmp_path, part):
    use = partial(labelled, tmp_path / "a.nii")
    check_growth(use, lambda n: part * n)
    check_growth(use, lambda n: f'<Label Key="1">{part * n}</Label>')
    check_growth(use, lambda n: f"<Label {part * n}>a</Label>")


def test_labels_in_nifti_are_read(tmp_path):
    text = (
        '<?xml version="1.0"?><LabelTable><Label Key="2" Red="0.5" Green="1" Blue="0" Alpha="1"><![CDATA[left &amp; '
        'right]]></Label>\n<Label Index = "3">no colour</Label><Label Key="x">none</Label></LabelTable>'
    )
    assert labelled(tmp_path / "a.nii", text) == {2: ("left & right", (0.5, 1.0, 0.0)), 3: ("no colour", None)}


@pytest.mark.parametrize(
    "head", ["# vtk DataFile Version 3.0\nx\nASCII\n", "<VTKFile ", "<ImageData ", "x", 'Extent="', "NumberOfPoints "]
)
def test_heads_of_vtk(tmp_path, head):
    def use(path):
        grids.is_grid(path)
        grids.check_promises(path.read_bytes()[: grids.HEAD_BYTES], path)
        for expression in (grids.DIRECTION, grids.LZ4):
            expression.search(path.read_bytes())

    for part in ("\n", " ", "<VTKFile ", "compressor ", "1 ", "Extent "):
        check_growth(through_a_file(tmp_path / "a.vtk", use), lambda n, part=part: head + part * n + "X\n")


@pytest.mark.parametrize(
    "use",
    [
        memory.bytes_of,
        colors.parse,
        facts.quantity_of,
        facts.value_unit_of,
        image_headers._quoted,
        json_texts.decode_syntax,
        paths.natural_key,
        paraview_state.views,
        scale_bar._asked,
        units.canonical,
        lambda text: nrrd_for_itk.listed_axis({"sizes": "1 2 3 4", "space directions": text}),
        lambda text: time_points._of_names([text, f"{text}1"]),
    ],
)
def test_names_and_values(use):
    use = partial(use, what="a value") if use is json_texts.decode_syntax else use
    for part in PARTS:
        check_growth(use, lambda n, part=part: part * n)
        check_growth(use, lambda n, part=part: f"1{part * n}x\n")
        check_growth(use, lambda n, part=part: f'"{part * n}')


# Files


def of_volume(name):
    return files.KINDS[name][0], ws.open


TEXT_VTK = (
    "# vtk DataFile Version 3.0\nx\nASCII\nDATASET POLYDATA\nPOINTS 3 float\n0 0 0 1 0 0 0 1 0\nPOLYGONS 1 4\n3 0 1 2\n"
)
PLY = (
    "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nelement face 1\n"
    "property list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"
)
STL = "solid x\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid\n"
LTA = (
    "type = 1\nnxforms = 1\n1 4 4\n1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\nsrc volume info\nvalid = 1\nfilename = a\n"
    "volume = 8 8 8\nvoxelsize = 1 1 1\nxras = 1 0 0\nyras = 0 1 0\nzras = 0 0 1\ncras = 0 0 0\n"
    "dst volume info\nvalid = 0\n"
)
TFM = "#Insight Transform File V1.0\nTransform: TranslationTransform_double_3_3\nParameters: 5 0 0\nFixedParameters:\n"
SCENE = {"wavesplat": "scene", "version": 1, "layers": [{"volume": {"example": "ripples", "n": 8}}]}
VALUES = np.ones(molecules.SIZE)


def of_text(text, use):
    return lambda path: path.write_text(text), use


def with_a_look(path):
    return ws.Look.load(path, documents.BALL)


def of_a_scan(path):
    scan = ws.examples.ripples(8)
    return ws.open_transform(path, moving=scan, fixed=scan)


#: File -> how it is made, and used.
TEXTS = {
    **{name: of_volume(name) for name in ("a.mhd", "a.nhdr", "text.nrrd", "text.vtk", "text.vti", "bdv.xml")},
    "a.cube": (lambda path: molecules.save_cube(path, VALUES), ws.open),
    "CHGCAR": (lambda path: molecules.save_vasp(path, [VALUES]), ws.open),
    "a.bov": (lambda path: molecules.save_bov(path, VALUES), ws.open),
    "a.ply": of_text(PLY, ws.open_geometry),
    "a.stl": of_text(STL, ws.open_geometry),
    "mesh.vtk": of_text(TEXT_VTK, ws.open_geometry),
    "a.obj": of_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", ws.open_geometry),
    "a.off": of_text("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n", ws.open_geometry),
    "a.swc": of_text("1 1 0 0 0 2 -1\n2 3 1 0 0 1 1\n3 3 2 0 0 1 2\n", ws.open_geometry),
    "a.csv": of_text("x,y,z,a (um)\n1,2,3,4\n", ws.open_geometry),
    "a.gltf": of_text(json.dumps({"asset": {"version": "2.0"}, "meshes": [], "nodes": []}), ws.open_geometry),
    "a.ctbl": of_text("1 liver 255 0 0 255\n", in_table),
    "a.tsv": of_text("index\tname\tcolor\n1\tliver\t#ff0000\n", in_table),
    "a.vp": of_text(documents.VP, with_a_look),
    "a.xml": of_text(documents.SLICER_XML, with_a_look),
    "pv.json": of_text(json.dumps(documents.PARAVIEW), with_a_look),
    "pv.xml": of_text(documents.PARAVIEW_XML, with_a_look),
    "scene.json": of_text(json.dumps(SCENE), ws.Scene.load),
    "a.lta": of_text(LTA, of_a_scan),
    "a.tfm": of_text(TFM, of_a_scan),
    "a.mat": of_text("1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n", of_a_scan),
}


@pytest.mark.parametrize("name", TEXTS)
def test_texts_of_files(tmp_path, name, monkeypatch):
    make, use = TEXTS[name]
    if use is ws.open_geometry and name.endswith((".ply", ".stl", ".obj", ".off", ".gltf", ".vtk")):
        pytest.importorskip("vtkmodules" if name.endswith(".vtk") else "trimesh")
    path = tmp_path / name
    make(path)
    whole = path.read_text()
    with suppress(WavesplatError, WavesplatWarning):
        use(path)  # what is imported and kept once
    places = [0, *(at + 1 for at, letter in enumerate(whole[:400]) if letter in '\n:="'), len(whole)][::3]
    monkeypatch.setattr(f"{__name__}.LENGTHS", [1_000, 16_000])
    for part in (" ", "\n", '"', "(", "1 ", "a: 1\n"):
        for at in (places[0], places[len(places) // 2], places[-1]):
            again = partial(lambda n, at, part: whole[:at] + part * (n // len(part)) + whole[at:], at=at, part=part)
            check_growth(through_a_file(path, use), again)


@pytest.mark.parametrize("start", ["ImageJ=1.53\nspacing=2\n", "<OME ", '{"shape": [4, 5, 6]}', ""])
def test_descriptions_of_tiff(tmp_path, start):
    def use(text):
        tifffile.imwrite(tmp_path / "a.tif", files.SAMPLES, description=text, metadata=None)
        with suppress(WavesplatWarning):
            ws.open(tmp_path / "a.tif")

    for part in ('"', "a", " ", "\n", "<", "a=1\n", "1 "):
        check_growth(use, lambda n, part=part: start + part * n)
