"""Options of a segmentation that is drawn with the volume."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from wavesplat.errors import ArgumentError

if TYPE_CHECKING:
    from wavesplat._looks.labels import Labels
    from wavesplat._model.grid import Grid

__all__ = ["LabelTable", "LabelsFile", "Segments", "opened_labels"]

LabelsFile = Annotated[
    str | None,
    typer.Option(
        metavar="FILE", help="A segmentation of the volume, also DICOM SEG or RTSTRUCT, every label in a colour."
    ),
]
LabelTable = Annotated[
    Path | None,
    typer.Option(metavar="FILE", help="Their names and colours, from ITK-SNAP, 3D Slicer (.ctbl) or BIDS (.tsv)."),
]
Segments = Annotated[
    list[str] | None,
    typer.Option(
        metavar="NAME|NUMBER", help='Only this label, such as liver, 5 or a pattern ("rib*"); may be repeated.'
    ),
]


def opened_labels(
    path: str | None, table: Path | None, segments: Sequence[str] | None, scan: Grid, *, quiet: bool
) -> Labels | None:
    """The segmentation of a scan that the options name, or None."""
    from wavesplat._cli.printing import warnings_as_notes
    from wavesplat._looks.labels import Labels

    if path is None:
        for option, given in (("--label-table", table), ("--segment", segments)):
            if given:
                raise ArgumentError(f"{option} is about the labels of a segmentation; give it with --labels")
        return None
    chosen = [int(one) if one.strip().isdecimal() else one for one in segments or ()]
    with warnings_as_notes(quiet=quiet):
        return Labels.open(path, table=table, segments=chosen or None, scan=scan)
