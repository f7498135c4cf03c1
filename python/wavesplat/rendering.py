"""The renderer's front door: takes what a user has, calls the compiled splatter."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from operator import index
from typing import Any, TypeAlias

from wavesplat import _native, colors, projection
from wavesplat.camera import Camera
from wavesplat.crop import Crop
from wavesplat.errors import ArgumentError
from wavesplat.grid import Grid
from wavesplat.labels import Labels
from wavesplat.materials import Materials
from wavesplat.options import BY_VIEW, Composite, Kernel, Method, Quality
from wavesplat.picture import Picture
from wavesplat.shading import Shading
from wavesplat.standard import StandardSplatting, chosen_standard, draw_standard
from wavesplat.transfer_function import TransferFunction
from wavesplat.transfer_function_2d import TransferFunction2D
from wavesplat.variant import Variant
from wavesplat.vectors import Vector, vector
from wavesplat.volume import Volume
from wavesplat.wavelet_volume import WaveletVolume

__all__ = ["render"]

ClipPlane: TypeAlias = tuple[Iterable[float], Iterable[float]]

DEFAULT_SHADING = Shading()


def render(
    volume: Volume | WaveletVolume,
    transfer_function: TransferFunction | TransferFunction2D | Materials | str | None = None,
    camera: Camera | str | None = None,
    *,
    labels: Labels | None = None,
    size: tuple[int, int] = (512, 512),
    kernel: Kernel = "linear",
    composite: Composite = "over",
    iso_value: float | None = None,
    local_threshold: float | None = None,
    depth_shading: float | None = None,
    attenuation: tuple[float, float] | None = None,
    shading: Shading | None = DEFAULT_SHADING,
    quality: Quality = "normal",
    sheets_per_slice: float | None = None,
    oversampling: float | None = None,
    psnr: float | None = None,
    like: Picture | None = None,
    drop_levels: int = 0,
    band_weights: Sequence[float] | None = None,
    crop: Crop | None = None,
    clip_planes: Sequence[ClipPlane] = (),
    background: str | Sequence[float] | None = None,
    threads: int | None = None,
    depth: bool = False,
    refined: bool = True,
    method: Method = "high-resolution",
    standard: StandardSplatting | None = None,
    variant: Variant | None = None,
    progress: Callable[[float], object] | None = None,
) -> Picture:
    """A picture of the volume, by high-resolution splatting.

    Parameters
    ----------
    volume : Volume or WaveletVolume
        What to draw, from `wavesplat.open` or an array, or from wavelet coefficients.
    transfer_function : TransferFunction, TransferFunction2D, Materials or str, optional
        Or the name of a preset; None makes one from the histogram (`TransferFunction.auto`), for "minimum", "mean",
        "sum" and "x-ray" from what this view shows: pass one to frames that are to be compared.
    camera : Camera or str, optional
        Or the name of a view, such as "left"; None is the anterior view.
    labels : Labels, optional
        A segmentation beside the scan, with a look for every label; for "over".
    size : (width, height), default (512, 512)
        Pixels.
    kernel : str
        Reconstruction between samples: "linear", the sharper "catmull-rom", the smooth interpolating "bspline2" and
        "bspline3", or the blurring "gaussian".
    composite : str
        "over": emission and absorption. "first-hit": the surface at `iso_value`. The others are projections: one number
        per ray, `Picture.value`, which is then coloured. "maximum", "minimum", "mean" and "sum" (the integral) of the
        values; "depth-shaded-maximum", which dims what is far; "local-maximum", which stops at the first maximum that
        reaches `local_threshold`; "x-ray": the share of light that comes through, 0..1, as a radiograph.
    iso_value : float, optional
        Sample value of the surface that "first-hit" shows.
    local_threshold : float, optional
        Sample value that a maximum must reach for "local-maximum"; rays without one show their largest value. None is
        a quarter of the way from the first to the last colour of the transfer function.
    depth_shading : float, optional
        How much "depth-shaded-maximum" dims the farthest point of what is drawn, 0..1, towards the value of the first
        colour; the nearest is not dimmed. None is 0.6.
    attenuation : (clear, attenuation), optional
        What "x-ray" is drawn with: the largest sample value that absorbs nothing, and absorption per world unit and
        sample unit above it. None is (-1000, 2.059e-5) for values that look like Hounsfield units, which is water at
        60 keV in millimetres; else it follows the range of values.
    shading : Shading or None
        Phong shading of "over" and "first-hit"; None draws the colours as given.
    quality : str
        "draft", "normal" or "high": sets the next two where they are None, "high" by how steep the transfer function
        is; the report holds what was used.
    sheets_per_slice : float, optional
        Sheets per slice distance.
    oversampling : float, optional
        Texels per pixel, along each side; a pixel is the mean of as many reads along each, rounded up. In perspective
        on the whole: where rays lie closest together, pixels get 0.7 of that at least.
    psnr : float, optional
        Instead of `quality`: choose both for this PSNR against the converged picture with 16 rays a pixel, in dB, 20 to
        80; 40 is good, 50 can hardly be told from it. Some tiles of the picture are drawn with several samplings to
        measure its error, then all of it is drawn once, with the cheapest sampling that promises enough. The report
        has that as `sheets_per_slice` and `oversampling`, and an estimate as `expected_psnr_db`, with its standard
        deviation as `expected_psnr_spread_db`: less than what was asked for where nothing reaches that. Projections
        are compared with one ray a pixel.
    like : Picture, optional
        With `psnr`: a picture of the same volume and transfer function that was drawn with `psnr`, be it of another
        value. What was measured on it is believed, and this one is drawn without measuring anything: for the frames of
        a turn, say. That promises less, which `expected_psnr_spread_db` tells. Leave it out for a frame now and then
        where the view changes much. Where it showed nothing, where only one of the two transfer functions is
        steep, or where pixels are more than 1.5 times as far apart or as close as they were, in samples, this picture
        is measured all the same. `measured` in the report has the numbers.
    drop_levels : int
        Of a WaveletVolume: leave out the details of this many levels, the finest first. What is left is drawn at its
        own resolution, with fewer sheets and texels (B-spline families: at the full one), and classified by
        the samples that it stands for, so that the picture keeps its brightness.
    band_weights : sequence of float, optional
        Of a WaveletVolume: a factor for each level's details, the finest first, and for the coarsest samples. Without
        these (weight 0) values are signed details, for which None makes a diverging transfer function.
    crop : Crop, optional
        Draw only this box.
    clip_planes : sequence of (point, normal)
        World units; what lies on the side that the normal points to is kept.
    background : colour, optional
        (r, g, b), (r, g, b, a), "#rrggbb" or a name; None is transparent.
    threads : int, optional
        Worker threads; None uses all cores. The picture does not depend on it.
    depth : bool
        Also give `Picture.depth`.
    refined : bool
        Pre-integrate the space between sheets where the transfer function is steep, so that hard surfaces are found and
        shaded where they are, and stop rays that are opaque. False: plain sheets, as the method has it.
    method : str
        "high-resolution", or "standard": the older technique, which splats colours and opacities where this one splats
        densities (Westover 1990). It blurs, and is there to be compared with; it has no other composites than "over",
        and of `quality` it takes the texels per pixel.
    standard : StandardSplatting, optional
        Which buffers "standard" has, and whether it corrects for the view angle.
    variant : Variant, optional
        Leave out, or change, a part of the method; for studies.
    progress : callable, optional
        Called with the part done, 0..1; returning False stops.

    Returns
    -------
    Picture
        With `rgba`, float32, shape (height, width, 4), associated.

    Raises
    ------
    ArgumentError
        If an argument cannot work; the message says which, and how to mend it.
    LimitError
        If the picture needs more memory than there may be.
    CancelledError
        If `progress` returned False.

    Examples
    --------
    >>> import wavesplat as ws
    >>> volume = ws.examples.ripples(16)
    >>> picture = ws.render(volume, camera=ws.Camera.orbit(volume, 30, 20), size=(64, 48))
    >>> picture.rgba.shape
    (48, 64, 4)

    Notes
    -----
    ARCHITECTURE.md describes the method; Mueller, Moeller and Crawfis (1999) its idea.
    """
    width, height = checked_size(size)
    standard = chosen_standard(
        method,
        standard,
        composite=composite,
        iso_value=iso_value,
        sheets_per_slice=sheets_per_slice,
        psnr=psnr,
        drop_levels=drop_levels,
        labels=labels,
        depth=depth,
        refined=refined,
    )
    projection.check_owners(
        composite,
        iso_value=iso_value,
        local_threshold=local_threshold,
        depth_shading=depth_shading,
        attenuation=attenuation,
    )
    if isinstance(volume, WaveletVolume):
        volume = volume.bands(band_weights)
        drawn: _native.Volume | _native.DecodedVolume = volume._decoded(drop_levels)
    elif drop_levels != 0 or band_weights is not None:
        raise ArgumentError("drop_levels and band_weights are for a WaveletVolume; make one with from_volume")
    else:
        drawn = volume._core
    if psnr is not None and (sheets_per_slice is not None or oversampling is not None):
        raise ArgumentError("psnr chooses sheets_per_slice and oversampling; leave out either it or them")
    measured = measured_by(like, psnr, composite)
    if labels is not None and (composite != "over" or drop_levels != 0):
        raise ArgumentError('labels are drawn with composite="over" and all levels; leave out one of them')
    absorbs = projection.absorption(composite, attenuation, volume)
    camera = chosen_camera(camera, volume, width / max(height, 1))
    if transfer_function in (None, "auto") and composite in BY_VIEW:
        overview = render(
            volume,
            projection.ANY_CURVES,
            camera,
            size=projection.overview_size(width, height),
            composite=composite,
            attenuation=absorbs,
            quality="draft",
            sheets_per_slice=1,
            drop_levels=drop_levels,
            crop=crop,
            clip_planes=clip_planes,
            threads=threads,
            variant=variant,
        )
        transfer_function = projection.exposed(volume, composite, overview)
    chosen = chosen_transfer_function(transfer_function, volume, composite)
    numbers = projection.numbers(composite, chosen, local_threshold, depth_shading, absorbs)
    curves, eye = chosen._core, camera._core
    light = None if shading is None else shading._core
    default_sheets, default_oversampling = _native.quality_settings(quality, drawn, curves, light, eye, height)
    if standard is not None:
        return draw_standard(
            standard,
            drawn,
            curves,
            eye,
            size=(width, height),
            kernel=kernel,
            shading=light,
            oversampling=default_oversampling if oversampling is None else float(oversampling),
            region=region(crop, clip_planes),
            background=colors.parse(background),
            threads=checked_count(threads, "threads"),
            progress=progress,
        )
    result = _native.render(
        drawn,
        curves,
        eye,
        labels=chosen_labels(labels, volume),
        width=width,
        height=height,
        kernel=kernel,
        composite=composite,
        iso_value=None if iso_value is None else float(iso_value),
        local_threshold=numbers.get("local_threshold"),
        depth_shading=numbers.get("depth_shading"),
        attenuation=numbers.get("attenuation"),
        shading=light,
        sheets_per_slice=default_sheets if sheets_per_slice is None else float(sheets_per_slice),
        oversampling=default_oversampling if oversampling is None else float(oversampling),
        psnr=None if psnr is None else float(psnr),
        like=measured,
        **region(crop, clip_planes),
        background=colors.parse(background),
        threads=checked_count(threads, "threads"),
        depth=bool(depth),
        refined=bool(refined),
        variant=None if variant is None else variant._core,
        progress=progress,
    )
    report = result["report"] | numbers
    told = report.get("measured")
    if isinstance(told, dict):
        told["composite"] = composite
    return Picture(result["rgba"], result["depth"], result["value"], report)


def measured_by(like: object, psnr: float | None, composite: str) -> dict[str, Any] | None:
    """What a picture told of its error, if it is of the kind that is wanted."""
    if like is None:
        return None
    if psnr is None:
        raise ArgumentError("like is for a wanted PSNR; pass psnr too, or leave out like")
    if not isinstance(like, Picture) or "measured" not in like.report:
        raise ArgumentError("like is no picture that was drawn with psnr; draw the first with psnr alone, then pass it")
    measured: dict[str, Any] | None = like.report["measured"]
    if measured is not None and measured["composite"] != composite:
        raise ArgumentError(
            f'like was drawn with composite="{measured["composite"]}", which tells nothing of "{composite}"; '
            "leave out like"
        )
    return measured


def chosen_transfer_function(
    given: TransferFunction | TransferFunction2D | Materials | str | None,
    volume: Volume | WaveletVolume,
    composite: str = "over",
) -> TransferFunction | TransferFunction2D:
    """The transfer function itself, or the one that materials, a preset name or None stand for."""
    if isinstance(given, TransferFunction | TransferFunction2D):
        return given
    if isinstance(given, Materials):
        return given.transfer_function()
    if given is None or given == "auto":
        return TransferFunction.auto(volume, composite)
    if isinstance(given, str):
        return TransferFunction.preset(given, volume)
    raise ArgumentError(
        f"transfer_function is a {type(given).__name__}; give a TransferFunction, Materials or the name of a preset"
    )


def chosen_labels(given: Labels | None, volume: Grid) -> _native.Labels | None:
    """The labels as the compiled module takes them, if they lie on the volume's samples."""
    if given is None:
        return None
    if not isinstance(given, Labels):
        raise ArgumentError(f"labels is a {type(given).__name__}; give a wavesplat.Labels(segmentation, ...)")
    return given.beside(volume)


