"""DICOM as hospitals hand it over: folders of folders, DICOMDIR, zip archives, and one series of several."""

from __future__ import annotations

import json
import os
import warnings
import zipfile

import numpy as np
import pytest
from dicom_files import base, random, save, slice_at

import wavesplat as ws
from wavesplat._readers.dicom import places
from wavesplat.errors import ArgumentError, FileError, LimitError

#: Number, modality, description and UID of the series of a study.
SERIES = ((2, "MR", "AX FSE T2", "1.2.840.7.2"), (3, "MR", "AX T1 post", "1.2.840.7.3"), (7, "CT", "", "1.2.840.8.7"))


def slices_of(number, modality, description, uid, n=3):
    """Slices of a series; its first sample is its number."""
    pixels = random(n)
    pixels[0, 0, 0] = number
    common = {"series": uid, "modality": modality, "SeriesNumber": number, "SeriesDescription": description}
    return [slice_at(one, k, **common) for k, one in enumerate(pixels)]


def study(folder):
    """A patient's folder with a folder for the study, and in it one for each series."""
    for number, *rest in SERIES:
        place = folder / "STUDY1" / f"S{number:03}"
        place.mkdir(parents=True)
        save(place, slices_of(number, *rest))
    (folder / "README.txt").write_text("exported")
    return folder


def number_of(volume):
    return int(volume.samples[0, 0, 0])


def test_one_series_two_levels_down_opens_fault_11(tmp_path):
    folder = tmp_path / "patient" / "study" / "series"
    folder.mkdir(parents=True)
    pixels = random(4)
    save(folder, [slice_at(one, n) for n, one in enumerate(pixels)])
    volume = ws.open(tmp_path / "patient")
    np.testing.assert_array_equal(volume.samples, pixels)
    assert volume.guesses == ()


def test_info_lists_the_series_of_a_patient_fault_11(wavesplat, tmp_path):
    done = wavesplat("info", study(tmp_path / "patient"))
    assert done.returncode == 0
    for line in ('2 MR "AX FSE T2" (3 files in STUDY1/S002)', '3 MR "AX T1 post" (3 files', "7 CT (3 files"):
        assert line in done.stdout
    [choice] = json.loads(wavesplat("info", tmp_path / "patient", "--json").stdout)["choices"]
    assert choice["names"] == [uid for *_, uid in SERIES]


WAYS = [
    (2, 2), ("2", 2), ("AX FSE T2", 2), ("ax fse t2", 2), ("fse", 2), ("1.2.840.7.3", 3), ("1.2.840.8", 7),
    ("post", 3), (7, 7), ("CT", 7), ("ct", 7),
]  # fmt: skip


def test_a_series_is_chosen_by_number_description_or_start_of_its_uid_fault_12(wavesplat, tmp_path):
    folder = study(tmp_path / "patient")
    for wanted, number in WAYS:
        assert number_of(ws.open(folder, series=wanted)) == number, wanted
    assert number_of(ws.open_series(folder, series="fse")[0]) == 2
    assert wavesplat("info", folder, "--series", "AX FSE T2").returncode == 0


@pytest.mark.parametrize(
    ("wanted", "told"),
    [
        (None, r"3 series; choose one with series= \(--series\), by its number.*2 MR \"AX FSE T2\" \(3 files"),
        ("AX", r"2 series match series='AX'.*2 MR \"AX FSE T2\" 1.2.840.7.2 .*3 MR \"AX T1 post\" 1.2.840.7.3 "),
        ("1.2.840", r"3 series match.*1.2.840.8.7"),
        ("sagittal", r"no series 'sagittal'.*2 MR \"AX FSE T2\" .*3 MR \"AX T1 post\" .*7 CT"),
        (0, "no series 0.*AX FSE T2"),
        ("", "no series ''.*AX FSE T2"),
    ],
)
def test_errors_list_the_series_with_descriptions_fault_12(tmp_path, wanted, told):
    with pytest.raises((FileError, ArgumentError), match=told):
        ws.open(study(tmp_path / "patient"), series=wanted)


