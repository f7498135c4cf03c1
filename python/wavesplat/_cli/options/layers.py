"""Options of layers: channels of the file, further volumes, time points.

`--channel NUMBER|NAME[:COLOUR][:LOW,HIGH]` and `--layer FILE[#DATASET][:LOOK][:LOW,HIGH][:threshold=T][:reg=FILE]`
are read from the right, so that names of channels, drives of Windows and URLs may have colons; `--color-by`, the field
that gives a layer its colours, likewise.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar, NamedTuple, TypeAlias

from wavesplat._cli.options.groups import option
from wavesplat._cli.options.reader import ReaderOptions, in_uptake, open_samples, series_options
from wavesplat._cli.printing import message, warnings_as_notes
from wavesplat._storage.addresses import is_address
from wavesplat.errors import ArgumentError

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from wavesplat._model.volume.grid import Grid
    from wavesplat._model.volume.series import Series
    from wavesplat._model.volume.volume import Volume
    from wavesplat._model.volume.wavelet_volume import WaveletVolume
    from wavesplat._scene.layer import Layer

#: Ends of a window: sample values, or percentiles such as "1%".
Ends: TypeAlias = tuple[float | str, float | str]

#: The transform of a registration, as freeview has it: `pet.nii.gz:hot:2,8:reg=pet_to_ct.lta`.
REG, MARK = "[:reg=TRANSFORM]", ":reg="
CHANNEL = "NUMBER|NAME[:COLOR][:LOW,HIGH]"
NAME = ":name="
LAYER = f"FILE[#DATASET][:LOOK][:LOW,HIGH][:threshold=T]{REG}[{NAME}TEXT]"
COLOR_BY = "FILE[#DATASET]|DATASET[:MAP][:LOW,HIGH]"
TIMES = "all|N,N,...|FIRST:END[:STEP]"
#: Placeholder of the time in the name of its picture.
PLACE_OF_TIME = "{time}"
#: Signs of a unit that are left out in names of files.
UNSAFE = re.compile(r"[^A-Za-z0-9]+")
#: The micro sign and the Greek letter -> as they are written in names of files.
MICRO = {0xB5: "u", 0x3BC: "u"}


#: Minimum share of the values above a window that is worth a note, and percentiles of a window in its place.
MANY, INSTEAD = 0.5, "90%,99.8%"


@dataclass(repr=False)
class ChannelOptions:
    """Channels of the file, and further volumes."""

    TITLE: ClassVar = "Layers"

    channel: list[str] | None = option(
        CHANNEL,
        "A channel, from 0, in a colour, over a window of values or percentiles: 0:green:100,900, 1:1%,99.8%, "
        '"DAPI":blue; may be repeated; all if not given.',
    )
    layer: list[str] | None = option(
        LAYER,
        "Another volume in the same picture, such as pet.nii.gz:hot:2,8, clear up to LOW. LOOK: a colour map, a colour "
        "or a preset. threshold=: hidden below it, of maps of two signs between -T and T, opaque beyond. "
        "reg=: the file of an affine transform onto INPUT, of ITK, FreeSurfer (.lta) or FLIRT (.mat). name=: what "
        "legends call it. May be repeated.",
    )


@dataclass(repr=False)
class LayerOptions(ChannelOptions):
    """Channels, further volumes, a field of colours, and times."""

    color_by: str | None = option(
        COLOR_BY,
        "A second field that gives INPUT its colours, such as temperature:inferno:1e4,1e7, a dataset of INPUT; INPUT "
        "itself says how opaque it is, or where its surface lies (first-hit).",
    )
    times: str | None = option(
        TIMES,
        "A picture of each of these time points, all with one look and view; {time} in the name of the output is the "
        "time, such as 30s; else its number is added.",
    )


# Channels


class ChannelText(NamedTuple):
    """A `--channel`, parsed: which one, its colour and its window."""

    which: int | str
    color: str | None
    window: Ends | None

    @property
    def is_plain(self) -> bool:
        """Whether only the channel is named, without colour or window."""
        return self.color is None and self.window is None


def channel_of(text: str) -> ChannelText:
    """Parse a `--channel`."""
    rest, window = without_window(text, f"--channel is {CHANNEL}")
    name, colon, color = rest.rpartition(":")
    if not (colon and name and _is_color(color)):
        name, color = rest, ""
    if not name.strip():
        raise ArgumentError(f"--channel {text!r} names no channel; it is {CHANNEL}, such as 0:green:100,900")
    which = int(name) if re.fullmatch(r"\s*\d{1,9}\s*", name) else name
    return ChannelText(which, color or None, window)


def _is_color(text: str) -> bool:
    from wavesplat._looks.curves import colors

    try:
        return bool(text) and colors.parse(text) is not None
    except ArgumentError:
        return False


def without_window(text: str, syntax: str) -> tuple[str, Ends | None]:
    """The text before a window, and the window, or None if the text does not end with one."""
    rest, colon, last = text.rpartition(":")
    numbers = re.fullmatch(r"\s*([-+.\deE]+%?)\s*,\s*([-+.\deE]+%?)\s*", last) if colon else None
    if numbers is None:
        return text, None
    try:
        ends = [(float(end.removesuffix("%")), end) for end in numbers.groups()]
    except ValueError:
        return text, None
    (low, first), (high, second) = ends
    if first.endswith("%") == second.endswith("%") and not low < high:
        raise ArgumentError(f"the window {last} of {text!r} does not grow; {syntax}, with the smaller value first")
    return rest, (first if first.endswith("%") else low, second if second.endswith("%") else high)


# Further volumes


class LayerText(NamedTuple):
    """A `--layer`, parsed: its file, look, window, threshold, the file of its transform, and its name."""

    path: str
    look: str | None = None
    window: Ends | None = None
    threshold: float | None = None
    transform: str | None = None
    name: str | None = None

    @property
    def is_plain(self) -> bool:
        """Whether nothing says how it looks."""
        return self.look is None and self.window is None and self.threshold is None


def layer_of(text: str) -> LayerText:
    """Parse a `--layer`; the longest beginning that names a file is the file."""
    if Path(text).exists():  # the file's own name ends like a window
        return LayerText(text)
    text, _, name = text.partition(NAME)
    said, transform = split_transform(text, "--layer")
    said, threshold = _without_threshold(said)
    if Path(said).exists():
        return LayerText(said, None, None, threshold, transform, name or None)
    rest, window = without_window(said, f"--layer is {LAYER}")
    path, look = named_file(rest, "--layer", LAYER, "pet.nii.gz:hot:2,8")
    return LayerText(path, look or None, window, threshold, transform, name or None)


def _without_threshold(text: str) -> tuple[str, float | None]:
    """The text before a threshold, and the threshold, or None if the text does not end with one."""
    rest, colon, number = text.rpartition(":threshold=")
    if not colon:
        return text, None
    try:
        return rest, float(number)
    except ValueError:
        raise ArgumentError(f"the threshold {number!r} of {text!r} is no number; --layer is {LAYER}") from None


def named_file(text: str, option: str, syntax: str, example: str) -> tuple[str, str]:
    """The file that the longest beginning of an option's text names, and what follows behind a colon.

    Raises
    ------
    ArgumentError
        If there is no such file.
    """
    parts = text.split(":")
    for count in range(len(parts), 0, -1):
        path, rest = ":".join(parts[:count]), ":".join(parts[count:])
        # Whether a URL exists is not known: after its last slash, what follows a colon is the look.
        is_whole = "/" in parts[count - 1] if is_address(path) else is_there(path)
        if is_whole:
            return path, rest
    raise ArgumentError(f"{option} {text!r} begins with no file that is there; it is {syntax}, such as {example}")


def is_there(path: str) -> bool:
    """Whether FILE, or the file of FILE#DATASET, is there."""
    return any(Path(one).expanduser().exists() for one in (path, dataset_of(path)[0]))


