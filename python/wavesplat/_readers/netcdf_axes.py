"""Axes of netCDF variables: which are of space and time, where their samples lie, and what their units mean.

Conventions for metadata (CF): https://cfconventions.org, "Coordinate Types".
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from wavesplat._files.libraries import library
from wavesplat._model import units
from wavesplat._model.facts import Facts
from wavesplat._model.labelled_array import NAMES, TOLERANCE
from wavesplat._readers.request import Request
from wavesplat.errors import FileError

__all__ = [
    "evenly",
    "is_downwards",
    "places_told",
    "role_of",
    "spatial_axes",
    "times_of",
    "with_true_unit",
    "without_unit",
]

#: The extra of the libraries.
EXTRA = "netcdf"
#: Coordinates' attribute `units` -> axis.
OF_UNITS = {
    f"degree{plural}{end}": axis
    for axis, ends in (("y", ("_north", "_n", "n")), ("x", ("_east", "_e", "e")))
    for end in ends
    for plural in ("", "s")
}
#: Units of pressure, which by the conventions mark an axis that grows downwards.
PRESSURES = ("pa", "hpa", "mb", "mbar", "millibar", "millibars", "bar", "dbar", "decibar")
#: Names of axes of time.
TIMES = ("time", "t")


def role_of(array: Any, axis: Any) -> str:
    """The role of an axis: "x", "y", "z", "time", or "" where nothing says which."""
    said = getattr(array.coords[axis], "attrs", {}) if axis in array.coords else {}
    units = str(said.get("units", "")).lower()
    by_axis = {"T": "time", "X": "x", "Y": "y", "Z": "z"}.get(str(said.get("axis", "")).upper(), "")
    by_name = "time" if str(axis).lower() in TIMES else NAMES.get(str(axis).lower(), "")
    is_upright = str(said.get("positive", "")).lower() in ("up", "down") or units in PRESSURES
    by_place = "z" if is_upright else ""
    return by_axis or ("time" if " since " in units else "") or OF_UNITS.get(units, "") or by_place or by_name


def is_downwards(array: Any, axis: Any) -> bool:
    """Whether an axis says that it grows downwards; pressures and depths do where they say nothing."""
    said = getattr(array.coords[axis], "attrs", {}) if axis in array.coords else {}
    is_down = str(said.get("units", "")).lower() in PRESSURES or said.get("standard_name") == "depth"
    return str(said.get("positive", "down" if is_down else "")).lower() == "down"


def spatial_axes(axes: list[tuple[Any, str]], sizes: Any) -> list[Any]:
    """The axes z, y, x: those that the file says are, the others in their order; fewer than three if unclear."""
    known = {role: axis for axis, role in axes if role in ("x", "y", "z") and [r for _, r in axes].count(role) == 1}
    if len(known) == 3:
        return [known[role] for role in "zyx"]
    others = [axis for axis, _ in axes if axis not in known.values()]
    if len(axes) > 3:  # axes of one sample are not missed
        others = [axis for axis in others if sizes[axis] > 1]
    if len(others) + len(known) != 3:
        return []
    return [known[role] if role in known else others.pop(0) for role in "zyx"]


def without_unit(array: Any, axis: Any) -> Any:
    """The array with an axis of times whose unit is none of lengths."""
    if axis not in array.coords:
        return array
    said = {key: value for key, value in array.coords[axis].attrs.items() if key != "units"}
    return array.assign_coords({axis: (axis, np.asarray(array.coords[axis]), said)})


def with_true_unit(facts: Facts, volume: Any, spatial: list[Any]) -> Facts:
    """The facts without a unit of length where x and y have none, and with a sentence on degrees and pressures."""
    said = {
        letter: str(volume.coords[axis].attrs.get("units", ""))
        for letter, axis in zip("xyz", reversed(spatial), strict=True)
        if axis in volume.coords
    }
    other = {
        letter: "degrees" if unit.lower().startswith("degree") else unit
        for letter, unit in said.items()
        if unit.lower().startswith("degree") or unit.lower() in PRESSURES
    }
    if not other:
        return facts
    is_length = units.metres(facts.unit) is not None
    told = [
        f"distances along {', '.join(letter for letter in other if other[letter] == unit)} in {unit}: 1 is drawn as 1"
        f"{f' {facts.unit} of the others' if is_length else ' unit of length'}"
        for unit in dict.fromkeys(other.values())
    ]
    # What the sentences above say of the same axes.
    guesses = [
        guess
        for guess in facts.guesses
        if not (guess.startswith("distances along") and any(f"'{unit[:6]}" in guess for unit in other.values()))
    ]
    keeps = is_length and not {"x", "y"} & other.keys()
    return replace(facts, unit=facts.unit if keeps else None, guesses=(*told, *guesses))


def places_told(array: Any, axis: Any) -> list[str]:
    """The coordinates along an axis, in messages; times of a calendar as dates."""
    if axis not in array.coords:
        return []
    units = str(array.coords[axis].attrs.get("units", ""))
    if " since " in units and (dates := _dates(array, axis)):
        return dates
    places = np.asarray(array.coords[axis]).tolist()
    return [f"{f'{place:.9g}' if isinstance(place, float) else place} {units}".strip() for place in places]


def _dates(array: Any, axis: Any) -> list[str]:
    """Dates of an axis of times; none where their calendar is that of a model."""
    xarray = library("xarray", extra=EXTRA)
    bare = xarray.Dataset({"time": (axis, np.asarray(array.coords[axis]), array.coords[axis].attrs)})
    try:
        dates = np.asarray(xarray.decode_cf(bare)["time"])
    except (ValueError, OverflowError, ImportError):
        return []
    if dates.dtype.kind != "M":
        return []
    unit: Literal["D", "m", "s"] = next((u for u in ("D", "m") if (dates == dates.astype(f"M8[{u}]")).all()), "s")
    return [str(date) for date in np.datetime_as_string(dates, unit=unit)]


def times_of(array: Any, axis: Any) -> dict[str, Any]:
    """Facts of time: the numbers of the coordinate, and the first word of its unit ("days since 2001-01-01")."""
    said: dict[str, Any] = {"n_times": int(array.sizes[axis])}
    if axis not in array.coords or array.coords[axis].dtype.kind not in "iuf":
        return said
    numbers = np.asarray(array.coords[axis], np.float64)
    if not np.isfinite(numbers).all():
        return said
    unit = str(array.coords[axis].attrs.get("units", "")).partition(" since ")[0].strip()
    return said | {"times": tuple(numbers.tolist()), "time_unit": unit or None}


def evenly(array: Any, request: Request) -> tuple[Any, list[str]]:
    """The array with even coordinates, interpolated where `resample` allows it, and a sentence for each such axis."""
    made = []
    for axis in array.dims if request.spacing is None else ():
        if axis not in array.coords or array.coords[axis].dtype.kind not in "iuf":
            continue
        places = np.asarray(array.coords[axis], np.float64)
        steps = np.diff(places)
        if _is_even(places):
            continue
        told = f"coordinates along {str(axis)!r} are not evenly spaced (steps from {_ends(steps)})"
        if not ((steps > 0).all() or (steps < 0).all()):
            raise FileError(
                f"coordinates along {str(axis)!r} do not grow or fall from each to the next; "
                f"pass spacing=(x, y, z) to draw them as if they were even: {request.path}"
            )
        if request.resample is None:
            raise FileError(
                f"{told}; interpolate to N even places with resample=N (--resample N), or pass spacing=(x, y, z) to "
                f"draw them as if they were: {request.path}"
            )
        array = array.interp({axis: np.linspace(places[0], places[-1], request.resample)})
        made.append(f"{told}; interpolated to {request.resample} even places from {len(places)}")
    return array, made


def _is_even(places: NDArray[np.float64]) -> bool:
    if len(places) < 2:
        return True
    step = (places[-1] - places[0]) / (len(places) - 1)
    off = np.abs(places - (places[0] + step * np.arange(len(places)))).max()
    # Written so that NaN is uneven too.
    return bool(step != 0 and off <= TOLERANCE * abs(step))


def _ends(steps: NDArray[np.float64]) -> str:
    lengths = np.abs(steps)
    return f"{lengths.min():g} to {lengths.max():g}"
