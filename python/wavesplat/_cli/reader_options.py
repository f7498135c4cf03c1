"""The options of `wavesplat.open` on the command line, declared once, and the volume that they and INPUT name.

A command that reads a volume has a parameter `reader` and the decorator `takes_reader_options`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, Any

import typer

from wavesplat._cli import parsers
from wavesplat._cli.option_groups import given, with_options_of
from wavesplat._cli.printing import message
from wavesplat.errors import ArgumentError

if TYPE_CHECKING:
    from wavesplat._model.volume import Volume
    from wavesplat._model.wavelet_volume import WaveletVolume

__all__ = [
    "Input",
    "InputOrNone",
    "ReaderOptions",
    "open_any",
    "open_samples",
    "print_guesses",
    "takes_reader_options",
    "takes_reader_options_but_channel",
]

InputOrNone = Annotated[
    str | None, typer.Argument(metavar="INPUT", help="A volume: file, folder or URL.", show_default=False)
]
Input = Annotated[str, typer.Argument(metavar="INPUT", help="A volume: file, folder or URL.", show_default=False)]


@dataclass(frozen=True)
class ReaderOptions:
    """Options of reading INPUT; the fields are the arguments of `wavesplat.open`."""

    series: Annotated[
        str | None,
        typer.Option(
            metavar="WHICH",
            help="DICOM, vendors' files: which series, by number, name or start of the UID.",
        ),
    ] = None
    time: Annotated[
        int | None,
        typer.Option(metavar="N", help="Which time point, from 0. DICOM: which volume of a series, such as an echo."),
    ] = None
    channel: Annotated[int | None, typer.Option(metavar="N", help="Which channel, from 0.")] = None
    dataset: Annotated[str | None, typer.Option(metavar="NAME", help="HDF5, netCDF, .npz, VTK, Zarr: which array.")] = (
        None
    )
    level: Annotated[
        int | None, typer.Option(metavar="N", help="Of an image with several: level of detail, 0 is the finest.")
    ] = None
    shape: Annotated[
        Any, typer.Option(metavar="Z,Y,X", parser=parsers.whole_numbers, help="Raw: number of samples.")
    ] = None
    dtype: Annotated[str | None, typer.Option(metavar="TYPE", help='Raw: type of the samples, such as "uint8".')] = None
    spacing: Annotated[
        Any,
        typer.Option(
            metavar="X,Y,Z",
            parser=parsers.numbers(3, "0.7,0.7,1.5"),
            help="Distances of samples, instead of the file's.",
        ),
    ] = None
    byte_order: Annotated[str | None, typer.Option(metavar="little|big", help="Raw: byte order of the samples.")] = None
    offset: Annotated[int, typer.Option(metavar="BYTES", help="Raw: bytes before the first sample.")] = 0
    unit: Annotated[
        str | None, typer.Option(metavar="NAME", help="Unit of lengths, instead of the file's: mm, um, nm, m, ...")
    ] = None
    gaps: Annotated[
        Any,
        typer.Option(
            metavar="fill|refuse",
            parser=parsers.one_of(("fill", "refuse")),
            help="DICOM: fill in slices that are missing, or refuse the series.",
        ),
    ] = "fill"
    suv: Annotated[
        bool, typer.Option("--suv", help="DICOM PET: values as SUV by body weight, corrected for decay.")
    ] = False
    component: Annotated[
        Any,
        typer.Option(
            metavar="x|y|z|magnitude",
            parser=parsers.one_of(("x", "y", "z", "magnitude")),
            help="Of vectors: which component, or their length.",
        ),
    ] = None
    resample: Annotated[
        int | None,
        typer.Option(metavar="N", help="Files of uneven grids: sample them evenly, N samples along the longest side."),
    ] = None
    external_files: Annotated[
        bool, typer.Option("--external-files", help="Read files elsewhere that a trusted file or document names.")
    ] = False
    memory: Annotated[
        str | None,
        typer.Option(metavar="SIZE", help="Read samples as they are drawn, so much of them at once, such as 2GB."),
    ] = None
    holes: Annotated[
        bool, typer.Option("--holes", help="With --memory: leave out samples that cannot be read, and say so.")
    ] = False
    cache: Annotated[
        Any,
        typer.Option(
            metavar="FOLDER",
            parser=parsers.cache_place,
            help="With --memory: keep range and bounds of the samples there, or nowhere: off.",
            show_default=False,
        ),
    ] = True


def takes_reader_options(command: Callable[..., None]) -> Callable[..., None]:
    """Give a command these options on the command line, in the place of its parameter `reader`."""
    return with_options_of(ReaderOptions, "reader", command)


def takes_reader_options_but_channel(command: Callable[..., None]) -> Callable[..., None]:
    """Give a command these options without `--channel`, for which it has an option that says more."""
    return with_options_of(ReaderOptions, "reader", command, without=("channel",))


def open_samples(path: str, reader: ReaderOptions, *, quiet: bool = False) -> Volume:
    """Open a volume of samples; each guess is a note on stderr, unless `quiet`."""
    import warnings

    from wavesplat._readers.opening import open as open_volume
    from wavesplat.errors import FileWarning

    with warnings.catch_warnings():
        # Warnings of files are among the guesses.
        warnings.simplefilter("ignore", FileWarning)
        volume = open_volume(path, **vars(reader))
    if not quiet:
        print_guesses([volume])
    return volume


def print_guesses(volumes: Iterable[Volume]) -> None:
    """Print a note for each guess about volumes, each once."""
    for guess in dict.fromkeys(guess for volume in volumes for guess in volume.guesses):
        message(f"note: {guess}")


def open_any(path: str, reader: ReaderOptions, *, quiet: bool = False) -> Volume | WaveletVolume:
    """A volume of samples, or a file of wavelet coefficients."""
    if not path.lower().endswith(".wavelets"):
        return open_samples(path, reader, quiet=quiet)
    from wavesplat._model.wavelet_volume import WaveletVolume

    if given(reader):
        raise ArgumentError(
            f"{', '.join(given(reader))} say nothing about a file of wavelet coefficients; leave them out"
        )
    return WaveletVolume.load(path)
