"""Axes of netCDF variables: times and places in messages, and uneven coordinates interpolated.

Conventions for metadata (CF): https://cfconventions.org, "Coordinate Types".
"""

from __future__ import annotations

import warnings
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from wavesplat._model.volume.map_axes import off_from_even, role_of, spatial_axes, without_lengths
from wavesplat._readers.request import Request, SeveralError, choose
from wavesplat._system.libraries import library
from wavesplat.errors import ArgumentError, FileError, LibraryError

#: The extra of the libraries.
EXTRA = "netcdf"


def variable_text(name: str, array: Any) -> str:
    """A variable in messages: "t (time 2, level 3, lat 4, lon 5), air temperature, K"."""
    axes = ", ".join(f"{axis} {size}" for axis, size in array.sizes.items())
    named = [str(array.attrs[key]) for key in ("long_name", "units") if array.attrs.get(key) is not None]
    return ", ".join((f"{name} ({axes})", *named))


def picked_axes(name: str, array: Any, request: Request) -> tuple[dict[Any, int], list[Any], dict[str, Any]]:
    """One place along each axis that is not of space, the axes z, y, x, and facts of time."""
    picked: dict[Any, int] = {}
    facts: dict[str, Any] = {}
    roles = {axis: role_of(array, axis) for axis in array.dims}
    time = next((axis for axis, role in roles.items() if role == "time"), None)
    if time is not None and array.ndim > 3:
        picked[time] = choose(
            "time", array.sizes[time], request.time, request.path, described=_place_texts(array, time)
        )
        facts = _times_of(array, time)
    rest = [axis for axis in array.dims if axis not in picked]
    spatial = spatial_axes([(axis, roles[axis]) for axis in rest], array.sizes)
    further = [axis for axis in rest if axis not in spatial]
    longer = [axis for axis in further if array.sizes[axis] > 1]
    if len(spatial) == 3 and len(longer) == 1:
        axis = longer[0]
        picked[axis] = _further(array, axis, request)
    picked |= dict.fromkeys((axis for axis in further if axis not in picked and array.sizes[axis] == 1), 0)
    for option, given, has in (
        ("time", request.time, time is not None and time in picked),
        ("channel", request.channel, len(longer) == 1),
    ):
        if given is not None and not has:
            raise ArgumentError(
                f"{option}= has no meaning for {variable_text(name, array)}; leave it out: {request.path}"
            )
    if len(spatial) != 3 or len(array.dims) - len(picked) != 3:
        raise FileError(
            f"which axes are z, y and x is not clear: {variable_text(name, array)}; "
            f"give wavesplat.Volume(xarray.open_dataset(path)[name].isel(...)), with one of each other axis: "
            f"{request.path}"
        )
    return picked, spatial, facts


def _further(array: Any, axis: Any, request: Request) -> int:
    """The place that is asked for along an axis that is neither of space nor of times, such as the member of a run."""
    listed = [f"{axis} {place}" for place in _place_texts(array, axis)]
    try:
        return choose("channel", array.sizes[axis], request.channel, request.path, described=listed)
    except SeveralError as error:
        error.are_light = False
        raise


def _place_texts(array: Any, axis: Any) -> list[str]:
    """The coordinates along an axis, in messages; times of a calendar as dates."""
    if axis not in array.coords:
        return []
    units = str(array.coords[axis].attrs.get("units", ""))
    if " since " in units and (dates := _dates(array, axis)):
        return dates
    places = np.asarray(array.coords[axis]).tolist()
    return [f"{f'{place:.9g}' if isinstance(place, float) else place} {units}".strip() for place in places]


def _dates(array: Any, axis: Any) -> list[str]:
    """Dates of an axis of times; none where their calendar is a model's own."""
    try:
        xarray = library("xarray", extra=EXTRA)
    except LibraryError:
        return []  # Zarr needs it for nothing else
    bare = xarray.Dataset({"time": (axis, np.asarray(array.coords[axis]), array.coords[axis].attrs)})
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", xarray.SerializationWarning)  # of dates before 1582, and of rounded ones
            dates = np.asarray(xarray.decode_cf(bare)["time"])
    except (ValueError, OverflowError, ImportError):
        return []
    if dates.dtype.kind != "M":
        return []
    unit: Literal["D", "m", "s"] = next((u for u in ("D", "m") if (dates == dates.astype(f"M8[{u}]")).all()), "s")
    return [str(date) for date in np.datetime_as_string(dates, unit=unit)]


def _times_of(array: Any, axis: Any) -> dict[str, Any]:
    """Facts of time: the numbers of the coordinate, and the first word of its unit ("days since 2001-01-01")."""
    facts: dict[str, Any] = {"n_times": int(array.sizes[axis])}
    if axis not in array.coords or array.coords[axis].dtype.kind not in "iuf":
        return facts
    numbers = np.asarray(array.coords[axis], np.float64)
    if not np.isfinite(numbers).all():
        return facts
    unit = str(array.coords[axis].attrs.get("units", "")).partition(" since ")[0].strip()
    return facts | {"times": tuple(numbers.tolist()), "time_unit": unit or None}


def evenly(array: Any, request: Request) -> tuple[Any, list[str]]:
    """The array with even coordinates, interpolated where `resample` allows it, and a sentence for each such axis."""
    made = []
    skipped = without_lengths(array, list(array.dims))
    for axis in array.dims if request.spacing is None else ():
        if axis in skipped or axis not in array.coords or array.coords[axis].dtype.kind not in "iuf":
            continue
        stored = np.asarray(array.coords[axis])
        if len(stored) < 2 or off_from_even(stored)[2]:
            continue
        places = stored.astype(np.float64)
        steps = np.diff(places)
        text = f"coordinates along {str(axis)!r} are not evenly spaced (steps from {_ends(steps)})"
        if not ((steps > 0).all() or (steps < 0).all()):
            raise FileError(
                f"coordinates along {str(axis)!r} do not grow or fall from each to the next; "
                f"pass spacing=(x, y, z) to draw them as if they were even: {request.path}"
            )
        if request.resample is None:
            raise FileError(
                f"{text}; interpolate to N even places with resample=N (--resample N), or pass spacing=(x, y, z) to "
                f"draw them as if they were: {request.path}"
            )
        array = array.interp({axis: np.linspace(places[0], places[-1], request.resample)})
        made.append(f"{text}; interpolated to {request.resample} even places from {len(places)}")
    return array, made


def _ends(steps: NDArray[np.float64]) -> str:
    lengths = np.abs(steps)
    return f"{lengths.min():g} to {lengths.max():g}"
