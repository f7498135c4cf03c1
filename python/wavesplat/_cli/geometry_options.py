"""Options of what stands in space with the volume: surfaces, lines, points, slices, a frame.

`--surface FILE[:WORD]...`: the words behind the file may come in any order, each known by its form: a colour, a colour
map, LOW,HIGH, an opacity 0..1, a size with its unit, values=NAME.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, Any

import typer

from wavesplat._cli.layer_options import named_file, without_window
from wavesplat._cli.option_groups import with_options_of
from wavesplat._cli.printing import message
from wavesplat.errors import ArgumentError

if TYPE_CHECKING:
    from wavesplat._geometry.shape import Shape

LOOK = "[:COLOR|MAP][:LOW,HIGH][:OPACITY][:values=NAME]"
SURFACE = f"FILE{LOOK}[:flat]"
LINES = f"FILE{LOOK}[:by-direction][:Npx|Nmm]"
POINTS = f"FILE{LOOK}[:Npx|Nmm]"
SLICE_PLANE = "PLANE[:INDEX|:POSITIONmm][:WINDOW|:MAP][:LOW,HIGH][:OPACITY]"
#: A length with its unit, and a size in pixels.
LENGTH = re.compile(r"([\d.]+(?:e[-+]?\d+)?)\s*([A-Za-zµμ]+)")
#: Word of the command line -> colour of `Lines`.
BY_DIRECTION = {"by-direction": "direction", "direction": "direction"}


@dataclass(frozen=True)
class GeometryOptions:
    """Surfaces, lines, points, slices that stand in space, and a frame."""

    surface: Annotated[
        list[str] | None,
        typer.Option(
            metavar=SURFACE,
            help="A surface in the picture, such as liver.stl:red:0.5, of .stl, .ply, .obj, .glb, .vtp, .gii or "
            "FreeSurfer; values=NAME colours it by values, of brains by those of another file. May be repeated.",
        ),
    ] = None
    lines: Annotated[
        list[str] | None,
        typer.Option(
            metavar=LINES,
            help="Lines in the picture, such as tracts.trk:by-direction, of .trk, .tck, .vtp, .swc, or tracks of .csv. "
            "May be repeated.",
        ),
    ] = None
    points: Annotated[
        list[str] | None,
        typer.Option(
            metavar=POINTS,
            help="Points in the picture, such as cells.csv:yellow:2um: balls of this radius, or discs of 6px. Columns "
            "are known by name. May be repeated.",
        ),
    ] = None
    slice_plane: Annotated[
        list[str] | None,
        typer.Option(
            metavar=SLICE_PLANE,
            help="A slice that stands in the picture: axial, coronal, sagittal, xy, xz or yz, through the middle, or "
            "as axial:12 the slice of this number, axial:-35mm the one at this place; cuts: on every face that --clip, "
            "--crop and --cut-out cut. May be repeated.",
        ),
    ] = None
    frame: Annotated[
        bool, typer.Option("--frame", help="A box with ticks and numbers around the volume.", show_default=False)
    ] = False
    grid: Annotated[
        bool, typer.Option("--grid", help="The frame, with lines on the sides behind.", show_default=False)
    ] = False


def takes_geometry_options(command: Callable[..., None]) -> Callable[..., None]:
    """Give a command these options on the command line, in the place of its parameter `showing`."""
    return with_options_of(GeometryOptions, "showing", command)


def opened_geometry(options: GeometryOptions, unit: str | None, *, quiet: bool) -> list[Shape]:
    """The shapes that the options ask for. `unit`: of the volume's world."""
    from wavesplat._geometry.frame import Frame
    from wavesplat._geometry.opening import open_geometry

    made: list[Shape] = []
    asked = [
        *[("surface", text) for text in options.surface or ()],
        *[("lines", text) for text in options.lines or ()],
        *[("points", text) for text in options.points or ()],
    ]
    for kind, text in asked:
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
    if (number := _number(word)) is not None:
        if not 0 <= number <= 1:
            raise ArgumentError(
                f"{what} has {word!r}: an opacity is 0..1, and a size has a unit, as {word}px or {word}mm"
            )
        return "opacity", number
    if (length := LENGTH.fullmatch(word)) is not None and kind in ("lines", "points"):
        return _size(length, kind, what, unit)
    return _color(word, what)


def _size(length: re.Match[str], kind: str, what: str, unit: str | None) -> tuple[str, Any]:
    """A radius in the world's unit, or a size in pixels."""
    from wavesplat._model import units

    number, own = float(length[1]), units.canonical(length[2])
    if length[2].lower() in ("px", "pixel", "pixels"):
        return ("width" if kind == "lines" else "size"), number
    a, b = units.metres(own), units.metres(unit)
    if a is None:
        raise ArgumentError(f"{what} has {length[0]!r}, whose unit is unknown; give px, um, mm or another length")
    if b is None:
        raise ArgumentError(
            f"{what} has a size in {length[2]}, and the volume's file names no unit; give it with --unit, or a size in "
            "px"
        )
    return "radius", float(f"{number * a / b:.12g}")


def _color(word: str, what: str) -> tuple[str, Any] | None:
    """A window, a colour or a colour map."""
    from wavesplat._looks import colormaps, colors

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
    from wavesplat._model import units
    from wavesplat._render.windows import CT_WINDOWS

    what = f"--slice-plane {text!r}"
    plane, *words = text.split(":")
    place: dict[str, Any] = {}
    if words and re.fullmatch(r"-?\d+", words[0]):
        place["index"] = int(words.pop(0))
    elif words and (length := re.fullmatch(r"(-?[\d.]+)\s*([A-Za-zµμ]+)", words[0])) is not None:
        a, b = units.metres(units.canonical(length[2])), units.metres(unit)
        if a is not None:
            place["position"] = float(f"{float(length[1]) * (1 if b is None else a / b):.12g}")
            words.pop(0)
    window = {"window": words.pop(0)} if words and words[0] in CT_WINDOWS else {}
    look = window | _look(words, "slice-plane", what, SLICE_PLANE, unit)
    for name in ("color", "values"):
        if name in look:
            raise ArgumentError(f"{what} has a {name}; a slice has a colour map; it is {SLICE_PLANE}")
    return SlicePlane(None, plane, **place, **look)


def _number(word: str) -> float | None:
    try:
        return float(word)
    except ValueError:
        return None
