"""INPUT of `slice`, and of `movie` for films: its layers, and the colours of the first layer on a plane."""

from __future__ import annotations

from math import inf
from typing import Any, NamedTuple

from wavesplat._cli.layer_options import LayerOptions
from wavesplat._cli.opened_layers import Channels, changed_channels, opened_in_uptake, refuse_for_channels
from wavesplat._cli.processing_options import ProcessingOptions
from wavesplat._cli.reader_options import ReaderOptions
from wavesplat._cli.transfer_function_options import (
    ColorOptions,
    LookOptions,
    function_of_histogram,
    named_look,
)

__all__ = ["FirstLayers", "first_layers"]


class FirstLayers(NamedTuple):
    """The volume or series that decides the plane, or its channels as layers, and its colours."""

    layers: list[Any]
    volume: Any
    transfer_function: Any
    is_grey: bool


def first_layers(
    input: str,
    reader: ReaderOptions,
    channel: list[str] | None,
    *,
    look: LookOptions,
    colors: ColorOptions,
    processing: ProcessingOptions,
    is_alone: bool,
    all_times: bool = False,
    n_pixels: float = inf,
    quiet: bool,
) -> FirstLayers:
    """The layers of INPUT with its colours; single pictures and films are allowed.

    all_times : keep all times of a file if no time is given. n_pixels : of the picture, along its longer side.
    """
    from wavesplat._model.series import Series
    from wavesplat._readers.request import taking_planes

    layering = LayerOptions(channel=channel)
    with taking_planes(n_pixels):
        opened: Any = opened_in_uptake(
            input,
            reader,
            layering,
            processing,
            composite=None,
            quiet=quiet,
            all_times=all_times,
            is_alone=is_alone,
        )
    # A window or a range alone maps to greys.
    is_grey = colors == ColorOptions(clim=colors.clim, window=colors.window)
    if isinstance(opened, Channels):
        refuse_for_channels(look, colors, len(opened.layers), ("cmap", "log", "opacity", "gamma"))
        shown = changed_channels(opened, colors)
        return FirstLayers(shown.layers, shown.layers[0].drawn, None, False)
    volume = opened[0] if isinstance(opened, Series) else opened
    if look.preset == "auto":
        return FirstLayers([opened], volume, function_of_histogram(volume, input), is_grey)
    of_look = None if is_grey else colors
    named = named_look(volume, preset=look.preset, tf=look.tf, colors=of_look, opacity=1.0, quiet=quiet)
    return FirstLayers([opened], volume, named and named.transfer_function, is_grey)
