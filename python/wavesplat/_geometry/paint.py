"""Colours of shapes: one for all, one for each vertex or point, or the colours of a map by values."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from wavesplat._geometry.positions import checked_values, frozen, numbers_of, row_of
from wavesplat._looks.curves import colormaps, colors
from wavesplat._system.values import described
from wavesplat.errors import ArgumentError

if TYPE_CHECKING:
    from wavesplat import _native

#: A colour for all, or an array of one for each.
Color: TypeAlias = Any

#: Values, their colour map, and the values of its ends.
Mapped: TypeAlias = tuple[NDArray[np.float64], str, tuple[float, float]]

#: Colour map of values without one: even steps of value look even.
CMAP = "viridis"
#: Entries of the table of a map of categories, whose steps lie between two entries.
N_STEPPED = 1024
#: Largest place of a value in a colour map, of which 0 and 1 are the ends; between two points values are linear.
FARTHEST = 1e30


def checked_color(color: Any, n: int, what: str, each: str) -> Any:
    """A colour as (r, g, b) or (r, g, b, a), or an array of one for each of `n`, float32 of shape (n, 4)."""
    if isinstance(color, str):
        return _one(color, what)
    try:
        ndim = np.ndim(color)
    except ValueError:
        ndim = 1
    if ndim < 2:
        return _one(color, what)
    form = f"a colour for each {each}, an array of shape ({n}, 3) or ({n}, 4) with numbers 0..1, or bytes"
    array = np.asarray(color)
    scale = 255.0 if array.dtype == np.uint8 else 1.0
    array = numbers_of(color, what, form) / scale
    if array.ndim != 2 or array.shape[0] != n or array.shape[1] not in (3, 4):
        raise ArgumentError(f"{what} has shape {array.shape}; give one colour, or {form}")
    is_right = ((array >= 0) & (array <= 1)).all(axis=1)
    if not is_right.all():
        row = int(np.argmin(is_right))
        raise ArgumentError(f"{row_of(what, row)} is {tuple(array[row].tolist())}; give {form}")
    rgba = np.ones((n, 4), np.float32)
    rgba[:, : array.shape[1]] = array
    return frozen(rgba)


def _one(color: Any, what: str) -> Any:
    try:
        rgba = colors.parse(color)
    except ArgumentError as error:
        raise ArgumentError(f"{what}: {error}") from None
    if rgba is None:
        raise ArgumentError(f"{what} is {described(color)}; give a colour, and opacity=0 to leave the shape out")
    return rgba


def checked_clim(clim: Any, values: NDArray[np.float64], what: str) -> tuple[float, float]:
    """The values of both ends of a colour map, given as numbers or percentiles; None is the least and the largest."""
    if clim is not None:
        clim = _without_percentiles(clim, values)
        ends = numbers_of(clim, f"clim of {what}", "(low, high), two numbers")
        if ends.shape != (2,) or not np.isfinite(ends).all() or not ends[0] < ends[1]:
            raise ArgumentError(
                f"clim of {what} is {described(clim, lists=True)}; give (low, high), the smaller number first"
            )
        return float(ends[0]), float(ends[1])
    there = values[~np.isnan(values)]
    if not len(there):
        raise ArgumentError(f"values of {what} are all NaN, so nothing would be drawn; give color= instead")
    low, high = float(there.min()), float(there.max())
    # One value for all has the middle of the map.
    middle, reach = (low + high) / 2, 0.5 * max(1.0, abs(low) * 1e-3)
    return (low, high) if low < high else (middle - reach, middle + reach)


def _without_percentiles(clim: Any, values: NDArray[np.float64]) -> Any:
    """The ends with values in place of percentiles, such as "1%"."""
    if not isinstance(clim, list | tuple) or not any(isinstance(end, str) and end.endswith("%") for end in clim):
        return clim
    try:
        return [
            float(np.nanpercentile(values, float(end[:-1]))) if isinstance(end, str) and end.endswith("%") else end
            for end in clim
        ]
    except ValueError:
        return clim


def checked_paint(
    color: Any, values: Any, cmap: str | None, clim: Any, *, n: int, what: str, each: str
) -> tuple[Any, Any, str | None, tuple[float, float] | None]:
    """Colour, values, colour map and its ends of a shape; an `ArgumentError` where they cannot work together."""
    if values is None:
        for name, given in (("cmap", cmap), ("clim", clim)):
            if given is not None:
                raise ArgumentError(f"{name} of {what} colours values; give values=, a number for each {each}")
        return (None if color is None else checked_color(color, n, f"color of {what}", each)), None, None, None
    if color is not None:
        raise ArgumentError(f"color and values of {what} both say its colours; give one of them")
    if not isinstance(cmap, str | None):
        raise ArgumentError(f'cmap of {what} is {described(cmap)}; give the name of a colour map, such as "viridis"')
    name = CMAP if cmap is None else cmap
    try:
        colormaps.colors_of(name)
    except ArgumentError as error:
        raise ArgumentError(f"cmap of {what}: {error}") from None
    checked = checked_values(values, n, f"values of {what}", each)
    return None, checked, name, checked_clim(clim, checked, what)


def table_of(cmap: str) -> NDArray[np.float32]:
    """Evenly spaced colours of a map, straight RGBA."""
    places, rgb = colormaps.colors_of(cmap)
    n = N_STEPPED if len(np.unique(places)) < len(places) else len(places)
    # At a step, two nodes have one place; entries lie beside it.
    at = np.linspace(0, 1, n) if n == len(places) else (np.arange(n) + 0.5) / n
    table = np.ones((n, 4), np.float32)
    table[:, :3] = np.stack([np.interp(at, places, channel) for channel in rgb.T], axis=1)
    return table


def paint_of(color: Any, mapped: Mapped | None, opacity: float, default: Any) -> tuple[_native.ShapePaint, float]:
    """Checked colours as the compiled module takes them, and the opacity, times the alpha of a single colour.

    color : checked; None is `default`. mapped : values and their colours instead.
    """
    if mapped is not None:
        values, cmap, (low, high) = mapped
        # Places in the map, since float32 does not hold small differences of large values.
        places = np.clip((values - low) / (high - low), -FARTHEST, FARTHEST).astype(np.float32)
        return {"rgb": None, "rgba": None, "mapped": (places, (0.0, 1.0), table_of(cmap))}, opacity
    if isinstance(color, np.ndarray):
        return {"rgb": None, "rgba": color, "mapped": None}, opacity
    red, green, blue, alpha = (*(default if color is None else color), 1.0)[:4]
    return {"rgb": (red, green, blue), "rgba": None, "mapped": None}, opacity * alpha
