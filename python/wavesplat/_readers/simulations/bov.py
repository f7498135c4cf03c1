"""Bricks of values (.bov): a text that describes samples in another file, as VisIt and VAPOR read them.

Format: VisIt, "Getting Data Into VisIt", section "Creating compatible files: Brick of Values".
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wavesplat._model.volume.facts import Facts
from wavesplat._model.volume.grid import UPRIGHT
from wavesplat._readers.components import component_of, quantity_of_array
from wavesplat._readers.request import Grid, Request
from wavesplat._storage import size_checks
from wavesplat._storage.paths import check_named_file
from wavesplat._storage.reading import reading
from wavesplat.errors import FileError

TYPES = {"BYTE": "u1", "SHORT": "i2", "INT": "i4", "INTS": "i4", "FLOAT": "f4", "FLOATS": "f4", "REAL": "f4"} | {
    "DOUBLE": "f8",
    "DOUBLES": "f8",
}
#: Longest text that is read.
HEAD_BYTES = 1 << 16


@dataclass(frozen=True)
class _Brick:
    """The samples that a text describes, and where they lie."""

    file: Path
    offset: int
    shape: tuple[int, int, int, int]
    dtype: np.dtype[Any]
    world_from_index: NDArray[np.float64]
    variable: str


def read(request: Request) -> Grid:
    """The samples of a brick."""
    with reading("a brick of values", request.path):
        brick = _described(request)
        stored = max(brick.file.stat().st_size - brick.offset, 0)
        size_checks.check_stored(brick.shape, brick.dtype, stored, request.path)
        n = int(np.prod(brick.shape))
        numbers = np.fromfile(brick.file, brick.dtype, n, offset=brick.offset).reshape(brick.shape)
        samples, guesses = component_of(numbers, request, brick.variable)
        quantity = quantity_of_array(brick.variable, brick.shape[-1], brick.dtype, request)
        facts = Facts(quantity=quantity, conventions=(UPRIGHT,), guesses=guesses)
        return Grid(np.ascontiguousarray(samples), brick.world_from_index, facts)


def _described(request: Request) -> _Brick:
    path = request.file
    with path.open("rb") as file:
        lines = file.read(HEAD_BYTES).decode("latin-1").splitlines()
    pairs = [line.partition(":") for line in lines if ":" in line and not line.lstrip().startswith("#")]
    fields = {key.strip().upper().replace(" ", "_"): value.strip() for key, _, value in pairs}
    missing = [key for key in ("DATA_FILE", "DATA_SIZE", "DATA_FORMAT") if key not in fields]
    if missing:
        raise FileError(f"the text lacks {', '.join(missing)}; write it in full: {path}")
    name = fields["DATA_FILE"].strip("\"'")
    if "%" in name:
        raise FileError(f"the samples are in several files ({name!r}); write them into one: {path}")
    if name.lower().endswith(".gz"):
        raise FileError(f"the samples are packed ({name!r}); unpack them, and name the result: {path}")
    check_named_file(name, path, anywhere=request.external_files, within=request.within)
    samples = path.parent / name
    if not samples.exists():
        raise FileError(f"the text names {name!r}, which is not there; copy it too: {path}")
    kind = fields["DATA_FORMAT"].upper()
    if kind not in TYPES:
        raise FileError(f"samples of type {kind!r} cannot be drawn; write one of {', '.join(TYPES)}: {path}")
    order = ">" if fields.get("DATA_ENDIAN", "LITTLE").upper().startswith("BIG") else "<"
    nx, ny, nz = (int(number) for number in fields["DATA_SIZE"].split())
    if min(nx, ny, nz) < 1:
        raise ValueError(f"a size of {nx} x {ny} x {nz}")
    of_cells = fields.get("CENTERING", "nodal").lower().startswith("z")
    return _Brick(
        samples,
        int(fields.get("BYTE_OFFSET", "0")),
        (nz, ny, nx, int(fields.get("DATA_COMPONENTS", "1"))),
        np.dtype(order + TYPES[kind]),
        _place(fields, (nx, ny, nz), of_cells=of_cells),
        fields.get("VARIABLE", samples.name),
    )


def _place(fields: dict[str, str], size: tuple[int, int, int], *, of_cells: bool) -> NDArray[np.float64]:
    """The affine: a brick reaches from its first to its last sample, or, of cells, over all of them."""
    origin = np.array(fields.get("BRICK_ORIGIN", "0 0 0").split(), np.float64)
    n = np.array(size, np.float64)
    cells = n if of_cells else np.maximum(n - 1, 1)
    # Without a size VisIt's brick is one cell a unit.
    lengths = np.array(fields["BRICK_SIZE"].split(), np.float64) if "BRICK_SIZE" in fields else cells
    matrix = np.diag([*(lengths / cells), 1.0])
    matrix[:3, 3] = origin + (lengths / cells / 2 if of_cells else 0.0)
    return matrix
