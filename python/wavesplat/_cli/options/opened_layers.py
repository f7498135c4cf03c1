"""The volume, series, or channels as layers, that INPUT, `--channel`, `--time` and `--times` name."""

from __future__ import annotations

import warnings
from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import inf
from typing import TYPE_CHECKING, Any, NamedTuple

from wavesplat._cli.options.groups import given, part
from wavesplat._cli.options.layers import CHANNEL, ChannelOptions, ChannelText, LayerOptions, channel_of
from wavesplat._cli.options.reader import (
    ProcessingOptions,
    ReaderOptions,
    changed_samples,
    changed_series,
    in_uptake,
    print_guesses,
    processed,
    series_options,
)
from wavesplat._cli.options.transfer_function import ColorOptions, NamedLookOptions, function_of_histogram, named_look
from wavesplat._cli.printing import message, warnings_as_notes
from wavesplat.errors import ArgumentError, FileWarning

if TYPE_CHECKING:
    from wavesplat._looks.look import Look
    from wavesplat._model.arguments.sampling import Composite
    from wavesplat._model.volume.series import Series
    from wavesplat._model.volume.volume import Volume
    from wavesplat._model.volume.wavelet_volume import WaveletVolume
    from wavesplat._scene.layer import Layer


@dataclass(repr=False)
class OpeningOptions:
    """Which channels and times of INPUT are drawn, with which further volumes, how it is read, and processed."""

    layering: LayerOptions = part(LayerOptions)
    reader: ReaderOptions = part(ReaderOptions)
    processing: ProcessingOptions = part(ProcessingOptions)


class FirstLayers(NamedTuple):
    """The volume or series that decides the plane, or its channels as layers, and its colours."""

    layers: list[Any]
    volume: Any
    transfer_function: Any
    is_grey: bool


class Channels(NamedTuple):
    """Channels as layers, and the look of the first."""

    layers: list[Layer]
    look: Look


def opened_layers(
    path: str, options: OpeningOptions, *, composite: Composite | None, quiet: bool, all_times: bool = False
) -> Volume | WaveletVolume | Series | Channels:
    """A volume, a series where several times are to be drawn, or channels with their looks.

    composite : the operator that looks are for.
    all_times : whether a file of several times gives a series if neither `--time` nor `--times` is given.
    """
    from wavesplat._readers.request import SeveralError

    layering, reader, processing = options.layering, options.reader, options.processing
    said = [channel_of(text) for text in layering.channel or ()]
    if path.lower().endswith(".wavelets"):
        named = [f"--{name}" for name, value in (("channel", said), ("times", layering.times)) if value]
        if named:
            raise ArgumentError(f"{', '.join(named)} say nothing about a file of wavelet coefficients; leave them out")
        return processed(path, reader, processing, quiet=quiet)
    number = said[0].which if len(said) == 1 and said[0].is_plain else None
    if not said or isinstance(number, int):
        own = replace(reader, channel=number) if isinstance(number, int) else reader
        try:
            if layering.times is not None:
                return _series(path, own, processing, quiet=quiet)
            return processed(path, own, processing, quiet=quiet)
        except SeveralError as error:
            if error.option == "time" and error.is_known and reader.time is None:
                options = _with_times(options, all_times=all_times)
                found = opened_layers(path, options, composite=composite, quiet=quiet, all_times=all_times)
                if not (quiet or all_times):
                    message(f"note: the file holds {len(error.names)} time points; this is --time 0")
                return found
            # In an array whose axes have no names, no axis is known to be the axis of channels.
            if error.option != "channel" or said or not error.is_known:
                raise
    return _channels(
        path,
        reader,
        said or None,
        processing,
        quiet=quiet,
        composite=composite or "over",
        keeps_times=layering.times is not None or (all_times and reader.time is None),
    )


def opened_in_uptake(
    path: str,
    options: OpeningOptions,
    *,
    composite: Composite | None,
    quiet: bool,
    all_times: bool,
    is_alone: bool,
) -> Volume | WaveletVolume | Series | Channels:
    """The same as `opened_layers`, in SUV if `--suv` is given. is_alone : whether no other file is drawn with it."""

    def opened(suv: bool) -> Volume | WaveletVolume | Series | Channels:
        own = replace(options, reader=replace(options.reader, suv=suv))
        return opened_layers(path, own, composite=composite, quiet=quiet, all_times=all_times)

    return in_uptake(opened, _modality_of, suv=options.reader.suv, is_alone=is_alone)


def _modality_of(opened: Volume | WaveletVolume | Series | Channels) -> str | None:
    """The modality of what was opened; None of channels."""
    from wavesplat._model.volume.series import Series

    if isinstance(opened, Channels):
        return None
    return opened[0].modality if isinstance(opened, Series) else opened.modality


