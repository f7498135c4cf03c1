"""Series of files: the time points of one file or folder, or a file for each; and when they were taken."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise
from math import isfinite
from os import PathLike, fspath
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from wavesplat._model.arguments.types import takes_its_types, takes_options
from wavesplat._model.interchange.hdf5 import read_hdf5
from wavesplat._model.volume.series import Series, times_of_facts
from wavesplat._model.volume.sources import Source, of_series
from wavesplat._model.volume.volume import Volume
from wavesplat._public import public
from wavesplat._readers.opening import opened
from wavesplat._readers.options import FileOptions
from wavesplat._readers.request import Request, SeveralError, requested, taking_planes
from wavesplat._storage.paths import FileName, matching_files
from wavesplat._system.values import described
from wavesplat.errors import ArgumentError, FileError

if TYPE_CHECKING:
    from typing import Unpack

    import h5py

# Times of files of one time point each: what the files say, else the numbers that their names differ in.

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


# Series of files: the time points of one file or folder, or a file for each.


@public
@takes_its_types
@takes_options(FileOptions, Request)
def open_series(
    path: str | PathLike[str] | Sequence[str | PathLike[str]],
    *,
    channel: int | None = None,
    **options: Unpack[FileOptions],
) -> Series:
    """The time points of a file, or files of one time point each, read when they are asked for.

    Parameters
    ----------
    path : path, URL, pattern or list of paths
        A file or folder that holds several time points: 4-D NIfTI, NRRD and MetaImage, OME-Zarr, TIFF of OME and
        ImageJ, Imaris, BigDataViewer, microscopes' files by bioio, DICOM; arrays without named axes (.npy, raw, HDF5),
        whose first axis is time. Or files of one time point each, in order: a list, or a pattern such as
        "frames/t*.nii.gz", whose files are taken in the order of the numbers in their names (t2 before t10). Their
        times are those that the files say (HDF5 by an attribute `time`, openPMD, netCDF-4, BOV), else the numbers that
        their names differ in. A file of one volume is a series of one.
    channel : int, optional
        As for `wavesplat.open`.
    **options : FileOptions
        As for `wavesplat.open`, for every time point.

    Returns
    -------
    Series
        `series[3]` is a Volume, `len(series)` the number of volumes, `series.times` when they were taken.

    Raises
    ------
    FileError
        If there is no such file, or it is unreadable. What is wrong with a later time point is said when it is read.
    ArgumentError
        If an option has no meaning for that format or is out of range.

    Examples
    --------
    >>> import numpy as np, wavesplat as ws
    >>> np.save("beating.npy", np.random.default_rng(1).random((5, 8, 8, 8), np.float32))
    >>> series = ws.open_series("beating.npy")
    >>> len(series), series[-1].shape, series[1:3]
    (5, (8, 8, 8), <Series 'beating.npy': 2 time points>)
    """
    paths = _files(path)
    if len(paths) == 1 and isinstance(path, str | PathLike):
        points: Any = _OfOneFile(requested(paths[0], channel=channel, **options))
        made = Series(points, name=points.request.name)
        made._source = _source_of(path, points.request)
        return made
    requests = [requested(one, channel=channel, **options) for one in paths]
    for request in requests:
        if not (request.is_url or request.file.exists()):
            raise FileError(f"no such file or folder; check the name: {request.safe_path}")
    made = Series(_OfManyFiles(requests), name=_name_of_all(requests))
    made._source = _source_of(path, requests[0])
    return made


def _source_of(path: Any, request: Request) -> Source | None:
    """Source of a series, for documents."""
    options = {name: getattr(request, name) for name in request.given()}
    if isinstance(path, str | PathLike):
        return of_series(path, options)
    return of_series(list(path), options)


class _OfOneFile:
    """The time points that a file or folder holds."""

    def __init__(self, request: Request) -> None:
        self.request = request
        self._first: Volume | None = None
        self._kept: dict[str, Any] = {}
        try:
            self._first = opened(replace(request, kept=self._kept))
        except SeveralError as error:
            if error.option != "time":
                raise
            self._n = len(error.names)
            self._has_several = True
        else:
            self._n = 1
            self._has_several = False

    def __len__(self) -> int:
        return self._n

    def __getitem__(self, number: int) -> Volume:
        if not self._has_several:
            first, self._first = self._first, None
            return opened(self.request) if first is None else first
        with taking_planes():  # films are times of pictures
            volume = opened(replace(self.request, time=number, kept=self._kept))
        self._times = times_of_facts(volume.facts, self._n)
        return volume

    def times(self) -> tuple[tuple[float, ...], str | None]:
        """Times and their unit as the file states them, once one of its volumes is read."""
        if self._times is None:
            volume = self._first or self[0]
            self._times = times_of_facts(volume.facts, self._n)
        return self._times

    _times: tuple[tuple[float, ...], str | None] | None = None

    def description(self) -> str:
        """The file, in messages."""
        return f"the file {self.request.safe_path!r}"

    def __getstate__(self) -> dict[str, Any]:
        # No open files.
        return {**vars(self), "_kept": {}, "_first": None}


class _OfManyFiles:
    """Files of one time point each."""

    def __init__(self, requests: Sequence[Request]) -> None:
        self._requests = tuple(requests)

    def __len__(self) -> int:
        return len(self._requests)

    def __getitem__(self, number: int) -> Volume:
        try:
            return opened(self._requests[number])
        except SeveralError as error:
            if error.option != "time":
                raise
            raise FileError(
                f"one of several files holds {len(error.names)} time points itself; open it alone, or list files of "
                f"one time point each: {self._requests[number].safe_path}"
            ) from None

    def times(self) -> tuple[tuple[float, ...], str | None]:
        """Times that the files say, else the numbers that their names differ in, else 0, 1, 2, ..."""
        named = [request.file for request in self._requests if not request.is_url and not request.file.is_dir()]
        found = times_of_files(named) if len(named) == len(self) else None
        return found or (tuple(float(number) for number in range(len(self))), None)

    def description(self) -> str:
        """The first and the last file, in messages."""
        return f"the list of files {_name_of_all(self._requests)!r}"


def _name_of_all(requests: Sequence[Request]) -> FileName:
    first, last = requests[0].name, requests[-1].name
    return first if first == last else FileName(f"{first} to {last}", is_private=first.is_private)


def _files(path: Any) -> list[Any]:
    """The files of a path, a pattern or a list, in order."""
    if isinstance(path, str | PathLike):
        text = fspath(path)
        found = matching_files(text) if isinstance(text, str) else None
        return [path] if found is None else found
    paths = list(path)
    if not paths:
        raise ArgumentError("path is an empty list; give the files of the time points, in order")
    for one in paths:
        if not isinstance(one, str | PathLike):
            raise ArgumentError(f"one of the paths is {described(one)}; give names of files")
    return paths
