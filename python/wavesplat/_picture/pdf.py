"""A canvas as PDF, by ReportLab: the rendering embedded with its transparency, the rest vectors and text.

The typeface is embedded. Equal canvases give equal bytes.
"""

from __future__ import annotations

import io
from typing import Any

from wavesplat._files.libraries import library
from wavesplat._picture import lettering, picture_files
from wavesplat._picture.marks import Canvas, Color, Polygon, Ramp, Rectangle, Text
from wavesplat.errors import FileError

POINTS_PER_INCH = 72.0
#: Pixels per inch where no size in print is given, as browsers have it.
INCH_PX = 96.0
FILL, STROKE = 0, 1


def written(canvas: Canvas) -> bytes:
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
