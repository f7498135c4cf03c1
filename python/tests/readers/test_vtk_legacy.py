"""Legacy VTK files: all types, as text and as bytes, fields, cells, colours, and files that hold no image."""

from __future__ import annotations

import numpy as np
import pytest

import wavesplat as ws
from wavesplat._readers.vtk import legacy

# VTK, PyVista and xarray take seconds to load: one process does.
pytestmark = pytest.mark.xdist_group("vtk")

SAMPLES = np.random.default_rng(2).integers(0, 100, (3, 4, 5))
PLACE = "DIMENSIONS 5 4 3\nSPACING 0.5 2 3\nORIGIN 7 8 9\n"
#: The format's names of types -> NumPy's types of their bytes.
TYPES = {
    "char": ">i1",
    "signed_char": ">i1",
    "unsigned_char": ">u1",
    "short": ">i2",
    "unsigned_short": ">u2",
    "int": ">i4",
    "unsigned_int": ">u4",
    "long": ">i8",
    "unsigned_long": ">u8",
    "vtktypeint64": ">i8",
    "vtktypeuint64": ">u8",
    "vtkIdType": ">i4",
    "float": ">f4",
    "double": ">f8",
}


def numbers(samples, dtype, is_text):
    if is_text:
        return (" ".join(map(str, samples.ravel().tolist())) + "\n").encode()
    return samples.astype(dtype).tobytes() + b"\n"


def write(path, parts, *, is_text=False, place=PLACE, dataset="STRUCTURED_POINTS"):
    head = f"# vtk DataFile Version 3.0\na title\n{'ASCII' if is_text else 'BINARY'}\nDATASET {dataset}\n{place}"
    path.write_bytes(head.encode() + b"".join(part.encode() if isinstance(part, str) else part for part in parts))
    return path


@pytest.mark.parametrize("is_text", [True, False])
@pytest.mark.parametrize("kind", TYPES)
@pytest.mark.every_pair
def test_every_type(tmp_path, kind, is_text):
    parts = ["POINT_DATA 60\n", f"SCALARS s%20c {kind}\nLOOKUP_TABLE default\n"]
    path = write(tmp_path / "a.vtk", [*parts, numbers(SAMPLES, TYPES[kind], is_text)], is_text=is_text)
    volume = ws.open(path)
    np.testing.assert_array_equal(volume.samples, SAMPLES)
    np.testing.assert_allclose(volume.world_from_index, [[0.5, 0, 0, 7], [0, 2, 0, 8], [0, 0, 3, 9], [0, 0, 0, 1]])
    if not is_text:
        lazy = ws.open(path, memory="1 MB")
        assert isinstance(lazy, ws.LazyVolume)
        np.testing.assert_array_equal(lazy.read().samples, SAMPLES)
    np.testing.assert_array_equal(ws.open(path, dataset="s c").samples, SAMPLES)


@pytest.mark.parametrize("is_text", [True, False])
def test_bits(tmp_path, is_text):
    bits = SAMPLES % 2
    data = numbers(bits, "u1", True) if is_text else np.packbits(bits).tobytes()
    path = write(tmp_path / "a.vtk", ["POINT_DATA 60\nSCALARS b bit 1\nLOOKUP_TABLE default\n", data], is_text=is_text)
    np.testing.assert_array_equal(ws.open(path).samples, bits)


def test_long_of_four_bytes(tmp_path):
    """Windows writes long with four bytes."""
    data = SAMPLES.astype(">i4").tobytes()
    path = write(tmp_path / "a.vtk", ["POINT_DATA 60\nSCALARS s long\nLOOKUP_TABLE default\n", data])
    np.testing.assert_array_equal(ws.open(path).samples, SAMPLES)


@pytest.mark.parametrize("is_text", [True, False])
def test_colours_are_bytes(tmp_path, is_text):
    """As text colours go from 0 to 1, and VTK turns them into bytes."""
    colours = SAMPLES.astype(np.uint8)
    data = numbers(colours / 255, "", True) if is_text else colours.tobytes()
    path = write(tmp_path / "a.vtk", ["POINT_DATA 60\nCOLOR_SCALARS c 1\n", data], is_text=is_text)
    volume = ws.open(path)
    assert volume.dtype == np.uint8
    np.testing.assert_array_equal(volume.samples, colours)


