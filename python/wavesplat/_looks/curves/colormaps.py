"""Transfer functions from colour maps by name: those of matplotlib, cmocean, ColorBrewer, Crameri, napari and others.

The maps that looks use come from `crates/look`, which also spreads a map over a range (`colormaps.rs`); all others from
the package `cmap`. Where several collections have a map of a name, matplotlib's is meant.
"""

from __future__ import annotations

from collections.abc import Iterable
from difflib import get_close_matches
from functools import cache
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from wavesplat import _native
from wavesplat._looks.curves.transfer_function import TransferFunction
from wavesplat._looks.curves.value_scale import End, values_of
from wavesplat._system.threads import warn
from wavesplat._system.values import described, positive
from wavesplat.errors import ArgumentError

if TYPE_CHECKING:
    from wavesplat._model.volume.volume import Volume
    from wavesplat._model.volume.wavelet_volume import WaveletVolume


Array: TypeAlias = NDArray[np.float64]
Opacity: TypeAlias = str | float | Iterable[float] | Iterable[tuple[float, float]]

#: Values of the first and the last colour, whether places are even in the logarithm, and gamma.
Range: TypeAlias = tuple[float, float, bool, float]

#: Largest number of names that are offered for an unknown one.
N_OFFERED = 6
#: Names of curves of opacity, for messages.
_NAMES = ", ".join(_native.RISES)


def transfer_function(
    name: str,
    volume: Volume | WaveletVolume | None,
    *,
    clim: Iterable[End] | None,
    opacity: Opacity,
    log: bool,
    gamma: float,
    opacity_unit: float | None,
) -> TransferFunction:
    """See `TransferFunction.from_colormap`."""
    positive(gamma, "gamma", "a positive number, 1 changes nothing")
    low, high = _limits(volume, clim, log=log)
    over = (low, high, bool(log), gamma)
    color = _native.map_nodes(*colors_of(name), over)
    return TransferFunction(opacity_nodes(opacity, over), color, opacity_unit)


def _limits(volume: Volume | WaveletVolume | None, clim: Iterable[End] | None, *, log: bool) -> tuple[float, float]:
    from wavesplat._looks.curves import value_scale

    if clim is None:
        if volume is None:
            raise ArgumentError("clim is not given, so it is the volume's; pass clim=(low, high) or the volume")
        if log:
            _warn_of_what_has_no_logarithm(volume)
        low, high = value_scale.ends("log" if log else "fraction", volume)
        return low, high
    low, high = values_of(clim, volume, "clim")
    if log and low <= 0:
        raise ArgumentError(
            f"clim is ({low:g}, {high:g}), and {low:g} has no logarithm; give a positive low, or no log"
        )
    return low, high


def _warn_of_what_has_no_logarithm(volume: Volume | WaveletVolume) -> None:
    from wavesplat._looks.curves import value_scale
    from wavesplat._looks.kinds import histogram

    if volume.value_range[0] > 0:
        return
    share = float(np.mean(histogram.finite_samples(volume) <= 0))
    low, _ = value_scale.positive_range(volume)
    warn(
        f"{100 * share:.3g} % of volume {volume.name!r} are 0 or less and have no logarithm; they are shown as "
        f"{low:.4g}, from where the colours begin",
        stacklevel=5,
    )


def colors_of(name: str) -> tuple[Array, Array]:
    """Places, 0..1, and the colours there, shape (n, 3); maps of categories become steps."""
    if (colors := _native.map_colors(name)) is not None:
        return _even_places(), colors
    import cmap

    colormap = cmap.Colormap(_found(name))
    if colormap.interpolation == "nearest":
        n = len(colormap.color_stops)
        places = np.repeat(np.arange(n + 1) / n, 2)[1:-1]
        steps: Array = colormap((np.arange(n) + 0.5) / n)
        return places, np.repeat(np.asarray(steps, dtype=np.float64)[:, :3], 2, axis=0)
    places = _even_places()
    return places, np.clip(np.asarray(colormap(places), dtype=np.float64)[:, :3], 0, 1)


def _even_places() -> Array:
    return np.arange(_native.MAP_NODES) / (_native.MAP_NODES - 1)


def is_diverging(name: str) -> bool:
    """Whether a map has a middle that its colours part from, as for values of two signs."""
    if (known := _native.map_is_diverging(name)) is not None:
        return known
    import cmap

    return bool(cmap.Colormap(_found(name)).category == "diverging")


def opacity_nodes(opacity: Any, over: Range) -> list[tuple[float, ...]]:
    """Nodes of a curve of opacity over a range: by name, a number, numbers over the range, or nodes."""
    if isinstance(opacity, str):
        if (named := _native.rise_nodes(opacity, (), over)) is None:
            raise ArgumentError(
                f"opacity is {opacity!r}; give {_NAMES}, a number, numbers over clim, or (value, alpha)"
            )
        return list(named)
    table = _table(opacity)
    if table.ndim == 2:
        return [tuple(node) for node in table.tolist()]
    return list(_native.rise_nodes(None, table.tolist(), over) or ())


def _table(opacity: Any) -> Array:
    """A given opacity as an array: numbers, shape (n,), or nodes, shape (n, 2)."""
    try:
        given = opacity if isinstance(opacity, int | float | np.ndarray) else list(opacity)
        table = np.atleast_1d(np.array(given, dtype=np.float64))
    except (TypeError, ValueError, OverflowError):
        table = np.empty(0)
    if not table.size or table.ndim > 2 or (table.ndim == 2 and table.shape[1] != 2):
        raise ArgumentError(
            f"opacity is {described(opacity)}; give {_NAMES}, a number 0..1, such numbers, or (value, alpha)"
        )
    return table


@cache
def _catalogue() -> Any:
    import cmap

    return cmap.Catalog()


def _found(name: str) -> str:
    """The full name of a map in the catalogue, or an `ArgumentError` that offers near ones."""
    catalogue: Any = _catalogue()
    known = {key.lower(): key for key in catalogue.keys()}  # noqa: SIM118 - not a dictionary
    plain = name.strip().lower().replace(" ", "_").replace("-", "_")
    base, reverse = (plain[:-2], "_r") if plain.endswith("_r") and plain not in known else (plain, "")
    if f"matplotlib:{base}" in known:
        return f"{known[f'matplotlib:{base}']}{reverse}"
    if base in known:
        # Where collections share a name, the catalogue's own choice is taken without a note.
        return f"{catalogue.resolve(known[base])}{reverse}"
    short = {key.lower(): key for key in catalogue.short_keys()}
    within = sorted((spelled for spelled in short if base and base in spelled), key=len)
    near = get_close_matches(base, short, N_OFFERED, 0.6)
    offered = list(dict.fromkeys(short[spelled] for spelled in [*near, *within]))[:N_OFFERED]
    hint = f"did you mean {', '.join(offered)}?" if offered else "the names are those of matplotlib and of cmap"
    raise ArgumentError(f"unknown colour map {name!r}; {hint}")
