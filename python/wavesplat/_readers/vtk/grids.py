"""VTK's grids that are no images: rectilinear, structured, unstructured, in blocks, and images in several files.

They are read by the library VTK itself, which alone knows them all (XML and legacy). A grid that is uniform is drawn as
it is; others are sampled on an image where the user asks for it, by VTK's `vtkResampleToImage`.
Format: "VTK XML Formats" and "VTK file formats", https://docs.vtk.org/en/latest/vtk_file_formats/.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass, replace
from pathlib import Path
from threading import Lock
from typing import Any
from xml.parsers import expat

import numpy as np
from numpy.typing import NDArray

from wavesplat._model.volume.facts import Facts
from wavesplat._model.volume.grid import UPRIGHT
from wavesplat._readers.components import component_of, facts_of_colors, is_length, length_of, quantity_of_array
from wavesplat._readers.file_contents import Contents, FileArray, joined_ranges, ranges_of
from wavesplat._readers.request import Grid, Request
from wavesplat._readers.vtk.amr import Box, boxes_of, on_one_grid, sizes_of
from wavesplat._readers.vtk.arrays import GRID_SUFFIXES, check_grid, chosen, described_grid, other_grid
from wavesplat._readers.vtk.legacy import check_whole
from wavesplat._readers.vtk.sampling import (
    GHOSTS,
    check_depth,
    facts_of_grid,
    n_points,
    sampled_on_image,
    set_only_array,
    type_of_samples,
    uniform_place,
    without_hidden,
)
from wavesplat._readers.vtk.vti import parsed
from wavesplat._storage import size_checks
from wavesplat._storage.paths import check_named_file
from wavesplat._storage.reading import reading
from wavesplat._system.libraries import library, muted_stderr
from wavesplat.errors import FileError

EXTRA = "vtk"
#: Bytes in which the kind of a file is looked for.
HEAD_BYTES = 1 << 16
# Not `^\s*`, which goes over all empty lines from each of them.
DATASET = re.compile(rb"^[ \t\r\v\f]*DATASET[ \t]+(\w+)", re.IGNORECASE | re.MULTILINE)
#: Numbers of points and cells that a file promises, and extents.
COUNTS = re.compile(
    rb"""\bNumberOf(?:Points|Cells)\s*=\s*["']\s*(\d+)|^[ \t\r\v\f]*(?:POINTS|CELLS|POINT_DATA|CELL_DATA)[ \t]+(\d+)""",
    re.MULTILINE,
)
EXTENTS = re.compile(rb"""\bExtent\s*=\s*["']([-\d\s]+)["']|^[ \t\r\v\f]*DIMENSIONS((?:[ \t]+\d+){3})""", re.MULTILINE)
#: A codec that Python lacks, and VTK has.
LZ4 = re.compile(rb"""<VTKFile\b[^<>]*?\bcompressor\s*=\s*["']vtkLZ4DataCompressor["']""")
#: The directions of an image's axes, of its element.
DIRECTION = re.compile(rb"""<ImageData\b[^<>]*?\bDirection\s*=\s*["']([^"']*)["']""")
#: The window that VTK writes errors to is one for all threads.
_WINDOW = Lock()
#: Maximum number of letters of an error of VTK that are shown.
MAX_LETTERS = 120
#: Files that files name, one in the other, at most.
MAX_DEPTH = 8


def read(request: Request) -> Grid:
    """The samples of a grid: its own where it is uniform, else the samples of an image that `resample` asks for."""
    with reading("a VTK grid", request.path):
        if (kind := _kind(request.file)) in ("PolyData", "PPolyData"):
            raise other_grid(kind, request.path)
        data, blocks = _checked_blocks(request)
        array, guessed = _chosen(blocks, request)
        if len(blocks) == 1 and (matrix := uniform_place(blocks[0], of_cells=array.of_cells)) is not None:
            return _with_guesses(_as_it_is(blocks[0], array, matrix, request), guessed)
        check_depth(blocks, request)
        boxes = boxes_of(data) if array.of_cells else None
        if request.resample is None and boxes:
            raise _which_level(data, boxes, request)
        if request.resample is None:
            held = described_grid(data.GetClassName())
            raise FileError(
                f"the file holds {held}, not an image of evenly spaced samples; sample it on one, with N "
                f"samples along its longest side, by resample=N (--resample N): {request.path}"
            )
        if boxes:
            return _with_guesses(_of_level(data, boxes, array, request), guessed)
        return _with_guesses(_resampled(data, blocks, array, request), guessed)


