"""Options of what stands in space with the volume: surfaces, lines, points, slices, a frame.

`--surface FILE[:WORD]...`: the words behind the file may come in any order, each known by its form: a colour, a colour
map, LOW,HIGH, an opacity 0..1, a size with its unit, values=NAME.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar

from wavesplat._cli.options.groups import option
from wavesplat._cli.options.layers import named_file, without_window
from wavesplat._cli.options.parsers import Length, length_in
from wavesplat._cli.printing import message
from wavesplat.errors import ArgumentError

if TYPE_CHECKING:
    from wavesplat._geometry.shape import Shape

LOOK = "[:COLOR|MAP][:LOW,HIGH][:OPACITY][:values=NAME]"
SURFACE = f"FILE{LOOK}[:flat]"
LINES = f"FILE{LOOK}[:by-direction][:Npx|Nmm]"
POINTS = f"FILE{LOOK}[:Npx|Nmm]"
SLICE_PLANE = "PLANE[:INDEX|:POSITIONmm][:WINDOW|:MAP][:LOW,HIGH][:OPACITY]"
#: Word of the command line -> colour of `Lines`.
BY_DIRECTION = {"by-direction": "direction", "direction": "direction"}


@dataclass(repr=False)
class GeometryOptions:
    """Surfaces, lines, points, slices that stand in space, and a frame."""

    TITLE: ClassVar = "Geometry"

    surface: list[str] | None = option(
        SURFACE,
        "A surface in the picture, such as liver.stl:red:0.5, of .stl, .ply, .obj, .glb, .vtp, .gii or FreeSurfer; "
        "values=NAME colours it by values, a brain by the values of another file. May be repeated.",
    )
    lines: list[str] | None = option(
        LINES,
        "Lines in the picture, such as tracts.trk:by-direction, of .trk, .tck, .vtp, .swc, or tracks of .csv. May be "
        "repeated.",
    )
    points: list[str] | None = option(
        POINTS,
        "Points in the picture, such as cells.csv:yellow:2um: balls of this radius, or discs of 6px. Columns are known "
        "by name. May be repeated.",
    )
    slice_plane: list[str] | None = option(
        SLICE_PLANE,
        "A slice that stands in the picture: axial, coronal, sagittal, xy, xz or yz, through the middle, or as "
        "axial:12 the slice of this number, axial:-35mm the one at this place; cuts: on every face that --clip, "
        "--crop and --cut-out cut. May be repeated.",
    )
    frame: bool = option(help="A box with ticks and numbers around the volume.", default=False)
    grid: bool = option(help="The frame, with lines on the sides behind.", default=False)


def opened_geometry(options: GeometryOptions, unit: str | None, *, quiet: bool) -> list[Shape]:
    """The shapes that the options ask for. `unit`: of the volume's world."""
    from wavesplat._geometry.frame import Frame

    made: list[Shape] = []
    asked = [
        *[("surface", text) for text in options.surface or ()],
        *[("lines", text) for text in options.lines or ()],
        *[("points", text) for text in options.points or ()],
    ]
    for kind, text in asked:
        from wavesplat._geometry.files.opening import open_geometry

        path, look = _of_file(kind, text, unit)
        shape: Any = open_geometry(path, kind=kind, world_unit=unit, **look)
        for guess in () if quiet else shape.guesses:
            message(f"note: {path}: {guess}")
        made.append(shape)
    made += [_slice_plane(text, unit) for text in options.slice_plane or ()]
    if options.frame or options.grid:
        made.append(Frame(grid=options.grid))
    return made


def _of_file(kind: str, text: str, unit: str | None) -> tuple[str, dict[str, Any]]:
    """The file of an option, and the look in the words behind it."""
    syntax, example = {
        "surface": (SURFACE, "liver.stl:red:0.5"),
        "lines": (LINES, "tracts.trk:by-direction"),
        "points": (POINTS, "cells.csv:yellow:2um"),
    }[kind]
    path, rest = named_file(text, f"--{kind}", syntax, example)
    words = rest.split(":") if rest else []
    return path, _look(words, kind, f"--{kind} {text!r}", syntax, unit)


def _look(words: Sequence[str], kind: str, what: str, syntax: str, unit: str | None) -> dict[str, Any]:
    look: dict[str, Any] = {}
    for word in words:
        found = _meaning(word, kind, what, unit)
        if found is None:
            raise ArgumentError(f"{what} has {word!r}, which is no colour, colour map, opacity or size; it is {syntax}")
        name, value = found
        if name in look:
            raise ArgumentError(f"{what} says its {name} twice, the second time as {word!r}; it is {syntax}")
        look[name] = value
    if "cmap" in look and "values" not in look and kind != "slice-plane":
        raise ArgumentError(
            f"{what} has a colour map and no values; say which, as values=NAME: a column of a table, an array of a mesh"
        )
    return look


def _meaning(word: str, kind: str, what: str, unit: str | None) -> tuple[str, Any] | None:
    """The field of a shape that a word stands for, and its value; None where it is none."""
    if word.startswith("values="):
        return "values", word.removeprefix("values=")
    if kind == "surface" and word in ("flat", "smooth"):
        return "normals", word
    if kind == "lines" and word in BY_DIRECTION:
        return "color", BY_DIRECTION[word]
    length = length_in(word)
    if length is not None and length.unit is None:
        if not 0 <= length.number <= 1:
            raise ArgumentError(
                f"{what} has {word!r}: an opacity is 0..1, and a size has a unit, as {word}px or {word}mm"
            )
        return "opacity", length.number
    if length is not None and kind in ("lines", "points"):
        return _size(length, kind, what, unit)
    return _color(word, what)


def _size(length: Length, kind: str, what: str, unit: str | None) -> tuple[str, Any]:
    """A radius in the world's unit, or a size in pixels."""
    if str(length.unit).lower() in ("px", "pixel", "pixels"):
        return ("width" if kind == "lines" else "size"), length.number
    return "radius", length.in_world(unit, f"{what}: the size", "give a size in px")


def _color(word: str, what: str) -> tuple[str, Any] | None:
    """A window, a colour or a colour map."""
    from wavesplat._looks.curves import colormaps, colors

    rest, window = without_window(f":{word}", what)
    if window is not None and not rest:
        return "clim", window
    try:
        if colors.parse(word) is not None:
            return "color", word
    except ArgumentError:
        pass
    try:
        colormaps.colors_of(word)
    except ArgumentError:
        return None
    return "cmap", word


def _slice_plane(text: str, unit: str | None) -> Shape:
    """The slice of a `--slice-plane`."""
    from wavesplat._geometry.slice_plane import SlicePlane
    from wavesplat._model.volume import units
    from wavesplat._render.windows import CT_WINDOWS

    what = f"--slice-plane {text!r}"
    plane, *words = text.split(":")
    place: dict[str, Any] = {}
    length = length_in(words[0]) if words else None
    if length is not None and length.unit is not None:
        words.pop(0)
        has_unit = units.metres(unit) is not None
        place["position"] = length.in_world(unit, f"{what}: the position") if has_unit else length.number
    elif length is not None and words[0].lstrip("-").isdecimal():
        place["index"] = int(words.pop(0))
    window = {"window": words.pop(0)} if words and words[0] in CT_WINDOWS else {}
    look = window | _look(words, "slice-plane", what, SLICE_PLANE, unit)
    for name in ("color", "values"):
        if name in look:
            raise ArgumentError(f"{what} has a {name}; a slice has a colour map; it is {SLICE_PLANE}")
    return SlicePlane(None, plane, **place, **look)
