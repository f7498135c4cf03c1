"""Pictures over a background, and what a picture shows beside the shapes in it."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from wavesplat._looks import colors

__all__ = ["beside_shapes", "over_background"]


def over_background(rgba: NDArray[np.float32], background: colors.Rgba | None) -> NDArray[np.float32]:
    """A picture over a background; None is transparent."""
    if background is None:
        return rgba
    red, green, blue, alpha = background
    below = np.array([red * alpha, green * alpha, blue * alpha, alpha], np.float32)
    # Added light can exceed the opacity.
    return np.minimum(rgba + (1 - rgba[..., 3:]) * below, 1).astype(np.float32)


def beside_shapes(rgba: NDArray[np.float32], alone: NDArray[np.float32] | None) -> NDArray[np.float32]:
    """What a picture shows beside its shapes: the light that comes through them, and the opacity of the rest alone.

    alone : the shapes' own picture, which the projection is composited behind; None without any.
    """
    if alone is None:
        return rgba
    rest = rgba - alone
    open_share = 1 - alone[..., 3]
    rest[..., 3] = np.divide(rest[..., 3], open_share, out=np.zeros_like(open_share), where=open_share > 0)
    return rest
