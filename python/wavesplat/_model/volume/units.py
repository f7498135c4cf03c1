"""Units of length: their names in files, their size, and the one in which a length reads best.

Lengths in other units (inch, megametre) are converted to one of these, by their size from `metres`.
A unit that a file names and that is unknown here is never taken for another one without a word: `guesses_of`, `differ`.
"""

from __future__ import annotations

from wavesplat._system.values import described
from wavesplat.errors import ArgumentError

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
    "line": (0.0254 / 12, "mm"),
    "point": (0.0254 / 72, "mm"),
    "Mm": (1e6, "km"),
    "hm": (1e2, "m"),
    "dam": (1e1, "m"),
    "fm": (1e-15, "pm"),
    "bohr": (5.29177210903e-11, "angstrom"),
}
#: Names in files, in lower case -> our names.
NAMES = {name.lower(): name for name in (*METRES, *FOREIGN) if name != "Mm"} | {
    "megameter": "Mm",
    "kilometer": "km",
    "hectometer": "hm",
    "decameter": "dam",
    "dekameter": "dam",
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
    "femtometer": "fm",
    "in": "inch",
    "inches": "inch",
    '"': "inch",
    "ft": "foot",
    "feet": "foot",
    "yd": "yard",
    "mi": "mile",
    "mil": "thou",
    "li": "line",
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
    # ImageJ writes letters beyond ASCII as escapes of Java.
    name = name.replace("\\u00B5", "µ").replace("\\u00b5", "µ").replace("\\u03BC", "μ").replace("\\u00C5", "Å")
    folded = name.lower().replace("metre", "meter")
    if folded in NONE:
        return None
    # A capital M and P are mega and peta, small ones milli and pico.
    if name in ("Mm", "Pm"):
        return name
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
    """One unit for axes x, y, z (the first that has one), and the factors that bring each axis to it.

    An axis of an unknown unit keeps its numbers, which is a guess (`guesses_of`).
    """
    first = next((unit for unit in units if metres(unit) is not None), None)
    if first is None:
        named = {unit for unit in units if unit is not None}
        return named.pop() if len(named) == 1 else None, (1.0, 1.0, 1.0)
    common = _shown(first)
    x, y, z = (factor(unit if metres(unit) is not None else first, common) or 1.0 for unit in units)
    return common, (x, y, z)


def of_file(name: object) -> tuple[str | None, float]:
    """The unit for lengths of a file that names one for all axes, and the factor that brings them to it."""
    own = canonical(name)
    unit, (by, _, _) = in_one_unit((own, own, own))
    return unit, by


def factor(own: str | None, wanted: str | None) -> float | None:
    """The factor from lengths in one unit to another; None if a named unit is unknown.

    Where one of them names none, the lengths stay as they are.
    """
    if own is None or wanted is None or own == wanted:
        return 1.0
    size, of_wanted = metres(own), metres(wanted)
    return None if size is None or of_wanted is None else float(f"{size / of_wanted:.12g}")


def differ(own: str | None, other: str | None) -> bool:
    """Whether lengths of two units cannot stand beside each other as they are; a unit that is not named fits to all."""
    return factor(own, other) != 1.0


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


def _shown(unit: str) -> str:
    """The unit in which lengths in a file's unit are reported."""
    return FOREIGN[unit][1] if unit in FOREIGN else unit


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