@pytest.mark.parametrize("is_text", [True, False])
def test_one_of_several_arrays(tmp_path, is_text):
    """Texts, metadata, look-up tables and fields lie between the arrays."""
    text = "micrometre of the microscope, which is long: more than sixty-three letters"
    word = text.encode() + b"\n" if is_text else (len(text) | 2 << 14).to_bytes(2, "big") + text.encode() + b"\n"
    cells = np.arange(2 * 3 * 4).reshape(2, 3, 4)
    vectors = np.stack([SAMPLES, SAMPLES + 1, SAMPLES + 2], -1)
    table = numbers(np.zeros(8), "", True) if is_text else bytes(8)
    parts = [
        "FIELD FieldData 2\nunit 1 1 string\n",
        word,
        "TIME 1 1 double\n",
        numbers(np.array([2.5]), ">f8", is_text),
        "CELL_DATA 24\nSCALARS c int\nLOOKUP_TABLE default\n",
        numbers(cells, ">i4", is_text),
        "METADATA\nINFORMATION 0\n\n",
        "POINT_DATA 60\nSCALARS s short\nLOOKUP_TABLE hot\n",
        numbers(SAMPLES, ">i2", is_text),
        "LOOKUP_TABLE hot 2\n",
        table,
        "VECTORS v float\n",
        numbers(vectors, ">f4", is_text),
        "FIELD more 2\na%20b 1 60 float\n",
        numbers(SAMPLES * 2, ">f4", is_text),
        "METADATA\nCOMPONENT_NAMES\nx\n\nd 2 60 double\n",
        numbers(np.stack([SAMPLES, -SAMPLES], -1), ">f8", is_text),
    ]
    path = write(tmp_path / "a.vtk", parts, is_text=is_text)
    wanted = {("s", None): SAMPLES, ("v", 2): SAMPLES + 2, ("a b", None): SAMPLES * 2, ("d", 1): -SAMPLES}
    for (name, channel), samples in wanted.items():
        volume = ws.open(path, dataset=name, channel=channel)
        np.testing.assert_array_equal(volume.samples, samples)
    # Samples of cells lie in the cells' middles.
    volume = ws.open(path, dataset="c")
    np.testing.assert_array_equal(volume.samples, cells)
    np.testing.assert_allclose(volume.bounds[0], (7.25, 9, 10.5))
    with pytest.raises(ws.errors.ArgumentError, match="no array 'x'; the file holds c, s, v, a b, d"):
        ws.open(path, dataset="x")


@pytest.mark.parametrize("change", [str.lower, str.upper])
def test_old_words_and_any_letters(tmp_path, change):
    place = PLACE.replace("SPACING", "ASPECT_RATIO")
    head = f"# vtk DataFile Version 2.0\n\nASCII\nDATASET STRUCTURED_POINTS\n{place}POINT_DATA 60\nSCALARS s short\n"
    first, _, rest = head.partition("\n")
    text = f"{first}\n{change(rest)}LOOKUP_TABLE default\n{numbers(SAMPLES, '', True).decode()}"
    (tmp_path / "a.vtk").write_text(text.replace("\n", "\r\n"), newline="")
    volume = ws.open(tmp_path / "a.vtk")
    np.testing.assert_array_equal(volume.samples, SAMPLES)
    np.testing.assert_allclose(volume.spacing, (0.5, 2, 3))


@pytest.mark.parametrize(
    ("dataset", "what"),
    [
        ("POLYDATA", "holds a mesh.*, which has no samples inside"),
        ("FIELD", "holds VTK's FIELD.*; resample it to one, as with pyvista"),
    ],
)
def test_a_grid_of_another_kind_is_not_called_damaged(tmp_path, dataset, what):
    path = write(tmp_path / "a.vtk", ["POINTS 0 float\n"], dataset=dataset, place="")
    with pytest.raises(ws.errors.FileError, match=what) as caught:
        ws.open(path)
    assert "damaged" not in str(caught.value)


@pytest.mark.parametrize(
    ("parts", "message"),
    [
        (
            ["POINT_DATA 60\nSCALARS s quaternion\nLOOKUP_TABLE default\n", bytes(60)],
            "type 'quaternion' cannot be drawn.*array 's'",
        ),
        (
            ["POINT_DATA 61\nSCALARS s char\nLOOKUP_TABLE default\n", bytes(61)],
            "has 61 samples, and the image 5 x 4 x 3",
        ),
        (["POINT_DATA 60\nSCALARS s char\nLOOKUP_TABLE default\n", bytes(59)], "truncated"),
        (["POINT_DATA 60\nBLUBB s char\n", bytes(59)], "the word 'BLUBB' where VTK has none"),
        (["POINT_DATA 60\n"], "a grid without an array of numbers"),
        (["FIELD f 1\nunit 1 1000000000000000 string\n", "a\n"], "1000000000000000 texts are promised"),
    ],
)
@pytest.mark.parametrize("is_text", [True, False])
def test_what_is_wrong_is_said(tmp_path, parts, message, is_text):
    if is_text:  # zero bytes are words, and too few of them
        parts = [" ".join("1" * len(part)) if isinstance(part, bytes) else part for part in parts]
    with pytest.raises(ws.errors.FileError, match=message):
        ws.open(write(tmp_path / "a.vtk", parts, is_text=is_text))


@pytest.mark.parametrize("n_bytes", [1, 2, 7, 100])
@pytest.mark.parametrize("space", [" ", "\n", "\r\n", " \t\v\f "])
def test_text_is_read_in_blocks(tmp_path, monkeypatch, n_bytes, space):
    monkeypatch.setattr(legacy, "BLOCK_BYTES", n_bytes)
    words = space.join(map(str, SAMPLES.ravel().tolist()))
    parts = ["POINT_DATA 60\nSCALARS a int\nLOOKUP_TABLE default\n", words, space, "\n"]
    parts += ["SCALARS b float\nLOOKUP_TABLE default\n", words]
    path = write(tmp_path / "a.vtk", parts, is_text=True)
    for name in "ab":
        np.testing.assert_array_equal(ws.open(path, dataset=name).samples, SAMPLES)
