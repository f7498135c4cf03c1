"""The transfer function that `--preset`, `--tf` or `--materials` names."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from wavesplat._cli.printing import message
from wavesplat.errors import ArgumentError, FileError, WavesplatWarning

if TYPE_CHECKING:
    from wavesplat._looks.look import Look
    from wavesplat._looks.transfer_function import TransferFunction
    from wavesplat._looks.transfer_function_2d import TransferFunction2D
    from wavesplat._model.volume import Volume
    from wavesplat._model.wavelet_volume import WaveletVolume

__all__ = ["TransferFunctionFile", "function_of_histogram", "function_of_materials", "named_look"]

TransferFunctionFile = Annotated[
    Path | None,
    typer.Option(
        "--tf",
        metavar="FILE[#NAME]",
        help="Look from a file: ours (.json), 3D Slicer's (.vp, .vp.json, presets.xml), ParaView's (.json, .xml).",
    ),
]


def named_look(
    volume: Volume | WaveletVolume, *, preset: str | None, tf: Path | None, quiet: bool = False
) -> Look | None:
    """The look of a preset or a file; None if neither is named, or `auto` is. What it warns of becomes notes."""
    import warnings

    from wavesplat._looks.look import Look

    if tf is not None:
        path, _, name = str(tf).rpartition("#") if not tf.exists() and "#" in str(tf) else (str(tf), "", None)
        return Look.load(path, volume, name)
    if preset in (None, "auto"):
        return None
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always", WavesplatWarning)
        look = Look.preset(preset, volume)
    if not quiet:
        for warning in caught:
            message(f"note: {warning.message}")
    return look


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
