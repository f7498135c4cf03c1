"""Two scans on one slice: squares of either in turn, a checkerboard, or the difference of their values."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import ceil
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from wavesplat._looks.curves.transfer_function import TransferFunction
from wavesplat._looks.curves.value_scale import are_percentiles
from wavesplat._looks.kinds.kinds import kind_of, offset_of, unit_of_values
from wavesplat._looks.layer_names import distinct_names, layer_name_of
from wavesplat._model.volume.volume import Volume
from wavesplat._model.volume.volume_like import VolumeLike, as_volume
from wavesplat._model.volume.wavelet_volume import WaveletVolume
from wavesplat._picture.picture import Picture
from wavesplat._picture.report_facts import shown_layer
from wavesplat._render import windows
from wavesplat._render.arguments import chosen_transfer_function
from wavesplat._render.slicing import Planes, in_colors, in_greys, planes_through
from wavesplat._scene.drawing.volumes_of_layers import identity_of
from wavesplat._scene.layer import Layer
from wavesplat._scene.scene import Scene
from wavesplat._system.values import described
from wavesplat.errors import ArgumentError

AnyVolume: TypeAlias = Volume | WaveletVolume
Values: TypeAlias = NDArray[np.float32]

#: The map of differences, and the percentile of their magnitudes that counts as the largest.
COLORMAP, LARGEST = "coolwarm", 99.0
#: Planes and pixels over which the magnitudes of differences are found.
N_PLANES, SIDE_PX = 32, 64
MAX_TILES = 1000


@dataclass(frozen=True)
class Comparison:
    """The second scan of a slice, and how both are shown.

    tiles : squares along the longer side of a checkerboard; None is the difference.
    """

    other: AnyVolume
    tiles: int | None

    def shown(self, scene: Scene, picture: Picture, planes: Planes, given: dict[str, Any], **options: Any) -> Picture:
        """The slice with the second scan.

        picture : the slice of the scene's first volume.
        given : the slice's arguments window, clim, transfer_function and background.
        options : kernel, slab and threads, as for `wavesplat.slice`.
        """
        values = planes.values_of(self.other, **options)
        first = scene.layers[0].drawn
        names = self._names(scene.layers[0])
        if self.tiles is not None:
            shown = _checkered(self, first, picture, values, names=names, **given)
        else:
            shown = _differing(self, first, picture, values, scene, names=names, **given)
        if not np.isfinite(values).any():
            shown.report["notes"] = [
                *shown.report.get("notes", []),
                f"no part of {names[1]!r} lies in the slice",
            ]
        return shown

    def _names(self, first: Layer) -> list[str]:
        """The names of both scans."""
        volumes = first.drawn, self.other
        return distinct_names([first.name or "", layer_name_of(self.other)], lambda n: volumes[n].facts.description)

    def window_of_first(self, window: Any, clim: Any) -> tuple[Any, Any]:
        """Arguments window and clim of the first scan's slice; given ones are for the difference, if there is one."""
        return (None, (0.0, 1.0)) if self.tiles is None else (window, clim)


def comparison(
    checkerboard: VolumeLike | None, tiles: int, difference: VolumeLike | None, *, n_channels: int
) -> Comparison | None:
    """The arguments checkerboard, tiles and difference, checked; None where there is no second scan."""
    if n_channels and not (checkerboard is None and difference is None):
        raise ArgumentError(f"a second scan is for one volume, and the scene has {n_channels} channels; choose one")
    if checkerboard is not None and difference is not None:
        raise ArgumentError("checkerboard and difference both show a second scan; give one of them")
    if difference is not None:
        return Comparison(as_volume(difference, argument="difference"), None)
    if checkerboard is None:
        return None
    given: object = tiles
    if isinstance(given, bool) or not isinstance(given, int | np.integer) or not 2 <= given <= MAX_TILES:
        raise ArgumentError(f"tiles is {described(tiles)}; give 2 to {MAX_TILES} squares along the longer side")
    return Comparison(as_volume(checkerboard, argument="checkerboard"), int(tiles))


