"""The visible parts of a scene, its cameras and its looks, decided once for all frames."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from wavesplat._looks.look import Look
from wavesplat._looks.over_time import brightest_number
from wavesplat._model.arguments.operators import Operator, checked_operator, name_of
from wavesplat._model.arguments.sampling import BY_VIEW, Composite, Sampling
from wavesplat._model.camera.stereo import PLAIN, Eyes
from wavesplat._model.camera.views import view_angles
from wavesplat._model.volume.series import Series
from wavesplat._render import framing, projection
from wavesplat._render.arguments import chosen_camera
from wavesplat._scene.drawing.drawing import geometry_in_view
from wavesplat._scene.drawing.drawn_layers import DrawnLayer, DrawnLayers, drawn_layers
from wavesplat.errors import ArgumentError

if TYPE_CHECKING:
    from wavesplat._looks.curves.transfer_function import TransferFunction
    from wavesplat._model.arguments.clips import Clipping
    from wavesplat._model.camera.camera import Camera
    from wavesplat._model.volume.grid import Grid
    from wavesplat._picture.picture import Picture
    from wavesplat._scene.scene import Scene

#: Sampling of overview pictures.
COARSE = Sampling(sheets_per_slice=1, quality="draft")


def camera_of(
    scene: Scene,
    given: Camera | str | None,
    composite: Operator | None,
    aspect: float,
    times: Sequence[int] | None = None,
    *,
    eyes: Eyes = PLAIN,
) -> Camera:
    """The camera itself, or the one that a view's name or None stands for, which frames all of these times."""
    return chosen_camera(given, *_parts(scene, composite, times), aspect, eyes=eyes, also=geometry_in_view(scene))


def direction_of(scene: Scene, name: str | None, composite: Operator | None) -> tuple[float, float]:
    """Azimuth and elevation, degrees, of a named view, or of the one that a picture of the scene has."""
    first = _shown(scene, composite).layers[0]
    view = first.look.view if name is None else name
    if view is None:
        return framing.natural_view(first.volume)
    return view_angles(view, is_anatomical=first.volume.is_anatomical)


def what_is_seen(
    scene: Scene, composite: Operator | None, times: Sequence[int] | None = None
) -> tuple[Grid, NDArray[np.float64] | None]:
    """A grid around all layers, at all of these times, and the positions of their visible samples.

    The positions are None where all samples may be visible.
    """
    return framing.shown_points(*_parts(scene, composite, times), geometry_in_view(scene))


def with_settled_looks(
    scene: Scene, composite: Operator | None, camera: Camera, size: tuple[int, int]
) -> tuple[Scene, Composite]:
    """The scene with all looks that are chosen by the data, or by name, written out, so that frames do not flicker.

    Greys that depend on the view are the greys that this camera sees. Also gives the name of the operator.
    """
    shown = _shown(scene, composite)
    looks = {id(layer.layer): layer.look for layer in shown.layers}
    first = shown.layers[0]
    if len(shown.layers) == 1 and first.is_automatic and shown.composite in BY_VIEW:
        looks[id(first.layer)] = _exposed(scene, first, composite or shown.composite, camera, size)
    settled = [replace(layer, look=looks.get(id(layer), layer.look)) for layer in scene.layers]
    return scene.with_(layers=settled), shown.composite


def _exposed(scene: Scene, layer: DrawnLayer, operator: Operator, camera: Camera, size: tuple[int, int]) -> Look:
    name = name_of(checked_operator(operator) or "over")

    def overview(curves: TransferFunction, at: Camera, of: tuple[int, int]) -> Picture:
        look = Look(transfer_function=curves, composite=name)
        bare = scene.with_(layers=[replace(whole, look=look)], background="transparent")
        return bare.render(at, size=of, quality=COARSE, composite=operator)

    volume, whole = layer.volume, layer.layer
    if isinstance(whole.volume, Series):  # as for other looks, so that no time is clipped
        whole = replace(whole, time=brightest_number(whole.volume))
        volume = whole.drawn
    function = projection.exposed_by(overview, volume, name, camera, size)
    return layer.look if function is None else replace(layer.look, transfer_function=function)


def _shown(scene: Scene, composite: Operator | None) -> DrawnLayers:
    asked = checked_operator(composite)
    shown = drawn_layers(scene, None if asked is None else name_of(asked))
    if not shown.layers:
        raise ArgumentError("no layer of the scene is visible; a movie needs one")
    return shown


def _parts(
    scene: Scene, composite: Operator | None, times: Sequence[int] | None
) -> tuple[list[framing.Part], Clipping]:
    """The visible volumes with their looks at the first, the middle and the last time, and what is clipped."""
    scenes = [scene]
    if times:
        wanted = dict.fromkeys((times[0], times[len(times) // 2], times[-1]))
        scenes = [scene.at_time(time) for time in wanted]
    shown = [_shown(one, composite) for one in scenes]
    parts: list[framing.Part] = [(layer.seen, layer.look) for one in shown for layer in one.layers]
    return parts, _clipping(scenes[0], shown[0])


def _clipping(scene: Scene, shown: DrawnLayers) -> Clipping:
    is_alone = shown.has_first and len(shown.layers) == 1
    return scene._clipping if is_alone else scene._clipping.in_world(shown.first)
