"""The field that colours a layer as it is drawn: its volume on the picture's axes, its look, and what cannot work."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from wavesplat._looks.curves.transfer_function import TransferFunction
from wavesplat._looks.curves.transfer_function_2d import TransferFunction2D
from wavesplat._looks.labels.labels import Labels
from wavesplat._looks.look import Look
from wavesplat._model.arguments.operators import FirstHit, Operator
from wavesplat._model.lazy.volume import LazyVolume
from wavesplat._model.volume.grid import Grid
from wavesplat._model.volume.volume import Volume
from wavesplat._model.volume.wavelet_volume import WaveletVolume
from wavesplat._scene.drawing.resampling import on_axes_of
from wavesplat.errors import ArgumentError

if TYPE_CHECKING:
    from wavesplat._scene.layer import Layer

#: Map of the measures of labels, whose dark end is seen on black.
MEASURE_MAP = "viridis"
#: Part of a sample by which rounding may take a corner too far.
ROUNDING = 1e-3


@dataclass(frozen=True)
class DrawnColor:
    """A field whose values give a layer its colours."""

    layer: Layer
    #: The field, and the field on the axes of the picture's first layer.
    volume: Volume
    seen: Volume
    look: Look
    function: TransferFunction

    @property
    def name(self) -> str:
        """Name of the field in messages and colour bars."""
        return self.layer.name or self.volume.name

    def function_at(self, opacity: TransferFunction | TransferFunction2D, operator: Operator) -> TransferFunction:
        """The colours by the field's values; on a surface, the colours of a function of two fields at its value."""
        if not isinstance(opacity, TransferFunction2D) or not isinstance(operator, FirstHit):
            return self.function
        rows = opacity.magnitudes
        rgba = opacity([operator.iso_value] * len(rows), rows).tolist()
        nodes = [(value, r, g, b) for value, (r, g, b, _) in zip(rows, rgba, strict=True)]
        return TransferFunction([(rows[0], 1.0)], nodes)


def drawn_color(layer: Layer, drawn: Volume | WaveletVolume, look: Look, first: Grid) -> DrawnColor:
    """The field that colours a layer, as it is drawn.

    drawn : the layer's own volume. look : of the field. first : grid of the picture's first layer.

    Raises
    ------
    ArgumentError
        If either volume has wavelet coefficients, or the look has no colours by value.
    """
    of_field: Layer = layer.color_from
    volume = of_field.drawn
    for name, one in ((layer.name, drawn), (of_field.name, volume)):
        _check_has_samples(layer, name, one)
    assert isinstance(volume, Volume)
    if look.labels is not None:
        raise ArgumentError(
            f"{of_field.name!r}, which colours {layer.name!r}, is a segmentation, whose numbers mean nothing between "
            "two labels; give it as labels= of the scene"
        )
    function = look.transfer_function
    if not isinstance(function, TransferFunction):
        raise ArgumentError(
            f"{of_field.name!r}, which colours {layer.name!r}, has a look of two dimensions; give it a "
            'TransferFunction, and a TransferFunction2D(..., rows="field") as the look of the layer itself'
        )
    _check_covers(layer, drawn, volume)
    seen = on_axes_of(volume, first)
    assert isinstance(seen, Volume)
    return DrawnColor(of_field, volume, seen, look, function)


def labels_by_field(layer: Layer, labels: Labels, given: Look | None) -> tuple[Labels, Look]:
    """Labels in the colours that a field has at its mean over each, and the look that has these colours.

    Labels without a sample of the field, or with missing ones (NaN) alone, are not drawn.

    given : look of the field; None is the map `MEASURE_MAP`, from the least mean to the largest.
    """
    volume = layer.color_from.drawn
    _check_has_samples(layer, layer.color_from.name, volume)
    volume = volume.read() if isinstance(volume, LazyVolume) else volume
    placed = labels.on_samples_of(volume)
    is_known = np.isfinite(volume.samples)
    codes, values = placed._codes[is_known], volume.samples[is_known].astype(np.float64)
    counts, sums = (np.bincount(codes, weights, len(placed.numbers)) for weights in (None, values))
    means = {
        number: sums[code] / counts[code]
        for code, number in enumerate(placed.numbers)
        if counts[code] and number in labels.labels
    }
    if given is None and means:
        low, high = min(means.values()), max(means.values())
        clim = (low, high if high > low else low + max(abs(low), 1.0))
        given = Look(transfer_function=TransferFunction.from_colormap(MEASURE_MAP, clim=clim, opacity=1))
    function = None if given is None else given.transfer_function
    if given is None or not isinstance(function, TransferFunction):
        what = "has no value in any of them" if not means else "has a look of two dimensions; give a TransferFunction"
        raise ArgumentError(f"{layer.color_from.name!r}, which colours the labels of {layer.name!r}, {what}")
    colors = function(list(means.values()))[:, :3].tolist()
    looks = {n: replace(labels.labels[n], color=color) for n, color in zip(means, colors, strict=True)}
    return labels.with_looks(looks), given


def _check_has_samples(layer: Layer, name: str | None, volume: Volume | WaveletVolume) -> None:
    if isinstance(volume, WaveletVolume):
        raise ArgumentError(
            f"{layer.name!r} is coloured by another field, for which both must have samples, but {name!r} is a "
            "WaveletVolume; give its to_volume()"
        )


def _check_covers(layer: Layer, drawn: Grid, field: Grid) -> None:
    """Raise an `ArgumentError` where a layer lies beyond the field that colours it, by more than one of its samples."""
    reach = np.abs(field.world_from_index[:3, :3]).sum(axis=1) * (1 + ROUNDING)
    lower, upper = field.bounds
    if np.all(drawn.bounds[0] >= lower - reach) and np.all(drawn.bounds[1] <= upper + reach):
        return
    places = [
        " to ".join(f"({', '.join(f'{number:g}' for number in corner)})" for corner in grid.bounds)
        for grid in (field, drawn)
    ]
    raise ArgumentError(
        f"{layer.color_from.name!r}, which colours {layer.name!r}, does not cover it: it lies from {places[0]}, and "
        f"{layer.name!r} from {places[1]}; crop the layer to where the field is, or say spacing and place where a file "
        "has none"
    )


def check_rows(layer: Layer, look: Look) -> None:
    """Raise an `ArgumentError` for a function of two dimensions whose rows the layer does not have."""
    function = look.transfer_function
    if not isinstance(function, TransferFunction2D):
        return
    if function.rows == "field" and layer.color_from is None:
        raise ArgumentError(
            f"the look of {layer.name!r} is a function of two fields, and the layer has one; give the other: "
            "wavesplat.Layer(volume, function, color_from=field)"
        )
    if function.rows == "gradient" and layer.color_from is not None:
        raise ArgumentError(
            f"the look of {layer.name!r} has colours by value and gradient, and color_from others; leave out "
            'color_from, or give a TransferFunction, or a TransferFunction2D(..., rows="field")'
        )


def check_operator(layer: Layer, composite: str) -> None:
    """Raise an `ArgumentError` where a layer of two fields is to be projected."""
    if layer.color_from is not None and composite not in ("over", "first-hit"):
        raise ArgumentError(
            f"{layer.name!r} is coloured by another field, and {composite!r} shows one number of each ray; "
            'say composite="over" or FirstHit (--composite over, first-hit), or leave out color_from'
        )
