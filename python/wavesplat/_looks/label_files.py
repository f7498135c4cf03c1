"""Segmentations in files: a volume of numbers, with names and colours, and a choice among its segments."""

from __future__ import annotations

import warnings
from collections.abc import Sequence
from os import PathLike

import numpy as np

from wavesplat._files.paths import expanded
from wavesplat._looks import label_names
from wavesplat._looks.label_names import Named, chosen_numbers
from wavesplat._looks.structure_labels import labels_of_structures
from wavesplat._model.grid import Grid
from wavesplat._model.volume import Volume
from wavesplat._readers import dicom_labels
from wavesplat._readers.dicom_structures import is_structure_set
from wavesplat._readers.opening import open as open_volume
from wavesplat.errors import FileWarning

__all__ = ["opened_segmentation"]


def opened_segmentation(
    path: str | PathLike[str], segments: Sequence[str | int] | None, scan: Grid | None
) -> tuple[Volume, dict[int, Named]]:
    """The numbers in a file, and names of labels.

    segments : of a DICOM segmentation or structure set those that others must not cover, as of `chosen_numbers`; None:
        all.
    scan : the grid that the lines of a structure set are filled on.
    """
    if is_structure_set(expanded(path)):
        return labels_of_structures(expanded(path), scan, segments)
    if segments is None or (file := dicom_labels.segmentation_at(expanded(path))) is None:
        return open_volume(path), label_names.in_file(path)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", FileWarning)  # of segments that may not be shown
        volume = open_volume(path)
    named = label_names.in_file(path)
    alone = dicom_labels.with_segments(
        file, chosen_numbers(segments, {number: name for number, (name, _) in named.items()}, path)
    )
    for loss in alone.losses:
        warnings.warn(f"{loss}: {path}", FileWarning, stacklevel=5)
    if np.array_equal(alone.samples != 0, np.isin(volume.samples, np.unique(alone.samples[alone.samples != 0]))):
        return volume, named  # which documents can name
    return Volume(alone.samples, world_from_index=volume.world_from_index, name=volume.name, facts=volume.facts), named
