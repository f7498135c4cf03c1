"""The renderer's front door: takes what a user has, calls the compiled splatter."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, Literal

from wavesplat import _native
from wavesplat._looks import colors
from wavesplat._looks.labels import Labels
from wavesplat._looks.look import Look
from wavesplat._looks.materials import Materials
from wavesplat._looks.shading import Shading
from wavesplat._looks.transfer_function import TransferFunction
from wavesplat._looks.transfer_function_2d import TransferFunction2D
from wavesplat._model.argument_types import takes_its_types
from wavesplat._model.camera import Camera
from wavesplat._model.crop import Crop
from wavesplat._model.forked import drawing
from wavesplat._model.options import BY_VIEW, Composite, Kernel, Quality
from wavesplat._model.volume import Volume
from wavesplat._model.wavelet_volume import WaveletVolume
from wavesplat._picture.picture import Picture
from wavesplat._public import public
from wavesplat._render import projection
from wavesplat._render.arguments import (
    ClipPlane,
    check_picture_memory,
    checked_size,
    chosen_camera,
    chosen_labels,
    chosen_look,
    chosen_threads,
    cut_open,
    region,
)
from wavesplat._render.notes import notes_on_picture
from wavesplat.errors import ArgumentError

__all__ = ["render"]

#: Colour, depth and value of a pixel, and of a texel, of which there are `oversampling` squared to a pixel; measured.
PIXEL_BYTES, TEXEL_BYTES = 20, 20
#: Where it does not matter how much more there would be.
MOST_OVERSAMPLING = 1e6


@public
@takes_its_types
def render(
    volume: Volume | WaveletVolume,
    look: Look | TransferFunction | TransferFunction2D | Materials | str | None = None,
    camera: Camera | str | None = None,
    *,
    labels: Labels | None = None,
    size: tuple[int, int] = (512, 512),
    kernel: Kernel = "linear",
    composite: Composite | None = None,
    iso_value: float | None = None,
    local_threshold: float | None = None,
    depth_shading: float | None = None,
    attenuation: tuple[float, float] | None = None,
    shading: Shading | Literal["look"] | None = "look",
    quality: Quality = "normal",
    sheets_per_slice: float | None = None,
    oversampling: float | None = None,
    psnr: float | None = None,
    like: Picture | None = None,
    drop_levels: int = 0,
    band_weights: Sequence[float] | None = None,
    crop: Crop | None = None,
    clip_planes: Sequence[ClipPlane] = (),
    cut_out: Crop | Sequence[Crop] = (),
    background: str | Sequence[float] | None = None,
    threads: int | None = None,
    depth: bool = False,
    pre_integration: bool = True,
    early_ray_termination: bool = True,
    progress: Callable[[float], object] | None = None,
) -> Picture:
    """A picture of the volume, by high-resolution splatting.

    Parameters
    ----------
    volume : Volume or WaveletVolume
        What to draw, from `wavesplat.open` or an array, or from wavelet coefficients.
    look : Look, TransferFunction, TransferFunction2D, Materials or str, optional
        How the values are shown; a text is the name of a preset. None chooses by the kind of data (`Look.auto`); the
        report says which and why. "minimum", "mean", "sum" and "x-ray" then get greys for what this view shows: pass a
        look to frames that are to be compared.
    camera : Camera or str, optional
        Or the name of a view, such as "left". None is the look's view or, where it has none, a patient's front, the
        thin side of a stack, or a three-quarter view from above. Names and None frame what is seen of the volume.
    labels : Labels, optional
        A segmentation beside the scan, with a look for every label; for "over".
    size : (width, height), default (512, 512)
        Pixels.
    kernel : str
        Reconstruction between samples: "linear", the sharper "catmull-rom", the smooth interpolating "bspline2" and
        "bspline3", or the blurring "gaussian".
    composite : str, optional
        None is the look's own. "over": emission and absorption. "first-hit": the isosurface at `iso_value`. The others
        are projections: one number per ray, `Picture.value`, which is then coloured. "maximum" (MIP), "minimum",
        "mean" and "sum" (the integral) of the values; "depth-shaded-maximum", which dims what is far; "local-maximum",
        which stops at the first maximum that reaches `local_threshold`; "x-ray": the share of light that comes through,
        0..1, as a radiograph. On a light background greys that are chosen here are inverted: black is much.
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
    shading : Shading, None or "look"
        Phong shading of "over" and "first-hit"; None draws the colours as given, "look" is the look's own.
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
    cut_out : Crop or sequence of Crop
        Boxes to take out, such as `Crop.corner(volume, "left anterior superior")`: one looks into the volume, and its
        colours are those of the whole. Samples whose centres are inside of a box are drawn as empty, so on axes that
        are oblique to the box its faces are stairs of samples. `labels` are taken out with them. The first picture with
        other boxes makes a copy of the samples, 4 bytes each (8 where they are 32-bit integers or float64), and what
        the renderer prepares of it takes 5 more; volume and labels keep both until other boxes are given.
        A WaveletVolume has no samples to take out: draw its `to_volume()`.
    background : colour, optional
        (r, g, b), (r, g, b, a), "#rrggbb" or a name. None is the look's own or, where it has none, transparent.
    threads : int, optional
        Worker threads; None uses all cores. The picture does not depend on it.
    depth : bool
        Also give `Picture.depth`.
    pre_integration : bool
        Pre-integrate the space between sheets where the transfer function is steep, so that hard surfaces are found and
        shaded where they are. False: plain sheets, as the method has it.
    early_ray_termination : bool
        Stop rays where no more than 1e-4 of their light comes through. False: where no more than 2e-6 does.
    progress : callable, optional
        Called with the part done, 0..1; returning False stops.

    Returns
    -------
    Picture
        With `rgba`, float32, shape (height, width, 4), associated. `report["look"]` has the look's name and reason,
        `report["processing"]` what was done to the samples (`Facts.processing`).

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
    volume = _weighted(volume, drop_levels, band_weights)
    automatic = look is None or (isinstance(look, str) and look.lower() == "auto")
    chosen = chosen_look(look, volume, composite)
    composite = chosen.composite
    shading = chosen.shading if shading == "look" else shading
    labels = chosen.labels if labels is None else labels
    projection.check_owners(
        composite,
        iso_value=iso_value,
        local_threshold=local_threshold,
        depth_shading=depth_shading,
        attenuation=attenuation,
    )
    seen, boxes = cut_open(volume, cut_out)
    drawn: _native.Volume | _native.DecodedVolume = (
        seen._decoded(drop_levels) if isinstance(seen, WaveletVolume) else seen._core
    )
    if psnr is not None and (sheets_per_slice is not None or oversampling is not None):
        raise ArgumentError("psnr chooses sheets_per_slice and oversampling; leave out either it or them")
    measured = measured_by(like, psnr, composite)
    if labels is not None and (composite != "over" or drop_levels != 0):
        raise ArgumentError('labels are drawn with composite="over" and all levels; leave out one of them')
    absorbs = projection.absorption(composite, attenuation, volume)
    camera = chosen_camera(camera, seen, chosen, crop, width / max(height, 1), clip_planes=clip_planes)
    function = chosen.transfer_function
    if automatic and composite in BY_VIEW:

        def overview(curves: TransferFunction, at: Camera, of: tuple[int, int]) -> Picture:
            drawn_as: Any = {"composite": composite, "attenuation": absorbs, "drop_levels": drop_levels}
            within: Any = {"crop": crop, "clip_planes": clip_planes, "cut_out": boxes, "threads": threads}
            return render(volume, curves, at, size=of, quality="draft", sheets_per_slice=1, **drawn_as, **within)

        function = projection.exposed_by(overview, volume, composite, camera, (width, height)) or function
    behind = colors.parse(chosen.background if background is None else background)
    if chosen.name == "auto" and chosen.background is None:
        function = projection.on(behind, composite, function)
    numbers = projection.numbers(composite, function, local_threshold, depth_shading, absorbs)
    curves, eye = function._core, camera._core
    light = None if shading is None else shading._core
    with drawing(volume):
        default_sheets, default_oversampling = _native.quality_settings(quality, drawn, curves, light, eye, height)
        wanted = default_oversampling if oversampling is None else abs(float(oversampling))
        texels = 1 if psnr is not None else min(wanted, MOST_OVERSAMPLING) ** 2
        check_picture_memory((width, height), PIXEL_BYTES + TEXEL_BYTES * texels)
        result = _native.render(
            drawn,
            curves,
            eye,
            labels=chosen_labels(labels, volume, boxes),
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
            background=behind,
            threads=chosen_threads(threads),
            depth=bool(depth),
            pre_integration=bool(pre_integration),
            early_ray_termination=bool(early_ray_termination),
            progress=progress,
        )
    report = result["report"] | numbers | {"look": {"name": chosen.name, "reason": chosen.reason}}
    report["processing"] = list(volume.facts.processing)
    told = report.get("measured")
    if isinstance(told, dict):
        told["composite"] = composite
    rgba, value = result["rgba"], result["value"]
    if notes := notes_on_picture(volume, function, composite=composite, iso_value=iso_value, rgba=rgba, value=value):
        report["notes"] = notes
    return Picture(result["rgba"], result["depth"], result["value"], report)


def _weighted(
    volume: Volume | WaveletVolume, drop_levels: int, band_weights: Sequence[float] | None
) -> Volume | WaveletVolume:
    """The volume with its bands weighted."""
    if isinstance(volume, WaveletVolume):
        return volume.bands(band_weights)
    if not isinstance(volume, Volume):
        raise ArgumentError(f"volume is a {type(volume).__name__}; give a wavesplat.Volume, as wavesplat.Volume(array)")
    if drop_levels != 0 or band_weights is not None:
        raise ArgumentError("drop_levels and band_weights are for a WaveletVolume; make one with from_volume")
    return volume


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
