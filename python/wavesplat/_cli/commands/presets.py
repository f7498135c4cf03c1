"""`wavesplat presets`."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from wavesplat._cli.options.groups import Json, Quiet, given, option, picture_size
from wavesplat._cli.options.reader import ReaderOptions, open_any
from wavesplat._cli.printing import check_outputs, message, print_result
from wavesplat.errors import ArgumentError

if TYPE_CHECKING:
    from wavesplat._looks.presets import Preset


@dataclass(repr=False)
class SheetOptions:
    """A sheet of a volume with each preset."""

    sheet: Path | None = option("OUT", "Draw the volume with each of these: .png, .jpg, ...")
    size: Any = picture_size("Pixels of each picture.", "320x320")


def presets(
    input: Annotated[
        str | None,
        typer.Argument(metavar="[INPUT]", help="A volume: only the presets that fit it.", show_default=False),
    ] = None,
    *,
    own: SheetOptions,
    reader: ReaderOptions,
    json: Json = False,
    quiet: Quiet = False,
) -> None:
    """List the presets, or those that fit a volume, and draw it with each of these on one sheet."""
    from wavesplat._looks import presets as known

    sheet = own.sheet
    if input is None:
        if sheet is not None or given(reader):
            raise ArgumentError("--sheet shows a volume; name the volume too")
        _print(list(known.catalogue().values()), as_json=json)
        return
    if sheet is not None:
        check_outputs(input, sheet, "pictures")
    volume = open_any(input, reader)
    fitting = known.fitting(volume)
    if sheet is None:
        _print(fitting, as_json=json)
        return
    from wavesplat._cli import contact_sheet

    names = ["auto", *(preset.name for preset in fitting)]
    picture = contact_sheet.drawn(volume, names, own.size)
    picture.save(sheet)
    if not quiet:
        message(f"from left to right and top to bottom: {', '.join(names)}")
    print_result({"picture": str(sheet), "size": list(picture.size), "presets": names}, sheet, as_json=json)


def _print(found: list[Preset], *, as_json: bool) -> None:
    """Print presets in groups, one line each."""
    from wavesplat._looks.presets import GROUPS

    text = []
    width = max(len(preset.name) for preset in found)
    for kind, title in GROUPS.items():
        group = [preset for preset in found if preset.kind == kind]
        if group:
            text += [title, *(f"  {preset.name:{width}}  {preset.description}" for preset in group), ""]
    text.append("And auto, which looks at the volume. Case does not matter; -, _ and blanks are alike.")
    facts = [{"name": preset.name, "kind": preset.kind, "description": preset.description} for preset in found]
    print_result({"presets": facts}, "\n".join(text), as_json=as_json)
