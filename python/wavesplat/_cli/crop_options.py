"""Options of cropping and clipping: boxes to keep, boxes to cut out to look inside, and clip planes."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, Any

import typer

from wavesplat._cli import parsers
from wavesplat._cli.option_groups import with_options_of

if TYPE_CHECKING:
    from wavesplat._model.clips import Clip
    from wavesplat._model.crop import Crop
    from wavesplat._model.grid import Grid

__all__ = ["CutOptions", "box", "chosen_clip", "chosen_crop", "takes_cut_options"]

CORNERS = "X0,Y0,Z0,X1,Y1,Z1"
_box = parsers.numbers(6, "0,0,0,50,50,50")


def box(help: str) -> Any:
    """An option that takes two opposite corners of a box."""
    return typer.Option(metavar=CORNERS, parser=_box, help=help)


def _box_or_corner(text: str) -> Any:
    """Six numbers, or the name of a corner, which is understood once there is a volume."""
    return _box(text) if "," in text and any(mark.isdigit() for mark in text) else text


@dataclass(frozen=True)
class CutOptions:
    """The crop box, the cut-out boxes and the clip planes."""

    crop: Annotated[Any, box("Draw only this box, world units.")] = None
    crop_index: Annotated[Any, box("The same, in samples.")] = None
    cut_out: Annotated[
        list[Any] | None,
        typer.Option(
            metavar=f"{CORNERS}|NAME",
            parser=_box_or_corner,
            help="Take out this box, world units, or a corner of the volume, such as right-anterior-superior, left or "
            "+x-y+z; may be repeated.",
        ),
    ] = None
    cut_out_index: Annotated[
        list[Any] | None,
        typer.Option(metavar=CORNERS, parser=_box, help="Take out this box, in samples; may be repeated."),
    ] = None
    clip: Annotated[
        list[Any] | None,
        typer.Option(
            metavar="X,Y,Z,NX,NY,NZ",
            parser=parsers.numbers(6, "0,0,50,0,0,1"),
            help="Keep the side of a plane that N points to: a point on it and N, world units; may be repeated.",
        ),
    ] = None


def takes_cut_options(command: Callable[..., None]) -> Callable[..., None]:
    """Give a command these options on the command line, in the place of its parameter `cuts`."""
    return with_options_of(CutOptions, "cuts", command)


def chosen_crop(crop: tuple[float, ...] | None, crop_index: tuple[float, ...] | None) -> Crop | None:
    """The box in world units or in samples, or None."""
    from wavesplat._model.crop import Crop

    parsers.refuse_pairs(crop=crop, crop_index=crop_index)
    if crop is not None:
        return Crop(crop[:3], crop[3:], space="world")
    return None if crop_index is None else Crop(crop_index[:3], crop_index[3:], space="index")


def chosen_clip(cuts: CutOptions, volume: Grid) -> list[Clip]:
    """The clips of a volume: crop box, clip planes, cut-out boxes."""
    from wavesplat._model.clips import ClipPlane, CutOut
    from wavesplat._model.crop import Crop

    kept = chosen_crop(cuts.crop, cuts.crop_index)
    boxes = [
        Crop.corner(volume, given) if isinstance(given, str) else Crop(given[:3], given[3:])
        for given in cuts.cut_out or ()
    ]
    boxes += [Crop(given[:3], given[3:], space="index") for given in cuts.cut_out_index or ()]
    planes = [ClipPlane(given[:3], given[3:]) for given in cuts.clip or ()]
    return [*([] if kept is None else [kept]), *planes, *(CutOut(box) for box in boxes)]