def dataset_of(path: str) -> tuple[str, str | None]:
    """The file of FILE#DATASET, and the dataset, which has no colon; None where the whole names a file."""
    file, _, dataset = path.partition("#")
    has_both = bool(file and dataset) and ":" not in dataset
    return (file, dataset) if has_both and not Path(path).expanduser().exists() else (path, None)


def further_layers(
    texts: Sequence[str] | None, scan: Grid, *, time: int, quiet: bool, suv: bool = False
) -> list[Layer]:
    """The volumes of `--layer`, with their looks.

    scan : the volume that transforms map onto.
    time : the time point of volumes that have several. suv : PET in SUV.
    """
    from wavesplat._readers.request import SeveralError
    from wavesplat._scene.layer import Layer
    from wavesplat._scene.opening import open_scene

    layers: list[Layer] = []
    for said in [layer_of(text) for text in texts or ()]:
        try:
            open_it = partial(_opened, said.path)
            series = in_uptake(open_it, lambda one: one[0].modality, suv=suv, is_alone=False)
        except SeveralError as error:
            if error.option != "channel" or not error.is_known or not said.is_plain:
                raise
            channels = list(open_scene(said.path, time=time).layers)
            if said.transform is not None:
                by = map_of_transform(said.transform, channels[0].drawn, scan, quiet=quiet)
                channels = [replace(layer, volume=layer.volume.moved(by)) for layer in channels]
            layers += channels
            continue
        if said.transform is not None:
            series = series.moved(map_of_transform(said.transform, series[0], scan, quiet=quiet))
        has_many = len(series) > 1
        volume = series if has_many else series[0]
        with warnings_as_notes(quiet=quiet):
            try:
                look: Any = {"threshold": said.threshold, "time": time if has_many else 0, "name": said.name}
                layers.append(Layer.overlay(volume, said.look, said.window, **look))
            except ArgumentError as error:
                raise ArgumentError(f"--layer is {LAYER}: {error}") from None
        note = None if quiet or said.window is None else _note_on_window(layers[-1].looked_at, said.window[1])
        if note is not None:
            message(f"note: {note}")
    return layers


