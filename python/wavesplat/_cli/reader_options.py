"""The options of `wavesplat.open` on the command line, declared once, and the volume that they and INPUT name.

A command that reads a volume has a parameter `reader` and the decorator `takes_reader_options`: Typer then sees one
option for each field of `ReaderOptions` in the place of `reader`, and the command gets them together.
"""

from __future__ import annotations

import inspect
from collections.abc import Callable
from dataclasses import dataclass, fields
from functools import wraps
from typing import TYPE_CHECKING, Annotated, Any, get_type_hints

import typer

from wavesplat._cli import parsers
from wavesplat.errors import ArgumentError

if TYPE_CHECKING:
    from wavesplat._model.volume import Volume
    from wavesplat._model.wavelet_volume import WaveletVolume

__all__ = ["Input", "ReaderOptions", "open_any", "open_samples", "takes_reader_options"]

Input = Annotated[str, typer.Argument(metavar="INPUT", help="A volume: file, folder or URL.", show_default=False)]


@dataclass(frozen=True)
class ReaderOptions:
    """What is said about the input beside its path; the fields are the arguments of `wavesplat.open`."""

    series: Annotated[
        str | None, typer.Option(metavar="UID", help="DICOM: which series, if the folder holds several.")
    ] = None
    time: Annotated[int | None, typer.Option(metavar="N", help="Which time point, from 0.")] = None
    channel: Annotated[int | None, typer.Option(metavar="N", help="Which channel, from 0.")] = None
    dataset: Annotated[str | None, typer.Option(metavar="NAME", help="HDF5, .npz, .vti, Zarr: which array.")] = None
    level: Annotated[int | None, typer.Option(metavar="N", help="OME-Zarr: level of detail, 0 is the finest.")] = None
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
    external_files: Annotated[
        bool, typer.Option("--external-files", help="Read samples from files elsewhere that a trusted file names.")
    ] = False

    def given(self) -> list[str]:
        """The options that were set, as they are written."""
        names = [field.name for field in fields(self) if getattr(self, field.name) != field.default]
        return sorted("--" + name.replace("_", "-") for name in names)


def takes_reader_options(command: Callable[..., None]) -> Callable[..., None]:
    """Give a command these options on the command line, in the place of its parameter `reader`."""
    hints = get_type_hints(ReaderOptions, include_extras=True)
    options = [
        inspect.Parameter(
            field.name, inspect.Parameter.KEYWORD_ONLY, default=field.default, annotation=hints[field.name]
        )
        for field in fields(ReaderOptions)
    ]

    @wraps(command)
    def with_options(**given: Any) -> None:
        reader = ReaderOptions(**{option.name: given.pop(option.name) for option in options})
        command(**given, reader=reader)

    parameters: list[inspect.Parameter] = []
    for parameter in inspect.signature(command, eval_str=True).parameters.values():
        parameters += options if parameter.name == "reader" else [parameter]
    # Typer asks for both, depending on its release.
    with_options.__signature__ = inspect.Signature(parameters)  # type: ignore[attr-defined]
    with_options.__annotations__ = {parameter.name: parameter.annotation for parameter in parameters}
    return with_options


def open_samples(path: str, reader: ReaderOptions) -> Volume:
    """A volume of samples."""
    from wavesplat._readers.opening import open as open_volume

    return open_volume(path, **vars(reader))


def open_any(path: str, reader: ReaderOptions) -> Volume | WaveletVolume:
    """A volume of samples, or a file of wavelet coefficients."""
    if not path.lower().endswith(".wavelets"):
        return open_samples(path, reader)
    from wavesplat._model.wavelet_volume import WaveletVolume

    if reader.given():
        raise ArgumentError(
            f"{', '.join(reader.given())} say nothing about a file of wavelet coefficients; leave them out"
        )
    return WaveletVolume.load(path)
