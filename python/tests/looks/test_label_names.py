"""Names and colours of labels from files."""

import gzip

import nibabel
import numpy as np
import pytest

import wavesplat as ws
from wavesplat.errors import ArgumentError, FileError


@pytest.fixture
def segmentation():
    samples = np.zeros((4, 5, 6), np.uint8)
    samples[1, :, :] = 1
    samples[2, :, :] = 2
    samples[3, :, :] = 5
    return samples


def save_nrrd(path, samples, pairs):
    sizes = " ".join(map(str, samples.shape[::-1]))
    header = f"NRRD0004\ntype: uint8\ndimension: 3\nsizes: {sizes}\nencoding: gzip\n"
    header += "space: left-posterior-superior\nspace directions: (1,0,0) (0,1,0) (0,0,1)\nspace origin: (0,0,0)\n"
    header += "".join(f"{key}:={value}\n" for key, value in pairs.items())
    path.write_bytes(header.encode() + b"\n" + gzip.compress(samples.tobytes()))


def test_segments_of_slicer(tmp_path, segmentation):
    path = tmp_path / "a.seg.nrrd"
    pairs = {
        "Segment0_ID": "Segment_1",
        "Segment0_Name": "left kidney",
        "Segment0_Color": "0.5 0.25 1",
        "Segment0_LabelValue": "5",
        "Segment1_Name": "spine",
        "Segment1_LabelValue": "1",
        "Segment2_Name": "not there",
        "Segment2_LabelValue": "77",
    }
    save_nrrd(path, segmentation, pairs)
    labels = ws.Labels.open(path)
    assert set(labels.labels) == {1, 2, 5}
    assert labels.labels[5].name == "left kidney"
    assert labels.labels[5].color == (0.5, 0.25, 1.0)
    assert labels.labels[1].name == "spine"
    plain = ws.Labels(segmentation)
    assert labels.labels[1].color == plain.labels[1].color
    assert labels.labels[2] == plain.labels[2]


def test_a_segmentation_that_is_drawn_alone_has_the_names_and_colours_of_its_file(tmp_path):
    z, y, x = np.indices((24, 24, 24))
    samples = np.where((x - 12) ** 2 + (y - 12) ** 2 + (z - 12) ** 2 < 80, 1 + (x > 12), 0).astype(np.uint8)
    path = tmp_path / "organs.seg.nrrd"
    pairs = {"Segment0_Name": "liver", "Segment0_Color": "0 1 0", "Segment0_LabelValue": "2"}
    save_nrrd(path, samples, pairs)
    volume = ws.open(path)
    picture = ws.render(volume, size=(32, 32))
    assert [one["name"] for one in picture.report["labels"]] == ["1", "liver"]
    assert picture.report["labels"][1]["color"][:3] == [0.0, 1.0, 0.0]
    pixels = np.asarray(picture)[..., :3].astype(int)
    assert (pixels[..., 1] > 2 * pixels[..., 0]).any()
    # So has a slice of it, unless a window is given.
    cut = ws.slice(volume, size=(48, 48))
    assert [one["name"] for one in cut.report["labels"]] == ["1", "liver"]
    green = (np.abs(cut.rgba - (0, 1, 0, 1)) < 0.01).all(axis=-1)
    assert (green == (cut.value == 2)).mean() > 0.9  # values are read between samples, labels at the nearest
    assert green.any()
    assert np.ptp(ws.slice(volume, clim=(0, 2)).rgba[..., :3], axis=-1).max() == 0
    # The names are those of the file, for as long as it is there.
    path.unlink()
    assert ws.Look.auto(volume).labels.labels[2].name != "liver"


