"""The automatic look of a volume, by the kind of data (`kinds.py`) and its histogram (`histogram.py`).

Homogeneous matter, and noise, must not cover what lies behind. Where nothing is known but the values, opacities
follow Kindlmann and Durkin (1998): high at the values that boundaries between two materials pass through, where
gradients are largest, and low at the values of the materials themselves.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from wavesplat import _native
from wavesplat._looks.curves.colormaps import colors_of
from wavesplat._looks.curves.transfer_function import TransferFunction
from wavesplat._looks.curves.transfer_function_2d import TransferFunction2D
from wavesplat._looks.kinds import histogram
from wavesplat._looks.kinds.channel_colors import color_of
from wavesplat._looks.kinds.channels import (
    channel_window,
    clear_of_values,
    opaque_after,
    ramp,
    window_of_values,
)
from wavesplat._looks.kinds.histogram import otsu, robust_range_of, without_padding
from wavesplat._looks.kinds.kinds import Evidence, Kind, evidence, kind_of, offset_of
from wavesplat._looks.kinds.looked_at import subsampled
from wavesplat._looks.labels import label_names
from wavesplat._looks.labels.labels import Labels
from wavesplat._looks.look import Look
from wavesplat._looks.shading import Shading
from wavesplat._model.arguments.sampling import BY_VIEW
from wavesplat._model.lazy.volume import LazyVolume
from wavesplat._model.volume import units
from wavesplat._model.volume.facts import Rgb
from wavesplat._model.volume.grid import axis_of_distant_slices, axis_of_few_slices, is_thin
from wavesplat._model.volume.volume import Volume
from wavesplat._model.volume.wavelet_volume import WaveletVolume
from wavesplat.errors import ArgumentError

if TYPE_CHECKING:
    from wavesplat._model.arguments.sampling import Composite

# Blocks: volumes whose matter goes up to their faces, such as crops and small fields of view.
#
# Only the six outermost slices of an opaque block can be seen. Matter that goes up to a face is opaque there, so a
# block is recognised by the share of its faces that is not clear. (`studies/looks`; mean of the six faces. Whole
# bodies, heads and things: 0 to 0.16; crops to 0.3 and 0.5 of the sides of heads, brains and pelves: 0.52 to 0.91; a
# knee of 10 slices: 0.47.)

#: Minimum mean share of the faces that is not clear, and the opacity above which a voxel is not clear.
MIN_FACES, MIN_OPACITY = 0.4, 0.02
#: Samples of a face that are looked at, about.
FACE_SAMPLES = 4096


def is_block(volume: Volume | WaveletVolume, function: Callable[[NDArray[np.float64]], NDArray[np.float64]]) -> bool:
    """Whether a volume looks like a block under a transfer function, which maps values to RGBA."""
    samples = subsampled(volume)
    faces = [_some_of(samples.take(end, axis)) for axis in range(3) for end in (0, -1)]
    seen = [np.isfinite(face) & (function(np.nan_to_num(face))[:, 3] > MIN_OPACITY) for face in faces]
    return bool(np.mean([face.mean() for face in seen]) >= MIN_FACES)


def _some_of(face: NDArray[Any]) -> NDArray[np.float64]:
    """Some thousand samples of a face: the standard error of a share is then below 0.01."""
    step = max(1, int((face.size / FACE_SAMPLES) ** 0.5))
    return face[::step, ::step].ravel().astype(np.float64)


# The automatic look of a volume, by the kind of data (`kinds.py`) and its histogram (`histogram.py`).

#: Kinds whose look has a map of colours over a scale.
COLORED: tuple[Kind, ...] = ("field", "signed field")
#: Light for solid things: ambient occlusion lets depth be seen.
SOLID = Shading(ambient_occlusion=0.3)
#: Light for translucent things: a highlight on every faint boundary would be noise.
SOFT = Shading(specular=0.1)

#: Colour of fluorescence whose file has none: green, as GFP has it, white where it is brightest.
GREEN = (0.35, 1.0, 0.45)
#: Largest luminance of the full colour of fluorescence, so that white and yellow have room for what is brighter.
MAX_LUMINANCE = 0.75
#: White of a maximum projection of fluorescence, at most so many widths of the window of the samples above its low end.
MAX_WHITE = 2.0
#: Kinds of data that are shown in greys where there are but a few slices: their looks are translucent, millimetre by
#: millimetre.
IN_GREYS = ("CT", "MR", "ultrasound", "scan")
#: Kinds of data that are cut open where matter fills the volume up to its faces.
BLOCKS = ("MR", "scan")
#: Hounsfield units in the black of a maximum: every ray through a body meets soft tissue, so that what is below shows
#: nothing but the table, and takes half of the greys from vessels and bone.
CT_MAXIMUM_BLACK = -100.0
#: Percentile of the pixels of air in a PET that is still white, and the largest share of the greys that white has.
AIR_PERCENT, MAX_AIR = 99.5, 0.02


def automatic(volume: Volume | WaveletVolume, composite: Composite | None, color: Rgb | None = None) -> Look:
    """See `Look.auto`; `color` is that of fluorescence, instead of the channel's own."""
    low, high = volume.value_range
    # Uniform matter projects to lengths, which depend on the view, so greys can still be found for it.
    if not low < high and composite not in BY_VIEW and not (volume.n_nonfinite and composite in (None, "over")):
        raise ArgumentError(
            f"volume {volume.name!r}: every sample is {low:g}, so the histogram shows nothing to tell apart; "
            "pass a transfer function, or check the file"
        )
    if isinstance(volume, WaveletVolume) and volume.is_detail and composite in (None, "over"):
        function = histogram.signed(volume)
        return Look(transfer_function=function, name="auto", reason="details of wavelets: values with two signs")
    if not math.isfinite(high - low):
        raise ArgumentError(
            f"volume {volume.name!r} has samples from {low:g} to {high:g}, too far apart for float64; divide them"
        )
    known = evidence(volume)
    if composite is None and known.kind == "PET":
        return _inverted_maximum(volume, known)
    if composite is None and known.has_few_bright:
        return _maximum_of_few(volume, known)
    if composite in histogram.PROJECTIONS:
        function = _greys_of_projection(volume, known, composite)
        return Look(transfer_function=function, composite=composite, shading=None, name="auto", reason=known.reason)
    if composite in (None, "over") and (labels := labels_alone(volume, known.kind)) is not None:
        clear = TransferFunction([(0.0, 0.0)], [(0.0, 1.0, 1.0, 1.0)])
        return Look(transfer_function=clear, labels=labels, shading=SOLID, name="auto", reason=known.reason)
    if composite is None and known.kind in IN_GREYS and axis_of_few_slices(volume) is not None:
        n = min(volume.shape)
        reason = f"{known.reason}; its {n} slices in greys, since so few are too thin for a translucent look"
        return Look(transfer_function=_greys(known, is_clear_below=True), shading=None, name="auto", reason=reason)
    made_by = LOOKS[known.kind]
    function, shading = made_by(volume, known, color) if made_by is _fluorescence else made_by(volume, known)
    if composite is None and known.kind in BLOCKS and is_block(volume, function):
        return _cut_open(volume, known)
    return Look(
        transfer_function=function,
        shading=shading,
        composite=composite or "over",
        name="auto",
        reason=known.reason,
    )


