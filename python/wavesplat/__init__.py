"""Wavesplat: pictures of volumes, by high-resolution splatting.

>>> import wavesplat as ws
>>> volume = ws.examples.ripples(16)
>>> picture = ws.render(volume, size=(64, 64))
>>> picture.rgba.shape
(64, 64, 4)
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from wavesplat import errors, examples, reference, study
    from wavesplat._native import __version__
    from wavesplat.camera import Camera
    from wavesplat.crop import Crop
    from wavesplat.labels import Label, Labels
    from wavesplat.materials import Material, Materials
    from wavesplat.meshing import Mesh, mesh
    from wavesplat.picture import Picture
    from wavesplat.readers import open
    from wavesplat.rendering import render
    from wavesplat.shading import Light, Shading
    from wavesplat.slicing import slice
    from wavesplat.transfer_function import TransferFunction
    from wavesplat.transfer_function_2d import TransferFunction2D
    from wavesplat.volume import Volume
    from wavesplat.wavelet_volume import WaveletVolume

__all__ = [
    "Camera",
    "Crop",
    "Label",
    "Labels",
    "Light",
    "Material",
    "Materials",
    "Mesh",
    "Picture",
    "Shading",
    "TransferFunction",
    "TransferFunction2D",
    "Volume",
    "WaveletVolume",
    "__version__",
    "errors",
    "examples",
    "mesh",
    "open",
    "reference",
    "render",
    "slice",
    "study",
]

#: Where each public name lives; loaded when first asked for, so that importing the package costs next to nothing.
_HOMES = {
    "Camera": "camera",
    "Crop": "crop",
    "Label": "labels",
    "Labels": "labels",
    "Light": "shading",
    "Material": "materials",
    "Materials": "materials",
    "Mesh": "meshing",
    "Picture": "picture",
    "Shading": "shading",
    "TransferFunction": "transfer_function",
    "TransferFunction2D": "transfer_function_2d",
    "Volume": "volume",
    "WaveletVolume": "wavelet_volume",
    "__version__": "_native",
    "mesh": "meshing",
    "open": "readers",
    "render": "rendering",
    "slice": "slicing",
}
_MODULES = {"errors", "examples", "reference", "study"}


def __getattr__(name: str) -> Any:
    if name in _MODULES:
        return import_module(f"wavesplat.{name}")
    if name not in _HOMES:
        raise AttributeError(f"module 'wavesplat' has no attribute {name!r}")
    value = getattr(import_module(f"wavesplat.{_HOMES[name]}"), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted(__all__)
