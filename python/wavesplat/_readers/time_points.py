"""Series of files: the time points of one file or folder, or a file for each."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from os import PathLike, fspath
from typing import TYPE_CHECKING, Any

from wavesplat._files.file_names import FileName
from wavesplat._files.patterns import matching_files
from wavesplat._model.argument_types import described, takes_its_types
from wavesplat._model.option_lists import takes_options
from wavesplat._model.series import Series
from wavesplat._model.sources import Source, of_series
from wavesplat._model.time_stamps import times_of_facts
from wavesplat._model.volume import Volume
from wavesplat._public import public
from wavesplat._readers.file_times import times_of_files
from wavesplat._readers.opening import opened
from wavesplat._readers.options import FileOptions
from wavesplat._readers.request import Request, SeveralError, requested, taking_planes
from wavesplat.errors import ArgumentError, FileError

if TYPE_CHECKING:
    from typing import Unpack


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
