"""Points and tracks in tables: CSV, TSV and Parquet, with columns that are known by name.

Names of TrackMate (POSITION_X), Imaris (Position X), napari (axis-0: z), scikit-image (centroid-0: z), trackpy (x,
frame, particle), BIDS (name, x, y, z) and others are taken, and units in them: x_um, x [mm], x (µm).
"""

from __future__ import annotations

import csv
import re
from collections.abc import Container, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from wavesplat._geometry.files.read_shape import Asked, ReadShape
from wavesplat._model.volume import units
from wavesplat._model.volume.facts import quantity_of, value_unit_of
from wavesplat._storage.paths import read_text
from wavesplat._system.libraries import library
from wavesplat.errors import ArgumentError, FileError

SUFFIXES = (".csv", ".tsv", ".txt", ".parquet")
#: Rows above the header, at most: Imaris writes three.
MAX_PREAMBLE = 12
#: Names of a column of positions along an axis x, y or z.
PLAIN = ("{}", "position_{}", "pos_{}", "{}_position", "centroid_{}", "center_{}", "centre_{}", "{}_coordinate")
#: Names of napari's and scikit-image's columns, whose numbers count from the slowest axis.
NUMBERED = ("axis_{}", "centroid_{}")
TRACKS = ("track_id", "trackid", "track", "particle", "track_number")
TIMES = ("frame", "time", "t", "position_t", "time_point", "timepoint")
LABELS = ("name", "electrode")
SEPARATORS = "\t;,"

Cells: TypeAlias = "Sequence[str] | NDArray[Any]"


@dataclass(frozen=True)
class _Table:
    """Columns by names that are made alike, the names as they are written, and the units of columns."""

    columns: Mapping[str, Cells]
    written: Mapping[str, str]
    units: Mapping[str, str]

    def numbers(self, name: str) -> NDArray[np.float64]:
        """A column as numbers; cells without a number are NaN."""
        return np.array([_number(cell) for cell in self.columns[name]], np.float64)

    def first(self, names: Sequence[str]) -> str | None:
        """The first of some names that is a column."""
        return next((name for name in names if name in self.columns), None)

    @property
    def listed(self) -> str:
        """The columns in messages."""
        names = list(self.written.values())
        return ", ".join(names[:20]) + (", ..." if len(names) > 20 else "")


def read(asked: Asked) -> ReadShape:
    """The points of a table, or its tracks where it has a column of them."""
    path = asked.file
    table = _parquet(path) if path.suffix.lower() == ".parquet" else _of_text(read_text(path, "table"), path)
    names, guesses = _axes(table, path)
    unit, factors, strange = _unit(table, names)
    guesses += strange
    columns = [None if name is None else table.numbers(name) for name in names]
    n = max(len(column) for column in columns if column is not None)
    positions = np.stack([np.zeros(n) if column is None else column for column in columns], axis=1) * factors
    rows = np.flatnonzero(np.isfinite(positions).all(axis=1))
    if not len(rows):
        raise FileError(f"no row of the table has numbers as x, y and z; its columns are {table.listed}")
    track = table.first(TRACKS)
    kind = asked.kind or ("points" if track is None else "lines")
    ends: NDArray[np.int64] = np.empty(0, np.int64)
    if kind == "lines":
        rows, ends = _along_tracks(table, track, rows)
        if not len(rows):
            raise FileError(
                f"no row of the table belongs to a track: the column {table.written[track or '']!r} is empty"
            )
    left_out = n - len(rows)
    if left_out:
        guesses.append(f"{left_out} of {n} rows left out: x, y, z or the track is no number")
    values = {} if asked.values is None else _values(table, _named(table, asked), rows)
    if kind == "lines":
        return ReadShape("lines", {"paths": np.split(positions[rows], ends), **values}, unit, tuple(guesses))
    fields = {"positions": positions[rows], **values, **_of_points(table, rows, factors[0])}
    return ReadShape("points", fields, unit, tuple(guesses))


