"""Units of length: their names in files, their size, and the one in which a length reads best.

Lengths in other units (inch, megametre) are converted to one of these, by their size from `metres`. The names
and sizes are in `crates/files/src/length_units.rs`.
A unit that a file names and that is unknown here is never taken for another one without a word: `guesses_of`, `differ`.
"""

from __future__ import annotations

from wavesplat import _native
from wavesplat._system.values import described
from wavesplat.errors import ArgumentError

#: Units in which lengths are shown, the longest first.
READABLE = ("km", "m", "mm", "um", "nm", "pm")
LONGEST_NAME = 24
#: A millimetre in metres.
MILLIMETRE = 1e-3

metres, factor, in_one_unit = _native.unit_metres, _native.unit_factor, _native.in_one_unit
guesses_of = _native.unit_guesses


def canonical(text: object) -> str | None:
    """Our name of a unit that a file names ("Micrometers", "µm"); one that is unknown as it is; None where none is."""
    return _native.unit_name(str(text or ""))


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
    if name is not None and (reported := _native.reported_unit(name)) != name:
        raise ArgumentError(f"unit is {unit!r}; give {reported} and the lengths in it")
    return name


def of_file(name: object) -> tuple[str | None, float]:
    """The unit for lengths of a file that names one for all axes, and the factor that brings them to it."""
    own = canonical(name)
    unit, (by, _, _) = in_one_unit((own, own, own))
    return unit, by


def differ(own: str | None, other: str | None) -> bool:
    """Whether lengths of two units cannot stand beside each other as they are; a unit that is not named fits to all."""
    return factor(own, other) != 1.0


def length_text(length: float, unit: str | None) -> str:
    """A length with the unit in which it reads best: 2000 um is "2 mm", 5 without a unit "5"."""
    size = metres(unit)
    if size is None:
        return f"{length:g} {unit}" if unit else f"{length:g}"
    for name in READABLE:
        # Rounded: 1000 um is 1 mm, whatever the last bit says.
        number = float(f"{length * size / (metres(name) or 1.0):.9g}")
        # Tenths of a metre stay metres in a world of metres, as the numbers of its frame: 0.5 m, not 500 mm.
        if number >= 1 or (name == unit == "m" and number >= 0.1):
            break
    return f"{number:g} {written(name)}"


def written(unit: str) -> str:
    """The printed sign of a unit."""
    return {"um": "µm", "angstrom": "Å"}.get(unit, unit)
