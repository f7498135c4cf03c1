"""Options of a segmentation that is drawn with the volume."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from wavesplat.errors import ArgumentError

if TYPE_CHECKING:
    from wavesplat._looks.labels import Labels

__all__ = ["LabelTable", "LabelsFile", "opened_labels"]

LabelsFile = Annotated[
    str | None,
    typer.Option(
        metavar="FILE",
        help="A segmentation of the volume, every label in a colour; or, in quotes, 'organs/*.nii.gz': masks in a file "
        "each, with their names.",
    ),
]
LabelTable = Annotated[
    Path | None,
    typer.Option(metavar="FILE", help="Their names and colours, from ITK-SNAP, 3D Slicer (.ctbl) or BIDS (.tsv)."),
]


def opened_labels(path: str | None, table: Path | None) -> Labels | None:
    """The segmentation that the options name, or None."""
    from wavesplat._looks.labels import Labels

    if path is None:
        if table is not None:
            raise ArgumentError("--label-table names the labels of a segmentation; give it with --labels")
        return None
    return Labels.open(path, table=table)
