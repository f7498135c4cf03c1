"""Cubes, VASP's grids, bricks of values and SEG-Y: values, cells and units as the formats say."""

import gzip
import re
import sys

import numpy as np
import pytest

import wavesplat as ws
from wavesplat.errors import ArgumentError, FileError, LibraryError

#: Samples along x, y, z of a skewed cell, and its vectors, a row each.
SIZE = (4, 5, 6)
CELL = np.array([[4.0, 0.0, 0.0], [1.0, 5.0, 0.0], [0.0, -1.0, 6.0]])
BOHR = 0.529177210903


@pytest.fixture
def values():
    return np.round(np.random.default_rng(5).normal(size=SIZE), 5)


def rows(numbers, n):
    flat = np.ravel(numbers)
    return "".join("".join(f"{x:13.5E}" for x in flat[k : k + n]) + "\n" for k in range(0, len(flat), n))


def save_cube(path, values, *, orbitals=(), sign=1, n_values=None):
    n_atoms = -2 if orbitals else 2
    more = f" {n_values}" if n_values else ""
    text = f"title\nmore\n{n_atoms:5d} -1.0 2.0 0.5{more}\n"
    for n, vector in zip(SIZE, CELL, strict=True):
        text += f"{sign * n:5d} " + " ".join(f"{part / n:.9f}" for part in vector) + "\n"
    text += "    8  8.0 0.0 0.0 0.0\n    1  1.0 0.0 0.0 1.0\n"
    if orbitals:
        text += f"{len(orbitals)} " + " ".join(map(str, orbitals)) + "\n"
    # A line ends with the innermost axis.
    inner = values.shape[2:]
    text += "".join(rows(row, 6) for row in values.reshape(-1, int(np.prod(inner))))
    path.write_text(text)
    return path


@pytest.mark.parametrize(("sign", "unit"), [(1, BOHR), (-1, 1.0)])
def test_cube(tmp_path, values, sign, unit):
    volume = ws.open(save_cube(tmp_path / "a.cube", values, sign=sign))
    np.testing.assert_array_equal(volume.samples, values.T)
    np.testing.assert_allclose(volume.world_from_index[:3, :3], (CELL / np.array(SIZE)[:, None]).T * unit, atol=1e-8)
    np.testing.assert_allclose(volume.world_from_index[:3, 3], np.array([-1, 2, 0.5]) * unit)
    assert volume.unit == "angstrom"


def test_orbitals_of_a_cube(tmp_path, values):
    both = np.stack([values, 2 * values], axis=-1)
    path = save_cube(tmp_path / "a.cube", both, orbitals=(12, 13))
    with pytest.raises(FileError, match=r"2 numbers at each place \(orbital 12, orbital 13\).*dataset="):
        ws.open(path)
    volume = ws.open(path, dataset="orbital 13")
    np.testing.assert_array_equal(volume.samples, 2 * values.T)
    assert volume.facts.quantity == "orbital 13"
    path = save_cube(tmp_path / "b.cube", both, n_values=2)
    np.testing.assert_array_equal(ws.open(path, dataset="value 1").samples, values.T)
    with pytest.raises(ArgumentError, match="no 'value 3'; the file holds value 1, value 2"):
        ws.open(path, dataset="value 3")


def test_orbitals_that_the_number_of_atoms_does_not_tell(tmp_path, values):
    """Molden writes the line of orbitals without a negative number of atoms; its numbers are no values."""
    path = save_cube(tmp_path / "a.cube", values[..., None], orbitals=(7,))
    path.write_text(path.read_text().replace("   -2 -1.0", "    2 -1.0", 1))
    volume = ws.open(path)
    np.testing.assert_array_equal(volume.samples, values.T)
    assert volume.guesses == ()
    path.write_text(path.read_text() + " 1.0 2.0\n")
    assert ws.open(path).guesses == ("numbers behind those that the header promises are left out",)