def labels_alone(volume: Volume | WaveletVolume, kind: Kind) -> Labels | None:
    """The labels of a segmentation, or of a mask that its file names, with the file's names and colours; else None.

    Labels lie in memory: of a segmentation that does not fit there are none.
    """
    if kind not in ("labels", "mask") or not isinstance(volume, Volume) or volume.dtype.kind not in "iuf":
        return None
    named = label_names.of_volume(volume)
    if (kind == "mask" and not named) or (isinstance(volume, LazyVolume) and not volume.fits_in_budget):
        return None
    try:
        labels = Labels(volume.read() if isinstance(volume, LazyVolume) else volume)
    except ArgumentError:  # fractions, or far too many numbers, between the samples that were looked at
        return None
    return labels._with_names(named)


def _greys_of_projection(volume: Volume | WaveletVolume, known: Evidence, composite: Composite) -> TransferFunction:
    function = histogram.projected(volume, composite)
    if composite not in histogram.MAXIMA:
        return function
    if known.kind == "fluorescence" or (known.kind == "scan" and not volume.is_anatomical):
        # A few specks may be many times as bright as all else, and have many pixels.
        low, high = window_of_values(without_padding(subsampled(volume)))
        function = histogram.not_beyond(function, low + MAX_WHITE * (high - low))
    if known.kind == "CT":
        function = histogram.not_before(function, CT_MAXIMUM_BLACK + offset_of(volume))
    return function


