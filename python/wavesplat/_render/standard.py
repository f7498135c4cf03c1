"""Standard splatting, the older technique: what it has to choose, and which options of `render` it knows."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, get_args

from wavesplat import _native
from wavesplat._model.options import Buffer, Kernel, Method
from wavesplat._picture.picture import Picture
from wavesplat._public import public
from wavesplat.errors import ArgumentError

__all__ = ["StandardSplatting"]


@public
@dataclass(frozen=True)
class StandardSplatting:
    """Where standard splatting has its sheet buffers, and how thick it takes their slabs to be.

    Parameters
    ----------
    buffer : str
        "axis": sheet buffers parallel to the slices of the axis nearest to the view, one per slice, then mapped to the
        view plane. "view": parallel to the view plane; samples are sorted by depth into slabs as thick as the distance
        from slice to slice along the view.
    view_angle_correction : bool
        True: opacities are those of the length that a ray runs from slice to slice. False: those of the slice distance
        from everywhere, as if slices were seen head-on; oblique views are then too clear ("axis") or, since samples lie
        closer in the picture, too opaque and too bright ("view").

    Raises
    ------
    ArgumentError
        If there is no such buffer, or the correction is not True or False.

    Examples
    --------
    >>> import wavesplat as ws
    >>> volume = ws.examples.ripples(16)
    >>> view_plane = ws.StandardSplatting(buffer="view", view_angle_correction=False)
    >>> ws.render(volume, method="standard", standard=view_plane, size=(32, 24)).rgba.shape
    (24, 32, 4)

    Notes
    -----
    Westover, *Footprint evaluation for volume rendering* (1990). Every sample is classified and shaded with its own
    value and the differences of its neighbours; its colour and opacity are then splatted. Overlapping splats can add up
    to more than there is: sums are clamped, opacity to 1 and colours to what that opacity can show. B-spline kernels
    smooth here, since there is no prefilter for colours. Crop boxes and clip planes keep the samples whose centres are
    inside.
    """

    buffer: Buffer = "axis"
    view_angle_correction: bool = True

    def __post_init__(self) -> None:
        """Check at once, so that an error points at the line that made it."""
        buffers = get_args(Buffer)
        if self.buffer not in buffers:
            raise ArgumentError(f"there is no buffer {self.buffer!r}; the buffers are {', '.join(buffers)}")
        if not isinstance(self.view_angle_correction, bool):
            raise ArgumentError(f"view_angle_correction is {self.view_angle_correction!r}; give True or False")


#: Options of `render` that have no meaning in standard splatting: their defaults, and why.
UNKNOWN: dict[str, tuple[object, str]] = {
    "composite": ("over", "it splats colours, which are composited with over"),
    "iso_value": (None, "it splats colours, which have no surface"),
    "sheets_per_slice": (None, "samples are splatted once, into the buffer of their slice or slab"),
    "psnr": (None, "no setting of it comes closer to the converged picture"),
    "drop_levels": (0, "it draws the samples themselves"),
    "labels": (None, "it splats the colours of samples"),
    "depth": (False, "sheet buffers have no surfaces"),
    "refined": (True, "there is nothing between its sheet buffers"),
}


def chosen_standard(method: Method, standard: StandardSplatting | None, **options: object) -> StandardSplatting | None:
    """What `render` was asked for, None for high-resolution splatting; `options` are those of `UNKNOWN`."""
    methods = get_args(Method)
    if method not in methods:
        raise ArgumentError(f"there is no method {method!r}; the methods are {', '.join(methods)}")
    if method != "standard":
        if standard is not None:
            raise ArgumentError(f'standard is for method="standard", not for {method!r}; give that, or leave it out')
        return None
    if standard is not None and not isinstance(standard, StandardSplatting):
        raise ArgumentError(f"standard is a {type(standard).__name__}; give a wavesplat.StandardSplatting(buffer=...)")
    for name, value in options.items():
        default, why = UNKNOWN[name]
        if value != default:
            raise ArgumentError(
                f'method="standard" has no {name}={value!r}: {why}; leave it out, or use method="high-resolution"'
            )
    return standard or StandardSplatting()


def draw_standard(
    standard: StandardSplatting,
    drawn: _native.Volume | _native.DecodedVolume,
    transfer_function: _native.TransferFunction,
    camera: _native.Camera,
    *,
    size: tuple[int, int],
    kernel: Kernel,
    shading: _native.Shading | None,
    oversampling: float,
    region: dict[str, Any],
    background: tuple[float, float, float, float] | None,
    threads: int | None,
    progress: Callable[[float], object] | None,
) -> Picture:
    """The picture, from arguments that `render` has checked."""
    result = _native.render_standard(
        drawn,
        transfer_function,
        camera,
        width=size[0],
        height=size[1],
        kernel=kernel,
        shading=shading,
        oversampling=oversampling,
        buffer=standard.buffer,
        view_angle_correction=standard.view_angle_correction,
        **region,
        background=background,
        threads=threads,
        progress=progress,
    )
    return Picture(result["rgba"], result["depth"], result["value"], result["report"])
