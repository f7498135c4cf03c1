"""VTK's lists of files, one for each time: ParaView's collections (.pvd) and series (.vtu.series, .vtk.series, ...).

Formats: https://www.paraview.org/Wiki/ParaView/Data_formats#PVD_File_Format, and for series
https://discourse.paraview.org/t/file-series (JSON: files with name and time).
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import isfinite

from wavesplat._readers.file_contents import Contents
from wavesplat._readers.opening import contents as contents_of_file
from wavesplat._readers.opening import grid_of
from wavesplat._readers.request import Grid, Request, choose
from wavesplat._readers.vtk.vti import parsed
from wavesplat._storage import json_texts
from wavesplat._storage.paths import check_named_file
from wavesplat._storage.reading import reading
from wavesplat._storage.size_checks import check_readable
from wavesplat.errors import ArgumentError, FileError

SUFFIXES = (".pvd", ".series")
#: A list of files has at most this many bytes.
MAX_BYTES = 1 << 26


@dataclass(frozen=True)
class _Listed:
    """The files of a list in the order of their times."""

    names: tuple[str, ...]
    times: tuple[float, ...]


def read(request: Request) -> Grid:
    """The samples of the file of one time, with all times."""
    with reading("a list of VTK's files", request.path):
        listed = _listed(request)
        described = [f"at {time:g}" for time in listed.times]
        number = choose("time", len(listed.names), request.time, request.path, described=described)
        grid = grid_of(_request_of(listed.names[number], request))
        return grid._replace(facts=replace(grid.facts, times=listed.times, n_times=len(listed.times)))


def contents(request: Request) -> Contents | None:
    """The arrays of the first file."""
    with reading("a list of VTK's files", request.path):
        return contents_of_file(_request_of(_listed(request).names[0], request))


def _request_of(name: str, request: Request) -> Request:
    path = request.file.parent / name
    if not path.exists():
        raise FileError(f"the file names {name!r}, which is not there; copy it too: {request.path}")
    return replace(request, path=path, time=None, kept=None)


def _listed(request: Request) -> _Listed:
    path = request.file
    check_readable(path)
    if path.stat().st_size > MAX_BYTES:
        raise FileError(f"a list of more than {MAX_BYTES >> 20} MiB; open one of its files: {request.path}")
    content = path.read_bytes()
    found = _of_xml(content, request) if content.lstrip().startswith(b"<") else _of_json(content)
    if not found:
        raise FileError(f"the list names no file; open the files themselves: {request.path}")
    for _, name in found:
        check_named_file(name, path, anywhere=request.external_files, within=request.within)
        if name.lower().endswith(SUFFIXES):
            raise FileError(f"the list names another list, {name!r}; open that: {request.path}")
    times = [time for time, _ in found]
    if not all(map(isfinite, times)):
        raise ValueError("a time that is not finite")
    if len(set(times)) < len(times):
        raise FileError(
            f"the list names several files at the time {min(t for t in times if times.count(t) > 1):g}, parts of one "
            "grid; for each time, with r = pyvista.get_reader(path), r.set_active_time_value(t), save "
            f"r.read().combine() as .vtu, and list these files in a .pvd: {request.path}"
        )
    found.sort()
    return _Listed(tuple(name for _, name in found), tuple(time for time, _ in found))


def _of_xml(content: bytes, request: Request) -> list[tuple[float, str]]:
    """Time and name of each file of a .pvd; numbers from 0 where it has no times."""
    whole = parsed(content)
    if whole.get("type") != "Collection":
        raise FileError(f"an XML file of another kind than a Collection of files: {request.path}")
    sets = [one for one in whole.iter("DataSet") if one.get("file")]
    return [(float(one.get("timestep") or number), str(one.get("file"))) for number, one in enumerate(sets)]


def _of_json(content: bytes) -> list[tuple[float, str]]:
    try:
        files = json_texts.decode(content, "the list").get("files", [])
    except ArgumentError as error:
        raise ValueError(str(error)) from None
    return [(float(one.get("time", number)), str(one["name"])) for number, one in enumerate(files)]
