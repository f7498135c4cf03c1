"""The look that `--preset`, `--tf` or `--cmap` names, and the transfer function of `--materials`."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from wavesplat._cli import parsers
from wavesplat._cli.option_groups import with_options_of
from wavesplat._cli.printing import warnings_as_notes
from wavesplat.errors import ArgumentError, FileError

if TYPE_CHECKING:
    from wavesplat._looks.look import Look
    from wavesplat._looks.transfer_function import TransferFunction
    from wavesplat._looks.transfer_function_2d import TransferFunction2D
    from wavesplat._model.volume import Volume
    from wavesplat._model.wavelet_volume import WaveletVolume

__all__ = [
    "ColorOptions",
    "TransferFunctionFile",
    "function_of_histogram",
    "function_of_materials",
    "named_look",
    "takes_color_options",
]

TransferFunctionFile = Annotated[
    Path | None,
    typer.Option(
        "--tf",
        metavar="FILE[#NAME]",
        help="Look from a file: ours (.json), 3D Slicer's (.vp, .vp.json, presets.xml), ParaView's (.json, .xml).",
    ),
]


@dataclass(frozen=True)
class ColorOptions:
    """A map of colours over a range of values."""

    cmap: Annotated[
        str | None,
        typer.Option(
            metavar="NAME", help="Colour map of matplotlib or others: viridis, inferno, coolwarm_r, cmocean:ice."
        ),
    ] = None
    clim: Annotated[
        Any,
        typer.Option(
            metavar="LOW,HIGH",
            parser=parsers.numbers(2, "0,500"),
            help="Values of the first and the last colour; those of the volume if not given.",
        ),
    ] = None
    log: Annotated[bool, typer.Option("--log", help="Colours even in the logarithm of the values.")] = False
    opacity: Annotated[
        Any,
        typer.Option(
            metavar="NAME|A,A,...",
            parser=parsers.opacity,
            help="Over the range: linear, sigmoid, sqrt, a number, or numbers, 0..1.",
        ),
    ] = None
    gamma: Annotated[float, typer.Option(metavar="G", help="Less than 1 brightens what is between.")] = 1.0

    def are_given(self) -> bool:
        """Whether any was set."""
        return self != ColorOptions()

    def look(self, volume: Volume | WaveletVolume, opacity: str | float) -> Look:
        """The map, grey if none is named. `opacity`: what is meant if nothing is said."""
        from wavesplat._looks.look import Look
        from wavesplat._looks.transfer_function import TransferFunction

        name = self.cmap or "gray"
        function = TransferFunction.from_colormap(
            name,
            volume,
            clim=self.clim,
            opacity=opacity if self.opacity is None else self.opacity,
            log=self.log,
            gamma=self.gamma,
        )
        return Look(transfer_function=function, name=name)


def takes_color_options(command: Callable[..., None]) -> Callable[..., None]:
    """Give a command these options on the command line, in the place of its parameter `colors`."""
    return with_options_of(ColorOptions, "colors", command)


def named_look(
    volume: Volume | WaveletVolume,
    *,
    preset: str | None,
    tf: Path | None,
    colors: ColorOptions | None = None,
    opacity: str | float = "linear",
    quiet: bool = False,
) -> Look | None:
    """The look of a preset, a file or a colour map; None if none is named, or `auto` is.

    What it warns of becomes notes. `opacity`: of a colour map, if nothing is said.
    """
    from wavesplat._looks.look import Look

    if colors is not None and colors.are_given() and (preset is not None or tf is not None):
        raise ArgumentError("--cmap, --clim, --log, --opacity and --gamma belong together, without --preset and --tf")
    with warnings_as_notes(quiet=quiet):
        if tf is not None:
            path, _, name = str(tf).rpartition("#") if not tf.exists() and "#" in str(tf) else (str(tf), "", None)
            return Look.load(path, volume, name)
        if colors is not None and colors.are_given():
            return colors.look(volume, opacity)
        return None if preset in (None, "auto") else Look.preset(preset, volume)


def function_of_histogram(volume: Volume | WaveletVolume, path: str) -> TransferFunction:
    """One for a first look. `path`: where the volume came from, for messages."""
    from wavesplat._looks.transfer_function import TransferFunction

    try:
        return TransferFunction.auto(volume)
    except ArgumentError as error:
        # Nothing on the command line is wrong: it is the data that give the histogram nothing to work with.
        raise FileError(f"{error}: {path}") from None


def function_of_materials(
    volume: Volume | WaveletVolume, given: str, surfaces: float | None
) -> TransferFunction | TransferFunction2D:
    """The mixture of materials from a file, by name, or from the histogram; with their surfaces if a share is given."""
    from wavesplat._looks.materials import Materials

    if given == "fit":
        materials = Materials.fit(volume)
    else:
        materials = Materials.load(given) if given.endswith(".json") else Materials.preset(given)
    return materials.transfer_function() if surfaces is None else materials.surfaces(surfaces)
