"""Options of figures: scale bar, orientation, colour bar, legend and title."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar

from wavesplat._cli.options import parsers
from wavesplat._cli.options.groups import option, part
from wavesplat._cli.printing import message
from wavesplat.errors import ArgumentError

if TYPE_CHECKING:
    from wavesplat._picture.picture import Picture
    from wavesplat._scene.scene import Scene


@dataclass(repr=False)
class MarkOptions:
    """Marks on a picture, as `Picture.annotated` takes them."""

    TITLE: ClassVar = "Figure"

    scale_bar: bool = option(help="Draw a bar of a round length, in the file's unit or --unit.", default=False)
    bar_length: str | None = option("LENGTH", "A bar of this length, such as '50 um', or 50 world units.")
    letters: bool = option(help="Write R, L, A, P, S, I at the edges, where the file has anatomy.", default=False)
    cube: bool = option(help="Draw a cube with these letters, or with x, y, z.", default=False)
    axes: bool = option(help="Draw the axes as arrows.", default=False)
    colorbar: bool = option(help="Draw the colours of the values beside the picture, which gets wider.", default=False)
    colorbar_label: str | None = option("TEXT", "What the values are called there.")
    legend: bool = option(help="Name labels and channels beside the picture.", default=False)
    title: str | None = option("TEXT", "Write this above the picture; {time} is the time, such as 30 s.")
    font_size: float | None = option("SIZE", "Points with --dpi, else pixels; else it follows the size.")
    font: Path | None = option("FILE.ttf", "For signs that the usual font lacks.")
    ink: Any = option("COLOR", "Text colour; black or white by default.", parser=parsers.color)

    @property
    def orientation(self) -> Any:
        """The one marker of orientation that is asked for: "letters", "cube", "axes", or None."""
        asked = [name for name in ("letters", "cube", "axes") if getattr(self, name)]
        if len(asked) > 1:
            raise ArgumentError(f"--{asked[0]} and --{asked[1]} both show how the picture lies; give one of them")
        return asked[0] if asked else None


@dataclass(repr=False)
class FigureOptions:
    """Options of a figure that may be printed."""

    TITLE: ClassVar = MarkOptions.TITLE

    figure: bool = option(
        help="Draw what a figure needs: a scale bar, the axes or letters, a colour bar of a field.", default=False
    )
    marks: MarkOptions = part(MarkOptions)
    dpi: float | None = option("N", "Pixels per inch when printed, for the file.")


def check_figure(options: FigureOptions) -> None:
    """Refuse options that cannot work, before a picture is drawn."""
    from wavesplat._picture.picture import check_dpi

    check_dpi(options.dpi)
    check_marks(options.marks, has_bar=options.figure)


def check_marks(options: MarkOptions, *, has_bar: bool = False) -> None:
    """Refuse marks that cannot be drawn. `has_bar`: whether there is a colour bar without being asked for."""
    from wavesplat._picture import lettering

    _ = options.orientation
    if options.font is not None:
        lettering.opened(str(options.font), 12)
    if options.title:
        lettering.check_letters(options.title, None if options.font is None else str(options.font), "--title")
    if options.colorbar_label is not None and not (options.colorbar or has_bar):
        raise ArgumentError("--colorbar-label names what a colour bar shows; give it with --colorbar")


def annotated(picture: Picture, options: FigureOptions, scene: Scene, *, quiet: bool) -> Picture:
    """The picture as a figure, with the marks that the options ask for. `scene`: what is drawn."""
    marked = options.marks
    bars: bool | list[str] = marked.colorbar
    if options.figure:
        from wavesplat._render.framing import is_of_patient

        first = scene.layers[0].drawn
        of_patient = is_of_patient(first)
        # Headers name a patient's axes and millimetres for other things too: these nobody measured.
        is_measured = of_patient or not first.is_anatomical
        bars = bars or _bars_of_fields(picture, scene)
        is_marked = marked.letters or marked.cube or marked.axes
        marked = replace(
            marked,
            scale_bar=marked.scale_bar or (is_measured and picture.unit is not None),
            letters=marked.letters or (not is_marked and of_patient),
            axes=marked.axes or (not is_marked and not of_patient and is_measured),
            colorbar=bool(bars),
        )
    marks = marks_of(marked, picture.unit, quiet=quiet)
    return picture.annotated(**marks | {"colorbar": bars}, dpi=options.dpi) if marks else picture


def _bars_of_fields(picture: Picture, scene: Scene) -> bool | list[str]:
    """Names of the fields and of the shapes with values that get a colour bar without being asked for."""
    from wavesplat._geometry.slice_plane import SlicePlane
    from wavesplat._looks.kinds.kinds import FIELDS, kind_of

    shown = [one for one in picture.report.get("shown") or () if one["composite"] != "first-hit"]
    # The report names a layer by the field that colours it.
    coloring = [layer if layer.color_from is None else layer.color_from for layer in scene.layers]
    fields = {layer.name or layer.drawn.name for layer in coloring if kind_of(layer.drawn) in FIELDS}
    named = [one["name"] for one in shown if one["name"] in fields and one["transfer_function"] is not None]
    shapes = picture.report.get("geometry_colors") or ()
    named += [one["name"] for one in shapes if one["kind"] != SlicePlane.KIND]
    return len(named) == len(shown) + len(shapes) or named if named else False


def marks_of(options: MarkOptions, unit: str | None, *, quiet: bool) -> dict[str, Any]:
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
