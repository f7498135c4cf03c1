"""The one place where a viewer's state becomes a call of the renderer: on the screen, for files and for code."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

from wavesplat._model.arguments.sampling import Sampling
from wavesplat._picture.picture import Picture
from wavesplat._scene.drawing.progressive import progressive
from wavesplat._viewer.session.previews import preview_of
from wavesplat._viewer.session.state import ViewerState
from wavesplat._viewer.slices.slice_view import slice_of


def render_arguments(state: ViewerState, size: tuple[int, int]) -> dict[str, Any]:
    """Arguments of `Scene.render` for the picture at rest, but for the camera."""
    return {"size": size, **state.options}


def picture_of(
    state: ViewerState,
    view: str,
    size: tuple[int, int],
    *,
    psnr: float | None = None,
    sampling: Sampling | None = None,
    scale: float = 1.0,
    progress: Callable[[float], object] | None = None,
) -> Picture:
    """The picture of a view: at rest, or with a wanted PSNR or a sampling and fewer pixels, while something moves.

    view : "3d" or a plane's name.
    size : width and height of the view, pixels; `scale` is a share of both.

    Raises
    ------
    CancelledError
        If `progress` returned False.
    """
    if view != "3d":
        return slice_of(state, view, size, scale=scale)
    arguments = render_arguments(state, size)
    if scale != 1:
        arguments["size"] = tuple(max(1, round(scale * n)) for n in size)
    if sampling is not None:
        arguments["quality"] = sampling
    elif psnr is not None:
        arguments["psnr"] = psnr
    # While something moves, lazy volumes are shown by coarse copies in memory.
    scene = state.scene if psnr is None and sampling is None else preview_of(state.scene)
    return scene.render(state.camera, progress=progress, **arguments)


def pictures_at_rest(
    state: ViewerState, size: tuple[int, int], progress: Callable[[float], object]
) -> Iterator[Picture]:
    """The picture at rest of lazy volumes, after coarser ones and parts of it."""
    arguments = render_arguments(state, size)
    yield from progressive(state.scene, state.camera, progress=progress, **arguments)