def are_colored(volume: Volume | WaveletVolume, composite: Composite | None) -> bool:
    """Whether the automatic look of a volume has a map of colours, which another one can take the place of."""
    is_detail = isinstance(volume, WaveletVolume) and volume.is_detail
    return composite in (None, "over") and not is_detail and kind_of(volume) in COLORED


def in_colors(look: Look, volume: Volume | WaveletVolume, colormap: str) -> Look:
    """The automatic look of a field in the colours of a map; an `ArgumentError` of other looks."""
    function = look.transfer_function
    if not are_colored(volume, look.composite) or not isinstance(function, TransferFunction):
        raise ArgumentError(
            f"volume {volume.name!r}: the look ({look.composite}, {look.reason}) is not one of a field, whose colours "
            f"a map can take the place of; use TransferFunction.from_colormap({colormap!r}, volume)"
        )
    return replace(look, transfer_function=function_in_colors(function, colormap), name=colormap)


def function_in_colors(function: TransferFunction, colormap: str) -> TransferFunction:
    """The automatic function of a field in the colours of a map: evenly over its nodes."""
    values = [value for value, *_ in function.color]
    places, colors = colors_of(colormap)
    rgb = [np.interp(np.linspace(0, 1, len(values)), places, colors[:, c]).tolist() for c in range(3)]
    return TransferFunction(function.opacity, list(zip(values, *rgb, strict=True)), function.opacity_unit)


def tinted(function: TransferFunction | TransferFunction2D, color: Rgb) -> TransferFunction | TransferFunction2D:
    """The transfer function tinted: its white becomes a colour."""
    if isinstance(function, TransferFunction2D):
        rgba = function.rgba * np.array([*color, 1.0])
        return function._with_rgba(rgba)
    red, green, blue = color
    nodes = [(value, r * red, g * green, b * blue) for value, r, g, b in function.color]
    return TransferFunction(function.opacity, nodes, function.opacity_unit, function.gradient_opacity)


def _cut_open(volume: Volume | WaveletVolume, known: Evidence) -> Look:
    """A look of matter that fills the volume, so that only its faces would be seen: cut open, in opaque greys."""
    axis = axis_of_distant_slices(volume)
    view = "isometric" if axis is None else ("yz", "xz", "xy")[axis]
    return Look(
        transfer_function=_greys(known),
        shading=None,
        view=None if is_thin(volume) else view,
        part="cut open",
        name="auto",
        reason=f"{known.reason}; matter up to the faces of the volume, shown in greys",
    )


def _inverted_maximum(volume: Volume | WaveletVolume, known: Evidence) -> Look:
    """A look that shows the largest uptake along each ray, black on white."""
    pixels = histogram.pixels_of_maxima(volume)
    greys = histogram.exposed(volume, "maximum", pixels)
    first, last = greys.color[0][0], greys.color[-1][0]
    # The noise of air, whose largest value along a ray is no 0, showed the box of the scan as a grey one on white.
    _, threshold, _ = _parted(known)
    air = pixels[pixels < threshold]
    if air.size:
        first = max(first, min(float(np.percentile(air, AIR_PERCENT)), first + MAX_AIR * (last - first)))
    # Faint uptake must show: half of the greys for the lower third.
    color = [(first, 1.0, 1.0, 1.0), (first + 0.3 * (last - first), 0.48, 0.48, 0.48), (last, 0.0, 0.0, 0.0)]
    function = TransferFunction([(first, 1.0)], color)
    return Look(
        transfer_function=function,
        composite="maximum",
        shading=None,
        background="white",
        name="auto",
        reason=known.reason,
    )


def _maximum_of_few(volume: Volume | WaveletVolume, known: Evidence) -> Look:
    """A maximum projection for a few bright samples over noise, in which the noise is nearly black."""
    pixels = histogram.pixels_of_maxima(volume)
    noise = float(np.median(pixels))
    deviation = 1.4826 * float(np.median(np.abs(pixels - noise)))
    far = pixels[pixels > noise + _native.FAR_ABOVE_NOISE * deviation]
    white = float(np.percentile(far, 98.0)) if far.size else float(pixels.max())
    black = min(noise + 2.0 * deviation, 0.5 * (noise + white))
    reason = f"{known.reason}; so the largest value along each ray is shown"
    function = TransferFunction([(black, 1.0)], [(black, 0.0, 0.0, 0.0), (white, 1.0, 1.0, 1.0)])
    return Look(transfer_function=function, composite="maximum", shading=None, name="auto", reason=reason)


