"""Options of a segmentation that is drawn with the volume."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from wavesplat.errors import ArgumentError

if TYPE_CHECKING:
    from wavesplat._looks.labels import Labels
    from wavesplat._model.volume import Volume
    from wavesplat._model.wavelet_volume import WaveletVolume

__all__ = ["LabelTable", "LabelsFile", "Segments", "chosen_segments", "opened_labels"]

LabelsFile = Annotated[
    str | None,
    typer.Option(
        metavar="FILE",
        help="A segmentation of the volume, also DICOM SEG or RTSTRUCT, every label in a colour; or, in quotes, "
        "'organs/*.nii.gz': masks in a file each, with their names; of OME-Zarr the name of labels in it.",
    ),
]
LabelTable = Annotated[
    Path | None,
    typer.Option(
        metavar="FILE", help="Their names and colours, from ITK-SNAP, FreeSurfer, 3D Slicer (.ctbl) or BIDS (.tsv)."
    ),
]
Segments = Annotated[
    list[str] | None,
    typer.Option(
        metavar="NAME|NUMBER", help='Only this label, such as liver, 5 or a pattern ("rib*"); may be repeated.'
    ),
]


def opened_labels(
    path: str | None, table: Path | None, segments: Sequence[str] | None, scan: Volume | WaveletVolume, *, quiet: bool
) -> Labels | None:
    """The segmentation of a scan that the options name, or None."""
    from wavesplat._cli.printing import warnings_as_notes
    from wavesplat._looks.labels import Labels

    if path is None:
        if table is not None:
            raise ArgumentError("--label-table names the labels of a segmentation; give it with --labels")
        if segments:
            raise ArgumentError("--segment chooses among the labels of a segmentation; give it with --labels")
        return None
    with warnings_as_notes(quiet=quiet):
        return Labels.open(path, table=table, segments=chosen_segments(segments), scan=scan)


def chosen_segments(segments: Sequence[str] | None) -> list[str | int] | None:
    """Names, patterns and numbers of segments; None: all."""
    return [int(one) if one.strip().isdecimal() else one for one in segments or ()] or None
