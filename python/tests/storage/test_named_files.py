"""A file makes us read other files only in its own folder, or where the user allows it."""

from __future__ import annotations

import os

import numpy as np
import pytest

import wavesplat as ws
from wavesplat.errors import FileError

SAMPLES = np.arange(60, dtype=np.uint8).reshape(3, 4, 5)
NRRD = "NRRD0004\ntype: uint8\ndimension: 3\nsizes: 5 4 3\nencoding: raw\n"
META = "ObjectType = Image\nNDims = 3\nDimSize = 5 4 3\nElementType = MET_UCHAR\n"


@pytest.fixture
def folder(tmp_path):
    """A folder for headers, beside which lie samples that they may not read."""
    (tmp_path / "secret.raw").write_bytes(SAMPLES.tobytes())
    (tmp_path / "mine").mkdir()
    return tmp_path / "mine"


def refused(path, match="in another folder; if you trust it, pass external_files=True", **options):
    with pytest.raises(FileError, match=match) as caught:
        ws.open(path, **options)
    assert str(caught.value).endswith(str(path))


def allowed(path, samples=SAMPLES, **options):
    np.testing.assert_array_equal(ws.open(path, external_files=True, **options).samples, samples)


@pytest.mark.parametrize("name", ["SECRET", "../secret.raw", "./.././secret.raw", "sub/../../secret.raw"])
@pytest.mark.parametrize(
    ("suffix", "header"),
    [
        ("nhdr", NRRD + "data file: {}\n"),
        ("nrrd", NRRD + "datafile: {}\n"),
        ("mhd", META + "ElementDataFile = {}\n"),
        ("mha", META + "ElementDataFile : {}\n"),
    ],
)
@pytest.mark.every_pair
def test_samples_elsewhere(folder, name, suffix, header):
    path = folder / f"a.{suffix}"
    (folder / "sub").mkdir()
    path.write_text(header.format(name.replace("SECRET", str(folder.parent / "secret.raw"))))
    refused(path)
    allowed(path)


@pytest.mark.parametrize("name", ["b.raw", "sub/b.raw", "./b.raw", "sub/../b.raw", "HERE/b.raw"])
@pytest.mark.parametrize(
    ("suffix", "header"), [("nhdr", NRRD + "data file: {}\n"), ("mhd", META + "ElementDataFile = {}\n")]
)
def test_samples_in_the_own_folder_are_read(folder, monkeypatch, name, suffix, header):
    (folder / "sub").mkdir()
    for place in (folder, folder / "sub"):
        # The user's own links may lead anywhere.
        (place / "b.raw").symlink_to(folder.parent / "secret.raw")
    path = folder / f"a.{suffix}"
    path.write_text(header.format(name.replace("HERE", str(folder))))
    np.testing.assert_array_equal(ws.open(path).samples, SAMPLES)
    monkeypatch.chdir(folder)
    np.testing.assert_array_equal(ws.open(path.name).samples, SAMPLES)


@pytest.mark.parametrize(
    ("suffix", "header"),
    [
        ("nhdr", NRRD + "data file: LIST\nfine.raw\n../secret.raw\n"),
        ("nhdr", NRRD + "data file: ../s%01d.raw 0 2 1\n"),
        ("mhd", META + "ElementDataFile = LIST\nfine.raw\n../secret.raw\n"),
        ("mhd", META + "ElementDataFile = ../s%01d.raw 0 2 1\n"),
        ("nhdr", NRRD + f"# {'.' * 100_000}\ndata file: ../secret.raw\n"),
        ("nhdr", NRRD + "data file: ../secret.raw\0/../../mine/b.raw\n"),
        ("nhdr", NRRD + "# \x0c\x0c\x85\x85 \ndata file: ../secret.raw\n"),
    ],
)
def test_lists_patterns_and_long_headers(folder, suffix, header):
    path = folder / f"a.{suffix}"
    path.write_text(header, encoding="latin-1", newline="")
    refused(path)


@pytest.mark.parametrize(
    ("suffix", "header", "match"),
    [
        ("mhd", META + "Comment = x ElementDataFile = LOCAL\nElementDataFile = ../secret.raw\n", "does not say where"),
        ("mhd", META + "Comment = x\rElementDataFile = LOCAL\nElementDataFile = ../secret.raw\n", "does not say where"),
        ("mhd", META, "does not say where"),
        ("nhdr", NRRD + "data file: a.raw\ndata file: ../secret.raw\n", "says twice"),
        ("nhdr", NRRD + "content: x\rdata file: ../secret.raw\n", "line ends in the middle"),
        ("mhd", META + "ElementDataFile = s%n%s.raw 0 2 1\n", "a pattern with one number"),
        ("nhdr", NRRD + "data file: s%d.raw 0 99999999 1\n", "a pattern with one number"),
    ],
)
def test_headers_that_could_be_read_in_two_ways(folder, suffix, header, match):
    path = folder / f"a.{suffix}"
    path.write_text(header, newline="")
    refused(path, match)


