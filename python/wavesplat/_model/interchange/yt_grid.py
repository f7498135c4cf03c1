"""Even grids of yt: covering grids, smoothed ones and arbitrary grids, whose fields are [x, y, z] of cells.

They are recognised by their class's library and attributes. A data set of yt, a region or a box of its mesh has no even
samples; a covering grid does, of the level that is asked for.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from wavesplat._model.interchange.converted import Converted
from wavesplat._model.volume import units
from wavesplat._model.volume.facts import Facts, quantity_of, value_unit_of
from wavesplat.errors import ArgumentError

COVERING = "data.covering_grid(level, data.domain_left_edge, data.domain_dimensions * data.refine_by**level)"


def of_yt(thing: Any) -> Converted:
    """Convert a covering grid with the one field that it has in memory."""
    if not all(hasattr(thing, name) for name in ("ActiveDimensions", "left_edge", "dds", "field_data", "ds")):
        raise ArgumentError(
            f"a {type(thing).__name__} of yt has no evenly spaced samples; give a covering grid of the data set, "
            f'grid = {COVERING}, after reading the field to draw, as grid["gas", "density"]'
        )
    fields = [field for field, values in thing.field_data.items() if np.ndim(values) == 3]
    if len(fields) != 1:
        named = ", ".join(repr(field) for field in fields) or "none"
        way = (
            'choose one, as grid.to_xarray(fields=[field])[field] with field = ("gas", "density")'
            if fields
            else 'read the one to draw first, as grid["gas", "density"]'
        )
        raise ArgumentError(f"the grid of yt has {len(fields)} fields in memory ({named}); {way}")
    values = thing.field_data[fields[0]]
    size = [int(n) for n in thing.ActiveDimensions]
    if list(np.shape(values)) != size:
        raise ArgumentError(f"the field {fields[0]!r} has the shape {np.shape(values)}, and the grid {tuple(size)}")
    steps, corner = thing.dds, thing.left_edge
    if hasattr(steps, "to") and hasattr(corner, "units"):
        steps = steps.to(corner.units)
    spacing = np.asarray(steps, np.float64)
    matrix = np.eye(4)
    matrix[:3, :3] = np.diag(spacing)
    matrix[:3, 3] = np.asarray(corner, np.float64) + spacing / 2
    length, factor = units.of_file(str(getattr(corner, "units", "")).replace("code_length", ""))
    matrix[:3] *= factor
    name = str(fields[0][-1] if isinstance(fields[0], tuple) else fields[0])
    facts = Facts(unit=length, value_unit=_unit_of(values), quantity=quantity_of(name))
    return Converted(np.asarray(values).transpose(), matrix, facts, name)


def of_unyt(array: Any) -> Converted:
    """Convert an array with a unit, which does not say in which order its axes are."""
    guesses: tuple[str, ...] = ()
    if np.ndim(array) == 3:
        guesses = (
            "axes z, y, x, as in any array: fields of yt's grids are x, y, z, so give the grid itself, or array.T",
        )
    return Converted(np.asarray(array), facts=Facts(value_unit=_unit_of(array), guesses=guesses))


def _unit_of(values: Any) -> str | None:
    name = str(getattr(values, "units", "")).replace("dimensionless", "")
    return value_unit_of(name.replace("**", "^"))