def _along_tracks(
    table: _Table, track: str | None, rows: NDArray[np.int64]
) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Rows in the order of their tracks and times, and where tracks but the first begin among them."""
    if track is None:
        return rows, np.empty(0, np.int64)
    numbers = _numbered(table.columns[track])
    rows = rows[numbers[rows] >= 0]
    time = table.first(TIMES)
    times = np.zeros(len(numbers)) if time is None else table.numbers(time)
    rows = rows[np.lexsort((rows, times[rows], numbers[rows]))]
    return rows, np.flatnonzero(np.diff(numbers[rows])) + 1


def _numbered(cells: Cells) -> NDArray[np.int64]:
    """A number for each name of a track; -1 for none."""
    known: dict[str, int] = {}
    keys = [str(cell).strip() for cell in cells]
    is_none = {"", "nan", "none", "n/a", "null", "-"}
    return np.array([-1 if key.lower() in is_none else known.setdefault(key, len(known)) for key in keys], np.int64)


def _of_points(table: _Table, rows: NDArray[np.int64], factor: float) -> dict[str, Any]:
    """Radii and names of points, where the table has all of them."""
    found: dict[str, Any] = {}
    if "radius" in table.columns:
        radii = table.numbers("radius")[rows]
        if (np.isfinite(radii) & (radii > 0)).all():
            found["radius"] = radii * factor
    if (name := table.first(LABELS)) is not None and len({*(cells := table.columns[name])}) > 1:
        found["labels"] = [str(cells[row]).strip() for row in rows]
    return found


def _values(table: _Table, name: str, rows: NDArray[np.int64]) -> dict[str, Any]:
    """The numbers of a column, what they are, and their unit: "speed" and "m/s" of "speed (m/s)"."""
    written, unit = table.written[name], table.units.get(name)
    if (in_brackets := _in_brackets(written)) is not None:
        written = in_brackets[0]
    elif unit is not None:
        written = written.removesuffix(f"_{unit}")
    return {
        "values": table.numbers(name)[rows],
        "quantity": quantity_of(written),
        "value_unit": value_unit_of(unit),
    }


def _named(table: _Table, asked: Asked) -> str:
    """The column that `values` names, as it is written or made alike."""
    for name, written in table.written.items():
        if asked.values in (written, name):
            return name
    alike = _alike(asked.values or "")[0]
    if alike in table.columns:
        return alike
    raise ArgumentError(f"the table has no column {asked.values!r}; its columns are {table.listed}: {asked.file}")


# Columns --------------------------------------------------------------------------------------------------------------


def _axes(table: _Table, path: Path) -> tuple[list[str | None], list[str]]:
    """Columns of x, y and z, None for the z of a table of a plane, and what was assumed."""
    found = _axes_among(table.columns)
    if found is None:
        raise ArgumentError(
            f"the table has no columns x, y, z; it has {table.listed}; name them x, y, z (or x_um, POSITION_X, axis-0, "
            f"centroid-0): {path}"
        )
    guesses = [] if found[2] is not None else ["z is 0: the table has x and y alone"]
    if found[0] not in {form.format("x") for form in PLAIN}:
        named = [f"{table.written[name]} as {axis}" for axis, name in zip("xyz", found, strict=True) if name]
        guesses.append(f"{', '.join(named)}, in world units: the table names none")
    return found, guesses


def _axes_among(names: Container[str]) -> list[str | None] | None:
    """The names of the columns of x, y and z among all names; None where there are none."""
    for form in PLAIN:
        x, y, z = (form.format(axis) for axis in "xyz")
        if x in names and y in names:
            return [x, y, z if z in names else None]
    for form in NUMBERED:
        there = [name for k in range(4) if (name := form.format(k)) in names]
        if len(there) >= 2:
            # Behind a time they count from the slowest axis, z.
            xyz: list[str | None] = [*there[::-1], None]
            return xyz[:3]
    return None


def _unit(table: _Table, names: Sequence[str | None]) -> tuple[str | None, tuple[float, float, float], list[str]]:
    """Unit of the positions, factors that bring the axes to it, and a sentence for each unit that is unknown."""
    own = [None if name is None else units.canonical(table.units.get(name)) for name in names]
    if not any(own) and (column := table.first(("unit", "units"))) is not None and len(table.columns[column]):
        own = [units.canonical(str(table.columns[column][0]))] * 3
    unit, factors = units.in_one_unit((own[0], own[1], own[2]))
    return unit, factors, units.guesses_of((own[0], own[1], own[2]))


def _alike(name: str) -> tuple[str, str | None]:
    """A column's name in small letters, and the unit in it: "Position X (µm)" is position_x in µm."""
    unit = None
    if (found := _in_brackets(name)) is not None:
        name, unit = found
    plain = re.sub(r"[\s\-.]+", "_", name.strip().lower()).strip("_")
    head, _, tail = plain.rpartition("_")
    if unit is None and head and units.metres(units.canonical(tail)) is not None and tail not in ("m", "point"):
        return head, tail
    return plain, unit


