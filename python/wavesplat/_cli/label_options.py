"""Options of a segmentation that is drawn with the volume."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from wavesplat._cli import registered
from wavesplat.errors import ArgumentError

if TYPE_CHECKING:
    from wavesplat._looks.labels import Labels
    from wavesplat._model.grid import Grid
    from wavesplat._model.volume import Volume
    from wavesplat._model.wavelet_volume import WaveletVolume

__all__ = ["LabelTable", "LabelsFile", "Segments", "chosen_segments", "grid_of", "opened_labels"]

LabelsFile = Annotated[
    str | None,
    typer.Option(
        metavar=f"FILE{registered.REG}",
        help="A segmentation of the volume, also DICOM SEG or RTSTRUCT, every label in a colour; or, in quotes, "
        "'organs/*.nii.gz': masks in a file each, with their names; of OME-Zarr the name of labels in it. reg= as of "
        "--layer.",
    ),
]
LabelTable = Annotated[
    Path | None,
    typer.Option(
        metavar="FILE",
        help="Names and colours of the labels (of slices without --labels, of the contours), from ITK-SNAP, "
        "FreeSurfer, 3D Slicer (.ctbl), Connectome Workbench or BIDS (.tsv).",
    ),
]
Segments = Annotated[
    list[str] | None,
    typer.Option(
        metavar="NAME|NUMBER", help='Only this label, such as liver, 5 or a pattern ("rib*"); may be repeated.'
    ),
]


def opened_labels(
    text: str | None, table: Path | None, segments: Sequence[str] | None, scan: Volume | WaveletVolume, *, quiet: bool
) -> Labels | None:
    """The segmentation of a scan that the options name, or None."""
    from wavesplat._cli.printing import warnings_as_notes
    from wavesplat._files.paths import expanded
    from wavesplat._looks.labels import Labels
    from wavesplat._readers.dicom_structures import is_structure_set

    if text is None:
        if table is not None:
            raise ArgumentError("--label-table names the labels of a segmentation; give it with --labels")
        if segments:
            raise ArgumentError("--segment chooses among the labels of a segmentation; give it with --labels")
        return None
    path, transform = registered.split(text, "--labels")
    if transform is not None and is_structure_set(expanded(path)):
        raise ArgumentError(f"the lines of a structure set cannot be moved by reg=; draw them on their scan: {path}")
    with warnings_as_notes(quiet=quiet):
        labels = Labels.open(path, table=table, segments=chosen_segments(segments), scan=scan)
    if transform is None:
        return labels
    return labels.moved(registered.map_of(transform, grid_of(labels, scan), scan, quiet=quiet))


def grid_of(labels: Labels, scan: Grid) -> Grid:
    """The grid of a segmentation; the scan's where it says nothing of its place."""
    from wavesplat._model.grid import Grid

    if labels.world_from_index is None:
        return Grid("labels", labels.shape, scan.world_from_index, scan.facts)
    return Grid("labels", labels.shape, labels.world_from_index, labels._facts)


def chosen_segments(segments: Sequence[str] | None) -> list[str | int] | None:
    """Names, patterns and numbers of segments; None: all."""
    return [int(one) if one.strip().isdecimal() else one for one in segments or ()] or None