def test_a_modality_that_several_series_have_is_no_choice_fault_12(tmp_path):
    with pytest.raises(ArgumentError, match=r"2 series match series='mri'.*AX FSE T2.*AX T1 post"):
        ws.open(study(tmp_path / "patient"), series="mri")


def test_series_of_one_number_are_told_by_their_uid(tmp_path):
    save(tmp_path / "a", slices_of(2, "MR", "scout", "1.2.3"))
    save(tmp_path / "b", slices_of(2, "MR", "brain", "1.2.4"))
    with pytest.raises(ArgumentError, match=r"2 series match series=2.*\"scout\" 1.2.3 .*\"brain\" 1.2.4 "):
        ws.open(tmp_path, series=2)
    assert ws.open(tmp_path, series="brain").shape == (3, 6, 7)


def test_damaged_files_of_other_series_are_not_told(tmp_path):
    folder = study(tmp_path / "patient")
    (folder / "STUDY1" / "S003" / "000.dcm").write_bytes(b"\0" * 128 + b"DICM" + b"\xff" * 40)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert number_of(ws.open(folder, series=2)) == 2
    with pytest.warns(ws.errors.FileWarning, match="damaged"):
        ws.open(folder, series=3)


def test_folders_that_lead_in_a_circle_are_entered_once(tmp_path):
    folder = tmp_path / "patient"
    folder.mkdir()
    save(folder / "ct", [slice_at(one, n) for n, one in enumerate(random(3))])
    (folder / "ct" / "up").symlink_to(folder, target_is_directory=True)
    assert len(places.files_below(folder)) == 3
    assert ws.open(folder).shape == (3, 6, 7)


def test_a_tree_of_very_many_files_is_refused(tmp_path, monkeypatch):
    monkeypatch.setattr(places, "MAX_ENTRIES", 5)
    with pytest.raises(FileError, match="more than 5 files and folders; name the folder of a patient"):
        ws.open(study(tmp_path / "patient"))


def test_files_of_other_systems_are_left_out(tmp_path):
    folder = save(tmp_path / "ct", [slice_at(one, n) for n, one in enumerate(random(3))])
    (folder / "._000.dcm").write_bytes(b"\0\5\x16\7")
    (folder / ".cache").mkdir()
    (folder / ".cache" / "001.dcm").write_bytes((folder / "001.dcm").read_bytes()[:300])
    assert ws.open(folder).guesses == ()


# DICOMDIR


def disc(folder):
    """A disc with a DICOMDIR and files in folders, written by pydicom."""
    from pydicom.fileset import FileSet

    files = FileSet()
    for one in SERIES[:2]:
        for dataset in slices_of(*one):
            dataset.PatientID, dataset.PatientName = "1", "Doe"
            dataset.StudyDate, dataset.StudyTime, dataset.StudyID, dataset.AccessionNumber = "20200101", "12", "1", "1"
            files.add(dataset)
    files.write(folder)
    files._stage["t"].cleanup()
    return folder / "DICOMDIR"


@pytest.mark.parametrize("case", [str, str.lower])
def test_a_directory_names_its_files_fault_11(tmp_path, case):
    file = disc(tmp_path / "disc")
    (tmp_path / "copied").mkdir()
    for one in list((tmp_path / "disc").rglob("*"))[::-1]:
        place = tmp_path / "copied" / case(one.relative_to(tmp_path / "disc").as_posix())
        if one.is_file():
            place.parent.mkdir(parents=True, exist_ok=True)
            place.write_bytes(one.read_bytes())
    # Not of the disc, so not in its directory.
    save(tmp_path / "copied" / "more", slices_of(*SERIES[2]))
    for place in (tmp_path / "copied" / case("DICOMDIR"), file):
        with pytest.raises(FileError, match=r"directory holds 2 series.*2 MR \"AX FSE T2\" \(3 files in "):
            ws.open(place)
        assert number_of(ws.open(place, series=3)) == 3
    assert number_of(ws.open(tmp_path / "copied", series=7)) == 7