def _in_brackets(name: str) -> tuple[str, str] | None:
    """A column's name without the brackets at its end, and the text in them: x (µm), x [mm]; None without brackets."""
    text = name.strip()
    begin = max(text.rfind("("), text.rfind("["))
    inside = text[begin + 1 : -1]
    if begin < 0 or not text.endswith((")", "]")) or ")" in inside or "]" in inside:
        return None
    return text[:begin].rstrip(), inside


def _table_of(header: Sequence[str], columns: Sequence[Cells], units_below: Mapping[int, str]) -> _Table:
    names = [_alike(str(name)) for name in header]
    found: dict[str, Cells] = {}
    written, in_units = dict[str, str](), dict[str, str]()
    for k, ((name, unit), column) in enumerate(zip(names, columns, strict=True)):
        if not name or name in found:
            continue
        found[name], written[name] = column, str(header[k])
        if (unit_here := unit or units_below.get(k)) is not None:
            in_units[name] = unit_here
    return _Table(found, written, in_units)


# Files ----------------------------------------------------------------------------------------------------------------


def _of_text(text: str, path: Path) -> _Table:
    lines = text.splitlines()
    separator = max(SEPARATORS, key="\n".join(lines[:MAX_PREAMBLE]).count)
    try:
        rows = [[cell.strip() for cell in row] for row in csv.reader(lines, delimiter=separator) if any(row)]
    except csv.Error as error:
        raise FileError(f"the table cannot be read: {error}: {path}") from None
    begins = (k for k, row in enumerate(rows[:MAX_PREAMBLE]) if _axes_among({_alike(cell)[0] for cell in row}))
    number = next(begins, 0)
    if not rows:
        raise FileError(f"the table is empty: {path}")
    header, below = rows[number], rows[number + 1 :]
    body = [row for row in below if len(row) == len(header)]
    n_ragged = len(below) - len(body)
    if n_ragged > len(below) // 2:
        raise FileError(f"{n_ragged} of {len(below)} rows have not the {len(header)} cells of the header: {path}")
    # TrackMate repeats the header in words, and writes the units below it.
    guesses: dict[int, str] = {}
    while body and not any(np.isfinite(_number(cell)) for cell in body[0]):
        guesses |= {k: found[1] for k, cell in enumerate(body.pop(0)) if (found := _in_brackets(cell))}
    return _table_of(header, list(zip(*body, strict=True)) or [()] * len(header), guesses)


def _parquet(path: Path) -> _Table:
    read_table: Any = library("pyarrow.parquet", extra="parquet").read_table
    table = read_table(str(path))
    names = [str(name) for name in table.column_names]
    return _table_of(names, [table.column(k).to_numpy(zero_copy_only=False) for k in range(len(names))], {})


def _number(cell: Any) -> float:
    try:
        return float(cell)
    except (TypeError, ValueError):
        return float("nan")