def _greys(known: Evidence, *, is_clear_below: bool = False) -> TransferFunction:
    """Opaque greys, as slices are shown. `is_clear_below`: what would be black is clear, such as air."""
    return TransferFunction(*_native.grey_nodes(known.values, known.kind == "CT", is_clear_below))


Made = tuple[TransferFunction, "Shading | None"]


def _ct(volume: Volume | WaveletVolume, _known: Evidence) -> Made:
    millimetre = units.MILLIMETRE / (units.metres(volume.unit) or units.MILLIMETRE)
    function = TransferFunction(*_native.ct_nodes(offset_of(volume)), opacity_unit=millimetre)
    return function, Shading(specular=0.15, ambient_occlusion=0.3)


def _tissue(_volume: Volume | WaveletVolume, known: Evidence) -> Made:
    """A look that shows skin and organs as surfaces: opaque soon above the background."""
    return TransferFunction(*_native.tissue_nodes(known.values)), SOLID


def _scan(volume: Volume | WaveletVolume, known: Evidence) -> Made:
    """A look that shows boundaries: opacity follows the mean gradient at a value, relative to that of other values."""
    return TransferFunction(*_native.scan_nodes(known.values, known.gradients, volume.is_anatomical)), SOLID


def _light(volume: Volume | WaveletVolume, known: Evidence) -> Made:
    """A look of light, or of solid matter: of doses, shares, calculated maps and p-values, and of masks."""
    nodes = _native.light_nodes(known.kind, known.values, volume.value_range[1], opaque_after(volume))
    assert nodes is not None, "the kinds that have this look"
    return TransferFunction(*nodes), {"probability": SOFT, "mask": SOLID, "labels": SOLID}.get(known.kind)


def _ultrasound(_volume: Volume | WaveletVolume, known: Evidence) -> Made:
    return TransferFunction(*_native.ultrasound_nodes(known.values)), Shading(ambient_occlusion=0.4)


def _fluorescence(volume: Volume | WaveletVolume, _known: Evidence, wanted: Rgb | None = None) -> Made:
    """A look of light in the colour of the channel: nothing is shaded."""
    low, high, _ = channel_window(volume)
    # Windows of files often begin below the background, which in space is fog.
    background = clear_of_values(without_padding(subsampled(volume)))
    color = _native.lightened(wanted or color_of(volume.facts.channel, volume.facts.channels) or GREEN)
    luminance = sum(share * weight for share, weight in zip(color, _native.LUMINANCE, strict=True))
    red, green, blue = (min(1.0, MAX_LUMINANCE / luminance) * share for share in color)
    return ramp((red, green, blue), low, high, opaque_after(volume), clear=background, white=0.5), None


def _em(_volume: Volume | WaveletVolume, known: Evidence) -> Made:
    """A look of a block that is cut where the volume ends: grey, opaque, as the slices are."""
    return _greys(known), None


def _field(volume: Volume | WaveletVolume, known: Evidence) -> Made:
    """A look of a field, in a map of colours, or in blue and red where it has two signs."""
    samples = np.ascontiguousarray(subsampled(volume), np.float64)
    has_two_signs, n_planes = known.kind == "signed field", volume.shape[0]
    nodes = _native.field_nodes(known.values, has_two_signs, known.fill, samples, n_planes, opaque_after(volume))
    return TransferFunction(*nodes), SOFT


LOOKS: dict[Kind, Callable[..., Made]] = {
    "CT": _ct,
    "MR": _tissue,
    "PET": _tissue,
    "dose": _light,
    "ultrasound": _ultrasound,
    "fluorescence": _fluorescence,
    "EM": _em,
    "FA": _light,
    "probability": _light,
    "map": _light,
    "p-values": _light,
    "signed field": _field,
    "field": _field,
    "mask": _light,
    "labels": _light,
    "scan": _scan,
}


def _parted(known: Evidence) -> tuple[float, float, float]:
    """Values that count as smallest and largest, and the threshold between background and object."""
    low, high = robust_range_of(known.values)
    return low, otsu(known.values, low, high), high