def save_vasp(path, grids, *, scale=1.0, names="H O\n", selective=False):
    text = f"water\n  {scale}\n" + "".join(" ".join(f"{part:.9f}" for part in vector) + "\n" for vector in CELL)
    text += (
        names + "2 1\n" + ("Selective dynamics\n" if selective else "") + "Direct\n0 0 0\n0.1 0.2 0.3\n0.5 0.5 0.5\n\n"
    )
    for values in grids:
        text += " {} {} {}\n".format(*SIZE) + rows(values.T, 5)
        text += "augmentation occupancies 1 4\n  0.1E+00 0.2E+00 0.3E+00 0.4E+00\n"
        text += "augmentation occupancies 2 3\n  0.1E+00 0.2E+00 0.3E+00\n  0.0 0.0\n"
    path.write_text(text)
    return path


def test_charges_are_divided_by_the_volume_of_the_cell(tmp_path, values):
    volume = ws.open(save_vasp(tmp_path / "CHGCAR", [values], scale=1.5, selective=True))
    np.testing.assert_allclose(volume.samples, values.T / (1.5**3 * np.linalg.det(CELL)))
    np.testing.assert_allclose(volume.world_from_index[:3, :3], 1.5 * (CELL / np.array(SIZE)[:, None]).T)
    assert (volume.unit, volume.value_unit) == ("angstrom", "e/angstrom^3")
    np.testing.assert_allclose(ws.open(save_vasp(tmp_path / "AECCAR0", [values], scale=-960, names="")).samples,
                               values.T / 960)  # fmt: skip


@pytest.mark.parametrize("name", ["run1.CHGCAR", "Si_CHGCAR", "CHGCAR.test", "b.LOCPOT"])
def test_names_of_vasp_begin_or_end_with_the_kind(tmp_path, values, name):
    volume = ws.open(save_vasp(tmp_path / name, [values]))
    assert volume.value_unit == ("eV" if "LOCPOT" in name else "e/angstrom^3")
    (tmp_path / "my_CHGCAR_notes").write_text("none")
    with pytest.raises(FileError, match="unknown kind of file"):
        ws.open(tmp_path / "my_CHGCAR_notes")


def test_spins_and_potentials_of_vasp(tmp_path, values):
    path = save_vasp(tmp_path / "CHGCAR_spin", [values, 3 * values])
    with pytest.raises(FileError, match=r"2 grids \(total, magnetization\).*dataset="):
        ws.open(path)
    np.testing.assert_allclose(ws.open(path, dataset="magnetization").samples, 3 * values.T / np.linalg.det(CELL))
    volume = ws.open(save_vasp(tmp_path / "LOCPOT", [values]))
    np.testing.assert_array_equal(volume.samples, values.T)
    assert volume.value_unit == "eV"
    path = save_vasp(tmp_path / "ELFCAR", [values, 3 * values])
    np.testing.assert_allclose(ws.open(path, dataset="down").samples, 3 * values.T)


