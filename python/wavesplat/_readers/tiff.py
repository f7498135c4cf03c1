"""TIFF stacks, by tifffile: one file with many pages, or a folder with one slice per file.

Distances, unit and channels come from OME or ImageJ metadata (`tiff_facts`); a bare TIFF has spacing 1 (its resolution
tags are about paper).
"""

from __future__ import annotations

import re
import xml.etree.ElementTree as ET
from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import prod
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from wavesplat._files import size_checks
from wavesplat._files.cancelling import check_cancelled
from wavesplat._files.named_files import check_named_file
from wavesplat._files.reading import reading
from wavesplat._model.facts import COLORS, Channel, Facts
from wavesplat._readers import tiff_slices
from wavesplat._readers.request import Grid, Request, choose, level_numbers, quiet
from wavesplat._readers.single_planes import level_of_plane, note_on_level
from wavesplat._readers.tiff_facts import TiffPlace, place_of
from wavesplat._readers.tiff_pages import check_pages
from wavesplat.errors import FileError

if TYPE_CHECKING:
    from tifffile import TiffFile

__all__ = ["Described", "described", "levels_in", "read"]

#: Attributes of OME metadata that name another file.
NAMES_OF_FILES = ("FileName", "MetadataFile")


def read(request: Request) -> Grid:
    """The stack in a TIFF file or a folder of TIFF files."""
    with reading("TIFF", request.path), quiet("tifffile"):
        if request.file.is_dir():
            level_numbers(1, request)
            return _read_folder(request.file, request)
        return _read_file(request.file, request)


def _read_file(path: Path, request: Request) -> Grid:
    import tifffile

    with tifffile.TiffFile(path) as tiff:
        found = _described(tiff, path, request)[0]
        samples = np.transpose(_picked_samples(tiff, found, path), found.order)
        return Grid(samples, found.world_from_index, found.facts)


@dataclass(frozen=True)
class Described:
    """Layout, place and facts of a level of a file's first series, before samples are read."""

    level: int
    shape: tuple[int, ...]
    page_shape: tuple[int, ...]
    #: Type of the samples, in the byte order of the file.
    dtype: np.dtype[Any]
    #: First byte of the samples where all of them lie in one piece of this file, unpacked; else None.
    offset: int | None
    picked: tuple[Any, ...]
    order: list[int]
    world_from_index: NDArray[np.float64]
    facts: Facts
    #: Other files of the same image that OME metadata name.
    others: tuple[Path, ...] = ()


def described(path: Path, request: Request) -> list[Described]:
    """Descriptions of the levels of the stack in a file, the finest first, or of the one that is asked for."""
    import tifffile

    with tifffile.TiffFile(path) as tiff:
        found = _described(tiff, path, request, in_memory=False)
        others = tuple(path.parent / name for name in dict.fromkeys(_named_files(tiff)))
        return [replace(one, others=others) for one in found]


def _described(tiff: TiffFile, path: Path, request: Request, *, in_memory: bool = True) -> list[Described]:
    check_pages(path)
    _check_named_files(tiff, path, request)
    levels = levels_in(tiff)
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
    shapes = [_zyx(series.shape, *layout) for series, layout in zip(levels, layouts, strict=True)]
    facts = replace(place.facts, channels=channels, n_times=_n_times(finest))
    facts = replace(facts, channel=_channel_of(facts, request), levels=tuple(shapes) if len(shapes) > 1 else ())
    wanted = level_numbers(len(levels), request)
    if in_memory:
        wanted = [level_of_plane(shapes, request) or wanted[0]]
        if wanted[0] > 0 and request.level is None:
            facts = replace(facts, guesses=(*facts.guesses, note_on_level(wanted[0], len(levels))))
    found = []
    for number in wanted:
        series, (picked, order) = levels[number], layouts[number]
        others = "TCS" if "Z" in series.axes else "CS"
        one = [n for name, n in zip(series.axes, series.shape, strict=True) if name not in others]
        _check_stored(path, one if in_memory else [1], series)
        # An empty image is refused when its samples are taken.
        sizes = np.maximum([shapes[0][::-1], shapes[number][::-1]], 1)
        matrix = _world_from_index(place, sizes[0] / sizes[1])
        pages = tuple(series.keyframe.shape)
        dtype = series.dtype.newbyteorder(tiff.byteorder)
        offset = _offset_of(series)
        found.append(Described(number, tuple(series.shape), pages, dtype, offset, picked, order, matrix, facts))
    return found


def levels_in(tiff: TiffFile) -> list[Any]:
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


def _zyx(shape: Sequence[int], picked: Sequence[Any], order: Sequence[int]) -> tuple[int, int, int]:
    """Samples along z, y, x of a stack; 1 along z of a single plane."""
    kept = [n for n, part in zip(shape, picked, strict=True) if isinstance(part, slice)]
    z, y, x = ([1] * (3 - len(kept)) + [kept[axis] for axis in order])[-3:]
    return z, y, x


