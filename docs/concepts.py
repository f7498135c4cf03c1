"""The pictures of docs/concepts.md, drawn by the product from the scans that come with it, and the numbers beside them.

`make concepts` draws them to `concepts` and prints the numbers; it takes seconds. A test holds the page to the numbers.
"""

# ruff: noqa: INP001 - a script, not a package
from __future__ import annotations

from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from PIL import Image

import wavesplat as ws

PICTURES = Path(__file__).parent / "concepts"
SIZE_PX = 208
QUALITIES = ("draft", "normal", "high")
#: Factor of the differences that are shown beside the pictures, else too faint to see.
MAGNIFIED = 4

CT = ws.examples.ct_pelvis()
HEAD = ws.examples.mri_head()
FRAME: dict[str, Any] = {"size": (SIZE_PX, SIZE_PX), "background": "black"}
VIEW = {**FRAME, "camera": ws.Camera.orbit(CT, 25, 15, fit="view")}
HEAD_VIEW = {**FRAME, "camera": ws.Camera.orbit(HEAD, 40, 20, fit="view")}

Floats = NDArray[np.float32]


def main() -> None:
    """Draw all pictures, and print the numbers."""
    PICTURES.mkdir(exist_ok=True)
    for name, panels in pictures().items():
        row = np.concatenate(panels, axis=1)
        pixels = np.rint(255 * np.clip(row, 0, 1)).astype(np.uint8)
        Image.fromarray(pixels).save(PICTURES / f"{name}.webp", quality=86, method=6)
    for name, value in numbers().items():
        print(f"{name}: {value}")


def pictures() -> dict[str, list[Floats]]:
    """The panels of each picture, from left to right, each an array of shape (height, width, 3), 0..1."""
    return {
        "sheets": [rgb(soft(sheets_per_slice=count)) for count in (0.08, 0.25, 2)],
        "footprints": [rgb(cells(kernel)) for kernel in ("linear", "catmull-rom", "bspline3")],
        "opacity": [rgb(soft(opacity_unit=share)) for share in (0.25, 1, 4)],
        "functions": [
            rgb(ws.render(CT, look, **VIEW)) for look in ("ct-bone", "ct-soft-tissue", ws.Materials.preset("ct"))
        ],
        "light": [rgb(ws.render(CT, "ct-bone", shading=light, **VIEW)) for light in lights()],
        "levels": [rgb(level(left_out)) for left_out in (0, 2, 3)],
        "error": [rgb(bones("draft")), *(difference(quality) for quality in QUALITIES)],
    }


def numbers() -> dict[str, str]:
    """The numbers that the page tells, as they stand there."""
    thin, thick = (brightness(soft(sheets_per_slice=count)) for count in (4, 1))
    whole, coarse = brightness(level(0)), brightness(level(2))
    return {
        "brightness with four sheets a slice, of that with one": f"{100 * thin / thick:.1f} %",
        "brightness without two levels, of the whole": f"{100 * coarse / whole:.0f} %",
        **{f"PSNR of {quality}": f"{psnr(quality):.0f} dB" for quality in QUALITIES},
    }


def rgb(picture: ws.Picture) -> Floats:
    """The colours of a picture on black, 0..1."""
    return picture.rgba[..., :3]


def brightness(picture: ws.Picture) -> float:
    """The mean of a picture's colours."""
    return float(rgb(picture).mean())


def soft(*, sheets_per_slice: float = 2, opacity_unit: float = 1) -> ws.Picture:
    """Skin over bones. `opacity_unit`: of the look's own."""
    own = ws.Look.preset("ct-soft-tissue", CT).transfer_function
    assert isinstance(own, ws.TransferFunction)
    unit = opacity_unit * (own.opacity_unit or 1)
    function = ws.TransferFunction(own.opacity, own.color, unit, gradient_opacity=own.gradient_opacity)
    return ws.render(CT, function, quality=ws.Sampling(sheets_per_slice, 1), **VIEW)


def cells(kernel: Any) -> ws.Picture:
    """A surface round samples of 1 among those of 0, one alone and two beside each other, by a kernel."""
    samples = np.zeros((7, 7, 9), np.float32)
    samples[3, 3, [2, 5, 6]] = 1
    volume = ws.Volume(samples)
    camera = ws.Camera.orbit(volume, 20, 25, fit="view").zoomed(1.5)
    light = ws.Shading(gradient_smoothing=0)
    return ws.render(volume, composite=ws.FirstHit(0.3), kernel=kernel, shading=light, camera=camera, **FRAME)


def lights() -> list[ws.Shading | None]:
    """No light, that of the eye, the usual one, and hollows and shadows with it."""
    return [None, ws.Shading.headlight(), ws.Shading(), ws.Shading(ambient_occlusion=0.8, shadow=0.6)]


def level(left_out: int) -> ws.Picture:
    """The head, without some levels of its wavelet coefficients, the finest first."""
    wavelets = ws.WaveletVolume.from_volume(HEAD, threshold=4)
    return ws.render(wavelets.level(left_out), "mr-head", **HEAD_VIEW)


def bones(quality: Any) -> ws.Picture:
    """Bones without light, of a quality."""
    return ws.render(CT, "ct-bone", quality=quality, shading=None, **VIEW)


@cache
def converged() -> Floats:
    """The same bones by a ray caster of small steps, several rays a pixel."""
    rays: dict[str, Any] = {"step": 0.2, "rays_per_pixel": 4, "shading": None, "size": FRAME["size"]}
    return rgb(ws.reference.raycast(CT, "ct-bone", VIEW["camera"], **rays))


def difference(quality: str) -> Floats:
    """Differences from the converged picture, magnified."""
    return np.asarray(MAGNIFIED * np.abs(rgb(bones(quality)) - converged()), np.float32)


def psnr(quality: str) -> float:
    """Peak signal-to-noise ratio of a quality, dB, against the converged picture."""
    return float(-10 * np.log10(np.mean((rgb(bones(quality)) - converged()) ** 2)))


if __name__ == "__main__":
    main()
