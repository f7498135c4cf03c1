"""The box that `--crop` or `--crop-index` limits a command to."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import typer

from wavesplat._cli import parsers

if TYPE_CHECKING:
    from wavesplat._model.crop import Crop

__all__ = ["box", "chosen_crop"]


def box(help: str) -> Any:
    """An option that takes two opposite corners."""
    return typer.Option(metavar="X0,Y0,Z0,X1,Y1,Z1", parser=parsers.numbers(6, "0,0,0,50,50,50"), help=help)


def chosen_crop(crop: tuple[float, ...] | None, crop_index: tuple[float, ...] | None) -> Crop | None:
    """The box in world units or in samples, or None."""
    from wavesplat._model.crop import Crop

    if crop is not None:
        return Crop(crop[:3], crop[3:], space="world")
    return None if crop_index is None else Crop(crop_index[:3], crop_index[3:], space="index")
