"""The options of `wavesplat.open` on the command line, of processing what was read, and the volume that they name."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar, TypeVar

from wavesplat._cli.options import parsers
from wavesplat._cli.options.groups import given, option
from wavesplat._cli.printing import message
from wavesplat._readers.options import OpenOptions, OpenValues
from wavesplat.errors import ArgumentError, FileError

if TYPE_CHECKING:
    from wavesplat._model.volume.series import Series
    from wavesplat._model.volume.volume import Volume
    from wavesplat._model.volume.wavelet_volume import WaveletVolume
    from wavesplat._scene.scene import Scene

T = TypeVar("T")


class ReaderOptions(OpenValues):
    """The options of `wavesplat.open`: here is how they are written."""

    TITLE: ClassVar = "What is read"
    DOCUMENTED: ClassVar = OpenOptions
    WRITTEN: ClassVar = {
        "series": option("WHICH"),
        "time": option("N"),
        "channel": option("N"),
        "dataset": option("NAME"),
        "level": option("N"),
        "shape": option("Z,Y,X", parser=parsers.whole_numbers),
        "dtype": option("TYPE"),
        "spacing": option("X,Y,Z", parser=parsers.numbers(3, "0.7,0.7,1.5")),
        "byte_order": option("little|big"),
        "offset": option("BYTES"),
        "unit": option("NAME"),
        "gaps": option("fill|refuse", choices=("fill", "refuse")),
        "suv": option(),
        "component": option("x|y|z|magnitude", choices=("x", "y", "z", "magnitude")),
        "resample": option("N"),
        "external_files": option(),
        "memory": option("SIZE"),
        "holes": option(),
        "cache": option(
            "FOLDER",
            "With --memory: keep range and bounds of the samples there, or nowhere: off.",
            parser=parsers.cache_place,
            show_default=False,
        ),
    }


@dataclass(repr=False)
class ProcessingOptions:
    """Steps of processing the samples once they are read, in this order."""

    TITLE: ClassVar = ReaderOptions.TITLE

    remove_table: bool = option(
        help="Keep the largest body of a CT alone: no table, headrest and blanket. Needs SciPy.", default=False
    )
    smooth: Any = option(
        "VOXELS|LENGTH",
        "Smooth by a Gaussian of this deviation: 0.7 in voxels, or 1mm, 20um.",
        parser=parsers.length,
    )


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
    from wavesplat._model.volume.wavelet_volume import WaveletVolume

    if given(reader):
        raise ArgumentError(
            f"{', '.join(given(reader))} say nothing about a file of wavelet coefficients; leave them out"
        )
    return WaveletVolume.load(path)


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
        from wavesplat._looks.body.largest_body import largest_body

        volume = largest_body(volume)
    deviation = processing.smooth
    if deviation is None:
        return volume
    from wavesplat._model.volume import units

    if units.canonical(deviation.unit) is None:
        return volume.smoothed(deviation.number)
    return volume.smoothed(deviation.in_world(volume.unit, "--smooth", "give it in voxels"), unit="world")


def changed_series(series: Series, processing: ProcessingOptions) -> Series:
    """The series with volumes that are processed when they are read."""
    from wavesplat._model.volume.series import Series

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


def series_options(reader: ReaderOptions) -> dict[str, Any]:
    """Options of the reader as arguments of `open_series`, without time and channel."""
    return {name: value for name, value in vars(reader).items() if name not in ("time", "channel")}


# SUV in pictures of several volumes: those that are PET are in SUV, the others as they are.


def in_uptake(opened: Callable[[bool], T], modality_of: Callable[[T], str | None], *, suv: bool, is_alone: bool) -> T:
    """A volume in SUV where `suv` asks for it; as it is where it is no PET and others are drawn with it.

    opened : opens the volume, in SUV or not.
    """
    if not suv or is_alone:
        return opened(suv)
    try:
        return opened(True)
    except (ArgumentError, FileError):
        plain = opened(False)  # which says what else is wrong
        if modality_of(plain) == "PT":
            raise
        return plain


def check_uptake(scene: Scene, *, suv: bool, others: Iterable[Volume | WaveletVolume] = ()) -> None:
    """Raise an `ArgumentError` if `--suv` is given and no volume is in SUV. `others`: volumes beside the layers."""
    if suv and not any(one.value_unit == "SUV" for one in (*(layer.drawn for layer in scene.layers), *others)):
        raise ArgumentError("--suv is for PET of DICOM, and no volume of the picture is one; leave it out")
