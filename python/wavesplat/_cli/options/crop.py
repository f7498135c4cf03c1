"""Options of cropping and clipping: boxes to keep, boxes to cut out to look inside, and clip planes."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar

from wavesplat._cli.options import parsers
from wavesplat._cli.options.groups import option

if TYPE_CHECKING:
    from wavesplat._model.arguments.clips import Clip, Crop
    from wavesplat._model.volume.grid import Grid

CORNERS = "X0,Y0,Z0,X1,Y1,Z1"
_box = parsers.numbers(6, "0,0,0,50,50,50")


def _box_or_corner(text: str) -> Any:
    """Six numbers, or the name of a corner, which is understood once there is a volume."""
    return _box(text) if "," in text and any(mark.isdigit() for mark in text) else text


@dataclass(repr=False)
class CropOptions:
    """A box of the volume."""

    TITLE: ClassVar = "Cuts"

    crop: Any = option(CORNERS, "Only this box, world units.", parser=_box)
    crop_index: Any = option(CORNERS, "The same, in samples.", parser=_box)


@dataclass(repr=False)
class CutOptions(CropOptions):
    """The crop box, the cut-out boxes and the clip planes."""

    cut_out: list[Any] | None = option(
        f"{CORNERS}|NAME",
        "Take out this box, world units, or a corner of the volume, such as right-anterior-superior, left or +x-y+z; "
        "may be repeated.",
        parser=_box_or_corner,
    )
    cut_out_index: list[Any] | None = option(CORNERS, "Take out this box, in samples; may be repeated.", parser=_box)
    clip: list[Any] | None = option(
        "X,Y,Z,NX,NY,NZ",
        "Keep the side of a plane that N points to: a point on it and N, world units; may be repeated.",
        parser=parsers.numbers(6, "0,0,50,0,0,1"),
    )


def chosen_crop(cuts: CropOptions) -> Crop | None:
    """The box in world units or in samples, or None."""
    from wavesplat._model.arguments.clips import Crop

    crop, crop_index = cuts.crop, cuts.crop_index
    parsers.refuse_pairs(crop=crop, crop_index=crop_index)
    if crop is not None:
        return Crop(crop[:3], crop[3:], space="world")
    return None if crop_index is None else Crop(crop_index[:3], crop_index[3:], space="index")


def chosen_clip(cuts: CutOptions, volume: Grid) -> list[Clip]:
    """The clips of a volume: crop box, clip planes, cut-out boxes."""
    from wavesplat._model.arguments.clips import ClipPlane, Crop, CutOut

    kept = chosen_crop(cuts)
    boxes = [
        Crop.corner(volume, given) if isinstance(given, str) else Crop(given[:3], given[3:])
        for given in cuts.cut_out or ()
    ]
    boxes += [Crop(given[:3], given[3:], space="index") for given in cuts.cut_out_index or ()]
    planes = [ClipPlane(given[:3], given[3:]) for given in cuts.clip or ()]
    return [*([] if kept is None else [kept]), *planes, *(CutOut(box) for box in boxes)]
