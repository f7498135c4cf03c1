"""Units of length: their names in files, their size, and the one in which a length reads best.

Lengths in units that are no power of ten of a metre (inch) are converted to one that is, by their size from `metres`;
pixels have no size.
"""

from __future__ import annotations

from wavesplat._model.argument_types import described
from wavesplat.errors import ArgumentError

__all__ = ["METRES", "canonical", "checked", "in_one_unit", "length_text", "metres", "written"]

#: Our name of a unit -> its size in metres.
METRES = {
    "km": 1e3,
    "m": 1.0,
    "dm": 1e-1,
    "cm": 1e-2,
    "mm": 1e-3,
    "um": 1e-6,
    "nm": 1e-9,
    "angstrom": 1e-10,
    "pm": 1e-12,
}
#: Other units with a size, and the unit that they are converted to: name -> (size in metres, unit).
FOREIGN = {
    "inch": (0.0254, "mm"),
    "foot": (0.3048, "m"),
    "yard": (0.9144, "m"),
    "mile": (1609.344, "km"),
    "thou": (2.54e-5, "um"),
    "point": (0.0254 / 72, "mm"),
}
#: Names in files, in lower case -> our names.
NAMES = {name: name for name in (*METRES, *FOREIGN)} | {
    "kilometer": "km",
    "meter": "m",
    "decimeter": "dm",
    "centimeter": "cm",
    "millimeter": "mm",
    "micrometer": "um",
    "micron": "um",
    "µm": "um",  # the sign
    "μm": "um",  # the Greek letter
    "nanometer": "nm",
    "å": "angstrom",
    "ångström": "angstrom",
    "ang": "angstrom",
    "picometer": "pm",
    "in": "inch",
    "inches": "inch",
    '"': "inch",
    "ft": "foot",
    "feet": "foot",
    "yd": "yard",
    "mi": "mile",
    "pt": "point",
}
#: Units in which lengths are shown, the longest first.
READABLE = ("km", "m", "mm", "um", "nm", "pm")
#: Names in files that mean no unit.
NONE = {
    "",
    "pixel",
    "pixels",
    "px",
    "voxel",
    "voxels",
    "unknown",
    "none",
    "null",
    "arbitrary",
    "reference frame",
    "index",
}
LONGEST_NAME = 24


def canonical(text: object) -> str | None:
    """Our name of a unit that a file names ("Micrometers", "µm"); one that is unknown as it is; None where none is."""
    name = str(text or "").strip().strip("\0").strip()
    # ImageJ writes what is not ASCII as an escape of Java.
    name = name.replace("\\u00B5", "µ").replace("\\u00b5", "µ").replace("\\u03BC", "μ").replace("\\u00C5", "Å")
    folded = name.lower().replace("metre", "meter")
    if folded in NONE:
        return None
    # Case distinguishes mm from Mm (megametre), and no other units here.
    if name == "Mm":
        return "Mm"
    singular = folded.removesuffix("s") if len(folded) > 3 else folded
    known = NAMES.get(folded) or NAMES.get(singular)
    return known or name[:LONGEST_NAME]


def checked(unit: object) -> str | None:
    """Our name of a unit that a caller names, or an `ArgumentError`."""
    if unit is None:
        return None
    if not isinstance(unit, str) or len(unit) > LONGEST_NAME or not unit.isprintable():
        begin = unit[:LONGEST_NAME] if isinstance(unit, str) else unit
        raise ArgumentError(
            f'unit is {described(begin)}; give the name of the world\'s unit of length, such as "mm" or "um"'
        )
    name = canonical(unit)
    if name in FOREIGN:
        raise ArgumentError(f"unit is {unit!r}; give {FOREIGN[name][1]} and the lengths in it")
    return name


def metres(unit: str | None) -> float | None:
    """The size of a unit by our name, in metres; None where it has none that we know."""
    if unit in FOREIGN:
        return FOREIGN[unit][0]
    return METRES.get(unit or "")


def in_one_unit(units: tuple[str | None, str | None, str | None]) -> tuple[str | None, tuple[float, float, float]]:
    """One unit for axes x, y, z, that of the first that has one, and the factors that bring each axis to it.

    An axis of an unknown unit keeps its numbers, which is a guess (`guesses_of`).
    """
    first = next((unit for unit in units if metres(unit) is not None), None)
    if first is None:
        named = {unit for unit in units if unit is not None}
        return named.pop() if len(named) == 1 else None, (1.0, 1.0, 1.0)
    common = FOREIGN[first][1] if first in FOREIGN else first
    x, y, z = (_factor(unit, common) if metres(unit) is not None else _factor(first, common) for unit in units)
    return common, (x, y, z)


def guesses_of(units: tuple[str | None, str | None, str | None]) -> list[str]:
    """A sentence for each unknown unit of axes x, y, z, with what `in_one_unit` assumes; axes without a unit aside."""
    common, _ = in_one_unit(units)
    strange = {unit for unit in units if unit is not None and metres(unit) is None}
    if not strange or strange == {common}:
        return []  # one unknown unit for all: its name is shown
    guesses = []
    for unit in sorted(strange):
        axes = ", ".join(name for name, own in zip("xyz", units, strict=True) if own == unit)
        meant = f"in {common}" if common else "as their numbers are"
        guesses.append(f"distances along {axes} {meant}: their unit in the file, {unit!r}, is unknown")
    return guesses


def _factor(unit: str | None, common: str) -> float:
    if unit == common:
        return 1.0
    # Of powers of ten, the quotient or its inverse is exact.
    size, of_common = metres(unit) or 1.0, METRES[common]
    return float(f"{size / of_common:.12g}")


def length_text(length: float, unit: str | None) -> str:
    """A length with the unit in which it reads best: 2000 um is "2 mm", 5 without a unit "5"."""
    size = METRES.get(unit or "")
    if size is None:
        return f"{length:g} {unit}" if unit else f"{length:g}"
    for name in READABLE:
        # Rounded: 1000 um is 1 mm, whatever the last bit says.
        number = float(f"{length * size / METRES[name]:.9g}")
        # Tenths of a metre stay metres in a world of metres, as the numbers of its frame: 0.5 m, not 500 mm.
        if number >= 1 or (name == unit == "m" and number >= 0.1):
            break
    return f"{number:g} {written(name)}"


def written(unit: str) -> str:
    """The printed sign of a unit."""
    return {"um": "µm", "angstrom": "Å"}.get(unit, unit)
