"""Arrays whose axes have names and coordinates, as xarray's: the order of their axes, and their place.

They are recognised by their attributes, so that xarray need not be installed.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from wavesplat._model import units
from wavesplat._model.converted import Converted
from wavesplat._model.facts import Channel, Facts, quantity_of, value_unit_of
from wavesplat._model.placement import UPRIGHT
from wavesplat.errors import ArgumentError

__all__ = ["AFFINE", "MODALITY", "SPACE", "UNITS", "channel_and_time_axes", "in_order", "is_labelled", "unlabelled"]

#: Names of axes, in lower case -> ours.
NAMES = {
    **dict.fromkeys(("z", "depth", "plane", "slice", "lev", "level", "altitude", "alt"), "z"),
    **dict.fromkeys(("y", "row", "lat", "latitude"), "y"),
    **dict.fromkeys(("x", "col", "column", "lon", "longitude"), "x"),
}
#: Names of axes that grow to the north, which is up on maps.
LATITUDES = ("lat", "latitude")
#: Names of axes along which a scene has layers, and times, in lower case.
CHANNELS, TIMES = {"c", "ch", "channel", "channels"}, {"t", "time", "times", "frame", "frames"}
#: Tolerance of coordinates, as a fraction of the step: many are float32.
TOLERANCE = 1e-3
#: Names of an array's attributes: the affine from the coordinates (x, y, z, 1) to the world where they are not the
#: world's own, row by row; "RAS" where the world is a patient's; how it was measured. `Volume.to_xarray` writes them.
AFFINE, SPACE, MODALITY = "world_from_coordinates", "space", "modality"
#: The attribute for the unit of values, by the conventions for climate and forecast metadata (CF).
UNITS = "units"


def is_labelled(samples: object) -> bool:
    """Whether an array has names and coordinates for its axes."""
    return hasattr(samples, "dims") and hasattr(samples, "coords")


def unlabelled(array: Any, *, has_place: bool) -> Converted:
    """The samples as [z, y, x]. `has_place`: the caller gives the place, so coordinates do not count."""
    found = in_order(array, has_place=has_place)
    return replace(found, samples=np.asarray(found.samples))


def in_order(array: Any, *, has_place: bool) -> Converted:
    """The array itself with its axes as z, y, x, and its place; no sample is read."""
    array = _only_array(array)
    sizes = dict(zip(array.dims, array.shape, strict=True))
    spatial = _spatial_axes(sizes)
    extra = [name for name in array.dims if name not in spatial]
    for name in extra:
        if sizes[name] != 1:
            is_of_scene = name in channel_and_time_axes(array)
            raise ArgumentError(
                f"the array has the axes {', '.join(map(str, array.dims))}; a volume is z, y, x: "
                f"choose one place along {name!r}, as with array.isel({name}=0)"
                f"{', or take all of them: wavesplat.Scene(array)' if is_of_scene else ''}"
            )
    ordered = array.isel(dict.fromkeys(extra, 0)).transpose(*spatial)
    title = None if array.name is None else str(array.name)
    said = getattr(array, "attrs", {})
    modality, value_unit = said.get(MODALITY), value_unit_of(said.get(UNITS))
    channel = _channel_of(ordered)
    values = Facts(modality=modality, value_unit=value_unit, quantity=quantity_of(title), channel=channel)
    if has_place:
        return Converted(ordered, None, values, title)
    places = {axis: _first_and_step(ordered, name) for axis, name in zip("zyx", spatial, strict=True)}
    matrix = np.diag([*(places[axis][1] for axis in "xyz"), 1.0])
    matrix[:3, 3] = [places[axis][0] for axis in "xyz"]
    x, y, z = (_unit_of(ordered, name) for name in reversed(spatial))
    unit, factors = units.in_one_unit((x, y, z))
    matrix[:3] *= np.array(factors)[:, None]
    if np.size(said.get(AFFINE, ())) == 16:
        matrix = np.reshape(np.asarray(said[AFFINE], np.float64), (4, 4)) @ matrix
    bare = [str(name) for name in spatial if name not in ordered.coords]
    guesses = (
        () if len(bare) in (0, 3) else (f"distance along {', '.join(bare)} 1: the array has no coordinates there",)
    )
    guesses = (*guesses, *units.guesses_of((x, y, z)))
    facts = replace(
        values,
        unit=unit,
        is_anatomical=said.get(SPACE) == "RAS",
        conventions=(UPRIGHT,) if str(spatial[1]).lower() in LATITUDES else (),
        guesses=guesses,
    )
    return Converted(ordered, matrix, facts, title)


def channel_and_time_axes(array: Any) -> tuple[Any, Any]:
    """Names of the axes of channels and of times, which a scene has all of; None for one that is not longer than 1.

    Where fewer than three axes are left beside them, they are an axis of the volume itself, such as times as slices.
    """
    long = [name for name, size in zip(array.dims, array.shape, strict=True) if size > 1]
    channels, times = ([name for name in long if str(name).lower() in known] for known in (CHANNELS, TIMES))
    if len(array.dims) - len(channels) - len(times) < 3:
        return None, None
    return channels[0] if len(channels) == 1 else None, times[0] if len(times) == 1 else None


def _channel_of(array: Any) -> Channel | None:
    """The channel by a coordinate that is a name, as of `array.sel(C="GFP")`; None without one."""
    for name in array.coords:
        if str(name).lower() in CHANNELS and array.coords[name].ndim == 0:
            told = array.coords[name].item()
            return Channel(told) if isinstance(told, str) and told.isprintable() else None
    return None


def _only_array(array: Any) -> Any:
    """The array itself, or the only array of a Dataset."""
    arrays = getattr(array, "data_vars", None)
    if arrays is None and hasattr(array, "transpose"):
        return array
    if arrays is not None and len(arrays) == 1:
        return next(iter(arrays.values()))
    names = ", ".join(map(str, arrays or ())) or "none"
    raise ArgumentError(f"this is a {type(array).__name__} of several arrays ({names}); give one of them")


def _spatial_axes(sizes: dict[Any, int]) -> list[Any]:
    """Names of the axes that become z, y, x: those with such names, else the only three (longer than 1), in order."""
    ours: dict[str, list[Any]] = {}
    for name in sizes:
        ours.setdefault(NAMES.get(str(name).lower(), ""), []).append(name)
    if all(len(ours.get(axis, [])) == 1 for axis in "zyx"):
        return [ours[axis][0] for axis in "zyx"]
    long = [name for name, size in sizes.items() if size != 1]
    names = list(sizes) if len(sizes) == 3 else long
    if len(names) != 3:
        raise ArgumentError(
            f"the array has the axes {', '.join(map(str, sizes))}, of which none are called z, y and x; "
            "choose or rename three, as with array.rename(height='z')"
        )
    return names


def _first_and_step(array: Any, name: Any) -> tuple[float, float]:
    """Coordinate of the first sample along an axis, and the step to the next one, which may be negative."""
    if name not in array.coords:
        return 0.0, 1.0
    places = np.asarray(array.coords[name])
    if places.dtype.kind not in "iuf":
        return 0.0, 1.0
    places = places.astype(np.float64)
    if len(places) == 1:
        return float(places[0]), 1.0
    step = (places[-1] - places[0]) / (len(places) - 1)
    off = np.abs(places - (places[0] + step * np.arange(len(places)))).max()
    # Written so that NaN is uneven too.
    if not (step != 0 and off <= TOLERANCE * abs(step)):
        raise ArgumentError(
            f"coordinates along {name!r} are not evenly spaced (they are off by up to {off:.3g}, in steps of "
            f"{step:.3g}); interpolate with array.interp, or pass spacing=(x, y, z) to draw them as if they were"
        )
    return float(places[0]), float(step)


def _unit_of(array: Any, name: Any) -> str | None:
    attributes = getattr(array.coords[name], "attrs", {}) if name in array.coords else {}
    return units.canonical(attributes.get("units", attributes.get("unit")))
