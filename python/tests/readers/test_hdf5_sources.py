"""Virtual datasets of HDF5 that are made of themselves, or of very many others, with which HDF5 crashes or hangs."""

import h5py
import numpy as np
import pytest

import wavesplat as ws
from wavesplat.errors import FileError, LimitError, WavesplatError

SHAPE = (4, 4, 4)


def virtual(file, name, *sources):
    """A virtual dataset whose slices are those of sources, each given as (file, dataset) or a dataset of this file."""
    layout = h5py.VirtualLayout(SHAPE, "f4")
    for index in range(SHAPE[0]):
        source = sources[index % len(sources)]
        where = (".", source) if isinstance(source, str) else source
        layout[index] = h5py.VirtualSource(*where, SHAPE)[index]
    file.create_virtual_dataset(name, layout)


def itself(file):
    virtual(file, "x", "x")


def each_other(file):
    file["own"] = np.zeros(SHAPE)
    virtual(file, "other", "own", "x")
    virtual(file, "x", "other")


def by_another_name(file):
    virtual(file, "x", "same")
    file["same"] = file["x"]


def through_a_soft_link(file):
    virtual(file, "x", "link")
    file["link"] = h5py.SoftLink("/x")


def of_a_chain(file):
    file["0"] = np.zeros(SHAPE)
    for number in range(1, 60):
        virtual(file, str(number), str(number - 1))
    virtual(file, "x", "20", "40", "59")


def of_too_many(file):
    file["0"] = np.zeros(SHAPE)
    for number in range(1, 13):
        virtual(file, str(number), str(number - 1))
    virtual(file, "x", "12")


KINDS = {
    itself: "'/x' is made of itself",
    each_other: "'/x' is made of itself",
    by_another_name: "made of itself",
    through_a_soft_link: "'/link' is made of itself",
    of_a_chain: "nested too deep",
    of_too_many: "nested too deep",
}


@pytest.mark.parametrize("make", KINDS)
@pytest.mark.parametrize("options", [{}, {"memory": "50 MB"}, {"external_files": True}], ids=["", "lazy", "others"])
def test_circles_and_depth_are_refused(tmp_path, make, options):
    with h5py.File(tmp_path / "a.h5", "w") as file:
        make(file)
    with pytest.raises(FileError, match=KINDS[make]):
        ws.open(tmp_path / "a.h5", dataset="x", **options)


def test_circles_through_another_file(tmp_path):
    for name, other in (("one", "two"), ("two", "one")):
        with h5py.File(tmp_path / f"{name}.h5", "w") as file:
            virtual(file, "x", (f"{other}.h5", "x"))
    with pytest.raises(FileError, match="made of itself"):
        ws.open(tmp_path / "one.h5", external_files=True)


def test_nested_sources_that_can_be_read(tmp_path):
    samples = np.random.default_rng(1).random(SHAPE).astype("f4")
    with h5py.File(tmp_path / "a.h5", "w") as file:
        file["own"] = samples
        for name, source in (("1", "own"), ("2", "1"), ("x", "2")):
            virtual(file, name, source, source)
    np.testing.assert_array_equal(ws.open(tmp_path / "a.h5", dataset="x").samples, samples)


def test_circles_in_other_formats_on_hdf5(tmp_path):
    """BigDataViewer's table of levels and Imaris' samples, netCDF, a dataset of h5py, a transform of ITK."""
    with h5py.File(tmp_path / "bdv.h5", "w") as file:
        file["t00000/s00/0/cells"] = np.zeros(SHAPE, "i2")
        virtual(file, "s00/resolutions", "s00/resolutions")
    with h5py.File(tmp_path / "a.ims", "w") as file:
        file.create_group("DataSetInfo/Image")
        inside = "DataSet/ResolutionLevel 0/TimePoint 0/Channel 0/Data"
        virtual(file, inside, inside)
    for name in ("a.nc", "a.h5", "a.tfm"):
        with h5py.File(tmp_path / name, "w") as file:
            itself(file)
    for name in ("bdv.h5", "a.ims", "a.nc"):
        for options in ({}, {"memory": "50 MB"}):
            with pytest.raises(FileError, match="made of itself"):
                ws.open(tmp_path / name, external_files=True, **options)
    with h5py.File(tmp_path / "a.h5") as file:
        for make in (ws.Volume, ws.Volume.lazy):
            with pytest.raises(WavesplatError, match="made of itself"):
                make(file["x"])
    scan = ws.examples.ripples(8)
    with pytest.raises(FileError, match="made of itself"):
        ws.open_transform(tmp_path / "a.tfm", moving=scan, fixed=scan)


def test_chunks_larger_than_memory(tmp_path):
    """A packed chunk of 1500^3 samples takes 7 GB to read one of them."""
    with h5py.File(tmp_path / "a.h5", "w") as file:
        file.create_dataset("x", SHAPE, "u1", maxshape=(None,) * 3, chunks=(1500, 1500, 1500), compression="gzip")
    for options in ({}, {"memory": "50 MB"}):
        with pytest.MonkeyPatch.context() as patch:
            patch.setattr("wavesplat._system.memory.free_bytes", lambda: 4 << 30)
            with pytest.raises(LimitError, match="chunks of 1500 x 1500 x 1500 samples need 6.3 GiB"):
                ws.open(tmp_path / "a.h5", **options)
