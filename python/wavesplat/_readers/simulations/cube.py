"""Gaussian's cubes: densities and orbitals of molecules, on a grid whose cells may be skewed.

An own parser: a header of a few lines and numbers as text. ASE, which reads it too, is a large library under the LGPL.
Format: https://gaussian.com/cubegen, and for files in angstroms https://paulbourke.net/dataformats/cube.
"""

from __future__ import annotations

from typing import IO

import numpy as np

from wavesplat._model.volume.facts import Facts
from wavesplat._model.volume.grid import UPRIGHT
from wavesplat._readers.request import Grid, Request, several
from wavesplat._readers.simulations.text_numbers import n_bytes_of, numbers_of_text, opened_text
from wavesplat._storage import size_checks
from wavesplat._storage.reading import reading
from wavesplat.errors import ArgumentError

#: A bohr in angstroms (CODATA 2018).
BOHR = 0.529177210903
#: Numbers of atoms and of values at each place, at most.
MOST = 1 << 20


def read(request: Request) -> Grid:
    """The samples of a cube, or of one of its orbitals, in angstroms."""
    path = request.file
    with reading("a Gaussian cube", path), opened_text(path) as file:
        file.readline()
        file.readline()
        words = file.readline().split()
        n_atoms, origin = int(words[0]), np.array(words[1:4], np.float64)
        steps = [file.readline().split() for _ in range(3)]
        # A negative number of samples: lengths are in angstroms. A negative number of atoms: orbitals.
        size = [int(step[0]) for step in steps]
        unit = 1.0 if min(size) < 0 else BOHR
        size = [abs(n) for n in size]
        vectors = np.array([step[1:4] for step in steps], np.float64) * unit
        if vectors.shape != (3, 3) or origin.shape != (3,):
            raise ValueError("an origin or a step of other than three numbers")
        if abs(n_atoms) > MOST or min(size) < 1:
            raise ValueError(f"{n_atoms} atoms, {size} samples")
        for _ in range(abs(n_atoms)):
            file.readline()
        names = _names(file, words, has_orbitals=n_atoms < 0 or _are_orbitals_next(file))
        shape, chosen = (*size, len(names)), _chosen(names, request)
        # Each number takes at least a digit and a space.
        stored = n_bytes_of(file) // 2
        size_checks.check_stored(shape, np.dtype("u1"), stored, path, held=(1,))
        size_checks.check_memory(size_checks.n_bytes(shape, np.dtype("f8")), path)
        values = numbers_of_text(file, int(np.prod(shape)), path).reshape(shape)[..., chosen]
        guesses = ("numbers behind those that the header promises are left out",) if file.read(1 << 16).strip() else ()
    quantity = names[chosen] if names != ["value 1"] else None
    matrix = np.eye(4)
    matrix[:3, :3], matrix[:3, 3] = vectors.T, origin * unit
    return Grid(
        np.ascontiguousarray(values.T),
        matrix,
        Facts(unit="angstrom", quantity=quantity, conventions=(UPRIGHT,), guesses=guesses),
    )


def _are_orbitals_next(file: IO[bytes]) -> bool:
    """Whether the next line counts orbitals and names them, as Molden writes without a negative number of atoms.

    Values are written with a point, the line of orbitals without.
    """
    begin = file.tell()
    words = file.readline().split()
    file.seek(begin)
    return len(words) > 1 and all(word.isdigit() for word in words) and int(words[0]) == len(words) - 1


def _names(file: IO[bytes], words: list[bytes], *, has_orbitals: bool) -> list[str]:
    """Names of the values at each place."""
    if not has_orbitals:
        n = int(words[4]) if len(words) > 4 else 1
        if not 1 <= n <= MOST:
            raise ValueError(f"{n} values at each place")
        return [f"value {number}" for number in range(1, n + 1)]
    numbers = [int(word) for word in file.readline().split()]
    n = numbers[0]
    if not 1 <= n <= MOST:
        raise ValueError(f"{n} orbitals")
    while len(numbers) < n + 1 and (line := file.readline()):
        numbers += [int(word) for word in line.split()]
    return [f"orbital {number}" for number in numbers[1 : n + 1]]


def _chosen(names: list[str], request: Request) -> int:
    listed = ", ".join(names)
    if request.dataset is not None:
        if request.dataset not in names:
            raise ArgumentError(f"no {request.dataset!r}; the file holds {listed}: {request.path}")
        return names.index(request.dataset)
    if len(names) == 1:
        return 0
    message = (
        f"the file holds {len(names)} numbers at each place ({listed}); choose one with dataset= (--dataset): "
        f"{request.path}"
    )
    raise several(message, "dataset", names)
