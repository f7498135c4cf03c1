"""Time series of any format: a time point is read only when it is asked for, and has the samples that were written."""

from __future__ import annotations

import gzip
import pickle
import tracemalloc

import numpy as np
import pytest
from dicom_files import save as save_dicom
from dicom_files import slice_at
from test_facts_of_files import save_imagej, save_ome, save_ome_zarr

import wavesplat as ws
from wavesplat.errors import ArgumentError, FileError

N_TIMES = 4
#: Samples of the series, [t, z, y, x].
SAMPLES = np.random.default_rng(3).integers(1, 200, (N_TIMES, 5, 6, 7)).astype(np.uint8)


def nifti(folder, name="a.nii"):
    import nibabel

    image = nibabel.Nifti1Image(SAMPLES.T, np.eye(4))
    image.header.set_zooms((1, 1, 1, 2.5))
    image.header.set_xyzt_units("mm", "sec")
    nibabel.save(image, folder / name)
    return folder / name, {}, (0, 2.5, 5, 7.5), "s"


def nifti_gz(folder):
    return nifti(folder, "a.nii.gz")


def metaimage(folder):
    import SimpleITK

    images = [SimpleITK.GetImageFromArray(one) for one in SAMPLES]
    SimpleITK.WriteImage(SimpleITK.JoinSeries(images, 0.0, 0.5), folder / "a.mha")
    return folder / "a.mha", {}, (0, 0.5, 1, 1.5), None


def nrrd_of_slicer(folder):
    """An NRRD of 3D Slicer, with the times as a list axis: each is a component of the samples."""
    head = ["NRRD0005", "type: uchar", "dimension: 4", "sizes: 4 7 6 5", "encoding: raw", "space: LPS"]
    head += ["kinds: list domain domain domain", "space directions: none (1,0,0) (0,1,0) (0,0,1)"]
    head += ["axis 0 index type:=numeric", "axis 0 index values:=0 1 4 9", "", ""]
    (folder / "a.seq.nrrd").write_bytes("\n".join(head).encode() + np.moveaxis(SAMPLES, 0, -1).tobytes())
    return folder / "a.seq.nrrd", {}, (0, 1, 4, 9), None


def nrrd(folder, kinds, *, placed=True, packed=False, apart=False):
    """An NRRD with an axis of kind time, first or last, whose samples lie in the file or in another."""
    is_first = kinds.startswith("time")
    data = (np.moveaxis(SAMPLES, 0, -1) if is_first else SAMPLES).tobytes()
    head = ["NRRD0005", "# time: none", "type: uchar", "dimension: 4", f"kinds: {kinds}"]
    head += ["sizes: 4 7 6 5" if is_first else "sizes: 7 6 5 4", f"encoding: {'gzip' if packed else 'raw'}"]
    axes = ["(1,0,0)", "(0,2,0)", "(0,0,3)"]
    if placed:
        directions = " ".join(["none", *axes] if is_first else [*axes, "none"])
        head += ["space: LPS", f"space directions: {directions}", "space origin: (1,2,3)"]
    else:
        head += ["spacings: " + ("2.5 1 2 3" if is_first else "1 2 3 2.5")]
        head += ["units: " + ('"s" "um" "um" "um"' if is_first else '"um" "um" "um" "s"')]
    head += ["kinds:=time time", *(["data file: samples.bin"] if apart else []), "", ""]
    data = gzip.compress(data) if packed else data
    if apart:
        (folder / "samples.bin").write_bytes(data)
    path = folder / ("a.nhdr" if apart else "a.nrrd")
    path.write_bytes("\n".join(head).encode() + (b"" if apart else data))
    return path, {}, (0, 1, 2, 3) if placed else (0, 2.5, 5, 7.5), None if placed else "s"


def nrrd_time_first(folder):
    return nrrd(folder, "time domain domain domain", packed=True)


def nrrd_time_last(folder):
    return nrrd(folder, "space space space time", apart=True)


def nrrd_with_units(folder):
    return nrrd(folder, "time domain domain domain", placed=False, packed=True, apart=True)


def nrrd_with_units_last(folder):
    return nrrd(folder, "domain domain domain time", placed=False)


def npy(folder):
    np.save(folder / "a.npy", SAMPLES)
    return folder / "a.npy", {}, (0, 1, 2, 3), None


def npy_with_channels(folder):
    np.save(folder / "a.npy", np.stack([SAMPLES + np.uint8(1), SAMPLES], axis=-1))
    return folder / "a.npy", {"channel": 1}, (0, 1, 2, 3), None


def raw(folder):
    SAMPLES.tofile(folder / "a.raw")
    return folder / "a.raw", {"shape": SAMPLES.shape, "dtype": "uint8"}, (0, 1, 2, 3), None


