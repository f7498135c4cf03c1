"""`wavesplat view --save`: what the viewer shows as a picture, without a page."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from wavesplat._cli import parsers
from wavesplat._cli.option_groups import with_options_of
from wavesplat._cli.outputs import check_outputs
from wavesplat._cli.printing import print_lines
from wavesplat.errors import ArgumentError

if TYPE_CHECKING:
    from wavesplat._viewer.state import ViewerState

__all__ = ["SaveOptions", "check_save_options", "save_seen", "takes_save_options"]

SHOWN = ("3d", "z", "y", "x", "all")
#: Pixels of a picture without --size.
FIRST_SIZE = (1024, 768)


@dataclass(frozen=True)
class SaveOptions:
    """A picture of what the viewer shows, and what is on it."""

    save: Annotated[
        Path | None, typer.Option(metavar="OUT", help="Write a picture of what is shown, and end; no page is opened.")
    ] = None
    shown: Annotated[
        Any,
        typer.Option(
            metavar="NAME",
            parser=parsers.one_of(SHOWN),
            help="Of --save: 3d, a slice by the axis across it, z, y or x, or all, two by two.",
        ),
    ] = "3d"
    size: Annotated[
        Any, typer.Option(metavar="WxH", parser=parsers.size, help="Of --save: pixels; 1024x768 without it.")
    ] = None
    marks: Annotated[
        bool,
        typer.Option("--marks/--no-marks", help="Of --save: draw measures, scale bars, letters, colour bar, legend."),
    ] = True


def takes_save_options(command: Callable[..., None]) -> Callable[..., None]:
    """Give a command these options on the command line, in the place of its parameter `saving`."""
    return with_options_of(SaveOptions, "saving", command)


def check_save_options(saving: SaveOptions, input: str | None, *, is_named: bool) -> None:
    """Refuse options that cannot work, before anything is read."""
    if saving.save is not None and not is_named:
        raise ArgumentError("INPUT: name one for --save: a volume, --state FILE.json or --example NAME")
    if saving.save is not None:
        check_outputs(input or "-", saving.save, "pictures", option="--save")
    elif (saving.shown, saving.size, saving.marks) != ("3d", None, True):
        raise ArgumentError("--shown, --size and --marks are for the picture of --save; name it, or leave them out")


def save_seen(saving: SaveOptions, state: ViewerState) -> None:
    """Draw the picture, write it, and print its path."""
    from wavesplat._viewer.seen import check_shown, seen

    output: Any = saving.save
    picture = seen(state, check_shown(saving.shown), saving.size or FIRST_SIZE, marks=saving.marks)
    picture.save(output)
    print_lines(str(output), written=output)
