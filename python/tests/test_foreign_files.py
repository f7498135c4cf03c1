"""Files of other kinds are named, with the way to a volume; only missing or wrong bytes are called damage."""

from __future__ import annotations

import gzip

import numpy as np
import pytest

import wavesplat as ws
from wavesplat.errors import FileError

SAMPLES = np.arange(60, dtype=np.int16).reshape(3, 4, 5)


def said(path, **options):
    with pytest.raises(FileError) as caught:
        ws.open(path, **options)
    text = str(caught.value)
    assert text.endswith(str(path))
    assert "\n" not in text
    return text


@pytest.mark.parametrize(
    ("name", "content", "words"),
    [
        ("a.czi", b"ZISRAWFILE", ("Zeiss", "OME-TIFF")),
        ("a.lif", b"p\0\0\0", ("Leica", "Fiji")),
        ("a.nii", b"CDF\2rest", ("netCDF", "ends in .nc")),
        ("a.nc", b"CDF\5rest", ("netCDF", "nccopy")),
        ("a.htg", b"<VTKFile", ("a tree of cells", "pyvista.read")),
        ("a.mif", b"mrtrix image", ("MRtrix", "mrconvert")),
        ("a.hdf", b"\x0e\x03\x13\x01rest", ("HDF4", "h4toh5")),
        ("a.cgns", b"ADF", ("grids of a simulation", "pyvista.read", "resample=N")),
        ("a.xdmf", b"<?xml", ("grids of a simulation", "pyvista.read")),
        ("a.stl", b"solid", ("a mesh", "the image that it was made from")),
        ("scan.tar", b"x", ("archive", "unpack it")),
        ("a.dat.bz2", b"x", ("packed bytes", "unpack it")),
        ("a.nrrd", b"BZh91AY", ("packed by bzip2", "unpack it")),
        ("a.nii", gzip.compress(bytes(999)), ("packed by gzip", "ends in .gz")),
        ("a.tif", b"\x89PNG\r\n", ("a PNG picture", "name the volume")),
        ("a.nii.gz.part", b"PK\3\4", ("a zip archive", "unpack it")),
        ("a.mha", b"version https://git-lfs.github.com/spec/v1\n", ("Git LFS", "git lfs pull")),
        ("a.nrrd", b"\n<!DOCTYPE html><html>404</html>", ("a web page", "download the file again")),
        ("a.vti", b'<VTKFile type="PolyData"></VTKFile>', ("a mesh of surfaces", "no samples inside")),
    ],
)
def test_what_the_file_holds_and_the_way(tmp_path, name, content, words):
    path = tmp_path / name
    path.write_bytes(content)
    text = said(path)
    for word in words:
        assert word in text
    assert "damaged" not in text
    assert "truncated" not in text


def test_samples_that_begin_like_another_kind_are_samples(tmp_path):
    samples = SAMPLES.copy()
    samples.ravel()[:2] = np.frombuffer(b"PK\3\4", np.int16)
    samples.tofile(tmp_path / "a.raw")
    volume = ws.open(tmp_path / "a.raw", shape=SAMPLES.shape, dtype="i2")
    np.testing.assert_array_equal(volume.samples, samples)


def test_cifti_is_no_image(tmp_path):
    import nibabel

    axes = (
        nibabel.cifti2.SeriesAxis(0, 1, 2),
        nibabel.cifti2.BrainModelAxis.from_mask(np.ones((2, 3, 4)), "thalamus_left"),
    )
    nibabel.save(nibabel.Cifti2Image(np.zeros((2, 24), np.float32), axes), tmp_path / "a.dtseries.nii")
    text = said(tmp_path / "a.dtseries.nii")
    assert "Cifti2Image" in text
    assert "-cifti-separate" in text


def test_formats_on_top_of_hdf5(tmp_path):
    h5py = pytest.importorskip("h5py")

    def file(name, fill):
        with h5py.File(tmp_path / name, "w") as made:
            made["data"] = SAMPLES
            fill(made)
        return tmp_path / name

    assert "ends in .mnc" in said(file("m.h5", lambda made: made.create_group("minc-2.0")))
    tree = file("v.h5", lambda made: made.create_group("VTKHDF").attrs.update({"Type": np.bytes_("PolyData")}))
    assert "a mesh of surfaces" in said(tree)

    def imaris(made):
        made.create_group("DataSetInfo")
        made.create_group("DataSet")

    for options in ({}, {"memory": "1 MB"}):
        volume = ws.open(file("i.h5", imaris), **options)
        told = "distances of samples 1, 1, 1: Imaris keeps them in DataSetInfo, which is not read with dataset="
        assert volume.guesses == (told,)
    assert ws.open(tmp_path / "i.h5", spacing=(1, 1, 2)).guesses == ()


def test_damaged_where_bytes_are_missing(tmp_path):
    ws.Volume(SAMPLES).save(tmp_path / "a.nii.gz")
    path = tmp_path / "b.nii.gz"
    path.write_bytes((tmp_path / "a.nii.gz").read_bytes()[:100])
    assert "truncated" in said(path)


@pytest.mark.parametrize(
    ("error", "words"),
    [
        (
            ImportError('HTTPFileSystem requires "requests" and "aiohttp" to be installed'),
            'a package is missing; run: pip install "wavesplat[http]"',
        ),
        (ImportError("Install s3fs to access S3"), "a package is missing; run: pip install s3fs"),
        (ModuleNotFoundError("No module named 'imagecodecs'"), "a package is missing; run: pip install imagecodecs"),
        (ValueError("<COMPRESSION.JPEG2000> requires the 'imagecodecs' package"), "run: pip install imagecodecs"),
        (ModuleNotFoundError("No module named 'unknown'"), "a package is missing; install it with pip"),
        (FileNotFoundError("http://host/a.zarr"), "it is not there; check the name"),
        (ConnectionRefusedError("refused"), "the server does not answer"),
        (EOFError("ended"), "the file is truncated or damaged"),
        (ValueError("fread got only 5 of 6"), "the file is truncated or damaged"),
        (ValueError("unknown kind 7"), "damaged, or of a form that wavesplat does not read"),
    ],
)
def test_what_may_be_done_fits_the_error(error, words):
    from wavesplat._files.reading import reading

    with pytest.raises(FileError) as caught, reading("Zarr", "a.zarr"):
        raise error
    assert words in str(caught.value)
    assert ("damaged" in str(caught.value)) == ("damaged" in words)