def _note_on_window(volume: Volume | WaveletVolume, high: float | str | None) -> str | None:
    """Advice on a window that ends at `high`, below most values, such as one for SUV of a PET in Bq/ml; else None."""
    import numpy as np

    from wavesplat._looks.kinds.histogram import finite_samples
    from wavesplat._looks.kinds.kinds import unit_of_values

    if not isinstance(high, float | int):
        return None
    values = finite_samples(volume)
    share = float(np.mean(values > high)) if values.size else 0.0
    if share <= MANY:
        return None
    unit = unit_of_values(volume)
    most = f"{volume.value_range[1]:.6g} {unit}".rstrip()
    instead = "--suv, or " if unit == "Bq/ml" else ""
    return (
        f"{100 * share:.0f} % of the values of layer {volume.name!r} lie above its window, which ends at {high:g}, and "
        f"cover what is below; they reach up to {most}: give {instead}a window such as {INSTEAD}"
    )


def _opened(path: str, suv: bool) -> Series:
    from wavesplat._readers.time_points import open_series

    file, dataset = dataset_of(path)
    series = open_series(file, suv=suv, dataset=dataset)
    series[0]
    return series


# The field of `--color-by`


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
    rest, window = without_window(text, f"--color-by is {COLOR_BY}")
    try:
        path, colormap = named_file(rest, "--color-by", COLOR_BY, "temperature:inferno:1e4,1e7")
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
    has_times : whether INPUT is drawn at several times, and so at the times of the field.
    """
    from wavesplat._looks.kinds.field_colors import field_colors
    from wavesplat._looks.over_time import brightest
    from wavesplat._model.volume.series import Series
    from wavesplat._scene.layer import Layer

    said = color_of(text)
    with warnings_as_notes(quiet=quiet):
        volume = _opened_field(said, text, input, reader, has_times=has_times)
        seen: Any = brightest(volume) if isinstance(volume, Series) else volume
        # The last part of its name, as colour bars have it.
        own = said.dataset and said.dataset.rpartition("/")[2]
        name = None if own is None else seen.facts.quantity or own
        if said.colormap is None and said.window is None:
            return Layer(volume, name=name)
        try:
            return Layer(volume, field_colors(seen, said.colormap, said.window), name=name)
        except ArgumentError as error:
            raise ArgumentError(f"--color-by is {COLOR_BY}: {error}") from None


def _opened_field(said: ColorText, text: str, input: str, reader: ReaderOptions, *, has_times: bool) -> Volume | Series:
    if said.path is not None:
        # Samples of another file are read as the samples of INPUT are: as they are drawn, or all at once.
        lazily = {name: getattr(reader, name) for name in ("memory", "holes", "cache")}
        own = ReaderOptions(dataset=said.dataset, time=reader.time, **lazily)
        return _read_field(said.path, own, has_times=has_times)
    try:
        return _read_field(input, replace(reader, dataset=said.dataset), has_times=has_times)
    except ArgumentError as error:
        raise ArgumentError(f"--color-by {text!r} begins with no file that is there, and of INPUT: {error}") from None


def _read_field(path: str, reader: ReaderOptions, *, has_times: bool) -> Volume | Series:
    from wavesplat._readers.time_points import open_series

    if has_times and reader.time is None:
        series = open_series(path, channel=reader.channel, **series_options(reader))
        return series if len(series) > 1 else series[0]
    return open_samples(path, reader, quiet=True)


# Transforms


def split_transform(text: str, option: str) -> tuple[str, str | None]:
    """The text before `:reg=`, and the transform's file behind it, or None."""
    if MARK not in text or Path(text).exists():
        return text, None
    rest, _, transform = text.rpartition(MARK)
    if not (rest and transform):
        raise ArgumentError(f"{option} {text!r} lacks a file; it is FILE{REG}, such as pet.nii.gz:reg=pet_to_ct.lta")
    return rest, transform


