"""No name of a person in what is published: the same bytes, whatever folders and files of a scan are called."""

from __future__ import annotations

import itertools
import json
import shutil
import zipfile

import nibabel
import numpy as np
import pytest
import SimpleITK
import tifffile
from dicom_files import enhanced, save, segmentation, sequence, slice_at

import wavesplat as ws
from wavesplat._picture.picture_files import text_in
from wavesplat._viewer.page_requests import code, export_html
from wavesplat._viewer.page_requests.seen import name_of
from wavesplat._viewer.session.picturing import picture_of
from wavesplat._viewer.session.state import ViewerState

#: Names of folders and files of the same scan, in two places.
NAMES = ("MUSTERMANN_MAX", "Doe-Jane-1950")
SIZE = (64, 48)
RANDOM = np.random.default_rng(3)
#: Samples [z, y, x]: of no scale, and of air, water and bone.
PLAIN = RANDOM.integers(0, 900, (6, 7, 8)).astype(np.int16)
CT = RANDOM.choice([-1000, -1000, -80, 20, 40, 60, 900], (10, 12, 14)).astype(np.int16)
LABELS = np.zeros((6, 7, 8), np.uint8)
LABELS[1:4, 1:5, 1:4], LABELS[4:, 2:, 5:] = 1, 2
AFFINE = np.diag([-1.5, -1.5, 2.0, 1.0])


def dicom(folder, samples=PLAIN, **attributes):
    save(folder, [slice_at(one, n, **{"PatientName": "REAL^NAME", **attributes}) for n, one in enumerate(samples)])


def nifti(path, samples=PLAIN, kind=nibabel.Nifti1Image):
    nibabel.save(kind(samples.T, AFFINE), path)


def itk(path, samples=PLAIN):
    image = SimpleITK.GetImageFromArray(samples)
    image.SetSpacing((1.5, 1.5, 2.0))
    SimpleITK.WriteImage(image, path)


def nrrd(path, samples):
    """A file that says nothing of a patient."""
    head = f"NRRD0004\ntype: int16\ndimension: 3\nsizes: {' '.join(map(str, samples.shape[::-1]))}\nencoding: raw\n"
    path.write_bytes(f"{head}endian: little\nspacings: 1 1 1\n\n".encode() + samples.tobytes())


def in_zip(path, folder):
    dicom(folder / "slices")
    with zipfile.ZipFile(path, "w") as archive:
        for file in sorted((folder / "slices").iterdir()):
            archive.write(file, file.name)
    shutil.rmtree(folder / "slices")


def loose(folder):
    """Files without suffixes in folders of folders, as archives send them."""
    folder.mkdir()
    dicom(folder / "x")
    (folder / "study" / "series").mkdir(parents=True)
    for number, file in enumerate(sorted((folder / "x").iterdir())):
        file.rename(folder / "study" / "series" / f"IM{number}")
    (folder / "x").rmdir()


FDG = sequence({"Radiopharmaceutical": "FDG"})
SEGMENTS = {1: ("liver", None), 2: ("spleen", None)}
MASKS = [(number, z, LABELS[z] == number) for number in (1, 2) for z in range(6) if (LABELS[z] == number).any()]
LINES = [("organ", (255, 0, 0), "ORGAN", [[(13, 25, 33), (14, 25, 33), (14, 24, 33), (13, 24, 33)]])]


IN_MEMORY = ws.Volume(PLAIN, spacing=(1, 1, 2), anatomical=True)

