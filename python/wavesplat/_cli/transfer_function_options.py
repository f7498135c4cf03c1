"""The transfer function that `--preset`, `--tf` or `--materials` names."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from wavesplat.errors import ArgumentError, FileError

if TYPE_CHECKING:
    from wavesplat._looks.transfer_function import TransferFunction
    from wavesplat._looks.transfer_function_2d import TransferFunction2D
    from wavesplat._model.volume import Volume
    from wavesplat._model.wavelet_volume import WaveletVolume

__all__ = ["TransferFunctionFile", "chosen_transfer_function", "function_in_file", "function_of_materials"]

TransferFunctionFile = Annotated[
    Path | None, typer.Option("--tf", metavar="FILE.json", help="Transfer function from a file.")
]


def chosen_transfer_function(
    volume: Volume | WaveletVolume,
    path: str,
    *,
    preset: str | None,
    tf: Path | None,
    composite: str = "over",
) -> TransferFunction:
    """The one that is named, or one from the histogram. `path`: where the volume came from, for messages."""
    from wavesplat._looks.transfer_function import TransferFunction

    if tf is not None:
        return TransferFunction.load(tf, volume)
    if preset not in (None, "auto"):
        return TransferFunction.preset(preset, volume)
    try:
        return TransferFunction.auto(volume, composite)
    except ArgumentError as error:
        # Nothing on the command line is wrong: it is the data that give the histogram nothing to work with.
        raise FileError(f"{error}: {path}") from None


def function_in_file(path: Path, volume: Volume | WaveletVolume) -> TransferFunction | TransferFunction2D:
    """Of the sample value alone, or of value and gradient magnitude; the fields of the file tell."""
    from wavesplat._files import json_object
    from wavesplat._looks.transfer_function import TransferFunction
    from wavesplat._looks.transfer_function_2d import TransferFunction2D

    what = "transfer function"
    document = json_object.load(path, what, lambda text: json_object.parse(text, what, "opacity and color"))
    return TransferFunction2D.load(path) if "rgba" in document else TransferFunction.load(path, volume)


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
