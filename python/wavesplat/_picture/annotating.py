"""A picture with a scale bar, the letters of its directions, colour bars, a legend and a title.

Marks that belong to the rendering stand on it, at its corners and edges, with a halo; explanations of colours, and the
title, stand beside it on the same background, so that nothing is hidden.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, fields, replace
from math import ceil, isfinite
from os import PathLike, fspath
from typing import Any, Literal, TypeAlias, get_args

import numpy as np
from numpy.typing import NDArray

from wavesplat._looks.curves import colors
from wavesplat._model.volume import units
from wavesplat._model.volume.series import FIGURE_SPACE
from wavesplat._model.volume.sources import absolute
from wavesplat._picture import color_bar, lettering, orientation, raster, report_facts, scale_bar
from wavesplat._picture.lettering import CAP_HEIGHT, text_width
from wavesplat._picture.marks import WHITE, Block, Canvas, Color, Mark, Polygon, Rectangle, Style, Text, contrast, moved
from wavesplat._system.values import described
from wavesplat.errors import ArgumentError

# Legends: a swatch of colour and a name a line, in columns.

#: Largest number of entries of a legend that was not asked for by name.
LONGEST = 30
#: Smallest number of lines in a column, where the picture is lower: else columns are as many as names.
MIN_LEGEND_LINES = 16

#: Sizes in units of the font: a swatch, the gap to its name, a line, and the gap between columns.
SWATCH, LEGEND_GAP, LINE, COLUMN = 0.85, 0.5, 1.45, 1.4


def shortened(swatches: Sequence[tuple[str, Color]]) -> list[tuple[str, Color | None]]:
    """The names, of very many the first ones and how many more there are."""
    if len(swatches) <= LONGEST:
        return list(swatches)
    return [*swatches[:LONGEST], (f"and {len(swatches) - LONGEST} more", None)]


def legend_block(
    swatches: Sequence[tuple[str, Color | None]], height: float, style: Style, *, may_be_higher: bool
) -> Block:
    """All names, in as few columns as the height allows, which are equally long; without a colour, the name alone.

    may_be_higher : the block may be higher than the picture that it stands beside.
    """
    size = style.size
    most = max(MIN_LEGEND_LINES if may_be_higher else 1, int((height - SWATCH * size) / (LINE * size)) + 1)
    n_columns = ceil(len(swatches) / most)
    n_rows = ceil(len(swatches) / n_columns)
    marks: list[Mark] = []
    x = right = 0.0
    for start in range(0, len(swatches), n_rows):
        column = swatches[start : start + n_rows]
        for row, (name, color) in enumerate(column):
            y = row * LINE * size
            line = max(1.0, round(0.05 * size))
            side = SWATCH * size
            if color is not None:
                marks.append(Rectangle(x, y, side, side, style.ink, style.halo))
                marks.append(Rectangle(x + line, y + line, side - 2 * line, side - 2 * line, color))
            baseline = y + (side + CAP_HEIGHT * size) / 2
            marks.append(Text(x + side + LEGEND_GAP * size, baseline, name, size, style.ink, "start", style.halo))
        right = x + (SWATCH + LEGEND_GAP) * size + max(text_width(name, size, style.font) for name, _ in column)
        x = right + COLUMN * size
    return Block(tuple(marks), right, (n_rows - 1) * LINE * size + SWATCH * size)


# A picture with a scale bar, the letters of its directions, colour bars, a legend and a title.

Corner: TypeAlias = Literal["lower left", "lower right", "upper left", "upper right"]
Side: TypeAlias = Literal["beside", "lower left", "lower right", "upper left", "upper right"]
Orientation: TypeAlias = Literal["letters", "cube", "axes"]

#: Height of the font as a part of the shorter side, and its bounds, pixels: a figure as wide as a column of a journal
#: (86 mm) then has 9 points.
TEXT_SHARE, TEXT_PX = 1 / 27, (10.0, 200.0)
POINTS_PER_INCH = 72.0
#: Sizes of the font along the shorter side of the smallest picture of a sheet, so that a position fits across it.
MIN_LINES = 6.0
#: Distances in sizes of the font: from the edges, between blocks, from the rendering to the blocks beside it.
MARGIN, GAP, BESIDE = 0.9, 0.9, 1.2
#: Height of a colour bar as a share of the rendering's, where it has room; least height, in sizes of the font.
BAR_SHARE, MIN_BAR = 0.62, 7.0
TITLE, TITLE_LINE = 1.25, 1.3
#: Placeholder of the time in a title.
TIME = "{time}"
#: Longest side, pixels, of a figure that is larger than its rendering.
MAX_SIDE = 32768


@dataclass(frozen=True, kw_only=True)
class Figure:
    """Arguments of `Picture.annotated`: the marks of a figure, and how they look."""

    scale_bar: bool | float | str = False
    orientation: Orientation | None = None
    colorbar: bool | str | Sequence[str] = False
    legend: bool | Iterable[str] = False
    title: str | None = None
    unit: str | None = None
    values: str | None = None
    dpi: float | None = None
    font_size: float | None = None
    color: str | Sequence[float] | None = None
    font: str | PathLike[str] | None = None
    scale_bar_at: Corner = "lower left"
    orientation_at: Corner = "lower right"
    colorbar_at: Side = "beside"
    legend_at: Side = "beside"

    def as_json(self) -> dict[str, Any]:
        """Arguments of `Picture.annotated` that differ from the defaults, as JSON has them."""
        given = {field.name: getattr(self, field.name) for field in fields(self)}
        given = {name: _plain(value) for name, value in given.items()}
        if self.font is not None:
            given["font"] = absolute(self.font)
        return {name: value for name, value in given.items() if value != getattr(type(self), name)}


def _plain(value: Any) -> Any:
    """A value as JSON has it: numbers of NumPy as Python's, several values as a list."""
    if isinstance(value, np.generic):
        return value.item()
    return value if value is None or isinstance(value, str | float | int | PathLike) else list(value)


