"""Options that several commands share."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any, get_args

import typer

from wavesplat._cli import parsers
from wavesplat._model import options

__all__ = [
    "Background",
    "Bits",
    "Device",
    "Family",
    "Json",
    "Kernel",
    "PictureOutput",
    "Quiet",
    "Size",
    "Threads",
    "Threshold",
    "Zoom",
]

PictureOutput = Annotated[
    Path,
    typer.Option(
        "--output",
        "-o",
        metavar="OUT",
        help="Picture to write: .png, .jpg, .webp, .tif, .exr, .svg or .pdf.",
        show_default=False,
    ),
]
Zoom = Annotated[float, typer.Option(metavar="FACTOR", help="Magnification; 1 fits the volume.")]
Size = Annotated[Any, typer.Option(metavar="WxH", parser=parsers.size, help="Pixels.")]
Kernel = Annotated[Any, parsers.choice(get_args(options.Kernel))]
Background = Annotated[
    Any, typer.Option(metavar="COLOR", parser=parsers.color, help="black, white, grey, #rrggbb, r,g,b or transparent.")
]
Bits = Annotated[int, typer.Option(metavar="8|16", help="Bits per channel of a PNG or TIFF file.")]
Device = Annotated[
    str,
    typer.Option(metavar="NAME", help="What draws: auto, cpu, gpu, or part of a GPU's name (gpu-check lists them)."),
]
Threads = Annotated[int | None, typer.Option(metavar="N", help="Worker threads; all cores if not given.")]
Family = Annotated[
    str, typer.Option(metavar="NAME", help="Wavelets: cdf97, cdf53, haar, spline4, bspline2 to bspline4.")
]
Threshold = Annotated[
    float | None, typer.Option(metavar="T", help="Drop wavelet coefficients of less amplitude, in sample units.")
]
Json = Annotated[bool, typer.Option("--json", help="Print the result as JSON.")]
Quiet = Annotated[bool, typer.Option("--quiet", "-q", help="No messages and no progress bar; errors still show.")]
