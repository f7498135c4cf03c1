"""Files of other kinds are named, with the way to a volume; only missing or wrong bytes are called damage."""

from __future__ import annotations

import contextlib
import gzip
import re
import sys
from pathlib import Path
from types import ModuleType, SimpleNamespace

import numpy as np
import pytest
from PIL import Image

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
        ("a.map", b"x", ("an MRC map", "moveaxis", "h.mapc", "docs/interop.md")),
        ("a.map.gz", b"\x1f\x8b", ("an MRC map", "mrcfile.open")),
        ("a.rec", bytes(208) + b"MAP " + bytes(812), ("an MRC map",)),
        ("case.foam", b"", ("a case of OpenFOAM", "OpenFOAMReader", "time_values", "internalMesh")),
        ("a.ex2", b"CDF\1", ("Exodus", "pyvista.read")),
        ("a.silo", b"\x89HDF\r\n\x1a\n", ("Silo", "VisIt")),
        ("a.case", b"FORMAT", ("EnSight", "pyvista.read")),
        ("a.q", b"\2\0\0\0", ("PLOT3D", "MultiBlockPlot3DReader")),
        ("a.xyz", b"\2\0\0\0", ("PLOT3D",)),
        ("a.xyz", b"2\nwater\nO 0 0 0\n", ("atoms", "wavesplat.Points")),
        ("a.hierarchy", b"\nGrid = 1", ("Enzo", "yt.load", "covering_grid")),
        ("a.bin0", b"# OOMMF OVF 2.0", ("OVF", "discretisedfield")),
        ("a.omf", b"# OOMMF", ("OVF", "f.array[..., 2].T")),
        ("a.slc", b"11", ("SLC", "pyvista.read(path) as .vti")),
        ("a.cjson", b"{}", ("Chemical JSON", "Gaussian cubes")),
        ("silicon", b"ITEM: TIMESTEP\n0", ("LAMMPS", "lammps-dump-text")),
        ("a.pp", b"\0\0\1\0", ("Met Office", "iris.load_cube")),
        ("gasdens5.dat", bytes(64), ("FARGO3D", "domain_y.dat", "float64")),
        ("a.fits", b"SIMPLE  =", ("FITS", "astropy")),
        ("weather", b"GRIB\0\0", ("GRIB", "xarray")),
        ("a.mat", b"MATLAB 5.0 MAT-file", ("MATLAB", "loadmat")),
        ("a.bp", b"x", ("ADIOS2", "adios2.FileReader")),
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


@pytest.mark.parametrize(
    ("files", "words"),
    [
        ({"attributes.json": '{"dimensions": [2, 3, 4]}'}, ("N5", "tensorstore")),
        ({"color/1/attributes.json": "{}"}, ("N5", "'driver': 'n5'")),
        ({"info": '{"scales": [], "num_channels": 1}'}, ("precomputed", "neuroglancer_precomputed")),
        ({"color/info": '{"scales": [], "num_channels": 1}'}, ("precomputed",)),
        ({"color/1/header.wkw": "WKW"}, ("WEBKNOSSOS", "wkw.Dataset.open")),
        ({"system/controlDict": "", "constant/polyMesh/points": ""}, ("a case of OpenFOAM", "OpenFOAMReader")),
        ({"run/case.foam": "", "run/0/U": ""}, ("a case of OpenFOAM",)),
        ({"md.idx": "", "data.0": ""}, ("ADIOS2",)),
        ({"Header": "", "Level_0/Cell_H": ""}, ("AMReX", "yt.load")),
    ],
)
def test_what_a_folder_holds_and_the_way(tmp_path, files, words):
    for name, content in files.items():
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text(content)
    text = said(tmp_path)
    for word in words:
        assert word in text


def test_a_format_deep_in_a_folder_of_slices_hides_them_not(tmp_path):
    for number in range(3):
        Image.fromarray(SAMPLES[number].astype(np.uint8)).save(tmp_path / f"{number}.tif")
    (tmp_path / "resaved").mkdir()
    (tmp_path / "resaved" / "attributes.json").write_text("{}")
    assert ws.open(tmp_path).shape == SAMPLES.shape


def test_the_lines_for_mrc_keep_axes_and_place(monkeypatch):
    """An odd order of axes, against arithmetic: columns are z, rows x, sections y, as of EMD-3001."""
    values = np.random.default_rng(0).normal(size=(4, 3, 5)).astype(np.float32)  # sections y, rows x, columns z
    header = {"mapc": 3, "mapr": 1, "maps": 2, "nxstart": 7, "nystart": -2, "nzstart": 10, "origin": np.zeros(3)}
    size = np.array((0.5, 1.0, 2.0))
    opened = SimpleNamespace(data=values, header=header, voxel_size=size)
    fake = ModuleType("mrcfile")
    fake.open = lambda *_, **__: contextlib.nullcontext(opened)
    monkeypatch.setitem(sys.modules, "mrcfile", fake)
    page = (Path(__file__).parents[3] / "docs" / "interop.md").read_text(encoding="utf-8")
    (code,) = re.findall(r"```python\n(def volume_of_mrc.*?)```", page, re.DOTALL)
    names = {"np": np, "ws": ws}
    exec(code, names)  # noqa: S102 - of our own page
    volume = names["volume_of_mrc"]("a.map")
    assert (volume.shape, volume.spacing, volume.unit) == ((5, 4, 3), (0.5, 1.0, 2.0), "angstrom")
    assert volume.samples[4, 2, 1] == values[2, 1, 4]
    # Starts along columns, rows, sections: z from 7, x from -2, y from 10.
    np.testing.assert_allclose(volume.world_from_index[:3, 3], (-2 * 0.5, 10 * 1.0, 7 * 2.0))
    header["origin"] = np.array((3.0, 4.0, 5.0))
    np.testing.assert_allclose(names["volume_of_mrc"]("a.map").world_from_index[:3, 3], (3, 4, 5))


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
    from wavesplat._storage.reading import reading

    with pytest.raises(FileError) as caught, reading("Zarr", "a.zarr"):
        raise error
    assert words in str(caught.value)
    assert ("damaged" in str(caught.value)) == ("damaged" in words)
