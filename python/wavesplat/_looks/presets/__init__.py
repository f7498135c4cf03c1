"""Named transfer functions, one JSON file each, and `auto`."""

from __future__ import annotations

from importlib.resources import files
from typing import TYPE_CHECKING

from wavesplat._files import json_object
from wavesplat._looks import transfer_function_json
from wavesplat._looks.transfer_function import TransferFunction
from wavesplat.errors import ArgumentError

if TYPE_CHECKING:
    from wavesplat._model.volume import Volume
    from wavesplat._model.wavelet_volume import WaveletVolume

__all__ = ["names", "preset"]


def names() -> list[str]:
    """Names of all presets, in alphabetical order."""
    return sorted(["auto", *json_object.names_in(files(__name__))])


def preset(name: str, volume: Volume | WaveletVolume | None = None) -> TransferFunction:
    """The preset of a name; see `TransferFunction.preset`."""
    if name not in names():
        raise ArgumentError(f"unknown preset {name!r}; use one of: {', '.join(names())}")
    if name == "auto":
        if volume is None:
            raise ArgumentError("preset 'auto' is made from a volume's histogram; pass the volume too")
        return TransferFunction.auto(volume)
    return transfer_function_json.parse((files(__name__) / f"{name}.json").read_text(encoding="utf-8"), volume)
