"""Options of lines over a slice: contours of a segmentation, and lines of equal value."""

from __future__ import annotations

import re
import warnings
from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, NamedTuple

import typer

from wavesplat._cli import registered
from wavesplat._cli.label_options import chosen_segments, grid_of
from wavesplat._cli.layer_options import named_file
from wavesplat.errors import ArgumentError

if TYPE_CHECKING:
    from wavesplat._looks.labels import Labels
    from wavesplat._looks.regions import Region
    from wavesplat._model.grid import Grid
    from wavesplat._render.isolines import Isolines

__all__ = ["ContoursFile", "IsolinesText", "IsolinesTexts", "isolines_of", "opened_contours", "opened_isolines"]

ISOLINES = f"FILE:VALUE,...[:COLOR]{registered.REG}"

ContoursFile = Annotated[
    str | None,
    typer.Option(
        metavar=f"FILE{registered.REG}",
        help="Regions as lines: DICOM RTSTRUCT or SEG, or any other segmentation, such as .nii.gz.",
    ),
]
IsolinesTexts = Annotated[
    list[str] | None,
    typer.Option(
        metavar=ISOLINES,
        help="Lines of equal value of a volume, such as isodoses: dose.dcm:20,40,60. COLOR: a colour or a colour map; "
        "may be repeated. reg= as of --layer.",
    ),
]


def opened_contours(
    text: str | None, table: Path | None, segments: Sequence[str] | None, scan: Grid, *, quiet: bool
) -> Sequence[Labels | Region] | None:
    """The regions of a structure set, or the labels of another segmentation, each whole also where they overlap.

    table : names and colours of the labels, instead of those of their file.
    scan : the volume that a transform maps onto.
    """
    from wavesplat._cli.printing import warnings_as_notes
    from wavesplat._files.paths import expanded
    from wavesplat._looks.labels import Labels
    from wavesplat._looks.regions import Region
    from wavesplat._readers.dicom_structures import is_structure_set

    if text is None:
        return None
    path, transform = registered.split(text, "--contours")
    chosen = chosen_segments(segments)
    if is_structure_set(expanded(path)):
        if transform is not None:
            raise ArgumentError(
                f"the lines of a structure set cannot be moved by reg=; draw them on their scan: {path}"
            )
        if table is not None:
            raise ArgumentError(f"a structure set has names and colours of its own; leave out --label-table: {path}")
        with warnings_as_notes(quiet=quiet):
            return Region.open(path, segments=chosen)
    with warnings_as_notes(quiet=quiet):
        found = _overlapping(path, table, chosen) or [Labels.open(path, table=table, segments=chosen)]
    if transform is None:
        return found
    by = registered.map_of(transform, grid_of(found[0], scan), scan, quiet=quiet)
    return [one.moved(by) for one in found]


def _overlapping(path: str, table: Path | None, chosen: Sequence[str | int] | None) -> list[Labels] | None:
    """Each segment of a DICOM segmentation by itself, since in one label map others hide parts of it; None elsewhere.

    None also where no segments overlap, so that one map has all of each.
    """
    from wavesplat._files.paths import expanded
    from wavesplat._looks import label_names
    from wavesplat._looks.default_colors import label_color
    from wavesplat._looks.labels import Label, Labels
    from wavesplat._readers import dicom_labels
    from wavesplat.errors import ArgumentError, FileWarning

    file = dicom_labels.segmentation_at(expanded(path))
    if file is None:
        return None
    named = label_names.in_file(path)
    numbers = list(named)
    if chosen is not None:
        numbers = label_names.chosen_numbers(chosen, {number: name for number, (name, _) in named.items()}, path)
    map_of_all = dicom_labels.with_segments(file, numbers)
    if map_of_all.overlap is None:
        return None
    for loss in map_of_all.losses:
        warnings.warn(f"{loss}: {path}", FileWarning, stacklevel=2)
    if table is not None:
        named = {**named, **label_names.in_table(table)}
    found: list[Labels] = []
    for place, number in enumerate(numbers):
        name, color = named[number]
        with warnings.catch_warnings(), suppress(ArgumentError):  # of a segment without voxels
            warnings.simplefilter("ignore", FileWarning)
            labels = Labels.open(path, segments=[number])
            found.append(labels.with_looks({number: Label(color or label_color(place), name=name)}))
    return found


class IsolinesText(NamedTuple):
    """An `--isolines`, parsed: its file, values, colour or colour map, and the file of its transform."""

    path: str
    values: tuple[float, ...]
    color: str | None
    transform: str | None = None


def isolines_of(text: str) -> IsolinesText:
    """Parse an `--isolines`; the longest beginning that names a file is the file."""
    text, transform = registered.split(text, "--isolines")
    path, rest = named_file(text, "--isolines", ISOLINES, "dose.dcm:20,40,60")
    said, _, color = rest.partition(":")
    parts = said.split(",")
    if not all(re.fullmatch(r"\s*[-+]?(\d+(?:\.\d*)?|\.\d+)([eE][-+]?\d+)?\s*", part) for part in parts):
        raise ArgumentError(f"--isolines {text!r} has the values {said!r}; it is {ISOLINES}, such as dose.dcm:20,40,60")
    return IsolinesText(path, tuple(map(float, parts)), color or None, transform)


def opened_isolines(
    texts: Sequence[str] | None, scan: Grid, *, time: int, quiet: bool, suv: bool = False
) -> list[Isolines] | None:
    """The volumes of `--isolines` with their values.

    scan : the volume that transforms map onto.
    time : the time point of volumes that have several. suv : PET in SUV.
    """
    from wavesplat._cli.layer_options import further_layers
    from wavesplat._render.isolines import Isolines

    if not texts:
        return None
    found = []
    for said in [isolines_of(text) for text in texts]:
        moved = said.path if said.transform is None else f"{said.path}{registered.MARK}{said.transform}"
        layers = further_layers([moved], scan, time=time, quiet=quiet, suv=suv)
        if len(layers) > 1:
            raise ArgumentError(f"--isolines: the file holds {len(layers)} channels, and lines are of one: {said.path}")
        found.append(Isolines(layers[0].drawn, said.values, **({"color": said.color} if said.color else {})))
    return found