def first_layers(
    input: str,
    channels: ChannelOptions,
    reader: ReaderOptions,
    processing: ProcessingOptions,
    *,
    look: NamedLookOptions,
    colors: ColorOptions,
    is_alone: bool,
    all_times: bool = False,
    n_pixels: float = inf,
    quiet: bool,
) -> FirstLayers:
    """The layers of INPUT with its colours; single pictures and films are allowed.

    all_times : keep all times of a file if no time is given. n_pixels : of the picture, along its longer side.
    """
    from wavesplat._model.volume.series import Series
    from wavesplat._readers.request import taking_planes

    opening = OpeningOptions(LayerOptions(channels.channel), reader, processing)
    with taking_planes(n_pixels):
        opened: Any = opened_in_uptake(
            input, opening, composite=None, quiet=quiet, all_times=all_times, is_alone=is_alone
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


def changed_channels(opened: Channels, colors: ColorOptions, exposure: float = 1.0) -> Channels:
    """The channels with the windows, gamma and opacity of the options, and so much more light."""

    def changed(layer: Layer) -> Layer:
        # Layers of channels have looks of their own.
        own: Look = layer.look  # type: ignore[assignment]
        return replace(layer, look=colors.changed(own, layer.looked_at).changed(exposure=exposure))

    layers = [changed(layer) for layer in opened.layers]
    return Channels(layers, layers[0].look)  # type: ignore[arg-type]


def refuse_for_channels(
    showing: NamedLookOptions, colors: ColorOptions, n: int, of_colors: Sequence[str] = ("cmap", "log")
) -> None:
    """Raise an `ArgumentError` for options that make a look, or coefficients, of one volume.

    of_colors : fields of the options of colours that are for one volume.
    """
    for_one = ("preset", "tf", "materials", "threshold", "wavelet_level", "bands")
    names = [f"--{name.replace('_', '-')}" for name in for_one if getattr(showing, name, None) is not None]
    plain = type(colors)()
    names += [f"--{name}" for name in of_colors if getattr(colors, name) != getattr(plain, name)]
    if names:
        raise ArgumentError(
            f"{', '.join(names)}: for one volume, and the picture is of {n} channels; choose one with --channel, or "
            "say how each is shown: --channel 0:green:100,900"
        )


def _with_times(options: OpeningOptions, *, all_times: bool) -> OpeningOptions:
    """The options completed for a file of several times: all of them, or the first."""
    if all_times:
        return replace(options, layering=replace(options.layering, times="all"))
    return replace(options, reader=replace(options.reader, time=0))


def _series(path: str, reader: ReaderOptions, processing: ProcessingOptions, *, quiet: bool) -> Series:
    from wavesplat._readers.time_points import open_series

    if reader.time is not None:
        raise ArgumentError("--time and --times say the same thing twice; give one of them")
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", FileWarning)  # they are among the guesses
        series = open_series(path, channel=reader.channel, **series_options(reader))
        first = series[0]
    _check_is_no_film(first, path)
    if not quiet:
        print_guesses([first])
    return changed_series(series, processing)


def _check_is_no_film(volume: Volume, path: str) -> None:
    """Raise a `PictureError` for a film if the command does not draw single pictures."""
    from wavesplat._readers.request import requested
    from wavesplat._readers.single_planes import check_thickness, is_single_plane, shape_in_file

    if is_single_plane(volume):
        check_thickness(shape_in_file(volume), requested(path), volume.facts.n_times)


def _channels(
    path: str,
    reader: ReaderOptions,
    said: list[ChannelText] | None,
    processing: ProcessingOptions,
    *,
    quiet: bool,
    composite: Composite,
    keeps_times: bool,
) -> Volume | Series | Channels:
    """Channels as layers; a volume or a series where there is one channel, without colour and window."""
    from wavesplat._looks.look import Look
    from wavesplat._model.volume.series import Series
    from wavesplat._scene.opening import open_scene

    if keeps_times and reader.time is not None:
        raise ArgumentError("--time and --times say the same thing twice; give one of them")
    with warnings_as_notes(quiet=quiet), warnings.catch_warnings():
        warnings.simplefilter("ignore", FileWarning)
        try:
            scene = open_scene(
                path,
                channels=None if said is None else [tuple(one) for one in said],
                time=reader.time or 0,
                composite=composite,
                **series_options(reader),
            )
        except ArgumentError as error:
            if said is None:
                raise
            raise ArgumentError(f"{error} (--channel is {CHANNEL})") from None
    _check_is_no_film(_volume(scene.layers[0]), path)
    if not quiet:
        print_guesses([_volume(layer) for layer in scene.layers])
        times = scene.layers[0].volume
        if isinstance(times, Series) and not keeps_times and reader.time is None:
            message(f"note: the file holds {len(times)} time points; this is --time 0")
    look = scene.layers[0].look
    if isinstance(look, Look):
        return Channels([_changed(layer, processing, keeps_times=keeps_times) for layer in scene.layers], look)
    only = _changed(scene.layers[0], processing, keeps_times=keeps_times)
    return only.volume if isinstance(only.volume, Series) and keeps_times else _volume(only)


def _changed(layer: Layer, processing: ProcessingOptions, *, keeps_times: bool) -> Layer:
    from wavesplat._model.volume.series import Series

    if isinstance(layer.volume, Series) and keeps_times:
        return replace(layer, volume=changed_series(layer.volume, processing))
    if not given(processing):
        return layer
    return replace(layer, volume=changed_samples(_volume(layer), processing), time=0)


def _volume(layer: Layer) -> Volume:
    """The volume of a layer that was read from a file of samples."""
    volume: Any = layer.drawn
    return volume  # type: ignore[no-any-return]
