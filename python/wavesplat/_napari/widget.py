"""The widget of the plugin: napari makes its form of the function's arguments."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Literal

import numpy as np

if TYPE_CHECKING:
    import napari


def draw_view(
    viewer: napari.viewer.Viewer,
    quality: Literal["draft", "normal", "high"] = "normal",
    operator: Literal["as shown", "over", "maximum", "mean"] = "as shown",
    enlarged: int = 1,
    show_in: Literal["new window", "new layer"] = "new window",
) -> None:
    """Draw the visible layers as they are seen, and show the picture.

    Parameters
    ----------
    viewer : napari.viewer.Viewer
        What is drawn.
    quality : str
        As for `wavesplat.render`.
    operator : str
        "as shown" is the rendering of the first image.
    enlarged : int
        Pixels of the picture for each pixel of the canvas, along each side.
    show_in : str
        A new window of napari, or a new layer.
    """
    from wavesplat._napari.cameras import canvas_size
    from wavesplat._napari.drawing import draw

    width, height = canvas_size(viewer)
    picture = draw(
        viewer,
        size=(enlarged * width, enlarged * height),
        quality=quality,
        composite=None if operator == "as shown" else operator,
    )
    # An object of the same type: with a window, or without one.
    shown_in: Any = type(viewer)(title="Wavesplat") if show_in == "new window" else viewer
    shown_in.add_image(
        np.asarray(picture)[..., :3], rgb=True, name="Wavesplat", metadata={"report": dict(picture.report)}
    )
