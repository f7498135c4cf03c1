"""Wavesplat: pictures of volumes, by high-resolution splatting.

>>> import wavesplat as ws
>>> volume = ws.examples.ripples(16)
>>> picture = ws.render(volume, size=(64, 64))
>>> picture.rgba.shape
(64, 64, 4)

Public are the names in `__all__`, and those that the modules `wavesplat.errors`, `wavesplat.examples`,
`wavesplat.napari` and `wavesplat.reference` list in theirs. Every name that begins with an underscore is private, the
modules that public names are defined in included: import `wavesplat.Volume`, from nowhere else. `docs/public_api.md`
says how long public names stay.

Rooms, each of which imports only from those before it: `errors`, `_files`, `_model`, `_readers`, `_looks`, `_picture`,
`examples`, `gpu`, `_geometry`, `_render`, `_cluster`, `_scene`, `_movie`, `_mesh`, `_viewer`, `_napari`, `napari`,
`reference`, `study`, `_cli`.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from wavesplat import errors, examples, gpu, napari, reference
    from wavesplat._cluster.parts import PartialPicture, merge
    from wavesplat._geometry.frame import Frame
    from wavesplat._geometry.lines import Lines
    from wavesplat._geometry.opening import open_geometry
    from wavesplat._geometry.points import Points
    from wavesplat._geometry.slice_plane import SlicePlane
    from wavesplat._geometry.surface import Surface
    from wavesplat._looks.labels import Label, Labels
    from wavesplat._looks.largest_body import largest_body
    from wavesplat._looks.look import Look
    from wavesplat._looks.materials import Material, Materials
    from wavesplat._looks.regions import Region
    from wavesplat._looks.shading import Light, Shading
    from wavesplat._looks.transfer_function import TransferFunction
    from wavesplat._looks.transfer_function_2d import TransferFunction2D
    from wavesplat._mesh.meshing import mesh
    from wavesplat._mesh.triangle_mesh import Mesh, Meshes
    from wavesplat._model.camera import Camera
    from wavesplat._model.clips import ClipPlane, CutOut
    from wavesplat._model.composites import (
        AttenuatedMaximum,
        DepthColoredMaximum,
        DepthShadedMaximum,
        FirstHit,
        LocalMaximum,
        XRay,
    )
    from wavesplat._model.crop import Crop
    from wavesplat._model.facts import Channel, Facts
    from wavesplat._model.lazy_volume import LazyVolume
    from wavesplat._model.sampling import Sampling
    from wavesplat._model.series import Series
    from wavesplat._model.stereo import Stereo
    from wavesplat._model.volume import Volume
    from wavesplat._model.volume_parts import VolumePart
    from wavesplat._model.wavelet_volume import WaveletVolume
    from wavesplat._movie.frames import render_frames
    from wavesplat._movie.key_frame import KeyFrame
    from wavesplat._movie.movie import movie
    from wavesplat._movie.turn import Turn
    from wavesplat._native import __version__
    from wavesplat._picture.picture import Picture
    from wavesplat._picture.report import Report
    from wavesplat._readers.opening import open
    from wavesplat._readers.options import OpenOptions
    from wavesplat._readers.time_points import open_series
    from wavesplat._readers.transform_files import open_transform
    from wavesplat._render.isolines import Isolines
    from wavesplat._render.options import RenderOptions
    from wavesplat._scene.cost import Cost, plan
    from wavesplat._scene.layer import Layer
    from wavesplat._scene.lightbox import lightbox
    from wavesplat._scene.opening import open_scene
    from wavesplat._scene.part_rendering import render_part
    from wavesplat._scene.progressive import progressive
    from wavesplat._scene.rendering import render
    from wavesplat._scene.scene import Scene
    from wavesplat._scene.slicing import slice
    from wavesplat._viewer.viewer import Viewer, view

__all__ = [
    "AttenuatedMaximum",
    "Camera",
    "Channel",
    "ClipPlane",
    "Cost",
    "Crop",
    "CutOut",
    "DepthColoredMaximum",
    "DepthShadedMaximum",
    "Facts",
    "FirstHit",
    "Frame",
    "Isolines",
    "KeyFrame",
    "Label",
    "Labels",
    "Layer",
    "LazyVolume",
    "Light",
    "Lines",
    "LocalMaximum",
    "Look",
    "Material",
    "Materials",
    "Mesh",
    "Meshes",
    "OpenOptions",
    "PartialPicture",
    "Picture",
    "Points",
    "Region",
    "RenderOptions",
    "Report",
    "Sampling",
    "Scene",
    "Series",
    "Shading",
    "SlicePlane",
    "Stereo",
    "Surface",
    "TransferFunction",
    "TransferFunction2D",
    "Turn",
    "Viewer",
    "Volume",
    "VolumePart",
    "WaveletVolume",
    "XRay",
    "__version__",
    "errors",
    "examples",
    "gpu",
    "largest_body",
    "lightbox",
    "merge",
    "mesh",
    "movie",
    "napari",
    "open",
    "open_geometry",
    "open_scene",
    "open_series",
    "open_transform",
    "plan",
    "progressive",
    "reference",
    "render",
    "render_frames",
    "render_part",
    "slice",
    "study",
    "view",
]

#: Module of each public name; loaded when first asked for, so that importing the package costs next to nothing.
_HOMES = {
    "Camera": "_model.camera",
    "Channel": "_model.facts",
    "ClipPlane": "_model.clips",
    "Cost": "_scene.cost",
    "Crop": "_model.crop",
    "CutOut": "_model.clips",
    "AttenuatedMaximum": "_model.composites",
    "DepthColoredMaximum": "_model.composites",
    "DepthShadedMaximum": "_model.composites",
    "Facts": "_model.facts",
    "FirstHit": "_model.composites",
    "Frame": "_geometry.frame",
    "Isolines": "_render.isolines",
    "KeyFrame": "_movie.key_frame",
    "Label": "_looks.labels",
    "Labels": "_looks.labels",
    "Layer": "_scene.layer",
    "LazyVolume": "_model.lazy_volume",
    "Light": "_looks.shading",
    "Lines": "_geometry.lines",
    "LocalMaximum": "_model.composites",
    "Look": "_looks.look",
    "Material": "_looks.materials",
    "Materials": "_looks.materials",
    "Mesh": "_mesh.triangle_mesh",
    "Meshes": "_mesh.triangle_mesh",
    "OpenOptions": "_readers.options",
    "PartialPicture": "_cluster.parts",
    "Picture": "_picture.picture",
    "Points": "_geometry.points",
    "Region": "_looks.regions",
    "RenderOptions": "_render.options",
    "Report": "_picture.report",
    "Sampling": "_model.sampling",
    "Scene": "_scene.scene",
    "Series": "_model.series",
    "Shading": "_looks.shading",
    "SlicePlane": "_geometry.slice_plane",
    "Stereo": "_model.stereo",
    "Surface": "_geometry.surface",
    "TransferFunction": "_looks.transfer_function",
    "TransferFunction2D": "_looks.transfer_function_2d",
    "Turn": "_movie.turn",
    "Viewer": "_viewer.viewer",
    "Volume": "_model.volume",
    "VolumePart": "_model.volume_parts",
    "WaveletVolume": "_model.wavelet_volume",
    "XRay": "_model.composites",
    "__version__": "_native",
    "largest_body": "_looks.largest_body",
    "lightbox": "_scene.lightbox",
    "merge": "_cluster.parts",
    "mesh": "_mesh.meshing",
    "movie": "_movie.movie",
    "open": "_readers.opening",
    "open_geometry": "_geometry.opening",
    "open_scene": "_scene.opening",
    "open_series": "_readers.time_points",
    "open_transform": "_readers.transform_files",
    "plan": "_scene.cost",
    "progressive": "_scene.progressive",
    "render": "_scene.rendering",
    "render_frames": "_movie.frames",
    "render_part": "_scene.part_rendering",
    "slice": "_scene.slicing",
    "view": "_viewer.viewer",
}
_MODULES = {"errors", "examples", "gpu", "napari", "reference", "study"}


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