def hdf5(folder):
    import h5py

    with h5py.File(folder / "a.h5", "w") as file:
        file["movie"] = SAMPLES
    return folder / "a.h5", {"dataset": "movie"}, (0, 1, 2, 3), None


def ome_zarr(folder):
    stack = np.stack([SAMPLES + np.uint8(1), SAMPLES], axis=1)
    path = save_ome_zarr(folder / "a.zarr", stack, "tczyx", {"t": "second"}, (30, 1, 1, 1, 1))
    return path, {"channel": 1}, (0, 30, 60, 90), "s"


def imagej(folder):
    stack = np.stack([SAMPLES + np.uint8(1), SAMPLES], axis=2)
    return save_imagej(folder / "a.tif", stack, axes="TZCYX", finterval=1.5), {"channel": 1}, (0, 1.5, 3, 4.5), "s"


def ome_tiff(folder):
    stack = np.stack([SAMPLES + np.uint8(1), SAMPLES], axis=1)
    planes = {
        "DeltaT": [float(t * t) for t in range(N_TIMES) for _ in range(10)],
        "DeltaTUnit": ["s"] * 40,
        "TheT": [t for t in range(N_TIMES) for _ in range(10)],
        "TheC": [c for _ in range(N_TIMES) for c in range(2) for _ in range(5)],
        "TheZ": list(range(5)) * 8,
    }
    path = save_ome(folder / "a.ome.tif", stack, axes="TCZYX", Plane=planes)
    return path, {"channel": 1}, (0, 1, 4, 9), "s"


def packed_ome_tiff(folder):
    import tifffile

    tifffile.imwrite(folder / "a.ome.tif", SAMPLES, metadata={"axes": "TZYX", "TimeIncrement": 2.0}, compression="zlib")
    return folder / "a.ome.tif", {}, (0, 2, 4, 6), "s"


def dicom(folder):
    clocks = ("110059", "110100.5", "110102", "120000")
    datasets = [
        slice_at(SAMPLES[t, z].astype(np.uint16), 5 * t + z, 1.5 * z, AcquisitionTime=clocks[t])
        for t in range(N_TIMES)
        for z in range(5)
    ]
    return save_dicom(folder / "ct", datasets), {}, (0, 1.5, 3, 3541), "s"


def files(folder):
    for number, one in enumerate(SAMPLES):
        np.save(folder / f"t{number + 8}.npy", one)
    return folder / "t*.npy", {}, (8, 9, 10, 11), None


FORMATS = [
    nifti, nifti_gz, metaimage, nrrd_of_slicer, nrrd_time_first, nrrd_time_last, nrrd_with_units, nrrd_with_units_last,
     npy, npy_with_channels, raw, hdf5, ome_zarr, imagej, ome_tiff,
    packed_ome_tiff, dicom, files,
]  # fmt: skip


@pytest.mark.parametrize("written", FORMATS)
def test_time_points_of_a_format(tmp_path, written):
    path, options, times, unit = written(tmp_path)
    series = ws.open_series(path, **options)
    assert len(series) == N_TIMES
    for number in (2, 0, -1, 1, -3):  # in no order: streams go back
        np.testing.assert_array_equal(series[number].samples, SAMPLES[number])
    for volume, samples in zip(series, SAMPLES, strict=True):
        np.testing.assert_array_equal(volume.samples, samples)
    assert series.times == pytest.approx(times)
    assert series.time_unit == unit
    later = series[::-2]
    assert later.times == pytest.approx((times[3], times[1]))
    np.testing.assert_array_equal(later[0].samples, SAMPLES[3])
    with pytest.raises(ArgumentError, match=r"time point 4, but .* holds 4, 0\.\.3"):
        series[4]


def test_times_are_known_before_a_volume_is_read(tmp_path):
    path, _, times, _ = nifti(tmp_path)
    assert ws.open_series(path)[1:].times == pytest.approx(times[1:])


def test_a_file_of_one_volume_is_a_series_of_one(tmp_path):
    np.save(tmp_path / "a.npy", SAMPLES[0])
    series = ws.open_series(tmp_path / "a.npy")
    assert (len(series), series.times, series.name) == (1, (0.0,), "a.npy")
    np.testing.assert_array_equal(series[0].samples, SAMPLES[0])
    with pytest.raises(ArgumentError, match=r"time point -2, but the file '.*a\.npy' holds 1, 0\.\.0"):
        series[-2]


def test_the_last_few_volumes_are_kept(tmp_path):
    path, options, _, _ = npy(tmp_path)
    series = ws.open_series(path, **options)
    first = series[0]
    assert series[0] is first
    assert series[:2][0] is first
    for _ in series:
        pass
    assert series[0] is not first


