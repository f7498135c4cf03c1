"""NRRD files that ITK cannot read as they are: skips, bzip2, and a fourth axis of no known kind."""

from __future__ import annotations

import bz2
import gzip

import numpy as np
import pytest

import wavesplat as ws

SAMPLES = np.random.default_rng(3).integers(0, 60000, (4, 5, 6)).astype("<u2")
HEADER = "NRRD0004\ntype: uint16\ndimension: 3\nsizes: 6 5 4\nendian: little\nspacings: 1 2 3\n"
TIMES = np.random.default_rng(4).integers(-99, 99, (3, 4, 5, 6)).astype("<i2")
PACKED = {"raw": bytes, "gzip": gzip.compress, "bzip2": bz2.compress}


def of_times(sizes, directions, kinds):
    kinds = f"kinds: {kinds}\n" if kinds else ""
    return (
        "NRRD0005\ntype: short\ndimension: 4\nspace: RAS\n"
        f"sizes: {sizes}\nspace directions: {directions}\n{kinds}endian: little\nspace origin: (0,0,0)\n"
    )


@pytest.mark.parametrize("encoding", PACKED)
@pytest.mark.parametrize("lines", [b"", b"one\ntwo\n"])
@pytest.mark.parametrize("skipped", [b"", b"abc"])
def test_lines_are_skipped_before_samples_are_unpacked_and_bytes_after(tmp_path, encoding, lines, skipped):
    n_lines = lines.count(b"\n")
    header = f"{HEADER}encoding: {encoding}\nline skip: {n_lines}\nbyte skip: {len(skipped)}\n"
    data = lines + PACKED[encoding](skipped + SAMPLES.tobytes())
    (tmp_path / "a.nrrd").write_bytes(header.encode() + b"\n" + data)
    (tmp_path / "a.data").write_bytes(data)
    (tmp_path / "a.nhdr").write_text(f"{header}data file: a.data\n")
    for name in ("a.nrrd", "a.nhdr"):
        volume = ws.open(tmp_path / name)
        np.testing.assert_array_equal(volume.samples, SAMPLES)
        np.testing.assert_allclose(volume.spacing, (1, 2, 3))


@pytest.mark.parametrize("encoding", PACKED)
@pytest.mark.parametrize("named", ["LIST", "%d"])
def test_each_file_of_a_list_has_its_skips(tmp_path, encoding, named):
    names = [f"s{k}.data" for k in range(4)]
    for name, one in zip(names, SAMPLES, strict=True):
        (tmp_path / name).write_bytes(b"line\n" + PACKED[encoding](b"xy" + one.tobytes()))
    header = f"{HEADER}encoding: {encoding}\nline skip: 1\nbyte skip: 2\ndata file: "
    header += "\n".join(["LIST", *names]) if named == "LIST" else "s%d.data 0 3 1\n"
    (tmp_path / "a.nhdr").write_text(header)
    np.testing.assert_array_equal(ws.open(tmp_path / "a.nhdr").samples, SAMPLES)


@pytest.mark.parametrize("encoding", PACKED)
@pytest.mark.parametrize("folder", ["50%", "50% 1 2 3", "s%d", "s%03d 0 3 1"])
@pytest.mark.parametrize("named", [None, "a.data", "50%d.data", "LIST\na.data", "FOLDER/a.data"])
def test_folders_with_percent_signs(tmp_path, monkeypatch, encoding, folder, named):
    folder = tmp_path / folder
    (folder / "temporary").mkdir(parents=True)
    monkeypatch.setattr("tempfile.tempdir", str(folder / "temporary"))
    for samples, header in (
        (SAMPLES, HEADER),
        (TIMES, of_times("6 5 4 3", "(1,0,0) (0,2,0) (0,0,3) none", "")),
    ):
        data = PACKED[encoding](samples.tobytes())
        path = folder / ("a.nrrd" if named is None else "a.nhdr")
        if named is None:
            path.write_bytes(f"{header}encoding: {encoding}\n\n".encode() + data)
        else:
            name = named.replace("FOLDER", str(folder))
            line = name.replace("LIST", f"LIST {samples.ndim}")
            path.write_text(f"{header}encoding: {encoding}\ndata file: {line}\n")
            (folder / name.rpartition("\n")[2]).write_bytes(data)
        options = {"time": 1} if samples is TIMES else {}
        wanted = TIMES[1] if samples is TIMES else SAMPLES
        np.testing.assert_array_equal(ws.open(path, **options).samples, wanted)


def test_bzip2_that_is_cut_or_holds_too_little_is_an_error(tmp_path):
    path = tmp_path / "a.nrrd"
    packed = bz2.compress(SAMPLES.tobytes())
    for data, message in ((packed[:-9], "ended before"), (bz2.compress(SAMPLES.tobytes()[:-2]), "238 are packed")):
        path.write_bytes(f"{HEADER}encoding: bzip2\n\n".encode() + data)
        with pytest.raises(ws.errors.FileError, match=message):
            ws.open(path)
    path.write_bytes(f"{HEADER}encoding: bzip2\nbyte skip: -1\n\n".encode() + packed)
    with pytest.raises(ws.errors.FileError, match="byte skip of -1 beside encoding bzip2"):
        ws.open(path)


