"""Segmentations in files: a volume of numbers, or a file for each mask, with names and colours.

So TotalSegmentator writes them, and other programs that find organs one by one. The masks lie on the first one's
samples; where two overlap, the later file counts.
"""

from __future__ import annotations

import os
import re
from collections.abc import Sequence
from os import PathLike, fspath
from pathlib import PurePath
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from wavesplat._looks.labels import label_grids, label_names
from wavesplat._looks.labels.label_names import Named, chosen_numbers
from wavesplat._looks.labels.structure_labels import labels_of_structures
from wavesplat._model.volume.grid import Grid
from wavesplat._model.volume.volume import Volume
from wavesplat._readers.dicom import segments as dicom_labels
from wavesplat._readers.dicom.structures import is_structure_set
from wavesplat._readers.opening import is_zarr
from wavesplat._readers.opening import open as open_volume
from wavesplat._readers.zarr import ome_zarr
from wavesplat._storage.addresses import is_address
from wavesplat._storage.paths import expanded
from wavesplat._system.threads import collected_notes, warn
from wavesplat.errors import ArgumentError, FileError, FileWarning

# Segmentations in files: a volume of numbers, with names and colours, and a choice among its segments.


def opened_segmentation(
    path: str | PathLike[str], segments: Sequence[str | int] | None, scan: Grid | None
) -> tuple[Volume, dict[int, Named]]:
    """The numbers in a file, and names of labels.

    segments : of a DICOM segmentation or structure set, the segments that others must not cover, from
        `chosen_numbers`; None: all.
    scan : the grid that the lines of a structure set are filled on; of an OME-Zarr image, whose own labels `path` may
        name.
    """
    if (own := _own_labels(path, scan)) is not None:
        source, dataset = own
        return _opened_as(source["path"], source, dataset), label_names.in_file(source["path"], dataset)
    if is_structure_set(expanded(path)):
        return labels_of_structures(expanded(path), scan, segments)
    if segments is None or (file := dicom_labels.segmentation_at(expanded(path))) is None:
        return open_volume(path), label_names.in_file(path)
    with collected_notes():  # of segments that may not be shown
        volume = open_volume(path)
    named = label_names.in_file(path)
    alone = dicom_labels.with_segments(
        file, chosen_numbers(segments, {number: name for number, (name, _) in named.items()}, path)
    )
    for loss in alone.all_losses:
        warn(f"{loss}: {path}", FileWarning, stacklevel=5)
    if np.array_equal(alone.samples != 0, np.isin(volume.samples, np.unique(alone.samples[alone.samples != 0]))):
        return volume, named  # which documents can name
    return Volume(alone.samples, world_from_index=volume.world_from_index, name=volume.name, facts=volume.facts), named


def _own_labels(name: str | PathLike[str], scan: Grid | None) -> tuple[dict[str, Any], str] | None:
    """The source of an OME-Zarr image, and the path in it of its labels of that name; None for the name of a file.

    Raises
    ------
    FileError
        If there is no such file, and the image has labels, but none of that name.
    """
    source = getattr(scan, "_source", None)
    wanted = fspath(name)
    if source is None or is_address(wanted) or os.path.lexists(expanded(wanted)):
        return None
    image, dataset = source.get("path"), source.get("dataset")
    if not isinstance(image, str) or not is_zarr(image):
        return None
    inner, names = ome_zarr.labels_of(image, dataset)
    if wanted in names:
        return source, f"{inner}/labels/{wanted}".lstrip("/")
    if not names:
        return None
    raise FileError(f"no such file, and no labels of the image, which has {', '.join(names)}; check the name: {wanted}")


def _opened_as(image: str, source: dict[str, Any], dataset: str) -> Volume:
    """Labels of an image, at its time and its level of detail where they have these."""
    options = {key: source[key] for key in ("time", "level") if source.get(key) is not None}
    try:
        return open_volume(image, dataset=dataset, **options)
    except ArgumentError:
        return open_volume(image, dataset=dataset)


# Masks in a file each, named after what they show, as one segmentation: `liver.nii.gz`, `spleen.nii.gz`, ...

#: Suffixes of formats, also double ones such as .seg.nrrd.
SUFFIXES = re.compile(r"(\.(nii|img|hdr|ome|seg))?\.[A-Za-z][A-Za-z0-9]{1,5}$", re.IGNORECASE)
#: Largest number of masks: codes have 16 bits.
MAX_MASKS = 65_534
#: Names that a note lists.
N_LISTED = 3


class Masks(NamedTuple):
    """Masks as one volume of numbers, from 1 in the order of the files; their names, and notes on what was lost."""

    volume: Volume
    names: dict[int, str]
    notes: tuple[str, ...]


def name_of(path: str | PathLike[str]) -> str:
    """The name of a mask: its file's name without suffixes."""
    return SUFFIXES.sub("", PurePath(path).name)


def merged(paths: Sequence[str]) -> Masks:
    """Masks in files as one segmentation.

    Raises
    ------
    FileError
        If a file cannot be read.
    ArgumentError
        If a file holds several numbers beside 0, or a mask lies beside the first one.
    """
    if len(paths) > MAX_MASKS:
        raise ArgumentError(f"labels: {len(paths)} masks; {MAX_MASKS} are the most")
    first = open_volume(paths[0])
    numbers = np.zeros(first.shape, np.uint8 if len(paths) < 256 else np.uint16)
    names: dict[int, str] = {}
    empty, covered, n_covered = list[str](), list[str](), 0
    for number, path in enumerate(paths, 1):
        volume = first if number == 1 else open_volume(path)
        name = name_of(path)
        mask = _on_first(_mask(volume, path), volume, first, path)
        if not mask.any():
            empty.append(name)
            continue
        n_twice = int(np.count_nonzero(numbers[mask]))
        if n_twice:
            covered.append(name)
            n_covered += n_twice
        numbers[mask] = number
        names[number] = name
    notes = []
    if covered:
        notes.append(f"labels overlap in {n_covered} samples, where the later file counts: {_listed(covered)}")
    if empty:
        notes.append(f"labels without a sample: {_listed(empty)}")
    n_left = np.bincount(numbers.ravel(), minlength=len(paths) + 1)
    if hidden := [name for number, name in names.items() if not n_left[number]]:
        notes.append(f"labels that later ones cover whole: {_listed(hidden)}")
        names = {number: name for number, name in names.items() if name not in hidden}
    volume = Volume(numbers, world_from_index=first.world_from_index, name="labels", facts=first.facts)
    return Masks(volume, names, tuple(notes))


def _mask(volume: Volume, path: str) -> NDArray[np.bool_]:
    """Samples of a mask as bools."""
    samples = np.asarray(volume.samples)
    # Besides 0 there is one number, such as 1 or 255.
    if not ((samples == 0) | (samples == samples.max())).all():
        raise ArgumentError(
            f"labels: the file holds more than one number beside 0, and of several files each is one mask: {path}"
        )
    return np.asarray(samples != 0, bool)


def _on_first(mask: NDArray[np.bool_], volume: Volume, first: Volume, path: str) -> NDArray[np.bool_]:
    if volume is first:
        return mask
    try:
        label_grids.check_unit(volume.unit, first)
        return label_grids.placed(mask, volume.world_from_index, 0, first).codes
    except ArgumentError as error:
        raise ArgumentError(f"{error}: {path}") from None


def _listed(names: Sequence[str]) -> str:
    more = f" and {len(names) - N_LISTED} more" if len(names) > N_LISTED else ""
    return ", ".join(names[:N_LISTED]) + more