def annotated(
    rgba: NDArray[np.float32], report: Mapping[str, Any], figure: Figure, marks: Iterable[Mark] = ()
) -> tuple[Canvas, dict[str, Any]]:
    """The canvas of a figure, and facts about its scale bar for the report. `marks`: on the rendering, from before."""
    _check(figure)
    figure = replace(figure, title=_title_of(figure, report))
    height, width = rgba.shape[:2]
    font = None if figure.font is None else _font(figure.font)
    background = report_facts.background_of(report, rgba)
    # Transparent pictures are taken to lie on white paper.
    behind: Color = WHITE if background is None else background[:3]
    style = Style(_font_px(figure, width, height), _ink(figure, behind), font=font)
    on_picture = style.on_picture()
    margin = MARGIN * style.size
    sheet = _Sheet(width, height, margin, GAP * style.size)
    sheet.marks += marks
    entries: dict[str, Any] = {}

    if figure.scale_bar is not False:
        bar = _bar(figure, report, width)
        entries["scale_bar"] = {"length": bar.length, "pixels": bar.length_px, "text": bar.text}
        sheet.put(scale_bar.block(bar, on_picture), figure.scale_bar_at, "a scale bar")
    if figure.orientation is not None:
        _orient(sheet, figure, report, on_picture)
    taken = 0.0
    if figure.legend is not False:
        swatches = _named(figure, report)
        lettering.check_letters("".join(name for name, _ in swatches), font, "a name of the legend")
        beside = figure.legend_at == "beside"
        room = height - 2 * margin
        if swatches:
            block = legend_block(swatches, room, style if beside else on_picture, may_be_higher=beside)
            sheet.put(block, figure.legend_at, "the legend")
            taken = block.height + 2 * GAP * style.size if beside and figure.colorbar_at == "beside" else 0.0
    if figure.colorbar is not False:
        beside = figure.colorbar_at == "beside"
        for block in _color_bars(figure, report, height, style if beside else on_picture, behind, taken=taken):
            sheet.put(block, figure.colorbar_at, "the colour bar")
    return sheet.canvas(rgba, background, style, figure), entries


