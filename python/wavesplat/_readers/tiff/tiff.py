"""TIFF stacks, by tifffile: one file with many pages, or a folder with one slice per file.

Distances, unit and channels come from OME or ImageJ metadata (`facts.py`); a bare TIFF has spacing 1 (its resolution
tags are about paper).
"""

from __future__ import annotations

import re
import weakref
import xml.etree.ElementTree as ET
from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from math import prod
from pathlib import Path
from threading import Lock
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from wavesplat._model.lazy.array import SlicedArray, along_zyx
from wavesplat._model.volume.facts import COLORS, Channel, Facts
from wavesplat._readers.levels import Levels, OneVolume, stored_samples
from wavesplat._readers.request import Request, choose, level_numbers, quiet
from wavesplat._readers.tiff import slices as tiff_slices
from wavesplat._readers.tiff.facts import TiffPlace, place_of
from wavesplat._readers.tiff.slices import check_pages
from wavesplat._storage import size_checks
from wavesplat._storage.file_states import StoredFiles
from wavesplat._storage.paths import check_named_file
from wavesplat._storage.reading import reading
from wavesplat._system.threads import check_cancelled
from wavesplat.errors import FileError

if TYPE_CHECKING:
    from tifffile import TiffFile


#: Attributes of OME metadata that name another file.
NAMES_OF_FILES = ("FileName", "MetadataFile")


def levels(request: Request) -> Levels:
    """The levels of the stack in a TIFF file, or the one that is asked for; or the stack of a folder."""
    import tifffile

    path = request.file
    with quiet("tifffile"):
        if path.is_dir():
            level_numbers(1, request)
            slices = tiff_slices.slices_in(path, request)
            folder = _folder_array(slices, request)
            return Levels([folder], [slices.world_from_index], slices.facts, quietly=partial(quiet, "tifffile"))
        with tifffile.TiffFile(path) as tiff:
            return _levels_of(tiff, path, request)


def _levels_of(tiff: TiffFile, path: Path, request: Request) -> Levels:
    check_pages(path)
    for name in _named_files(tiff):
        check_named_file(name, path, anywhere=request.external_files, within=request.within)
    levels = _levels_in(tiff)
    finest: Any = levels[0]
    place = place_of(
        tiff,
        has_z="Z" in finest.axes or "T" not in finest.axes,
        time=request.time or 0,
        channel=request.channel or 0,
    )
    channels = _colors(finest) or place.facts.channels
    names = [channel.name for channel in channels]
    layouts = [_one_stack(series.axes, series.shape, request, names) for series in levels]
    shapes = [along_zyx(series.shape, order, 1) for series, (_, order) in zip(levels, layouts, strict=True)]
    facts = replace(place.facts, channels=channels, n_times=_n_times(finest))
    facts = replace(facts, channel=_channel_of(facts, request), levels=tuple(shapes) if len(shapes) > 1 else ())
    arrays, matrices = [], []
    for number in level_numbers(len(levels), request):
        _check_stored(path, levels[number])
        # An empty image is refused when its samples are taken.
        sizes = np.maximum([shapes[0][::-1], shapes[number][::-1]], 1)
        arrays.append(_array(tiff, number, layouts[number], request))
        matrices.append(_world_from_index(place, sizes[0] / sizes[1]))
    return Levels(arrays, matrices, facts, quietly=partial(quiet, "tifffile"))


def _array(
    tiff: TiffFile,
    level: int,
    layout: tuple[list[int | None], tuple[int, ...]],
    request: Request,
) -> SlicedArray:
    """The samples of a level: by their place in the file where all lie in one piece of it, unpacked, else page by page.

    Such a file may have a single page directory for all of its planes: ImageJ writes stacks of more than 4 GB so.
    """
    series: Any = _levels_in(tiff)[level]
    path, (picked, order) = request.file, layout
    dtype = series.dtype
    if series.dataoffset is not None and not series.is_multifile:
        stored = dtype.newbyteorder(tiff.byteorder)
        return stored_samples(path, int(series.dataoffset), series.shape, OneVolume(order, picked, stored, stored))
    n_of_pages = len(series.shape) - len(series.keyframe.shape)
    # Of pages that are slices one can be read without the others.
    is_of_slices = _has_own_pages(series) and [n_of_pages - 1] == [k for k in order if k < n_of_pages]
    if request.memory is not None and not is_of_slices:
        raise FileError(f"the slices are no pages of their own; open the file without memory=: {path}")
    return SlicedArray(
        None,
        name=request.name,
        chunks=along_zyx([1 if axis < n_of_pages else n for axis, n in enumerate(series.shape)], order, 1),
        order=order,
        picked=picked,
        opened=partial(_Pages, str(path), level),
        dtype=dtype.newbyteorder("="),
        shape=along_zyx(series.shape, order, 1),
        n_readers=2,
        token=f"TIFF {path} {level} {picked}",
        files=StoredFiles([path, *(path.parent / name for name in dict.fromkeys(_named_files(tiff)))]),
    )


