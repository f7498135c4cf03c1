"""Options of the view, and the camera that they make."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from wavesplat._cli import parsers
from wavesplat._cli.eye_options import EyeOptions, at_the_eye, chosen_eyes
from wavesplat._cli.option_groups import with_options_of
from wavesplat._cli.shared_options import Zoom
from wavesplat._model.stereo import PLAIN
from wavesplat._model.views import VIEWS

if TYPE_CHECKING:
    from wavesplat._looks.look import Look
    from wavesplat._model.camera import Camera
    from wavesplat._scene.scene import Scene

__all__ = ["ViewOptions", "camera_for", "check_view_options", "given_camera", "takes_view_options"]


@dataclass(frozen=True)
class ViewOptions:
    """Options of a view, or a camera, and of its turn and magnification."""

    view: Annotated[
        Any,
        typer.Option(
            metavar="NAME",
            parser=parsers.one_of(tuple(VIEWS)),
            help=f"{', '.join(VIEWS)}; the one that suits the data if not given.",
        ),
    ] = None
    camera: Annotated[
        Path | None,
        typer.Option(
            metavar="FILE[#NAME]|JSON",
            help="The camera of a file, ours (.json) or ParaView's (.pvsm, .py); or the text of our file itself.",
        ),
    ] = None
    azimuth: Annotated[
        float | None, typer.Option(metavar="DEG", help="Turn the eye from the view to the patient's left.")
    ] = None
    elevation: Annotated[float | None, typer.Option(metavar="DEG", help="Lift the eye from the view.")] = None
    zoom: Zoom = 1.0
    perspective: Annotated[float | None, typer.Option(metavar="DEG", help="Perspective with this vertical angle.")] = (
        None
    )


def takes_view_options(command: Callable[..., None]) -> Callable[..., None]:
    """Give a command these options on the command line, in the place of its parameter `viewing`."""
    return with_options_of(ViewOptions, "viewing", command)


def check_view_options(viewing: ViewOptions) -> None:
    """Refuse options that cannot work, before anything is read."""
    from wavesplat._model.camera import checked_lens

    parsers.refuse_pairs(view=viewing.view, camera=viewing.camera)
    parsers.refuse_pairs(perspective=viewing.perspective, camera=viewing.camera)
    checked_lens(viewing.zoom, viewing.perspective)


def given_camera(viewing: ViewOptions) -> Camera | None:
    """The camera of a file or of its text, turned and magnified; None if none is given."""
    from wavesplat._model.camera import Camera

    if viewing.camera is None:
        return None
    if str(viewing.camera).lstrip().startswith("{"):
        found = Camera.from_json(str(viewing.camera))
    else:
        path, name = parsers.file_and_name(viewing.camera)
        found = Camera.load(path, name)
    if viewing.azimuth is None and viewing.elevation is None:
        turned = found
    else:
        turned = found.turned(viewing.azimuth or 0.0, viewing.elevation or 0.0)
    return turned if viewing.zoom == 1 else turned.zoomed(viewing.zoom)


def camera_for(
    scenes: Sequence[Scene],
    look: Look,
    viewing: ViewOptions,
    size: tuple[int, int],
    eyes: EyeOptions | None = None,
) -> Camera:
    """The camera of the view that is named, or of a side chosen from the data, turned by the angles.

    Several scenes are time points; the camera frames the first, the middle and the last. `look`: of the first layer.
    """
    from wavesplat._render.arguments import chosen_camera
    from wavesplat._scene.drawing import geometry_in_view
    from wavesplat._scene.drawn_layers import seen_parts

    own = PLAIN if eyes is None else chosen_eyes(eyes)
    wanted = dict.fromkeys((0, len(scenes) // 2, len(scenes) - 1))
    parts = [part for number in wanted for part in seen_parts(scenes[number], look)]
    is_turned = viewing.azimuth is not None or viewing.elevation is not None
    camera = chosen_camera(
        given_camera(viewing) or viewing.view,
        parts,
        scenes[0]._clipping,
        own.aspect_of(size) if min(size) > 0 else 1.0,  # the renderer refuses an empty picture
        turned=(viewing.azimuth or 0.0, viewing.elevation or 0.0) if is_turned else None,
        zoom=viewing.zoom,
        view_angle=viewing.perspective,
        eyes=own,
        also=geometry_in_view(scenes[0]),
    )
    return camera if eyes is None else at_the_eye(camera, eyes)
