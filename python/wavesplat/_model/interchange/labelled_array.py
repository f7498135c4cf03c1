"""Arrays whose axes have names and coordinates, as xarray's: the order of their axes, and their place.

They are recognised by their attributes, so that xarray need not be installed.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wavesplat._model.interchange.converted import Converted
from wavesplat._model.volume import map_axes, units
from wavesplat._model.volume.facts import Channel, Facts, quantity_of, value_unit_of
from wavesplat._model.volume.grid import UPRIGHT
from wavesplat._model.volume.map_axes import off_from_even
from wavesplat.errors import ArgumentError

#: Names of axes along which a scene has layers, and times, in lower case.
CHANNELS, TIMES = {"c", "ch", "channel", "channels"}, {"t", "time", "times", "frame", "frames"}
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


def in_order(array: Any, *, has_place: bool, of_file: Mapping[str, Any] | None = None) -> Converted:
    """The array itself with its axes as z, y, x, and its place; no sample is read.

    has_place : the caller gives distances of samples, so that only directions of axes are taken.
    of_file : attributes of the file, of a format of models, that the array is in.
    """
    attributes = getattr(array, "attrs", {}) if of_file is None else of_file
    array = _only_array(array)
    sizes = dict(zip(array.dims, array.shape, strict=True))
    spatial = _spatial_axes(array, sizes)
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
    own = getattr(array, "attrs", {})
    modality, value_unit = own.get(MODALITY), value_unit_of(own.get(UNITS))
    is_anatomical = own.get(SPACE) == "RAS"
    is_model = of_file is not None or map_axes.is_of_world(ordered, spatial)
    is_map = is_model and not is_anatomical and modality is None
    facts = Facts(
        modality=modality,
        value_unit=value_unit,
        quantity=quantity_of(title),
        channel=_channel_of(ordered),
        is_anatomical=is_anatomical and not has_place,
        conventions=(UPRIGHT,) if is_map else (),
    )
    is_down = is_map and map_axes.is_downwards(ordered, spatial[0])
    notes = _notes(ordered, spatial, title) if is_map else []
    # Up is up in pictures: the surface of the sea is on top.
    down = [f"z is minus {spatial[0]}, which grows downwards"] if is_down else []
    if has_place:
        signs = [_direction(ordered, axis) if is_map else 1.0 for axis in reversed(spatial)]
        signs[2] *= -1 if is_down else 1
        facts = replace(facts, guesses=(*notes, *down))
        return Converted(ordered, None, facts, title, directions=(signs[0], signs[1], signs[2]))
    matrix, unit, guesses = _place(ordered, spatial, attributes, is_map=is_map)
    if is_down:
        matrix = np.diag([1.0, 1.0, -1.0, 1.0]) @ matrix
    if np.size(own.get(AFFINE, ())) == 16:
        matrix = np.reshape(np.asarray(own[AFFINE], np.float64), (4, 4)) @ matrix
    facts = replace(facts, unit=unit, guesses=(*notes, *guesses, *down))
    return Converted(ordered, matrix, facts, title)


def _place(
    array: Any, spatial: list[Any], attributes: Mapping[str, Any], *, is_map: bool
) -> tuple[NDArray[np.float64], str | None, list[str]]:
    """The affine by the coordinates of the axes z, y, x, the unit of the world, and sentences on what was assumed."""
    skipped = map_axes.without_lengths(array, spatial) if is_map else []
    places = {
        axis: (0.0, _direction(array, name)) if name in skipped else _first_and_step(array, name)
        for axis, name in zip("zyx", spatial, strict=True)
    }
    own = [map_axes.length_unit_of(array, name) for name in reversed(spatial)]
    bare = [str(name) for name in spatial if name not in array.coords]
    z = spatial[0]
    guesses: list[str] = []
    if (steps := map_axes.wrf_steps(array, spatial, attributes) if is_map else None) is not None:
        dx, dy = steps
        places |= {"x": (0.0, dx), "y": (0.0, dy)}
        own = ["m", "m", own[2]]
        if z not in array.coords or skipped:
            places["z"] = (0.0, dx * _direction(array, z))
            unused = "" if map_axes.role_of(array, z) == "time" else ": heights of its levels are not used"
            guesses.append(f"distance along {z} {dx:g} m, as along {spatial[2]}{unused}")
    elif skipped:
        guesses.append(f"distance along {z} 1, as along the others: its numbers are shares, no lengths")
    elif len(bare) in (1, 2):
        guesses.append(f"distance along {', '.join(bare)} 1: the array has no coordinates there")
    elif bare and is_map:
        guesses.append(f"distance of samples 1, 1, 1: the array has no coordinates along {', '.join(bare)}")
    matrix = np.diag([*(places[axis][1] for axis in "xyz"), 1.0])
    matrix[:3, 3] = [places[axis][0] for axis in "xyz"]
    x_y_z = (own[0], own[1], own[2])
    unit, factors = units.in_one_unit(x_y_z)
    matrix[:3] *= np.array(factors)[:, None]
    unit, notes = map_axes.unit_with_notes(array, spatial, unit)
    return matrix, unit, [*notes, *guesses, *units.guesses_of(x_y_z)]


def _notes(array: Any, spatial: list[Any], name: str | None) -> list[str]:
    """Sentences on an axis of times that is drawn as one of space, and on places that are not used."""
    times = [axis for axis in spatial if map_axes.role_of(array, axis) == "time"]
    notes = [f"the axis {str(axis)!r} is drawn as one of space: {name!r} has no third one" for axis in times]
    bare = [axis for axis in spatial if axis not in array.coords]
    curved = sorted(str(axis) for axis in array.coords if array.coords[axis].ndim == 2 and len(bare) > 1)
    if curved:
        notes.append(f"places of its cells differ from row to row, and are not used: {', '.join(curved)}")
    return notes


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
    """The channel by a coordinate that is a name, as after `array.sel(C="GFP")`; None without one."""
    for name in array.coords:
        if str(name).lower() in CHANNELS and array.coords[name].ndim == 0:
            notes = array.coords[name].item()
            return Channel(notes) if isinstance(notes, str) and notes.isprintable() else None
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


def _spatial_axes(array: Any, sizes: dict[Any, int]) -> list[Any]:
    """Names of the axes that become z, y, x: the given ones, else the only three axes longer than 1, in order."""
    names = map_axes.spatial_axes([(name, map_axes.role_of(array, name)) for name in sizes], sizes)
    if len(names) != 3:
        raise ArgumentError(
            f"the array has the axes {', '.join(map(str, sizes))}, of which none are called z, y and x; "
            "choose or rename three, as with array.rename(height='z')"
        )
    return names


def _direction(array: Any, name: Any) -> float:
    """-1 where the coordinates along an axis fall, else 1."""
    places = np.asarray(array.coords[name]) if name in array.coords else np.zeros(0)
    return -1.0 if places.dtype.kind in "iuf" and len(places) > 1 and places[-1] < places[0] else 1.0


def _first_and_step(array: Any, name: Any) -> tuple[float, float]:
    """Coordinate of the first sample along an axis, and the step to the next one, which may be negative."""
    if name not in array.coords:
        return 0.0, 1.0
    places = np.asarray(array.coords[name])
    if places.dtype.kind not in "iuf":
        return 0.0, 1.0
    if len(places) == 1:
        return float(places[0]), 1.0
    step, off, is_even = off_from_even(places)
    if not is_even:
        raise ArgumentError(
            f"coordinates along {name!r} are not evenly spaced (they are off by up to {off:.3g}, in steps of "
            f"{step:.3g}); interpolate with array.interp, or pass spacing=(x, y, z) to draw them as if they were"
        )
    return float(places[0]), step