def _checkered(
    chosen: Comparison,
    first: AnyVolume,
    picture: Picture,
    values: Values,
    *,
    names: Sequence[str],
    window: Any,
    clim: Any,
    transfer_function: Any,
    background: str | Sequence[float] | None,
) -> Picture:
    """Squares of both scans in turn; the upper left one is of the first."""
    report = picture.report
    other = chosen.other
    fields: dict[str, Any] = {"checkerboard": names[1], "tiles": chosen.tiles}
    if transfer_function is not None:
        curves: Any = chosen_transfer_function(transfer_function, first)
        rgba = in_colors(values, curves, background)
    else:
        limits = _limits_of(other, first, report["clim"], window, clim)
        rgba = in_greys(values, limits, background)
        fields["clim"] = limits
        if limits != tuple(report["clim"]):
            greys = TransferFunction([(limits[0], 1), (limits[1], 1)], [(limits[0], 0, 0, 0), (limits[1], 1, 1, 1)])
            report["shown"] += [shown_layer(names[1], "over", greys, unit_of_values(other))]
            low, high = report["clim"]
            note = (
                f"black and white are {low:g} and {high:g} of {names[0]!r}, {limits[0]:g} and {limits[1]:g} of "
                f"{names[1]!r}: their values have no scale in common"
            )
            report["notes"] = [*report.get("notes", []), note]
    report["shown"][0]["name"] = names[0]
    report["compared"] = fields
    height, width = values.shape
    side = ceil(max(width, height) / fields["tiles"])
    rows, columns = np.arange(height) // side, np.arange(width) // side
    is_other = (rows[:, None] + columns) % 2 == 1
    assert picture.value is not None
    return Picture(
        np.where(is_other[..., None], rgba, picture.rgba),
        value=np.where(is_other, values, picture.value),
        report=report,
    )


def _limits_of(
    other: AnyVolume, first: AnyVolume, of_first: tuple[float, float], window: Any, clim: Any
) -> tuple[float, float]:
    """The values of the second scan that are black and white: the first scan's, where a value means the same."""
    if window is not None or clim is not None:
        is_alike = kind_of(other) == kind_of(first)
        return windows.limits(other, window, clim) if is_alike else windows.limits(other, None, None)
    unit = unit_of_values(first)
    shift = offset_of(other) - offset_of(first)
    low, high = of_first[0] + shift, of_first[1] + shift
    return (low, high) if unit and unit == unit_of_values(other) else windows.limits(other, None, None)


def _differing(
    chosen: Comparison,
    first: AnyVolume,
    picture: Picture,
    values: Values,
    scene: Scene,
    *,
    names: Sequence[str],
    window: Any,
    clim: Any,
    transfer_function: Any,
    background: str | Sequence[float] | None,
) -> Picture:
    """The first scan minus the second, float32, in a map of two signs."""
    other = chosen.other
    units = unit_of_values(first), unit_of_values(other)
    if all(units) and units[0] != units[1]:
        raise ArgumentError(
            f"values of {first.name!r} are in {units[0]}, values of {other.name!r} in {units[1]}, so they have no "
            "difference; open both in one unit"
        )
    offsets = offset_of(first), offset_of(other)
    if offsets[0] != offsets[1]:
        raise ArgumentError(
            f"values of {first.name!r} are Hounsfield units with {offsets[0]:g} added, values of {other.name!r} with "
            f"{offsets[1]:g}, so their difference says nothing; subtract these from the samples first"
        )
    if isinstance(window, str):
        raise ArgumentError(
            f"window {window!r} is for Hounsfield units, not for differences; give clim, such as (-200, 200)"
        )
    assert picture.value is not None
    value = picture.value - values
    report = picture.report
    report.pop("notes", None)  # on the greys of the first scan
    for name in ("window", "clim"):
        report.pop(name, None)
    if transfer_function is not None:
        curves: Any = chosen_transfer_function(transfer_function, first)
    else:
        if window is None and clim is None:
            key = (id(first), id(other), "difference")
            identity = identity_of(first), identity_of(other)
            most = scene._cache.get_or_compute(key, identity, lambda: _largest(first, other))
            clim = (-most, most)
        if are_percentiles(window) or are_percentiles(clim):
            raise ArgumentError(
                "percentiles of a difference are not known before it is drawn; give its window or clim in values, such "
                "as clim=(-100, 100)"
            )
        low, high = windows.limits(first, window, clim)
        curves = TransferFunction.from_colormap(COLORMAP, clim=(low, high), opacity=1.0)
        report["window"], report["clim"] = ((low + high) / 2, high - low), (low, high)
    report["compared"] = {"difference": names[1]}
    name = f"{names[0]} - {names[1]}"
    report["shown"] = [shown_layer(name, "over", curves, units[0] if units[0] == units[1] else "")]
    return Picture(in_colors(value, curves, background), value=value, report=report)


def _largest(first: AnyVolume, other: AnyVolume) -> float:
    """The magnitude that counts as the largest of the differences, over the whole of the first scan."""
    options: Any = {"kernel": "linear", "slab": "maximum", "threads": None}
    found = [np.zeros(0, np.float32)]
    for planes in planes_through(first, N_PLANES, (SIDE_PX, SIDE_PX)):
        part = planes.values_of(first, **options) - planes.values_of(other, **options)
        found.append(np.abs(part[np.isfinite(part)]))
    magnitudes = np.concatenate(found)
    most = float(np.percentile(magnitudes, LARGEST)) if magnitudes.size else 0.0
    return most if most > 0 else 1.0
