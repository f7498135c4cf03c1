"""Pictures over a background, and projections with shapes behind them."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from wavesplat._looks import colors
from wavesplat._looks.transfer_function import TransferFunction

__all__ = ["AddedLight", "over_background"]

#: Least transparency of shapes at which the opacity of what is before them can be told from a picture of both.
LEAST_OPEN = 0.02


def over_background(rgba: NDArray[np.float32], background: colors.Rgba | None) -> NDArray[np.float32]:
    """A picture over a background; None is transparent."""
    if background is None:
        return rgba
    red, green, blue, alpha = background
    below = np.array([red * alpha, green * alpha, blue * alpha, alpha], np.float32)
    # Added light can exceed the opacity.
    return np.minimum(rgba + (1 - rgba[..., 3:]) * below, 1).astype(np.float32)


class AddedLight:
    """Projections of several layers, their colours added as light, with shapes behind them.

    size : width and height. alone : the shapes' own picture; None without any. Projections then come with the light of
    the shapes left out (`ShapeArrays.in_black`), and with their opacities, which say how much of shapes is seen.
    """

    def __init__(self, size: tuple[int, int], alone: NDArray[np.float32] | None) -> None:
        self.alone = alone
        self.light = np.zeros((size[1], size[0], 3))
        self.covers: list[NDArray[np.float64]] = []

    def add(self, rgba: NDArray[np.float32], values: NDArray[np.float32] | None, curves: Any) -> None:
        """Add the projection of a layer. `values`, `curves`: what it shows, and its transfer function."""
        # In double precision the sum of a few float32 colours does not depend on their order.
        self.light += rgba[..., :3]
        alpha = rgba[..., 3].astype(np.float64)
        if self.alone is not None:
            left = 1 - self.alone[..., 3].astype(np.float64)
            # Behind opaque shapes the picture of both does not tell; the projected values do, but for edges of pixels.
            known = _opacity_of(values, curves, alpha.shape)
            alpha = np.divide(alpha - self.alone[..., 3], left, out=known, where=left > LEAST_OPEN).clip(0, 1)
        self.covers.append(1 - alpha)

    def rgba(self) -> NDArray[np.float32]:
        """Colours and opacity of all."""
        # Products depend on their order, so they are taken in that of size.
        left = (np.sort(self.covers, axis=0) if len(self.covers) > 2 else np.array(self.covers)).prod(axis=0)
        light, alpha = self.light, 1 - left
        if self.alone is not None:
            light, alpha = light + left[..., None] * self.alone[..., :3], alpha + left * self.alone[..., 3]
        return np.dstack([light.clip(0, 1), alpha]).astype(np.float32)


def _opacity_of(values: NDArray[np.float32] | None, curves: Any, shape: tuple[int, ...]) -> NDArray[np.float64]:
    """Opacity of projected values; 0 where there are none."""
    if values is None or not isinstance(curves, TransferFunction):
        return np.zeros(shape)
    alpha = curves(np.nan_to_num(values.ravel()))[:, 3].reshape(shape)
    return np.where(np.isfinite(values), alpha, 0.0)
