"""Segmentations in files: a volume of numbers, with names and colours, and a choice among its segments."""

from __future__ import annotations

import os
from collections.abc import Sequence
from os import PathLike, fspath
from typing import Any

import numpy as np

from wavesplat._files.addresses import is_address
from wavesplat._files.notes import collected_notes, warn
from wavesplat._files.paths import expanded
from wavesplat._looks import label_names
from wavesplat._looks.label_names import Named, chosen_numbers
from wavesplat._looks.structure_labels import labels_of_structures
from wavesplat._model.grid import Grid
from wavesplat._model.volume import Volume
from wavesplat._readers import dicom_labels, ome_zarr
from wavesplat._readers.dicom_structures import is_structure_set
from wavesplat._readers.opening import is_zarr
from wavesplat._readers.opening import open as open_volume
from wavesplat.errors import ArgumentError, FileError, FileWarning


def opened_segmentation(
    path: str | PathLike[str], segments: Sequence[str | int] | None, scan: Grid | None
) -> tuple[Volume, dict[int, Named]]:
    """The numbers in a file, and names of labels.

    segments : of a DICOM segmentation or structure set those that others must not cover, as of `chosen_numbers`; None:
        all.
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