#: Scans by what they are: what is written, by the ending of its name ("" is a folder).
SCANS = {
    "CT": {"": lambda p: dicom(p, CT)},
    "CT without a scale": {"": dicom},
    "MR": {"": lambda p: dicom(p, modality="MR")},
    "PET": {"": lambda p: dicom(p, modality="PT", RadiopharmaceuticalInformationSequence=FDG)},
    "NM": {"": lambda p: dicom(p, modality="NM")},
    "PET and CT": {" ct": lambda p: dicom(p, CT), " pt": lambda p: dicom(p, modality="PT")},
    "two CT": {
        " 1": lambda p: dicom(p, CT, SeriesDescription="Thorax"),
        " 2": lambda p: dicom(p, CT, SeriesDescription="Abdomen"),
    },
    "two CT without a description": {" 1": lambda p: dicom(p, CT), " 2": lambda p: dicom(p, CT)},
    "CT and segmentation": {
        "": dicom,
        " seg": lambda p: save(p, [segmentation(MASKS, segments=SEGMENTS)]),
    },
    "CT and dose": {"": lambda p: dicom(p, CT), " dose": lambda p: dicom(p, modality="RTDOSE")},
    "one file of many": {
        ".dcm": lambda p: enhanced(PLAIN.astype(np.uint16), [(2.0 * n,) for n in range(6)]).save_as(
            p, enforce_file_format=True
        )
    },
    "files without suffixes": {"": loose},
    "archive": {".zip": lambda p: in_zip(p, p.parent)},
    "NIfTI": {".nii": nifti},
    "NIfTI, compressed": {".nii.gz": nifti},
    "NIfTI of CT": {".nii.gz": lambda p: nifti(p, CT)},
    "NIfTI of fractions": {".nii": lambda p: nifti(p, PLAIN.astype(np.float32) / 7)},
    "NIfTI of labels": {".nii.gz": lambda p: nifti(p, LABELS)},
    "NIfTI of two": {"_1.nii.gz": nifti, "_2.nii.gz": lambda p: nifti(p, PLAIN[::-1])},
    "NIfTI of times": {".nii": lambda p: nifti(p, np.stack([PLAIN, PLAIN + 9]))},
    "NIfTI, header and samples": {".hdr": lambda p: nifti(p.with_suffix(".img"), PLAIN, nibabel.Nifti1Pair)},
    "FreeSurfer": {".mgz": lambda p: nifti(p, PLAIN, nibabel.MGHImage)},
    "NRRD": {".nrrd": itk},
    "NRRD of CT without a patient": {".nrrd": lambda p: nrrd(p, CT)},
    "MetaImage": {".mha": itk},
    "MetaImage of labels": {".mha": lambda p: itk(p, LABELS)},
    "MetaImage and NRRD": {".mha": itk, " 2.nrrd": itk},
    "array of CT": {".npy": lambda p: np.save(p, CT)},
    "coefficients": {
        ".wavelets": lambda p: ws.WaveletVolume.from_volume(ws.Volume(PLAIN, spacing=(1, 1, 2), anatomical=True)).save(
            p
        )
    },
    "slices in a folder": {"": lambda p: [p.mkdir(), *(tifffile.imwrite(p / f"{n}.tif", PLAIN[n]) for n in range(6))]},
}


@pytest.fixture(params=[*SCANS])
def places(request, tmp_path):
    """Paths of the files of a scan, under each of the names."""
    (tmp_path / "made").mkdir()
    endings = SCANS[request.param]
    for ending, write in endings.items():
        write(tmp_path / "made" / f"scan{ending}")
    found = []
    for name in NAMES:
        folder = shutil.copytree(tmp_path / "made", tmp_path / name / name)
        for file in sorted(folder.iterdir()):
            file.rename(folder / file.name.replace("scan", name, 1))
        found.append([folder / f"{name}{ending}" for ending in endings])
    return found


def opened(path):
    if path.suffix == ".wavelets":
        return ws.WaveletVolume.load(path)
    series = ws.open_series(path)
    return series if len(series) > 1 else series[0]


def published(paths, out):
    """All that is made of a scan, by its kind."""
    volumes = [opened(path) for path in paths]
    scene = ws.Scene([ws.Layer(one, "grey" if n else None) for n, one in enumerate(volumes)])
    found = {"layers": repr(scene)}
    picture = scene.render(size=SIZE, device="cpu")
    pictures = {"render": picture}
    samples = [one if isinstance(one, ws.Volume) else None for one in volumes]
    if None not in samples:
        pictures["slice"] = ws.slice(scene, size=SIZE)
        pictures["lightbox"] = ws.lightbox(volumes[0], positions=2)
        pictures["compared"] = ws.slice(volumes[0], size=SIZE, checkerboard=volumes[-1])
        pictures["lines"] = ws.slice(volumes[0], size=SIZE, isolines=ws.Isolines(volumes[-1], [30, 400]))
    for kind, one in pictures.items():
        report = {name: value for name, value in one.report.items() if name != "seconds"}
        found[f"{kind}, report"] = ws.Picture(one.rgba, report=report).report.to_json()
        found[f"{kind}, repr"] = repr(report)
        colorbar = any(layer["transfer_function"] for layer in one.report.get("shown") or [])
        legend = bool(one.report.get("labels")) or len(one.report.get("shown") or []) > 1
        figure = one.annotated(colorbar=colorbar and legend, legend=legend, title="scan", font_size=6)
        for suffix in (".png", ".svg"):
            figure.save(out / f"figure{suffix}")
            found[f"{kind}{suffix}"] = (out / f"figure{suffix}").read_bytes()
        found[f"{kind}, text"] = text_in(found[f"{kind}.png"], "wavesplat")
    state = ViewerState.of(scene)
    page = export_html.page_of(state, picture_of(state, "3d", SIZE))
    found |= {"page": page, "document": json.dumps(state.document), "file": name_of(state, "3d")}
    for kind, text in (("python", code.python_of(state, SIZE)), ("command", code.command_of(state, SIZE))):
        for number, path in enumerate(paths):  # which must be there, so that it runs
            text = text.replace(str(path), f"<path {number}>")  # noqa: PLW2901
        found[kind] = text
    compile(code.python_of(state, SIZE), "copied", "exec")
    return found


def test_nothing_holds_a_name(places, tmp_path):
    first, second = (published(paths, tmp_path) for paths in places)
    assert [kind for kind in first if first[kind] != second[kind]] == []
    for kind, name in itertools.product(first, ("MUSTERMANN", "REAL")):
        content = first[kind] or b""
        assert name not in content if isinstance(content, str) else name.encode() not in content, kind