def test_texts_that_are_cut(tmp_path, values):
    for path in (save_cube(tmp_path / "a.cube", values), save_vasp(tmp_path / "CHGCAR", [values])):
        content = path.read_text()
        for n in (30, 120, len(content) // 2, int(0.9 * content.rfind("E"))):
            path.write_text(content[: min(n, content.find("augmentation") - 20) if "aug" in content else n])
            with pytest.raises(FileError):
                ws.open(path)
    path = save_cube(tmp_path / "a.cube", values)
    path.write_text(path.read_text().replace("    4 ", "99999 ", 1).replace("    5 ", "99999 ", 1))
    with pytest.raises(FileError, match="truncated, or a wrong header"):
        ws.open(path)


def save_bov(path, values, **said):
    values.tofile(path.with_suffix(".values"))
    kind = {"f4": "FLOAT", "f8": "DOUBLE", "u1": "BYTE", "i4": "INT"}[values.dtype.str[1:]]
    nz, ny, nx = values.shape[:3]
    lines = {"TIME": 1.5, "DATA_FILE": path.with_suffix(".values").name, "DATA_SIZE": f"{nx} {ny} {nz}"}
    lines |= {"DATA_FORMAT": kind, "VARIABLE": "rho", "BRICK_ORIGIN": "1 2 3", "BRICK_SIZE": "5. 8. 12."} | said
    path.write_text("# a comment: of words\n" + "".join(f"{key}: {value}\n" for key, value in lines.items()))
    return path


@pytest.mark.parametrize(("centering", "cells", "shift"), [("nodal", (5, 4, 3), 0), ("zonal", (6, 5, 4), 0.5)])
def test_bricks_of_values(tmp_path, centering, cells, shift):
    values = np.random.default_rng(1).normal(size=(4, 5, 6))
    for dtype, order in (("<f4", "LITTLE"), (">f8", "BIG")):
        stored = values.astype(dtype)
        volume = ws.open(save_bov(tmp_path / "a.bov", stored, CENTERING=centering, DATA_ENDIAN=order))
        np.testing.assert_array_equal(volume.samples, stored)
        steps = np.array([5, 8, 12]) / cells
        np.testing.assert_allclose(volume.spacing, steps)
        np.testing.assert_allclose(volume.bounds[0], np.array([1, 2, 3]) + shift * steps)
        assert volume.facts.quantity == "rho"


def test_vectors_and_faults_of_bricks(tmp_path):
    vectors = np.random.default_rng(1).normal(size=(4, 5, 6, 3)).astype(np.float32)
    path = save_bov(tmp_path / "a.bov", vectors, DATA_COMPONENTS=3)
    np.testing.assert_allclose(ws.open(path).samples, np.linalg.norm(vectors, axis=-1), rtol=1e-6)
    np.testing.assert_array_equal(ws.open(path, component="z").samples, vectors[..., 2])
    for said, words in (
        ({"DATA_FILE": "../secret"}, "external_files=True"),
        ({"DATA_FILE": "none"}, "which is not there"),
        ({"DATA_FILE": "part%04d"}, "in several files"),
        ({"DATA_FORMAT": "WORDS"}, "type 'WORDS' cannot be drawn"),
        ({"DATA_SIZE": "60 50 40"}, "truncated, or a wrong header"),
    ):
        with pytest.raises(FileError, match=words):
            ws.open(save_bov(tmp_path / "a.bov", vectors, DATA_COMPONENTS=3, **said))
    (tmp_path / "a.bov").write_text("TIME: 1\n")
    with pytest.raises(FileError, match="lacks DATA_FILE, DATA_SIZE, DATA_FORMAT"):
        ws.open(tmp_path / "a.bov")


def save_segy(path, cube, *, places=True):
    """A survey of inlines 10, 11, ... and crosslines 20, 21, ..., 25 m and 12.5 m apart, turned by a right angle."""
    segyio = pytest.importorskip("segyio")
    spec = segyio.spec()
    spec.sorting, spec.format = 2, 5  # by inline; IEEE floats
    spec.ilines, spec.xlines = 10 + np.arange(cube.shape[0]), 20 + np.arange(cube.shape[1])
    spec.samples = 100 + 4.0 * np.arange(cube.shape[2])
    with segyio.create(str(path), spec) as file:
        number = 0
        for i, inline in enumerate(spec.ilines):
            for j, crossline in enumerate(spec.xlines):
                file.header[number] = {
                    segyio.su.iline: inline,
                    segyio.su.xline: crossline,
                    segyio.su.offset: 1,
                    segyio.su.delrt: 100,
                    segyio.su.scalco: -10,
                    **({segyio.su.cdpx: 1000 - 250 * i, segyio.su.cdpy: 500 + 125 * j} if places else {}),
                }
                file.trace[number] = cube[i, j]
                number += 1
        file.bin.update(hdt=4000, tsort=segyio.TraceSortingFormat.INLINE_SORTING)
        file.bin.update({segyio.BinField.MeasurementSystem: 1})
    return path


def test_seismic_traces(tmp_path):
    cube = np.random.default_rng(2).normal(size=(3, 4, 5)).astype(np.float32)
    volume = ws.open(save_segy(tmp_path / "a.sgy", cube))
    np.testing.assert_array_equal(volume.samples, cube.transpose(2, 0, 1))
    expected = [[0, -25, 0, 100], [12.5, 0, 0, 50], [0, 0, -4, -100], [0, 0, 0, 1]]
    np.testing.assert_allclose(volume.world_from_index, expected)
    assert volume.unit == "m"
    assert "samples are 4 ms apart, or m" in volume.guesses[0]
    volume = ws.open(save_segy(tmp_path / "b.segy", cube, places=False))
    assert volume.spacing == (1, 1, 4)
    assert any("traces have no places" in guess for guess in volume.guesses)


def change_traces(path, changed, *, kept=lambda *_: True, endian="big"):
    """A copy of a survey of the traces that `kept` takes, with numbers of their headers changed."""
    segyio = pytest.importorskip("segyio")
    with segyio.open(str(path), ignore_geometry=True) as file:
        inlines, crosslines = (file.attributes(byte)[:] for byte in (189, 193))
        numbers = [n for n in range(file.tracecount) if kept(inlines[n], crosslines[n])]
        spec = segyio.tools.metadata(file)
        spec.tracecount, spec.endian, spec.ilines = len(numbers), endian, None
        with segyio.create(str(changed), spec) as copy:
            copy.bin = file.bin
            for to, number in enumerate(numbers):
                copy.header[to], copy.trace[to] = file.header[number], file.trace[number]
    return changed


def test_traces_in_the_other_byte_order(tmp_path):
    cube = np.random.default_rng(2).normal(size=(3, 4, 5)).astype(np.float32)
    path = save_segy(tmp_path / "a.sgy", cube)
    volume = ws.open(change_traces(path, tmp_path / "little.sgy", endian="little"))
    np.testing.assert_array_equal(volume.samples, cube.transpose(2, 0, 1))
    np.testing.assert_array_equal(volume.world_from_index, ws.open(path).world_from_index)


def test_surveys_with_gaps(tmp_path):
    cube = np.random.default_rng(2).normal(size=(5, 6, 7)).astype(np.float32)
    path = save_segy(tmp_path / "a.sgy", cube)
    # Every second crossline, and a corner of the survey is missing.
    changed = change_traces(path, tmp_path / "b.sgy", kept=lambda i, j: j % 2 == 0 and (i, j) != (10, 20))
    volume = ws.open(changed)
    expected = cube[:, ::2].transpose(2, 0, 1).copy()
    expected[:, 0, 0] = np.nan
    np.testing.assert_array_equal(volume.samples, expected)
    np.testing.assert_allclose(volume.world_from_index[:3, :2], [[0, -25], [25, 0], [0, 0]], atol=1e-6)
    np.testing.assert_allclose(volume.world_from_index[:3, 3], [100, 50, -100])
    assert "1 of 15 places have no trace, and nothing is drawn there" in volume.guesses


def test_traces_without_a_grid_have_a_route(tmp_path):
    segyio = pytest.importorskip("segyio")
    path = save_segy(tmp_path / "a.sgy", np.ones((3, 4, 5), np.float32))

    def refused(change, match):
        other = tmp_path / "b.sgy"
        other.write_bytes(path.read_bytes())
        with segyio.open(str(other), "r+", ignore_geometry=True) as file:
            change(file)
        with pytest.raises(FileError, match=match):
            ws.open(other)

    def line(file):
        for header in file.header:
            header.update(iline=0, xline=0)

    def gathers(file):
        for number, header in enumerate(file.header):
            header.update(xline=20 + number % 4 // 2, offset=100 * (number % 2))

    def twice(file):
        file.header[1].update(xline=20)

    refused(line, r"12 traces have 1 x 1 numbers.*segyio.open\(path, iline=BYTE")
    refused(gathers, r"12 traces have 6 places and 2 offsets; stack them")
    refused(twice, r"1 traces have the inline and crossline of another one")
    refused(lambda file: file.bin.update({segyio.BinField.Format: 7}), "format 7, which segyio does not read")


def test_traces_that_are_no_cube(tmp_path, monkeypatch):
    path = save_segy(tmp_path / "a.sgy", np.ones((3, 4, 5), np.float32))
    content = path.read_bytes()
    for changed in (content[:3700], content[:3000], content[: len(content) // 2]):
        path.write_bytes(changed)
        with pytest.raises(FileError):
            ws.open(path)
    monkeypatch.setitem(sys.modules, "segyio", None)
    with pytest.raises(LibraryError, match=r"segy\]"):
        ws.open(path)


@pytest.mark.parametrize("letter", ["", "D"])
def test_exponents_of_fortran(tmp_path, values, letter):
    """Fortran drops the E where an exponent has three digits, and NumPy takes that for two numbers."""
    small = values.copy()
    small[1, 2, 3], small[0, 0, 0], small[3, 4, 5] = 1.234e-100, -5.5e-300, 2.5e101
    cube, charges = save_cube(tmp_path / "a.cube", small), save_vasp(tmp_path / "LOCPOT", [small, 2 * small])
    for path in (cube, charges):
        text = path.read_text()
        changed = re.sub(r"E([-+]\d{3})", rf"{letter}\1", text)
        if letter:
            changed = re.sub(r"(\d)E([-+]\d\d)\b", r"\1D\2", changed)
        assert changed != text
        path.write_text(changed)
    np.testing.assert_allclose(ws.open(cube).samples, small.T, rtol=1e-5)
    np.testing.assert_allclose(ws.open(charges, dataset="up").samples, small.T, rtol=1e-5)
    np.testing.assert_allclose(ws.open(charges, dataset="down").samples, 2 * small.T, rtol=1e-5)
    cube.write_text(re.sub(r"1\.23400-100|1\.23400D-100", "1.2x400-100", cube.read_text()))
    with pytest.raises(FileError, match="a word that is no number"):
        ws.open(cube)


def test_packed_files_and_names_that_end_in_vasp(tmp_path, values):
    plain = save_cube(tmp_path / "a.cube", values), save_vasp(tmp_path / "CHGCAR", [values])
    for path in plain:
        packed = path.with_name(path.name + ".gz")
        packed.write_bytes(gzip.compress(path.read_bytes()))
        np.testing.assert_array_equal(ws.open(packed).samples, ws.open(path).samples)
        packed.write_bytes(packed.read_bytes()[:-30])
        with pytest.raises(FileError, match="truncated or damaged, as gzip finds"):
            ws.open(packed)
    named = save_vasp(tmp_path / "water.vasp", [values])
    np.testing.assert_array_equal(ws.open(named).samples, ws.open(plain[1]).samples)
    assert "a charge density (CHGCAR)" in ws.open(named).guesses[0]
    (tmp_path / "water.vasp.gz").write_bytes(gzip.compress(named.read_bytes()))
    np.testing.assert_array_equal(ws.open(tmp_path / "water.vasp.gz").samples, ws.open(named).samples)
    potential = ws.open(save_vasp(tmp_path / "water_LOCPOT.vasp", [values]))
    np.testing.assert_array_equal(potential.samples, values.T)
    assert (potential.value_unit, potential.guesses) == ("eV", ())
    (tmp_path / "POSCAR.vasp").write_text(named.read_text().split("\n\n")[0] + "\n")
    with pytest.raises(FileError, match="places of atoms and no grid, as POSCAR does; name the CHGCAR"):
        ws.open(tmp_path / "POSCAR.vasp")