def test_files_that_a_directory_names_in_vain_are_told(tmp_path):
    file = disc(tmp_path / "disc")
    series = min(one.parent for one in (tmp_path / "disc").rglob("*") if one.is_file() and one != file)
    sorted(series.iterdir())[1].unlink()
    with pytest.warns(ws.errors.FileWarning, match=r"1 file is missing that the directory \(DICOMDIR\) names"):
        volume = ws.open(file, series=2)
    assert volume.shape == (2, 6, 7)


def test_a_directory_cannot_name_files_elsewhere(tmp_path):
    from pydicom import dcmread

    file = disc(tmp_path / "disc")
    save(tmp_path / "secret", [slice_at(one, n) for n, one in enumerate(random(3))])
    dataset = dcmread(file)
    for record in dataset.DirectoryRecordSequence:
        if "ReferencedFileID" in record:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")  # of pydicom, about names that begin with a dot
                record.ReferencedFileID = ["..", "secret", "000.dcm"]
    dataset.save_as(file)
    with pytest.raises(FileError, match="no image"):
        ws.open(file)


# Archives


def packed(tmp_path, folder, **options):
    with zipfile.ZipFile(tmp_path / "study.zip", "w", zipfile.ZIP_DEFLATED, **options) as archive:
        for file in sorted(folder.rglob("*")):
            archive.write(file, file.relative_to(folder.parent))
    return tmp_path / "study.zip"


def test_a_zip_of_folders_is_read_fault_11(wavesplat, tmp_path):
    path = packed(tmp_path, study(tmp_path / "patient"))
    with pytest.raises(FileError, match=r"zip archive holds 3 series.*2 MR .*in patient/STUDY1/S002.*study.zip$"):
        ws.open(path)
    for number, *_ in SERIES:
        assert number_of(ws.open(path, series=number)) == number
    assert "AX FSE T2" in wavesplat("info", path).stdout
    assert ws.open(path, series=2).facts == ws.open(tmp_path / "patient", series=2).facts


