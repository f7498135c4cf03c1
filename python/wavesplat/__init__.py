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

Rooms, each of which imports only from those before it: `errors`, `_system`, `_storage`, `_model`, `_readers`, `_looks`,
`_picture`, `examples`, `gpu`, `_geometry`, `_render`, `_cluster`, `_scene`, `_movie`, `_mesh`, `_viewer`, `_napari`,
`napari`, `reference`, `study`, `_cli`.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from wavesplat import errors, examples, gpu, napari, reference
    from wavesplat._cluster.parts import PartialPicture, merge
    from wavesplat._geometry.files.opening import open_geometry
    from wavesplat._geometry.frame import Frame
    from wavesplat._geometry.lines import Lines
    from wavesplat._geometry.points import Points
    from wavesplat._geometry.slice_plane import SlicePlane
    from wavesplat._geometry.surface import Surface
    from wavesplat._looks.body.largest_body import largest_body
    from wavesplat._looks.curves.materials import Material, Materials
    from wavesplat._looks.curves.transfer_function import TransferFunction
    from wavesplat._looks.curves.transfer_function_2d import TransferFunction2D
    from wavesplat._looks.labels.labels import Label, Labels
    from wavesplat._looks.labels.regions import Region
    from wavesplat._looks.look import Look
    from wavesplat._looks.shading import Light, Shading
    from wavesplat._mesh.meshing import mesh
    from wavesplat._mesh.triangle_mesh import Mesh, Meshes
    from wavesplat._model.arguments.clips import ClipPlane, Crop, CutOut
    from wavesplat._model.arguments.operators import (
        AttenuatedMaximum,
        DepthColoredMaximum,
        DepthShadedMaximum,
        FirstHit,
        LocalMaximum,
        XRay,
    )
    from wavesplat._model.arguments.sampling import Sampling
    from wavesplat._model.camera.camera import Camera
    from wavesplat._model.camera.stereo import Stereo
    from wavesplat._model.lazy.volume import LazyVolume
    from wavesplat._model.volume.facts import Channel, Facts
    from wavesplat._model.volume.series import Series
    from wavesplat._model.volume.volume import Volume
    from wavesplat._model.volume.volume_parts import VolumePart
    from wavesplat._model.volume.wavelet_volume import WaveletVolume
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
    from wavesplat._scene.drawing.cost import Cost, plan
    from wavesplat._scene.drawing.progressive import progressive
    from wavesplat._scene.drawing.rendering import render, render_part
    from wavesplat._scene.layer import Layer
    from wavesplat._scene.opening import open_scene
    from wavesplat._scene.scene import Scene
    from wavesplat._scene.slices.lightbox import lightbox
    from wavesplat._scene.slices.slicing import slice
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
    "Camera": "_model.camera.camera",
    "Channel": "_model.volume.facts",
    "ClipPlane": "_model.arguments.clips",
    "Cost": "_scene.drawing.cost",
    "Crop": "_model.arguments.clips",
    "CutOut": "_model.arguments.clips",
    "AttenuatedMaximum": "_model.arguments.operators",
    "DepthColoredMaximum": "_model.arguments.operators",
    "DepthShadedMaximum": "_model.arguments.operators",
    "Facts": "_model.volume.facts",
    "FirstHit": "_model.arguments.operators",
    "Frame": "_geometry.frame",
    "Isolines": "_render.isolines",
    "KeyFrame": "_movie.key_frame",
    "Label": "_looks.labels.labels",
    "Labels": "_looks.labels.labels",
    "Layer": "_scene.layer",
    "LazyVolume": "_model.lazy.volume",
    "Light": "_looks.shading",
    "Lines": "_geometry.lines",
    "LocalMaximum": "_model.arguments.operators",
    "Look": "_looks.look",
    "Material": "_looks.curves.materials",
    "Materials": "_looks.curves.materials",
    "Mesh": "_mesh.triangle_mesh",
    "Meshes": "_mesh.triangle_mesh",
    "OpenOptions": "_readers.options",
    "PartialPicture": "_cluster.parts",
    "Picture": "_picture.picture",
    "Points": "_geometry.points",
    "Region": "_looks.labels.regions",
    "RenderOptions": "_render.options",
    "Report": "_picture.report",
    "Sampling": "_model.arguments.sampling",
    "Scene": "_scene.scene",
    "Series": "_model.volume.series",
    "Shading": "_looks.shading",
    "SlicePlane": "_geometry.slice_plane",
    "Stereo": "_model.camera.stereo",
    "Surface": "_geometry.surface",
    "TransferFunction": "_looks.curves.transfer_function",
    "TransferFunction2D": "_looks.curves.transfer_function_2d",
    "Turn": "_movie.turn",
    "Viewer": "_viewer.viewer",
    "Volume": "_model.volume.volume",
    "VolumePart": "_model.volume.volume_parts",
    "WaveletVolume": "_model.volume.wavelet_volume",
    "XRay": "_model.arguments.operators",
    "__version__": "_native",
    "largest_body": "_looks.body.largest_body",
    "lightbox": "_scene.slices.lightbox",
    "merge": "_cluster.parts",
    "mesh": "_mesh.meshing",
    "movie": "_movie.movie",
    "open": "_readers.opening",
    "open_geometry": "_geometry.files.opening",
    "open_scene": "_scene.opening",
    "open_series": "_readers.time_points",
    "open_transform": "_readers.transform_files",
    "plan": "_scene.drawing.cost",
    "progressive": "_scene.drawing.progressive",
    "render": "_scene.drawing.rendering",
    "render_frames": "_movie.frames",
    "render_part": "_scene.drawing.rendering",
    "slice": "_scene.slices.slicing",
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
