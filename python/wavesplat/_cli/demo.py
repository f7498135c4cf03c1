"""`wavesplat demo`."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from wavesplat._cli.printing import message, print_lines, print_result
from wavesplat._cli.shared_options import Json, Quiet
from wavesplat.errors import FileError

__all__ = ["demo"]


def demo(
    *,
    folder: Annotated[
        Path, typer.Option("--output", "-o", metavar="DIR", help="Folder for the pictures; made if missing.")
    ] = Path("out"),
    json: Json = False,
    quiet: Quiet = False,
) -> None:
    """Draw the volumes that come with the package and print the pictures' paths."""
    from wavesplat._cli import demo_scenes as scenes

    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise FileError(f"cannot make the folder: {error.strerror}; choose another with -o: {folder}") from None
    paths = []
    for path in scenes.draw(folder):
        paths.append(str(path))
        if not json:
            print_lines(path, written=path)
    if json:
        print_result({"pictures": paths}, "", as_json=True)
    elif not quiet:
        message(f"drew {len(paths)} pictures in {folder}")