def _has_own_pages(series: Any) -> bool:
    """Whether the last axes of a series are the axes of its pages, which follow each other along the others."""
    n = len(series.shape) - len(series.keyframe.shape)
    return bool(series.shape[n:] == series.keyframe.shape and len(series.pages) == prod(series.shape[:n]))


class _Pages:
    """A level of the first series, which is sliced by reading the pages that it needs."""

    def __init__(self, path: str, level: int) -> None:
        import tifffile

        self._file = tifffile.TiffFile(path)
        # Closed with these pages, rather than by the garbage collector's warning.
        weakref.finalize(self, self._file.close)
        self._series: Any = _levels_in(self._file)[level]
        self._lock = Lock()

    def __getitem__(self, index: tuple[int | slice, ...]) -> NDArray[Any]:
        series, n = self._series, len(self._series.shape) - len(self._series.keyframe.shape)
        with self._lock, quiet("tifffile"):
            if not _has_own_pages(series) or all(_is_whole(one, k) for one, k in zip(index, series.shape, strict=True)):
                return np.asarray(series.asarray()[index])
            wanted = np.arange(len(series.pages)).reshape(series.shape[:n])[index[:n]]
            pages: NDArray[Any] = np.stack([self._page(int(number), index[n:]) for number in wanted.ravel()])
        return pages.reshape(*wanted.shape, *pages.shape[1:])

    def _page(self, number: int, inside: tuple[int | slice, ...]) -> NDArray[Any]:
        page: Any = self._series.pages[number]
        if page is None:
            raise ValueError(f"page {number} is not there")
        samples: NDArray[Any] = page.asarray()[inside]
        return samples


def _is_whole(part: int | slice, n: int) -> bool:
    return isinstance(part, slice) and (part.start, part.stop) in ((0, n), (None, None))


def _levels_in(tiff: TiffFile) -> list[Any]:
    """The levels of the first series, the finest first: levels of a pyramid with the same axes and falling sizes."""
    finest: Any = tiff.series[0]
    levels = [finest]
    for one in finest.levels[1:]:
        sizes = list(zip(one.axes, one.shape, levels[-1].shape, strict=False))
        is_smaller = any(n < before for _, n, before in sizes) and all(n <= before for _, n, before in sizes)
        is_same = all(n == before for name, n, before in sizes if name not in "ZYX")
        if one.axes == finest.axes and one.dtype == finest.dtype and is_smaller and is_same:
            levels.append(one)
    return levels


def _world_from_index(place: TiffPlace, ratios: NDArray[np.float64]) -> NDArray[np.float64]:
    """The affine of a coarser level with the same box, by the number of finest samples for each of its own.

    A negative distance mirrors the axis.
    """
    steps = np.array(place.steps)
    matrix = np.diag([*(ratios * steps), 1.0])
    matrix[:3, 3] = np.array(place.origin) + (ratios - 1) / 2 * steps
    return matrix


def _channel_of(facts: Facts, request: Request) -> Channel | None:
    number = request.channel or 0
    return facts.channels[number] if number < len(facts.channels) else None


def _colors(series: Any) -> tuple[Channel, ...]:
    """Channels of pixels of three or four samples, which are colours; none for others."""
    sizes = dict(zip(series.axes, series.shape, strict=True))
    return COLORS[: sizes["S"]] if sizes.get("S") in (3, 4) and "C" not in sizes else ()


def _n_times(series: Any) -> int:
    sizes = dict(zip(series.axes, series.shape, strict=True))
    return int(sizes.get("T", 1)) if "Z" in sizes else 1