def _checked_blocks(request: Request) -> tuple[Any, list[Any]]:
    """The data object in a file, and the grids that it is made of, all checked."""
    library("vtkmodules", extra=EXTRA)
    _check_file(request.file, request, MAX_DEPTH)
    data = loaded(request.file)
    blocks = [block for block in _blocks(data) if block.GetNumberOfPoints() > 0]
    if not blocks:
        raise FileError(f"the grid has no points; write one that has: {request.path}")
    for block in blocks:
        check_grid(block)
    return data, blocks


def contents(request: Request) -> Contents:
    """All arrays of the file, and its grid."""
    with reading("a VTK grid", request.path):
        data, blocks = _checked_blocks(request)
        arrays = tuple(_described(name, array, blocks) for name, array in _arrays_of(blocks).items())
        return Contents(arrays, facts_of_grid(data, blocks))


def _described(name: str, array: _Array, blocks: list[Any]) -> FileArray:
    found = [numbers for block in blocks if (numbers := array.numbers_of(block)) is not None]
    n = sum(len(numbers) for numbers in found)
    same_width = {numbers.shape[1] for numbers in found}
    ranges = [ranges_of(numbers, has_components=True) for numbers in found if len(numbers)]
    place: Any = "cells" if array.of_cells else "points"
    dtype = str(np.result_type(*found))
    return FileArray(name, dtype, (n,), max(same_width), place, joined_ranges(ranges) if len(same_width) == 1 else ())


def is_grid(path: Path, *, or_mesh: bool = False) -> bool:
    """Whether a legacy or XML file of VTK holds another grid than one image, or an image packed as VTK alone does.

    or_mesh : or a mesh of surfaces or lines in a legacy file, which holds no samples.
    """
    with path.open("rb") as file:
        head = file.read(HEAD_BYTES)
    if head.lstrip().startswith(b"<"):
        kind = _kind_of_xml(head)
        is_other = kind is not None and kind != "ImageData" and f".{_SUFFIX_OF.get(kind, '')}" in GRID_SUFFIXES
        return is_other or (kind == "ImageData" and LZ4.search(head) is not None)
    found = DATASET.search(head)
    grids = [b"RECTILINEAR_GRID", b"STRUCTURED_GRID", b"UNSTRUCTURED_GRID", *([b"POLYDATA"] if or_mesh else [])]
    return found is not None and found[1].upper() in grids


_SUFFIX_OF = {
    "RectilinearGrid": "vtr",
    "StructuredGrid": "vts",
    "UnstructuredGrid": "vtu",
    "PolyData": "vtp",
    "PImageData": "pvti",
    "PRectilinearGrid": "pvtr",
    "PStructuredGrid": "pvts",
    "PUnstructuredGrid": "pvtu",
    "PPolyData": "pvtp",
    "vtkMultiBlockDataSet": "vtm",
    "vtkOverlappingAMR": "vthb",
    "vtkHierarchicalBoxDataSet": "vthb",
    "vtkNonOverlappingAMR": "vthb",
}


def _kind(path: Path) -> str | None:
    """The type that an XML file states; None of another file."""
    with path.open("rb") as file:
        head = file.read(HEAD_BYTES)
    return _kind_of_xml(head) if head.lstrip().startswith(b"<") else None


def _kind_of_xml(head: bytes) -> str | None:
    """The type that the first element of a file states; None where it states none, or has a document type."""
    found: list[str] = []

    def element(name: str, attributes: dict[str, str]) -> None:
        if not found:
            found.append(attributes.get("type", "") if name == "VTKFile" else "")

    def document_type(*_: object) -> None:
        found.append("")  # its entities could grow without bound, and VTK writes none

    parser = expat.ParserCreate()
    parser.StartElementHandler = element
    parser.StartDoctypeDeclHandler = document_type
    with suppress(expat.ExpatError):  # appended bytes are no XML
        parser.Parse(head, False)
    return found[0] if found and found[0] else None


