"""Geometry of scenes as JSON: a list of objects of one field, the kind of shape.

    [{"surface": {"file": {"path": "lh.pial", "values": "lh.thickness"}, "cmap": "viridis", "clim": [1, 4]}},
     {"points": {"positions": [[0, 0, 0], [1, 2, 3]], "radius": 2, "color": [1, 0, 0, 1], "labels": ["A1", "A2"]}},
     {"slice_plane": {"plane": "axial", "window": "soft-tissue"}},
     {"frame": {"grid": true}}]

A shape of a file is named by it and the options that it was opened with; others are written out where they are small.
Only fields that differ from the defaults are written.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import MISSING, fields
from typing import Any

import numpy as np

from wavesplat._geometry.frame import Frame
from wavesplat._geometry.lines import Lines
from wavesplat._geometry.points import Points
from wavesplat._geometry.positions import Chains
from wavesplat._geometry.shape import Shape
from wavesplat._geometry.slice_plane import SlicePlane
from wavesplat._geometry.surface import Surface
from wavesplat._readers.request import named_within
from wavesplat._scene.documents.named_volumes import Reach, made_at, volume_named
from wavesplat.errors import ArgumentError, FileError

TYPES: dict[str, type[Shape]] = {
    "surface": Surface,
    "lines": Lines,
    "points": Points,
    "slice_plane": SlicePlane,
    "frame": Frame,
}
NAMES = {kind: name for name, kind in TYPES.items()}
#: Largest number of numbers of a shape that is written out.
MAX_INLINE = 2000


# Writing


def fields_of(geometry: Sequence[Shape], *, strict: bool) -> list[dict[str, Any]]:
    """Shapes as JSON, paths absolute.

    strict : raise an `ArgumentError` for large shapes, and volumes, that come from no file; else their path is null.
    """
    return [{NAMES[type(shape)]: _fields(shape, strict)} for shape in geometry]


def _fields(shape: Shape, strict: bool) -> dict[str, Any]:
    given = {
        field.name: getattr(shape, field.name)
        for field in fields(shape)  # type: ignore[arg-type]
        if field.init and not _is_default(getattr(shape, field.name), field.default)
    }
    if isinstance(shape, SlicePlane):
        return _with_volume(shape, given, strict)
    if shape._source is not None:
        look = {name: value for name, value in given.items() if name not in shape.OF_FILE}
        return {"file": shape._source, **{name: _plain(value) for name, value in look.items() if _is_small(value)}}
    n = sum(_count(value) for value in given.values())
    if n <= MAX_INLINE:
        return {name: _plain(value) for name, value in given.items()}
    if strict:
        raise ArgumentError(
            f"{shape._title} has {n} numbers and comes from no file, and a document holds at most {MAX_INLINE}; "
            "write it to a file (a surface as .ply, points as .csv), and open the file with wavesplat.open_geometry"
        )
    return {"file": {"path": None}, **({} if shape.name is None else {"name": shape.name})}


def _with_volume(plane: SlicePlane, given: dict[str, Any], strict: bool) -> dict[str, Any]:
    """Fields of a slice, its volume by its source."""
    volume = given.pop("volume", None)
    found = {name: _plain(value) for name, value in given.items()}
    if not isinstance(plane.plane, str):
        point, normal = plane.plane
        found["plane"] = {"point": list(point), "normal": list(normal)}
    if volume is None:
        return found
    if volume._source is None and strict:
        raise ArgumentError(
            f"the volume of {plane._title}, {volume.name!r}, comes from no file, so a document cannot name it; "
            "leave it out to cut the first layer's, or write it to a file and open that"
        )
    return {"volume": volume._source or {"path": None, "name": volume.name}, **found}


def _is_default(value: Any, default: Any) -> bool:
    if default is MISSING or isinstance(value, np.ndarray | Chains):
        return False
    return value is default or (type(value) is type(default) and bool(value == default))


def _is_small(value: Any) -> bool:
    """Whether a value is one for all of a shape; values for each of its parts come from its file."""
    return not isinstance(value, np.ndarray | Chains)


def _count(value: Any) -> int:
    if isinstance(value, Chains):
        return value.positions.size
    if isinstance(value, np.ndarray):
        return value.size
    return len(value) if isinstance(value, tuple) else 1


def _plain(value: Any) -> Any:
    """A value as JSON has it; values that are NaN, which JSON lacks, are null."""
    if isinstance(value, Chains):
        return [path.tolist() for path in value]
    if isinstance(value, np.ndarray):
        return _without_nan(value.tolist())
    if isinstance(value, tuple):
        return [_plain(part) for part in value]
    return value


def _without_nan(value: Any) -> Any:
    if isinstance(value, list):
        return [_without_nan(part) for part in value]
    return None if value != value else value  # noqa: PLR0124 - NaN alone differs from itself


# Reading


def shapes_of(geometry: list[Any], what: str, reach: Reach) -> list[Shape]:
    """The shapes that a document describes; files of shapes are opened. `what`: the place there, for messages."""
    return [_shape(one, f"{what}[{number}]", reach) for number, one in enumerate(geometry)]


def _shape(given: dict[str, Any], what: str, reach: Reach) -> Shape:
    ((name, own),) = given.items()
    kind, what = TYPES[name], f"{what}.{name}"
    arguments = {key: _tuples(value) if key in ("clim", "window") else value for key, value in own.items()}
    if "file" in own:
        del arguments["file"]
        return _opened(own["file"], arguments, (name, what), reach)
    if kind is SlicePlane:
        arguments = _of_slice(arguments, what, reach)
    elif isinstance(arguments.get("values"), list):
        arguments["values"] = [float("nan") if value is None else value for value in arguments["values"]]
    made: Shape = made_at(what, lambda: kind(**arguments))
    return made


def _opened(file: Any, look: dict[str, Any], place: tuple[str, str], reach: Reach) -> Shape:
    """The shape of a file. `place`: its kind, and where it stands in the document."""
    name, what = place
    what = f"{what}.file"
    if file["path"] is None:
        raise ArgumentError(
            f"{what} came from no file when this was written; write its shape to one, and make the scene anew"
        )
    from wavesplat._geometry.files.opening import open_geometry

    within = reach.of_name(file["path"])
    options = within.options(dict(file), what)
    path = options.pop("path")
    options.setdefault("kind", name)
    try:
        with named_within(within.within):
            return made_at(what, lambda: open_geometry(path, **options, **look))
    except FileError:
        reach.check_there(file["path"], what)
        raise


def _of_slice(arguments: dict[str, Any], what: str, reach: Reach) -> dict[str, Any]:
    plane = arguments.get("plane")
    if isinstance(plane, dict):
        arguments["plane"] = (plane["point"], plane["normal"])
    if arguments.get("volume") is not None:
        arguments["volume"] = volume_named(arguments["volume"], f"{what}.volume", reach)
    return arguments


def _tuples(value: Any) -> Any:
    return tuple(value) if isinstance(value, list) else value
