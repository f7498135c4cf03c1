"""Arguments and options that several commands share."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any, get_args

import typer

from wavesplat._cli import parsers
from wavesplat._cli.option_groups import option
from wavesplat._model import options

InputOrNone = Annotated[
    str | None, typer.Argument(metavar="INPUT", help="A volume: file, folder or URL.", show_default=False)
]
Input = Annotated[str, typer.Argument(metavar="INPUT", help="A volume: file, folder or URL.", show_default=False)]
Json = Annotated[bool, typer.Option("--json", help="Print the result as JSON.")]
Quiet = Annotated[bool, typer.Option("--quiet", "-q", help="No messages and no progress bar; errors still show.")]


def output(help: str) -> Any:
    """The option of the result's file."""
    return typer.Option("--output", "-o", metavar="OUT", help=help, show_default=False)


PictureOutput = Annotated[Path, output("Picture to write: .png, .jpg, .webp, .tif, .exr, .svg or .pdf.")]


def picture_size(help: str = "Pixels.", default: str | None = "512x512") -> Any:
    """The field of a picture's size."""
    return option("WxH", help, default=default, parser=parsers.size)


def zoom() -> Any:
    """The field of a magnification."""
    return option("FACTOR", "Magnification; 1 fits the volume.", default=1.0)


def kernel() -> Any:
    """The field of a kernel."""
    return option(choices=get_args(options.Kernel), default="linear")


def background(default: str | None = None) -> Any:
    """The field of a background."""
    return option("COLOR", "black, white, grey, #rrggbb, r,g,b or transparent.", default=default, parser=parsers.color)


def bits() -> Any:
    """The field of the bits of a picture's file."""
    return option("8|16", "Bits per channel of a PNG or TIFF file.", default=8)


def threads() -> Any:
    """The field of worker threads."""
    return option("N", "Worker threads; all cores if not given.")


def family() -> Any:
    """The field of a family of wavelets."""
    return option("NAME", "Wavelets: cdf97, cdf53, haar, spline4, bspline2 to bspline4.", default="cdf97")


def threshold() -> Any:
    """The field of a threshold of wavelet coefficients."""
    return option("T", "Drop wavelet coefficients of less amplitude, in sample units.")
