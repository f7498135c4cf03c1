"""Times of files of one time point each: what the files say, else the numbers that their names differ in."""

from __future__ import annotations

import re
from collections.abc import Sequence
from itertools import pairwise
from math import isfinite
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from wavesplat._model.hdf5_files import read_hdf5

if TYPE_CHECKING:
    import h5py

#: Names of the attribute of an HDF5 file that is its time.
ATTRIBUTES = ("time", "Time", "TIME", "current_time")
HDF5 = b"\x89HDF"
#: Bytes of a text (.bov) in which its time is looked for.
HEAD_BYTES = 1 << 12

Times = tuple[tuple[float, ...], str | None]


def times_of_files(paths: Sequence[Path]) -> Times | None:
    """The times of files in order, and their unit; None where they do not grow, or nothing says them."""
    return _of_contents(paths) or _of_names([path.name for path in paths])


def _of_contents(paths: Sequence[Path]) -> Times | None:
    found = []
    for path in paths:
        try:
            one = _time_in(path)
        except (OSError, KeyError, ValueError, TypeError, RuntimeError):
            one = None  # whatever is wrong is said where the file is read
        if one is None:
            return None
        found.append(one)
    times, units = tuple(time for time, _ in found), {unit for _, unit in found}
    return (times, units.pop()) if len(units) == 1 and _is_growing(times) else None


def _time_in(path: Path) -> tuple[float, str | None] | None:
    """The time that one file says, and its unit, of HDF5 and of bricks of values; no other file is followed."""
    with path.open("rb") as file:
        start = file.read(HEAD_BYTES)
    if path.name.lower().endswith(".bov"):
        found = re.search(rb"^[ \t\r\v\f]*TIME\s*:\s*(\S+)", start, re.MULTILINE | re.IGNORECASE)
        return (float(found[1]), None) if found else None
    if not start.startswith(HDF5):
        return None
    with read_hdf5(path) as opened:
        for name in ATTRIBUTES:
            if name in opened.attrs:
                return _number(opened.attrs[name]), None
        return _time_of_openpmd(opened) or _time_of_netcdf(opened)


def _time_of_openpmd(file: h5py.File) -> tuple[float, str | None] | None:
    """The time of the only iteration of a file of openPMD, in seconds."""
    import h5py

    data = file["data"] if isinstance(file.get("data", getlink=True), h5py.HardLink) else None
    if not isinstance(data, h5py.Group) or len(data) != 1:
        return None
    name = next(iter(data))
    if not isinstance(data.get(name, getlink=True), h5py.HardLink) or "time" not in data[name].attrs:
        return None
    attributes = data[name].attrs
    return _number(attributes["time"]) * _number(attributes.get("timeUnitSI", 1.0)), "s"


def _time_of_netcdf(file: h5py.File) -> tuple[float, str | None] | None:
    """The time of a netCDF-4 file of one: the coordinate of that name."""
    import h5py

    node = file["time"] if isinstance(file.get("time", getlink=True), h5py.HardLink) else None
    if not isinstance(node, h5py.Dataset) or node.external or node.is_virtual or node.size != 1:
        return None
    name = node.attrs.get("units", b"")
    unit = (name.decode("utf-8", "replace") if isinstance(name, bytes) else str(name)).partition(" since ")[0].strip()
    return _number(node[()]), unit or None


def _number(value: Any) -> float:
    (number,) = np.ravel(value).astype(np.float64).tolist()
    return float(number)


def _of_names(names: Sequence[str]) -> Times | None:
    """The numbers in names that are equal but for one run of digits."""
    split = [re.split(r"(\d+)", name) for name in names]
    if len({len(parts) for parts in split}) != 1:
        return None
    differing = [column for column in zip(*split, strict=True) if len(set(column)) > 1]
    if len(differing) != 1 or not all(part.isdecimal() for part in differing[0]):
        return None
    times = tuple(float(part) for part in differing[0])
    return (times, None) if _is_growing(times) else None


def _is_growing(times: Sequence[float]) -> bool:
    return all(map(isfinite, times)) and all(a < b for a, b in pairwise(times))