def style_of(rgba: NDArray[np.float32], background: Any) -> Style:
    """The style of what is written on a picture, over its background, red, green, blue and opacity, or None."""
    height, width = rgba.shape[:2]
    return Style(
        _font_px(Figure(), width, height), contrast(WHITE if background is None else background[:3])
    ).on_picture()


def common_font_px(sizes: Sequence[tuple[int, int]]) -> float:
    """Font height in pixels for all pictures of a sheet: the largest picture's, reduced to fit the smallest."""
    largest = max(_font_px(Figure(), width, height) for width, height in sizes)
    return max(TEXT_PX[0], min(largest, min(map(min, sizes)) / MIN_LINES))


def with_caption(
    rgba: NDArray[np.float32], text: str, color: Color = WHITE, font_px: float | None = None
) -> NDArray[np.float32]:
    """The picture with a line of text in its upper left corner. `font_px`: height of the font, by its size if None."""
    height, width = rgba.shape[:2]
    style = Style(font_px or _font_px(Figure(), width, height), color).on_picture()
    mark = Text(0.5 * style.size, 1.2 * style.size, text, style.size, style.ink, "start", style.halo)
    return raster.drawn(Canvas(width, height, rgba, marks=(mark,)))


def caption_strip(text: str, width: int, height: int) -> NDArray[np.float32]:
    """A transparent strip with a line of white text, to stand below a picture of this width and height.

    Of a line that is too long the middle is left out.
    """
    size = _font_px(Figure(), width, height)
    line = lettering.fitting(text, size, width - size)
    mark = Text(width / 2, 0.4 * size + lettering.CAP_HEIGHT * size, line, size, WHITE, "middle")
    strip = ceil((0.8 + lettering.CAP_HEIGHT) * size)
    return raster.drawn(Canvas(width, strip, np.zeros((strip, width, 4), np.float32), marks=(mark,)))


class _Sheet:
    """Layout of blocks: at the corners of the rendering, one above the other, or in columns at its right."""

    def __init__(self, width: int, height: int, margin: float, gap: float) -> None:
        self.width, self.height, self.margin, self.gap = width, height, margin, gap
        self.marks: list[Mark] = []
        self.filled = dict.fromkeys(get_args(Corner), margin)
        self.beside: list[Block] = []

    def put(self, block: Block, where: Side, what: str) -> None:
        """Put a block in the next place of a corner, or of the columns beside the rendering."""
        if where == "beside":
            self.beside.append(block)
            return
        if block.width + self.margin > self.width or block.height + self.margin > self.height:
            raise ArgumentError(
                f"a picture of {self.width} x {self.height} pixels has no room for {what}; draw a larger one, or give "
                "a smaller font_size"
            )
        across = self.margin if "left" in where else self.width - self.margin - block.width
        down = self.filled[where]
        self.marks += moved(block.marks, across, down if "upper" in where else self.height - down - block.height)
        self.filled[where] = down + block.height + self.gap

    def columns(self) -> list[Block]:
        """The columns beside the rendering, each half way up."""
        columns: list[list[Block]] = []
        for block in self.beside:
            if columns and self._height([*columns[-1], block]) <= self.height - 2 * self.margin:
                columns[-1].append(block)
            else:
                columns.append([block])
        return [self._column(blocks) for blocks in columns]

    def _height(self, blocks: Sequence[Block]) -> float:
        return sum(block.height for block in blocks) + 2 * (len(blocks) - 1) * self.gap

    def _column(self, blocks: Sequence[Block]) -> Block:
        y = max(self.margin, (self.height - self._height(blocks)) / 2)
        marks: list[Mark] = []
        for block in blocks:
            marks += moved(block.marks, 0, y)
            y += block.height + 2 * self.gap
        return Block(tuple(marks), max(block.width for block in blocks), self.height)

    def canvas(self, rgba: NDArray[np.float32], background: Any, style: Style, figure: Figure) -> Canvas:
        """The canvas with all blocks, as large as they need; sides are even, as encoders of movies want them."""
        right = float(self.width)
        columns = self.columns()
        for column in columns:
            right += BESIDE * style.size
            self.marks += moved(column.marks, right, 0)
            right += column.width
        right += self.margin if columns else 0
        below = max((_lowest(mark) for column in columns for mark in column.marks), default=0.0) + self.margin
        title, top = _title(figure, style, self.width)
        height = max(float(self.height), below if columns else 0.0) + top
        grown = right > self.width or height > self.height
        if grown and max(right, height) > MAX_SIDE:
            raise ArgumentError(
                f"the figure would have {right:.0f} x {height:.0f} pixels, and {MAX_SIDE} a side are the most; "
                "give a smaller font_size or dpi, or shorter names"
            )
        return Canvas(
            _even(right) if grown else self.width,
            _even(height) if grown else self.height,
            rgba,
            (0, top),
            background if grown else None,
            (*moved(self.marks, 0, top), *title),
            style.font,
            figure.dpi,
            figure.title or "",
        )