def _check_file(path: Path, request: Request, depth: int) -> None:
    """Refuse, before VTK reads it, a file that names others elsewhere, or promises more than it can hold."""
    with path.open("rb") as file:
        content = file.read(HEAD_BYTES)
        kind = _kind_of_xml(content) if content.lstrip().startswith(b"<") else ""
        if kind is None:
            raise ValueError(f"{path.name} does not begin as VTK's files do")
        if kind in ("", "RectilinearGrid", "StructuredGrid", "UnstructuredGrid", "PolyData", "ImageData"):
            check_promises(content, path)
            return
        content += file.read()
    if depth == 0:
        raise FileError(f"files name each other {MAX_DEPTH} deep; open one of the pieces: {request.path}")
    for element in parsed(content).iter():
        for key in ("Source", "file"):
            if (name := element.get(key)) is None:
                continue
            check_named_file(name, path, anywhere=request.external_files, within=request.within)
            piece = path.parent / name
            if not piece.exists():
                raise FileError(f"the file names {name!r}, which is not there; copy it too: {path}")
            _check_file(piece, request, depth - 1)


def check_promises(head: bytes, path: Path) -> None:
    """Refuse a header with more points or cells than its file can hold, however packed."""
    counts = [int(number) for match in COUNTS.findall(head) for number in match if number]
    for match in EXTENTS.findall(head):
        numbers = [int(number) for number in (match[0] or match[1]).split()]
        sides = numbers if len(numbers) == 3 else [b - a + 1 for a, b in zip(numbers[::2], numbers[1::2], strict=False)]
        counts.append(size_checks.n_bytes(sides, np.dtype("u1")))
    stored, is_packed = path.stat().st_size, head.lstrip().startswith(b"<")
    for count in counts:
        ratio = size_checks.DEFLATE_RATIO if is_packed else 1
        size_checks.check_stored([count], np.dtype("u1"), stored, path, ratio=ratio)


def loaded(path: Path) -> Any:
    """The data object of a file that was checked, by VTK."""
    with path.open("rb") as file:
        is_xml = file.read(HEAD_BYTES).lstrip().startswith(b"<")
    if is_xml:
        reader = library("vtkmodules.vtkIOXML", extra=EXTRA).vtkXMLGenericDataObjectReader()
    else:
        check_whole(path)
        reader = library("vtkmodules.vtkIOLegacy", extra=EXTRA).vtkGenericDataObjectReader()
        # All arrays are read, not the first of each kind alone.
        for kind in ("Scalars", "Vectors", "Tensors", "Fields", "Normals", "TCoords"):
            getattr(reader, f"ReadAll{kind}On")()
    reader.SetFileName(str(path))
    with _messages_of_vtk() as messages:
        reader.Update()
    data = reader.GetOutputDataObject(0)
    if is_xml and data is not None and data.IsA("vtkImageData") and (turned := _direction_of(path)):
        data.SetDirectionMatrix(turned)
    if data is None or any("ERR" in line for line in messages):
        # Behind "ERROR: In FILE, line N" VTK says what is wrong, and which of its objects found it.
        reasons = [line.partition("): ")[2].strip(" .") for line in messages if "): " in line]
        reason = f": {reasons[0][:MAX_LETTERS]}" if reasons else ""
        raise FileError(
            f"VTK cannot read the file{reason}; it is truncated, damaged or of an old form: copy it again, or save it "
            f"anew with ParaView: {path}"
        )
    return data


def _direction_of(path: Path) -> list[float] | None:
    """The directions of the axes of an image in several files, which VTK reads of none of them."""
    with path.open("rb") as file:
        if _kind_of_xml(head := file.read(HEAD_BYTES)) != "PImageData":
            return None
        whole = parsed(head + file.read())
    found = {tuple(_numbers(one.get("Direction"))) for one in whole.iter("PImageData") if one.get("Direction")}
    for piece in whole.iter("Piece"):
        with (path.parent / piece.get("Source", "")).open("rb") as file:
            named = DIRECTION.search(file.read(HEAD_BYTES))
        found.add(tuple(_numbers(named[1].decode("ascii", "replace"))) if named else (1.0, 0, 0, 0, 1.0, 0, 0, 0, 1.0))
    if len(found) > 1:
        raise FileError(f"its pieces have axes in {len(found)} different directions; write them alike: {path}")
    return list(found.pop()) if found else None


def _numbers(text: str | None) -> list[float]:
    numbers = [float(word) for word in (text or "").split()]
    if len(numbers) != 9:
        raise ValueError(f"a Direction of {len(numbers)} numbers")
    return numbers


