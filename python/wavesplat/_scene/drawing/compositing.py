"""Pictures over a background, and projections of several layers with shapes over them."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from wavesplat import _native
from wavesplat._looks.curves import colors
from wavesplat._looks.curves.transfer_function import TransferFunction

#: Smallest opacity of a projection from which its light can be recovered.
MIN_LEFT = 1e-3


def over_background(rgba: NDArray[np.float32], background: colors.Rgba | None) -> NDArray[np.float32]:
    """A picture over a background; None is transparent."""
    if background is None:
        return rgba
    red, green, blue, alpha = background
    below = np.array([red * alpha, green * alpha, blue * alpha, alpha], np.float32)
    # Added light can exceed the opacity.
    return np.minimum(rgba + (1 - rgba[..., 3:]) * below, 1).astype(np.float32)


class AddedLight:
    """Projections of several layers, their colours added as light, with shapes over them.

    size : width and height. alone : the shapes' own picture; None without any. Projections then come with black shapes
    (`ShapeArrays.in_black`) over them, and with their opacities, which say how much shows through.
    """

    def __init__(self, size: tuple[int, int], alone: NDArray[np.float32] | None) -> None:
        self.alone = alone
        self.light = np.zeros((size[1], size[0], 3))
        self.covers: list[NDArray[np.float64]] = []

    def add(self, rgba: NDArray[np.float32], values: NDArray[np.float32] | None, curves: Any) -> None:
        """Add the projection of a layer. `values`, `curves`: what it shows, and its transfer function."""
        light, alpha = rgba[..., :3].astype(np.float64), rgba[..., 3].astype(np.float64)
        if self.alone is not None:
            # Below shapes the picture does not show the projection's opacity; its values do, but for edges of pixels.
            alpha = np.where(self.alone[..., 3] > 0, _opacity_of(values, curves, alpha.shape), alpha)
            left = 1 - _share_of_shapes(alpha) * self.alone[..., 3]
            light = np.divide(light, left[..., None], out=np.zeros_like(light), where=left[..., None] > MIN_LEFT)
        # In double precision the sum of a few float32 colours does not depend on their order.
        self.light += light
        self.covers.append(1 - alpha)

    def rgba(self) -> NDArray[np.float32]:
        """Colours and opacity of all."""
        # Rounded products depend on their order; sorted factors give the same bytes for any order of layers.
        left = (np.sort(self.covers, axis=0) if len(self.covers) > 2 else np.array(self.covers)).prod(axis=0)
        whole = np.dstack([self.light, 1 - left])
        if self.alone is not None:
            share = _share_of_shapes(1 - left)[..., None]
            whole = share * self.alone + (1 - share * self.alone[..., 3:]) * whole
        return whole.clip(0, 1).astype(np.float32)


def _share_of_shapes(alpha: NDArray[np.float64]) -> NDArray[np.float64]:
    """Share of shapes that is seen over a projection of an opacity."""
    return 1 - _native.SHOWS_THROUGH * alpha


def _opacity_of(values: NDArray[np.float32] | None, curves: Any, shape: tuple[int, ...]) -> NDArray[np.float64]:
    """Opacity of projected values; 0 where there are none."""
    if values is None or not isinstance(curves, TransferFunction):
        return np.zeros(shape)
    alpha = curves(np.nan_to_num(values.ravel()))[:, 3].reshape(shape)
    return np.where(np.isfinite(values), alpha, 0.0)