def _title_of(figure: Figure, report: Mapping[str, Any]) -> str | None:
    """The title, with the picture's time in place of `{time}`."""
    if not figure.title or TIME not in figure.title:
        return figure.title
    time = report.get("time")
    if not isinstance(time, Mapping):
        raise ArgumentError(
            f"the title has {TIME}, and this picture is of no time point; leave it out, or draw one of a file that "
            "holds several (time=, --time, --times)"
        )
    return figure.title.replace(TIME, str(time["text"]))


def _title(figure: Figure, style: Style, width: int) -> tuple[list[Mark], int]:
    """Lines of the title above the rendering, and the height that they take, pixels."""
    if not figure.title:
        return [], 0
    lettering.check_length(figure.title, "the title")
    lettering.check_letters(figure.title, style.font, "the title")
    size = TITLE * style.size
    # Some typefaces have no blank of this width; it would be drawn as a box.
    title = figure.title if lettering.has_sign(FIGURE_SPACE, style.font) else figure.title.replace(FIGURE_SPACE, "")
    lines = lettering.wrapped(title, size, width - 2 * MARGIN * style.size, style.font)
    first = 0.75 * size + lettering.CAP_HEIGHT * size
    marks: list[Mark] = [
        Text(width / 2, first + number * TITLE_LINE * size, line, size, style.ink, "middle")
        for number, line in enumerate(lines)
    ]
    return marks, ceil(first + (len(lines) - 1) * TITLE_LINE * size + 0.6 * size)


def _check(figure: Figure) -> None:
    from wavesplat._picture.picture import check_dpi

    check_dpi(figure.dpi)
    if figure.orientation is not None and figure.orientation not in get_args(Orientation):
        raise ArgumentError(
            f"orientation is {described(figure.orientation)}; use one of: {', '.join(get_args(Orientation))}, or None"
        )
    for name, places in (
        ("scale_bar_at", Corner),
        ("orientation_at", Corner),
        ("colorbar_at", Side),
        ("legend_at", Side),
    ):
        if getattr(figure, name) not in get_args(places):
            raise ArgumentError(
                f"{name} is {described(getattr(figure, name))}; use one of: {', '.join(get_args(places))}"
            )
    colorbar: object = figure.colorbar
    is_names = isinstance(colorbar, list | tuple) and colorbar and all(isinstance(name, str) for name in colorbar)
    if not is_names and not isinstance(colorbar, bool | np.bool_ | str):
        raise ArgumentError(f"colorbar is {described(colorbar)}; give True, False or names of layers")
    size = figure.font_size
    if size is not None and not (isfinite(size) and 1 <= size <= 1000):
        raise ArgumentError(f"font_size is {size:g}; give 1 to 1000: points where dpi is given, else pixels")


