"""Arguments that several renderers take: as users give them, checked, and as the compiled module takes them."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from dataclasses import replace
from math import isnan
from operator import index
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wavesplat import _native
from wavesplat._looks.curves.materials import Materials
from wavesplat._looks.curves.transfer_function import TransferFunction
from wavesplat._looks.curves.transfer_function_2d import TransferFunction2D
from wavesplat._looks.labels.labels import Labels
from wavesplat._looks.look import Look
from wavesplat._looks.shading import Shading
from wavesplat._model.arguments.clips import Clipping
from wavesplat._model.arguments.sampling import MAX_SIDE_PX, Composite
from wavesplat._model.camera import fit
from wavesplat._model.camera.camera import Camera, check_place, check_view
from wavesplat._model.camera.stereo import PLAIN, Eyes
from wavesplat._model.camera.views import view_angles
from wavesplat._model.volume.cutting import Boxes, without
from wavesplat._model.volume.grid import Grid
from wavesplat._model.volume.volume import Volume
from wavesplat._model.volume.wavelet_volume import WaveletVolume
from wavesplat._render import framing
from wavesplat._system.memory import check_room
from wavesplat._system.values import described, whole
from wavesplat.errors import ArgumentError

DEFAULT_SHADING = Shading()
#: Default light of studies, which compare with the light of other renderers.
HEADLIGHT = Shading.headlight()

#: Largest number of threads, more than any machine has processors, since each is created; and of rays in a pixel.
MAX_COUNT = 4096


def chosen_transfer_function(
    given: TransferFunction | TransferFunction2D | Materials | str | None,
    volume: Volume | WaveletVolume,
    composite: Composite = "over",
) -> TransferFunction | TransferFunction2D:
    """The transfer function itself, or the one that materials, a preset name or None stand for."""
    if isinstance(given, TransferFunction | TransferFunction2D):
        return given
    if isinstance(given, Materials):
        return given.transfer_function()
    if given is None:
        return TransferFunction.auto(volume, composite)
    if isinstance(given, str):
        return Look.preset(given, volume).transfer_function
    raise ArgumentError(
        f"transfer_function is a {type(given).__name__}; give a TransferFunction, Materials or the name of a preset"
    )


def chosen_look(
    given: Look | TransferFunction | TransferFunction2D | Materials | str | None,
    volume: Volume | WaveletVolume,
    composite: Composite | None,
) -> Look:
    """The look itself, or the one that a transfer function, materials, a preset's name or None stand for."""
    if isinstance(given, Look):
        return given if composite is None else replace(given, composite=composite)
    if given is None or (isinstance(given, str) and given.lower() == "auto"):
        return Look.auto(volume, composite)
    if isinstance(given, str):
        look = Look.preset(given, volume)
        return look if composite is None else replace(look, composite=composite)
    function = chosen_transfer_function(given, volume, composite or "over")
    return Look(transfer_function=function, composite=composite or "over")


def chosen_labels(
    given: Labels | None, volume: Grid, boxes: Boxes = (), *, level: Grid | None = None
) -> _native.Labels | None:
    """The labels for the compiled module, on the samples of the volume or of its `level`; none in the boxes."""
    if given is None:
        return None
    if not isinstance(given, Labels):
        raise ArgumentError(f"labels is a {type(given).__name__}; give a wavesplat.Labels(segmentation, ...)")
    if level is not None:
        # An array lies on the finest level's samples.
        return (given if given.world_from_index is not None else given.on_samples_of(volume)).beside(level)
    return given.without(boxes, volume).beside(volume)


