"""Options of slices that show a second scan: a checkerboard of both, or their difference."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any, NamedTuple

import typer

from wavesplat._cli import parsers, registered
from wavesplat.errors import ArgumentError

if TYPE_CHECKING:
    from wavesplat._model.grid import Grid

__all__ = ["Checkerboard", "Difference", "Tiles", "opened_comparison"]

Checkerboard = Annotated[
    str | None,
    typer.Option(
        metavar=f"FILE{registered.REG}",
        help="A second scan, in squares in turn with INPUT, as after a registration. reg= as of --layer.",
    ),
]
Tiles = Annotated[int | None, typer.Option(metavar="N", help="Squares of it along the longer side; 8.")]
Difference = Annotated[
    str | None,
    typer.Option(
        metavar=f"FILE{registered.REG}",
        help="INPUT less a second scan, in blue and red about 0; --clim LOW,HIGH: the ends. reg= as of --layer.",
    ),
]


class Compared(NamedTuple):
    """The arguments of a slice for a second scan, and the scan."""

    arguments: dict[str, Any]
    volumes: list[Any]


def opened_comparison(
    checkerboard: str | None,
    tiles: int | None,
    difference: str | None,
    scan: Grid,
    *,
    time: int,
    quiet: bool,
    suv: bool,
) -> Compared:
    """The second scan of the options, opened.

    scan : the volume that transforms map onto.
    time : the time point of a second scan that has several. suv : PET in SUV.
    """
    from wavesplat._cli.layer_options import further_layers

    parsers.refuse_pairs(checkerboard=checkerboard, difference=difference)
    if tiles is not None and checkerboard is None:
        raise ArgumentError("--tiles are the squares of a checkerboard; give them with --checkerboard FILE")
    found = Compared({} if tiles is None else {"tiles": tiles}, [])
    for option, text in (("checkerboard", checkerboard), ("difference", difference)):
        if text is None:
            continue
        path, _ = registered.split(text, f"--{option}")
        layers = further_layers([text], scan, time=time, quiet=quiet, suv=suv)
        if len(layers) > 1:
            raise ArgumentError(f"--{option}: the file holds {len(layers)} channels, and one is compared: {path}")
        found.arguments[option] = layers[0].drawn
        found.volumes.append(layers[0].drawn)
    return found