def _font(font: str | PathLike[str]) -> str:
    try:
        return fspath(font)
    except TypeError:
        raise ArgumentError(f"font is {described(font)}; give the name of a .ttf or .otf file") from None


def _font_px(figure: Figure, width: int, height: int) -> float:
    if figure.font_size is None:
        return round(float(np.clip(min(width, height) * TEXT_SHARE, *TEXT_PX)), 1)
    return figure.font_size * (figure.dpi or POINTS_PER_INCH) / POINTS_PER_INCH


def _ink(figure: Figure, behind: Color) -> Color:
    rgba = colors.parse(figure.color)
    if rgba is None:
        return contrast(behind)
    return rgba[:3]


def _bar(figure: Figure, report: Mapping[str, Any], width: int) -> scale_bar.Bar:
    pixel = report.get("pixel")
    if pixel is None:
        raise ArgumentError(
            "this picture does not say how far its pixels are apart, which a scale bar needs; pictures of render and "
            'slice do, and others may: wavesplat.Picture(rgba, report={"pixel": 0.5, "unit": "mm"})'
        )
    known = report.get("unit")
    given = units.checked(figure.unit)
    if given is not None and known is not None and given != known:
        raise ArgumentError(
            f"unit is {figure.unit!r}, but the file's is {known!r}; leave it out, or open the file with unit="
        )
    camera = report.get("camera") or {}
    in_perspective = camera.get("view_angle") is not None
    return scale_bar.bar_of(figure.scale_bar, width, float(pixel), known or given, is_perspective=in_perspective)


def _orient(sheet: _Sheet, figure: Figure, report: Mapping[str, Any], style: Style) -> None:
    view, is_anatomical = report_facts.view_of(report), bool(report.get("anatomical"))
    if figure.orientation == "letters":
        if not is_anatomical:
            raise ArgumentError(
                "this picture has no letters: the file does not say how its axes lie in a patient; use "
                'orientation="cube" or "axes", which show x, y and z, or, if you know that the world is RAS, say so '
                "with wavesplat.Volume(..., anatomical=True)"
            )
        sheet.marks += orientation.letter_marks(view, sheet.width, sheet.height, sheet.margin, style)
        return
    drawn = orientation.cube_block if figure.orientation == "cube" else orientation.axes_block
    sheet.put(drawn(view, style, is_anatomical=is_anatomical), figure.orientation_at, f"the {figure.orientation}")


def _colored(figure: Figure, report: Mapping[str, Any]) -> list[tuple[report_facts.ShownLayer, str]]:
    """Layers, and what stands in space with values, that get a colour bar, with the bar's title."""
    shapes = report_facts.shapes_of(report)
    layers = report_facts.layers_of(report) if report.get("shown") or not shapes else []
    if not isinstance(figure.colorbar, bool | np.bool_):
        wanted = [figure.colorbar] if isinstance(figure.colorbar, str) else list(figure.colorbar)
        names = [one.name for one in (*layers, *shapes)]
        if missing := [name for name in wanted if name not in names]:
            raise ArgumentError(f"no layer is named {missing[0]!r}; there are: {', '.join(map(repr, names))}")
        layers, shapes = ([one for one in kind if one.name in wanted] for kind in (layers, shapes))
    layers = [layer for layer in layers if layer.composite != "first-hit"]
    if not layers and not shapes:
        raise ArgumentError(
            "a surface of one value has one colour, so a colour bar says nothing of it; leave out the colour bar, or "
            "write the value as a title"
        )
    if figure.values is not None:
        named = [(one, figure.values) for one in (layers or shapes)]
        return named if not layers else [*named, *_titled(shapes)]
    if len(layers) == 1 and not shapes and layers[0].values and not layers[0].quantity:
        return [(layers[0], layers[0].values)]
    return _titled([*layers, *shapes])