def chosen_camera(
    given: Camera | str | None,
    parts: Sequence[framing.Part],
    clipping: Clipping,
    aspect: float,
    *,
    turned: tuple[float, float] | None = None,
    zoom: float = 1.0,
    view_angle: float | None = None,
    eyes: Eyes = PLAIN,
    also: NDArray[np.float64] | None = None,
) -> Camera:
    """The camera itself, or the one that a view's name or None stands for: near enough that what is seen fits.

    parts : volumes and their looks, of which the first chooses the view.
    turned : azimuth and elevation by which the eye turns from the view, at its scale as long as all stays in view; None
        of a look without a view is then the front.
    eyes : in whose pictures it fits; two, and panoramas, have cameras of perspective.
    also : world positions that are in view besides the volumes.
    """
    if isinstance(given, Camera):
        for volume, _ in parts:
            check_view(given, volume)
        return eyes.camera(given)
    if not (given is None or isinstance(given, str)):
        raise ArgumentError(f"camera is a {type(given).__name__}; give a Camera or the name of a view")
    for volume, _ in parts:
        check_place(volume)
    first, look = parts[0]
    view = look.view if given is None else given
    if view is None and turned is None:
        azimuth, elevation = framing.natural_view(first)
    else:
        azimuth, elevation = view_angles("anterior" if view is None else view, is_anatomical=first.is_anatomical)
    if view_angle is None and not eyes.are_plain:
        view_angle = _native.VIEW_ANGLE
    # A picture without pixels has no aspect; the compiled module refuses it.
    fitting: Any = {"clipping": clipping, "zoom": zoom, "aspect": aspect if aspect > 0 else 1.0, "also": also}
    camera = framing.framed(parts, azimuth, elevation, view_angle=view_angle, **fitting)
    if turned is not None:
        camera = framing.in_view_again(camera.turned(*turned), parts, **fitting)
    for volume, _ in parts:
        check_view(camera, volume)
    # Who lifts the eye wants to look down or up.
    return fit.within(camera, is_level=turned is None or turned[1] == 0) if eyes.panorama else camera


def cut_open(volume: Volume | WaveletVolume, boxes: Boxes) -> Volume | WaveletVolume:
    """The volume with the boxes cut out of it."""
    if isinstance(volume, WaveletVolume):
        if boxes:
            raise ArgumentError(
                f"CutOut takes samples out, and volume {volume.name!r} has wavelet coefficients; "
                "draw its to_volume(), and on the command line leave out --threshold, --wavelet-level and --bands"
            )
        return volume
    return without(volume, boxes)


def checked_size(size: Sequence[int]) -> tuple[int, int]:
    """Width and height as plain integers, 0 to `MAX_SIDE_PX`."""
    try:
        width, height = (index(number) for number in size)
    except (TypeError, ValueError):
        raise ArgumentError(f"size is {described(size)}; give (width, height), two whole numbers of pixels") from None
    if max(width, height) > MAX_SIDE_PX:
        raise ArgumentError(f"size is {described((width, height))}; give at most {MAX_SIDE_PX} pixels a side")
    if width < 0 or height < 0:
        raise ArgumentError(f"size is {width} x {height} pixels; width and height must be at least 1")
    return width, height


def check_picture_memory(size: tuple[int, int], bytes_per_pixel: float) -> None:
    """Raise a `LimitError` if a picture takes more memory than there is: the compiled module would end the process."""
    width, height = size
    needed = width * height * bytes_per_pixel
    if isnan(needed):
        return  # which is refused elsewhere
    check_room(
        int(min(needed, sys.maxsize)),
        f"the pixels of a picture of {width} x {height}",
        "draw a smaller one, or less sharp",
    )


def checked_count(number: int | None, name: str) -> int | None:
    """The number as a plain integer, 0 or more, or None."""
    if number is None:
        return None
    return whole(number, name, f"a whole number from 1 to {MAX_COUNT}", least=0, most=MAX_COUNT)


def chosen_threads(number: int | None) -> int | None:
    """The number of threads that draw, as the compiled module takes it."""
    return checked_count(number, "threads")


def region(clipping: Clipping) -> dict[str, Any]:
    """Crop and clip planes as the compiled module takes them."""
    crop = clipping.crop
    return {
        "crop_index": crop.corners_in("index") if crop else None,
        "crop_world": crop.corners_in("world") if crop else None,
        "clip_planes": [(plane.point, plane.normal) for plane in clipping.planes],
    }
