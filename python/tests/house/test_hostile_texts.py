"""Texts in files that ended the process, or never let it go, inside of ITK and VTK."""

import numpy as np
import pytest
import test_fuzzed_files as files
from test_growth_of_work import TEXT_VTK

import wavesplat as ws
from wavesplat.errors import FileError


@pytest.mark.parametrize("letter", ['"', "1"])
def test_words_among_the_numbers_of_an_nrrd_file(tmp_path, letter):
    """ITK copies each word into room for a number."""
    files.nrrd(tmp_path / "a.nrrd", "ascii")
    whole = (tmp_path / "a.nrrd").read_text()
    at = whole.index(" 4 5 6 ")
    (tmp_path / "a.nrrd").write_text(whole[:at] + " " + letter * 40_000 + whole[at:])
    with pytest.raises(FileError, match="a word of 40000 letters, which is no number"):
        ws.open(tmp_path / "a.nrrd")


def test_counts_of_an_nrrd_file_of_text(tmp_path):
    files.nrrd(tmp_path / "a.nrrd", "ascii")
    whole = (tmp_path / "a.nrrd").read_text()
    (tmp_path / "a.nrrd").write_text(whole.replace("sizes: 6 5 4", "sizes: 60 50 40"))
    with pytest.raises(FileError, match="truncated, or a wrong header: 60 x 50 x 40"):
        ws.open(tmp_path / "a.nrrd")


@pytest.mark.parametrize(
    ("before", "inserted"),
    [("3.0", "1" * 300), ("0 1 0", " " * 300), ("POLYGONS", " " * 300)],
    ids=["version", "behind numbers", "keyword"],
)
def test_lines_that_vtk_does_not_read(tmp_path, before, inserted):
    """VTK 9.7 ends the process at a long version, and never comes back from a long line."""
    pytest.importorskip("vtkmodules")
    (tmp_path / "a.vtk").write_text(TEXT_VTK.replace(before, before + inserted))
    with pytest.raises(FileError, match=r"a line of more than 255 letters|a first line without a version"):
        ws.open_geometry(tmp_path / "a.vtk")


def test_cubes_and_grids_whose_vectors_have_other_lengths(tmp_path):
    (tmp_path / "a.cube").write_text("a\nb\n1 0 0 0\n" + "1 2\n" * 3 + "1 1 0 0 0\n5\n")
    (tmp_path / "CHGCAR").write_text("a\n1\n" + "1 2\n" * 3 + "H\n1\nDirect\n0 0 0\n\n1 1 1\n5\n")
    for name in ("a.cube", "CHGCAR"):
        with pytest.raises(FileError, match="cannot read as a"):
            ws.open(tmp_path / name)


def test_cells_of_points_that_are_not_there(tmp_path):
    """VTK looks them up to find the outer faces."""
    vtk = pytest.importorskip("pyvista")
    grid = vtk.UnstructuredGrid(np.array([4, 0, 1, 2, 3]), np.array([10]), np.eye(4, 3))
    grid.save(tmp_path / "a.vtu", binary=False)
    assert len(ws.open_geometry(tmp_path / "a.vtu").faces) == 4
    text = (tmp_path / "a.vtu").read_text()
    assert "0 1 2 3" in text
    (tmp_path / "a.vtu").write_text(text.replace("0 1 2 3", "0 1 2 999999999"))
    with pytest.raises(FileError, match="a cell of points that are not there"):
        ws.open_geometry(tmp_path / "a.vtu")


def test_compressed_bytes_that_a_meta_image_promises(tmp_path):
    """ITK takes memory for as many."""
    files.itk(tmp_path / "a.mha", useCompression=True)
    header, name, rest = (tmp_path / "a.mha").read_bytes().partition(b"CompressedDataSize = ")
    (tmp_path / "a.mha").write_bytes(header + name + b"9999" + rest)
    with pytest.raises(FileError, match=r"truncated, or a wrong header: it promises 9999\d+ compressed bytes"):
        ws.open(tmp_path / "a.mha")