@pytest.mark.parametrize("kinds", ["", "domain domain domain ???", "??? ??? ??? ???", "space space space none"])
@pytest.mark.parametrize("encoding", PACKED)
@pytest.mark.parametrize("is_attached", [True, False])
def test_a_fourth_axis_without_direction_and_kind_is_chosen_from(tmp_path, kinds, encoding, is_attached):
    header = of_times("6 5 4 3", "(1,0,0) (0,2,0) (0, 0,3) none", kinds)
    header += f"encoding: {encoding}\nline skip: 1\nbyte skip: 2\n"
    data = b"line\n" + PACKED[encoding](b"ab" + TIMES.tobytes())
    path = tmp_path / ("a.nrrd" if is_attached else "a.nhdr")
    if is_attached:
        path.write_bytes(f"{header}\n".encode() + data)
    else:
        path.write_text(f"{header}data file: a.data\n")
        (tmp_path / "a.data").write_bytes(data)
    for options, meaning in (({"time": 1}, "time points"), ({"channel": 1}, "channels")):
        volume = ws.open(path, **options)
        np.testing.assert_array_equal(volume.samples, TIMES[1])
        np.testing.assert_allclose(volume.spacing, (1, 2, 3))
        guess = f"axis 3 of the file, 3 samples long, is of {meaning}: the file names no kind of it"
        assert guess in volume.facts.guesses
    with pytest.raises(ws.errors.FileError, match="holds 3 time points; choose one"):
        ws.open(path)


def test_a_first_axis_without_direction_and_kind_is_of_channels(tmp_path):
    path = tmp_path / "a.nrrd"
    header = of_times("3 6 5 4", "none (1,0,0) (0,2,0) (0,0,3)", "") + "encoding: raw\n\n"
    path.write_bytes(header.encode() + np.ascontiguousarray(np.moveaxis(TIMES, 0, -1)).tobytes())
    with pytest.raises(ws.errors.FileError, match="holds 3 channels; choose one"):
        ws.open(path)
    for options in ({"time": 2}, {"channel": 2}):
        np.testing.assert_array_equal(ws.open(path, **options).samples, TIMES[2])


def test_times_in_a_list_of_files(tmp_path):
    header = of_times("6 5 4 3", "(1,0,0) (0,2,0) (0,0,3) none", "domain domain domain time") + "encoding: raw\n"
    for k, one in enumerate(TIMES):
        (tmp_path / f"t {k}.raw").write_bytes(one.tobytes())
    (tmp_path / "a.nhdr").write_text(f"{header}data file: LIST\nt 0.raw\nt 1.raw\nt 2.raw\n")
    volume = ws.open(tmp_path / "a.nhdr", time=2)
    np.testing.assert_array_equal(volume.samples, TIMES[2])
    assert (volume.facts.n_times, volume.facts.guesses) == (3, ())


@pytest.mark.parametrize(
    ("space", "signs"),
    [
        ("left-posterior-superior-time", (-1, -1, 1)),
        ("LPST", (-1, -1, 1)),
        ("right-anterior-superior-time", (1, 1, 1)),
        ("RAST", (1, 1, 1)),
        ("LAST", (-1, 1, 1)),
        ("scanner-xyz-time", None),
    ],
)
def test_spaces_with_a_time_axis(tmp_path, space, signs):
    """By their long and their short names. ITK turns no such space, and does not name its units."""
    head = (
        f"NRRD0005\ntype: short\ndimension: 4\nspace: {space}\nsizes: 6 5 4 3\nendian: little\nencoding: raw\n"
        "space directions: (2,0,0,0) (0,3,0,0) (0,0,4,0) (0,0,0,2.5)\nspace origin: (7,8,9,0)\n"
        'space units: "um" "um" "um" "s"\nkinds: domain domain domain domain\n\n'
    )
    (tmp_path / "a.nrrd").write_bytes(head.encode() + TIMES.tobytes())
    series = ws.open_series(tmp_path / "a.nrrd")
    assert (series.times, series[0].facts.time_unit, series[0].unit) == ((0, 2.5, 5), "s", "um")
    assert series[0].facts.is_anatomical == (signs is not None)
    for t, volume in enumerate(series):
        np.testing.assert_array_equal(volume.samples, TIMES[t])
    wanted = np.diag([*(signs or (1, 1, 1)), 1]) @ [[2, 0, 0, 7], [0, 3, 0, 8], [0, 0, 4, 9], [0, 0, 0, 1]]
    np.testing.assert_array_equal(series[0].world_from_index, wanted)


def test_modalities_by_the_codes_of_dicom(tmp_path):
    """As ITK writes what it read from DICOM."""
    for word, code in (("XA", "XA"), ("SEG", "SEG"), ("PT", "PT"), ("nonsense", None)):
        (tmp_path / "a.nrrd").write_bytes(f"{HEADER}encoding: raw\n0008|0060:={word}\n\n".encode() + SAMPLES.tobytes())
        assert ws.open(tmp_path / "a.nrrd").modality == code
