"""Options of movies: those of their frames, and the marks that are drawn on every frame."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from os import PathLike
from typing import Any, TypedDict

from wavesplat._picture.annotating import Corner, Figure, Orientation, Side
from wavesplat._render.options import DrawOptions, FrameOptions


class FigureOptions(TypedDict, total=False):
    """Marks of a figure; `Picture.annotated` documents them."""

    scale_bar: bool | float | str
    orientation: Orientation | None
    colorbar: bool | str | Sequence[str]
    legend: bool | Iterable[str]
    title: str | None
    unit: str | None
    values: str | None
    font_size: float | None
    color: str | Sequence[float] | None
    font: str | PathLike[str] | None
    scale_bar_at: Corner
    orientation_at: Corner
    colorbar_at: Side
    legend_at: Side


class MovieOptions(FrameOptions, FigureOptions, total=False):
    """Options of `movie`: those of pictures, and the marks of figures."""


@dataclass(frozen=True, kw_only=True)
class MovieValues(DrawOptions, Figure):
    """The defaults of `MovieOptions`."""


def parted(options: MovieOptions) -> tuple[dict[str, Any], dict[str, Any]]:
    """Options of drawing, and arguments of `Picture.annotated`."""
    drawing: dict[str, Any] = dict(options)
    return drawing, {name: drawing.pop(name) for name in FigureOptions.__annotations__ if name in drawing}
