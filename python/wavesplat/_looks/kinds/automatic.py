"""The automatic look of a volume, by the kind of its data and its samples.

The compiled module decides (`crates/look`: `automatic.rs`); here it is given facts and samples. The labels of a
segmentation, and colours of a map that people name, are found here.
"""

from __future__ import annotations

from dataclasses import replace
from typing import cast

import numpy as np

from wavesplat import _native
from wavesplat._looks.curves.colormaps import colors_of
from wavesplat._looks.curves.transfer_function import TransferFunction
from wavesplat._looks.curves.transfer_function_2d import TransferFunction2D
from wavesplat._looks.kinds import histogram
from wavesplat._looks.kinds.channels import facts_of_channel
from wavesplat._looks.kinds.kinds import Evidence, Kind, evidence, kind_of
from wavesplat._looks.kinds.looked_at import subsampled_as_float64
from wavesplat._looks.labels import label_names
from wavesplat._looks.labels.labels import Labels
from wavesplat._looks.look import Look
from wavesplat._looks.shading import Shading
from wavesplat._model.arguments.sampling import Composite, composite_name
from wavesplat._model.lazy.volume import LazyVolume
from wavesplat._model.volume.facts import Rgb
from wavesplat._model.volume.grid import axis_of_distant_slices, axis_of_few_slices, is_thin
from wavesplat._model.volume.volume import Volume
from wavesplat._model.volume.wavelet_volume import WaveletVolume
from wavesplat.errors import ArgumentError

#: Kinds whose look has a map of colours over a scale.
COLORED: tuple[Kind, ...] = ("field", "signed field")
#: Light for solid things.
SOLID = Shading(**_native.SOLID_LIGHT)


def is_block(volume: Volume | WaveletVolume, function: TransferFunction) -> bool:
    """Whether matter goes up to the faces of a volume, as in a crop or a small field of view."""
    return _native.is_block(subsampled_as_float64(volume), function._core)


def automatic(volume: Volume | WaveletVolume, composite: Composite | None, color: Rgb | None = None) -> Look:
    """See `Look.auto`; `color` is that of fluorescence, instead of the channel's own."""
    composite = None if composite is None else composite_name(composite)
    low, high = volume.value_range
    refused = _native.look_refused((low, high), bool(volume.n_nonfinite), composite)
    if refused == "uniform":
        raise ArgumentError(
            f"volume {volume.name!r}: every sample is {low:g}, so the histogram shows nothing to tell apart; "
            "pass a transfer function, or check the file"
        )
    if isinstance(volume, WaveletVolume) and volume.is_detail and composite in (None, "over"):
        function = histogram.signed(volume)
        return Look(transfer_function=function, name="auto", reason="details of wavelets: values with two signs")
    if refused is not None:
        raise ArgumentError(
            f"volume {volume.name!r} has samples from {low:g} to {high:g}, too far apart for float64; divide them"
        )
    known = evidence(volume)
    if composite in (None, "over") and (labels := labels_alone(volume, known.kind)) is not None:
        clear = TransferFunction([(0.0, 0.0)], [(0.0, 1.0, 1.0, 1.0)])
        return Look(transfer_function=clear, labels=labels, shading=SOLID, name="auto", reason=known.reason)
    nodes, unit, light, operator, is_on_white, view, is_cut_open, reason = _native.automatic_look(
        _subject(volume, known), composite, color
    )
    return Look(
        transfer_function=TransferFunction(*nodes, opacity_unit=unit),
        shading=None if light is None else Shading(**dict(light)),
        composite=cast("Composite", operator),
        background="white" if is_on_white else None,
        view=view,
        part="cut open" if is_cut_open else None,
        name="auto",
        reason=reason,
    )


def _subject(volume: Volume | WaveletVolume, known: Evidence) -> _native.Subject:
    return {
        "facts": known.facts,
        "kind": known.kind,
        "reason": known.reason,
        "has_few_bright": known.has_few_bright,
        "values": known.values,
        "gradients": known.gradients,
        "fill": known.fill,
        "size": volume.shape,
        "slices": (axis_of_few_slices(volume) is not None, axis_of_distant_slices(volume), is_thin(volume)),
        "channel": facts_of_channel(volume),
        "spread": lambda: subsampled_as_float64(volume),
    }


def labels_alone(volume: Volume | WaveletVolume, kind: Kind) -> Labels | None:
    """The labels of a segmentation, or of a mask that its file names, with the file's names and colours; else None.

    Labels lie in memory: of a segmentation that does not fit there are none.
    """
    if kind not in ("labels", "mask") or not isinstance(volume, Volume) or volume.dtype.kind not in "iuf":
        return None
    named = label_names.of_volume(volume)
    if (kind == "mask" and not named) or (isinstance(volume, LazyVolume) and not volume.fits_in_budget):
        return None
    try:
        labels = Labels(volume.read() if isinstance(volume, LazyVolume) else volume)
    except ArgumentError:  # fractions, or far too many numbers, between the samples that were looked at
        return None
    return labels._with_names(named)


def are_colored(volume: Volume | WaveletVolume, composite: Composite | None) -> bool:
    """Whether the automatic look of a volume has a map of colours, which another one can take the place of."""
    is_detail = isinstance(volume, WaveletVolume) and volume.is_detail
    return composite in (None, "over") and not is_detail and kind_of(volume) in COLORED


def in_colors(look: Look, volume: Volume | WaveletVolume, colormap: str) -> Look:
    """The automatic look of a field in the colours of a map; an `ArgumentError` of other looks."""
    function = look.transfer_function
    if not are_colored(volume, look.composite) or not isinstance(function, TransferFunction):
        raise ArgumentError(
            f"volume {volume.name!r}: the look ({look.composite}, {look.reason}) is not one of a field, whose colours "
            f"a map can take the place of; use TransferFunction.from_colormap({colormap!r}, volume)"
        )
    return replace(look, transfer_function=function_in_colors(function, colormap), name=colormap)


def function_in_colors(function: TransferFunction, colormap: str) -> TransferFunction:
    """The automatic function of a field in the colours of a map: evenly over its nodes."""
    values = [value for value, *_ in function.color]
    places, colors = colors_of(colormap)
    rgb = [np.interp(np.linspace(0, 1, len(values)), places, colors[:, c]).tolist() for c in range(3)]
    return TransferFunction(function.opacity, list(zip(values, *rgb, strict=True)), function.opacity_unit)


def tinted(function: TransferFunction | TransferFunction2D, color: Rgb) -> TransferFunction | TransferFunction2D:
    """The transfer function tinted: its white becomes a colour."""
    if isinstance(function, TransferFunction2D):
        rgba = function.rgba * np.array([*color, 1.0])
        return function._with_rgba(rgba)
    red, green, blue = color
    nodes = [(value, r * red, g * green, b * blue) for value, r, g, b in function.color]
    return TransferFunction(function.opacity, nodes, function.opacity_unit, function.gradient_opacity)
