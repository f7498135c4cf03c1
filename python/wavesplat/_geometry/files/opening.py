"""`wavesplat.open_geometry`: surfaces, lines and points in files, each by the module for its format."""

from __future__ import annotations

import os
import re
from collections.abc import Callable
from dataclasses import fields
from os import PathLike
from pathlib import Path
from typing import Any, Literal, get_args

import numpy as np

from wavesplat._geometry.files import brain_surfaces, meshes, neurons_and_tracts, poly_data, tables
from wavesplat._geometry.files import neurons_and_tracts as tract_files
from wavesplat._geometry.files.read_shape import Asked, ReadShape
from wavesplat._geometry.lines import Lines
from wavesplat._geometry.points import Points
from wavesplat._geometry.shape import Shape, is_one
from wavesplat._geometry.surface import Surface
from wavesplat._model.arguments.types import takes_its_types
from wavesplat._model.volume import sources, units
from wavesplat._model.volume.facts import quantity_of
from wavesplat._public import public
from wavesplat._readers.request import NAMED_WITHIN
from wavesplat._storage.paths import check_within, expanded
from wavesplat._storage.reading import reading
from wavesplat._storage.size_checks import check_readable
from wavesplat._system.values import described
from wavesplat.errors import ArgumentError, FileError

TYPES: dict[str, type[Shape]] = {"surface": Surface, "lines": Lines, "points": Points}
Kind = Literal["surface", "lines", "points"]

#: Suffix -> what files of it are called in messages, and their reader.
READERS: dict[str, tuple[str, Callable[[Asked], ReadShape]]] = {
    **dict.fromkeys(meshes.SUFFIXES, ("a mesh", meshes.read)),
    **dict.fromkeys(tract_files.SUFFIXES, ("tracts", tract_files.read_tracts)),
    **dict.fromkeys(poly_data.SUFFIXES, ("a mesh of VTK", poly_data.read)),
    **dict.fromkeys(tables.SUFFIXES, ("a table of points", tables.read)),
    ".gii": ("a surface (GIfTI)", brain_surfaces.read_gifti),
    ".swc": ("a neuron (SWC)", neurons_and_tracts.read_neuron),
}
OF_FREESURFER = ("a surface of FreeSurfer", brain_surfaces.read_freesurfer)
SUFFIXES = tuple(READERS)
#: Advice on rows of a neuron, which are text: the message names the fault, and no bytes need be missing.
OF_NEURONS = "mend the rows, or export the neuron again"
#: Parts of file names that say nothing of the values, and known names of values; others may be a patient's name.
OF_BRAINS = re.compile(r"^[lr]h\.|(\.(shape|func|gii|txt))+$")
MEASURES = {"area", "area.mid", "area.pial", "curv", "curv.pial", "jacobian_white", "sulc", "thickness", "volume"}