@contextmanager
def _messages_of_vtk() -> Iterator[list[str]]:
    """The lines that VTK would write to the standard error stream meanwhile: inner readers report nowhere else."""
    core = library("vtkmodules.vtkCommonCore", extra=EXTRA)
    messages: list[str] = []
    with _WINDOW:
        window, before = core.vtkStringOutputWindow(), core.vtkOutputWindow.GetInstance()
        core.vtkOutputWindow.SetInstance(window)
        try:
            with muted_stderr():
                yield messages
        finally:
            core.vtkOutputWindow.SetInstance(before)
            messages += window.GetOutput().splitlines()


def _blocks(data: Any) -> Iterator[Any]:
    """The grids that a data object is made of."""
    if not data.IsA("vtkCompositeDataSet"):
        yield data
        return
    iterator = data.NewIterator()
    iterator.InitTraversal()
    while not iterator.IsDoneWithTraversal():
        block = iterator.GetCurrentDataObject()
        if block is not None and block.IsA("vtkDataSet"):
            yield block
        iterator.GoToNextItem()


@dataclass(frozen=True)
class _Array:
    """An array of points or cells, and the blocks that have it."""

    name: str
    of_cells: bool

    def numbers_of(self, block: Any) -> NDArray[Any] | None:
        """The numbers, [point or cell, component]; None of a block that does not have them."""
        from vtkmodules.util.numpy_support import vtk_to_numpy

        array = (block.GetCellData() if self.of_cells else block.GetPointData()).GetArray(self.name)
        if array is None:
            return None
        numbers: NDArray[Any] = vtk_to_numpy(array)
        return numbers.reshape(len(numbers), -1)


def _arrays_of(blocks: list[Any]) -> dict[str, _Array]:
    """The arrays of grids by the names that choose them."""
    found: list[_Array] = []
    for block in blocks:
        for part, of_cells in ((block.GetPointData(), False), (block.GetCellData(), True)):
            for number in range(part.GetNumberOfArrays()):
                array = part.GetArray(number)
                if array is not None and array.GetName() not in (None, GHOSTS):
                    found.append(_Array(str(array.GetName()), of_cells))
    arrays = list(dict.fromkeys(found))
    of_points = {array.name for array in arrays if not array.of_cells}
    return {
        f"{array.name} of cells" if array.of_cells and array.name in of_points else array.name: array
        for array in arrays
    }


def _chosen(blocks: list[Any], request: Request) -> tuple[_Array, tuple[str, ...]]:
    """The array that is asked for, else the active scalars of the only block, else the first; and what was guessed."""
    arrays = _arrays_of(blocks)
    parts = [blocks[0].GetPointData(), blocks[0].GetCellData()] if len(blocks) == 1 else []
    active = [str(scalars.GetName()) for part in parts if (scalars := part.GetScalars()) is not None]
    sizes = [
        next(n.shape[1] for block in blocks if (n := one.numbers_of(block)) is not None) for one in arrays.values()
    ]
    number, guessed = chosen(list(arrays), active, sizes, request)
    return list(arrays.values())[number], guessed


def _with_guesses(grid: Grid, guesses: tuple[str, ...]) -> Grid:
    return grid._replace(facts=replace(grid.facts, guesses=(*guesses, *grid.facts.guesses)))


def _as_it_is(grid: Any, array: _Array, matrix: NDArray[np.float64], request: Request) -> Grid:
    """The samples of a uniform grid."""
    numbers = array.numbers_of(grid)
    if numbers is None:
        raise ValueError("no such array")
    # A layer of points counts as one of cells.
    nx, ny, nz = (max(n - 1, 1) if array.of_cells else n for n in n_points(grid))
    samples, guesses = component_of(numbers.reshape(nz, ny, nx, -1), request, array.name)
    quantity = quantity_of_array(array.name, numbers.shape[-1], numbers.dtype, request)
    of_points, of_cells = _ghosts_of(grid)
    samples, hidden = without_hidden(np.array(samples), of_points, of_cells, are_cells=array.of_cells)
    # Rows of images grow downwards, in one file or several.
    conventions = () if grid.IsA("vtkImageData") else (UPRIGHT,)
    colors = facts_of_colors(numbers.shape[-1], numbers.dtype, request)
    return Grid(samples, matrix, Facts(quantity=quantity, conventions=conventions, guesses=guesses + hidden, **colors))