def test_numbered_files_are_read(folder):
    for number, one in enumerate(SAMPLES):
        (folder / f"s{number:02}.raw").write_bytes(one.tobytes())
    (folder / "a.mhd").write_text(META + "ElementDataFile = s%02d.raw 0 2 1\n")
    (folder / "b.nhdr").write_text(NRRD + "data file: s%02d.raw 0 2 1 2\n")
    (folder / "c.mhd").write_text(META + "ElementDataFile = LIST\n" + "".join(f"s{k:02}.raw\n" for k in range(3)))
    for name in ("a.mhd", "b.nhdr", "c.mhd"):
        np.testing.assert_array_equal(ws.open(folder / name).samples, SAMPLES)


@pytest.mark.parametrize(
    ("suffix", "header"), [("nhdr", NRRD + "data file: pipe\n"), ("mhd", META + "ElementDataFile = pipe\n")]
)
def test_samples_in_a_pipe_do_not_hang(folder, suffix, header):
    os.mkfifo(folder / "pipe")
    (folder / f"a.{suffix}").write_text(header)
    refused(folder / f"a.{suffix}", "which is no file")


def test_hdf5_external_storage(folder):
    import h5py

    path = folder / "a.h5"
    with h5py.File(path, "w") as file:
        file.create_dataset("raw", SAMPLES.shape, "u1", external=[(str(folder.parent / "secret.raw"), 0, 60)])
    for options in ({}, {"dataset": "raw"}):
        refused(path, "secret.raw' as the place of its samples; if you trust it, pass external_files=True", **options)
    allowed(path)


def test_hdf5_virtual_datasets(folder):
    import h5py

    with h5py.File(folder.parent / "secret.h5", "w") as file:
        file["raw"] = SAMPLES
    layout = h5py.VirtualLayout(SAMPLES.shape, "u1")
    layout[:] = h5py.VirtualSource(str(folder.parent / "secret.h5"), "raw", SAMPLES.shape)
    with h5py.File(folder / "a.h5", "w") as file:
        file.create_virtual_dataset("raw", layout)
    refused(folder / "a.h5", "secret.h5' as the place of its samples")
    allowed(folder / "a.h5")


def test_hdf5_external_links(folder):
    import h5py

    with h5py.File(folder.parent / "secret.h5", "w") as file:
        file["g/raw"] = SAMPLES
    path = folder / "a.h5"
    with h5py.File(path, "w") as file:
        file["other"] = h5py.ExternalLink(str(folder.parent / "secret.h5"), "/g")
        file["soft"] = h5py.SoftLink("/other/raw")
        file["deep/softer"] = h5py.SoftLink("../soft")
        file["round"] = h5py.SoftLink("/round")
        file["own"] = SAMPLES
        file["deep/own"] = h5py.SoftLink("/own")
    for name in ("other/raw", "soft", "/other//raw"):
        refused(path, "secret.h5' as the place of", dataset=name)
        allowed(path, dataset=name)
    refused(path, "go round in a circle", dataset="round")
    refused(path, "go round in a circle", dataset="round", external_files=True)
    refused(path, "secret.h5' as the place of", dataset="./other/raw")
    np.testing.assert_array_equal(ws.open(path, dataset="./own").samples, SAMPLES)
    np.testing.assert_array_equal(ws.open(path, dataset="deep/own").samples, SAMPLES)
    np.testing.assert_array_equal(ws.open(path).samples, SAMPLES)


def test_hdf5_virtual_datasets_of_datasets_that_lie_elsewhere(folder):
    import h5py

    with h5py.File(folder.parent / "secret.h5", "w") as file:
        file["raw"] = SAMPLES
    path = folder / "a.h5"
    with h5py.File(path, "w") as file:
        file.create_dataset("flat", (60,), "u1", external=[(str(folder.parent / "secret.raw"), 0, 60)])
        file["other"] = h5py.ExternalLink(str(folder.parent / "secret.h5"), "/")
        file["own"] = SAMPLES.ravel()
        file["flat0"] = h5py.SoftLink("/flat")
        for source in ("flat", "other/raw", "own"):
            layout = h5py.VirtualLayout(SAMPLES.shape, "u1")
            layout[:] = h5py.VirtualSource(".", source, SAMPLES.shape if source == "other/raw" else (60,))
            file.create_virtual_dataset(f"of {source.replace('/', ' ')}", layout)
        # A source for each block of a growing dataset: flat0, flat1, ...
        grows, own = h5py.h5s.create_simple((3, 4, 5), (h5py.h5s.UNLIMITED, 4, 5)), h5py.h5s.create_simple((60,))
        grows.select_hyperslab((0, 0, 0), (h5py.h5s.UNLIMITED, 1, 1), (3, 4, 5), (3, 4, 5))
        made = h5py.h5p.create(h5py.h5p.DATASET_CREATE)
        made.set_virtual(grows, b".", b"flat%b", own)
        h5py.h5d.create(file.id, b"of flat%b", h5py.h5t.STD_U8LE, grows, made)
    refused(path, "secret.raw' as the place of its samples", dataset="of flat")
    refused(path, "secret.h5' as the place of 'other/raw'", dataset="of other raw")
    refused(path, "'flat%b' as the place of its samples", dataset="of flat%b")
    for name in ("of flat", "of other raw"):
        allowed(path, dataset=name)
    np.testing.assert_array_equal(ws.open(path, dataset="of own").samples, SAMPLES)