def test_one_time_point_is_read_and_no_more(tmp_path):
    path = tmp_path / "a.raw"
    with path.open("wb") as file:
        file.truncate(4000 * 64**3 * 4)  # 4 GB, none of them written
    series = ws.open_series(path, shape=(4000, 64, 64, 64), dtype="float32")
    tracemalloc.start()
    for number in (0, 1999, 3999, 7, 8):
        assert series[number].value_range == (0, 0)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert peak < 6 * 64**3 * 4


def test_a_list_of_files(tmp_path):
    files(tmp_path)
    series = ws.open_series([tmp_path / "t9.npy", str(tmp_path / "t8.npy")], spacing=(1, 2, 3))
    assert [volume.name for volume in series] == ["t9.npy", "t8.npy"]
    assert (series.name, series[0].spacing) == ("t9.npy to t8.npy", (1, 2, 3))
    with pytest.raises(ArgumentError, match=r"time point 2, but the list of files 't9\.npy to t8\.npy' holds 2"):
        series[2]


def test_what_is_wrong_with_files_is_said(tmp_path):
    files(tmp_path)
    np.save(tmp_path / "all.npy", SAMPLES)
    with pytest.raises(FileError, match=r"no file matches .*x\*\.npy$"):
        ws.open_series(tmp_path / "x*.npy")
    with pytest.raises(FileError, match=r"no such file .*t12\.npy$"):
        ws.open_series([tmp_path / "t8.npy", tmp_path / "t12.npy"])
    with pytest.raises(FileError, match=r"holds 4 time points itself; open it alone.*all\.npy$"):
        ws.open_series([tmp_path / "t8.npy", tmp_path / "all.npy"])[1]
    with pytest.raises(ArgumentError, match="empty list"):
        ws.open_series([])
    with pytest.raises(ArgumentError, match="level= has no meaning"):
        ws.open_series(tmp_path / "t8.npy", level=1)
    with pytest.raises(ArgumentError, match="one of the paths is 3"):
        ws.open_series([3])


def test_names_with_brackets_are_names(tmp_path):
    np.save(tmp_path / "a[1].npy", SAMPLES)
    assert len(ws.open_series(tmp_path / "a[1].npy")) == N_TIMES


@pytest.mark.parametrize("written", [nifti_gz, files])
def test_series_are_pickled_without_what_they_keep(tmp_path, written):
    series = ws.open_series(written(tmp_path)[0])
    np.testing.assert_array_equal(series[1].samples, SAMPLES[1])
    data = pickle.dumps(series)
    again = pickle.loads(data)  # noqa: S301 - our own bytes
    assert b"_kept" not in data or again._kept == {}
    np.testing.assert_array_equal(again[2].samples, SAMPLES[2])


def test_damage_in_a_packed_series_is_found(tmp_path):
    path, *_ = nifti_gz(tmp_path)
    content = bytearray(path.read_bytes())
    content[-6] ^= 1  # a byte of the checksum
    path.write_bytes(content)
    with pytest.raises(FileError, match="damaged|CRC"):
        ws.open_series(path)[0]


def test_series_of_volumes():
    volumes = [ws.Volume(one) for one in SAMPLES]
    series = ws.Series(volumes, times=[0, 1, 3, 7], time_unit="min", name="beat")
    assert series[2] is volumes[2]
    assert (series[1:3].times, series[1:].time_unit, repr(series)) == (
        (1, 3),
        "min",
        "<Series 'beat': 4 time points>",
    )
    with pytest.raises(ArgumentError, match="no time point lies in 4:2:None; series 'beat' holds 4"):
        series[4:2]
    with pytest.raises(ArgumentError, match="time point is 'x'"):
        series["x"]


@pytest.mark.parametrize(
    ("volumes", "more", "message"),
    [
        ([], {}, "at least one volume"),
        (3, {}, "volumes of a series are 3"),
        (ws.Volume(SAMPLES[0]), {}, "volumes of a series are a Volume"),
        ([ws.Volume(SAMPLES[0])], {"times": [1, 2]}, "2 times are given for 1 volumes"),
        ([ws.Volume(SAMPLES[0])], {"times": [np.nan]}, "finite"),
        ([ws.Volume(SAMPLES[0])], {"times": "x"}, "times of a series is 'x'"),
    ],
)
def test_what_is_no_series(volumes, more, message):
    with pytest.raises(ArgumentError, match=message):
        ws.Series(volumes, **more)


def test_what_wants_one_volume_says_how_to_take_it():
    with pytest.raises(ArgumentError, match=r"volume is a Series of several times; give one of them, as series\[0\]"):
        ws.mesh(ws.Series([ws.Volume(SAMPLES[0])]), 1)


def test_arrays_become_volumes_by_hand():
    with pytest.raises(ArgumentError, match="time point 0 of series 'series' is a ndarray; give a list of volumes"):
        ws.Series(SAMPLES)[0]
