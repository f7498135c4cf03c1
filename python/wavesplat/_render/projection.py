"""Arguments of projections that the caller did not give: numbers, and greys for what a view shows.

Maxima are much the same wherever a volume is seen from. Minima, means, sums and x-rays depend on the ray's way through
the volume, so that their greys are chosen as a radiograph is exposed: by a small picture of the same view.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeAlias, TypedDict

import numpy as np

from wavesplat._looks.curves import colormaps, colors
from wavesplat._looks.curves.transfer_function import TransferFunction
from wavesplat._looks.curves.transfer_function_2d import TransferFunction2D
from wavesplat._looks.kinds import histogram
from wavesplat._model.arguments.operators import (
    AXES,
    AttenuatedMaximum,
    DepthColoredMaximum,
    DepthShadedMaximum,
    LocalMaximum,
    Operator,
    XRay,
    name_of,
)
from wavesplat._model.camera.camera import Camera
from wavesplat._model.volume.volume import Volume
from wavesplat._model.volume.wavelet_volume import WaveletVolume
from wavesplat._picture.picture import Picture

#: Transfer function of a picture of which only the values are used, and its longer side, pixels.
ANY_CURVES = TransferFunction([(0.0, 1.0)], [(0.0, 1.0, 1.0, 1.0)])
OVERVIEW_PX = 128

#: A colour, or a vector.
Three: TypeAlias = tuple[float, float, float]

#: Number of colours that the compiled module gets for depths.
N_DEPTH_COLORS = 256
#: Threshold of local maxima, as a share of the way from the first to the last colour.
LOCAL_THRESHOLD = 0.25


class Numbers(TypedDict, total=False):
    """Arguments of the compiled renderer that belong to one operator each."""

    local_threshold: float
    depth_shading: tuple[float, float]
    attenuated: tuple[float, float, float]
    attenuation: tuple[float, float]


def overview_size(width: int, height: int) -> tuple[int, int]:
    """Size of the small picture, pixels."""
    scale = min(1.0, OVERVIEW_PX / max(width, height, 1))
    return max(1, round(width * scale)), max(1, round(height * scale))


def exposed_by(
    overview: Callable[[TransferFunction, Camera, tuple[int, int]], Picture],
    volume: Volume | WaveletVolume,
    composite: str,
    camera: Camera,
    size: tuple[int, int],
) -> TransferFunction | None:
    """Greys for what a small picture of the same view shows, which `overview` draws; None where it shows nothing."""
    shown = overview(ANY_CURVES, camera, overview_size(*size)).value
    if shown is None:
        return None
    values = shown[np.isfinite(shown)]
    return histogram.exposed(volume, composite, values) if values.size else None


def on(
    background: colors.Rgba | None, composite: str, function: TransferFunction | TransferFunction2D
) -> TransferFunction | TransferFunction2D:
    """The greys of a projection, inverted on a background that is nearer to white: black is what was white.

    Nothing is transparent then, so that the least is as white as what is behind.
    """
    is_light = background is not None and sum(background[:3]) * background[3] > 1.5
    # In depth colours what is dark is clear, on any background.
    is_grey = composite in histogram.PROJECTIONS and composite != DepthColoredMaximum.name
    if not is_grey or not is_light or isinstance(function, TransferFunction2D):
        return function
    color = [(value, 1.0 - red, 1.0 - green, 1.0 - blue) for value, red, green, blue in function.color]
    return TransferFunction([(color[0][0], 1.0)], color)


def absorption(operator: XRay, volume: Volume | WaveletVolume) -> tuple[float, float]:
    """Numbers of an x-ray, (clear, attenuation): given, or fitted to the volume."""
    if operator.clear is not None and operator.attenuation is not None:
        return operator.clear, operator.attenuation
    clear, attenuation = histogram.attenuation(volume)
    return (
        clear if operator.clear is None else operator.clear,
        attenuation if operator.attenuation is None else operator.attenuation,
    )


def numbers(
    operator: Operator,
    curves: TransferFunction | TransferFunction2D,
    volume: Volume | WaveletVolume,
    absorbs: tuple[float, float] | None,
) -> Numbers:
    """The numbers of one operator; where nothing is given they follow the colours, so that they fit what is shown."""
    if isinstance(curves, TransferFunction2D):
        first, last = curves.values[0], curves.values[-1]
    else:
        first, last = curves.color[0][0], curves.color[-1][0]
    if isinstance(operator, LocalMaximum):
        between = first + LOCAL_THRESHOLD * (last - first)
        return {"local_threshold": between if operator.threshold is None else operator.threshold}
    if isinstance(operator, DepthShadedMaximum):
        return {"depth_shading": (operator.strength, first)}
    if isinstance(operator, AttenuatedMaximum):
        voxel = float(np.prod(volume.spacing)) ** (1 / 3)
        # White must lie above black, also where all colours have one value.
        white = last if last > first else first + max(abs(first), 1.0) * 1e-6
        return {"attenuated": (first, white, operator.attenuation / voxel)}
    return {} if absorbs is None else {"attenuation": absorbs}


def in_order(named: Numbers) -> list[float]:
    """The numbers of an operator as the compiled module takes them, without their names."""
    if "local_threshold" in named:
        return [named["local_threshold"]]
    return [*named.get("depth_shading", ()), *named.get("attenuated", ()), *named.get("attenuation", ())]


def depth_colors(
    operator: Operator,
) -> tuple[list[tuple[float, float, float]], tuple[float, float, float] | None] | None:
    """Colours of depths and the world axis that they are along, as the compiled module takes them; None without."""
    if not isinstance(operator, DepthColoredMaximum):
        return None
    places, rgb = colormaps.colors_of(operator.cmap)
    even = np.linspace(0, 1, N_DEPTH_COLORS)
    red, green, blue = (np.interp(even, places, channel).tolist() for channel in rgb.T)
    x, y, z = (float(name == operator.axis) for name in AXES)
    return list(zip(red, green, blue, strict=True)), None if operator.axis is None else (x, y, z)


def compiled_name(operator: Operator) -> str:
    """The operator's name in the compiled module, where colours of depths are an option of a maximum."""
    return "maximum" if isinstance(operator, DepthColoredMaximum) else name_of(operator)