def _ghosts_of(grid: Any) -> tuple[NDArray[Any] | None, NDArray[Any] | None]:
    """The ghost types of the points and of the cells of a uniform grid, [z, y, x]; None where it has none."""
    nx, ny, nz = n_points(grid)
    points, cells = (_Array(GHOSTS, of_cells=of_cells).numbers_of(grid) for of_cells in (False, True))
    return (
        None if points is None else points.reshape(nz, ny, nx),
        None if cells is None else cells.reshape(max(nz - 1, 1), max(ny - 1, 1), max(nx - 1, 1)),
    )


def _which_level(data: Any, boxes: list[Box], request: Request) -> FileError:
    """The error that asks for a level of an adaptive mesh."""
    sizes = sizes_of(boxes)
    levels = ", ".join(f"{level}: {' x '.join(map(str, sizes[level]))}" for level in sorted(sizes))
    return FileError(
        f"the file holds {described_grid(data.GetClassName())}, with samples x, y, z at the spacing of level {levels}; "
        f"resample=N (--resample N) takes the finest of at most N along its longest side, such as "
        f"{max(size.max() for size in sizes.values())}: {request.path}"
    )


def _of_level(data: Any, boxes: list[Box], array: _Array, request: Request) -> Grid:
    """The samples of an adaptive mesh on the grid of one of its levels."""
    first = next(numbers for box in boxes if (numbers := array.numbers_of(box.grid)) is not None)
    _, guesses = component_of(first[:1], request, array.name)

    def sampled(part: int | None) -> tuple[NDArray[Any], NDArray[np.float64], str]:
        """Samples of one component, or, for None, of the component or length that the request asks for."""

        def values_of(grid: Any) -> NDArray[Any] | None:
            numbers = array.numbers_of(grid)
            if numbers is None:
                return None
            return numbers[:, part] if part is not None else np.asarray(component_of(numbers, request, array.name)[0])

        return on_one_grid(boxes, values_of, request)

    n = first.shape[1]
    if is_length(n, first.dtype, request):
        parts = [sampled(part) for part in range(n)]
        samples, (_, matrix, how) = length_of([part[0] for part in parts]), parts[0]
    else:
        samples, matrix, how = sampled(None)
    guesses = (f"{described_grid(data.GetClassName())}, {how}", *guesses)
    quantity = quantity_of_array(array.name, n, first.dtype, request)
    return Grid(samples, matrix, Facts(quantity=quantity, conventions=(UPRIGHT,), guesses=guesses))


def _resampled(data: Any, blocks: list[Any], array: _Array, request: Request) -> Grid:
    """The samples of an image that covers the grid."""
    guesses: tuple[str, ...] = ()
    quantity: str | None = None
    values: list[NDArray[Any] | None] = []
    are_lengths = False
    for block in blocks:
        numbers = array.numbers_of(block)
        if numbers is not None:
            quantity = quantity_of_array(array.name, numbers.shape[-1], numbers.dtype, request)
            are_lengths = is_length(numbers.shape[-1], numbers.dtype, request)
            part, guesses = component_of(numbers, request, array.name)
            # Vectors are interpolated before their length is taken: lengths between samples would be too large.
            numbers = numbers if are_lengths else part
        values.append(numbers)
    there = [one for one in values if one is not None]
    dtype = type_of_samples(there)
    having = [(block, one) for block, one in zip(blocks, values, strict=True) if one is not None]
    for block, one in having:
        set_only_array(block, one.astype(dtype), of_cells=array.of_cells)
    sampled_data = data
    if len(having) < len(blocks):
        sampled_data = _together([block for block, _ in having])
        guesses += (f"blocks without {array.name!r}, which are left out: {len(blocks) - len(having)} of {len(blocks)}",)
    samples, matrix, sampled = sampled_on_image(sampled_data, [block for block, _ in having], request)
    samples = length_of([*np.moveaxis(samples, -1, 0)]) if are_lengths else samples[..., 0]
    what = f"{described_grid(data.GetClassName())}, {sampled}"
    of_cells = (f"{array.name!r} is of cells, and constant in each",) if array.of_cells else ()
    return Grid(samples, matrix, Facts(quantity=quantity, conventions=(UPRIGHT,), guesses=(what, *of_cells, *guesses)))


def _together(blocks: list[Any]) -> Any:
    """Grids as blocks of one data object."""
    from vtkmodules.vtkCommonDataModel import vtkMultiBlockDataSet

    whole = vtkMultiBlockDataSet()
    for number, block in enumerate(blocks):
        whole.SetBlock(number, block)
    return whole
