"""Options of figures: scale bar, orientation, colour bar, legend and title."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from wavesplat._cli import parsers
from wavesplat._cli.option_groups import with_options_of
from wavesplat._cli.printing import message
from wavesplat.errors import ArgumentError

if TYPE_CHECKING:
    from wavesplat._picture.picture import Picture
    from wavesplat._scene.scene import Scene


@dataclass(frozen=True)
class FigureOptions:
    """Options of a figure, as `Picture.annotated` takes them."""

    figure: Annotated[
        bool,
        typer.Option(
            "--figure", help="Draw what a figure needs: a scale bar, the axes or letters, a colour bar of a field."
        ),
    ] = False
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
    return with_options_of(FigureOptions, "figure", command, without=["dpi", "figure"])


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
    if options.colorbar_label is not None and not (options.colorbar or options.figure):
        raise ArgumentError("--colorbar-label names what a colour bar shows; give it with --colorbar")


def annotated(picture: Picture, options: FigureOptions, scene: Scene, *, quiet: bool) -> Picture:
    """The picture as a figure, with the marks that the options ask for. `scene`: what is drawn."""
    bars: bool | list[str] = options.colorbar
    if options.figure:
        from wavesplat._render.framing import is_of_patient

        first = scene.layers[0].drawn
        of_patient = is_of_patient(first)
        # Headers name a patient's axes and millimetres for what is none, too: these nobody measured.
        is_measured = of_patient or not first.is_anatomical
        is_marked = options.letters or options.cube or options.axes
        options = replace(
            options,
            scale_bar=options.scale_bar or (is_measured and picture.unit is not None),
            letters=options.letters or (not is_marked and of_patient),
            axes=options.axes or (not is_marked and not of_patient and is_measured),
        )
        bars = bars or _bars_of_fields(picture, scene)
        options = replace(options, colorbar=bool(bars))
    marks = marks_of(options, picture.unit, quiet=quiet)
    return picture.annotated(**marks | {"colorbar": bars}, dpi=options.dpi) if marks else picture


def _bars_of_fields(picture: Picture, scene: Scene) -> bool | list[str]:
    """Names of the fields and of the shapes with values that get a colour bar without being asked for."""
    from wavesplat._geometry.slice_plane import SlicePlane
    from wavesplat._looks.kinds import FIELDS, kind_of

    shown = [one for one in picture.report.get("shown") or () if one["composite"] != "first-hit"]
    # The report names a layer by the field that colours it.
    coloring = [layer if layer.color_from is None else layer.color_from for layer in scene.layers]
    fields = {layer.name or layer.drawn.name for layer in coloring if kind_of(layer.drawn) in FIELDS}
    named = [one["name"] for one in shown if one["name"] in fields and one["transfer_function"] is not None]
    shapes = picture.report.get("geometry_colors") or ()
    named += [one["name"] for one in shapes if one["kind"] != SlicePlane.KIND]
    return len(named) == len(shown) + len(shapes) or named if named else False


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
