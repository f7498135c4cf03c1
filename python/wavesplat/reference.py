"""Slow, literal renderers in double precision, against which the fast one is measured."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

from wavesplat import _native
from wavesplat._looks.curves.materials import Materials
from wavesplat._looks.curves.transfer_function import TransferFunction
from wavesplat._looks.curves.transfer_function_2d import TransferFunction2D
from wavesplat._looks.labels.labels import Labels
from wavesplat._looks.shading import Shading
from wavesplat._model.arguments.clips import Clip, Clipping, combined_clips
from wavesplat._model.arguments.sampling import Kernel
from wavesplat._model.arguments.types import takes_its_types
from wavesplat._model.camera.camera import Camera
from wavesplat._model.volume.volume import Volume
from wavesplat._model.volume.volume_like import VolumeLike, as_volume
from wavesplat._picture.picture import Picture
from wavesplat._render import arguments
from wavesplat._scene.drawing.drawn_layers import drawn_layers, slice_source
from wavesplat._scene.drawing.scene_shapes import also_in_view, shapes_of
from wavesplat._scene.scene import Scene
from wavesplat.errors import ArgumentError

__all__ = ["raycast", "splat_literal"]


@takes_its_types
def raycast(
    what: VolumeLike | Scene,
    transfer_function: TransferFunction | TransferFunction2D | Materials | str | None = None,
    camera: Camera | str | None = None,
    *,
    labels: Labels | None = None,
    size: tuple[int, int] = (512, 512),
    step: float = 0.05,
    rays_per_pixel: int = 1,
    kernel: Kernel = "linear",
    shading: Shading | None = arguments.DEFAULT_SHADING,
    clip: Clip | Iterable[Clip] = (),
    geometry: Any = (),
    threads: int | None = None,
) -> Picture:
    """The converged picture, by casting rays in small steps (emission and absorption, "over").

    Parameters
    ----------
    what : Volume or Scene
        A volume, or a scene of up to eight, mixed point by point; of a WaveletVolume, give `to_volume()`. The looks,
        labels, light and clipping of a scene are its own: leave these arguments out.
    transfer_function, camera, labels, size, kernel, shading, clip, threads
        As for `wavesplat.render`.
    step : float, default 0.05
        Distance between samples of a ray, in voxels.
    rays_per_pixel : int, default 1
        On a regular grid inside the pixel; a square number.
    geometry : Surface, Lines, Points, SlicePlane, Frame, or several of them in a list
        Stand in space with the volume, and are met analytically. A scene has its own shapes: leave this out.

    Returns
    -------
    Picture
        With `rgba`, float32, shape (height, width, 4), associated, transparent background.

    Raises
    ------
    ArgumentError
        If an argument cannot work.

    Examples
    --------
    >>> import wavesplat as ws
    >>> ws.reference.raycast(ws.examples.ripples(8), size=(8, 8), step=0.5).rgba.shape
    (8, 8, 4)
    """
    if isinstance(what, Scene):
        scene = what
        if (
            transfer_function is not None
            or labels is not None
            or combined_clips(clip) != combined_clips(())
            or geometry
        ):
            raise ArgumentError("a scene has its own looks, labels, clipping and geometry; leave these arguments out")
    else:
        volume = _checked_samples(what)
        look = arguments.chosen_look(transfer_function, volume, "over")
        scene = Scene(volume, look, labels=labels, shading=shading, clip=clip, geometry=geometry)
    shown = drawn_layers(scene, "over")
    lights = [layer.look.shading if scene.shading == "look" else scene.shading for layer in shown.layers]
    if any(isinstance(light, Shading) and (light.ambient_occlusion > 0 or light.shadow > 0) for light in lights):
        raise ArgumentError("the reference knows no ambient_occlusion and no shadow; give a Shading without them")
    volumes = [_checked_samples(layer.seen) for layer in shown.layers]
    width, height = arguments.checked_size(size)
    clipping = scene._clipping if len(shown.layers) == 1 else scene._clipping.in_world(shown.first)
    parts = [(layer.seen, layer.look) for layer in shown.layers]
    first, source = shown.layers[0], slice_source(scene)
    also = also_in_view(scene.geometry, source, scene.bounds)
    eye = arguments.chosen_camera(camera, parts, clipping, width / max(height, 1), also=also)
    shapes = shapes_of(scene.geometry, source, eye, scene._cache.shapes_of)
    rgba = _native.raycast(
        [
            (
                volume._core,
                layer.faded(layer.look.transfer_function)._core,
                light._core if light is not None else None,
                None if layer.color is None else (layer.color.seen._core, layer.color.function._core),
            )
            for volume, layer, light in zip(volumes, shown.layers, lights, strict=True)
        ],
        eye._core,
        labels=arguments.chosen_labels(scene.labels or first.look.labels, first.volume, first.boxes),
        width=width,
        height=height,
        kernel=kernel,
        step=float(step),
        rays_per_pixel=arguments.checked_count(rays_per_pixel, "rays_per_pixel") or 0,
        **arguments.region(clipping),
        shapes=None if shapes is None else shapes.core,
        threads=arguments.chosen_threads(threads),
    )
    return Picture(rgba)


@takes_its_types
def splat_literal(
    volume: VolumeLike,
    transfer_function: TransferFunction | TransferFunction2D | Materials | str | None = None,
    camera: Camera | str | None = None,
    *,
    size: tuple[int, int] = (512, 512),
    kernel: Kernel = "linear",
    shading: Shading | None = arguments.DEFAULT_SHADING,
    sheets_per_slice: float = 1.0,
    threads: int | None = None,
) -> Picture:
    """The picture of the method's own pseudo-code, sample by sample and sheet by sheet.

    Parameters
    ----------
    volume, transfer_function, camera, size, kernel, shading, threads
        As for `wavesplat.render`.
    sheets_per_slice : float, default 1
        Sheets per slice distance.

    Returns
    -------
    Picture
        With `rgba`, float32, shape (height, width, 4), associated, transparent background.

    Raises
    ------
    ArgumentError
        If an argument cannot work.

    Examples
    --------
    >>> import wavesplat as ws
    >>> ws.reference.splat_literal(ws.examples.ripples(8), size=(8, 8)).rgba.shape
    (8, 8, 4)
    """
    volume = _checked_samples(volume)
    width, height = arguments.checked_size(size)
    look = arguments.chosen_look(transfer_function, volume, "over")
    rgba = _native.splat_literal(
        volume._core,
        look.transfer_function._core,
        arguments.chosen_camera(camera, [(volume, look)], Clipping(), width / max(height, 1))._core,
        width=width,
        height=height,
        kernel=kernel,
        shading=None if shading is None else shading._core,
        sheets_per_slice=float(sheets_per_slice),
        threads=arguments.chosen_threads(threads),
    )
    return Picture(rgba)


def _checked_samples(thing: object) -> Volume:
    volume = as_volume(thing)
    if not isinstance(volume, Volume):
        raise ArgumentError(
            f"the reference draws a Volume, not a {type(volume).__name__}; of a WaveletVolume, give its to_volume()"
        )
    return volume
