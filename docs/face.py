"""The face of the project: its logo, the row of pictures at the head of the README, and the preview for links.

`make face` draws them to `face`, from the bundled scans and the pictures of `make pictures`; it takes seconds.
The logo is a wave of splats: Gaussian footprints along a wavelet, largest in the middle.
"""

# ruff: noqa: INP001 - a script, not a package
from __future__ import annotations

import math
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw, ImageFont

import wavesplat as ws

HERE = Path(__file__).parent
FACE = HERE / "face"
FONT = Path(ws.__file__).parent / "data" / "liberation_sans" / "LiberationSans-Regular.ttf"

#: The tile of the logo, the colours of its wave at the crest and in the troughs, and its side in units of the SVG.
TILE, CREST, TROUGH, SIDE = "#14181f", (108, 178, 255), (255, 140, 84), 64
N_SPLATS = 21
#: Pixels that the SVG takes where nothing else is said.
SHOWN = 72
#: The standard deviation of the largest splat, units of the SVG.
LARGEST_SIGMA = 3.6

ROW = ("ct", "brain", "mouse_brain", "nuclei", "flame", "protein")
PANEL_PX = 320
SOCIAL_PX = (1280, 640)
INK, FAINT = "#f2f5fa", "#9fb0c8"

Rgb = tuple[int, int, int]


def main() -> None:
    """Draw all three."""
    FACE.mkdir(exist_ok=True)
    (FACE / "logo.svg").write_text(logo_svg(), encoding="utf-8")
    row().save(FACE / "row.webp", quality=84, method=6)
    social().save(FACE / "social.png", optimize=True)


def splats() -> list[tuple[float, float, float, str]]:
    """The splats of the logo: centre x and y, standard deviation, colour; units of the SVG."""
    found = []
    for number in range(N_SPLATS):
        place = number / (N_SPLATS - 1) * 2 - 1  # -1 to 1, from left to right
        envelope = math.exp(-3 * place**2)
        wave = (1 - 7 * place**2) * envelope  # 1 in the middle, about -0.5 in the troughs
        sigma = LARGEST_SIGMA * (0.45 + 0.55 * envelope)
        center = (SIDE * (0.5 + 0.39 * place), SIDE * (0.56 - 0.3 * wave))
        share = min(max((wave + 0.5) / 1.3, 0), 1)
        color = "#" + "".join(f"{round(b + share * (a - b)):02x}" for a, b in zip(CREST, TROUGH, strict=True))
        found.append((*center, sigma, color))
    return found


def logo_svg() -> str:
    """The logo as SVG: radial gradients with the profile of a Gaussian."""
    stops = [(r, 0 if r == 1 else math.exp(-4.5 * r**2)) for r in (0, 0.2, 0.4, 0.6, 0.8, 1)]
    lines = [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {SIDE} {SIDE}" width="{SHOWN}" height="{SHOWN}">',
        f'<rect width="{SIDE}" height="{SIDE}" rx="12" fill="{TILE}"/>',
    ]
    for number, (x, y, sigma, color) in enumerate(splats()):
        profile = "".join(f'<stop offset="{r:g}" stop-color="{color}" stop-opacity="{a:.3g}"/>' for r, a in stops)
        lines.append(f'<radialGradient id="s{number}">{profile}</radialGradient>')
        lines.append(f'<circle cx="{x:.2f}" cy="{y:.2f}" r="{3 * sigma:.2f}" fill="url(#s{number})"/>')
    return "\n".join([*lines, "</svg>", ""])


def logo(side_px: int) -> Image.Image:
    """The logo as a picture, composited splat by splat as the SVG is."""
    y, x = (np.mgrid[:side_px, :side_px] + 0.5) * SIDE / side_px
    pixels: NDArray[np.float64] = np.broadcast_to(np.array(_rgb(TILE), float), (side_px, side_px, 3)).copy()
    for cx, cy, sigma, color in splats():
        opacity = np.exp(-((x - cx) ** 2 + (y - cy) ** 2) / (2 * sigma**2))[..., None]
        pixels += opacity * (np.array(_rgb(color), float) - pixels)
    tile = Image.fromarray(np.rint(pixels).astype(np.uint8))
    mask = Image.new("L", (4 * side_px, 4 * side_px))
    ImageDraw.Draw(mask).rounded_rectangle((0, 0, 4 * side_px - 1, 4 * side_px - 1), 0.75 * side_px, fill=255)
    tile.putalpha(mask.resize((side_px, side_px)))
    return tile


def row() -> Image.Image:
    """Six of the pictures of `make pictures`, side by side on black."""
    picture = Image.new("RGB", (PANEL_PX * len(ROW), PANEL_PX))
    for number, name in enumerate(ROW):
        panel = Image.open(HERE / "pictures" / f"{name}.png").convert("RGBA")
        picture.paste(panel, (number * PANEL_PX, 0), panel)
    return picture


def social() -> Image.Image:
    """The preview that is shown beside links: logo, name, what it is, and a body."""
    width, height = SOCIAL_PX
    picture = Image.new("RGB", SOCIAL_PX, "black")
    ct = ws.examples.ct_pelvis()
    camera = ws.Camera.orbit(ct, 25, 12, fit="view")
    body = ws.render(ct, "ct-soft-tissue", camera, size=(height, height), quality="high")
    drawn = body.to_pil()
    picture.paste(drawn, (width - height + 10, 0), drawn)
    mark = logo(128)
    picture.paste(mark, (72, 96), mark)
    draw = ImageDraw.Draw(picture)
    draw.text((72, 252), "Wavesplat", INK, _font(92))
    for number, line in enumerate(("Volume rendering at ray-casting", "quality, on any processor.")):
        draw.text((76, 372 + 46 * number), line, INK, _font(36))
    draw.text((76, 490), "CT · MRI · microscopy · simulations", FAINT, _font(30))
    return picture


def _font(size: int) -> ImageFont.FreeTypeFont:
    return ImageFont.truetype(str(FONT), size)


def _rgb(color: str) -> Rgb:
    red, green, blue = bytes.fromhex(color[1:])
    return red, green, blue


if __name__ == "__main__":
    main()
