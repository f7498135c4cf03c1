"""TIFF stacks, by tifffile: one file with many pages, or a folder with one slice per file.

Spacing comes from OME or ImageJ metadata, in the unit given there; a bare TIFF has spacing 1 (its resolution tags are
about paper).
"""

from __future__ import annotations

import re
import xml.etree.ElementTree as ET
from math import prod
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from wavesplat._files import payload
from wavesplat._files.named_files import check_named_file
from wavesplat._files.reading import reading
from wavesplat._model import affine
from wavesplat._readers.request import Grid, Request, choose, quiet
from wavesplat.errors import FileError

if TYPE_CHECKING:
    from tifffile import TiffFile

__all__ = ["read"]

#: OME's units of length, in micrometres.
MICROMETERS = {"nm": 1e-3, "µm": 1.0, "um": 1.0, "mm": 1e3, "cm": 1e4, "m": 1e6, "pm": 1e-6, "Å": 1e-4}

#: Attributes of OME metadata that name another file.
NAMES_OF_FILES = ("FileName", "MetadataFile")


def read(request: Request) -> Grid:
    """The stack in a TIFF file or a folder of TIFF files."""
    with reading("TIFF", request.path), quiet("tifffile"):
        if request.file.is_dir():
            return _read_folder(request.file, request)
        return _read_file(request.file, request)


def _read_file(path: Path, request: Request) -> Grid:
    import tifffile

    with tifffile.TiffFile(path) as tiff:
        _check_named_files(tiff, path, anywhere=request.external_files)
        series = tiff.series[0]
        _check_stored(tiff, path)
        samples = _one_stack(series.asarray(), series.axes, request)
        return Grid(samples, affine.from_spacing(_spacing(tiff)))


def _check_named_files(tiff: TiffFile, path: Path, *, anywhere: bool) -> None:
    """A `FileError` if the OME metadata name files in other folders."""
    text = (tiff.ome_metadata or "") if tiff.is_ome else ""
    try:
        root = ET.fromstring(text)  # noqa: S314 - as tifffile does
        names = [part.get(attribute, "") for part in root.iter() for attribute in NAMES_OF_FILES]
    except ET.ParseError:  # some releases of tifffile mend it
        names = re.findall(rf"(?:{'|'.join(NAMES_OF_FILES)})\s*=\s*[\"']([^\"']*)", text)
    for name in filter(None, names):
        check_named_file(name, path, anywhere=anywhere)


def _read_folder(folder: Path, request: Request) -> Grid:
    import tifffile

    files = sorted((file for file in folder.iterdir() if file.suffix.lower() in (".tif", ".tiff")), key=_natural)
    first = _slice(tifffile.imread(files[0]), files[0], request)
    payload.check_memory(first.nbytes * len(files), folder)
    stack = np.empty((len(files), *first.shape), first.dtype)
    for number, file in enumerate(files):
        with reading("TIFF", file):
            one = _slice(tifffile.imread(file), file, request)
        if (one.shape, one.dtype) != (first.shape, first.dtype):
            raise FileError(
                f"slices differ: {files[0].name} is {first.shape} of {first.dtype}, "
                f"{file.name} is {one.shape} of {one.dtype}; "
                f"keep one kind in the folder: {folder}"
            )
        stack[number] = one
    return Grid(stack, np.eye(4))


def _slice(pixels: NDArray[Any], file: Path, request: Request) -> NDArray[Any]:
    """One 2-D slice, of one channel."""
    if pixels.ndim == 3 and pixels.shape[-1] in (2, 3, 4):
        return pixels[..., choose("channel", pixels.shape[-1], request.channel, file)]
    if pixels.ndim != 2:
        raise FileError(f"a slice in the folder is {pixels.ndim}-D, shape {pixels.shape}; open that file alone: {file}")
    return pixels


def _natural(path: Path) -> list[tuple[int, str]]:
    """Sort key that puts slice10 after slice9."""
    return [(int(part), "") if part.isdigit() else (-1, part) for part in re.split(r"(\d+)", path.name)]


def _one_stack(samples: NDArray[Any], axes: str, request: Request) -> NDArray[Any]:
    """The [z, y, x] part of an array whose axes tifffile named: T time, C channel, S colour, Q or I unknown."""
    if "Z" not in axes:
        # Many programs store a stack as anonymous pages or as time points.
        stack = next((name for name in "QIT" if name in axes and samples.shape[axes.index(name)] > 1), None)
        axes = axes.replace(stack, "Z") if stack else axes
    picked: list[Any] = []
    kept = ""
    for name, count in zip(axes, samples.shape, strict=True):
        if name in "ZYX":
            picked.append(slice(None))
            kept += name
        elif name == "T":
            picked.append(choose("time", count, request.time, request.path))
        elif name in "CS":
            picked.append(choose("channel", count, request.channel, request.path))
        elif count == 1:
            picked.append(0)
        else:
            raise FileError(f"the axes are {axes}, shape {samples.shape}; export one stack as Z, Y, X: {request.path}")
    order = [kept.index(name) for name in "ZYX" if name in kept]
    return np.transpose(samples[tuple(picked)], order)


def _check_stored(tiff: TiffFile, path: Path) -> None:
    """A `FileError` if a page's data reach past the end of the file."""
    size = path.stat().st_size
    series: Any = tiff.series[0]
    payload.check_stored(series.shape, series.dtype, size, path, ratio=payload.ANY_RATIO)
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


def _spacing(tiff: TiffFile) -> tuple[float, float, float]:
    found = _ome_spacing(tiff) if tiff.is_ome else _imagej_spacing(tiff) if tiff.is_imagej else (None, None, None)
    x = found[0] or 1.0
    # A missing spacing is taken from x: then the stack keeps its proportions at least in scale.
    return x, found[1] or x, found[2] or x


def _imagej_spacing(tiff: TiffFile) -> tuple[float | None, float | None, float | None]:
    page: Any = tiff.pages[0]
    metadata = tiff.imagej_metadata or {}

    def between_pixels(tag: str) -> float | None:
        if tag not in page.tags:
            return None
        n_pixels, n_units = page.tags[tag].value
        return n_units / n_pixels if n_pixels and n_units else None

    return between_pixels("XResolution"), between_pixels("YResolution"), metadata.get("spacing")


def _ome_spacing(tiff: TiffFile) -> tuple[float | None, float | None, float | None]:
    """`PhysicalSizeX` and so on of the first `Pixels`, in the unit of x."""
    text = tiff.ome_metadata or ""
    pixels = re.search(r"<(?:\w+:)?Pixels\b[^>]*>", text)
    attributes = dict(re.findall(r'(\w+)="([^"]*)"', pixels.group())) if pixels else {}

    def unit(axis: str) -> float:
        return MICROMETERS.get(attributes.get(f"PhysicalSize{axis}Unit", "µm"), 1.0)

    sizes = [float(attributes.get(f"PhysicalSize{axis}", 0)) * unit(axis) / unit("X") for axis in "XYZ"]
    return sizes[0] or None, sizes[1] or None, sizes[2] or None
