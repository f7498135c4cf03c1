"""VASP's grids (CHGCAR, CHG, PARCHG, AECCAR, LOCPOT, ELFCAR): charge densities and potentials in a cell of a crystal.

Charges are written times the volume of the cell, and are divided by it, as ASE does: electrons per cubic angstrom.
An own parser, as for cubes. Format: https://www.vasp.at/wiki/CHGCAR.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path
from typing import IO

import numpy as np
from numpy.typing import NDArray

from wavesplat._model.volume.facts import Facts
from wavesplat._model.volume.grid import UPRIGHT
from wavesplat._readers.request import Grid, Request, several
from wavesplat._readers.simulations.text_numbers import n_bytes_of, numbers_of_text, opened_text
from wavesplat._storage import size_checks
from wavesplat._storage.reading import reading
from wavesplat.errors import ArgumentError, FileError

#: The kind of file in a name; alone it says so at the name's beginning or end.
KIND = r"(CHGCAR|CHG|PARCHG|AECCAR[0-2]?|LOCPOT|ELFCAR)"
IN_NAME = re.compile(rf"(?<![A-Za-z0-9]){KIND}(?![A-Za-z0-9])")
NAME = re.compile(rf"{KIND}(?![A-Za-z0-9])|.*(?<![A-Za-z0-9]){KIND}(\.gz)?$")
#: Kinds of files whose values are no charges times the volume: -> the unit of their values.
PLAIN = {"LOCPOT": "eV", "ELFCAR": None}
MAX_ATOMS = 1 << 24
#: Number of grids in a file -> their names.
GRIDS = {
    1: ("total",),
    2: ("total", "magnetization"),
    4: ("total", "magnetization x", "magnetization y", "magnetization z"),
}
#: Potentials and localizations of spin-polarized crystals are of each spin.
OF_SPINS = {**GRIDS, 2: ("up", "down")}


def is_named(path: Path) -> bool:
    """Whether a file has the name of one of VASP's grids, such as CHGCAR, CHGCAR_sum or run1.CHGCAR."""
    return NAME.match(path.name) is not None


def read(request: Request) -> Grid:
    """The samples of a grid, in angstroms."""
    path = request.file
    found = IN_NAME.search(path.name)
    kind = found[1] if found else "CHGCAR"
    with reading("a grid of VASP", path), opened_text(path) as file:
        cell = _cell(file)
        grids = list(_grids(file, path))
    if not grids:
        raise FileError(
            "the file holds the places of atoms and no grid, as POSCAR does; name the CHGCAR or LOCPOT beside it: "
            f"{path}"
        )
    name = (OF_SPINS if kind in PLAIN else GRIDS).get(len(grids))
    names = list(name or (f"grid {number}" for number in range(1, len(grids) + 1)))
    number = _chosen(names, request)
    samples = grids[number]
    unit = PLAIN.get(kind, "e/angstrom^3")
    if kind not in PLAIN:
        samples = samples / abs(np.linalg.det(cell))
    matrix = np.eye(4)
    # The cell repeats: its far faces are the next cell's near ones.
    matrix[:3, :3] = (cell / np.array(samples.shape[::-1])[:, None]).T
    guesses = () if found else ("a charge density (CHGCAR): the name says nothing else, such as LOCPOT or ELFCAR",)
    facts = Facts(unit="angstrom", value_unit=unit, quantity=names[number], conventions=(UPRIGHT,), guesses=guesses)
    return Grid(samples, matrix, facts)


def _cell(file: IO[bytes]) -> NDArray[np.float64]:
    """The three vectors of the cell, a row each; the file is then behind the places of the atoms."""
    file.readline()
    scale = np.array(file.readline().split(), np.float64)
    cell = np.array([file.readline().split()[:3] for _ in range(3)], np.float64)
    if len(scale) == 1 and scale[0] < 0:  # minus the volume
        cell *= np.cbrt(-scale[0] / abs(np.linalg.det(cell)))
    else:
        cell *= scale
    if cell.shape != (3, 3):
        raise ValueError(f"a cell of {cell.size} numbers")
    counts = file.readline().split()
    if not counts[0].isdigit():  # names of the elements, which old files leave out
        counts = file.readline().split()
    n_atoms = sum(int(count) for count in counts)
    if not 0 < n_atoms <= MAX_ATOMS:
        raise ValueError(f"{n_atoms} atoms")
    if file.readline().strip()[:1] in b"Ss":
        file.readline()
    for _ in range(n_atoms):
        file.readline()
    return cell


def _grids(file: IO[bytes], path: Path) -> Iterator[NDArray[np.float64]]:
    """The grids [z, y, x] of a file, each behind a line of its size; what stands between them is passed over."""
    size: list[bytes] = []
    while line := file.readline():
        words = line.split()
        if len(words) != 3 or (size and words != size):
            continue
        if not size and not all(word.isdigit() for word in words):
            continue
        size = words
        nx, ny, nz = (int(word) for word in size)
        size_checks.check_stored((nz, ny, nx), np.dtype("u1"), n_bytes_of(file) // 2, path, held=(1,))
        size_checks.check_memory(size_checks.n_bytes((nz, ny, nx), np.dtype("f8")), path)
        yield numbers_of_text(file, nx * ny * nz, path).reshape(nz, ny, nx)


def _chosen(names: list[str], request: Request) -> int:
    if request.dataset is None:
        if len(names) == 1:
            return 0
        message = f"the file holds {len(names)} grids ({', '.join(names)}); choose one with dataset= (--dataset): "
        raise several(f"{message}{request.path}", "dataset", names)
    if request.dataset not in names:
        raise ArgumentError(f"no grid {request.dataset!r}; the file holds {', '.join(names)}: {request.path}")
    return names.index(request.dataset)