def test_times_of_a_zip_are_unpacked_once(tmp_path, monkeypatch):
    folder = save(tmp_path / "mr", [slice_at(p, n, z=1.5 * (n // 2)) for n, p in enumerate(random(6))])
    path = packed(tmp_path, folder)
    n_unpacked = []
    unpack = places._unpack
    monkeypatch.setattr(places, "_unpack", lambda *args: n_unpacked.append(1) or unpack(*args))
    series = ws.open_series(path)
    assert [volume.shape for volume in series] == [(3, 6, 7)] * 2
    assert len(n_unpacked) == 1


def test_messages_name_the_archive_and_not_where_it_was_unpacked(tmp_path):
    folder = save(tmp_path / "ct", [slice_at(random(1)[0], 0)])
    with pytest.raises(FileError, match=r"single plane.*study.zip$") as caught:
        ws.open(packed(tmp_path, folder))
    assert "wavesplat-" not in str(caught.value)


def test_archives_that_are_not_read(tmp_path, monkeypatch):
    (tmp_path / "text").mkdir()
    (tmp_path / "text" / "a.txt").write_text("a")
    path = packed(tmp_path, tmp_path / "text")
    with pytest.raises(FileError, match=r"zip archive holds no DICOM files.*unpack it"):
        ws.open(path)
    folder = save(tmp_path / "ct", [slice_at(one, n) for n, one in enumerate(random(3))])
    path = packed(tmp_path, folder)
    content = bytearray(path.read_bytes())
    content[content.index(b"PK\1\2") + 8] |= 1
    (tmp_path / "secret.zip").write_bytes(content)
    with pytest.raises(FileError, match="encrypted"):
        ws.open(tmp_path / "secret.zip")
    path.with_name("cut.zip").write_bytes(path.read_bytes()[:-40])
    with pytest.raises(FileError, match="truncated or damaged"):
        ws.open(path.with_name("cut.zip"))
    monkeypatch.setattr(places, "MAX_SHARE", 0.0)
    with pytest.raises(LimitError, match=r"unpacks to .* GB, and there is room for 0 GB"):
        ws.open(path)


def test_names_in_archives_lead_nowhere_else(tmp_path):
    slices = save(tmp_path / "ct", [slice_at(one, n) for n, one in enumerate(random(3))])
    with zipfile.ZipFile(tmp_path / "a.zip", "w") as archive:
        for n, file in enumerate(sorted(slices.iterdir())):
            archive.write(file, ("../../a.dcm", "/etc/a.dcm", "c:\\a.dcm")[n])
    assert ws.open(tmp_path / "a.zip").shape == (3, 6, 7)
    assert sorted(one.name for one in tmp_path.iterdir()) == ["a.zip", "ct"]


# One file of a folder


def test_a_named_file_without_a_series_is_read_with_others_without_one(tmp_path):
    pixels = random(4)
    folder = save(tmp_path / "a", [slice_at(one, n, SeriesInstanceUID="") for n, one in enumerate(pixels)])
    save(folder / "more", slices_of(*SERIES[0]))
    for file in folder.glob("more/*"):
        file.rename(folder / f"other{file.name}")
    np.testing.assert_array_equal(ws.open(folder / "001.dcm").samples, pixels)
    assert number_of(ws.open(folder / "001.dcm", series=2)) == 2


@pytest.mark.parametrize("harm", ["cut", "another size", "another direction", "several frames"])
def test_a_broken_sibling_does_not_hinder_the_named_file_fault_16(tmp_path, harm, recwarn):
    pixels = random(5)
    folder = save(tmp_path / "mr", [slice_at(one, n) for n, one in enumerate(pixels)])
    if harm == "cut":
        content = (folder / "004.dcm").read_bytes()
        (folder / "004.dcm").write_bytes(content[:-20])
    elif harm == "another size":
        slice_at(random(1, size=(9, 9))[0], 4).save_as(folder / "004.dcm")
    elif harm == "another direction":
        slice_at(pixels[4], 4, ImageOrientationPatient=[0, 1, 0, 0, 0, 1]).save_as(folder / "004.dcm")
    else:
        base(random(2), 4, NumberOfFrames=2).save_as(folder / "004.dcm")
    volume = ws.open(folder / "001.dcm")
    np.testing.assert_array_equal(volume.samples, pixels[:4])
    assert len(volume.guesses) == 1
    assert "damaged" in volume.guesses[0] or volume.guesses[0].startswith("without 1 file of the series")
    assert {type(one.message) for one in recwarn} <= {ws.errors.FileWarning}


def test_the_list_of_files_is_kept_as_long_as_no_folder_changes(tmp_path, monkeypatch):
    """Listing the folder anew took two fifths of the time of each further time point."""
    from wavesplat._readers.dicom import places as dicom_places

    (tmp_path / "a" / "b").mkdir(parents=True)
    (tmp_path / "a" / "1.dcm").write_bytes(b"x")
    long_ago = 1_000_000_000

    def settle():
        for folder in (tmp_path / "a", tmp_path / "a" / "b"):
            os.utime(folder, (long_ago, long_ago))

    listed = []
    entries = dicom_places._entries
    monkeypatch.setattr(dicom_places, "_entries", lambda *a, **k: listed.append(a[0]) or entries(*a, **k))
    kept = {}

    def names():
        return [file.name for file in dicom_places.files_below(tmp_path / "a", None, kept)]

    settle()
    assert names() == names() == ["1.dcm"]
    assert len(listed) == 2
    (tmp_path / "a" / "b" / "2.dcm").write_bytes(b"y")
    # Changed a moment ago: listed, and not kept, until it is settled.
    assert names() == names() == ["1.dcm", "2.dcm"]
    assert len(listed) == 6
    (tmp_path / "a" / "1.dcm").unlink()
    assert names() == ["2.dcm"]
