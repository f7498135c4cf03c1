"""The field that `--color-by FILE[#DATASET]|DATASET[:MAP][:LOW,HIGH]` names, opened, with its colours."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any, NamedTuple

from wavesplat._cli.layer_options import Ends, dataset_of, is_there, named_file, without_window
from wavesplat._cli.printing import warnings_as_notes
from wavesplat.errors import ArgumentError

if TYPE_CHECKING:
    from wavesplat._cli.reader_options import ReaderOptions
    from wavesplat._model.series import Series
    from wavesplat._model.volume import Volume
    from wavesplat._scene.layer import Layer

__all__ = ["ColorText", "color_layer", "color_of"]

SYNTAX = "FILE[#DATASET]|DATASET[:MAP][:LOW,HIGH]"


class ColorText(NamedTuple):
    """A `--color-by`, parsed: a file, or None for INPUT; a dataset of it; colour map and window."""

    path: str | None
    dataset: str | None
    colormap: str | None
    window: Ends | None


def color_of(text: str) -> ColorText:
    """Parse a `--color-by`; what begins with no file that is there is a dataset of INPUT."""
    if is_there(text):
        return ColorText(*dataset_of(text), None, None)
    rest, window = without_window(text, f"--color-by is {SYNTAX}")
    try:
        path, colormap = named_file(rest, "--color-by", SYNTAX, "temperature:inferno:1e4,1e7")
    except ArgumentError:
        # Maps have names such as cmocean:ice, which no dataset has.
        dataset, _, colormap = rest.partition(":")
        if not dataset:
            raise
        return ColorText(None, dataset, colormap or None, window)
    return ColorText(*dataset_of(path), colormap or None, window)


def color_layer(text: str, input: str, reader: ReaderOptions, *, has_times: bool, quiet: bool) -> Layer:
    """The field of colours as a layer.

    reader : options of INPUT, which hold for its other datasets too.
    has_times : whether INPUT is drawn at several times, and so at those of the field.
    """
    from wavesplat._looks.field_colors import field_colors
    from wavesplat._looks.over_time import brightest
    from wavesplat._model.series import Series
    from wavesplat._scene.layer import Layer

    said = color_of(text)
    with warnings_as_notes(quiet=quiet):
        volume = _opened(said, text, input, reader, has_times=has_times)
        seen: Any = brightest(volume) if isinstance(volume, Series) else volume
        # The last part of its name, as colour bars have it.
        own = said.dataset and said.dataset.rpartition("/")[2]
        name = None if own is None else seen.facts.quantity or own
        if said.colormap is None and said.window is None:
            return Layer(volume, name=name)
        try:
            return Layer(volume, field_colors(seen, said.colormap, said.window), name=name)
        except ArgumentError as error:
            raise ArgumentError(f"--color-by is {SYNTAX}: {error}") from None


def _opened(said: ColorText, text: str, input: str, reader: ReaderOptions, *, has_times: bool) -> Volume | Series:
    from wavesplat._cli.reader_options import ReaderOptions

    if said.path is not None:
        # Samples of another file are read as those of INPUT are: as they are drawn, or all at once.
        lazily = {name: getattr(reader, name) for name in ("memory", "holes", "cache")}
        own = ReaderOptions(dataset=said.dataset, time=reader.time, **lazily)
        return _read(said.path, own, has_times=has_times)
    try:
        return _read(input, replace(reader, dataset=said.dataset), has_times=has_times)
    except ArgumentError as error:
        raise ArgumentError(f"--color-by {text!r} begins with no file that is there, and of INPUT: {error}") from None


def _read(path: str, reader: ReaderOptions, *, has_times: bool) -> Volume | Series:
    from wavesplat._cli.opened_layers import series_options
    from wavesplat._cli.reader_options import open_samples
    from wavesplat._readers.time_points import open_series

    if has_times and reader.time is None:
        series = open_series(path, channel=reader.channel, **series_options(reader))
        return series if len(series) > 1 else series[0]
    return open_samples(path, reader, quiet=True)