def _named_files(tiff: TiffFile) -> list[str]:
    """Names of files in the OME metadata."""
    text = (tiff.ome_metadata or "") if tiff.is_ome else ""
    try:
        root = ET.fromstring(text)  # noqa: S314 - as tifffile does
        names = [part.get(attribute, "") for part in root.iter() for attribute in NAMES_OF_FILES]
    except ET.ParseError:  # some releases of tifffile mend it
        names = re.findall(rf"(?:{'|'.join(NAMES_OF_FILES)})\s*=\s*[\"']([^\"']*)", text)
    return [name for name in names if name]


def _folder_array(slices: tiff_slices.Slices, request: Request) -> SlicedArray:
    """The samples of a folder, a file for each slice."""
    y, x = slices.first.shape
    return SlicedArray(
        None,
        name=request.name,
        chunks=(1, y, x),
        opened=partial(_FolderPages, slices.files, replace(request, kept=None), slices.first),
        dtype=slices.first.dtype,
        shape=(len(slices.files), y, x),
        n_readers=2,
        token=f"TIFF folder {request.file} {request.time} {request.channel}",
        files=StoredFiles(slices.files, axis=0),
    )


class _FolderPages:
    """Slices in a file each, of the shape and type of the first."""

    def __init__(self, files: list[Path], request: Request, first: NDArray[Any]) -> None:
        self._files, self._request = files, request
        self._shape, self._dtype = first.shape, first.dtype

    def __getitem__(self, index: tuple[slice, slice, slice]) -> NDArray[Any]:
        zs, ys, xs = index
        made: NDArray[Any] | None = None
        for k in range(zs.start, zs.stop):
            check_cancelled()
            page = self._page(self._files[k])[ys, xs]
            made = np.empty((zs.stop - zs.start, *page.shape), page.dtype) if made is None else made
            made[k - zs.start] = page
        return np.empty((0, 0, 0), self._dtype) if made is None else made

    def _page(self, file: Path) -> NDArray[Any]:
        import tifffile

        with reading("TIFF", file), quiet("tifffile"):
            check_pages(file)
            one = tiff_slices.slice_of(tifffile.imread(file), file, self._request)
        if (one.shape, one.dtype) != (self._shape, self._dtype):
            raise FileError(
                f"slices differ: {self._files[0].name} is {self._shape} of {self._dtype}, "
                f"{file.name} is {one.shape} of {one.dtype}; "
                f"keep one kind in the folder: {file.parent}"
            )
        return one


def _one_stack(
    axes: str, shape: Sequence[int], request: Request, channels: Sequence[str] = ()
) -> tuple[list[int | None], tuple[int, ...]]:
    """Index of one stack in an array whose axes tifffile named, and its axes z, y, x (or y, x).

    The names: T time, C channel, S colour, Q or I unknown.
    """
    if "Z" not in axes:
        # Many programs store a stack as anonymous pages or as time points.
        stack = next((name for name in "QIT" if name in axes and shape[axes.index(name)] > 1), None)
        axes = axes.replace(stack, "Z") if stack else axes
    picked: list[int | None] = []
    for name, count in zip(axes, shape, strict=True):
        if name in "ZYX":
            picked.append(None)
        elif name == "T":
            picked.append(choose("time", count, request.time, request.path))
        elif name in "CS":
            picked.append(choose("channel", count, request.channel, request.path, described=channels))
        elif count == 1:
            picked.append(0)
        else:
            raise FileError(f"the axes are {axes}, shape {tuple(shape)}; export one stack as Z, Y, X: {request.path}")
    return picked, tuple(axes.index(name) for name in "ZYX" if name in axes)


def _check_stored(path: Path, series: Any) -> None:
    """Raise a `FileError` if a page's data reach past the end of the file."""
    size = path.stat().st_size
    size_checks.check_stored(series.shape, series.dtype, size, path, ratio=size_checks.ANY_RATIO, held=(1,))
    ends = [series.dataoffset + series.nbytes] if series.dataoffset is not None else []
    for page in series.pages:
        if page is not None:
            if len(page.dataoffsets) < prod(page.chunked):
                raise FileError(f"truncated, or a wrong header: a page lacks its data; copy or export it again: {path}")
            ends += [at + count for at, count in zip(page.dataoffsets, page.databytecounts, strict=False)]
    if max(ends, default=0) > size:
        raise FileError(
            f"truncated: the pages need {max(ends)} bytes, the file holds {size}; copy or export it again: {path}"
        )
