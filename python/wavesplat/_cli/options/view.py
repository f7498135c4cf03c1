"""Options of the view, of two eyes and of panoramas, and the camera that they make."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar

from wavesplat._cli.options import parsers
from wavesplat._cli.options.groups import option, zoom
from wavesplat._model.camera.stereo import LAYOUTS, PLAIN, Eyes
from wavesplat._model.camera.views import VIEWS
from wavesplat.errors import ArgumentError

if TYPE_CHECKING:
    from wavesplat._looks.look import Look
    from wavesplat._model.camera.camera import Camera
    from wavesplat._scene.scene import Scene


@dataclass(repr=False)
class ViewOptions:
    """Options of a view, or a camera, and of its turn and magnification."""

    TITLE: ClassVar = "View"

    view: Any = option(help=f"{', '.join(VIEWS)}; the one that suits the data if not given.", choices=tuple(VIEWS))
    camera: Path | None = option(
        "FILE[#NAME]|JSON",
        "The camera of a file, ours (.json) or ParaView's (.pvsm, .py); or the text of our file itself.",
    )
    azimuth: float | None = option("DEG", "Turn the eye from the view to the patient's left.")
    elevation: float | None = option("DEG", "Lift the eye from the view.")
    zoom: float = zoom()
    perspective: float | None = option("DEG", "Perspective with this vertical angle.")


@dataclass(repr=False)
class EyeOptions:
    """Options of two eyes and of panoramas."""

    TITLE: ClassVar = ViewOptions.TITLE

    stereo: Any = option("LAYOUT", f"A picture for two eyes: {', '.join(LAYOUTS)}.", choices=LAYOUTS)
    eye_distance: Any = option(
        "LENGTH",
        "Of --stereo, world units, or with its unit: 65mm; else 2 degrees of the middle.",
        parser=parsers.length,
    )
    convergence: Any = option(
        "LENGTH",
        "Of --stereo: distance of what has no parallax, world units, or with its unit; else the middle's.",
        parser=parsers.length,
    )
    panorama: bool = option(help="All around the eye, 360 by 180 degrees; give --size 2048x1024, say.", default=False)
    eye: Any = option(
        "X,Y,Z",
        "Where --panorama is seen from, world units; the middle of what is shown if not given.",
        parser=parsers.numbers(3, "10,20,30"),
    )


def check_view_options(viewing: ViewOptions) -> None:
    """Refuse options that cannot work, before anything is read."""
    from wavesplat._model.camera.camera import checked_lens

    parsers.refuse_pairs(view=viewing.view, camera=viewing.camera)
    parsers.refuse_pairs(perspective=viewing.perspective, camera=viewing.camera)
    checked_lens(viewing.zoom, viewing.perspective)


def given_camera(viewing: ViewOptions) -> Camera | None:
    """The camera of a file or of its text, turned and magnified; None if none is given."""
    from wavesplat._model.camera.camera import Camera

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
    from wavesplat._scene.drawing.drawing import geometry_in_view
    from wavesplat._scene.drawing.drawn_layers import seen_parts

    own = PLAIN if eyes is None else Eyes(**eye_arguments(eyes, unit_of(scenes[0])))
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


def check_eyes(options: EyeOptions) -> None:
    """Refuse options that cannot work, before anything is read."""
    for name in ("eye_distance", "convergence"):
        if options.stereo is None and getattr(options, name) is not None:
            raise ArgumentError(f"--{name.replace('_', '-')} is of --stereo; give that, or leave it out")
    if options.eye is not None and not options.panorama:
        raise ArgumentError(
            "--eye is of --panorama; give that, or --view, --azimuth and --elevation for other pictures"
        )
    plain: Any = {name: length and length._replace(unit=None) for name, length in _lengths(options)}
    _ = eye_arguments(replace(options, **plain), None)


def eye_arguments(options: EyeOptions, unit: str | None) -> dict[str, Any]:
    """Arguments `stereo` and `panorama` of functions that draw. `unit`: of the world's lengths."""
    from wavesplat._model.camera.stereo import Stereo

    stereo = None
    if options.stereo is not None:
        lengths = [one and one.in_world(unit, f"--{name.replace('_', '-')}") for name, one in _lengths(options)]
        stereo = Stereo(options.stereo, *lengths)
    return {"stereo": stereo, "panorama": options.panorama}


def unit_of(scene: Scene) -> str | None:
    """Unit of the lengths of a scene's world, where a file names one."""
    units = (layer.drawn.facts.unit for layer in scene.layers)
    return next((unit for unit in units if unit is not None), None)


def _lengths(options: EyeOptions) -> list[tuple[str, Any]]:
    return [(name, getattr(options, name)) for name in ("eye_distance", "convergence")]


def at_the_eye(camera: Camera, options: EyeOptions) -> Camera:
    """The camera moved to where `--eye` says, which looks the same way."""
    if options.eye is None:
        return camera
    ahead = [there - here for there, here in zip(camera.focal_point, camera.position, strict=True)]
    focal_point = tuple(place + step for place, step in zip(options.eye, ahead, strict=True))
    return replace(camera, position=options.eye, focal_point=focal_point)
