"""Slices: of a volume, and of others over it in the same places."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wavesplat._looks.kinds import unit_of_values
from wavesplat._looks.transfer_function import TransferFunction
from wavesplat._looks.transfer_function_2d import TransferFunction2D
from wavesplat._model.argument_types import takes_its_types
from wavesplat._model.options import Kernel, Plane, Slab
from wavesplat._picture.picture import Picture
from wavesplat._picture.report_facts import shown_layer
from wavesplat._public import public
from wavesplat._render.arguments import chosen_look
from wavesplat._render.slicing import Planes, sliced
from wavesplat._scene.layer import Layer
from wavesplat._scene.scene import as_scene
from wavesplat.errors import ArgumentError

__all__ = ["slice"]


@public
@takes_its_types
def slice(
    what: Any,
    plane: Plane | tuple[Iterable[float], Iterable[float]] = "axial",
    position: float | None = None,
    *,
    size: tuple[int, int] | None = None,
    zoom: float = 1.0,
    center: Iterable[float] | None = None,
    kernel: Kernel = "linear",
    thickness: float = 0.0,
    slab: Slab = "maximum",
    window: str | tuple[float, float] | None = None,
    clim: tuple[float, float] | None = None,
    transfer_function: TransferFunction | str | None = None,
    background: str | Sequence[float] | None = "black",
    threads: int | None = None,
) -> Picture:
    """A picture of a plane through the volume, or of a slab around it.

    Parameters
    ----------
    what : Volume, WaveletVolume, array or what else `Volume` takes, Scene, Layer, or several in a list
        What to cut. The first volume decides plane, pixels and values; the others lie over it at the same places, as
        PET over CT does: in the colours of their looks, as opaque as these make the value, by their strongest, times
        `Layer.opacity`. Where a look is transparent, and outside of its volume, a layer does not show. Clips and labels
        of a scene are for pictures in space.
    plane : str or (point, normal), default "axial"
        "axial", "coronal" or "sagittal", at right angles to the world's z, y or x; or any plane, world units.
    position : float, optional
        Where the plane crosses that axis, world units; None is the middle of the volume. Of (point, normal): how far
        to move from the point along the normal; None is not at all.
    size : (width, height), optional
        Pixels, into which the volume fits; None gives square pixels of the volume's finest spacing, on its samples
        where these lie along the picture.
    zoom : float, default 1
        Magnification about `center`.
    center : three numbers (x, y, z), optional
        World position in the middle of the picture, moved at right angles onto the plane; None is the middle of the
        volume's box.
    kernel : str
        Reconstruction between samples, as for `render`.
    thickness : float, default 0
        Of a slab with the plane in its middle, world units. Two planes for every sample across it, and both its faces.
    slab : str
        "maximum", "minimum" or "mean" of the values across the slab.
    window : (level, width) or str, optional
        As radiologists say it: black is level - width / 2, white is level + width / 2. Or a name, for Hounsfield units:
        "abdomen", "angio", "bone", "brain", "liver", "lung", "mediastinum", "soft-tissue", "spine", "stroke",
        "subdural" or "temporal-bone".
    clim : (low, high), optional
        Instead of a window: the values shown as black and as white. Without both these are the ones that count as the
        volume's smallest and largest.
    transfer_function : TransferFunction or str, optional
        Instead of a window: the colours, opaque, of all values that are not transparent. Looks of the first layer are
        for pictures in space.
    background : colour, optional
        As for `render`; shows where there are no values.
    threads : int, optional
        Worker threads; None uses all cores.

    Returns
    -------
    Picture
        `value` holds the values, float32, shape (height, width), NaN outside the volume.
        `report` tells where the pixels lie in the world (`origin`, the centre of the first one, `right`, `down` and
        `pixel`), the letters of the edges (None without anatomy), the window, as `window` (level, width) and `clim`
        (low, high), and what was done to the samples (`Facts.processing`). `Picture.annotated` writes on it: letters, a
        scale bar, the colours of the values.

    Raises
    ------
    ArgumentError
        If an argument cannot work, or the plane lies outside the volume (the message has the range).

    Warns
    -----
    WavesplatWarning
        If a window for Hounsfield units is named and the volume's values do not look like them.

    Examples
    --------
    >>> import wavesplat as ws
    >>> volume = ws.examples.ripples(16)
    >>> ws.slice(volume, "coronal").value.shape
    (16, 16)
    >>> ws.slice(volume, ((0, 0, 0), (1, 0, 1)), thickness=0.2, size=(64, 48)).size
    (64, 48)
    >>> spots = ws.TransferFunction.from_colormap("hot", clim=(100, 255), opacity="linear")
    >>> ws.slice([volume, ws.Layer(volume.smoothed(1), spots, opacity=0.5)]).report["shown"][1]["name"]
    'ripples(16)'
    """
    scene = as_scene(what, None, labels=None, shading="look", clip=(), background=None)
    first, *others = [layer for layer in scene.layers if layer.is_shown] or scene.layers[:1]
    picture, planes = sliced(
        first.drawn,
        plane,
        position,
        size=size,
        zoom=zoom,
        center=center,
        kernel=kernel,
        thickness=thickness,
        slab=slab,
        window=window,
        clim=clim,
        transfer_function=transfer_function,
        background=background,
        threads=threads,
    )
    if not others:
        return picture
    rgba = picture.rgba.astype(np.float64)
    for layer in others:
        over, shown = _laid_over(layer, planes, kernel, slab, threads)
        rgba = over + (1 - over[..., 3:]) * rgba
        picture.report["shown"].append(shown)
    return Picture(rgba.astype(np.float32), value=picture.value, report=picture.report)


def _laid_over(
    layer: Layer, planes: Planes, kernel: Kernel, slab: Slab, threads: int | None
) -> tuple[NDArray[np.float64], dict[str, Any]]:
    """A layer's colours in the places of a slice, associated, and what a colour bar needs of them."""
    volume = layer.drawn
    name = layer.name or volume.name
    curves = chosen_look(layer.look, layer.looked_at, "over").transfer_function
    if isinstance(curves, TransferFunction2D):
        raise ArgumentError(
            f"a slice shows values, not gradients; give the layer {name!r} a TransferFunction, as from_colormap makes"
        )
    values = planes.values_of(volume, kernel, slab, threads)
    rgba = curves(values.ravel()).reshape(*values.shape, 4)
    most = max(alpha for _, alpha in curves.opacity)
    share = layer.opacity * rgba[..., 3] / most if most > 0 else np.zeros(values.shape)
    alpha = np.where(np.isfinite(values), share, 0.0)[..., None]
    rgb = np.where(alpha > 0, rgba[..., :3], 0.0)
    return np.concatenate([rgb * alpha, alpha], axis=2), shown_layer(name, "over", curves, unit_of_values(volume))
