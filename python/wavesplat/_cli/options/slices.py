"""Options of slices: lines of regions and of equal value, and a second scan beside the first."""

from __future__ import annotations

import re
import warnings
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar, NamedTuple

from wavesplat import _native
from wavesplat._cli.options.groups import option
from wavesplat._cli.options.layers import MARK, REG, further_layers, map_of_transform, named_file, split_transform
from wavesplat._cli.options.parsers import refuse_pairs
from wavesplat._cli.printing import warnings_as_notes
from wavesplat.errors import ArgumentError

if TYPE_CHECKING:
    from wavesplat._looks.labels.labels import Labels
    from wavesplat._looks.labels.regions import Region
    from wavesplat._model.volume.grid import Grid
    from wavesplat._model.volume.volume import Volume
    from wavesplat._model.volume.wavelet_volume import WaveletVolume
    from wavesplat._render.isolines import Isolines

ISOLINES = f"FILE:VALUE,...[:COLOR]{REG}"


@dataclass(repr=False)
class LabelOptions:
    """A segmentation of the volume."""

    TITLE: ClassVar = "Labels"

    labels: str | None = option(
        f"FILE{REG}",
        "A segmentation of the volume, also DICOM SEG or RTSTRUCT, every label in a colour; or, in quotes, "
        "'organs/*.nii.gz': masks in a file each, with their names; of OME-Zarr the name of labels in it. reg= as for "
        "--layer.",
    )
    label_table: Path | None = option(
        "FILE",
        "Names and colours of the labels (of slices without --labels, of the contours), from ITK-SNAP, FreeSurfer, 3D "
        "Slicer (.ctbl), Connectome Workbench or BIDS (.tsv).",
    )
    segment: list[str] | None = option(
        "NAME|NUMBER", 'Only this label, such as liver, 5 or a pattern ("rib*"); may be repeated.'
    )


@dataclass(repr=False)
class LineOptions:
    """Lines over a slice."""

    TITLE: ClassVar = "Lines over the slice"

    contours: str | None = option(
        f"FILE{REG}",
        "Regions as lines: DICOM RTSTRUCT or SEG, or any other segmentation, such as .nii.gz.",
    )
    isolines: list[str] | None = option(
        ISOLINES,
        "Lines of equal value of a volume, such as isodoses: dose.dcm:20,40,60. COLOR: a colour or a colour map; may "
        "be repeated. reg= as for --layer.",
    )


@dataclass(repr=False)
class ComparisonOptions:
    """A second scan: a checkerboard of both, or their difference."""

    TITLE: ClassVar = "Comparison with a second scan"

    checkerboard: str | None = option(
        f"FILE{REG}",
        "A second scan, in squares in turn with INPUT, as after a registration. reg= as for --layer.",
    )
    tiles: int | None = option("N", "Squares of it along the longer side; 8.")
    difference: str | None = option(
        f"FILE{REG}",
        "INPUT less a second scan, in blue and red about 0; --clim LOW,HIGH: the ends. reg= as for --layer.",
    )


def opened_labels(options: LabelOptions, scan: Volume | WaveletVolume, *, quiet: bool) -> Labels | None:
    """The segmentation of a scan that the options name, or None."""
    text, table, segments = options.labels, options.label_table, options.segment
    if text is None:
        if table is not None:
            raise ArgumentError("--label-table names the labels of a segmentation; give it with --labels")
        if segments:
            raise ArgumentError("--segment chooses among the labels of a segmentation; give it with --labels")
        return None
    from wavesplat._looks.labels.labels import Labels
    from wavesplat._readers.dicom.structures import is_structure_set
    from wavesplat._storage.paths import expanded

    path, transform = split_transform(text, "--labels")
    if transform is not None and is_structure_set(expanded(path)):
        raise ArgumentError(f"the lines of a structure set cannot be moved by reg=; draw them on their scan: {path}")
    with warnings_as_notes(quiet=quiet):
        labels = Labels.open(path, table=table, segments=chosen_segments(segments), scan=scan)
    if transform is None:
        return labels
    return labels.moved(map_of_transform(transform, grid_of(labels, scan), scan, quiet=quiet))


