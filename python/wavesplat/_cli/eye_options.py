"""Options of pictures for two eyes and all around."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, Any

import typer

from wavesplat._cli import parsers
from wavesplat._cli.option_groups import with_options_of
from wavesplat._model.stereo import LAYOUTS
from wavesplat.errors import ArgumentError

if TYPE_CHECKING:
    from wavesplat._model.camera import Camera
    from wavesplat._model.stereo import Eyes

__all__ = ["EyeOptions", "at_the_eye", "chosen_eyes", "eye_arguments", "takes_eye_options"]


@dataclass(frozen=True)
class EyeOptions:
    """Options of two eyes and of panoramas."""

    stereo: Annotated[
        Any,
        typer.Option(
            metavar="LAYOUT", parser=parsers.one_of(LAYOUTS), help=f"A picture for two eyes: {', '.join(LAYOUTS)}."
        ),
    ] = None
    eye_distance: Annotated[
        float | None, typer.Option(metavar="LENGTH", help="Of --stereo, world units; else 2 degrees of the middle.")
    ] = None
    convergence: Annotated[
        float | None,
        typer.Option(
            metavar="LENGTH", help="Of --stereo: distance of what has no parallax, world units; else the middle's."
        ),
    ] = None
    panorama: Annotated[
        bool,
        typer.Option("--panorama", help="All around the eye, 360 by 180 degrees; give --size 2048x1024, say."),
    ] = False
    eye: Annotated[
        Any,
        typer.Option(
            metavar="X,Y,Z",
            parser=parsers.numbers(3, "10,20,30"),
            help="Where --panorama is seen from, world units; the middle of what is shown if not given.",
        ),
    ] = None


def takes_eye_options(command: Callable[..., None]) -> Callable[..., None]:
    """Give a command these options on the command line, in the place of its parameter `eyes`."""
    return with_options_of(EyeOptions, "eyes", command)


def eye_arguments(options: EyeOptions) -> dict[str, Any]:
    """Arguments `stereo` and `panorama` of functions that draw; an `ArgumentError` for options that cannot work."""
    from wavesplat._model.stereo import Stereo

    for name in ("eye_distance", "convergence"):
        if options.stereo is None and getattr(options, name) is not None:
            raise ArgumentError(f"--{name.replace('_', '-')} is of --stereo; give that, or leave it out")
    if options.eye is not None and not options.panorama:
        raise ArgumentError(
            "--eye is of --panorama; give that, or --view, --azimuth and --elevation for other pictures"
        )
    stereo = None
    if options.stereo is not None:
        stereo = Stereo(options.stereo, options.eye_distance, options.convergence)
    return {"stereo": stereo, "panorama": options.panorama}


def chosen_eyes(options: EyeOptions) -> Eyes:
    """The eyes that the options ask for."""
    from wavesplat._model.stereo import Eyes

    return Eyes(**eye_arguments(options))


def at_the_eye(camera: Camera, options: EyeOptions) -> Camera:
    """The camera moved to where `--eye` says, which looks the same way."""
    from dataclasses import replace

    if options.eye is None:
        return camera
    ahead = [there - here for there, here in zip(camera.focal_point, camera.position, strict=True)]
    focal_point = tuple(place + step for place, step in zip(options.eye, ahead, strict=True))
    return replace(camera, position=options.eye, focal_point=focal_point)