def chosen_camera(given: Camera | str | None, volume: Grid, aspect: float) -> Camera:
    """The camera itself, or the one that a view's name or None stands for."""
    if isinstance(given, Camera):
        return given
    if given is None or isinstance(given, str):
        # A picture without pixels has no aspect; the compiled module refuses it.
        return Camera.view(volume, given or "anterior", aspect=aspect if aspect > 0 else 1.0)
    raise ArgumentError(f"camera is a {type(given).__name__}; give a Camera or the name of a view")


def checked_size(size: Sequence[int]) -> tuple[int, int]:
    """Width and height as plain integers, 0 or more."""
    try:
        width, height = (index(number) for number in size)
    except (TypeError, ValueError):
        raise ArgumentError(f"size is {size!r}; give (width, height), two whole numbers of pixels") from None
    if width < 0 or height < 0:
        raise ArgumentError(f"size is {width} x {height} pixels; width and height must be at least 1")
    return width, height


def checked_count(number: int | None, name: str) -> int | None:
    """The number as a plain integer, 0 or more, or None."""
    if number is None:
        return None
    try:
        count = index(number)
    except TypeError:
        raise ArgumentError(f"{name} is {number!r}; give a whole number") from None
    if count < 0:
        raise ArgumentError(f"{name} is {count}; give a whole number of at least 1")
    return count


def region(crop: Crop | None, clip_planes: Sequence[ClipPlane]) -> dict[str, Any]:
    """Crop and clip planes as the compiled module takes them."""
    if crop is not None and not isinstance(crop, Crop):
        raise ArgumentError(f"crop is a {type(crop).__name__}; give a wavesplat.Crop(lower, upper, space=...)")
    return {
        "crop_index": crop.corners_in("index") if crop else None,
        "crop_world": crop.corners_in("world") if crop else None,
        "clip_planes": [_plane(plane, number) for number, plane in enumerate(clip_planes)],
    }


def _plane(plane: ClipPlane, number: int) -> tuple[Vector, Vector]:
    try:
        point, normal = plane
    except (TypeError, ValueError):
        raise ArgumentError(f"clip plane {number} is {plane!r}; give (point, normal), three numbers each") from None
    return vector(point, f"point of clip plane {number}"), vector(normal, f"normal of clip plane {number}")
