"""Options of processing the samples once they are read, declared once."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, Any

import typer

from wavesplat._cli.option_groups import given, with_options_of
from wavesplat._cli.reader_options import ReaderOptions, open_any, open_samples
from wavesplat.errors import ArgumentError

if TYPE_CHECKING:
    from wavesplat._model.series import Series
    from wavesplat._model.volume import Volume
    from wavesplat._model.wavelet_volume import WaveletVolume

__all__ = [
    "ProcessingOptions",
    "changed_samples",
    "changed_series",
    "processed",
    "processed_samples",
    "takes_processing_options",
]


def _deviation(text: str) -> tuple[float, str | None]:
    """A number, and its unit of length; None is voxels."""
    from wavesplat._model import units

    parts = re.fullmatch(r"([\d.]+(?:e[+-]?\d+)?)(\D*)", text.strip())
    try:
        return float(parts[1] if parts else text), units.canonical(parts[2]) if parts else None
    except ValueError:
        raise typer.BadParameter(f"{text!r} is not a number of voxels or a length, such as 0.7 or 1mm") from None


@dataclass(frozen=True)
class ProcessingOptions:
    """Steps of processing the samples, in this order."""

    remove_table: Annotated[
        bool,
        typer.Option(
            "--remove-table",
            help="Keep the largest body of a CT alone: no table, headrest and blanket. Needs SciPy.",
            show_default=False,
        ),
    ] = False
    smooth: Annotated[
        Any,
        typer.Option(
            metavar="VOXELS|LENGTH",
            parser=_deviation,
            help="Smooth by a Gaussian of this deviation: 0.7 in voxels, or 1mm, 20um.",
        ),
    ] = None


def takes_processing_options(command: Callable[..., None]) -> Callable[..., None]:
    """Give a command these options on the command line, in the place of its parameter `processing`."""
    return with_options_of(ProcessingOptions, "processing", command)


def processed(
    path: str, reader: ReaderOptions, processing: ProcessingOptions, *, quiet: bool = False
) -> Volume | WaveletVolume:
    """The volume that INPUT names, processed; or its wavelet coefficients, which cannot be."""
    if not path.lower().endswith(".wavelets"):
        return processed_samples(path, reader, processing, quiet=quiet)
    if given(processing):
        raise ArgumentError(
            f"{', '.join(given(processing))} change samples, and this is a file of wavelet coefficients; give them to "
            "`wavesplat wavelet`, which makes such files"
        )
    return open_any(path, reader, quiet=quiet)


def processed_samples(
    path: str, reader: ReaderOptions, processing: ProcessingOptions, *, quiet: bool = False
) -> Volume:
    """The volume of samples that INPUT names, processed."""
    return changed_samples(open_samples(path, reader, quiet=quiet), processing)


def changed_samples(volume: Volume, processing: ProcessingOptions) -> Volume:
    """The volume after the processing."""
    if processing.remove_table:
        from wavesplat._looks.largest_body import largest_body

        volume = largest_body(volume)
    return volume if processing.smooth is None else _smoothed(volume, *processing.smooth)


def changed_series(series: Series, processing: ProcessingOptions) -> Series:
    """The series with volumes that are processed when they are read."""
    from wavesplat._model.series import Series

    if not given(processing):
        return series
    return Series(_Changed(series, processing), name=series.name)


class _Changed:
    def __init__(self, series: Series, processing: ProcessingOptions) -> None:
        self._series, self._processing = series, processing

    def __len__(self) -> int:
        return len(self._series)

    def __getitem__(self, number: int) -> Volume:
        return changed_samples(self._series[number], self._processing)

    def times(self) -> tuple[tuple[float, ...], str | None]:
        return self._series.times, self._series.time_unit

    def description(self) -> str:
        return f"series {self._series.name!r}"


def _smoothed(volume: Volume, deviation: float, unit: str | None) -> Volume:
    from wavesplat._model import units

    if unit is None:
        return volume.smoothed(deviation)
    size, of_volume = units.metres(unit), units.metres(volume.unit)
    if unit == volume.unit:
        size = of_volume = 1.0
    if size is None or of_volume is None:
        known = f"is in {volume.unit}" if volume.unit else "names no unit; give it with --unit"
        raise ArgumentError(f"--smooth is {deviation:g} {unit}, and the file {known}, or give --smooth in voxels")
    return volume.smoothed(float(f"{deviation * size / of_volume:.12g}"), unit="world")