def _titled(shown: Sequence[report_facts.ShownLayer]) -> list[tuple[report_facts.ShownLayer, str]]:
    """Colour bars with their titles; if several have the same title, later ones are titled by their layer or shape."""
    found: list[tuple[report_facts.ShownLayer, str]] = []
    for one in shown:
        title = _title_of_values(one)
        is_ambiguous = one.quantity and any(title == other for _, other in found)
        found.append((one, f"{report_facts.plain_name(one.name)}, {title}" if is_ambiguous else title))
    return found


def _title_of_values(layer: report_facts.ShownLayer) -> str:
    """The title of a layer's colour bar: the name of its values and their unit, such as "temperature (K)"."""
    name = layer.quantity or report_facts.plain_name(layer.name)
    return f"{name} ({units.written(layer.values)})" if layer.values else name


def _scales(figure: Figure, report: Mapping[str, Any], behind: Color) -> list[color_bar.Scale]:
    """Scales of the colour bars: the scale of depths first, if there is one, then the scales of layers and shapes."""
    of_depths = []
    if (depth_colors := report.get("depth_colors")) is not None:
        of_depths = [color_bar.scale_of_depths(depth_colors, report.get("unit"))]
    colored = _titled(report_facts.shapes_of(report)) if of_depths else _colored(figure, report)
    own = [color_bar.scale_of(layer.function, layer.composite, title, behind) for layer, title in colored]
    return [*of_depths, *own]


def _color_bars(
    figure: Figure, report: Mapping[str, Any], height: int, style: Style, behind: Color, *, taken: float
) -> list[Block]:
    """Colour bars, one above the other where all have room. `taken`: height that blocks above them take."""
    scales = _scales(figure, report, behind)
    for scale in scales:
        lettering.check_length(scale.title, "the name of a layer")
        lettering.check_letters(scale.title, style.font, "the name of a layer")
    room = height - 2 * MARGIN * style.size - 2 * (len(scales) - 1) * GAP * style.size
    least = MIN_BAR * style.size
    # Else they stand in columns of their own.
    if len(scales) > 1 and (room - taken) / len(scales) >= least:
        room -= taken
    long = max(min(room / len(scales), BAR_SHARE * height), least)
    return [color_bar.block(scale, long, style, behind) for scale in scales]


def _named(figure: Figure, report: Mapping[str, Any]) -> list[tuple[str, Color | None]]:
    """Names and colours of the legend; None for the line that counts names left out.

    Empty where the picture has labels or lines and none of them lies in this slice: other slices have the legend.
    """
    swatches = [(report_facts.plain_name(name), color) for name, color in report_facts.swatches_of(report)]
    for name, _ in swatches:
        lettering.check_length(name, "a name in the legend")
    if not swatches:
        if figure.legend is True and ("labels" in report or "lines" in report):
            return []
        raise ArgumentError(
            "there is nothing for a legend: this picture has no labels, no lines, and not several layers"
        )
    if figure.legend is True:
        return shortened(swatches)
    if isinstance(figure.legend, str) or not isinstance(figure.legend, Iterable):
        raise ArgumentError(f"legend is {described(figure.legend)}; give True, or the names that it shall have")
    known = dict(swatches)
    wanted = [str(name) for name in figure.legend]
    missing = [name for name in wanted if name not in known]
    if missing or not wanted:
        raise ArgumentError(f"the legend has no {missing or 'names'}; there are: {', '.join(map(repr, known))}")
    return [(name, known[name]) for name in wanted]


def _lowest(mark: Mark) -> float:
    if isinstance(mark, Polygon):
        return max(y for _, y in mark.points)
    return mark.y if isinstance(mark, Text) else mark.y + mark.height


def _even(length: float) -> int:
    return 2 * ceil(length / 2 - 1e-9)