@pytest.mark.parametrize("code", [0, 30])  # of TotalSegmentator, and of Connectome Workbench
def test_label_tables_of_nifti(tmp_path, segmentation, code):
    image = nibabel.Nifti1Image(segmentation.T, np.eye(4))
    text = (
        '<?xml version="1.0"?><CaretExtension><VolumeInformation Index="0"><LabelTable>'
        '<Label Key="1" Red="0.2" Green="0.4" Blue="0.6" Alpha="1"><![CDATA[spleen]]></Label>'
        '<Label Key="5" Red="7" Green="0" Blue="0">kidney &amp; fat</Label>'
        "</LabelTable></VolumeInformation></CaretExtension>"
    )
    # Extensions that hold something else, one of them damaged, are none of ours.
    for one, content in ((6, b"a remark"), (2, b"no DICOM"), (code, text.encode())):
        image.header.extensions.append(nibabel.nifti1.Nifti1Extension(one, content))
    path = tmp_path / "a.nii.gz"
    nibabel.save(image, path)
    labels = ws.Labels.open(path)
    assert labels.labels[1].name == "spleen"
    assert labels.labels[1].color == (0.2, 0.4, 0.6)
    assert labels.labels[5].name == "kidney & fat"
    assert labels.labels[5].color == ws.Labels(segmentation).labels[5].color  # 7 is no share of red


TABLES = {
    "itksnap.txt": '# IDX -R- -G- -B- -A- VIS MSH LABEL\n 0 0 0 0 0 0 0 "Clear"\n 5 255 0 51 1 1 1 "left kidney"\n',
    "slicer.ctbl": "# Slicer color table\n0 Background 0 0 0 0\n5 left_kidney 255 0 51 255\n",
    "workbench.txt": "Clear\n0 0 0 0 0\nleft kidney\n5 255 0 51 255\n",
    "bids.tsv": "index\tname\tcolor\n0\tnone\t\n5\tleft kidney\t#ff0033\n",
}


@pytest.mark.parametrize("name", TABLES)
def test_tables(tmp_path, segmentation, name):
    (tmp_path / name).write_text(TABLES[name], encoding="utf-8")
    path = tmp_path / "a.npy"
    np.save(path, segmentation)
    labels = ws.Labels.open(path, table=tmp_path / name)
    assert labels.labels[5] == ws.Label((1, 0, 0.2), name="left kidney")
    assert labels.labels[1].name == "1"


@pytest.mark.parametrize(
    ("name", "text", "message"),
    [
        ("a.txt", "", "holds none"),
        ("a.txt", "liver 1 2 3\n", "line 1 is 'liver 1 2 3'"),
        ("a.tsv", "number\tname\n1\tliver\n", "columns index and name"),
        ("a.tsv", "index\tname\none\tliver\n", "one"),
        ("a.tsv", "index\tname\n1\t" + "x" * 200_000 + "\n", "field larger than field limit"),
        ("a.tsv", "name\tindex\nliver\n", "int"),
    ],
)
def test_tables_that_are_none_are_refused(tmp_path, segmentation, name, text, message):
    (tmp_path / name).write_text(text, encoding="utf-8")
    path = tmp_path / "a.npy"
    np.save(path, segmentation)
    with pytest.raises(FileError, match=message):
        ws.Labels.open(path, table=tmp_path / name)
    with pytest.raises(FileError, match="check the name"):
        ws.Labels.open(path, table=tmp_path / "absent.txt")
    assert issubclass(FileError, Exception)
    assert not issubclass(FileError, ArgumentError)


def test_the_command_line_takes_tables(tmp_path, segmentation, wavesplat):
    (tmp_path / "names.ctbl").write_text("1 liver 200 90 60 255\n", encoding="utf-8")
    scan, labels = tmp_path / "scan.npy", tmp_path / "labels.npy"
    np.save(scan, segmentation.astype(np.int16) * 100)
    np.save(labels, segmentation)
    picture = tmp_path / "a.png"
    options = ["--size", "24x24", "--quiet"]
    beside = ["--labels", labels, "--label-table", tmp_path / "names.ctbl"]
    assert wavesplat("render", scan, "-o", picture, *options, *beside).returncode == 0
    refused = wavesplat("render", scan, "-o", picture, *options, "--label-table", tmp_path / "names.ctbl")
    assert refused.returncode != 0
    assert "give it with --labels" in refused.stderr
