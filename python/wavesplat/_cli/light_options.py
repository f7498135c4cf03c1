"""Options of light, declared once, and the shading that they make of a look's own."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, Any

import typer

from wavesplat._cli import parsers
from wavesplat._cli.option_groups import given, with_options_of
from wavesplat.errors import ArgumentError

if TYPE_CHECKING:
    from wavesplat._looks.shading import Shading

__all__ = ["LightOptions", "chosen_shading", "exposure_of", "takes_light_options"]


def _light(text: str) -> Any:
    """The name of a light, or its direction."""
    if text in ("key", "headlight"):
        return text
    return parsers.numbers(3, "-1,1,1.5, key or headlight")(text)


@dataclass(frozen=True)
class LightOptions:
    """Options of light; those that are not given leave the look's own settings."""

    shading: Annotated[bool, typer.Option(help="Light the surfaces, or draw colours as they are.")] = True
    light: Annotated[
        Any,
        typer.Option(
            metavar="key|headlight|X,Y,Z",
            parser=_light,
            help="key: from the upper left, with a fill light. headlight: as VTK and Slicer have it. "
            "Or the direction to it: x right, y up, z to the eye.",
        ),
    ] = None
    ambient: Annotated[float | None, typer.Option(metavar="SHARE", help="Light that comes from everywhere.")] = None
    diffuse: Annotated[float | None, typer.Option(metavar="SHARE", help="Light on surfaces that face it.")] = None
    specular: Annotated[float | None, typer.Option(metavar="SHARE", help="Highlights.")] = None
    specular_power: Annotated[
        float | None, typer.Option(metavar="POWER", help="Higher is a smaller, sharper highlight.")
    ] = None
    exposure: Annotated[
        float | None, typer.Option(metavar="FACTOR", help="Factor of all light; 1 changes nothing.")
    ] = None
    occlusion: Annotated[float | None, typer.Option(metavar="0..1", help="How much hollows darken.")] = None
    shadow: Annotated[float | None, typer.Option(metavar="0..1", help="How dark the first light's shadow is.")] = None
    gradient_smoothing: Annotated[
        float | None,
        typer.Option(metavar="VOXELS", help="Smooth normals by 0.5 to 1.25 voxels; 0: differences, as VTK has them."),
    ] = None


def takes_light_options(command: Callable[..., None]) -> Callable[..., None]:
    """Give a command these options on the command line, in the place of its parameter `lighting`."""
    return with_options_of(LightOptions, "lighting", command)


def exposure_of(options: LightOptions, own: Shading | None) -> float:
    """The factor of the light that an unlit look gives off, which `--exposure` is unless other options light it."""
    exposure = options.exposure
    return exposure if own is None and exposure is not None and given(options) == ["--exposure"] else 1.0


def chosen_shading(options: LightOptions, own: Shading | None) -> Shading | None:
    """A look's own shading, changed by the options; None without shading."""
    from wavesplat._looks.shading import Light, Shading

    asked = given(options)
    if not options.shading:
        if len(asked) > 1:
            others = ", ".join(name for name in asked if name != "--shading")
            raise ArgumentError(f"{others} are light; leave out --no-shading")
        return None
    if not asked or (own is None and asked == ["--exposure"]):
        return own
    if options.light == "headlight":
        base = Shading.headlight()
    elif own is None or options.light == "key":
        base = Shading()
    else:
        base = own
    terms = ("ambient", "diffuse", "specular", "specular_power", "exposure", "shadow", "gradient_smoothing")
    changes: dict[str, Any] = {name: getattr(options, name) for name in terms if getattr(options, name) is not None}
    if options.exposure is not None:
        changes["exposure"] = base.exposure * options.exposure
    if options.occlusion is not None:
        changes["ambient_occlusion"] = options.occlusion
    if isinstance(options.light, tuple):
        changes["lights"] = [Light(options.light)]
    return base.changed(**changes)
