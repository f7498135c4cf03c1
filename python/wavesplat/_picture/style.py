"""The style of marks: size, colours, typeface."""

from __future__ import annotations

from dataclasses import dataclass, replace

from wavesplat._picture.marks import Color, Halo

BLACK: Color = (0.0, 0.0, 0.0)
WHITE: Color = (1.0, 1.0, 1.0)
#: Width of a halo, in sizes of the font.
HALO = 0.09


@dataclass(frozen=True)
class Style:
    """Size of the font in pixels, colour of what is written, its halo, and the file of the typeface."""

    size: float
    ink: Color
    halo: Halo | None = None
    font: str | None = None

    def on_picture(self) -> Style:
        """The style with a halo, to be seen on anything."""
        return replace(self, halo=(contrast(self.ink), max(1.0, HALO * self.size)))


def luminance(color: Color) -> float:
    """Luminance (Rec. 709) of a colour as it is shown."""
    return 0.2126 * color[0] + 0.7152 * color[1] + 0.0722 * color[2]


def contrast(color: Color) -> Color:
    """Black or white, whichever contrasts with a colour."""
    return BLACK if luminance(color) > 0.45 else WHITE
