"""Axes with names and coordinates: which are x, y and z, where north and up are, units, evenness.

Conventions for climate and forecasts (CF, https://cfconventions.org, "Coordinate Types"): the attributes `axis`,
`positive`, `standard_name` and `units` of coordinates. Dimensions of the models WRF (bottom_top, south_north,
west_east) and ROMS (s_rho, eta_rho, xi_rho) have their names alone, and so have many files with lat and lon.
One reading for netCDF, HDF5, Zarr, GRIB and arrays in memory: all are arrays with `dims`, `coords` and attributes.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wavesplat._model.volume import units

# Whether coordinates along an axis are even: as exactly as their numbers can say it.
#
# A longitude of 359.58 in single precision is rounded to a multiple of 3.05e-5, so that steps of 0.0009 differ by 7 %.

#: Tolerance of coordinates, as a fraction of the step: many are calculated in single precision.
TOLERANCE = 1e-3
#: Maximum rounding error of a coordinate in units in the last place: half a unit each for itself and both ends, doubled
#: since coordinates are often calculated from the one before.
ULPS = 2.0


def off_from_even(places: NDArray[Any], tolerance: float = TOLERANCE) -> tuple[float, float, bool]:
    """The mean step, the largest distance from even places, and whether it is within rounding or tolerance.

    places : two or more coordinates, in the type of the file. tolerance : as a fraction of the step.
    """
    numbers = places.astype(np.float64)
    step = float((numbers[-1] - numbers[0]) / (len(numbers) - 1))
    off = float(np.abs(numbers - (numbers[0] + step * np.arange(len(numbers)))).max())
    # Written so that NaN is uneven too.
    return step, off, bool(step != 0 and off <= max(tolerance * abs(step), rounding_of(places)))


def rounding_of(places: NDArray[Any]) -> float:
    """The distance by which even coordinates can be off since their type is short."""
    if places.dtype.kind != "f" or not np.isfinite(places).all():
        return 0.0
    with np.errstate(over="ignore"):
        single = places.astype(np.float32)
    # Fractions in double precision that have the numbers of single precision were converted from it.
    is_converted = np.array_equal(single, places) and not np.array_equal(np.round(places), places)
    kept = single if is_converted else places
    return ULPS * float(np.spacing(np.abs(kept).max()))


# Axes with names: which of them are x, y and z, where north and up are, and what the units of their numbers mean.

#: Names of axes of arrays of any kind, in lower case -> ours.
NAMES = {
    **dict.fromkeys(("z", "depth", "plane", "slice"), "z"),
    **dict.fromkeys(("y", "row"), "y"),
    **dict.fromkeys(("x", "col", "column", "width"), "x"),
}
#: Names of axes of maps, of the sea and of the air: z grows up or down, y to the north, x to the east.
MAP_NAMES = {
    "z": (
        r"i?lev(el)?s?[_\d]*|olev(el)?|[mp]lev\d*|(air_)?pressure\w*|isobaric\w*|heights?(?!_)\w*|height_\w+|alt(itude)?s?"
        r"|depth\w+|(bottom_top|soil_layers|snow_layers|snso_layers)(_stag)?|s_(rho|w)|sigma\w*|hybrid\w*"
        r"|model_level\w*|(atmosphere|ocean)_\w+|generalvertical\w*|nav_lev|z(_[twl]|lev|t|u|w)|st_ocean|sw_ocean"
    ),
    "y": (
        r"(grid_)?lat(itude)?s?[_\d]*|[rny]lat\d*|south_north(_stag)?|eta_(rho|u|v|psi)|projection_y_coordinate|northings?|y_?coord"
    ),
    "x": (
        r"(grid_)?lon(gitude)?s?[_\d]*|[rnx]lon\d*|west_east(_stag)?|xi_(rho|u|v|psi)|projection_x_coordinate|eastings?|x_?coord"
    ),
}
#: Coordinates' attribute `units` -> axis.
OF_UNITS = {
    f"degree{plural}{end}": axis
    for axis, ends in (("y", ("_north", "_n", "n")), ("x", ("_east", "_e", "e")))
    for end in ends
    for plural in ("", "s")
}
#: Standard names of coordinates -> axis; of the many vertical names, the ones in common use.
OF_STANDARD_NAMES = {
    **dict.fromkeys(("latitude", "grid_latitude", "projection_y_coordinate"), "y"),
    **dict.fromkeys(("longitude", "grid_longitude", "projection_x_coordinate"), "x"),
    **dict.fromkeys(("height", "altitude", "depth", "air_pressure", "sea_water_pressure", "model_level_number"), "z"),
    "time": "time",
}
#: Vertical coordinates that are shares of a height, a depth or a pressure, and no lengths.
SHARES = r"(atmosphere|ocean)_\w*(sigma|hybrid|s_coordinate)\w*|s_(rho|w)|sigma\w*"
#: Units of pressure, which by the conventions mark an axis that grows downwards.
PRESSURES = ("pa", "hpa", "kpa", "mb", "mbar", "millibar", "millibars", "bar", "dbar", "decibar", "decibars")
#: Names of coordinates that grow downwards unless an attribute says otherwise.
DOWNWARDS = r"depth\w*|plev\d*|(air_|sea_water_)?pressure\w*|isobaric\w*"
#: Names of axes of time.
TIMES = ("time", "t", "times", "timestep", "timesteps", "time_step", "time_steps")
#: Units that are not lengths.
WITHOUT_LENGTH = ("1", "level", "levels", "layer", "layers", "sigma_level", "count", "index", "-")
ANGLES = ("deg", "degree", "degrees", "arc_degree", "rad", "radian", "radians")


def attributes_of(array: Any, axis: Any) -> dict[str, Any]:
    """Attributes of the coordinate along an axis."""
    return dict(getattr(array.coords[axis], "attrs", {})) if axis in array.coords else {}


def role_of(array: Any, axis: Any) -> str:
    """The role of an axis: "x", "y", "z", "time", or "" where nothing says which."""
    attributes = attributes_of(array, axis)
    unit = _text(attributes, "units")
    by_axis = {"t": "time", "x": "x", "y": "y", "z": "z"}.get(_text(attributes, "axis"), "")
    standard_name = _text(attributes, "standard_name")
    by_meaning = OF_STANDARD_NAMES.get(standard_name) or ("z" if re.fullmatch(SHARES, standard_name) else "")
    by_place = "z" if _text(attributes, "positive") in ("up", "down") or unit in PRESSURES else ""
    is_time = " since " in unit or (axis in array.coords and array.coords[axis].dtype.kind == "M")
    role = by_axis or ("time" if is_time else "") or OF_UNITS.get(unit, "") or by_meaning or by_place
    return role or _role_by_name(axis, array.dims)


def _role_by_name(axis: Any, dims: Any) -> str:
    name = str(axis).lower()
    if name in TIMES:
        return "time"
    if name == "height" and "width" in [str(other).lower() for other in dims]:
        return "y"  # of a picture
    return NAMES.get(name) or _role_on_maps(axis)


def _role_on_maps(axis: Any) -> str:
    return next((role for role, names in MAP_NAMES.items() if re.fullmatch(names, str(axis).lower())), "")


def spatial_axes(axes: list[tuple[Any, str]], sizes: Any) -> list[Any]:
    """The axes z, y, x: those that are known to be, the others in their order; fewer than three if unclear."""
    known = {role: axis for axis, role in axes if role in ("x", "y", "z") and [r for _, r in axes].count(role) == 1}
    if len(known) == 3:
        return [known[role] for role in "zyx"]
    others = [axis for axis, _ in axes if axis not in known.values()]
    if len(axes) > 3:  # axes of one sample are not missed
        others = [axis for axis in others if sizes[axis] > 1]
    if len(others) + len(known) != 3:
        return []
    return [known[role] if role in known else others.pop(0) for role in "zyx"]


def is_of_world(array: Any, spatial: list[Any]) -> bool:
    """Whether names and attributes of the axes z, y, x say that z is up and y north, as on maps, in the sea or the air.

    Rows of images grow downwards, and nothing is said of theirs but a name and a unit as small as they are.
    What xarray has opened is of such a file: it reads the formats of models, and keeps how the values are stored there.
    """
    own = getattr(array, "attrs", {})
    is_opened = bool({"source", "dtype"} & set(getattr(array, "encoding", {})))
    if is_opened or "grid_mapping" in own or _text(own, "standard_name"):
        return True
    for axis in spatial:
        attributes = attributes_of(array, axis)
        unit = _text(attributes, "units")
        is_named = _role_on_maps(axis) == _role_by_name(axis, array.dims) != ""
        is_described = any(_text(attributes, key) for key in ("axis", "positive", "standard_name"))
        is_large = (units.metres(units.canonical(unit)) or 0.0) >= 1.0
        if is_named or is_described or is_large or _other_unit(unit):
            return True
    return any(array.coords[name].ndim == 2 and _is_map_place(array, name) for name in array.coords)


def _is_map_place(array: Any, name: Any) -> bool:
    """Whether a coordinate of two axes is a latitude or longitude."""
    attributes = attributes_of(array, name)
    return _text(attributes, "units") in OF_UNITS or OF_STANDARD_NAMES.get(_text(attributes, "standard_name")) in (
        "x",
        "y",
    )


def is_downwards(array: Any, axis: Any) -> bool:
    """Whether an axis z of a map grows downwards; pressures and depths do where they say nothing.

    Numbers that are below 0 everywhere are heights already, whatever their name is.
    """
    if axis not in array.coords:
        return False
    attributes = attributes_of(array, axis)
    if (positive := _text(attributes, "positive")) in ("up", "down"):
        return positive == "down"
    is_named = re.fullmatch(DOWNWARDS, _text(attributes, "standard_name") or str(axis).lower()) is not None
    places = np.asarray(array.coords[axis])
    is_height = places.dtype.kind in "iuf" and bool(places.size) and float(np.nanmax(places)) <= 0 > np.nanmin(places)
    return (_text(attributes, "units") in PRESSURES or is_named) and not is_height


def without_lengths(array: Any, spatial: list[Any]) -> list[Any]:
    """The axis z if its coordinates are fractions, such as of the depth in ROMS, and x and y have no units."""
    z, *others = spatial
    attributes = attributes_of(array, z)
    names = [_text(attributes, "standard_name"), str(z).lower()]
    is_share = any(re.fullmatch(SHARES, name) for name in names) and _text(attributes, "units") in ("", *WITHOUT_LENGTH)
    return [z] if is_share and not any(_text(attributes_of(array, axis), "units") for axis in others) else []


def wrf_steps(array: Any, spatial: list[Any], attributes: Mapping[str, Any]) -> tuple[float, float] | None:
    """Distances along x and y in metres, from the attributes DX and DY of a WRF file; None for other files."""
    _, y, x = (str(axis) for axis in spatial)
    if not (y.startswith("south_north") and x.startswith("west_east")) or {y, x} & set(array.coords):
        return None
    steps = [attributes.get(name, array.attrs.get(name)) for name in ("DX", "DY")]
    try:
        dx, dy = (float(np.ravel(step)[0]) for step in steps)
    except (TypeError, ValueError, IndexError):
        return None
    return (dx, dy) if 0 < dx < np.inf and 0 < dy < np.inf else None


def length_unit_of(array: Any, axis: Any) -> str | None:
    """The unit of length of a coordinate, by our name or as it is; None for degrees, pressures, numbers, times."""
    attributes = attributes_of(array, axis)
    unit = attributes.get("units", attributes.get("unit"))
    is_time = role_of(array, axis) == "time"
    return None if is_time or _other_unit(unit) is not None else units.canonical(unit)


def _other_unit(unit: object) -> str | None:
    """The name, for messages, of a unit that is not a length; "" for numbered levels; None for other units."""
    name = str(unit or "").strip()
    if name.lower() in OF_UNITS or name.lower() in ("deg", "degree", "degrees", "arc_degree"):
        return "degrees"
    if name.lower() in ANGLES:
        return "radians"
    if name.lower() in PRESSURES:
        return name
    return "" if name.lower() in WITHOUT_LENGTH else None


def unit_with_notes(array: Any, spatial: list[Any], unit: str | None) -> tuple[str | None, list[str]]:
    """The unit of length of the world, None where x or y have no lengths, and a sentence on degrees and pressures.

    spatial : axes z, y, x. unit : unit of the axes that are lengths.
    """
    named = {
        letter: _other_unit(attributes_of(array, axis).get("units"))
        for letter, axis in zip("xyz", reversed(spatial), strict=True)
        if role_of(array, axis) != "time"
    }
    other = {letter: one for letter, one in named.items() if one}
    if not other:
        return unit, []
    is_length = units.metres(unit) is not None
    notes = [
        f"distances along {', '.join(letter for letter in other if other[letter] == one)} in {one}: 1 is drawn as 1"
        f"{f' {unit} of the others' if is_length else ' unit of length'}"
        for one in dict.fromkeys(other.values())
    ]
    keeps = is_length and not {"x", "y"} & other.keys()
    return unit if keeps else None, notes


def _text(attributes: dict[str, Any], key: str) -> str:
    value = attributes.get(key)
    return value.strip().lower() if isinstance(value, str) else ""