@pytest.mark.parametrize("options", [{}, {"memory": "50 MB"}])
@pytest.mark.parametrize("name", ["VTKHDF", "minc-2.0", "x"])
@pytest.mark.every_pair
def test_hdf5_links_of_the_root_are_not_followed(folder, name, options):
    import h5py

    with h5py.File(folder.parent / "secret.h5", "w") as file:
        group = file.create_group("g")
        group.attrs.update({"Type": "a password", "_Netcdf4Dimid": 0})
    links = [
        h5py.ExternalLink(str(folder.parent / "secret.h5"), "/g"),
        h5py.ExternalLink("not there.h5", "/g"),
        h5py.SoftLink("/not there"),
    ]
    for number, link in enumerate(links):
        path = folder / f"{number}.h5"  # HDF5 does not write to a file that a lazy volume holds open
        with h5py.File(path, "w") as file:
            file["own"] = SAMPLES
            file[name] = link
        volume = ws.open(path, **options)
        samples = (volume.read() if options else volume).samples
        np.testing.assert_array_equal(samples, SAMPLES)


def test_ome_tiff(folder):
    import tifffile

    def save(path, data):
        ome = (
            '<OME xmlns="http://www.openmicroscopy.org/Schemas/OME/2016-06" UUID="urn:uuid:1"><Image ID="Image:0">'
            '<Pixels ID="Pixels:0" DimensionOrder="XYZCT" Type="uint8" SizeX="5" SizeY="4" SizeZ="3" SizeC="1" '
            f'SizeT="1"><Channel ID="Channel:0:0" SamplesPerPixel="1"/>{data}</Pixels></Image></OME>'
        )
        tifffile.imwrite(path, SAMPLES[:1], description=ome, metadata=None)

    tifffile.imwrite(folder.parent / "secret.tif", SAMPLES, metadata=None, photometric="minisblack")
    part = '<TiffData FirstZ="{z}" IFD="0" PlaneCount="{n}"><UUID FileName="{name}">urn:uuid:{uuid}</UUID></TiffData>'
    path = folder / "a.ome.tif"
    own = part.format(z=0, n=1, name="a.ome.tif", uuid=1)
    save(path, own + part.format(z=1, n=2, name="../secret.tif", uuid=2))
    refused(path)
    assert ws.open(path, external_files=True).samples[1:].tolist() == SAMPLES[:2].tolist()
    (folder.parent / "secret.tif").rename(folder / "b.tif")
    save(path, own + part.format(z=1, n=2, name="b.tif", uuid=2))
    assert ws.open(path).shape == (3, 4, 5)


def test_the_command_line_takes_external_files(folder, wavesplat):
    (folder / "a.nhdr").write_text(NRRD + "data file: ../secret.raw\n")
    assert "--external-files" in wavesplat("info", folder / "a.nhdr").stderr
    assert wavesplat("info", folder / "a.nhdr", "--external-files").returncode == 0


@pytest.mark.parametrize("name", ["50%.raw", "per%20cent.raw", "a%d.raw", "s%n%s.raw 0 2 1"])
@pytest.mark.parametrize(
    ("suffix", "header"), [("mhd", META + "ElementDataFile = {}\n"), ("nhdr", NRRD + "data file: {}\n")]
)
def test_a_percent_sign_in_the_name_of_a_file_that_is_there(folder, suffix, header, name):
    (folder / name).write_bytes(SAMPLES.tobytes())
    path = folder / f"50%.{suffix}"
    path.write_text(header.format(name))
    np.testing.assert_array_equal(ws.open(path).samples, SAMPLES)
    np.testing.assert_array_equal(ws.open(path, memory="1 MB").read().samples, SAMPLES)
    (folder / name).unlink()
    refused(path, "a pattern with one number" if " " in name else "that is not there, .* where a name has a percent")
