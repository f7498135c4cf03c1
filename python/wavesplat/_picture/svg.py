"""A canvas as SVG: the rendering embedded as PNG, the rest vectors and text, which may be edited and searched.

Text names its typeface and does not hold it: ours is as wide as Arial and Helvetica, which are asked for next.
"""

from __future__ import annotations

from base64 import b64encode
from itertools import count
from xml.sax.saxutils import escape, quoteattr

from wavesplat._picture import lettering, picture_files
from wavesplat._picture.marks import UPRIGHT, Canvas, Color, Mark, Polygon, Ramp, Rectangle, Text

INCH_PX = 96.0


def written(canvas: Canvas, bits: int = 8) -> str:
    """The content of an SVG file."""
    to_inches = 1 / (canvas.dpi or INCH_PX)
    head = (
        '<svg xmlns="http://www.w3.org/2000/svg" xmlns:xlink="http://www.w3.org/1999/xlink" version="1.1" '
        f'width="{_number(canvas.width * to_inches)}in" height="{_number(canvas.height * to_inches)}in" '
        f'viewBox="0 0 {canvas.width} {canvas.height}">'
    )
    lines = [head]
    if canvas.title:
        lines.append(f"<title>{escape(canvas.title)}</title>")
    if canvas.background is not None:
        *color, alpha = canvas.background
        opacity = "" if alpha == 1 else f' fill-opacity="{_number(alpha)}"'
        lines.append(f'<rect width="{canvas.width}" height="{canvas.height}" fill="{_hex(color)}"{opacity}/>')
    height, width = canvas.rgba.shape[:2]
    png = b64encode(picture_files.png_bytes(canvas.rgba, bits)).decode()
    lines.append(
        f'<image x="{canvas.place[0]}" y="{canvas.place[1]}" width="{width}" height="{height}" '
        f'preserveAspectRatio="none" xlink:href="data:image/png;base64,{png}"/>'
    )
    font = "" if canvas.font is None else f"'{lettering.opened(canvas.font, 12).getname()[0]}', "
    lines.append(f"<g font-family={quoteattr(font + lettering.FAMILY)}>")
    halos = [_halo(mark, *mark.halo) for mark in canvas.marks if not isinstance(mark, Ramp) and mark.halo]
    names = count(1)
    lines += halos + [_mark(mark, names) for mark in canvas.marks]
    return "\n".join([*lines, "</g>", "</svg>", ""])


def _halo(mark: Rectangle | Polygon | Text, color: Color, rim: float) -> str:
    paint = f'stroke="{_hex(color)}" stroke-width="{_number(2 * rim)}" stroke-linejoin="round"'
    hidden = ' aria-hidden="true"' if isinstance(mark, Text) else ""
    return _shape(mark, f'fill="{_hex(color)}" {paint}{hidden}')


def _mark(mark: Mark, names: count[int]) -> str:
    if not isinstance(mark, Ramp):
        return _shape(mark, f'fill="{_hex(mark.fill)}"')
    name = f"ramp{next(names)}"
    stops = "".join(f'<stop offset="{_number(place)}" stop-color="{_hex(color)}"/>' for place, color in mark.stops)
    gradient = f'<linearGradient id="{name}" x1="0" y1="1" x2="0" y2="0">{stops}</linearGradient>'
    box = f'x="{_number(mark.x)}" y="{_number(mark.y)}" width="{_number(mark.width)}" height="{_number(mark.height)}"'
    return f'<defs>{gradient}</defs><rect {box} fill="url(#{name})"/>'


def _shape(mark: Rectangle | Polygon | Text, paint: str) -> str:
    if isinstance(mark, Rectangle):
        x, y, width, height = (_number(length) for length in (mark.x, mark.y, mark.width, mark.height))
        return f'<rect x="{x}" y="{y}" width="{width}" height="{height}" {paint}/>'
    if isinstance(mark, Polygon):
        points = " ".join(f"{_number(x)},{_number(y)}" for x, y in mark.points)
        return f'<polygon points="{points}" {paint}/>'
    anchor = "" if mark.anchor == "start" else f' text-anchor="{mark.anchor}"'
    place = f'x="{_number(mark.x)}" y="{_number(mark.y)}"'
    if mark.slant != UPRIGHT:
        place = f'transform="matrix({" ".join(_number(number) for number in (*mark.slant, mark.x, mark.y))})"'
    place += f' font-size="{_number(mark.size)}"'
    return f"<text {place}{anchor} {paint}>{escape(mark.text)}</text>"


def _number(number: float) -> str:
    return f"{round(number, 4):.10g}"


def _hex(color: list[float] | Color) -> str:
    # Halves are rounded up, as in the PNG encoder.
    return "#" + "".join(f"{int(255 * min(max(share, 0), 1) + 0.5):02x}" for share in color)
