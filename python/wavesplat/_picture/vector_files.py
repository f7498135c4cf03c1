"""A canvas as SVG and as PDF: the rendering embedded, the rest vectors and text.

The typeface is embedded. Equal canvases give equal bytes.
"""

from __future__ import annotations

import io
from base64 import b64encode
from itertools import count
from typing import Any
from xml.sax.saxutils import escape, quoteattr

from wavesplat._picture import lettering, picture_files
from wavesplat._picture.marks import UPRIGHT, Canvas, Color, Mark, Polygon, Ramp, Rectangle, Text
from wavesplat._system.libraries import library
from wavesplat.errors import FileError

# A canvas as SVG: the rendering embedded as PNG, the rest vectors and text, which may be edited and searched.
#
# Text names its typeface and does not hold it: ours is as wide as Arial and Helvetica, which are asked for next.

INCH_PX = 96.0


def svg_written(canvas: Canvas, bits: int = 8) -> str:
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


# A canvas as PDF, by ReportLab: the rendering embedded with its transparency, the rest vectors and text.

POINTS_PER_INCH = 72.0
FILL, STROKE = 0, 1


def pdf_written(canvas: Canvas) -> bytes:
    """The content of a PDF file of one page."""
    sheets, readers = library("reportlab.pdfgen.canvas", extra="figure"), library("reportlab.lib.utils", extra="figure")
    scale = POINTS_PER_INCH / (canvas.dpi or INCH_PX)
    content = io.BytesIO()
    # invariant: without the time of day.
    page = sheets.Canvas(content, pagesize=(canvas.width * scale, canvas.height * scale), invariant=1)
    page.setTitle(canvas.title or "picture")
    page.setProducer("wavesplat")
    page.scale(scale, scale)
    if canvas.background is not None:
        *color, alpha = canvas.background
        page.setFillColorRGB(*color, alpha=alpha)
        page.rect(0, 0, canvas.width, canvas.height, stroke=0, fill=1)
        page.setFillAlpha(1)
    height, width = canvas.rgba.shape[:2]
    left, top = canvas.place
    embedded = readers.ImageReader(picture_files.image(canvas.rgba))
    page.drawImage(embedded, left, canvas.height - top - height, width, height, mask="auto")
    pen = _Pen(page, canvas)
    for mark in canvas.marks:
        if not isinstance(mark, Ramp) and mark.halo is not None:
            pen.draw(mark, *mark.halo)
    for mark in canvas.marks:
        if isinstance(mark, Ramp):
            pen.ramp(mark)
        else:
            pen.draw(mark, mark.fill, 0.0)
    page.save()
    return content.getvalue()


class _Pen:
    """Draws on a page whose y axis points up."""

    def __init__(self, page: Any, canvas: Canvas) -> None:
        self.page, self.top = page, canvas.height
        self.font = _registered(canvas.font) if any(isinstance(mark, Text) for mark in canvas.marks) else ""
        page.setLineJoin(1)

    def draw(self, mark: Rectangle | Polygon | Text, color: Color, rim: float) -> None:
        page = self.page
        page.setFillColorRGB(*color)
        page.setStrokeColorRGB(*color)
        page.setLineWidth(2 * rim)
        if isinstance(mark, Rectangle):
            low = self.top - mark.y - mark.height
            page.rect(mark.x, low, mark.width, mark.height, stroke=int(rim > 0), fill=1)
        elif isinstance(mark, Polygon):
            path = page.beginPath()
            path.moveTo(mark.points[0][0], self.top - mark.points[0][1])
            for x, y in mark.points[1:]:
                path.lineTo(x, self.top - y)
            path.close()
            page.drawPath(path, stroke=int(rim > 0), fill=1)
        else:
            before = (
                page.stringWidth(mark.text, self.font, mark.size)
                * {"start": 0.0, "middle": 0.5, "end": 1.0}[mark.anchor]
            )
            across, along, down_x, down_y = mark.slant
            # The mode of drawing text stays set after the text in PDF, which ReportLab does not undo.
            page.saveState()
            text = page.beginText()
            x, y = mark.x - before * across, self.top - mark.y + before * along
            text.setTextTransform(across, -along, -down_x, down_y, x, y)
            text.setFont(self.font, mark.size)
            text.setTextRenderMode(STROKE if rim else FILL)
            text.textOut(mark.text)
            page.drawText(text)
            page.restoreState()

    def ramp(self, mark: Ramp) -> None:
        from reportlab.lib.colors import Color as Ink

        page, low = self.page, self.top - mark.y - mark.height
        page.saveState()
        path = page.beginPath()
        path.rect(mark.x, low, mark.width, mark.height)
        page.clipPath(path, stroke=0, fill=0)
        inks, places = [Ink(*color) for _, color in mark.stops], [place for place, _ in mark.stops]
        page.linearGradient(mark.x, low, mark.x, low + mark.height, inks, places, extend=True)
        page.restoreState()


def _registered(font: str | None) -> str:
    """The name by which ReportLab has the typeface."""
    from reportlab.pdfbase import pdfmetrics, ttfonts

    path = lettering.file_of(font)
    name = "wavesplat:" + path
    if name not in pdfmetrics.getRegisteredFontNames():
        try:
            pdfmetrics.registerFont(ttfonts.TTFont(name, path))
        except ttfonts.TTFError as error:
            raise FileError(f"PDF files cannot hold this font ({error}); give a TrueType one: {path}") from error
    return name