@public
@takes_its_types
def open_geometry(
    path: str | PathLike[str],
    *,
    kind: str | None = None,
    values: str | None = None,
    unit: str | None = None,
    world_unit: str | None = None,
    **look: Any,
) -> Surface | Lines | Points:
    r"""A surface, lines or points of a file, in world coordinates.

    Parameters
    ----------
    path : path
        `.stl`, `.ply`, `.obj`, `.off`, `.glb`, `.gltf`, `.3mf`; `.vtp`, `.vtk`, `.vtu`; `.gii`, and FreeSurfer's
        surfaces (`lh.pial`), which are moved by their header's c_ras into the scanner's world; tracts in `.trk` and
        `.tck`; neurons in `.swc`; tables of points and tracks in `.csv`, `.tsv` and `.parquet`, whose columns are known
        by name: x, y, z, x_um, POSITION_X (TrackMate), axis-0 (napari), and TRACK_ID, frame, radius and name.
    kind : str, optional
        "surface", "lines" or "points", where a file may be taken as several: the spots of tracks, say. None is what the
        file holds.
    values : str, optional
        What is coloured: a column of a table, an array of a VTK or PLY file, of tracts one of their numbers; of brain
        surfaces another file (`lh.thickness`, `.annot`, `.shape.gii`).
    unit : str, optional
        Unit of the positions, such as "um", where the file does not say it.
    world_unit : str, optional
        Unit of the volumes' world, to which positions are brought where both units are known.
    **look
        Fields of `Surface`, `Lines` or `Points`: `color`, `cmap`, `opacity`, `radius` and others.

    Returns
    -------
    Surface, Lines or Points
        `guesses` says what was assumed where the file says nothing, and what was done to its numbers.

    Raises
    ------
    FileError
        If the file is missing, damaged or of no known kind.
    ArgumentError
        If it has no such values, or a field cannot work.
    LibraryError
        If the library for its format is not installed (`pip install "wavesplat[geometry]"`).

    Examples
    --------
    >>> import wavesplat as ws
    >>> from pathlib import Path
    >>> _ = Path("cells.csv").write_text("x_um,y_um,z_um,speed\n1,2,3,0.5\n4,5,6,0.7\n")
    >>> ws.open_geometry("cells.csv", values="speed", world_unit="mm", size=8).positions.round(6).tolist()
    [[0.001, 0.002, 0.003], [0.004, 0.005, 0.006]]
    """
    place = expanded(path)
    if kind is not None and kind not in get_args(Kind):
        raise ArgumentError(f"kind is {described(kind)}; use one of: {', '.join(get_args(Kind))}, or None")
    given, world = units.checked(unit), units.checked(world_unit)
    within = NAMED_WITHIN.get()
    check_within(place, within)
    check_readable(place)
    what, read = _reader_of(place)
    try:
        with reading(what, path, other_form=OF_NEURONS if place.suffix.lower() == ".swc" else None):
            found = read(Asked(place, values, kind, within))
    except FileError as error:
        raise (error if str(error).endswith(str(path)) else FileError(f"{error}: {path}")) from error.__cause__
    if kind is not None and kind != found.kind:
        raise FileError(
            f"the file holds {_plural(found.kind)}, and {_plural(kind)} is asked for; leave out kind: {path}"
        )
    if values is not None and found.fields.get("values") is not None:
        found.fields.setdefault("quantity", quantity_of(_name_of_values(values, found)))
    own = given or found.unit
    if given is not None and found.unit is not None and given != found.unit:
        raise ArgumentError(f"unit is {unit!r}, and the file's own is {found.unit!r}; leave it out: {path}")
    factor = units.factor(own, world)
    shape: Any = _made(found, factor or 1.0, look, str(path))
    guesses = list(found.guesses)
    if factor is None:
        unknown = own if units.metres(own) is None else world
        guesses.append(
            f"positions in {own!r} are taken in {world!r}, the volume's unit, as their numbers are: the size of "
            f"{unknown!r} is unknown; give unit="
        )
    if own is None and world is not None:
        guesses.append(f"positions are taken in {units.written(world)}, the volume's unit: the file names none")
    options = {"kind": found.kind, "values": values, "unit": unit, "world_unit": world_unit}
    if values is not None and found.values_from is not None:
        options["values"] = os.path.relpath(found.values_from, place.absolute().parent)
    source = sources.of_file(path, {name: value for name, value in options.items() if value is not None})
    source = source if all(is_one(*given) for given in look.items()) else None
    shape._set(guesses=tuple(guesses), _source=source)
    return shape  # type: ignore[no-any-return]


def _reader_of(path: Path) -> tuple[str, Callable[[Asked], ReadShape]]:
    """Name of the kind of a file, and its reader; by its suffix, of FreeSurfer's surfaces by their first bytes."""
    if path.is_dir():
        raise FileError(f"this is a folder; name the file of a surface, of lines or of points: {path}")
    if brain_surfaces.is_freesurfer(path):
        return OF_FREESURFER
    found = READERS.get(path.suffix.lower())
    if found is None:
        raise FileError(
            f"the suffix {path.suffix!r} is unknown; surfaces, lines and points are read from {', '.join(SUFFIXES)} "
            f"and FreeSurfer's surfaces: {path}"
        )
    return found


def _name_of_values(values: str, found: ReadShape) -> str | None:
    """The name of the values of vertices: of their array or column, of a file of FreeSurfer its measure."""
    if found.values_from is None:
        return values
    name = OF_BRAINS.sub("", found.values_from.name)
    return name if name in MEASURES else None


def _plural(kind: str) -> str:
    return {"surface": "a surface", "lines": "lines", "points": "points"}[kind]


def _made(found: ReadShape, factor: float, look: dict[str, Any], path: str) -> Any:
    """The shape of what was read, its lengths multiplied by a factor; fields of the look count more."""
    kind = TYPES[found.kind]
    known = [field.name for field in fields(kind)]  # type: ignore[arg-type]
    for name in look:
        if name not in known:
            raise ArgumentError(f"{_plural(found.kind)} has no {name!r}; it has {', '.join(known)}: {path}")
    own = _without_what_is_given(found.fields, look)
    for name in ("vertices", "positions", "radius"):
        if name in own:
            own[name] = np.asarray(own[name]) * factor
    if "paths" in own:
        own["paths"] = [np.asarray(path) * factor for path in own["paths"]]
    if "radius" in own and found.kind == "lines":
        own["radius"] = float(own["radius"])
    try:
        return kind(**own | look)
    except ArgumentError as error:
        raise ArgumentError(f"{error}: {path}") from None


def _without_what_is_given(own: dict[str, Any], look: dict[str, Any]) -> dict[str, Any]:
    """Fields of a file, but for colours and sizes that the look has."""
    dropped = {name for name, value in own.items() if value is None}
    if look.get("color") is not None:
        dropped |= {"color", "values", "quantity", "value_unit"}
    if own.get("values") is not None and "values" not in dropped:
        dropped.add("color")
    if any(look.get(name) is not None for name in ("radius", "size", "width")):
        dropped.add("radius")
    return {name: value for name, value in own.items() if name not in dropped}
