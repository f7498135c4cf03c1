"""Parsers of numbers, lengths and names on the command line, and a check of options that exclude each other."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from contextlib import suppress
from math import floor
from pathlib import Path
from typing import NamedTuple

import typer

from wavesplat._model.arguments.sampling import MAX_SIDE_PX
from wavesplat.errors import ArgumentError

#: Slices on one sheet, at most.
MAX_POSITIONS = 400
#: A number, and letters of a unit behind it.
LENGTH = re.compile(r"\s*([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)\s*([A-Za-zµμÅ]*)\s*")


class Length(NamedTuple):
    """A length as it is written: a number, and its unit; None is the unit of the world, or voxels."""

    number: float
    unit: str | None = None

    def in_world(self, unit: str | None, what: str, instead: str = "give it without a unit") -> float:
        """The number in the unit of a world, as its file names it.

        Raises
        ------
        ArgumentError
            If the two units cannot be compared; it names `what` and suggests `instead`.
        """
        from wavesplat._model.volume import units

        own = units.canonical(self.unit)
        if self.unit is None or own == unit:
            return self.number
        size, of_world = units.metres(own), units.metres(unit)
        if size is None:
            raise ArgumentError(f"{what} is {self}, whose unit is unknown; give um, mm or another length, or {instead}")
        if of_world is None:
            known = f"is in {unit}" if unit else "names no unit; give it with --unit"
            raise ArgumentError(f"{what} is {self}, and the volume's file {known}, or {instead}")
        return float(f"{self.number * size / of_world:.12g}")

    def __str__(self) -> str:
        return f"{self.number:g} {self.unit or ''}".rstrip()


def length(text: str) -> Length:
    """A length such as "12", "1.5mm" or "300 um"."""
    found = length_in(text)
    if found is None:
        raise typer.BadParameter(f"{text!r} is not a number or a length, such as 0.7, 1.5mm or 300um")
    return found


def length_in(text: str) -> Length | None:
    """The length that a text is; None for other texts."""
    found = LENGTH.fullmatch(text)
    return None if found is None else Length(float(found[1]), found[2] or None)


def cache_place(text: str | bool) -> str | bool:
    """A folder, or False for "off"; the default, which is parsed too, stays what it is."""
    return False if text == "off" else text


def one_of(names: Sequence[str]) -> Callable[[str], str]:
    """A parser that takes one of these names."""

    def parse(text: str) -> str:
        if text not in names:
            raise typer.BadParameter(f"{text!r} is not one of: {', '.join(names)}")
        return text

    return parse


def size(text: str) -> tuple[int, int]:
    """Width and height of "800x600"; "800" is a square."""
    try:
        parts = [int(part) for part in text.lower().split("x")]
        width, height = parts if len(parts) > 1 else parts * 2
    except ValueError:
        raise typer.BadParameter(f"{text!r} is not WIDTHxHEIGHT, such as 800x600, or 800") from None
    if max(width, height) > MAX_SIDE_PX:
        raise typer.BadParameter(f"{text[:60]!r} is too large; give at most {MAX_SIDE_PX} pixels a side")
    return width, height


def numbers(count: int, example: str) -> Callable[[str], tuple[float, ...]]:
    """A parser that takes `count` numbers; `example` shows how they are written."""

    def parse(text: str) -> tuple[float, ...]:
        try:
            parsed = tuple(float(part) for part in text.split(","))
        except ValueError:
            parsed = ()
        if len(parsed) != count:
            raise typer.BadParameter(f"{text!r} is not {count} numbers with commas between, such as {example}")
        return parsed

    return parse


def ends(example: str) -> Callable[[str], tuple[float | str, ...]]:
    """A parser of the two ends of a window, numbers or percentiles such as 1%; `example` shows how they are written."""

    def parse(text: str) -> tuple[float | str, ...]:
        parts = [part.strip() for part in text.split(",")]
        try:
            numbers_there = [float(part.removesuffix("%")) for part in parts]
        except ValueError:
            numbers_there = []
        if len(numbers_there) != 2:
            raise typer.BadParameter(f"{text!r} is not 2 numbers with commas between, such as {example} or 1%,99.8%")
        return tuple(part if part.endswith("%") else float(part) for part in parts)

    return parse


def positions(text: str) -> int | tuple[Length, ...]:
    """Positions of "10:80:10" (start, stop, step; the stop is the last), of "10mm,20mm,35mm", or their number, "12"."""
    if text.strip().isdecimal():
        return int(text)
    between = ":" if ":" in text else ","
    listed = [found for part in text.split(between) if (found := length_in(part)) is not None]
    n = len(listed)
    if n <= text.count(between) or len({one.unit for one in listed}) > 1 or (between == ":" and n != 3):
        n = 0
    elif between == ":":
        (start, unit), (stop, _), (step, _) = listed
        with suppress(OverflowError, ValueError, ZeroDivisionError):
            n = 0
            n = floor((stop - start) / step * (1 + 1e-9) + 1e-9) + 1
        listed = [Length(start + number * step, unit) for number in range(min(n, MAX_POSITIONS))]
    if n > MAX_POSITIONS:
        raise typer.BadParameter(f"{text!r} is {n} slices; {MAX_POSITIONS} are the most on one sheet")
    if n < 1:
        raise typer.BadParameter(
            f"{text!r} is not START:STOP:STEP, such as 10:80:10, not numbers with commas between, and not a number of "
            "slices, such as 12; either all have the same unit or none has one"
        )
    return tuple(listed)


def whole_numbers(text: str) -> tuple[int, ...]:
    """A list of whole numbers, of any length."""
    try:
        return tuple(int(part) for part in text.split(","))
    except ValueError:
        raise typer.BadParameter(f"{text!r} is not whole numbers with commas between, such as 64,128,128") from None


def weights(text: str) -> tuple[float, ...]:
    """A list of numbers, of any length."""
    try:
        return tuple(float(part) for part in text.split(","))
    except ValueError:
        raise typer.BadParameter(f"{text!r} is not numbers with commas between, such as 1,1,0") from None


def opacity(text: str) -> str | float | tuple[float, ...]:
    """The name of an opacity curve, a number, or several numbers."""
    if text.isalpha():
        return text
    given = weights(text)
    return given[0] if len(given) == 1 else given


def window(text: str) -> str | tuple[float | str, ...]:
    """The name of a window, its level and width, or two percentiles."""
    return text if any(letter.isalpha() for letter in text) else ends("40,400")(text)


def color(text: str) -> str:
    """The text of a colour, checked."""
    from wavesplat._looks.curves import colors

    try:
        colors.parse(text)
    except ArgumentError as error:
        raise typer.BadParameter(str(error)) from None
    return text


def file_and_name(path: Path) -> tuple[Path, str | None]:
    """The file, and the name of what is meant in it, that "FILE#NAME" says; a file may have "#" in its name."""
    if path.exists() or "#" not in str(path):
        return path, None
    file, _, name = str(path).rpartition("#")
    return Path(file), name


def refuse_pairs(**given: object) -> None:
    """Raise an `ArgumentError` if both of two options are given: neither is None."""
    first, second = given
    if given[first] is not None and given[second] is not None:
        names = " and ".join("--" + name.replace("_", "-") for name in given)
        raise ArgumentError(f"{names} say the same thing twice; give one of them")