def map_of_transform(transform: str, moving: Grid, fixed: Grid, *, quiet: bool) -> NDArray[Any]:
    """The map from the moving scan's world to the fixed one's; what had to be guessed is printed as a note."""
    from wavesplat._readers.transform_files import transform_between

    with warnings_as_notes(quiet=quiet):
        return transform_between(transform, moving, fixed)


# Times


def times_of(text: str, n: int) -> list[int]:
    """The time points that `--times` names, of `n`."""
    if text == "all":
        return list(range(n))
    is_range = ":" in text
    parts = text.split(":" if is_range else ",")
    try:
        numbers = [int(part) if part.strip() or not is_range else None for part in parts]
    except ValueError:
        numbers = []
    if not numbers or (is_range and len(numbers) > 3):
        raise ArgumentError(f"--times is {text!r}; it is {TIMES}, such as 0,5,10 or 0:10")
    if is_range:
        if len(numbers) == 3 and numbers[2] == 0:
            raise ArgumentError(f"--times is {text!r}, whose step is 0; give another one")
        found = list(range(n))[slice(*numbers)]
        if not found:
            raise ArgumentError(f"--times is {text!r}, which selects none of the time points 0..{n - 1}")
        return found
    for number in numbers:
        if number is None or not -n <= number < n:
            raise ArgumentError(f"--times has {number}, but the file holds {n} time points, 0..{n - 1}")
    return [number % n for number in numbers if number is not None]


def names_of_pictures(output: Path, numbers: Sequence[int], texts: Sequence[str]) -> Iterator[tuple[int, Path]]:
    """The number of each time point, and the file for its picture. `texts`: times of all time points, as "30 s"."""
    names = names_of_times(texts)
    for number in numbers:
        if PLACE_OF_TIME in output.name:
            yield number, output.with_name(output.name.replace(PLACE_OF_TIME, names[number]))
        else:
            digits = f"{number:0{len(str(len(texts) - 1))}}"
            yield number, output.with_name(f"{output.stem}_{digits}{output.suffix}")


def names_of_times(texts: Sequence[str]) -> list[str]:
    """Times as parts of names of files, such as "030s"; their numbers where some times are the same."""
    parts = [text.partition(" ") for text in texts]
    longest = max(len(number) for number, _, _ in parts)
    names = [number.zfill(longest) + UNSAFE.sub("", unit.translate(MICRO)) for number, _, unit in parts]
    if len(set(names)) == len(names):
        return names
    return [f"{number:0{len(str(len(texts) - 1))}}" for number in range(len(texts))]