def grid_of(labels: Labels, scan: Grid) -> Grid:
    """The grid of a segmentation; the scan's where it says nothing of its place."""
    from wavesplat._model.volume.grid import Grid

    if labels.world_from_index is None:
        return Grid("labels", labels.shape, scan.world_from_index, scan.facts)
    return Grid("labels", labels.shape, labels.world_from_index, labels._facts)


def chosen_segments(segments: Sequence[str] | None) -> list[str | int] | None:
    """Names, patterns and numbers of segments; None: all."""
    return [int(one) if one.strip().isdecimal() else one for one in segments or ()] or None


def opened_contours(
    text: str | None, table: Path | None, segments: Sequence[str] | None, scan: Grid, *, quiet: bool
) -> Sequence[Labels | Region] | None:
    """The regions of a structure set, or the labels of another segmentation, each whole also where they overlap.

    table : names and colours of the labels, instead of the names and colours in their file.
    scan : the volume that a transform maps onto.
    """
    from wavesplat._looks.labels.labels import Labels
    from wavesplat._looks.labels.regions import Region
    from wavesplat._readers.dicom.structures import is_structure_set
    from wavesplat._storage.paths import expanded

    if text is None:
        return None
    path, transform = split_transform(text, "--contours")
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
    by = map_of_transform(transform, grid_of(found[0], scan), scan, quiet=quiet)
    return [one.moved(by) for one in found]


def _overlapping(path: str, table: Path | None, chosen: Sequence[str | int] | None) -> list[Labels] | None:
    """Each segment of a DICOM segmentation by itself, since in one label map others hide parts of it; None elsewhere.

    None also where no segments overlap, so that one map has all of each.
    """
    from wavesplat._looks.labels import label_names
    from wavesplat._looks.labels.labels import Label, Labels
    from wavesplat._readers.dicom import segments as dicom_labels
    from wavesplat._storage.paths import expanded
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
            found.append(labels.with_looks({number: Label(color or _native.label_color(place), name=name)}))
    return found


class IsolinesText(NamedTuple):
    """An `--isolines`, parsed: its file, values, colour or colour map, and the file of its transform."""

    path: str
    values: tuple[float, ...]
    color: str | None
    transform: str | None = None


def isolines_of(text: str) -> IsolinesText:
    """Parse an `--isolines`; the longest beginning that names a file is the file."""
    text, transform = split_transform(text, "--isolines")
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
    from wavesplat._render.isolines import Isolines

    if not texts:
        return None
    found = []
    for said in [isolines_of(text) for text in texts]:
        moved = said.path if said.transform is None else f"{said.path}{MARK}{said.transform}"
        layers = further_layers([moved], scan, time=time, quiet=quiet, suv=suv)
        if len(layers) > 1:
            raise ArgumentError(f"--isolines: the file holds {len(layers)} channels, and lines are of one: {said.path}")
        found.append(Isolines(layers[0].drawn, said.values, **({"color": said.color} if said.color else {})))
    return found


class Compared(NamedTuple):
    """The arguments of a slice for a second scan, and the scan."""

    arguments: dict[str, Any]
    volumes: list[Any]


def opened_comparison(
    options: ComparisonOptions,
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
    refuse_pairs(checkerboard=options.checkerboard, difference=options.difference)
    tiles = options.tiles
    if tiles is not None and options.checkerboard is None:
        raise ArgumentError("--tiles are the squares of a checkerboard; give them with --checkerboard FILE")
    found = Compared({} if tiles is None else {"tiles": tiles}, [])
    for name in ("checkerboard", "difference"):
        text = getattr(options, name)
        if text is None:
            continue
        path, _ = split_transform(text, f"--{name}")
        layers = further_layers([text], scan, time=time, quiet=quiet, suv=suv)
        if len(layers) > 1:
            raise ArgumentError(f"--{name}: the file holds {len(layers)} channels, and one is compared: {path}")
        found.arguments[name] = layers[0].drawn
        found.volumes.append(layers[0].drawn)
    return found
