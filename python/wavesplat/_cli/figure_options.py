"""Options of figures: scale bar, orientation, colour bar, legend and title."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from wavesplat._cli import parsers
from wavesplat._cli.option_groups import with_options_of
from wavesplat._cli.printing import message
from wavesplat.errors import ArgumentError

if TYPE_CHECKING:
    from wavesplat._picture.picture import Picture

__all__ = [
    "FigureOptions",
    "annotated",
    "check_figure",
    "marks_of",
    "takes_figure_options",
    "takes_frame_figure_options",
]


@dataclass(frozen=True)
class FigureOptions:
    """Options of a figure, as `Picture.annotated` takes them."""

    scale_bar: Annotated[
        bool, typer.Option("--scale-bar", help="Draw a bar of a round length, in the file's unit or --unit.")
    ] = False
    bar_length: Annotated[
        str | None, typer.Option(metavar="LENGTH", help="A bar of this length, such as '50 um', or 50 world units.")
    ] = None
    letters: Annotated[
        bool, typer.Option("--letters", help="Write R, L, A, P, S, I at the edges, where the file has anatomy.")
    ] = False
    cube: Annotated[bool, typer.Option("--cube", help="Draw a cube with these letters, or with x, y, z.")] = False
    axes: Annotated[bool, typer.Option("--axes", help="Draw the axes as arrows.")] = False
    colorbar: Annotated[
        bool, typer.Option("--colorbar", help="Draw the colours of the values beside the picture, which gets wider.")
    ] = False
    colorbar_label: Annotated[str | None, typer.Option(metavar="TEXT", help="What the values are called there.")] = None
    legend: Annotated[bool, typer.Option("--legend", help="Name labels and channels beside the picture.")] = False
    title: Annotated[
        str | None, typer.Option(metavar="TEXT", help="Write this above the picture; {time} is the time, such as 30 s.")
    ] = None
    dpi: Annotated[float | None, typer.Option(metavar="N", help="Pixels per inch when printed, for the file.")] = None
    font_size: Annotated[
        float | None, typer.Option(metavar="SIZE", help="Points with --dpi, else pixels; else it follows the size.")
    ] = None
    font: Annotated[Path | None, typer.Option(metavar="FILE.ttf", help="For signs that the usual font lacks.")] = None
    ink: Annotated[
        Any, typer.Option(metavar="COLOR", parser=parsers.color, help="Text colour; black or white by default.")
    ] = None

    @property
    def orientation(self) -> Any:
        """The one marker of orientation that is asked for: "letters", "cube", "axes", or None."""
        asked = [name for name in ("letters", "cube", "axes") if getattr(self, name)]
        if len(asked) > 1:
            raise ArgumentError(f"--{asked[0]} and --{asked[1]} both show how the picture lies; give one of them")
        return asked[0] if asked else None


def takes_figure_options(command: Callable[..., None]) -> Callable[..., None]:
    """Give a command these options on the command line, in the place of its parameter `figure`."""
    return with_options_of(FigureOptions, "figure", command)


def takes_frame_figure_options(command: Callable[..., None]) -> Callable[..., None]:
    """Give a command the options of figures that are not printed, in the place of its parameter `figure`."""
    return with_options_of(FigureOptions, "figure", command, without=["dpi"])


def check_figure(options: FigureOptions) -> None:
    """Refuse options that cannot work, before a picture is drawn."""
    from wavesplat._picture import lettering
    from wavesplat._picture.picture import check_dpi

    check_dpi(options.dpi)
    _ = options.orientation
    if options.font is not None:
        lettering.opened(str(options.font), 12)
    if options.title:
        lettering.check_letters(options.title, None if options.font is None else str(options.font), "--title")
    if options.colorbar_label is not None and not options.colorbar:
        raise ArgumentError("--colorbar-label names what a colour bar shows; give it with --colorbar")


def annotated(picture: Picture, options: FigureOptions, *, quiet: bool) -> Picture:
    """The picture as a figure, with the marks that the options ask for."""
    marks = marks_of(options, picture.unit, quiet=quiet)
    return picture.annotated(**marks, dpi=options.dpi) if marks else picture


def marks_of(options: FigureOptions, unit: str | None, *, quiet: bool) -> dict[str, Any]:
    """Arguments of `Picture.annotated` but `dpi`; none where no mark is asked for. `unit`: of the world's lengths."""
    bar: Any = options.scale_bar if options.bar_length is None else options.bar_length
    if bar is not False and unit is None and not quiet and not any(map(str.isalpha, options.bar_length or "")):
        message("note: the scale bar has no unit: the file names none; give it with --unit, such as --unit um")
    if not (bar or options.orientation or options.colorbar or options.legend or options.title):
        return {}
    return {
        "scale_bar": bar,
        "orientation": options.orientation,
        "colorbar": options.colorbar,
        "values": options.colorbar_label,
        "legend": options.legend,
        "title": options.title,
        "font_size": options.font_size,
        "font": options.font,
        "color": options.ink,
    }
