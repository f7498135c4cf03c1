"""VTK's XML images: every way to write one gives the same samples."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from vti_files import save_vti

import wavesplat as ws
from wavesplat.errors import ArgumentError, FileError

# VTK, PyVista and xarray take seconds to load: one process does.
pytestmark = pytest.mark.xdist_group("vtk")

SAMPLES = np.random.default_rng(3).integers(0, 250, (6, 7, 9)).astype(np.int16)


@pytest.mark.parametrize("compressor", [None, "vtkZLibDataCompressor", "vtkLZMADataCompressor"])
@pytest.mark.parametrize(
    ("form", "is_base64"), [("ascii", False), ("binary", True), ("appended", False), ("appended", True)]
)
@pytest.mark.every_pair
def test_all_encodings(tmp_path, form, is_base64, compressor):
    orders, integers = ("LittleEndian", "BigEndian"), ("UInt32", "UInt64")
    for dtype, byte_order, header_type in itertools.product(["u1", "i2", "u4", "i8", "f4", "f8"], orders, integers):
        samples = SAMPLES.astype(dtype)
        path = save_vti(
            tmp_path / "a.vti",
            {"other": samples[::-1], "d": samples},
            form=form,
            is_base64=is_base64,
            compressor=compressor,
            byte_order=byte_order,
            header_type=header_type,
            scalars='Scalars="d"',
        )
        volume = ws.open(path)
        # Whole numbers of 64 bits become as small as they can be.
        assert volume.samples.dtype == np.dtype(dtype) or dtype == "i8"
        assert np.array_equal(volume.samples, samples)


def test_the_grid_lies_where_the_file_says(tmp_path):
    attributes = 'Origin="1 2 3" Spacing="0.5 1 2" Direction="0 1 0 -1 0 0 0 0 1"'
    path = save_vti(tmp_path / "a.vti", {"d": SAMPLES}, attributes=attributes, first=(2, -1, 0))
    affine = ws.open(path).world_from_index
    # Index (2, -1, 0): 1 along the first column of the direction, -1 along the second.
    assert np.allclose(affine @ [0, 0, 0, 1], [1 - 1, 2 - 1, 3, 1])
    assert np.allclose(affine[:3, :3], [[0, 1, 0], [-0.5, 0, 0], [0, 0, 2]])


def test_cells_have_their_samples_in_their_middles(tmp_path):
    path = save_vti(tmp_path / "a.vti", {"d": SAMPLES}, attributes='Origin="1 2 3" Spacing="2 2 2"', of_cells=True)
    volume = ws.open(path)
    assert np.array_equal(volume.samples, SAMPLES)
    assert np.allclose(volume.world_from_index @ [0, 0, 0, 1], [2, 3, 4, 1])


@pytest.mark.parametrize("of_cells", [False, True])
def test_pieces_are_put_together(tmp_path, of_cells):
    path = save_vti(tmp_path / "a.vti", {"d": SAMPLES}, n_pieces=3, of_cells=of_cells, first=(0, 4, -2))
    assert np.array_equal(ws.open(path).samples, SAMPLES)


@pytest.mark.parametrize("of_cells", [False, True])
def test_a_missing_piece_is_missed(tmp_path, of_cells):
    path = save_vti(tmp_path / "a.vti", {"d": SAMPLES}, n_pieces=2, of_cells=of_cells)
    content = path.read_bytes()
    begin = content.rindex(b"<Piece")
    path.write_bytes(content[:begin] + content[content.rindex(b"</Piece>") + len(b"</Piece>") :])
    with pytest.raises(FileError, match="the pieces of 'd' do not fill the file's extent"):
        ws.open(path)


def test_a_piece_beyond_the_extent_is_refused(tmp_path):
    path = save_vti(tmp_path / "a.vti", {"d": SAMPLES})
    content = path.read_bytes()
    path.write_bytes(content.replace(b'<Piece Extent="0 8 0 6 0 5"', b'<Piece Extent="0 8 0 6 -3 2"'))
    with pytest.raises(FileError, match="a piece beyond the extent"):
        ws.open(path)


def test_arrays_and_channels_are_chosen(tmp_path):
    colors = np.stack([SAMPLES, SAMPLES + 1, SAMPLES + 2], axis=-1)
    path = save_vti(tmp_path / "a.vti", {"d": SAMPLES, "colors": colors})
    first = ws.open(path)
    assert np.array_equal(first.samples, SAMPLES)
    assert first.guesses == (
        "shown: d, the first of 2 arrays (d, colors); dataset=NAME (--dataset NAME) chooses another",
    )
    with pytest.raises(ArgumentError, match="no array 'Color'; did you mean 'colors'. the file holds d, colors"):
        ws.open(path, dataset="Color")
    assert ws.open(path, dataset="d").guesses == ()
    assert np.array_equal(ws.open(path, dataset="d").samples, SAMPLES)
    assert np.array_equal(ws.open(path, dataset="colors", channel=2).samples, SAMPLES + 2)


def test_vectors_are_drawn_by_their_length_f6(tmp_path):
    vectors = np.random.default_rng(0).normal(size=(*SAMPLES.shape, 3)).astype(np.float32)
    path = save_vti(tmp_path / "a.vti", {"u": vectors})
    volume = ws.open(path)
    np.testing.assert_array_almost_equal_nulp(volume.samples, np.linalg.norm(vectors, axis=-1), 1)
    (told,) = volume.guesses
    assert "'u' holds vectors, of which the length is drawn" in told
    assert ws.open(path, component="magnitude").guesses == ()
    for number, axis in enumerate("xyz"):
        np.testing.assert_array_equal(ws.open(path, component=axis).samples, vectors[..., number])
        np.testing.assert_array_equal(ws.open(path, channel=number).samples, vectors[..., number])
    assert len(ws.open_scene(path).layers) == 1
    with pytest.raises(ArgumentError, match="both choose one"):
        ws.open(path, channel=0, component="x")
    with pytest.raises(ArgumentError, match='component is .w.; use "x", "y", "z" or "magnitude"'):
        ws.open(path, component="w")


def test_colours_are_channels(tmp_path):
    colours = np.random.default_rng(0).integers(0, 255, (*SAMPLES.shape, 3)).astype(np.uint8)
    path = save_vti(tmp_path / "a.vti", {"rgb": colours})
    with pytest.raises(FileError, match="holds 3 channels; choose one with channel=0..2"):
        ws.open(path)


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        (
            b'type="ImageData"',
            b'type="PolyData"',
            r"a mesh of surfaces or lines \(PolyData\), which has no samples inside",
        ),
        (b'compressor="vtkZLib', b'compressor="vtkNew', "compressed by vtkNewDataCompressor; write it with zlib"),
        (b'type="Int16"', b'type="Float64"', "not as many samples as the extent has"),
        (b'type="Int16"', b'type="String"', "samples of type 'String' cannot be drawn"),
        (b'WholeExtent="0 8', b'WholeExtent="8 0', "an extent of 8 0"),
        (b"<ImageData", b"<!DOCTYPE a><ImageData", "a document type"),
        (b"<AppendedData", b"<AppendedDatum", "damaged"),
    ],
)
def test_what_is_wrong_is_said(tmp_path, old, new, message):
    path = save_vti(tmp_path / "a.vti", {"d": SAMPLES}, compressor="vtkZLibDataCompressor")
    content = path.read_bytes().replace(old, new)
    if b"PolyData" in new:
        content = content.replace(b"ImageData ", b"PolyData ").replace(b"/ImageData", b"/PolyData")
    path.write_bytes(content)
    with pytest.raises(FileError, match=message):
        ws.open(path)


def test_a_header_that_promises_too_much_takes_no_memory(tmp_path):
    path = save_vti(tmp_path / "a.vti", {"d": SAMPLES})
    path.write_bytes(path.read_bytes().replace(b'"0 8 0 6 0 5"', b'"0 99999 0 99999 0 99999"'))
    with pytest.raises(FileError, match=r"truncated, or a wrong header: 100000 x 100000 x 100000 x 1 samples"):
        ws.open(path)