def _world_from_index(place: TiffPlace, ratios: NDArray[np.float64]) -> NDArray[np.float64]:
    """The affine of a coarser level with the same box, by the number of finest samples for each of its own.

    A negative distance mirrors the axis.
    """
    steps = np.array(place.steps)
    matrix = np.diag([*(ratios * steps), 1.0])
    matrix[:3, 3] = np.array(place.origin) + (ratios - 1) / 2 * steps
    return matrix


def _offset_of(series: Any) -> int | None:
    """First byte of a series whose samples lie in one piece of the file; None where they do not.

    Such a series may have a single page directory for all of its planes: ImageJ writes stacks of more than 4 GB so.
    """
    return None if series.is_multifile or series.dataoffset is None else int(series.dataoffset)


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


def _check_named_files(tiff: TiffFile, path: Path, request: Request) -> None:
    """Raise a `FileError` if the OME metadata name files in other folders."""
    for name in _named_files(tiff):
        check_named_file(name, path, anywhere=request.external_files, within=request.within)


def _named_files(tiff: TiffFile) -> list[str]:
    """Names of files in the OME metadata."""
    text = (tiff.ome_metadata or "") if tiff.is_ome else ""
    try:
        root = ET.fromstring(text)  # noqa: S314 - as tifffile does
        names = [part.get(attribute, "") for part in root.iter() for attribute in NAMES_OF_FILES]
    except ET.ParseError:  # some releases of tifffile mend it
        names = re.findall(rf"(?:{'|'.join(NAMES_OF_FILES)})\s*=\s*[\"']([^\"']*)", text)
    return [name for name in names if name]


def _read_folder(folder: Path, request: Request) -> Grid:
    import tifffile

    slices = tiff_slices.slices_in(folder, request)
    first = slices.first
    size_checks.check_memory(first.nbytes * len(slices.files), folder)
    stack = np.empty((len(slices.files), *first.shape), first.dtype)
    for number, file in enumerate(slices.files):
        check_cancelled()
        with reading("TIFF", file):
            check_pages(file)
            one = tiff_slices.slice_of(tifffile.imread(file), file, request)
        if (one.shape, one.dtype) != (first.shape, first.dtype):
            raise FileError(
                f"slices differ: {slices.files[0].name} is {first.shape} of {first.dtype}, "
                f"{file.name} is {one.shape} of {one.dtype}; "
                f"keep one kind in the folder: {folder}"
            )
        stack[number] = one
    return Grid(stack, slices.world_from_index, slices.facts)


def _one_stack(
    axes: str, shape: Sequence[int], request: Request, channels: Sequence[str] = ()
) -> tuple[tuple[Any, ...], list[int]]:
    """Index of one stack in an array whose axes tifffile named, and the order that makes it [z, y, x].

    The names: T time, C channel, S colour, Q or I unknown.
    """
    if "Z" not in axes:
        # Many programs store a stack as anonymous pages or as time points.
        stack = next((name for name in "QIT" if name in axes and shape[axes.index(name)] > 1), None)
        axes = axes.replace(stack, "Z") if stack else axes
    picked: list[Any] = []
    kept = ""
    for name, count in zip(axes, shape, strict=True):
        if name in "ZYX":
            picked.append(slice(None))
            kept += name
        elif name == "T":
            picked.append(choose("time", count, request.time, request.path))
        elif name in "CS":
            picked.append(choose("channel", count, request.channel, request.path, described=channels))
        elif count == 1:
            picked.append(0)
        else:
            raise FileError(f"the axes are {axes}, shape {tuple(shape)}; export one stack as Z, Y, X: {request.path}")
    return tuple(picked), [kept.index(name) for name in "ZYX" if name in kept]


def _picked_samples(tiff: TiffFile, found: Described, path: Path) -> NDArray[Any]:
    """Samples of a level of the first series at the index `picked`; other pages are not read."""
    picked = found.picked
    series: Any = levels_in(tiff)[found.level]
    of_pages = len(series.shape) - len(series.keyframe.shape)
    n_pages = len(series.pages)
    is_part = not all(isinstance(part, slice) for part in picked[:of_pages])
    is_regular = series.shape[of_pages:] == series.keyframe.shape and n_pages == prod(series.shape[:of_pages])
    offset = _offset_of(series)
    if is_part and offset is not None:
        dtype = series.dtype.newbyteorder(tiff.byteorder)
        mapped = np.memmap(path, dtype, "r", offset=offset, shape=tuple(series.shape))
        return np.array(mapped[picked])
    if is_part and is_regular:
        wanted = np.arange(n_pages).reshape(series.shape[:of_pages])[picked[:of_pages]]
        pages: NDArray[Any] = np.stack([series.pages[int(number)].asarray() for number in wanted.ravel()])
        pages = pages.reshape(*wanted.shape, *series.keyframe.shape)
        return np.asarray(pages[(..., *picked[of_pages:])])
    whole: NDArray[Any] = series.asarray()
    return np.asarray(whole[picked])


def _check_stored(path: Path, one: Sequence[int], series: Any) -> None:
    """Raise a `FileError` if a page's data reach past the end of the file. `one`: shape of one volume."""
    size = path.stat().st_size
    size_checks.check_stored(series.shape, series.dtype, size, path, ratio=size_checks.ANY_RATIO, held=one)
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
